//! Cost of a bar over disparity: its own pixels and 1 px beyond both edges.
//!
//! In: a bar, the band that holds its rows. Out: its disparity, that of its halves, and the numbers
//! that evidence is made of.
//!
//! ```text
//! strips of eight columns from 1 px before the left edge to 1 px behind the right one; two overlap
//!     where it has fewer than sixteen; what a single one has beyond is flat, and its part of the
//!     cost is taken off
//! cost(d) = least of upper(d) + lower(d), upper(d + 1) + lower(d - 1) + penalty, and the reverse
//! a minimum between two whole disparities counts as low as that of a V through its three costs
//! ```
//!
//! # Bounds
//! Eight rows of 16 columns: 8 * 16 * 62 < 2^14.
//!
//! # Cost
//! Eight rows of one or two strips at 64 disparities: 3000 to 6000 instructions; 2000 for what is
//! taken off of bars up to 4 px wide; six passes over the curve.

use super::Bar;
use super::edges::MOST_ROWS;
use crate::curve::{CURVES, Curve, MAX_DISPARITIES, low_of};
use crate::kernel::{FLAT, STRIP, Strip, sad_curve};
use crate::matching::band::{Band, SampledRows};
use crate::matching::{MIN_RANGE, MatchContext};
use crate::row_memory::PAD;
use crate::units::quotient;
use heapless::Vec;

/// Columns beyond both edges.
const MARGIN: i32 = 1;
/// Most strips of a row.
const MOST_STRIPS: usize = 2;
/// Most strips of a bar.
const STRIPS: usize = MOST_ROWS as usize * MOST_STRIPS;
/// Penalty of halves 2 px apart: 1/25 of the mean cost.
const PENALTY: u32 = 25;
/// Largest difference of the halves' disparities of a straight bar, 1/64 px.
const STRAIGHT_Q6: i32 = 3 << 6;
/// Disparities beside the best that the second-best leaves out.
const NEIGHBOURHOOD: usize = 2;

/// Rows at which a bar is compared.
pub(super) type Rows = Vec<i32, { MOST_ROWS as usize }>;

/// The match of a bar.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub(super) disparity_q6: i32,
    /// Disparities of the upper and of the lower half, 1/64 px.
    pub(super) halves_q6: [i32; 2],
    /// Mean row of each half, in half rows.
    pub(super) centres_q1: [i32; 2],
    pub(super) is_straight: bool,
    /// Cost at the disparity, between whole ones.
    pub(super) best: u32,
    /// The lowest elsewhere.
    pub(super) second: u32,
    /// Sum of the bar's own gradients.
    pub(super) energy: u32,
    /// Number of disparities.
    pub(super) range: i32,
}

/// Rows of the band at which a bar is compared.
pub(super) fn rows(bar: &Bar) -> Rows {
    let [first, last] = bar.first_and_last();
    let mut rows = Rows::new();
    for y in SampledRows::new((first, last), MOST_ROWS) {
        let _ = rows.push(y); // at most MOST_ROWS
    }
    rows
}

/// Columns that are compared.
pub(super) fn columns(bar: &Bar) -> i32 {
    (((i32::from(bar.width_q5) + 16) >> 5) + 1 + 2 * MARGIN).min((MOST_STRIPS * STRIP) as i32)
}

