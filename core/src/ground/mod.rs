//! The ground plane of a pair: the disparity of the floor that a robot drives on is a plane over
//! the image, steeper down the rows than any window stands.
//!
//! In: both images, before anything is matched, and the plane of the pair before. Out: the plane,
//! if one is seen.
//!
//! ```text
//! d = b y + c x + a        b: baseline / camera height, px per row; c: roll; a: pitch and height
//!
//! strips   pieces of 64 px of every fourth row of the lower 60 %, each searched alone: a single
//!          row knows no slope  (strips)
//! lines    the line of disparity over row on which most strips have their lowest cost   (lines)
//! fit      with roll, then by least squares over the strips near it                     (fit)
//! ```
//! Images wider than 450 px are searched at half of their size.
//!
//! # Cost
//! Some 2.1 M instructions for 320x240 and 64 disparities, 1.1 M where the plane is near that of
//! the pair before (Armv7E-M).
//!
//! # Source
//! Labayrade, Aubert, Tarel 2002 (v-disparity), by strips of single rows instead of a dense map.

mod fit;
mod lines;
mod pose;
mod strips;

use crate::cores::{Cores, lend};
use crate::image::Gray;
pub use pose::{CameraPose, PoseError};
use strips::Strips;

/// Disparity of the floor over the image, `b y + c x + a`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct GroundPlane {
    /// Change of the disparity down the rows, px per row, Q16: baseline / height of the cameras.
    pub down_q16: i32,
    /// Change along the columns, px per column, Q16: roll.
    pub across_q16: i32,
    /// Disparity at the left top pixel, px, Q16.
    pub origin_q16: i32,
}

/// Steepest plane, px per row or column, Q16: a baseline of four times the height.
const STEEPEST_Q16: i32 = 4 << 16;
/// Largest disparity of a plane at the first pixel, px, Q16.
const LARGEST_Q16: i32 = 1 << 29;

impl GroundPlane {
    /// True when its disparity in an image of any accepted size, Q16, fits 32 bits: two slopes of
    /// 2^18 times 1280 px and an origin of 2^29.
    pub(crate) const fn is_bounded(&self) -> bool {
        let Self { down_q16, across_q16, origin_q16 } = *self;
        down_q16.unsigned_abs() <= STEEPEST_Q16 as u32
            && across_q16.unsigned_abs() <= STEEPEST_Q16 as u32
            && origin_q16.unsigned_abs() <= LARGEST_Q16 as u32
    }

    /// Disparity at a pixel, 1/64 px.
    #[must_use]
    pub const fn at_q6(&self, x: i32, y: i32) -> i32 {
        (self.down_q16 * y + self.across_q16 * x + self.origin_q16) >> 10
    }

    /// Change of the disparity over so many columns and rows, 1/64 px.
    pub(crate) const fn change_q6(&self, dx: i32, dy: i32) -> i32 {
        (self.down_q16 * dy + self.across_q16 * dx + (1 << 9)) >> 10
    }

    /// Whole disparity of a row, without roll, px.
    pub(crate) const fn of_row(&self, y: i32) -> i32 {
        (self.down_q16 * y + self.origin_q16 + (1 << 15)) >> 16
    }

    /// Disparity that roll adds at a column, rounded, px.
    pub(crate) const fn of_column(&self, x: i32) -> i32 {
        (self.across_q16 * x + (1 << 15)) >> 16
    }

    /// The same plane in images of twice the size.
    const fn doubled(self) -> Self {
        // Pixel (2 x + 1/2, 2 y + 1/2) has twice the disparity of (x, y).
        let half = (self.down_q16 + self.across_q16) / 2;
        Self { origin_q16: 2 * self.origin_q16 - half, ..self }
    }

    /// The same plane in images of half the size.
    pub(crate) const fn halved(self) -> Self {
        let half = (self.down_q16 + self.across_q16) / 2;
        Self { origin_q16: (self.origin_q16 + half) / 2, ..self }
    }
}

/// Where the ground plane of a pair is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GroundSearch {
    /// Among all planes.
    Everywhere,
    /// Near the plane of the pair before, then among all.
    Near(GroundPlane),
    /// Near the plane where the camera's pose says that it is ([`GroundPlane::of_pose`]); where
    /// none is seen there, that plane is taken.
    Given(GroundPlane),
    /// Nowhere.
    Off,
}

