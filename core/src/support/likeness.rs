//! How alike both images are around the pixel that a point is listed at.
//!
//! In: the pair, a pixel, its disparity. Out: three kinds of evidence.
//!
//! A point's window is matched as a whole; an outline in it may be all that matches. Around the
//! pixel itself both images differ where it shows another surface.
//!
//! # Cost
//! Some 1200 instructions a point on a Cortex-M7.

use crate::evidence::log2_mean_q8;
use crate::ground::GroundPlane;
use crate::image::Gray;

/// Pixels of the window to each side. Chosen by networks fitted to the listed points of `qvga`,
/// `robot_world`, `oakd_agreed_320` and `middlebury2006_third`, with 2 and with 1 px: on twelve
/// other sets, which chose it, mean log loss is 2.7 and 2.2 % less than without this evidence.
const REACH: u16 = 2;
/// Pixels of a row of the window, and rows.
const SIDE: usize = 2 * REACH as usize + 1;
/// Pixels of the window.
const PIXELS: i32 = (SIDE * SIDE) as i32;

/// Compares both images of the pair that points were matched in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Likeness<'a> {
    pub(crate) images: [Gray<'a>; 2],
    /// Row of the right image that matches row 0 of the left one.
    pub(crate) row_offset: i32,
    /// Mean grey level of the left image above that of the right one.
    pub(crate) brighter: i32,
}

impl Likeness<'_> {
    /// Around a pixel with this disparity, 1/64 px, whose rows may move along the ground plane:
    /// log2(1 + grey levels), Q8, of the mean deviation of the differences between both images, of
    /// the mean difference, and of the mean deviation in the left image. At the border of an image
    /// columns are those inside it, and its last row is repeated.
    pub(super) fn at(
        &self,
        (x, y): (u16, u16),
        disparity_q6: i16,
        along: Option<GroundPlane>,
    ) -> [i32; 3] {
        let [left, right] = self.images;
        let (width, height) = (left.dims().width, left.dims().height);
        let last = i32::from(height) - 1;
        let first = usize::from(x.saturating_sub(REACH).min(width.saturating_sub(SIDE as u16)));
        let (mut greys, mut differences_q6) = ([[0; SIDE]; SIDE], [[0; SIDE]; SIDE]);
        for ((greys, differences_q6), down) in
            greys.iter_mut().zip(&mut differences_q6).zip(-i32::from(REACH)..)
        {
            let change_q6 = along.map_or(0, |plane| plane.change_q6(0, down));
            let at_q6 = ((first as i32) << 6) - i32::from(disparity_q6) - change_q6;
            let from = (at_q6 >> 6).min(i32::from(width) - SIDE as i32 - 1).max(0) as usize;
            let row = |y: i32| y.max(0).min(last) as usize;
            let y = i32::from(y) + down;
            let (Some(here), Some(there)) = (
                left.row(row(y)).and_then(|row| row.get(first..)?.first_chunk::<SIDE>()),
                right
                    .row(row(y + self.row_offset))
                    .and_then(|row| row.get(from..)?.first_chunk::<{ SIDE + 1 }>()),
            ) else {
                return [0; 3];
            };
            let part_q6 = at_q6 & 63;
            let pairs = there.iter().zip(there.iter().skip(1));
            let both = here.iter().zip(pairs);
            for ((grey, difference_q6), (&here, (&before, &after))) in
                greys.iter_mut().zip(differences_q6).zip(both)
            {
                *grey = i32::from(here);
                let [before, after] = [before, after].map(i32::from);
                *difference_q6 = (*grey << 6) - (before << 6) - (after - before) * part_q6;
            }
        }
        let [unlike, brighter] = deviation_and_mean(&differences_q6, 64, self.brighter);
        let [texture, _] = deviation_and_mean(&greys, 1, 0);
        [unlike, brighter, texture]
    }
}

