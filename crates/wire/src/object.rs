//! Regions of a host, and the depths of the objects in them.
//!
//! In: boxes of a detector, in pixels of the rectified left image. Out: an [`ObjectRecord`] for
//! each, of the same bits as the core's [`ObjectDepth`].

use heapless::Vec;
use linestereo::objects::{ObjectMetres, Reason, RegionError};
use linestereo::units::{Confidence, Depth, Disparity};
use linestereo::{Area, Dims, NoDepth, ObjectDepth, Region};
use serde::{Deserialize, Serialize};

/// Most regions that a board keeps.
pub const MAX_REGIONS: usize = 16;

/// Objects in one packet, so that it stays below `MAX_PACKET`.
pub const OBJECTS_PER_PACKET: usize = 8;

/// Objects whose depths are wanted, from the next pair on.
#[derive(Clone, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Regions {
    /// Boxes; none: no object.
    pub boxes: Vec<RegionBox, MAX_REGIONS>,
    /// Match in and just around these boxes alone, where there are any.
    pub only: bool,
}

/// A box: columns `left .. right` of the rows `top .. bottom`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RegionBox {
    /// Label of the detector; comes back with the answer.
    pub label: u16,
    /// First column.
    pub left: u16,
    /// First row.
    pub top: u16,
    /// The column after the last one.
    pub right: u16,
    /// The row after the last one.
    pub bottom: u16,
}

impl RegionBox {
    /// Its pixels.
    #[must_use]
    pub const fn area(&self) -> Area {
        let Self { left, top, right, bottom, .. } = *self;
        Area { left, top, right, bottom }
    }

    /// The core's region, for images of this size.
    pub fn region(&self, dims: Dims) -> Result<Region<'static>, RegionError> {
        Region::boxed(self.label, self.area(), dims)
    }
}

impl From<(u16, Area)> for RegionBox {
    fn from((label, Area { left, top, right, bottom }): (u16, Area)) -> Self {
        Self { label, left, top, right, bottom }
    }
}

/// Depths of some of a frame's objects.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Objects {
    /// The frame they belong to.
    pub sequence: u32,
    /// The objects, in the order of their regions.
    pub list: Vec<ObjectRecord, OBJECTS_PER_PACKET>,
}

/// An [`ObjectDepth`] in plain numbers.
///
/// Not the core's own type: it has the label of its region, and the reasons of later versions can
/// be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ObjectRecord {
    /// Of its region.
    pub label: u16,
    /// Disparity at the region's centre, 1/64 px, or why there is none: its index in
    /// [`Reason::ALL`].
    pub disparity_q6: Result<i16, u8>,
    /// Standard deviation of the disparity, 1/64 px.
    pub sigma_q6: i16,
    /// Change of the disparity per pixel to the right and downwards, 1/1024 px.
    pub slope_q10: [i16; 2],
    /// Half of the range of disparities around the plane, 1/64 px.
    pub spread_q6: i16,
    /// Depth at the centre, its standard deviation, and the nearest credible depth, 1/65536 m;
    /// `i32::MAX` is infinite.
    pub depth_q16: Option<[i32; 3]>,
    /// Number of segments and support points that support the answer.
    pub support: u16,
    /// Probability that the disparity is within 1 px of the object's own range, 1/65536.
    pub confidence_q16: u16,
}

impl ObjectRecord {
    /// The record of a region's depth.
    #[must_use]
    pub fn new(label: u16, found: &Result<ObjectDepth, NoDepth>) -> Self {
        match found {
            Ok(object) => Self {
                label,
                disparity_q6: Ok(object.disparity.to_bits()),
                sigma_q6: object.sigma.to_bits(),
                slope_q10: object.slope_q10,
                spread_q6: object.spread.to_bits(),
                depth_q16: object.metres.map(|ObjectMetres { depth, sigma, nearest }| {
                    [depth, sigma, nearest].map(Depth::to_bits)
                }),
                support: object.support,
                confidence_q16: object.confidence.to_bits(),
            },
            Err(NoDepth { reason, support }) => {
                let index = (0..).zip(Reason::ALL).find(|(_, of)| of == reason);
                Self {
                    label,
                    disparity_q6: Err(index.map_or(0, |(index, _)| index)),
                    sigma_q6: 0,
                    slope_q10: [0; 2],
                    spread_q6: 0,
                    depth_q16: None,
                    support: *support,
                    confidence_q16: 0,
                }
            }
        }
    }

    /// The depth that was recorded. A reason of a later version is [`Reason::LittleSupport`].
    pub fn depth(&self) -> Result<ObjectDepth, NoDepth> {
        let Self { support, .. } = *self;
        let disparity = self.disparity_q6.map_err(|index| {
            let reason = Reason::ALL.get(usize::from(index)).copied();
            NoDepth { reason: reason.unwrap_or(Reason::LittleSupport), support }
        })?;
        let metres = |bits: [i32; 3]| {
            let [depth, sigma, nearest] = bits.map(Depth::from_bits);
            ObjectMetres { depth, sigma, nearest }
        };
        Ok(ObjectDepth {
            disparity: Disparity::from_bits(disparity),
            sigma: Disparity::from_bits(self.sigma_q6),
            slope_q10: self.slope_q10,
            spread: Disparity::from_bits(self.spread_q6),
            metres: self.depth_q16.map(metres),
            support,
            confidence: Confidence::from_bits(self.confidence_q16),
        })
    }
}
