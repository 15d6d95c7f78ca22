//! A row below which one image is moved sideways: rows that a cable or a buffer lost.
//!
//! In: the pair and its support points. Out: the row and the shift, if there is one.
//!
//! ```text
//! each image: mean of |row - row below| along the columns
//! rows that stand out: a quarter above those before and behind, and 2 grey levels; the first eight
//!     by how far they stand out
//! of these, with the row below moved by 2 to 24 px to both sides: the lowest
//! torn, where that is below 3/4, unless the points above and below have one disparity; of fewer
//!     than 240 columns, and where areas alone are matched, only if a third of these points change
//!     theirs by the shift: four, or two where it is below 1/2
//! ```
//! The edge of a table across the whole picture stands out as well, but its rows are not alike when
//! moved. Those of a checkerboard are: there points have the last word.
//!
//! Rows of a blank wall, or of a floor without detail, show none. `docs/experiments.md` says how
//! many tears are found.
//!
//! # Cost
//! Some 210 000 instructions of a QVGA pair, and 13 000 for every row that stands out, at most
//! [`MOST`] an image.

use crate::image::Gray;
use crate::kernel::{STRIP, row_difference};
use crate::sort::keep_largest;
use crate::support::{SUPPORT_PITCH, Support};
use crate::units::quotient;

/// Most rows of an image that are looked at with others moved.
const MOST: usize = 8;
/// Smallest and largest shift, px.
const SHIFTS: [i32; 2] = [2, 24];
/// Least mean difference of neighbouring rows for them to say something, 1/16 grey levels.
const LEAST_Q4: i32 = 32;
/// Fewest columns that are compared.
const FEWEST: usize = 64;
/// Rows at the border of an image that have points on one side alone, px.
const BORDER: i32 = SUPPORT_PITCH as i32;
/// Rows between a tear and points whose windows do not reach it, px.
const CLEAR: i32 = 4;
/// Largest distance of a change of disparity from none, or from the shift, 1/64 px.
const SAME_Q6: i32 = 64;
/// Points that say nothing. Of more of one disparity above and below, a quarter that change by the
/// shift is enough: few are matched at a tear, and some of these elsewhere.
const FEW: i32 = 3;
/// Columns from which on rows are not alike by chance. Of fewer, points have to say the same. This
/// and [`SAME_Q6`] were chosen on six sets reduced to 128, 160, 224, 256 and 288 px,
/// `robot_sequences` and `kitti2012_640` among them: with 208, of 60 whole pairs of the former with
/// noise of their rows 2 are called torn at 256 px.
const ENOUGH: usize = 240;
/// Points of a small image that are not enough where its rows are half as different when moved, or
/// less. Chosen on `qvga` and `robot_world` reduced to 128 to 256 px. Torn images found at 160 px
/// with this and with [`FEW`]: of 300 of `robot_sequences` 102 and 69, of 125 of `kitti2012_640` 64
/// and 59, of 90 of six other sets 62 and 54; none in whole pairs with noise of their rows.
const FEW_IF_CLEAR: i32 = 1;

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
pub(super) fn find(images: [Gray<'_>; 2], support: Support<'_>, is_whole: bool) -> Option<Tear> {
    // The left image moved to the right has larger disparities, the right one smaller ones.
    images.into_iter().zip([1, -1]).find_map(|(image, sign)| {
        standing_out(image).into_iter().find_map(|row| {
            let Continuation { shift, few } = continuation(image, row, is_whole)?;
            let tear = Tear { row: u16::try_from(row).ok()?, shift: (sign * shift) as i16 };
            confirms(support, tear, few).then_some(tear)
        })
    })
}

/// The rows that differ more from the row below than both rows beside them do, the one that stands
/// out most first.
fn standing_out(image: Gray<'_>) -> impl Iterator<Item = i32> {
    let mut found = [(0, 0); MOST];
    let (mut before, mut own) = (None, None);
    let last = i32::from(image.dims().height) - 1;
    for y in BORDER - 1..=last + 1 - BORDER {
        let after = Rows::new(image, y).map(|rows| rows.difference_q4());
        if let (Some(before), Some(own), Some(after)) = (before, own, after)
            && own >= LEAST_Q4
            && 4 * own > 5 * after.max(before)
        {
            keep_largest(&mut found, (own - after.max(before), y - 1));
        }
        (before, own) = (own, after);
    }
    found.into_iter().filter(|(by, _)| *by > 0).map(|(_, row)| row)
}

/// An image that continues below a row when it is moved back.
struct Continuation {
    /// Shift to the right of the rows below, px.
    shift: i32,
    /// Number of points with the same shift that is too few; `None` where none has to have it.
    few: Option<i32>,
}

/// Looks below a row of an image.
fn continuation(image: Gray<'_>, row: i32, is_whole: bool) -> Option<Continuation> {
    let rows = Rows::new(image, row)?;
    let [least, most] = SHIFTS;
    let shifts = (-most..=most).filter(|shift| shift.abs() >= least);
    // Half of the columns say which one.
    let (_, shift) = shifts.map(|shift| (rows.moved::<true>(shift), shift)).min()?;
    let [moved, as_they_are] = [shift, 0].map(|shift| rows.moved::<false>(shift));
    // Points outside of areas could have denied it.
    let is_enough = is_whole && rows.upper.len() - 2 * (most as usize) >= ENOUGH;
    let few = if 2 * moved < as_they_are { FEW_IF_CLEAR } else { FEW };
    (4 * moved < 3 * as_they_are)
        .then_some(Continuation { shift, few: (!is_enough).then_some(few) })
}

/// True where the points above and below a tear do not deny it, or, of a small image, more than
/// `few` say the same.
fn confirms(support: Support<'_>, tear: Tear, few: Option<i32>) -> bool {
    let (row, shift_q6) = (i32::from(tear.row), i32::from(tear.shift) << 6);
    let (mut alike, mut moved) = (0, 0);
    for (y, above, below) in support.row_pairs(2) {
        let end = y + 2 * BORDER;
        if y + CLEAR > row || end - CLEAR <= row {
            continue;
        }
        for (above, below) in above.iter().zip(below) {
            if above.is_matched() && below.is_matched() {
                let change_q6 = i32::from(below.disparity_q6) - i32::from(above.disparity_q6);
                alike += i32::from(change_q6.abs() <= SAME_Q6);
                moved += i32::from((change_q6 - shift_q6).abs() <= SAME_Q6);
            }
        }
    }
    match few {
        Some(few) => moved > few && 2 * moved >= alike,
        None => alike <= FEW + 3 * moved,
    }
}

/// The valid pixels of a row, and of the row below at the same columns.
struct Rows<'a> {
    upper: &'a [u8],
    lower: &'a [u8],
}