/// Matches a bar over all disparities.
pub(super) fn search(
    bar: &Bar,
    context: &MatchContext<'_>,
    band: &Band<'_>,
    curves: &mut [Curve; CURVES],
) -> Option<Found> {
    let rows = rows(bar);
    let half = rows.len() / 2;
    let (above, below) = (rows.get(..half)?, rows.get(half..)?);
    let range = range(bar, context, band)?;
    let [upper, lower, whole, one, other, joint, ..] = curves;
    let energy = fill(bar, above, range, band, upper) + fill(bar, below, range, band, lower) + 1;
    whole.set_sum(upper, lower);
    let (_, costs) = whole.listed()?;
    let sum: u32 = costs.iter().map(|&cost| u32::from(cost)).sum();
    let penalty = sum.checked_div(costs.len() as u32 * PENALTY).unwrap_or(0) as u16;
    one.set_shifted_sum(upper, 1, lower, -1);
    other.set_shifted_sum(upper, -1, lower, 1);
    one.raise(penalty);
    other.raise(penalty);
    joint.set_lower(one, other);
    other.set_lower(joint, whole);
    let (joint, one) = (&*other, &*one);
    let best = joint.minimum();
    if best.at <= range.0 || context.is_last(best.at) || best.at >= range.0 + range.1 - 1 {
        return None;
    }
    let slant = match (whole.at(best.at), one.at(best.at)) {
        (Some(level), _) if level == best.cost => 0,
        (_, Some(rising)) if rising == best.cost => 1,
        _ => -1,
    };
    let (_, costs) = joint.listed()?;
    let index = usize::try_from(best.at - range.0).ok()?;
    let second = lowest_but(costs, index.saturating_sub(NEIGHBOURHOOD)..index + NEIGHBOURHOOD + 1);
    let halves_q6 = [upper.subpixel_q6(best.at + slant), lower.subpixel_q6(best.at - slant)];
    let [a, b] = halves_q6;
    let is_straight = (a - b).abs() <= STRAIGHT_Q6;
    let disparity_q6 = if is_straight { (a + b) >> 1 } else { whole.subpixel_q6(best.at) };
    let centre = |rows: &[i32]| quotient(2 * rows.iter().sum::<i32>(), rows.len() as i32);
    let centres_q1 = [centre(above), centre(below)];
    let best = low_at(costs, index)?;
    Some(Found {
        disparity_q6,
        halves_q6,
        centres_q1,
        is_straight,
        best,
        second,
        energy,
        range: range.1,
    })
}

/// First disparity and number of disparities at which all of it lies at valid columns.
fn range(bar: &Bar, context: &MatchContext<'_>, band: &Band<'_>) -> Option<(i32, i32)> {
    let (left, right) = bar.reach();
    let (from, to) = band.right_columns(bar.middle_row());
    let (first, end) = context.disparities();
    let first = first.max(right - MARGIN + columns(bar) + 1 - to);
    let len = end.min(left - MARGIN - from) - first;
    (len >= MIN_RANGE).then_some((first, len))
}

/// Sums the costs of some rows over a range of disparities; returns the sum of the bar's own
/// gradients.
#[inline(never)] // two calls
fn fill(bar: &Bar, rows: &[i32], range: (i32, i32), band: &Band<'_>, curve: &mut Curve) -> u32 {
    let width = band.width();
    fill_strips(bar, rows, range, curve, |y, x| {
        let (left, right) = band.gradient_rows(y)?;
        let mut reference =
            *left.get(usize::try_from(PAD as i32 + x).ok()?..)?.first_chunk::<STRIP>()?;
        reference.reverse();
        let target = PAD as i32 + width - STRIP as i32 - x + range.0;
        Some((reference, right.get(usize::try_from(target).ok()?..)?, true))
    })
}

/// Sums the costs of strips that `strip` gives for a row and a first column: reference pixels, the
/// row that they are compared with, and whether both are mirrored.
pub(super) fn fill_strips<'b>(
    bar: &Bar,
    rows: &[i32],
    range: (i32, i32),
    curve: &mut Curve,
    strip: impl Fn(i32, i32) -> Option<([u8; STRIP], &'b [u8], bool)>,
) -> u32 {
    let columns = columns(bar);
    // Columns beyond a bar of fewer than eight.
    let beyond = usize::try_from(STRIP as i32 - columns).unwrap_or(0);
    let starts = [0, columns - STRIP as i32];
    let starts = starts.get(..if columns > STRIP as i32 { 2 } else { 1 }).unwrap_or(&[]);
    let mut strips: Vec<Strip<'b>, STRIPS> = Vec::new();
    // Of each row: where what is taken off begins.
    let mut spares: Vec<&'b [u8], { MOST_ROWS as usize }> = Vec::new();
    let mut energy = 0;
    for &y in rows {
        for start in starts {
            let Some((mut reference, other, is_mirrored)) =
                strip(y, bar.column(y) - MARGIN + start)
            else {
                continue;
            };
            if beyond > 0 {
                let (flat, spare) = if is_mirrored {
                    (reference.get_mut(..beyond), 0)
                } else {
                    (reference.get_mut(STRIP - beyond..), STRIP - beyond)
                };
                flat.into_iter().for_each(|flat| flat.fill(FLAT));
                let _ = spares.push(other.get(spare..).unwrap_or(&[]));
            }
            energy += reference.iter().map(|g| u32::from(g.abs_diff(FLAT))).sum::<u32>();
            let _ = strips.push(Strip { reference, other }); // at most two of each row
        }
    }
    curve.fill(range, |costs| {
        sad_curve(&strips, costs);
        take_off(&spares, beyond, costs);
    });
    energy
}

