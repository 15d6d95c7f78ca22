//! Left segments -> disparities with evidence.

pub(crate) mod band;
pub(crate) mod consistency;
pub(crate) mod curve;
pub(crate) mod evidence;
pub(crate) mod feature;
pub(crate) mod flat;
pub(crate) mod steep;

use crate::lines::Segment;
use evidence::Evidence;

/// A segment that passed every hard test, with what speaks for and against each side's disparity.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The left segment.
    pub segment: Segment,
    /// The sides that carry a disparity: left and right of it, or above and below.
    pub sides: [Option<Side>; 2],
    /// Disparity by window, census and (if any) right segment at the middle, 1/64 px.
    pub window_q6: i32,
    /// By census.
    pub census_q6: i32,
    /// By the line of a right segment.
    pub feature_q6: Option<i32>,
}

/// One side's claim.
#[derive(Clone, Debug)]
pub struct Side {
    /// Disparity at the two ends, 1/64 px.
    pub disparity_q6: [i32; 2],
    /// What speaks for and against it.
    pub evidence: Evidence,
}

/// What is the same for every segment of a frame.
pub(crate) struct MatchContext<'a> {
    pub(crate) width: i32,
    pub(crate) max_disparity: i32,
    pub(crate) min_range: i32,
    pub(crate) right: &'a [Segment],
    pub(crate) row_offset_q5: i32,
    pub(crate) max_window_ratio_q8: i32,
    pub(crate) max_census_ratio_q8: i32,
    pub(crate) max_side_ratio_q8: i32,
    pub(crate) max_flat_ratio_q8: i32,
    pub(crate) max_slant_q6: i32,
    pub(crate) margin_q6: i32,
}

impl MatchContext<'_> {
    pub(crate) fn margin_holds(&self, a_q6: i32, b_q6: i32) -> bool {
        (a_q6 - b_q6).abs() <= self.margin_q6
    }
}
