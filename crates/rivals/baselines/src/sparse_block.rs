//! TU Delft's sparse block matching, as it flies on a stereo board of 4 grams: a value where a row has a peak of its gradient.
//!
//! In: a pair. Out: disparities in 1/6 px at the peaks.
//!
//! ```text
//! peak   = abs(I(x) - I(x + 1)) above the threshold and above both neighbours'
//! cost   = sum of absolute differences over 5 x 5 px at every disparity
//! unique = second * 100 / best > ratio        second: the lowest cost more than 1 px from the best
//! result = vertex of a parabola through the costs around the best
//! ```
//!
//! # Cost
//! 25 differences a disparity at each peak, nothing elsewhere.
//!
//! # Source
//! `stereo_vision_sparse_block` of the TU Delft stereo board's firmware; McGuire et al., "Efficient optical flow and stereo vision for
//! velocity estimation and obstacle avoidance on an autonomous pocket drone" (2017). There, the two halves of the picture are matched
//! from different sides, for columns without a whole range; here every baseline leaves these columns out.

use super::curve::{Fraction, Minimum};
use super::map::DisparityMap;
use super::search::Search;
use linestereo_frames::GrayImage;

/// Half the side of the window.
const HALF: usize = 2;
/// Steps of a disparity in one px.
const RESOLUTION: f32 = 6.0;

/// The matcher.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SparseBlockMatcher {
    /// A peak's step is above this, grey levels.
    pub gradient: u8,
    /// The second cost is above so many percent of the best.
    pub peak_ratio: u32,
}

impl Default for SparseBlockMatcher {
    fn default() -> Self {
        Self { gradient: 20, peak_ratio: 140 }
    }
}

impl SparseBlockMatcher {
    /// Matches a pair.
    #[must_use]
    pub fn run(&self, left: &GrayImage, right: &GrayImage, search: Search) -> DisparityMap {
        let mut map = DisparityMap::empty(left.dims);
        let (width, height) = (search.width(), search.height());
        let mut curve = vec![0_u32; search.count];
        for y in HALF..height.saturating_sub(HALF) {
            let row = &left.pixels[y * width..(y + 1) * width];
            let step = |x: usize| row[x].abs_diff(row[x + 1]);
            for x in search.first() + HALF..width.saturating_sub(HALF) {
                let here = step(x);
                if here <= self.gradient || here <= step(x - 1) || here <= step(x + 1) {
                    continue;
                }
                block_costs(left, right, (x, y), &mut curve);
                let minimum = Minimum::of(&curve);
                // A cost of 0 is a match without a fault: unique unless the second is 0 as well.
                let unique = u64::from(minimum.second) * 100 > u64::from(minimum.cost) * u64::from(self.peak_ratio);
                if unique {
                    let disparity = minimum.refined(&curve, Fraction::Parabola);
                    map.set(x, y, (disparity * RESOLUTION).round() / RESOLUTION, minimum.confidence());
                }
            }
        }
        map
    }
}

fn block_costs(left: &GrayImage, right: &GrayImage, (x, y): (usize, usize), curve: &mut [u32]) {
    let width = usize::from(left.dims.width);
    for (d, cost) in curve.iter_mut().enumerate() {
        let row = |y: usize| {
            let start = y * width + x - HALF;
            let (left, right) =
                (&left.pixels[start..=start + 2 * HALF], &right.pixels[start - d..=start - d + 2 * HALF]);
            left.iter().zip(right).map(|(l, r)| u32::from(l.abs_diff(*r))).sum::<u32>()
        };
        *cost = (y - HALF..=y + HALF).map(row).sum();
    }
}
