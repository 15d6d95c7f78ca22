//! Regions of a host, and the depths of the objects in them.
//!
//! In: boxes of a detector, in pixels of the rectified left image. Out: an [`ObjectRecord`] for
//! each, of the same bits as the core's [`ObjectDepth`].

use heapless::Vec;
use linestereo::{
    Area, Confidence, Depth, Dims, Disparity, NoDepth, ObjectDepth, Region, RegionError,
};
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
/// Not the core's own type: the three depths share one byte that says whether they are known, and
/// the reasons of later versions can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ObjectRecord {
    /// Of its region.
    pub label: u16,
    /// Disparity at the region's centre, 1/64 px, or why there is none: its index in
    /// [`NoDepth::ALL`].
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
    /// Segments that support the answer.
    pub support: u16,
    /// Probability that the disparity is within 1 px of the object's own range, 1/65536.
    pub confidence_q16: u16,
}

impl From<&ObjectDepth> for ObjectRecord {
    fn from(object: &ObjectDepth) -> Self {
        let index = |reason: NoDepth| {
            (0..).zip(NoDepth::ALL).find(|&(_, of)| of == reason).map_or(0, |(index, _)| index)
        };
        let depth_q16 = match (object.depth, object.depth_sigma, object.nearest) {
            (Some(depth), Some(sigma), Some(nearest)) => {
                Some([depth, sigma, nearest].map(Depth::to_bits))
            }
            _ => None,
        };
        Self {
            label: object.label,
            disparity_q6: object.disparity.map(Disparity::to_bits).map_err(index),
            sigma_q6: object.sigma.to_bits(),
            slope_q10: object.slope_q10,
            spread_q6: object.spread.to_bits(),
            depth_q16,
            support: object.support,
            confidence_q16: object.confidence.to_bits(),
        }
    }
}

impl From<&ObjectRecord> for ObjectDepth {
    fn from(record: &ObjectRecord) -> Self {
        let reason = |index: u8| {
            NoDepth::ALL.get(usize::from(index)).copied().unwrap_or(NoDepth::LittleSupport)
        };
        let [depth, depth_sigma, nearest] = match record.depth_q16 {
            Some(bits) => bits.map(|bits| Some(Depth::from_bits(bits))),
            None => [None; 3],
        };
        Self {
            label: record.label,
            disparity: record.disparity_q6.map(Disparity::from_bits).map_err(reason),
            sigma: Disparity::from_bits(record.sigma_q6),
            slope_q10: record.slope_q10,
            spread: Disparity::from_bits(record.spread_q6),
            depth,
            depth_sigma,
            nearest,
            support: record.support,
            confidence: Confidence::from_bits(record.confidence_q16),
        }
    }
}
