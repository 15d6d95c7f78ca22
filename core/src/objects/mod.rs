//! Regions that a detector calls objects -> the depth of each, or why there is none.

mod region;

use crate::units::{Confidence, Depth, Disparity};
pub use region::{Area, Region, RegionError, Run, Shape};

/// Why an object has no depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NoDepth {
    /// Too few credible claims in the region.
    LittleSupport,
    /// Two groups of claims explain the region equally well.
    TwoSurfaces,
    /// Claims lie on the outline only: they may belong to what is behind.
    OnlyOutline,
    /// The pair is not fit to be used.
    UnhealthyPair,
}

/// The depth of one region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ObjectDepth {
    /// Of its region.
    pub label: u16,
    /// Disparity at the region's centre, or why there is none.
    pub disparity: Result<Disparity, NoDepth>,
    /// Standard deviation of the disparity in px; 0 where there is none.
    pub sigma: Disparity,
    /// Change of the disparity per pixel to the right and downwards, 1/1024 px: the object's plane.
    pub slope_q10: [i16; 2],
    /// The object's own disparities lie within the answer's plane plus and minus so much.
    pub spread: Disparity,
    /// Depth at the region's centre; `None` without a rig or an answer.
    pub depth: Option<Depth>,
    /// Standard deviation of depth; `None` where depth is.
    pub depth_sigma: Option<Depth>,
    /// Nearest credible depth of the object; `None` where depth is.
    pub nearest: Option<Depth>,
    /// Segments that speak for the answer.
    pub support: u16,
    /// Probability that the disparity is within 1 px of the object's own range.
    pub confidence: Confidence,
}