/// Looks for the ground in a pair, whose right rows are `row_offset` rows lower, at disparities
/// below `most`. `None` where none is seen, or `memory` is too small. A second core has memory of
/// its own.
#[inline(never)] // its variables are on the stack only while it runs
pub(crate) fn find(
    mut cores: Option<&mut dyn Cores>,
    others: Option<&mut [u8]>,
    images: [Gray<'_>; 2],
    row_offset: i32,
    most: u16,
    search: GroundSearch,
    memory: &mut [u8],
) -> Option<GroundPlane> {
    let [left, _] = images;
    let half = left.dims().is_large();
    let most = if half { most / 2 } else { most };
    let near = match search {
        GroundSearch::Near(plane) | GroundSearch::Given(plane) => Some(plane),
        GroundSearch::Everywhere => None,
        GroundSearch::Off => return None,
    };
    let near = near.filter(|plane| plane.is_bounded());
    let given = near.filter(|_| matches!(search, GroundSearch::Given(_)));
    let near = near.map(|plane| if half { plane.halved() } else { plane });
    let measured =
        Strips::measure(images, row_offset, half, most.into(), memory, lend(&mut cores), others);
    let seen = measured.and_then(|(strips, memory)| {
        let near = near.and_then(|plane| fit::fit(lend(&mut cores), &strips, plane));
        match given {
            // Beside a shallow plane a strip says less than the pose does.
            Some(_) => near.filter(|plane| plane.down_q16 >= fit::SHALLOW_Q16),
            None => near.or_else(|| {
                lines::best(lend(&mut cores), &strips, memory)
                    .and_then(|line| fit::fit(cores, &strips, line.plane(&strips)))
            }),
        }
    });
    seen.map(|plane| if half { plane.doubled() } else { plane }).or(given)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Dims;

    const DIMS: Dims = Dims { width: 320, height: 240 };
    const PIXELS: usize = 320 * 240;

    /// A floor of this slope from row 80 down, with random columns of 4 px; a wall above.
    fn floor(down_q8: i32) -> [[u8; PIXELS]; 2] {
        let mut state = 7_u32;
        let mut texture = [0_u8; PIXELS];
        for (i, pixel) in texture.iter_mut().enumerate() {
            if i % 4 == 0 {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            }
            *pixel = 60 + (state >> 25) as u8;
        }
        let disparity = |y: i32| (((y - 80).max(4) * down_q8 + 128) >> 8) as usize;
        let right = core::array::from_fn(|i| {
            let (x, y) = (i % 320, i / 320);
            texture
                .get(i + disparity(y as i32))
                .copied()
                .filter(|_| x + disparity(y as i32) < 320)
                .unwrap_or(0)
        });
        [texture, right]
    }

    fn found(images: &[[u8; PIXELS]; 2], before: Option<GroundPlane>) -> Option<GroundPlane> {
        let images = images.each_ref().map(|pixels| Gray::new(pixels, DIMS, 320).unwrap());
        let search = before.map_or(GroundSearch::Everywhere, GroundSearch::Near);
        find(None, None, images, 0, 64, search, &mut [0; 16_384])
    }

    #[test]
    fn a_floor_is_found_near_the_plane_before_and_without_one() {
        let images = floor(102); // 0.4 px per row
        let plane = found(&images, None).unwrap();
        for y in [100, 170, 230] {
            let expected_q6 = (y - 80) * 102 / 4;
            assert!((plane.at_q6(160, y) - expected_q6).abs() < 32, "{y}: {plane:?}");
        }
        let before = GroundPlane { origin_q16: plane.origin_q16 + (2 << 16), ..plane };
        let again = found(&images, Some(before)).unwrap();
        assert!((again.at_q6(160, 230) - plane.at_q6(160, 230)).abs() < 8, "{again:?}");
        // A plane before that is far off is no hindrance.
        let far = GroundPlane { origin_q16: plane.origin_q16 + (30 << 16), ..plane };
        assert_eq!(found(&images, Some(far)), Some(plane));
    }

    #[test]
    fn a_shallow_floor_is_found_and_a_stated_pose_is_taken_as_it_is() {
        let images = floor(20); // 0.078 px per row
        let plane = found(&images, None).unwrap();
        for y in [140, 230] {
            let expected_q6 = (y - 80) * 20 / 4;
            assert!((plane.at_q6(160, y) - expected_q6).abs() < 32, "{y}: {plane:?}");
        }
        let given = GroundPlane { origin_q16: plane.origin_q16 + (1 << 15), ..plane };
        let images = images.each_ref().map(|pixels| Gray::new(pixels, DIMS, 320).unwrap());
        let search = GroundSearch::Given(given);
        let taken = find(None, None, images, 0, 64, search, &mut [0; 16_384]);
        assert_eq!(taken, Some(given));
    }

    #[test]
    fn a_wall_is_no_ground_and_too_little_memory_no_error() {
        assert_eq!(found(&floor(8), None), None);
        let images = floor(102);
        let images = images.each_ref().map(|pixels| Gray::new(pixels, DIMS, 320).unwrap());
        assert_eq!(find(None, None, images, 0, 64, GroundSearch::Everywhere, &mut [0; 64]), None);
    }

    #[test]
    fn the_camera_s_pose_is_taken_where_nothing_is_seen_if_it_fits_the_numbers() {
        let flat = [[90; PIXELS]; 2];
        let images = flat.each_ref().map(|pixels| Gray::new(pixels, DIMS, 320).unwrap());
        let given =
            |plane| find(None, None, images, 0, 64, GroundSearch::Given(plane), &mut [0; 16_384]);
        let plane = GroundPlane { down_q16: 20_000, across_q16: -300, origin_q16: -1_500_000 };
        assert_eq!(given(plane), Some(plane));
        for unbounded in [
            GroundPlane { down_q16: STEEPEST_Q16 + 1, ..plane },
            GroundPlane { across_q16: i32::MIN, ..plane },
            GroundPlane { origin_q16: i32::MAX, ..plane },
        ] {
            assert_eq!(given(unbounded), None);
        }
        // Seen far from where the pose says: the pose is believed.
        let images = floor(102);
        let images = images.each_ref().map(|pixels| Gray::new(pixels, DIMS, 320).unwrap());
        let far = GroundPlane { origin_q16: plane.origin_q16 + (40 << 16), ..plane };
        let found = find(None, None, images, 0, 64, GroundSearch::Given(far), &mut [0; 16_384]);
        assert_eq!(found, Some(far));
    }

    #[test]
    fn half_and_whole_sizes_say_the_same() {
        let plane = GroundPlane { down_q16: 20_000, across_q16: -300, origin_q16: -1_500_000 };
        let half = plane.halved();
        assert_eq!(half.doubled(), plane);
        // Pixel (100, 90) of the half lies between those of the whole at (200.5, 180.5).
        let whole_q6 = (plane.at_q6(200, 180) + plane.at_q6(201, 181)) / 2;
        assert!((2 * half.at_q6(100, 90) - whole_q6).abs() <= 2);
    }
}
