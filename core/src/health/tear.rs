//! A row below which one image is moved sideways: rows that a cable or a buffer lost.
//!
//! In: the pair and its support points. Out: the row and the shift, if there is one.
//!
//! ```text
//! rows of points one below the other, and one apart: histogram of the differences of
//!     disparity, bins of 1/2 px
//!     a peak at 1.5 px or more that holds a third of the points: the rows may be torn between
//!         these two
//! images: at each row between them, sum of |row - row below| along the columns, as it is and with the row below moved by the shift
//!     torn, where the moved row is below 11/16 of the other
//! ```
//! The edge of a table across the whole picture moves disparities as well, but its rows are not
//! alike when moved.
//!
//! # Cost
//! Some 65 000 instructions of a QVGA pair, and 16 000 for every pair of rows of points with such a
//! peak, at most [`MOST`].

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
/// Bins that no window around a shift of [`MIN_SHIFT`] or more holds.
const NEAR: core::ops::RangeInclusive<usize> =
    (REACH - MIN_SHIFT + 2) as usize..=(REACH + MIN_SHIFT - 2) as usize;
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
                both.then(|| {
                    i32::from(below.disparity().to_bits()) - i32::from(above.disparity().to_bits())
                })
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

/// The change of disparity that a third of the points share, px; `None` if there is none, or it is
/// small.
#[inline(never)] // its variables are in registers
fn common_shift(changes_q6: impl Iterator<Item = i32>) -> Option<i32> {
    let mut bins = [0_u8; BINS];
    // A bit for each four bins that are not all empty, and the number of points.
    let (mut filled, mut points) = (0_u32, 0);
    changes_q6.for_each(|change| {
        points += 1;
        if let Ok(bin) = usize::try_from(((change + 16) >> 5) + REACH)
            && let Some(count) = bins.get_mut(bin)
        {
            *count = count.saturating_add(1);
            filled |= 1 << (bin / 4);
        }
    });
    // Most rows go on as the one above: a third of the points has to lie in a bin of a large shift
    // or beside it.
    let near: u32 = bins.get(NEAR).into_iter().flatten().map(|&count| u32::from(count)).sum();
    if points < MIN_POINTS || 3 * (points - near) < points {
        return None;
    }
    let low = 4 * filled.trailing_zeros() as usize;
    let high = 4 * (32 - filled.leading_zeros()) as usize;
    let (mut peak, mut count, mut shift) = (0, 0, 0);
    let (mut before, mut own) = (0, 0);
    for (&after, at) in
        bins.get(low..BINS.min(high + 1)).unwrap_or(&[]).iter().zip(low as i32 - 1 - REACH..)
    {
        let after = u32::from(after);
        // The middle counts twice: of three windows that hold the same points it is the one around
        // them.
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
        let stands_out =
            as_it_is >= MIN_DIFFERENCE * length && 4 * as_it_is > 5 * before.min(1 << 24);
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

/// Sum of |row - row below|, the latter moved by `shift`, and the number of pixels: at least 64, at
/// most every one, that are valid when moved by `most` as well.
#[inline(never)] // its variables are in registers
fn difference(image: Gray<'_>, y: i32, shift: i32, most: i32) -> Option<(u32, u32)> {
    let (upper, lower) =
        usize::try_from(y).ok().and_then(|y| image.row(y).zip(image.row(y + 1)))?;
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
    use crate::image::{Dims, Span};
    use crate::params::Params;
    use crate::support::SupportPoint;

    #[test]
    fn a_third_of_the_points_have_to_share_a_shift() {
        let differences = |count: usize, q6: i32| core::iter::repeat_n(q6, count);
        assert_eq!(common_shift(differences(12, -256)), Some(-4));
        assert_eq!(common_shift(differences(13, 250).chain(differences(12, 0))), Some(4));
        assert_eq!(common_shift(differences(7, -256)), None, "too few");
        assert_eq!(common_shift(differences(12, 64)), None, "a slope");
        assert_eq!(
            common_shift(differences(12, -256).chain((0..25).map(|n| 60 * n))),
            None,
            "not a third of them"
        );
    }

    #[test]
    fn a_shift_is_rounded_to_whole_pixels_and_counted_within_half_a_pixel() {
        let spread = |q6: i32| {
            common_shift(
                [-31, 0, 31].into_iter().cycle().map(|off| q6 + off).take(MIN_POINTS as usize),
            )
        };
        // From the bin of 1.5 px on: 2 px, away from zero.
        assert_eq!(
            [79, 80, 95, 128, 159, 192].map(spread),
            [None, Some(2), Some(2), Some(2), Some(3), Some(3)]
        );
        assert_eq!([-96, -128, -192].map(spread), [Some(-2), Some(-2), Some(-3)]);
        assert_eq!([1536, 1600].map(spread), [Some(24), None], "beyond the reach");
    }

    const DIMS: Dims = Dims { width: 320, height: 32 };
    type Pixels = [u8; 320 * 32];

    /// Pillars of random levels below this one, noise of a level; each row is moved to the right.
    fn pillars(levels: u32, moved: impl Fn(i32) -> i32) -> Pixels {
        let mut pixels = [0; 320 * 32];
        for (pixel, i) in pixels.iter_mut().zip(0..) {
            let pillar = (i % 320 - moved(i / 320)).div_euclid(5) as u32;
            let level = ((pillar.wrapping_mul(2_654_435_761) >> 16) * levels) >> 16;
            *pixel = 100 + level as u8 + (i * 7 % 3 / 2) as u8;
        }
        pixels
    }

    /// From the row behind this one on moved to the right.
    fn torn(below: i32, by: i32) -> Pixels {
        pillars(64, |y| if y > below { by } else { 0 })
    }

    fn view(pixels: &Pixels) -> Gray<'_> {
        Gray::new(pixels, DIMS, 320).unwrap()
    }

    #[test]
    fn a_row_below_which_one_image_is_moved_is_torn() {
        let (whole, torn) = (torn(9, 0), torn(9, 6));
        let row = |left, right, rows, shift| torn_row([view(left), view(right)], rows, shift);
        // The left image moved to the right has larger disparities, the right one smaller.
        assert_eq!(row(&torn, &whole, (2, 20), 6), Some(9));
        assert_eq!(row(&whole, &torn, (2, 20), -6), Some(9));
        assert_eq!(row(&torn, &whole, (-4, 20), 6), Some(9));
        for (rows, shift) in [((2, 20), -6), ((2, 20), -3), ((2, 9), 6), ((10, 20), 6)] {
            assert_eq!(row(&torn, &whole, rows, shift), None, "{rows:?} by {shift}");
        }
        assert_eq!(row(&whole, &whole, (2, 20), 6), None);
        // Levels below 6 differ by 2 on average, and noise by less than one.
        let [faint, clear] = [6, 16].map(|levels| pillars(levels, |y| if y > 9 { 6 } else { 0 }));
        assert_eq!(
            [row(&faint, &whole, (2, 20), 6), row(&clear, &whole, (2, 20), 6)],
            [None, Some(9)]
        );
        let slanted = pillars(64, |y| 6 * y);
        assert_eq!(row(&slanted, &slanted, (2, 20), 6), None, "each row is the one above, moved");
    }

    #[test]
    fn neighbouring_rows_differ_by_the_sum_over_every_fourth_column() {
        let mut pixels = [0; 320 * 32];
        for (pixel, i) in pixels.iter_mut().zip(0..) {
            *pixel = (i % 320 / 2 + 3 * (i / 320)) as u8;
        }
        let image = view(&pixels);
        assert_eq!(difference(image, 4, 0, 0), Some((80 * 3, 80)));
        assert_eq!(difference(image, 4, 0, 9), Some((76 * 3, 76)), "9 px less at each end: 302 px");
        // Two columns are a level.
        assert_eq!(
            [-8, 8].map(|shift| difference(image, 4, shift, 8)),
            [Some((76, 76)), Some((76 * 7, 76))]
        );
        assert_eq!([-1, 31].map(|y| difference(image, y, 0, 0)), [None; 2], "no row, none below");
        assert_eq!(difference(image, 4, 0, 161), None);
        // Of few pixels every one: 128 to 191 in twos, fewer one by one.
        let step = |width: u16| {
            let spans = [Span { start: 20, end: 20 + width }; 32];
            difference(image.with_valid(&spans).unwrap(), 4, 0, 0).unwrap().1
        };
        assert_eq!([256, 255, 192, 191, 128, 127, 5].map(step), [64, 85, 64, 96, 64, 127, 5]);
    }

    /// Looks with points of these disparities: rows of 40 of them at 4, 12, 20 and 28 px.
    fn found(
        [left, right]: [&Pixels; 2],
        disparity_q6: impl Fn(usize, usize) -> Option<i16>,
    ) -> Option<Tear> {
        let points: [_; 40 * 4] = core::array::from_fn(|i| match disparity_q6(i / 40, i % 40) {
            Some(disparity_q6) => {
                SupportPoint { disparity_q6, score_q8: 0, ..SupportPoint::none() }
            }
            None => SupportPoint::none(),
        });
        find([view(left), view(right)], Support::new(&Params::default(), DIMS, &points, 0))
    }

    #[test]
    fn four_rows_beyond_those_of_points_are_looked_at() {
        let rows = [None, Some(640), Some(1024), Some(1024)];
        let is_found =
            |below| found([&torn(below, 6), &torn(below, 0)], |row, _| rows[row]).is_some();
        // The first of them has none before it to stand out from.
        assert_eq!([8, 9, 15, 23].map(is_found), [false, true, true, true]);
    }

    #[test]
    fn rows_of_points_two_apart_are_compared_where_the_middle_one_has_none() {
        let rows = [Some(640), None, Some(1024), None];
        let tear = found([&torn(21, 6), &torn(21, 0)], |row, _| rows[row]);
        assert_eq!(tear, Some(Tear { row: 21, shift: 6 }));
    }

    #[test]
    fn points_lead_to_the_row() {
        let (whole, torn) = (torn(9, 0), torn(9, 6));
        // Rows from the second on see the shift, with every point or every second one.
        let seen = |images, shift: i16, every: usize| {
            found(images, |row, column| {
                (column % every == every - 1).then_some(640 + (shift << 6) * i16::from(row > 0))
            })
        };
        let tear = Some(Tear { row: 9, shift: 6 });
        assert_eq!([1, 2].map(|every| seen([&torn, &whole], 6, every)), [tear; 2]);
        assert_eq!(seen([&whole, &torn], -6, 1), Some(Tear { row: 9, shift: -6 }));
        assert_eq!(seen([&whole, &whole], 6, 1), None, "a step of the scene");
        assert_eq!(seen([&torn, &whole], 0, 1), None, "no change of disparity");
    }
}
