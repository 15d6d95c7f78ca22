//! The line of disparity over row that explains most strips, then with roll.
//!
//! ```text
//! of every second row of strips
//! gain     255 at a strip's lowest cost, 0 from half way to the mean on
//! image    of each row, at each disparity: the strips' largest gain within 2 px, less their mean,
//!          summed
//! lines    disparity at the lowest row every 4 px, horizon (where it is 0) -0.75 to 0.7 heights
//!          every 4 rows, slope 0.04 to 2: sum of the image along each
//! again    the best of each of six bands of slope, +-2 px, +-2 rows, then with roll of -2 to 2 px
//!          per 100: sum of the strips' own gains within 1 px, less their means
//! ```

use super::GroundPlane;
use super::strips::{STEP, Strips, Summary, WIDTH};
use crate::cores::{Cores, join, lend};
use crate::curve::MAX_DISPARITIES;
use crate::units::quotient;
use core::ops::Range;

/// Slopes at which bands begin, Q16: 0.04, 0.15, 0.25, 0.4, 0.65, 1; the last ends at 2.
const BANDS_Q16: [i32; 7] = [2621, 9830, 16_384, 26_214, 42_598, 65_536, 131_072];
/// Number of bands.
const BANDS: usize = BANDS_Q16.len() - 1;
/// Least disparity at which strips are looked at, px.
const LEAST: usize = 2;
/// Disparities and rows from one line to the next.
const PITCH: usize = 4;
/// Rows of strips from one to the next that are looked at.
const SKIP: usize = 2;
/// Largest disparity at the lowest row beyond the range, px.
const BEYOND: usize = 64;
/// Roll from one line to the next, px per px, Q16: 0.01.
const ROLL_Q16: i32 = 655;
/// Cost of each 0.01 of roll, in halves of gains of 255: 0.05.
const ROLL_COST: i32 = 6;

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

/// A line with its score.
type Scored = (i32, Line);

/// The best line; `None` without strips or memory.
#[inline(never)] // its variables are on the stack only while it runs
pub(super) fn best(
    mut cores: Option<&mut dyn Cores>,
    strips: &Strips<'_>,
    memory: &mut [u8],
) -> Option<Line> {
    let (most, rows) = (strips.most, strips.rows.div_ceil(SKIP));
    let (gains, memory) = memory.split_at_mut_checked(rows * strips.strips * most)?;
    let image = memory.get_mut(..rows * most)?;
    let above = rows / 2;
    let (upper, lower) = gains.split_at_mut_checked(above * strips.strips * most)?;
    let (sums_above, sums_below) = image.split_at_mut_checked(above * most)?;
    join(
        lend(&mut cores),
        || sum_gains(strips, 0, upper, sums_above),
        || sum_gains(strips, above, lower, sums_below),
    );
    let scored = |line: Line| (score(strips, gains, line), line);
    let of_band = |(_, at_bottom, horizon): Candidate| {
        let around =
            [-2, 0, 2].into_iter().flat_map(|d| [-2, 0, 2].map(|h| (at_bottom + d, horizon + h)));
        let level = around.filter_map(|(at_bottom, horizon)| {
            let down_q16 = slope_q16(strips, at_bottom, horizon)?;
            Some(scored(Line { down_q16, across_q16: 0, horizon }))
        });
        let level = first_best(level)?;
        let rolled = [-2_i32, -1, 1, 2].into_iter().map(|roll| {
            let (score, line) = scored(Line { across_q16: roll * ROLL_Q16, ..level.1 });
            (score - ROLL_COST * roll.abs(), line)
        });
        first_best(core::iter::once(level).chain(rolled))
    };
    let bands = search(lend(&mut cores), strips, image);
    let (steep, steeper) = bands.split_at_checked(BANDS / 2)?;
    let [mut first, mut second] = [None; 2];
    let of_bands = |bands: &[Option<Candidate>]| {
        first_best(bands.iter().flatten().copied().filter_map(of_band))
    };
    join(cores, || first = of_bands(steep), || second = of_bands(steeper));
    first_best([first, second].into_iter().flatten()).map(|(_, line)| line)
}

/// The first of those with the largest score.
fn first_best(lines: impl Iterator<Item = Scored>) -> Option<Scored> {
    lines.reduce(|best, line| if line.0 > best.0 { line } else { best })
}

/// Slope of the line through a disparity at the lowest row and 0 at the horizon, Q16.
fn slope_q16(strips: &Strips<'_>, at_bottom: i32, horizon: i32) -> Option<i32> {
    let rows = i32::from(strips.dims.height) - 1 - horizon;
    (rows > 0).then(|| quotient(at_bottom << 16, rows))
}

/// Sets the gains of a strip, 255 at its lowest cost and 0 from half way to the mean on.
fn set_gains(gains: &mut [u8], summary: Summary, costs: &[u8]) {
    let depth = i32::from(summary.mean) - i32::from(summary.lowest);
    let scale_q8 = quotient(255 << 8, depth.max(1));
    let zero = 2 * i32::from(summary.mean) - depth;
    for (gain, &cost) in gains.iter_mut().zip(costs) {
        *gain = (((zero - 2 * i32::from(cost)).max(0) * scale_q8) >> 8).min(255) as u8;
    }
}

/// The largest of three neighbouring gains in place of each. Returns their mean.
fn widen(gains: &mut [u8]) -> u8 {
    let (mut before, mut sum) = (0, 0_u32);
    let mut here = gains.first().copied().unwrap_or(0);
    for at in 0..gains.len() {
        let after = gains.get(at + 1).copied().unwrap_or(0);
        let largest = here.max(before).max(after);
        sum += u32::from(largest);
        if let Some(gain) = gains.get_mut(at) {
            *gain = largest;
        }
        (before, here) = (here, after);
    }
    sum.checked_div(gains.len() as u32).unwrap_or(0) as u8
}