impl<'a> Rows<'a> {
    /// None where there are too few.
    fn new(image: Gray<'a>, y: i32) -> Option<Self> {
        let row = usize::try_from(y).ok()?;
        let (above, below) = (image.valid_columns(y), image.valid_columns(y + 1));
        let valid =
            usize::from(above.start.max(below.start))..usize::from(above.end.min(below.end));
        let upper = image.row(row)?.get(valid.clone())?;
        let lower = image.row(row + 1)?.get(valid)?;
        (upper.len() >= FEWEST + 2 * SHIFTS[1] as usize).then_some(Self { upper, lower })
    }

    /// Mean difference, 1/16 grey levels.
    fn difference_q4(&self) -> i32 {
        quotient((sum::<false>(self.upper, self.lower) << 4) as i32, self.upper.len() as i32)
    }

    /// Sum of the differences to the lower row moved to the left, over all columns or half of them.
    fn moved<const HALF: bool>(&self, shift: i32) -> u32 {
        let [_, most] = SHIFTS;
        let columns = |from: i32, row: &'a [u8]| {
            let from = usize::try_from(from).ok()?;
            row.get(from..(from + row.len()).saturating_sub(2 * most as usize))
        };
        let both = columns(most, self.upper).zip(columns(most + shift, self.lower));
        both.map_or(u32::MAX, |(upper, lower)| sum::<HALF>(upper, lower))
    }
}

