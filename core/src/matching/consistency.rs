//! What the claims say of each other.
//!
//! In: every claim's place, disparity and weight. Out: evidence of agreement and conflict for each, and the pairs that want the same place
//! in the right image.
//!
//! ```text
//! support  = log2(1 + sum of weight * nearness over the neighbours that agree)
//! conflict = conflicting / (agreeing + conflicting + 0.2)
//! ```
//! A neighbour agrees when its disparity differs by at most 1 px plus 0.06 px per px of distance: surfaces that slant up to that much.
//!
//! # Bounds
//! Weight and nearness are at most 256 each; 2 * 4096 claims: sums below 2^29.
//!
//! # Cost
//! Quadratic in the claims of 2 * [`REACH`] rows.

use super::evidence::log2_mean_q8;
use super::{Candidate, Side, narrow};
use crate::lines::MAX_ROWS;

/// Distance at which a neighbour's word counts nothing, px.
const REACH: i32 = 64;
/// Distance of a claim's centre from its edge, px.
const OFF_EDGE: i32 = 4;
/// Largest difference of rows and of right columns at which two claims explain the same place, px.
const SAME_ROWS: i32 = 6;
const SAME_COLUMNS_Q6: i32 = 2 << 6;
/// Least difference of disparity that makes them contradict each other.
const OTHER_SURFACE_Q6: i32 = 2 << 6;

/// A claim reduced to what its neighbours need to know.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Place {
    x: i16,
    y: i16,
    d_q6: i16,
    /// 0 = no claim.
    weight_q8: u16,
    agreeing: u32,
    conflicting: u32,
}

impl Place {
    pub(crate) const EMPTY: Self = Self { x: 0, y: 0, d_q6: 0, weight_q8: 0, agreeing: 0, conflicting: 0 };

    fn new(candidate: &Candidate, side: usize, claim: &Side) -> Self {
        let (x0, y0, x1, y1) = candidate.segment.ends_q5();
        let off = if side == 0 { -OFF_EDGE } else { OFF_EDGE };
        let (dx, dy) = if candidate.segment.near_horizontal { (0, off) } else { (off, 0) };
        let [d0, d1] = claim.disparity_q6.map(i32::from);
        Self {
            x: (((x0 + x1) >> 6) + dx) as i16,
            y: (((y0 + y1) >> 6) + dy) as i16,
            d_q6: ((d0 + d1) >> 1) as i16,
            weight_q8: claim.weight_q8,
            ..Self::EMPTY
        }
    }

    /// Lets two claims of different segments speak of each other.
    fn weigh(&mut self, other: &mut Self) {
        if self.weight_q8 == 0 || other.weight_q8 == 0 {
            return;
        }
        let dx = i32::from(other.x - self.x).abs();
        let dy = i32::from(other.y - self.y).abs();
        let distance = dx.max(dy) + ((3 * dx.min(dy)) >> 3); // within 7 % of the length
        if distance >= REACH {
            return;
        }
        let nearness = (REACH - distance) as u32; // of 64
        let (to_self, to_other) =
            ((u32::from(other.weight_q8) * nearness) >> 6, (u32::from(self.weight_q8) * nearness) >> 6);
        // 0.06 px per px is 4/64.
        if i32::from(other.d_q6 - self.d_q6).abs() <= 64 + 4 * distance {
            self.agreeing += to_self;
            other.agreeing += to_other;
        } else {
            self.conflicting += to_self;
            other.conflicting += to_other;
        }
    }
}

/// Rows between the tops of two segments beyond which their claims are out of [`REACH`]: half of the taller one and both offsets on top.
const TOPS_REACH: i32 = REACH + MAX_ROWS / 2 + 2 * OFF_EDGE;

/// Fills `places` (two per candidate; candidates in the order of their tops) and sets every claim's [`Kind::Support`] and
/// [`Kind::Conflict`].
pub(crate) fn weigh_neighbours(candidates: &mut [Candidate], places: &mut [[Place; 2]]) {
    for (candidate, pair) in candidates.iter().zip(places.iter_mut()) {
        for (side, (claim, place)) in candidate.sides.iter().zip(pair.iter_mut()).enumerate() {
            *place = claim.as_ref().map_or(Place::EMPTY, |claim| Place::new(candidate, side, claim));
        }
    }
    for i in 0..candidates.len() {
        let Some((pair, after)) = places.get_mut(i..).and_then(<[_]>::split_first_mut) else { break };
        let Some((own, others)) = candidates.get(i..).and_then(<[_]>::split_first) else { break };
        let top = own.segment.top();
        for (other, other_pair) in others.iter().zip(after) {
            if other.segment.top() - top > TOPS_REACH {
                break;
            }
            for place in pair.iter_mut() {
                for neighbour in other_pair.iter_mut() {
                    place.weigh(neighbour);
                }
            }
        }
    }
    for (candidate, pair) in candidates.iter_mut().zip(places.iter()) {
        for (claim, place) in candidate.sides.iter_mut().zip(pair) {
            if let Some(claim) = claim {
                claim.support_q8 = narrow(log2_mean_q8(place.agreeing, 256));
                let share = (place.conflicting << 8).checked_div(place.agreeing + place.conflicting + 51).unwrap_or(0);
                claim.conflict_q8 = narrow(share as i32);
            }
        }
    }
}

/// Rows between the tops of two segments beyond which their claims cannot contradict each other.
pub(crate) const CONTRADICTION_REACH: i32 = SAME_ROWS + MAX_ROWS / 2 + 2 * OFF_EDGE;

/// True when two places want the same part of the right image with different disparities: at most one of them is right.
pub(crate) fn contradict(a: Place, b: Place) -> bool {
    let right = |p: Place| (i32::from(p.x) << 6) - i32::from(p.d_q6);
    a.weight_q8 > 0
        && b.weight_q8 > 0
        && i32::from(a.y - b.y).abs() <= SAME_ROWS
        && (right(a) - right(b)).abs() <= SAME_COLUMNS_Q6
        && i32::from(a.d_q6 - b.d_q6).abs() > OTHER_SURFACE_Q6
}