/// Fills `all` with half of the strips' gains within 1 px, and the image with the sums over each
/// row of the gains within 2 px, in steps of 16; both less their means, signed; of every second row
/// of strips, from row `first` of these on.
fn sum_gains(strips: &Strips<'_>, first: usize, all: &mut [u8], image: &mut [u8]) {
    all.fill(0);
    let most = strips.most.max(1);
    let of_rows =
        all.chunks_exact_mut((strips.strips * most).max(1)).zip(image.chunks_exact_mut(most));
    for (row, (of_row, sums)) in (first..).zip(of_rows) {
        let mut total = [0_i16; MAX_DISPARITIES];
        for (index, own) in of_row.chunks_exact_mut(most).enumerate() {
            let Some((summary, costs)) = strips.strip(row * SKIP, index) else { continue };
            let mut gains = [0; MAX_DISPARITIES];
            let Some(gains) = gains.get_mut(..costs.len()) else { continue };
            set_gains(gains, summary, costs);
            let mean = i16::from(widen(gains));
            for (own, &gain) in own.iter_mut().zip(&*gains) {
                *own = ((i16::from(gain) - mean) >> 1) as u8;
            }
            let mean = i16::from(widen(gains));
            for (total, &gain) in total.iter_mut().zip(&*gains) {
                *total += i16::from(gain) - mean;
            }
        }
        for (at, (sum, total)) in sums.iter_mut().zip(total).enumerate() {
            *sum = if at < LEAST { 0 } else { (total >> 4).clamp(-128, 127) as u8 };
        }
    }
}

/// The best line of each band of slopes.
fn search(
    cores: Option<&mut dyn Cores>,
    strips: &Strips<'_>,
    image: &[u8],
) -> [Option<Candidate>; BANDS] {
    let end = strips.most + BEYOND;
    let middle = 8 + end / 2 / PITCH * PITCH;
    let (mut best, mut others) = ([None; BANDS], [None; BANDS]);
    join(
        cores,
        || best = search_below(strips, image, 8..middle),
        || others = search_below(strips, image, middle..end),
    );
    for (best, other) in best.iter_mut().zip(others) {
        let score = |line: Option<Candidate>| line.map(|(score, ..)| score);
        if score(other) > score(*best) {
            *best = other;
        }
    }
    best
}

/// The same of lines with these disparities at the lowest row.
fn search_below(
    strips: &Strips<'_>,
    image: &[u8],
    at_bottom: Range<usize>,
) -> [Option<Candidate>; BANDS] {
    let mut best: [Option<Candidate>; BANDS] = [None; BANDS];
    let height = i32::from(strips.dims.height);
    for at_bottom in (at_bottom.start as i32..at_bottom.end as i32).step_by(PITCH) {
        for horizon in (-quotient(3 * height, 4)..quotient(7 * height, 10)).step_by(PITCH) {
            let Some(down_q16) = slope_q16(strips, at_bottom, horizon) else { continue };
            let Some(band) = BANDS_Q16.iter().rposition(|&from_q16| from_q16 <= down_q16) else {
                continue;
            };
            let score = sum_along(strips, image, down_q16, horizon);
            if let Some(best) = best.get_mut(band)
                && best.is_none_or(|(most, ..)| score > most)
            {
                *best = Some((score, at_bottom, horizon));
            }
        }
    }
    best
}

/// Sum of the image along a line of this slope, above 0, and horizon.
fn sum_along(strips: &Strips<'_>, image: &[u8], down_q16: i32, horizon: i32) -> i32 {
    let most = strips.most as i32;
    let rows = quotient(image.len() as i32, most);
    let step_q16 = SKIP as i32 * STEP * down_q16;
    let first = strips.ys().next().unwrap_or(0);
    let d_q16 = down_q16 * (first - horizon) + (1 << 15);
    // Rows at which the line is between 0 and the largest disparity.
    let start = quotient(step_q16 - 1 - d_q16, step_q16).max(0);
    let end = quotient((most << 16) - d_q16 + step_q16 - 1, step_q16).min(rows);
    let mut at_q16 = d_q16 + start * (step_q16 + (most << 16));
    let mut score = 0;
    for _ in start..end {
        score += i32::from(image.get((at_q16 >> 16) as usize).copied().unwrap_or(0) as i8);
        at_q16 += step_q16 + (most << 16);
    }
    score
}

/// Sum of the strips' own gains within 1 px of a line, less their means, in halves.
fn score(strips: &Strips<'_>, gains: &[u8], line: Line) -> i32 {
    let most = strips.most.max(1);
    let mut score = 0;
    for (y, gains) in
        strips.ys().step_by(SKIP).zip(gains.chunks_exact((strips.strips * most).max(1)))
    {
        let mut d_q16 = line.at_q16(strips, y);
        for gains in gains.chunks_exact(most) {
            let d = (d_q16 >> 16) as usize;
            if d >= LEAST {
                score += i32::from(gains.get(d).copied().unwrap_or(0) as i8);
            }
            d_q16 += line.across_q16 * WIDTH as i32;
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

    /// Disparity at a row of the middle of the first strip, and a half, Q16.
    fn at_q16(&self, strips: &Strips<'_>, y: i32) -> i32 {
        let from_middle = Strips::middle(0) - i32::from(strips.dims.width / 2);
        self.down_q16 * (y - self.horizon) + self.across_q16 * from_middle + (1 << 15)
    }
}
