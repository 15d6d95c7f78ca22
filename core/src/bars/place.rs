//! Where a bar lies: in front of the support points that do not see it, or level with them.
//!
//! In: a matched bar, the rated support points. Out: whether it is in front, and the evidence of
//! the points.
//!
//! # Cost
//! The points at most 22 px from the bar, some 40 of 25 instructions.

use super::{AMID, Bar};
use crate::area::Area;
use crate::support::Support;
use crate::units::{narrow, quotient};

/// Distance from an edge from which on the windows of points do not see the bar, and the largest
/// one, 1/32 px.
const BESIDE_Q5: (i32, i32) = (5 << 5, 22 << 5);
/// Rows above and below that count, px.
const ROWS: u16 = 6;
/// Largest difference of disparities that agree, 1/64 px.
const AGREES_Q6: i32 = 96;
/// Least probability of a point that counts, Q8: 0.3.
const LEAST_Q8: i32 = 77;
/// Share, Q8, below which points that agree leave a bar in front: 0.3.
const FRONT_Q8: i32 = 77;
/// Share, Q8, below which points that are nearer do: 0.15.
const NEARER_Q8: i32 = 38;

/// Support points around a bar.
pub(super) struct Around {
    pub(super) is_in_front: bool,
    /// More than half of the points are nearer: a gap, or a reflection.
    pub(super) is_behind: bool,
    /// Entries of the evidence from [`BarKind::SupportAgrees`](super::evidence::BarKind) on, Q8.
    pub(super) evidence_q8: [i16; 4],
}

/// Probabilities, Q8, of points that agree and of all.
#[derive(Clone, Copy, Default)]
struct Side {
    agree: i32,
    all: i32,
}

impl Side {
    /// Share that agrees, with a doubt of 0.3 of a point, Q8.
    fn share_q8(self) -> i32 {
        quotient(self.agree << 8, self.all + LEAST_Q8)
    }
}

/// Compares a bar with the support points around it.
pub(super) fn around(bar: &Bar, support: Support<'_>) -> Around {
    let (near, far) = BESIDE_Q5;
    let width = i32::from(bar.width_q5);
    let (mut sides, mut all, mut agree, mut behind, mut nearer) =
        ([Side::default(); 2], 0, 0, 0, 0);
    for (x, y, point) in support.within(reach(bar)) {
        let weight = i32::from(point.confidence().to_bits() >> 8);
        let from_left = (x << 5) - bar.x_at_q5(y);
        if weight < LEAST_Q8 || !(-far..=width + far).contains(&from_left) {
            continue;
        }
        let off_q6 = i32::from(point.disparity().to_bits()) - bar.disparity_at_q6(y);
        let agrees = off_q6.abs() <= AGREES_Q6;
        all += weight;
        *if agrees {
            &mut agree
        } else if off_q6 < 0 {
            &mut behind
        } else {
            &mut nearer
        } += weight;
        let [left, right] = &mut sides;
        let beside = match from_left {
            off if off <= -near => left,
            off if off >= width + near => right,
            _ => continue,
        };
        beside.all += weight;
        beside.agree += if agrees { weight } else { 0 };
    }
    let share = |of: i32| quotient(of << 8, all + 128);
    let [left, right] = sides.map(Side::share_q8);
    // Where bars repeat points are left out: that none agrees says nothing.
    let is_in_front =
        left.min(right).max(share(agree)) < FRONT_Q8 && share(nearer) < NEARER_Q8 && !bar.is(AMID);
    let none = i32::from(all == 0) << 8;
    let is_behind = share(nearer) > 128;
    Around {
        is_in_front,
        is_behind,
        evidence_q8: [share(agree), share(behind), share(nearer), none].map(narrow),
    }
}

/// Pixels whose points count.
fn reach(bar: &Bar) -> Area {
    let Area { left, top, right, bottom } = bar.area();
    let (_, far) = BESIDE_Q5;
    let far = u16::try_from(far >> 5).unwrap_or(0);
    Area {
        left: left.saturating_sub(far),
        top: top.saturating_sub(ROWS),
        right: right.saturating_add(far),
        bottom: bottom.saturating_add(ROWS),
    }
}