/// Takes the differences between `beyond` flat pixels of each row and these rows off each cost.
fn take_off(rows: &[&[u8]], beyond: usize, costs: &mut [u16]) {
    let mut columns = [0_u8; MAX_DISPARITIES + STRIP];
    let length = if beyond > 0 { costs.len() + beyond } else { 0 };
    let fours = columns.as_chunks_mut().0;
    for (four, x) in fours.iter_mut().zip((0..length).step_by(4)) {
        *four = sizes(rows, x);
    }
    let entering = columns.get(beyond..).unwrap_or(&[]);
    let mut sum: u16 = columns.iter().take(beyond).map(|&size| u16::from(size)).sum();
    for ((cost, &gone), &next) in costs.iter_mut().zip(&columns).zip(entering) {
        *cost = cost.saturating_sub(sum);
        sum = sum.wrapping_add(next.into()).wrapping_sub(gone.into());
    }
}

/// Sums of the sizes of the gradients of these rows, at most eight, at four columns from `x` on.
fn sizes(rows: &[&[u8]], x: usize) -> [u8; 4] {
    let mut sums = 0_u32;
    for row in rows {
        let there = row.get(x..).unwrap_or(&[]);
        let four = there.first_chunk().copied().unwrap_or_else(|| {
            let mut four = [FLAT; 4];
            four.iter_mut().zip(there).for_each(|(four, &gradient)| *four = gradient);
            four
        });
        // Bit 5 is set from FLAT on: without it, what lies below is 64 less its size.
        let off = u32::from_le_bytes(four) ^ 0x2020_2020;
        let below = (off >> 5) & 0x0101_0101;
        sums += (off ^ (below * 63)) + below;
    }
    sums.to_le_bytes()
}

/// The cost at an index; a minimum as that of a V through its three costs, which lies between
/// whole disparities.
fn low_at(costs: &[u16], index: usize) -> Option<u32> {
    let before = index.checked_sub(1).and_then(|before| costs.get(before..));
    let around = before.and_then(|costs| costs.first_chunk());
    around.map(low_of).or_else(|| costs.get(index).map(|&cost| cost.into()))
}

/// The lowest of these costs outside a range of indices.
fn lowest_but(costs: &[u16], left_out: core::ops::Range<usize>) -> u32 {
    let mut lowest = u32::from(u16::MAX);
    let sides = [costs.get(..left_out.start + 1), costs.get(left_out.end.saturating_sub(1)..)];
    for side in sides.into_iter().flatten() {
        for around in side.windows(3).filter_map(|around| around.first_chunk()) {
            lowest = lowest.min(low_of(around));
        }
    }
    for (end, index) in [(costs.first(), 0), (costs.last(), costs.len().saturating_sub(1))] {
        if let Some(&cost) = end.filter(|_| !left_out.contains(&index)) {
            lowest = lowest.min(cost.into());
        }
    }
    lowest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_beyond_the_bar_is_taken_off() {
        let other: [u8; 48] = core::array::from_fn(|i| (i * 7 % 63) as u8 + 1);
        let reference = [FLAT, FLAT, FLAT, 20, 40, 33, 12, 60];
        let mut costs = [0; 32];
        sad_curve(&[Strip { reference, other: &other }], &mut costs);
        take_off(&[&other], 3, &mut costs);
        for (d, &cost) in costs.iter().enumerate() {
            let own =
                (3..STRIP).map(|k| u16::from(other[d + k].abs_diff(reference[k]))).sum::<u16>();
            assert_eq!(cost, own, "{d}");
        }
    }

    #[test]
    fn a_minimum_between_two_disparities_is_as_low_as_one_on_one() {
        let on_one = [300, 200, 100, 200, 300];
        let between = [350, 250, 150, 150, 250];
        assert_eq!((low_at(&on_one, 2), low_at(&between, 2)), (Some(100), Some(100)));
        assert_eq!((low_at(&on_one, 0), low_at(&on_one, 5)), (Some(300), None));
        assert_eq!(lowest_but(&on_one, 1..4), 300);
    }
}
