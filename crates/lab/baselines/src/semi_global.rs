//! Semi-global matching: costs gathered along eight straight paths, with a small penalty for steps
//! of disparity and a larger one for jumps.
//!
//! In: a pair. Out: disparities of all pixels that have every disparity in the right image.
//!
//! ```text
//! C(p, d)   = census cost of a window of 5 x 5 px
//! L_r(p, d) = C(p, d) - low + min( L_r(p-r, d), L_r(p-r, d+-1) + STEP, low + JUMP )
//! low       = min_e L_r(p-r, e)
//! S(p, d)   = sum of L_r(p, d) over the directions r
//! ```
//! Half of the directions come in a pass over the rows downwards, half in a pass upwards. Images
//! are continued by their border pixels, so that windows at the border have a cost.
//!
//! # Bounds
//! A cost is at most 25 * 24 = 600, so a path's value at most 840 and the sum of eight 6720.
//!
//! # Cost
//! `4 * width * height * disparities` bytes; about ten operations of 16 bits a path, pixel and
//! disparity.
//!
//! # Source
//! Hirschmueller, "Stereo processing by semiglobal matching and mutual information" (2008), Eqs. 13
//! and 14.

use crate::census::{self, padded};
use crate::curve::{Acceptance, CurveRow};
use crate::{DisparityMap, Search};
use linestereo_frames::GrayImage;

/// Half the side of the window of a pixel's own cost.
const HALF: usize = 2;
/// Penalty of a step by 1 px.
const STEP: i16 = 60;
/// Penalty of a jump.
const JUMP: i16 = 240;
/// Beyond the first and the last disparity: more than any path's value with its penalty.
const GUARD: i16 = 1 << 14;
/// Where paths from the row before come from, relative to a column.
const BEFORE: [isize; 3] = [-1, 0, 1];

/// Every pixel by the lowest sum of its paths, where the right image agrees.
pub(crate) fn match_paths(
    pair: [&GrayImage; 2],
    search: Search,
    least_confidence: f32,
) -> DisparityMap {
    let mut map = DisparityMap::empty(search.dims);
    let stride = search.columns() * search.count;
    if stride == 0 {
        return map;
    }
    let costs = pixel_costs(pair, search);
    let mut sums = vec![0; costs.len()];
    let mut pass = Pass::new(search, true);
    for (costs, sums) in costs.chunks_exact(stride).zip(sums.chunks_exact_mut(stride)) {
        pass.add_row(costs, sums);
    }
    let acceptance = Acceptance { least_confidence, left_right: true };
    let mut pass = Pass::new(search, false);
    for (y, (costs, sums)) in
        costs.chunks_exact(stride).zip(sums.chunks_exact_mut(stride)).enumerate().rev()
    {
        pass.add_row(costs, sums);
        acceptance.fill(
            CurveRow { y, first: search.first(), count: search.count, costs: sums },
            &mut map,
        );
    }
    map
}

/// Cost of each pixel and disparity, row by row.
fn pixel_costs(pair: [&GrayImage; 2], search: Search) -> Vec<i16> {
    let [left, right] = pair.map(|image| padded(image, HALF));
    // The margin gives the windows of the first and last columns and rows room.
    let wide = Search { dims: left.dims, ..search };
    let mut costs = Vec::with_capacity(search.height() * search.columns() * search.count);
    let windows = census::windows([&left, &right], wide, HALF);
    windows.for_each_row(census::hamming, |row| costs.extend_from_slice(row.costs));
    costs
}

/// A path at a pixel.
#[derive(Clone)]
struct Path {
    /// A guard, the value at each disparity, a guard.
    values: Vec<i16>,
    lowest: i16,
}

impl Path {
    /// A path that has not begun.
    fn new(count: usize) -> Self {
        let mut values = vec![0; count + 2];
        values[0] = GUARD;
        values[count + 1] = GUARD;
        Self { values, lowest: 0 }
    }

    /// Goes on from `before` to a pixel of these costs, and adds its values to the sums.
    fn extend(&mut self, before: &Self, costs: &[i16], sums: &mut [i16]) {
        let (count, lowest) = (costs.len(), before.lowest);
        let (below, same, above) =
            (&before.values[..count], &before.values[1..=count], &before.values[2..count + 2]);
        let (values, sums) = (&mut self.values[1..=count], &mut sums[..count]);
        self.lowest = i16::MAX;
        for d in 0..count {
            let stepped = below[d].min(above[d]) + STEP;
            let value = costs[d] + same[d].min(stepped).min(lowest + JUMP) - lowest;
            values[d] = value;
            sums[d] += value;
            self.lowest = self.lowest.min(value);
        }
    }
}

/// Half of the directions: those from the row before, and the one along the row.
struct Pass {
    count: usize,
    /// To the right; else to the left.
    is_rightwards: bool,
    /// For each of [`BEFORE`] the paths in the row before and in this one, between paths that have
    /// not begun.
    paths: [[Vec<Path>; 2]; BEFORE.len()],
}

impl Pass {
    fn new(search: Search, is_rightwards: bool) -> Self {
        let row = vec![Path::new(search.count); search.columns() + 2];
        Self {
            count: search.count,
            is_rightwards,
            paths: BEFORE.map(|_| [row.clone(), row.clone()]),
        }
    }

    /// Adds the paths in the next row to its sums.
    fn add_row(&mut self, costs: &[i16], sums: &mut [i16]) {
        let count = self.count;
        for (offset, [before, here]) in BEFORE.into_iter().zip(&mut self.paths) {
            let pixels = costs.chunks_exact(count).zip(sums.chunks_exact_mut(count));
            for (x, (costs, sums)) in (1_usize..).zip(pixels) {
                here[x].extend(&before[x.wrapping_add_signed(offset)], costs, sums);
            }
            core::mem::swap(before, here);
        }
        let [mut before, mut here] = [Path::new(count), Path::new(count)];
        let step = |(costs, sums): (&[i16], &mut [i16])| {
            here.extend(&before, costs, sums);
            core::mem::swap(&mut before, &mut here);
        };
        let pixels = costs.chunks_exact(count).zip(sums.chunks_exact_mut(count));
        if self.is_rightwards { pixels.for_each(step) } else { pixels.rev().for_each(step) }
    }
}
