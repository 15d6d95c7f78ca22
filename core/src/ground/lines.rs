//! The line of disparity over row that explains most strips, then with roll.
//!
//! ```text
//! image    of each row, at each disparity: the strips' largest gain within 2 px, less their mean, summed
//! lines    disparity at the lowest row every 4 px, horizon (where it is 0) -0.75 to 0.7 heights every
//!          4 rows, slope 0.08 to 2: sum of the image along each
//! again    the best of each of six bands of slope, +-2 px, +-2 rows, with roll of -2 to 2 px per 100:
//!          sum of the strips' own gains within 1 px, less their means
//! ```

use super::GroundPlane;
use super::strips::{MOST_ROWS, MOST_STRIPS, STEP, Strips, WIDTH};
use crate::units::quotient;

/// Slopes at which bands begin, Q16: 0.08, 0.15, 0.25, 0.4, 0.65, 1; the last ends at 2.
const BANDS_Q16: [i32; 7] = [5243, 9830, 16_384, 26_214, 42_598, 65_536, 131_072];
/// Number of bands.
const BANDS: usize = BANDS_Q16.len() - 1;
/// Least disparity at which strips are looked at, px.
const LEAST: i32 = 2;
/// Disparities and rows from one line to the next.
const PITCH: usize = 4;
/// Largest disparity at the lowest row beyond the range, px.
const BEYOND: usize = 64;
/// Roll from one line to the next, px per px, Q16: 0.01.
const ROLL_Q16: i32 = 655;
/// What each 0.01 of roll costs, in gains of 255: 0.05.
const ROLL_COST: i32 = 13;

/// A line of disparity over row, with roll about the middle of the image.
#[derive(Clone, Copy)]
pub(super) struct Line {
    /// Change down the rows, Q16.
    down_q16: i32,
    /// Change along the columns, Q16.
    across_q16: i32,
    /// Row at which it is 0 in the middle of the image.
    horizon: i32,
}

/// A line of the first search: its score, disparity at the lowest row, horizon.
type Candidate = (i32, i32, i32);

/// The best line; `None` without strips or memory.
pub(super) fn best(strips: &mut Strips<'_>) -> Option<Line> {
    let (most, rows) = (strips.most, strips.rows);
    let image = core::mem::take(&mut strips.rest).get_mut(..most * rows)?;
    let own_means = sum_gains(strips, image);
    let candidates = search(strips, image);
    let mut best: Option<(i32, Line)> = None;
    for (_, at_bottom, horizon) in candidates.into_iter().flatten() {
        for (d, h) in [-2, 0, 2].into_iter().flat_map(|d| [-2, 0, 2].map(|h| (d, h))) {
            let Some(down_q16) = slope_q16(strips, at_bottom + d, horizon + h) else { continue };
            for roll in -2..=2 {
                let line = Line { down_q16, across_q16: roll * ROLL_Q16, horizon: horizon + h };
                let score = score(strips, &own_means, line) - ROLL_COST * roll.abs();
                if best.is_none_or(|(most, _)| score > most) {
                    best = Some((score, line));
                }
            }
        }
    }
    best.map(|(_, line)| line)
}

/// Slope of the line through a disparity at the lowest row and 0 at the horizon, Q16.
fn slope_q16(strips: &Strips<'_>, at_bottom: i32, horizon: i32) -> Option<i32> {
    let rows = i32::from(strips.dims.height) - 1 - horizon;
    (rows > 0).then(|| quotient(at_bottom << 16, rows))
}

/// Largest of the entries within `reach`, of each.
fn widest(gains: &[u8], at: usize, reach: usize) -> u8 {
    let near = gains.get(at.saturating_sub(reach)..gains.len().min(at + reach + 1)).unwrap_or(&[]);
    near.iter().copied().max().unwrap_or(0)
}

