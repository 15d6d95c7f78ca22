//! Which claims contradict each other: at most one of two that want the same place in the right image is right.
//!
//! In: every claim's place and disparity. Out: the pairs that want the same place with different disparities.
//!
//! # Cost
//! Quadratic in the claims of some 20 rows.

use super::{Candidate, Side, narrow};
use crate::lines::MAX_ROWS;

/// Distance of a claim's centre from its edge, px.
const OFF_EDGE: i32 = 4;
/// Largest difference of rows and of right columns at which two claims explain the same place, px.
const SAME_ROWS: i32 = 6;
const SAME_COLUMNS_Q6: i32 = 2 << 6;
/// Least difference of disparity that makes them contradict each other.
const OTHER_SURFACE_Q6: i32 = 2 << 6;

/// A candidate reduced to what its neighbours need to know: its middle, and what each side says.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) x: i16,
    pub(crate) y: i16,
    /// First row of the segment.
    top: i16,
    near_horizontal: bool,
    pub(crate) claims: [Claim; 2],
}

/// What a side says, and what is said of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Claim {
    pub(crate) d_q6: i16,
    /// 0 = no claim.
    pub(crate) weight_q8: u16,
    /// Weight when a surface is sought: that of an object's claim falls to the border of a box.
    pub(crate) agreeing: u16,
}

impl Place {
    pub(crate) const EMPTY: Self = Self { x: 0, y: 0, top: 0, near_horizontal: false, claims: [Claim::EMPTY; 2] };

    pub(crate) fn new(candidate: &Candidate) -> Self {
        let (x0, y0, x1, y1) = candidate.segment.ends_q5();
        let claim = |side: &Option<Side>| side.as_ref().map_or(Claim::EMPTY, Claim::new);
        let [left, right] = &candidate.sides;
        Self {
            x: narrow((x0 + x1) >> 6),
            y: narrow((y0 + y1) >> 6),
            top: narrow(y0.min(y1) >> 5),
            near_horizontal: candidate.segment.near_horizontal,
            claims: [claim(left), claim(right)],
        }
    }

    /// Of a support point.
    pub(crate) fn of_point(x: i32, y: i32, d_q6: i16, weight_q8: u16) -> Self {
        let claims = [Claim { d_q6, weight_q8, ..Claim::EMPTY }, Claim::EMPTY];
        Self { x: narrow(x), y: narrow(y), top: narrow(y), near_horizontal: false, claims }
    }

    /// Column in the right image that one side's claim wants, 1/64 px.
    fn right_q6(&self, side: usize, d_q6: i32) -> i32 {
        let off = if self.near_horizontal {
            0
        } else if side == 0 {
            -OFF_EDGE
        } else {
            OFF_EDGE
        };
        ((i32::from(self.x) + off) << 6) - d_q6
    }
}

impl Claim {
    const EMPTY: Self = Self { d_q6: 0, weight_q8: 0, agreeing: 0 };

    fn new(side: &Side) -> Self {
        Self { d_q6: narrow(side.sum_q6() >> 1), weight_q8: side.weight_q8, ..Self::EMPTY }
    }
}

/// Fills `places`, one per candidate.
pub(crate) fn place(candidates: &[Candidate], places: &mut [Place]) {
    for (candidate, place) in candidates.iter().zip(places.iter_mut()) {
        *place = Place::new(candidate);
    }
}

/// Rows between the tops of two segments beyond which their claims cannot contradict each other.
const CONTRADICTION_REACH: i32 = SAME_ROWS + MAX_ROWS / 2;

/// Calls `found` with the claims `(candidate, side)` of every two of the first `count` that want the same part of the right image with
/// different disparities: at most one of them is right.
pub(crate) fn for_each_contradiction(
    places: &[Place],
    count: usize,
    mut found: impl FnMut((usize, usize), (usize, usize)),
) {
    let places = places.get(..count).unwrap_or(&[]);
    for (i, place) in places.iter().enumerate() {
        for (other, j) in places.get(i + 1..).unwrap_or(&[]).iter().zip(i + 1..) {
            if i32::from(other.top - place.top) > CONTRADICTION_REACH {
                break;
            }
            if i32::from(other.y - place.y).abs() > SAME_ROWS {
                continue;
            }
            for side in 0..2 {
                for other_side in 0..2 {
                    if contradict((place, side), (other, other_side)) {
                        found((i, side), (j, other_side));
                    }
                }
            }
        }
    }
}

fn contradict((a, a_side): (&Place, usize), (b, b_side): (&Place, usize)) -> bool {
    let (Some(claim_a), Some(claim_b)) = (a.claims.get(a_side), b.claims.get(b_side)) else { return false };
    let (da, db) = (i32::from(claim_a.d_q6), i32::from(claim_b.d_q6));
    claim_a.weight_q8 > 0
        && claim_b.weight_q8 > 0
        && (a.right_q6(a_side, da) - b.right_q6(b_side, db)).abs() <= SAME_COLUMNS_Q6
        && (da - db).abs() > OTHER_SURFACE_Q6
}