/// log2(1 + grey levels), Q8, of the mean deviation of these values and of their mean beyond what
/// is usual, for so many units a grey level: 1 or 64.
#[inline(never)] // of both windows
fn deviation_and_mean(values: &[[i32; SIDE]; SIDE], unit: i32, usual: i32) -> [i32; 2] {
    let sum: i32 = values.iter().map(|row| row.iter().sum::<i32>()).sum();
    let off = |value: &i32| (PIXELS * value - sum).abs();
    // At most 25 * 2 * 25 * 255 * 64, below 2^25. Row by row: loops of five are unrolled.
    let deviation: i32 = values.iter().map(|row| row.iter().map(off).sum::<i32>()).sum();
    let beyond = sum - usual * PIXELS * unit;
    [
        log2_mean_q8(deviation.cast_unsigned(), PIXELS * PIXELS * unit),
        log2_mean_q8(beyond.unsigned_abs(), PIXELS * unit),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Dims;

    const DIMS: Dims = Dims { width: 32, height: 24 };
    const PIXELS_OF_IMAGE: usize = 32 * 24;

    /// Both images, whose pixels are `grey(column in 1/64 px, row)`; the right one has this
    /// disparity, 1/64 px, and is brighter by 30.
    fn compare(
        grey: impl Fn(i32, i32) -> i32,
        [disparity_q6, row_offset, usual]: [i32; 3],
        at: (u16, u16),
        told_q6: i16,
    ) -> [i32; 3] {
        let pixel = |index: usize| ((index % 32) as i32, (index / 32) as i32);
        let image = |shift_q6: i32, rows: i32, brighter: i32| -> [u8; PIXELS_OF_IMAGE] {
            core::array::from_fn(|index| {
                let (x, y) = pixel(index);
                (grey((x << 6) + shift_q6, y - rows) + brighter) as u8
            })
        };
        let (left, right) = (image(0, 0, 0), image(disparity_q6, row_offset, 30));
        let view = |pixels| Gray::new(pixels, DIMS, 32).unwrap();
        Likeness { images: [view(&left), view(&right)], row_offset, brighter: usual }
            .at(at, told_q6, None)
    }

    #[test]
    fn images_of_other_brightness_are_alike_at_the_right_disparity() {
        // Ten grey levels a pixel, and steps of four rows.
        let grey = |x_q6: i32, y: i32| ((x_q6 * 10) >> 6) % 150 + y % 4 * 5;
        let thirty = log2_mean_q8(30, 1);
        for (disparity_q6, row_offset) in [(5 << 6, 0), (5 * 64 + 32, 0), (3 << 6, 2)] {
            let pair = |usual| [disparity_q6, row_offset, usual];
            let [unlike, brighter, texture] = compare(grey, pair(0), (12, 10), disparity_q6 as i16);
            assert_eq!((unlike, brighter), (0, thirty), "{disparity_q6} {row_offset}");
            assert!(texture > 3 << 8, "{texture}");
            let usual = compare(grey, pair(-30), (12, 10), disparity_q6 as i16);
            assert_eq!(usual, [0, 0, texture]);
            // At the end of the ramp.
            let [unlike, ..] = compare(grey, pair(0), (15, 10), 0);
            assert!(unlike > 4 << 8, "{unlike}");
        }
        assert_eq!(compare(|_, _| 90, [64, 0, 0], (12, 10), 640), [0, thirty, 0]);
    }

    #[test]
    fn rows_move_along_the_ground() {
        // Half a pixel a row, from 5 px in the middle.
        let grey = |x_q6: i32| ((x_q6 * 10) >> 6) % 150;
        let image = |slope_q6: i32, at_middle_q6: i32| -> [u8; PIXELS_OF_IMAGE] {
            core::array::from_fn(|index| {
                let (x, y) = ((index % 32) as i32, (index / 32) as i32);
                grey((x << 6) + at_middle_q6 + slope_q6 * (y - 10)) as u8
            })
        };
        let (left, right) = (image(0, 0), image(32, 320));
        let view = |pixels| Gray::new(pixels, DIMS, 32).unwrap();
        let likeness = Likeness { images: [view(&left), view(&right)], row_offset: 0, brighter: 0 };
        let plane = GroundPlane { down_q16: 1 << 15, across_q16: 0, origin_q16: 0 };
        assert_eq!(likeness.at((8, 10), 320, Some(plane))[..2], [0, 0]);
        assert!(likeness.at((8, 10), 320, None)[0] > 2 << 8);
    }

    #[test]
    fn windows_are_moved_into_the_images() {
        for at in [(0, 0), (31, 23), (0, 23), (31, 0)] {
            for told_q6 in [i16::MIN, 0, i16::MAX] {
                let [.., texture] = compare(|x_q6, _| x_q6 >> 6, [0, 20, 0], at, told_q6);
                assert_eq!(texture, log2_mean_q8(6 * 5, 25), "{at:?}");
            }
        }
    }
}
