//! Block matching as OpenCV's StereoBM does it, number for number: the rival that users know.
//!
//! In: a pair. Out: disparities in 1/16 px where texture and uniqueness allow.
//!
//! ```text
//! values  = Sobel along the row, clipped to +-31, plus 31     first and last column, an odd last row: 31
//! cost    = sum of absolute differences of the values over 15 x 15 px
//! best    = the lowest cost, the largest disparity of equals
//! texture = sum of abs(value - 31) over the window >= threshold
//! unique  = every cost more than 1 px from the best > best + best * ratio / 100
//! result  = best + (before - after) / (2 (max(before, after) - best cost))
//!           in 1/256 px, plus 15 and halved four times
//! ```
//!
//! # Source
//! OpenCV, `calib3d/stereobm.cpp` (Konolige's block matcher). `tests/tests/opencv.rs` compares maps
//! with those of the installed one.

use crate::curve::Minimum;
use crate::windows::{BLOCK_HALF, Windows};
use crate::{DisparityMap, Search};
use linestereo_frames::GrayImage;

/// Largest step of a gradient.
const CAP: u8 = 31;

/// The block matcher.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StereoBm {
    /// Least sum of `abs(value - 31)` over a window.
    pub texture_threshold: u16,
    /// Percent by which every other cost has to be above the lowest.
    pub uniqueness_ratio: u16,
}

impl Default for StereoBm {
    /// OpenCV's defaults.
    fn default() -> Self {
        Self { texture_threshold: 10, uniqueness_ratio: 15 }
    }
}

impl StereoBm {
    /// Strict settings: uniqueness 90 and texture 3000.
    #[must_use]
    pub fn strict() -> Self {
        Self { texture_threshold: 3000, uniqueness_ratio: 90 }
    }

    /// Matches a pair.
    ///
    /// # Panics
    /// When the images differ in size.
    #[must_use]
    pub fn run(&self, left: &GrayImage, right: &GrayImage, search: Search) -> DisparityMap {
        let mut map = DisparityMap::empty(search.dims);
        let [left, right] = [left, right].map(prefiltered);
        let texture = texture(&left, search);
        Windows::new(search, BLOCK_HALF, [left, right]).for_each_row(u8::abs_diff, |row| {
            for (x, curve) in row.curves() {
                if i32::from(texture[row.y * search.width() + x])
                    >= i32::from(self.texture_threshold)
                    && let Some((disparity, confidence)) = self.best(curve)
                {
                    map.set(x, row.y, disparity, confidence);
                }
            }
        });
        map
    }

    /// The disparity in px and its confidence, if it is unique.
    fn best(&self, curve: &[i16]) -> Option<(f32, f32)> {
        let minimum = Minimum::of(curve);
        let (cost, second) = (i32::from(minimum.cost), i32::from(minimum.second));
        if self.uniqueness_ratio > 0
            && second <= cost + cost * i32::from(self.uniqueness_ratio) / 100
        {
            return None;
        }
        let fraction = minimum.neighbours(curve).map_or(0, |neighbours| {
            let [before, after] = neighbours.map(i32::from);
            (before - after) * 256 / (2 * (before.max(after) - cost))
        });
        let sixteenths = (minimum.disparity as i32 * 256 + fraction + 15) >> 4;
        Some((sixteenths as f32 / 16.0, minimum.confidence()))
    }
}

/// Sum of `abs(value - CAP)` over the window around each pixel, 0 where it leaves the image.
fn texture(values: &[u8], search: Search) -> Vec<i16> {
    let mut texture = vec![0; values.len()];
    // The cost of one disparity against an image without any.
    let windows = Windows::new(
        Search { count: 1, ..search },
        BLOCK_HALF,
        [values.to_vec(), vec![CAP; values.len()]],
    );
    windows.for_each_row(u8::abs_diff, |row| {
        texture[row.y * search.width() + row.first..][..row.costs.len()].copy_from_slice(row.costs);
    });
    texture
}

/// Sobel along the row, clipped, in OpenCV's order of rows.
fn prefiltered(image: &GrayImage) -> Vec<u8> {
    let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
    let mut values = vec![CAP; width * height];
    let row = |y: usize| &image.pixels[y * width..(y + 1) * width];
    let cap = i32::from(CAP);
    // Rows are filtered in pairs: an odd one at the end is left alone.
    for y in 0..height & !1 {
        let above = row(if y > 0 { y - 1 } else { 1 });
        let below = row(if y + 1 < height { y + 1 } else { y - 1 });
        let (here, out) = (row(y), &mut values[y * width..(y + 1) * width]);
        for x in 1..width - 1 {
            let step = |row: &[u8]| i32::from(row[x + 1]) - i32::from(row[x - 1]);
            out[x] = ((step(above) + 2 * step(here) + step(below)).clamp(-cap, cap) + cap) as u8;
        }
    }
    values
}
