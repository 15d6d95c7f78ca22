//! Bars that the left image shows elsewhere along the same rows: fences, radiators, stripes.
//!
//! In: a matched bar, the band that holds its rows. Out: nothing where it repeats; else how much
//! the most similar place costs.
//!
//! ```text
//! cost of the bar in the left image, 4 px to the range away on both sides
//! alike: a minimum of at most 1.5 times the cost of the match and 0.3 of the bar's own gradients
//! two of them on one side, or one on each side as far: it repeats. One is another leg, unless the
//!     right image matches elsewhere as well as that
//! ```
//!
//! # Cost
//! As matching, at twice as many places.

use super::cost::{Found, fill_strips, rows};
use super::evidence::{BarEvidence, BarKind, MOST_ALIKE_Q8, part_q8};
use super::{Bar, cost};
use crate::curve::{CURVES, Curve, low_of};
use crate::kernel::Strip;
use crate::matching::MatchContext;
use crate::matching::band::Band;
use crate::matching::repetition::strip;

/// Nearest place that is compared, px.
const NEAREST: i32 = 4;
/// Farthest one, whatever the range: both sides are one curve.
const FARTHEST: i32 = 120;
/// Difference between the distances of two places that are as far, px.
const AS_FAR: i32 = 2;

/// Looks for a bar elsewhere in the left image; `None` where it repeats, or may.
pub(super) fn look_for(
    bar: &Bar,
    found: &Found,
    context: &MatchContext<'_>,
    band: &Band<'_>,
    [curve, ..]: &mut [Curve; CURVES],
    evidence: &mut BarEvidence,
) -> Option<()> {
    let (_, end) = context.disparities();
    let (left, right) = bar.reach();
    let farthest = end.min(FARTHEST);
    let first = (-farthest).max(2 - left);
    let last = farthest.min(band.width() - 2 - right - cost::columns(bar));
    // Every second row of those that are matched.
    let mut rows = rows(bar);
    let mut is_even = false;
    rows.retain(|_| {
        is_even = !is_even;
        is_even
    });
    let energy = fill_strips(bar, &rows, (first, last - first + 1), curve, |y, x| {
        let Strip { reference, other } = strip(x, y, first, band)?;
        Some((reference, other, false))
    });
    let (_, costs) = curve.listed()?;
    let most = found.best + found.best / 2 + found.energy * 3 / 10;
    let of_rows = |cost: u32| (cost * (energy + 1)).checked_div(found.energy).unwrap_or(0);
    let places = Alike::of(costs, first, of_rows(most));
    evidence.set(BarKind::Alike, part_q8(places.lowest, energy + 1, MOST_ALIKE_Q8));
    let is_elsewhere = places.count != [0; 2] && found.second <= most;
    (!places.repeat() && !is_elsewhere).then_some(())
}

/// Places that are alike: they look like the bar.
struct Alike {
    /// Number on the left and on the right.
    count: [u32; 2],
    /// Distance of the last one found on each side, px.
    distance: [i32; 2],
    /// The lowest cost.
    lowest: u32,
}

impl Alike {
    fn of(costs: &[u16], first: i32, most: u32) -> Self {
        let mut places = Self { count: [0; 2], distance: [0; 2], lowest: u16::MAX.into() };
        let around = costs.windows(3).filter_map(|around| around.first_chunk());
        for (around, offset) in around.zip(first + 1..) {
            if offset.abs() < NEAREST {
                continue;
            }
            let low = low_of(around);
            places.lowest = places.lowest.min(low);
            let &[before, here, after] = around;
            if low <= most && here <= before && here < after {
                let ([left, right], [left_at, right_at]) =
                    (&mut places.count, &mut places.distance);
                let (count, at) = if offset < 0 { (left, left_at) } else { (right, right_at) };
                *count += 1;
                *at = offset.abs();
            }
        }
        places
    }

    fn repeat(&self) -> bool {
        let ([left, right], [left_at, right_at]) = (self.count, self.distance);
        left > 1 || right > 1 || left == 1 && right == 1 && (left_at - right_at).abs() <= AS_FAR
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Costs at -20 ..= 20 px, low at these places.
    fn repeats(at: &[i32]) -> bool {
        let costs: [u16; 41] =
            core::array::from_fn(|i| if at.contains(&(i as i32 - 20)) { 50 } else { 400 });
        Alike::of(&costs, -20, 100).repeat()
    }

    #[test]
    fn a_fence_repeats_and_a_second_leg_does_not() {
        assert!(repeats(&[0, 8, 16]) && repeats(&[0, -8, -16]) && repeats(&[-9, 0, 10]));
        assert!(
            !repeats(&[0, 15])
                && !repeats(&[-15, 0])
                && !repeats(&[0, -8, 15])
                && !repeats(&[-2, 0, 2])
        );
    }
}
