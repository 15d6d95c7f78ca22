//! Strips: pieces of single rows, each compared with the other image alone.
//!
//! ```text
//! step     I(x + 3) - I(x - 3), limited to +-63 levels
//! cost     1/32 of the sum over 64 columns of |step - step|, at each disparity with the strip in view
//! a strip counts with 12 disparities in view, its lowest cost below 3/4 of their mean, and a mean of 2
//! levels a pixel
//! gain     255 at its lowest cost, 0 from half way to the mean on
//! ```
//!
//! # Bounds
//! A cost is at most 64 * 126 / 32 = 252.

use crate::image::{Dims, Gray};
use crate::units::quotient;

/// Width of a strip, px.
pub(super) const WIDTH: usize = 64;
/// Rows from one with strips to the next.
pub(super) const STEP: i32 = 4;
/// Most rows with strips.
pub(super) const MOST_ROWS: usize = 80;
/// Most strips of a row.
pub(super) const MOST_STRIPS: usize = 10;
/// Distance of the pixels that a step compares from its own, px.
const REACH: usize = 3;
/// Largest step, grey levels.
const MOST_STEP: i16 = 63;
/// Least number of disparities in view.
const FEWEST: usize = 12;
/// Least mean cost: 2 levels a pixel.
const LEAST_MEAN: u32 = 2 * WIDTH as u32 / 32;
/// Cost of a disparity that is not in view.
const UNSEEN: u8 = u8::MAX;

/// Lowest cost and mean of a strip; a mean of 0 where it does not count.
#[derive(Clone, Copy, Default)]
pub(super) struct Summary {
    pub(super) lowest: u8,
    pub(super) mean: u8,
}

impl Summary {
    pub(super) fn counts(self) -> bool {
        self.mean > 0
    }

    /// Gain of a cost, 0 ..= 255.
    pub(super) fn gain(self, cost: u8) -> u8 {
        let (cost, lowest, mean) = (i32::from(cost), i32::from(self.lowest), i32::from(self.mean));
        quotient((2 * (mean - cost) - (mean - lowest)).max(0) * 255, (mean - lowest).max(1)).min(255) as u8
    }
}

/// Costs of all strips of a pair, and of each the lowest and the mean.
pub(super) struct Strips<'m> {
    pub(super) dims: Dims,
    pub(super) most: usize,
    pub(super) rows: usize,
    pub(super) strips: usize,
    summaries: [[Summary; MOST_STRIPS]; MOST_ROWS],
    costs: &'m [u8],
    /// Memory that is left.
    pub(super) rest: &'m mut [u8],
}

