//! Aggregation of disparities: agreement between techniques, and the common line of two sides.
//!
//! In: disparities by different techniques or from different sides. Out: accepted or not; one line
//! of disparity with its slant.
//!
//! # Source
//! The chapter's disparity aggregation, Eq. 13: a margin in metres is a disparity interval that is
//! not symmetric.

use super::Side;
use crate::params::{Margin, Params};
use crate::rig::Rig;
use crate::units::{Disparity, narrow, quotient};

/// Largest difference between two sides' disparities that is one slanted surface, 1/64 px.
const ONE_SURFACE_Q6: i32 = 112;

/// Joins two sides that agree into one surface: both get the disparity `line_q6` at the ends of the
/// edge, 1/64 px, and the slant across the edge that follows from the difference of `own_q6`, the
/// disparities by each side's own window, whose centres lie `apart` px from each other.
#[inline(never)]
pub(super) fn join_sides(
    sides: &mut [Option<Side>; 2],
    own_q6: [i32; 2],
    apart: i32,
    line_q6: [i32; 2],
) {
    let [Some(left), Some(right)] = sides else { return };
    let [own_left, own_right] = own_q6;
    if (own_right - own_left).abs() > ONE_SURFACE_Q6 {
        return;
    }
    let across_q10 = quotient((own_right - own_left) << 4, apart); // 1/64 px to 1/1024 px
    left.across_q10 = narrow(-across_q10);
    right.across_q10 = narrow(across_q10);
    left.disparity_q6 = line_q6.map(narrow);
    right.disparity_q6 = line_q6.map(narrow);
}

/// The margin within which techniques have to agree.
#[derive(Clone, Copy)]
pub(crate) struct Agreement {
    margin: Margin,
    rig: Option<Rig>,
}

impl Agreement {
    pub(crate) fn new(params: &Params) -> Self {
        Self { margin: params.margin, rig: params.rig }
    }

    /// True when `other` lies within the margin around `d` (Eq. 13), both in 1/64 px.
    pub(crate) fn holds(&self, d_q6: i32, other_q6: i32) -> bool {
        match (self.margin, self.rig) {
            (Margin::Metres { nearer, farther }, Some(rig)) => {
                let d = Disparity::from_bits(i16::try_from(d_q6).unwrap_or(i16::MAX));
                let (low, high) = rig.disparity_interval(d, nearer, farther);
                (i32::from(low.to_bits())..=i32::from(high.to_bits())).contains(&other_q6)
            }
            (Margin::Pixels(margin), _) => (d_q6 - other_q6).abs() <= i32::from(margin.to_bits()),
            (Margin::Metres { .. }, None) => false, // refused by `Params::check`
        }
    }
}
