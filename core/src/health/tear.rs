//! A row below which one image is moved sideways: rows that a cable or a buffer lost.
//!
//! In: the pair and its support points. Out: the row and the shift, if there is one.
//!
//! ```text
//! rows of points one below the other, and one apart: histogram of the differences of disparity, bins of 1/2 px
//!     a peak at 1.5 px or more that holds a third of the points: the rows may be torn between these two
//! images: at each row between them, sum of |row - row below| along the columns, as it is and with the row below moved by the shift
//!     torn, where the moved row is below 11/16 of the other
//! ```
//! The edge of a table across the whole picture moves disparities as well, but its rows are not alike when moved.
//!
//! # Cost
//! Some 75 000 instructions of a QVGA pair, and 16 000 for every pair of rows of points with such a peak, at most [`MOST`].

use crate::image::Gray;
use crate::support::Support;

/// Most pairs of rows of points that are looked at in the images.
const MOST: usize = 3;
/// Largest shift, half px.
const REACH: i32 = 48;
/// Number of bins.
const BINS: usize = 2 * REACH as usize + 1;
/// Least shift, half px.
const MIN_SHIFT: i32 = 3;
/// Differences of disparity that no window around a shift of [`MIN_SHIFT`] or more holds, 1/64 px.
const NEAR_Q6: core::ops::Range<i32> = 16 - (MIN_SHIFT - 1) * 32..(MIN_SHIFT - 1) * 32 - 16;
/// Least number of points in both rows.
const MIN_POINTS: u32 = 8;
/// Rows beyond the two rows of points that are looked at, px.
const MARGIN: i32 = 4;
/// Most columns from one pixel of a row compared to the next, px.
const MOST_STEP: usize = 4;
/// Least number of pixels compared of a row, where it has that many.
const MIN_PIXELS: usize = 64;
/// Least mean difference of neighbouring rows for them to say something, grey levels.
const MIN_DIFFERENCE: u32 = 3;

/// A row at which an image is torn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tear {
    /// The last row above it, px.
    pub row: u16,
    /// Change of the disparities below it, px.
    pub shift: i16,
}

/// Looks for a tear.
pub(super) fn find(images: [Gray<'_>; 2], support: Support<'_>) -> Option<Tear> {
    let mut looked = 0;
    for apart in [1, 2] {
        for (row, above, below) in support.row_pairs(apart) {
            let changes = above.iter().zip(below).filter_map(|(above, below)| {
                let both = above.is_matched() && below.is_matched();
                both.then(|| i32::from(below.disparity().to_bits()) - i32::from(above.disparity().to_bits()))
            });
            let Some(shift) = common_shift(changes) else { continue };
            looked += 1;
            if looked > MOST {
                return None;
            }
            let end = row + i32::from(crate::support::SUPPORT_PITCH) * apart as i32;
            if let Some(row) = torn_row(images, (row - MARGIN, end + MARGIN), shift) {
                return Some(Tear { row: u16::try_from(row).ok()?, shift: shift as i16 });
            }
        }
    }
    None
}

/// The change of disparity that a third of the points share, px; `None` if there is none, or it is small.
#[inline(never)] // its variables are in registers
fn common_shift(changes_q6: impl Iterator<Item = i32>) -> Option<i32> {
    let mut bins = [0_u8; BINS];
    let (mut low, mut high) = (BINS, 0);
    let (mut points, mut near) = (0, 0);
    changes_q6.for_each(|change| {
        points += 1;
        if NEAR_Q6.contains(&change) {
            near += 1;
        }
        if let Ok(bin) = usize::try_from(((change + 16) >> 5) + REACH)
            && let Some(count) = bins.get_mut(bin)
        {
            *count = count.saturating_add(1);
            (low, high) = (low.min(bin), high.max(bin));
        }
    });
    // Most rows go on as the one above: a third of the points has to lie in a bin of a large shift or beside it.
    if points < MIN_POINTS || 3 * (points - near) < points {
        return None;
    }
    let (mut peak, mut count, mut shift) = (0, 0, 0);
    let (mut before, mut own) = (0, 0);
    for (&after, at) in bins.get(low..BINS.min(high + 2)).unwrap_or(&[]).iter().zip(low as i32 - 1 - REACH..) {
        let after = u32::from(after);
        // The middle counts twice: of three windows that hold the same points it is the one around them.
        let weight = before + 2 * own + after;
        if weight > peak {
            (peak, count, shift) = (weight, before + own + after, at);
        }
        (before, own) = (own, after);
    }
    let is_common = 3 * count >= points && shift.abs() >= MIN_SHIFT;
    is_common.then_some((shift + shift.signum()) / 2)
}

/// The row between `from` and `to` below which one image continues when moved by the shift.
fn torn_row([left, right]: [Gray<'_>; 2], (from, to): (i32, i32), shift: i32) -> Option<i32> {
    let rows = (from.max(0), to);
    torn_row_of(left, rows, shift).or_else(|| torn_row_of(right, rows, -shift))
}

fn torn_row_of(image: Gray<'_>, (from, to): (i32, i32), shift: i32) -> Option<i32> {
    let mut before = u32::MAX;
    for y in from..to {
        let (as_it_is, length) = difference(image, y, 0, shift)?;
        // A tear stands out among the rows: most need no second sum.
        let stands_out = as_it_is >= MIN_DIFFERENCE * length && 4 * as_it_is > 5 * before.min(1 << 24);
        before = as_it_is;
        if stands_out
            && let Some((moved, _)) = difference(image, y, shift, shift)
            && 16 * moved < 11 * as_it_is
        {
            return Some(y);
        }
    }
    None
}

/// Sum of |row - row below|, the latter moved by `shift`, and the number of pixels: at least 64, at most every one, that are valid
/// when moved by `most` as well.
#[inline(never)] // its variables are in registers
fn difference(image: Gray<'_>, y: i32, shift: i32, most: i32) -> Option<(u32, u32)> {
    let (upper, lower) = usize::try_from(y).ok().and_then(|y| image.row(y).zip(image.row(y + 1)))?;
    let (above, below) = (image.valid_columns(y), image.valid_columns(y + 1));
    let start = i32::from(above.start.max(below.start)) + most.abs();
    let end = i32::from(above.end.min(below.end)) - most.abs();
    let at = |x: i32| usize::try_from(x).ok();
    let upper = upper.get(at(start)?..at(end)?)?;
    let lower = lower.get(at(start + shift)?..)?.get(..upper.len())?;
    let step = (upper.len() / MIN_PIXELS).clamp(1, MOST_STEP);
    let (mut sum, mut x) = (0, 0);
    while let Some((upper, lower)) = upper.get(x).zip(lower.get(x)) {
        sum += u32::from(*upper).abs_diff(u32::from(*lower));
        x += step;
    }
    Some((sum, upper.len().div_ceil(step) as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_of_the_points_have_to_share_a_shift() {
        let differences = |count: usize, q6: i32| core::iter::repeat_n(q6, count);
        assert_eq!(common_shift(differences(12, -256)), Some(-4));
        assert_eq!(common_shift(differences(13, 250).chain(differences(12, 0))), Some(4));
        assert_eq!(common_shift(differences(7, -256)), None, "too few");
        assert_eq!(common_shift(differences(12, 64)), None, "a slope");
        assert_eq!(common_shift(differences(12, -256).chain((0..25).map(|n| 60 * n))), None, "not a third of them");
    }
}