/// Fills the image with the gains of all strips of a row, less their means, in steps of 16 around 128.
/// Returns the mean of each strip's gains within 1 px.
fn sum_gains(strips: &Strips<'_>, image: &mut [u8]) -> [[u8; MOST_STRIPS]; MOST_ROWS] {
    let mut means = [[0; MOST_STRIPS]; MOST_ROWS];
    for ((row, means), sums) in (0..).zip(&mut means).zip(image.chunks_exact_mut(strips.most.max(1))) {
        let mut total = [0_i32; crate::curve::MAX_DISPARITIES];
        for (index, mean) in means.iter_mut().enumerate().take(strips.strips) {
            let Some((summary, costs)) = strips.strip(row, index) else { continue };
            let mut gains = [0; crate::curve::MAX_DISPARITIES];
            gains.iter_mut().zip(costs).for_each(|(gain, &cost)| *gain = summary.gain(cost));
            let Some(gains) = gains.get(..costs.len()) else { continue };
            let mean_within = |reach: usize| {
                let sum: i32 = (0..gains.len()).map(|at| i32::from(widest(gains, at, reach))).sum();
                quotient(sum, gains.len() as i32)
            };
            *mean = mean_within(1) as u8;
            let mean = mean_within(2);
            for (at, total) in total.iter_mut().enumerate().take(gains.len()) {
                *total += i32::from(widest(gains, at, 2)) - mean;
            }
        }
        sums.iter_mut().zip(total).for_each(|(sum, total)| *sum = ((total >> 4).clamp(-128, 127) + 128) as u8);
    }
    means
}

/// The best line of each band of slopes.
fn search(strips: &Strips<'_>, image: &[u8]) -> [Option<Candidate>; BANDS] {
    let mut best: [Option<Candidate>; BANDS] = [None; BANDS];
    let height = i32::from(strips.dims.height);
    let first = strips.ys().next().unwrap_or(0);
    for at_bottom in (8..(strips.most + BEYOND) as i32).step_by(PITCH) {
        for horizon in (-quotient(3 * height, 4)..quotient(7 * height, 10)).step_by(PITCH) {
            let Some(down_q16) = slope_q16(strips, at_bottom, horizon) else { continue };
            let Some(band) = BANDS_Q16.iter().rposition(|&from_q16| from_q16 <= down_q16) else { continue };
            let (mut d_q16, mut score) = (down_q16 * (first - horizon) + (1 << 15), 0);
            for sums in image.chunks_exact(strips.most.max(1)) {
                let d = d_q16 >> 16;
                if d >= LEAST
                    && let Some(&sum) = sums.get(d as usize)
                {
                    score += i32::from(sum) - 128;
                }
                d_q16 += STEP * down_q16;
            }
            if let Some(best) = best.get_mut(band)
                && best.is_none_or(|(most, ..)| score > most)
            {
                *best = Some((score, at_bottom, horizon));
            }
        }
    }
    best
}

/// Sum of the strips' own gains within 1 px of a line, less their means.
fn score(strips: &Strips<'_>, means: &[[u8; MOST_STRIPS]; MOST_ROWS], line: Line) -> i32 {
    let mut score = 0;
    for ((row, y), means) in (0..).zip(strips.ys()).zip(means) {
        for (index, &mean) in means.iter().enumerate().take(strips.strips) {
            let d = line.at(strips, index, y);
            let Some((summary, costs)) = strips.strip(row, index) else { continue };
            if d >= LEAST && (d as usize) < costs.len().min(index * WIDTH + 1) {
                let lowest = (d - 1..=d + 1).filter_map(|d| costs.get(d as usize)).min().copied();
                score += lowest.map_or(0, |cost| i32::from(summary.gain(cost))) - i32::from(mean);
            }
        }
    }
    score
}

impl Line {
    /// The line as a plane.
    pub(super) fn plane(self, strips: &Strips<'_>) -> GroundPlane {
        let half_width = i32::from(strips.dims.width / 2);
        GroundPlane {
            down_q16: self.down_q16,
            across_q16: self.across_q16,
            origin_q16: -self.down_q16 * self.horizon - self.across_q16 * half_width,
        }
    }

    /// Disparity at a row of the middle of a strip, rounded, px.
    fn at(&self, strips: &Strips<'_>, index: usize, y: i32) -> i32 {
        let from_middle = Strips::middle(index) - i32::from(strips.dims.width / 2);
        (self.down_q16 * (y - self.horizon) + self.across_q16 * from_middle + (1 << 15)) >> 16
    }
}
