//! Parameters of the method, checked once.
//!
//! In: plain numbers with documented defaults. Out: a [`Matcher`](crate::Matcher) for one image
//! size, or the name and range of the invalid number. A run then fails only on images of another
//! size or too little memory.

use crate::curve::MAX_DISPARITIES;
use crate::image::Dims;
use crate::named::named_enum;
pub use crate::rig::{Rig, RigError};
use crate::units::{Confidence, Depth, Disparity};

/// Largest difference between the techniques (Eq. 13).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Margin {
    /// In disparity, px, both ways.
    Pixels(Disparity),
    /// In depth, m, around the window's depth; needs a rig.
    Metres {
        /// Margin towards the cameras, m (x of Eq. 13).
        nearer: Depth,
        /// Margin away from them, m (y of Eq. 13).
        farther: Depth,
    },
}

/// Parts of the method that match a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Parts {
    /// Support points, and segments, whose search range they limit.
    #[default]
    Both,
    /// Support points alone: a third of the work, no edges.
    Support,
}

/// Parameters of the method. The defaults are one set for every scene; only the disparity range and
/// the rig belong to a camera pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Params {
    /// First disparity searched, px; -32 ..= 0. Negative only for pairs whose disparity at infinity
    /// is, which the rig's offset corrects.
    pub min_disparity: i16,
    /// End of the disparities searched, exclusive, px; 8 to 256 above `min_disparity`, smaller than
    /// the width. The nearest depth is that of [`Params::largest_disparity`].
    pub max_disparity: u16,
    /// The rectified rig; without one there are no depths.
    pub rig: Option<Rig>,
    /// Least grey step times four at which an edge is started; 4 ..= 1020.
    pub anchor_gradient: u16,
    /// Least grey step times four along an edge; 4 ..= `anchor_gradient`.
    pub edge_gradient: u16,
    /// Least extent of a segment in px; 6 ..= 32. Edges have a position every second pixel: odd
    /// extents count as the next even one.
    pub min_extent: u16,
    /// Side of the squares in each of which the most prominent segment is matched, px; 8 ..= 256.
    /// Cost is inverse to its square.
    pub cell: u16,
    /// Largest difference between window and census.
    pub margin: Margin,
    /// Least probability of points and segments; 0.1 ..= 0.99.
    pub min_confidence: Confidence,
    /// Largest distance from the edge of pixels that get a side's disparity, px; 1 ..= 6.
    pub reach: u16,
    /// Parts of the method that match pairs.
    pub parts: Parts,
    /// Look for the ground plane, and match support points beside it as well.
    pub ground: bool,
}

impl Params {
    /// The documented defaults.
    pub const DEFAULT: Self = Self {
        min_disparity: 0,
        max_disparity: 64,
        rig: None,
        anchor_gradient: 48,
        edge_gradient: 20,
        min_extent: 6,
        cell: 20,
        margin: Margin::Pixels(Disparity::ONE),
        min_confidence: Confidence::from_bits(0xe666),
        reach: 4,
        parts: Parts::Both,
        ground: true,
    };

    /// End of the disparities searched by default in images of this width, px: fewer than
    /// [`Params::DEFAULT`] has where the images have no room for them.
    #[must_use]
    pub const fn default_max_disparity(width: u16) -> u16 {
        let widest = width.saturating_sub(1);
        if widest < Self::DEFAULT.max_disparity { widest } else { Self::DEFAULT.max_disparity }
    }

    /// Largest disparity that is found where those below `max_disparity` are searched: its depth is
    /// the near limit. Of the last one that is compared a minimum may lie beyond, so minima are
    /// found up to the one before, and between pixels up to half a pixel farther.
    #[must_use]
    pub const fn largest_disparity(max_disparity: u16) -> Disparity {
        const MOST: u16 = MAX_DISPARITIES as u16;
        let end = if max_disparity < MOST { max_disparity } else { MOST };
        let half_px = Disparity::ONE.to_bits() / 2;
        Disparity::from_bits((2 * end as i16 - 3) * half_px)
    }

