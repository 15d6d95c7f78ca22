//! Dynamic programming along scan lines with occlusion: the best row as a whole instead of the best pixel.
//!
//! In: costs of windows. Out: disparities and the pixels that the right image does not see.
//!
//! ```text
//! a row's path visits its left columns in order; column x is matched at disparity d, or hidden; right column = x - d
//! matched(x, d) = cost(x, d) + min( state(x - 1, d),                   same surface
//!                                   state(x - 1, d - 1 or d + 1) + slope,
//!                                   state(x - 1, e > d) + jump )       what is farther begins: right columns alone are hidden
//! hidden(x, d)  = state(x - 1, d - 1) + hidden                         the right column stays while the left one moves on
//! ```
//! `state` is the lower of `matched` and `hidden`. What is nearer by k px hides k left columns before it, as geometry demands.
//!
//! # Bounds
//! States are kept relative to their lowest one and costs are capped at [`LARGEST_COST`]: far below 2^32.
//!
//! # Cost
//! Four comparisons a column and disparity, two bytes each to remember the way.
//!
//! # Source
//! Bobick and Intille, "Large occlusion stereo" (1999); Cox et al., "A maximum likelihood stereo algorithm" (1996).

use super::cost::CostKind;
use super::curve::{Fraction, Minimum};
use super::map::DisparityMap;
use super::search::Search;
use super::sums::{CurveRow, for_each_row};
use super::window::Window;
use linestereo_frames::GrayImage;

/// Costs of windows are scaled so that this is their mean over a row; penalties are in the same unit.
const MEAN_COST: f32 = 256.0;
/// A single column never costs more.
const LARGEST_COST: f32 = 65_536.0;
/// In a remembered way: the column is hidden.
const HIDDEN: u16 = 1 << 15;

/// The matcher; penalties in 1/256 of the mean cost of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanLineMatcher {
    /// Matching cost of two windows.
    pub cost: CostKind,
    /// The window.
    pub window: Window,
    /// Of a step by 1 px.
    pub slope: u32,
    /// Of a hidden column.
    pub hidden: u32,
    /// Of a fall to what is farther.
    pub jump: u32,
    /// Least confidence of a reported disparity, 0 to 1: its cost against the best elsewhere.
    pub least_confidence: f32,
}

impl Default for ScanLineMatcher {
    fn default() -> Self {
        let (cost, window) = (CostKind::Census, Window::square(5));
        Self { cost, window, slope: 64, hidden: 160, jump: 256, least_confidence: f32::NEG_INFINITY }
    }
}

impl ScanLineMatcher {
    /// Matches a pair. The confidence of a pixel is that of its own curve at the path's disparity.
    #[must_use]
    pub fn run(&self, left: &GrayImage, right: &GrayImage, search: Search) -> DisparityMap {
        let mut map = DisparityMap::empty(left.dims);
        let cost = self.cost.of(left, right, &self.window, search);
        let mut path = Path::default();
        for_each_row(&*cost, search, &self.window, |row| {
            path.find(row, self);
            path.write(row, self.least_confidence, &mut map);
        });
        map
    }
}

/// The best path of a row, with the memory to find it.
#[derive(Default)]
struct Path {
    /// Of each column and disparity the disparity that the path came from, and [`HIDDEN`].
    ways: Vec<u16>,
    state: Vec<u32>,
    next: Vec<u32>,
    /// Of each column its disparity, and whether it is hidden.
    found: Vec<(usize, bool)>,
}

impl Path {
    fn find(&mut self, row: CurveRow<'_>, penalties: &ScanLineMatcher) {
        let count = row.count;
        let mean = row.costs.iter().map(|&cost| cost as f32).sum::<f32>() / row.costs.len() as f32;
        let scale = MEAN_COST / mean.max(1.0);
        self.ways.clear();
        self.ways.resize(row.costs.len(), 0);
        self.state.clear();
        self.state.resize(count, 0);
        self.next.resize(count, 0);
        for ((_, curve), ways) in row.curves().zip(self.ways.chunks_exact_mut(count)) {
            step(&self.state, curve, scale, penalties, ways, &mut self.next);
            core::mem::swap(&mut self.state, &mut self.next);
        }
        self.trace(row.costs.len() / count, count);
    }

    /// Back from the best end.
    fn trace(&mut self, columns: usize, count: usize) {
        self.found.clear();
        self.found.resize(columns, (0, false));
        let low = self.state.iter().copied().min().unwrap_or(0);
        let mut d = self.state.iter().position(|&state| state == low).unwrap_or(0);
        for (i, found) in self.found.iter_mut().enumerate().rev() {
            let way = self.ways[i * count + d];
            *found = (d, way & HIDDEN != 0);
            d = usize::from(way & !HIDDEN);
        }
    }

    fn write(&self, row: CurveRow<'_>, least_confidence: f32, map: &mut DisparityMap) {
        for ((x, curve), &(d, hidden)) in row.curves().zip(&self.found) {
            let minimum = Minimum::at(curve, d);
            if hidden {
                map.mark_occluded(x, row.y);
            } else if minimum.confidence() >= least_confidence {
                map.set(x, row.y, minimum.refined(curve, Fraction::Equiangular), minimum.confidence().max(0.0));
            }
        }
    }
}

/// One column: `state` of the one before to `next`.
fn step(state: &[u32], curve: &[u32], scale: f32, penalties: &ScanLineMatcher, ways: &mut [u16], next: &mut [u32]) {
    let low = state.iter().copied().min().unwrap_or(0);
    let relative = |d: usize| state.get(d).map_or(u32::MAX / 2, |&state| state - low);
    // The best farther ones are those that were visited before: from the largest disparity down.
    let (mut fall, mut fall_from) = (u32::MAX / 2, 0);
    for d in (0..state.len()).rev() {
        let (same, above, below) = (relative(d), relative(d + 1), relative(d.wrapping_sub(1)));
        let (mut best, mut from) = (same, d);
        for (value, origin) in [
            (above + penalties.slope, d + 1),
            (below + penalties.slope, d.wrapping_sub(1)),
            (fall + penalties.jump, fall_from),
        ] {
            if value < best {
                (best, from) = (value, origin);
            }
        }
        let matched = best + (curve[d] as f32 * scale).min(LARGEST_COST) as u32;
        let hidden = below + penalties.hidden;
        (next[d], ways[d]) = if hidden < matched { (hidden, (d - 1) as u16 | HIDDEN) } else { (matched, from as u16) };
        if same < fall {
            (fall, fall_from) = (same, d);
        }
    }
}