/// Sum of the absolute differences of whole sixteens of columns, or of the first half of each.
#[inline(never)] // its variables are in registers
fn sum<const HALF: bool>(upper: &[u8], lower: &[u8]) -> u32 {
    let [upper, lower] = [upper, lower].map(|row| row.as_chunks::<STRIP>().0.as_chunks::<2>().0);
    let mut sum = 0;
    for ([a, b], [c, d]) in upper.iter().zip(lower) {
        sum += u32::from(row_difference(a, c));
        if !HALF {
            sum += u32::from(row_difference(b, d));
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Dims, Span};
    use crate::params::Params;
    use crate::support::SupportPoint;

    const DIMS: Dims = Dims { width: 320, height: 32 };
    type Pixels = [u8; 320 * 32];

    /// Pillars of random levels below this one, noise of a level; each row is moved to the right.
    fn pillars(levels: u32, moved: impl Fn(i32) -> i32) -> Pixels {
        let mut pixels = [0; 320 * 32];
        for (pixel, i) in pixels.iter_mut().zip(0..) {
            let pillar = (i % 320 - moved(i / 320)).div_euclid(5) as u32;
            let mixed = pillar.wrapping_mul(2_654_435_761);
            let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x85eb_ca6b);
            let level = ((mixed >> 16) * levels) >> 16;
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

    /// Looks with points of these disparities: rows of 40 of them at 4, 12, 20 and 28 px.
    fn found(
        images: [Gray<'_>; 2],
        disparity_q6: impl Fn(usize, usize) -> Option<i16>,
    ) -> Option<(u16, i16)> {
        looked(images, true, disparity_q6)
    }

    fn looked(
        images: [Gray<'_>; 2],
        is_whole: bool,
        disparity_q6: impl Fn(usize, usize) -> Option<i16>,
    ) -> Option<(u16, i16)> {
        let points: [_; 40 * 4] = core::array::from_fn(|i| match disparity_q6(i / 40, i % 40) {
            Some(disparity_q6) => SupportPoint::matched(disparity_q6, 0),
            None => SupportPoint::none(),
        });
        let support = Support::new(&Params::default(), DIMS, &points, 0);
        find(images, support, is_whole).map(|tear| (tear.row, tear.shift))
    }

    /// Looks without points.
    fn alone(left: &Pixels, right: &Pixels) -> Option<(u16, i16)> {
        found([view(left), view(right)], |_, _| None)
    }

    #[test]
    fn a_row_below_which_one_image_is_moved_is_torn() {
        let whole = torn(9, 0);
        // The left image moved to the right has larger disparities, the right one smaller.
        for by in [-24, -6, -2, 2, 6, 24] {
            assert_eq!(alone(&torn(9, by), &whole), Some((9, by as i16)));
            assert_eq!(alone(&whole, &torn(9, by)), Some((9, -by as i16)));
        }
        assert_eq!(alone(&whole, &whole), None);
        for by in [-40, -1, 1, 40] {
            assert_eq!(alone(&torn(9, by), &whole), None, "{by} px");
        }
        // Nearer to the border there are points on one side alone.
        let rows = [7, 8, 23, 24].map(|below| alone(&torn(below, 6), &whole).is_some());
        assert_eq!(rows, [false, true, true, false]);
    }

    #[test]
    fn where_areas_alone_are_matched_their_points_have_to_say_the_same() {
        let (whole, torn) = (torn(9, 0), torn(9, 6));
        let images = [view(&torn), view(&whole)];
        let of_area = |below: i16| {
            looked(images, false, |row, column| {
                (column < 4).then_some(if row > 0 { below } else { 640 })
            })
        };
        assert_eq!(looked(images, false, |_, _| None), None);
        assert_eq!([640, 640 + 6 * 64].map(of_area), [None, Some((9, 6))]);
    }

    #[test]
    fn rows_that_differ_as_others_do_are_not_torn() {
        let whole = torn(9, 0);
        let slanted = pillars(64, |y| 6 * y);
        assert_eq!(alone(&slanted, &slanted), None, "each row is the one above, moved");
        // Levels below 4 differ by 1.3 on average, and noise by less than one.
        let [faint, clear] = [4, 16].map(|levels| pillars(levels, |y| if y > 9 { 6 } else { 0 }));
        assert_eq!([&faint, &clear].map(|image| alone(image, &whole)), [None, Some((9, 6))]);
        // Another picture below.
        let other = pillars(64, |y| if y > 9 { 1777 } else { 0 });
        assert_eq!(alone(&other, &whole), None);
    }

    #[test]
    fn of_many_rows_those_are_looked_at_that_stand_out_most() {
        // Steps of 4, 6, 8 ... grey levels, three rows from each other.
        let dims = Dims { width: 320, height: 64 };
        let level = |row: i32| {
            let steps = (1 + (row - 10).div_euclid(3)).clamp(0, 10);
            steps * (3 + steps)
        };
        let pixels: [u8; 320 * 64] = core::array::from_fn(|i| level(i as i32 / 320) as u8);
        let mut rows = standing_out(Gray::new(&pixels, dims, 320).unwrap());
        for index in (2..10).rev() {
            assert_eq!(rows.next(), Some(9 + 3 * index));
        }
        assert_eq!(rows.next(), None);
    }

    #[test]
    fn columns_that_are_not_valid_are_not_compared() {
        let (whole, torn) = (torn(9, 0), torn(9, 6));
        let seen = |width: u16, disparity_q6: fn(usize) -> Option<i16>| {
            let spans = [Span { start: 20, end: 20 + width }; 32];
            let images = [view(&torn), view(&whole)].map(|image| image.with_valid(&spans).unwrap());
            found(images, |row, _| disparity_q6(row))
        };
        let few = [111, 112, 287, 288].map(|width| seen(width, |_| None));
        assert_eq!(few, [None, None, None, Some((9, 6))]);
        // Of few columns points have to say the same.
        let changes: fn(usize) -> _ = |row| Some(if row > 1 { 640 + 6 * 64 } else { 640 });
        let tear = Some((9, 6));
        assert_eq!([111, 112].map(|width| seen(width, changes)), [None, tear]);
    }

    #[test]
    fn of_a_small_image_fewer_points_are_enough_where_rows_are_clear() {
        let (whole, torn) = (torn(9, 0), torn(9, 6));
        let other = pillars(64, |y| if y > 9 { 1777 } else { 0 });
        // 152 columns are compared. Another picture below in most of them: the rest continues.
        let spans = [Span { start: 20, end: 220 }; 32];
        let seen = |same: usize, points: usize| {
            let image: Pixels =
                core::array::from_fn(|i| if i % 320 < same { torn[i] } else { other[i] });
            let images = [&image, &whole].map(|image| view(image).with_valid(&spans).unwrap());
            found(images, |row, column| {
                (column < points).then_some(if row > 1 { 640 + 6 * 64 } else { 640 })
            })
        };
        let tear = Some((9, 6));
        assert_eq!([seen(320, 1), seen(320, 2)], [None, tear]);
        assert_eq!([seen(120, 3), seen(120, 4)], [None, tear]);
    }

    #[test]
    fn points_of_one_disparity_above_and_below_deny_a_tear() {
        let (whole, torn) = (torn(9, 0), torn(9, 6));
        // So many points keep their disparity from the first to the third row, others change it.
        let seen = |alike: usize, moved: usize| {
            found([view(&torn), view(&whole)], |row, column| {
                let change = if column < alike { 0 } else { 6 << 6 };
                (column < alike + moved).then_some(640 + change * i16::from(row > 1))
            })
        };
        let tear = Some((9, 6));
        assert_eq!([seen(3, 0), seen(4, 0)], [tear, None]);
        assert_eq!([seen(33, 7), seen(24, 7)], [None, tear]);
        // Squares of eight pixels, whose rows are alike at a distance of eight.
        let squares: Pixels = core::array::from_fn(|i| {
            if (i % 320 / 8 + i / 320 / 8).is_multiple_of(2) { 60 } else { 160 }
        });
        let checker = |d: Option<i16>| found([view(&squares), view(&squares)], |_, _| d);
        assert_eq!([checker(None).is_some(), checker(Some(640)).is_some()], [true, false]);
    }
}
