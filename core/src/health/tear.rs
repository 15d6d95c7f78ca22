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
//! Some 40 000 instructions of a QVGA pair, and 20 000 for every pair of rows of points with such a peak, at most [`MOST`].

use crate::image::Gray;
use crate::support::Support;

/// Most pairs of rows of points that are looked at in the images.
const MOST: usize = 4;
/// Largest shift, half px.
const REACH: i32 = 48;
/// Number of bins.
const BINS: usize = 2 * REACH as usize + 1;
/// Least shift, half px.
const MIN_SHIFT: i32 = 3;
/// Least number of points in both rows.
const MIN_POINTS: u32 = 8;
/// Rows beyond the two rows of points that are looked at, px.
const MARGIN: i32 = 4;
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
            let differences = above.iter().zip(below).filter_map(|(above, below)| {
                let both = above.is_matched() && below.is_matched();
                both.then(|| i32::from(below.disparity().to_bits()) - i32::from(above.disparity().to_bits()))
            });
            let Some(shift) = common_shift(differences) else { continue };
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
fn common_shift(differences_q6: impl Iterator<Item = i32>) -> Option<i32> {
    let mut bins = [0_u8; BINS];
    let mut points = 0;
    for difference in differences_q6 {
        points += 1;
        let bin = ((difference + 16) >> 5) + REACH;
        if let Some(count) = usize::try_from(bin).ok().and_then(|bin| bins.get_mut(bin)) {
            *count = count.saturating_add(1);
        }
    }
    let (mut peak, mut count, mut shift) = (0, 0, 0);
    for (window, at) in bins.windows(3).zip(1 - REACH..) {
        let [before, own, after] = [0, 1, 2].map(|i| window.get(i).map_or(0, |&count: &u8| u32::from(count)));
        // The middle counts twice: of three windows that hold the same points it is the one around them.
        let weight = before + 2 * own + after;
        if weight > peak {
            (peak, count, shift) = (weight, before + own + after, at);
        }
    }
    let is_common = points >= MIN_POINTS && 3 * count >= points && shift.abs() >= MIN_SHIFT;
    is_common.then_some((shift + shift.signum()) / 2)
}

/// The row between `from` and `to` below which one image continues when moved by the shift.
fn torn_row([left, right]: [Gray<'_>; 2], (from, to): (i32, i32), shift: i32) -> Option<i32> {
    (from.max(0)..to).find(|&y| is_torn(left, y, shift) || is_torn(right, y, -shift))
}

fn is_torn(image: Gray<'_>, y: i32, shift: i32) -> bool {
    let rows = usize::try_from(y).ok().and_then(|y| image.row(y).zip(image.row(y + 1)));
    let Some((upper, lower)) = rows else { return false };
    let (above, below) = (image.valid_columns(y), image.valid_columns(y + 1));
    let start = i32::from(above.start.max(below.start)) + shift.abs();
    let end = i32::from(above.end.min(below.end)) - shift.abs();
    let (Ok(start), Ok(end), Ok(moved)) =
        (usize::try_from(start), usize::try_from(end), usize::try_from(start + shift))
    else {
        return false;
    };
    let length = end.saturating_sub(start);
    let (Some(upper), Some(lower), Some(shifted)) =
        (upper.get(start..end), lower.get(start..end), lower.get(moved..moved + length))
    else {
        return false;
    };
    let as_it_is = difference(upper, lower);
    as_it_is >= MIN_DIFFERENCE * length as u32 && 16 * difference(upper, shifted) < 11 * as_it_is
}

/// Sum of absolute differences.
fn difference(a: &[u8], b: &[u8]) -> u32 {
    a.iter().zip(b).map(|(&a, &b)| u32::from(a.abs_diff(b))).sum()
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