    /// Checks all parameters for images of this size, as [`Matcher::new`](crate::Matcher::new).
    ///
    /// # Errors
    /// The parameter that cannot be used.
    pub fn check(&self, dims: Dims) -> Result<(), ParamError> {
        in_range(Param::MinDisparity, self.min_disparity, -32_i16, 0_i16)?;
        let most = MAX_DISPARITIES as i32 + i32::from(self.min_disparity);
        let widest = most.min(i32::from(dims.width) - 1);
        in_range(
            Param::MaxDisparity,
            self.max_disparity,
            i32::from(self.min_disparity) + 8,
            widest,
        )?;
        in_range(Param::AnchorGradient, self.anchor_gradient, 4_i32, 1020_i32)?;
        in_range(Param::EdgeGradient, self.edge_gradient, 4_i32, self.anchor_gradient)?;
        in_range(Param::MinExtent, self.min_extent, 6_i32, 32_i32)?;
        in_range(Param::Cell, self.cell, 8_i32, 256_i32)?;
        in_range(Param::Reach, self.reach, 1_i32, 6_i32)?;
        let percent = (u32::from(self.min_confidence.to_bits()) * 100) >> 16;
        in_range(Param::MinConfidence, percent, 10_i32, 99_i32)?;
        match self.margin {
            Margin::Pixels(margin) => in_range(Param::Margin, margin.to_bits(), 16_i32, 1024_i32),
            Margin::Metres { .. } if self.rig.is_none() => Err(ParamError::MarginNeedsRig),
            Margin::Metres { nearer, farther } => {
                in_range(Param::MarginNearer, millimetres(nearer), 1_i32, 1_000_000_i32)?;
                in_range(Param::MarginFarther, millimetres(farther), 1_i32, 1_000_000_i32)
            }
        }
    }
}

impl Default for Params {
    fn default() -> Self {
        Self::DEFAULT
    }
}

fn millimetres(depth: Depth) -> i32 {
    i32::try_from((i64::from(depth.to_bits()) * 1000) >> 16).unwrap_or(i32::MAX)
}

fn in_range(
    param: Param,
    value: impl Into<i64>,
    low: impl Into<i64>,
    high: impl Into<i64>,
) -> Result<(), ParamError> {
    let (value, low, high) = (value.into(), low.into(), high.into());
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(ParamError::OutOfRange { param, value, low, high })
    }
}

named_enum! {
    /// A field of [`Params`], in the unit of its limits.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    #[cfg_attr(feature = "defmt", derive(defmt::Format))]
    #[non_exhaustive]
    pub enum Param {
        /// [`Params::min_disparity`], px.
        MinDisparity = "min_disparity",
        /// [`Params::max_disparity`], px.
        MaxDisparity = "max_disparity",
        /// [`Params::anchor_gradient`].
        AnchorGradient = "anchor_gradient",
        /// [`Params::edge_gradient`].
        EdgeGradient = "edge_gradient",
        /// [`Params::min_extent`], px.
        MinExtent = "min_extent",
        /// [`Params::cell`], px.
        Cell = "cell",
        /// [`Params::reach`], px.
        Reach = "reach",
        /// [`Params::min_confidence`], percent.
        MinConfidence = "min_confidence (percent)",
        /// [`Margin::Pixels`], 1/64 px.
        Margin = "margin (1/64 px)",
        /// [`Margin::Metres`] towards the cameras, mm.
        MarginNearer = "margin nearer (mm)",
        /// [`Margin::Metres`] away from the cameras, mm.
        MarginFarther = "margin farther (mm)",
    }

    /// The name of the field, with the unit of its limits where it is not the field's.
    fn name;
}

/// A parameter that cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ParamError {
    /// A number outside its range.
    #[error("{} is {value} but must be {low} to {high}", .param.name())]
    OutOfRange {
        /// The parameter.
        param: Param,
        /// Its value.
        value: i64,
        /// Least allowed value.
        low: i64,
        /// Largest allowed value.
        high: i64,
    },
    /// A margin in metres needs a rig, and there is none.
    #[error("a margin in metres needs a rig (focal length and baseline)")]
    MarginNeedsRig,
}