impl<'m> Strips<'m> {
    /// Compares the strips of a pair, or of the pair at half of its size, at disparities below `most`.
    pub(super) fn measure(
        images: [Gray<'_>; 2],
        row_offset: i32,
        (half, most): (bool, usize),
        memory: &'m mut [u8],
    ) -> Option<Self> {
        let [left, _] = images;
        let full = left.dims();
        let dims = if half { Dims { width: full.width / 2, height: full.height / 2 } } else { full };
        let first = Self::first_row(dims);
        let rows = quotient(i32::from(dims.height) - first + STEP - 1, STEP).max(0) as usize;
        let strips = usize::from(dims.width) / WIDTH;
        if rows > MOST_ROWS || strips > MOST_STRIPS || strips == 0 {
            return None;
        }
        let (costs, rest) = memory.split_at_mut_checked(rows * strips * most)?;
        costs.fill(UNSEEN);
        let mut summaries = [[Summary::default(); MOST_STRIPS]; MOST_ROWS];
        let of_rows = costs.chunks_exact_mut((strips * most).max(1));
        for ((row, summaries), costs) in (0..).zip(&mut summaries).zip(of_rows) {
            let y = first + row * STEP;
            let [Some(left), Some(right)] = [(0, 0), (1, row_offset)].map(|(which, offset)| {
                let image = *images.get(which)?;
                steps(image, (y, offset), half)
            }) else {
                continue;
            };
            let of_strips = costs.chunks_exact_mut(most.max(1));
            for ((start, summary), costs) in (0..).step_by(WIDTH).zip(summaries).zip(of_strips) {
                let Some(own) = left.get(start..).and_then(<[i8]>::first_chunk::<WIDTH>) else { break };
                for (cost, d) in costs.iter_mut().zip(0..=start) {
                    let other = right.get(start - d..).and_then(<[i8]>::first_chunk::<WIDTH>);
                    *cost = other.map_or(UNSEEN, |other| difference(own, other));
                }
                *summary = summarize(costs.get(..(start + 1).min(most)).unwrap_or(&[]));
            }
        }
        Some(Self { dims, most, rows, strips, summaries, costs, rest })
    }

    /// First row with strips.
    fn first_row(dims: Dims) -> i32 {
        // 0.4 of the height.
        quotient(quotient(2 * i32::from(dims.height), 5), STEP) * STEP + STEP / 2
    }

    /// Rows with strips.
    pub(super) fn ys(&self) -> impl Iterator<Item = i32> + use<> {
        let first = Self::first_row(self.dims);
        (0..self.rows as i32).map(move |row| first + row * STEP)
    }

    /// Middle of a strip, px.
    pub(super) const fn middle(strip: usize) -> i32 {
        (strip * WIDTH + WIDTH / 2) as i32
    }

    /// A strip, with its costs at the disparities in view.
    pub(super) fn strip(&self, row: usize, strip: usize) -> Option<(Summary, &[u8])> {
        let summary = *self.summaries.get(row)?.get(strip)?;
        let start = (row * self.strips + strip) * self.most;
        let costs = self.costs.get(start..start + self.most.min(strip * WIDTH + 1))?;
        summary.counts().then_some((summary, costs))
    }
}

/// Steps of a row of an image, or of its half; `None` outside of it.
fn steps(image: Gray<'_>, (y, offset): (i32, i32), half: bool) -> Option<[i8; 640]> {
    let mut levels = [0_i16; 640];
    if half {
        let rows = [2 * y + offset, 2 * y + 1 + offset];
        let [Some(upper), Some(lower)] = rows.map(|y| image.row(usize::try_from(y).ok()?)) else { return None };
        let pairs = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
        for (level, ([a, b], [c, d])) in levels.iter_mut().zip(pairs) {
            *level = (i16::from(*a) + i16::from(*b) + i16::from(*c) + i16::from(*d) + 2) >> 2;
        }
    } else {
        let row = image.row(usize::try_from(y + offset).ok()?)?;
        levels.iter_mut().zip(row).for_each(|(level, &pixel)| *level = pixel.into());
    }
    let width = usize::from(image.dims().width) >> u32::from(half);
    let levels = levels.get(..width)?;
    let mut steps = [0; 640];
    let inside = steps.get_mut(REACH..width.checked_sub(REACH)?)?;
    for (step, (before, after)) in inside.iter_mut().zip(levels.iter().zip(levels.get(2 * REACH..)?)) {
        *step = (after - before).clamp(-MOST_STEP, MOST_STEP) as i8;
    }
    Some(steps)
}

/// 1/32 of the sum of the differences of two strips.
fn difference(own: &[i8; WIDTH], other: &[i8; WIDTH]) -> u8 {
    let sum: u16 = own.iter().zip(other).map(|(own, other)| u16::from(own.abs_diff(*other))).sum();
    (sum >> 5) as u8
}

fn summarize(costs: &[u8]) -> Summary {
    let lowest = costs.iter().copied().min().unwrap_or(0);
    let sum: u32 = costs.iter().map(|&cost| u32::from(cost)).sum();
    let mean = sum.checked_div(costs.len() as u32).unwrap_or(0);
    let counts = costs.len() >= FEWEST && 4 * u32::from(lowest) < 3 * mean && mean > LEAST_MEAN;
    Summary { lowest, mean: if counts { mean as u8 } else { 0 } }
}
