//! Strips: pieces of single rows, each compared with the other image alone.
//!
//! ```text
//! step     I(x + 3) - I(x - 3), limited to +-63 levels
//! cost     1/32 of the sum over 64 columns of |step - step|, at each disparity with the strip in
//!          view
//! a strip counts with 12 disparities in view, its lowest cost below 3/4 of their mean, and a mean
//! of 2 levels a pixel
//! ```
//!
//! # Bounds
//! A cost is at most 64 * 126 / 32 = 252.

use crate::cores::Cores;
use crate::curve::MAX_DISPARITIES;
use crate::image::{Dims, Gray, MAX_WIDTH, WIDEST, halve_rows};
use crate::kernel::{LANES, STRIP, Strip, limited_steps, sad_curve};
use crate::units::quotient;

/// Width of a strip, px.
pub(super) const WIDTH: usize = 64;
/// Rows from one with strips to the next.
pub(super) const STEP: i32 = 4;
/// Most strips of a row.
pub(super) const MOST_STRIPS: usize =
    if MAX_WIDTH / 2 > WIDEST { MAX_WIDTH / 2 } else { WIDEST } as usize / WIDTH;
/// Distance of the pixels that a step compares from its own, px.
const REACH: usize = 3;
/// Largest step, grey levels.
const MOST_STEP: u8 = 63;
/// Least number of disparities in view.
const FEWEST: usize = 12;
/// Least mean cost: 2 levels a pixel.
const LEAST_MEAN: u32 = 2 * WIDTH as u32 / 32;

/// Bytes of a strip before its costs: the lowest and the mean.
const HEAD: usize = 2;

/// Lowest cost and mean of a strip; a mean of 0 where it does not count.
#[derive(Clone, Copy)]
pub(super) struct Summary {
    pub(super) lowest: u8,
    pub(super) mean: u8,
}

/// Costs of all strips of a pair, and of each the lowest and the mean.
pub(super) struct Strips<'m> {
    pub(super) dims: Dims,
    /// Disparities of a strip.
    pub(super) most: usize,
    pub(super) rows: usize,
    pub(super) strips: usize,
    /// Lowest, mean and costs of each.
    costs: &'m [u8],
}

impl<'m> Strips<'m> {
    /// Compares the strips of a pair, or of the pair at half of its size, at disparities below
    /// `most`, or at as many as `memory` holds with the search of lines. Returns them with the
    /// memory that is left. A second core has memory of its own.
    #[inline(never)] // its variables are on the stack only while it runs
    pub(super) fn measure(
        images: [Gray<'_>; 2],
        row_offset: i32,
        half: bool,
        most: usize,
        memory: &'m mut [u8],
        cores: Option<&mut dyn Cores>,
        others: Option<&mut [u8]>,
    ) -> Option<(Self, &'m mut [u8])> {
        let [left, right] = images;
        let full = left.dims();
        let dims =
            if half { Dims { width: full.width / 2, height: full.height / 2 } } else { full };
        let width = usize::from(dims.width);
        let first = Self::first_row(dims);
        let rows = quotient(i32::from(dims.height) - first + STEP - 1, STEP).max(0) as usize;
        let strips = width / WIDTH;
        if strips > MOST_STRIPS || strips == 0 {
            return None;
        }
        let (of_row, memory) = memory.split_at_mut_checked(3 * width)?;
        let second = cores.zip(others.and_then(|memory| memory.get_mut(..3 * width)));
        let share = memory.len().checked_div(rows)?.checked_sub(HEAD * strips)?;
        let most = most.min(share.checked_div(2 * strips + 1)?).min(MAX_DISPARITIES);
        let (costs, rest) = memory.split_at_mut_checked(rows * strips * (HEAD + most))?;
        costs.fill(0);
        let measure = |first: i32, costs: &mut [u8], of_row: &mut [u8]| {
            let mut parts = of_row.chunks_exact_mut(width.max(1));
            let (Some(left_steps), Some(right_steps), Some(levels)) =
                (parts.next(), parts.next(), parts.next())
            else {
                return;
            };
            let ys = (first..).step_by(STEP as usize);
            for (y, costs) in ys.zip(costs.chunks_exact_mut((strips * (HEAD + most)).max(1))) {
                if steps(left, y, 0, half.then_some(&mut *levels), left_steps)
                    && steps(right, y, row_offset, half.then_some(&mut *levels), right_steps)
                {
                    measure_row([left_steps, right_steps], most, costs);
                }
            }
        };
        let above = rows / 2;
        if let Some((cores, others)) = second
            && let Some((upper, lower)) = costs.split_at_mut_checked(above * strips * (HEAD + most))
        {
            let next = first + above as i32 * STEP;
            cores.join(&mut || measure(first, upper, of_row), &mut || {
                measure(next, lower, others);
            });
        } else {
            measure(first, costs, of_row);
        }
        Some((Self { dims, most, rows, strips, costs }, rest))
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

    /// A strip, with its costs at the disparities in view; `None` if it does not count.
    pub(super) fn strip(&self, row: usize, strip: usize) -> Option<(Summary, &[u8])> {
        let (&[lowest, mean], costs) = self
            .costs
            .get((row * self.strips + strip) * (HEAD + self.most)..)?
            .split_first_chunk::<HEAD>()?;
        let costs = costs.get(..self.most.min(strip * WIDTH))?;
        (mean > 0).then_some((Summary { lowest, mean }, costs))
    }
}

/// Compares the strips of a row, by the steps of both images.
fn measure_row([left, right]: [&[u8]; 2], most: usize, costs: &mut [u8]) {
    for (start, strip) in (0..).step_by(WIDTH).zip(costs.chunks_exact_mut(HEAD + most)) {
        let Some(([lowest, mean], costs)) = strip.split_first_chunk_mut::<HEAD>() else { break };
        if let Some(costs) = costs.get_mut(..most.min(start)) {
            compare(left, right, start, costs);
            let summary = summarize(costs);
            (*lowest, *mean) = (summary.lowest, summary.mean);
        }
    }
}

/// Sets the steps of a row of an image, or, with memory for its levels, of its half; false outside
/// of it.
fn steps(
    image: Gray<'_>,
    y: i32,
    offset: i32,
    levels: Option<&mut [u8]>,
    steps: &mut [u8],
) -> bool {
    let row = |y: i32| usize::try_from(y + offset).ok().and_then(|y| image.row(y));
    let Some(levels) = levels else { return row(y).is_some_and(|row| differences(row, steps)) };
    let [Some(upper), Some(lower)] = [2 * y, 2 * y + 1].map(row) else { return false };
    halve_rows(upper, lower, levels);
    differences(levels, steps)
}

/// Sets the steps of a row of pixels.
fn differences(row: &[u8], steps: &mut [u8]) -> bool {
    steps.fill(MOST_STEP); // a step of 0
    let inside = row.len().checked_sub(REACH).and_then(|end| steps.get_mut(REACH..end));
    let (Some(inside), Some(after)) = (inside, row.get(2 * REACH..)) else { return false };
    limited_steps(row, after, MOST_STEP, inside);
    true
}

/// Sets the costs of the strip that begins at this column, disparities rising from 0.
fn compare(left: &[u8], right: &[u8], start: usize, costs: &mut [u8]) {
    // Whole blocks, in which disparities fall; they are in view, as strips begin at multiples of
    // blocks.
    let length = costs.len().next_multiple_of(LANES);
    let first = start.saturating_sub(length) + 1;
    let mut curve = [0; MAX_DISPARITIES];
    let Some(curve) = curve.get_mut(..length) else { return };
    let own = left.get(start..).unwrap_or(&[]).as_chunks::<STRIP>().0;
    let mut pieces = [Strip { reference: [0; STRIP], other: &[] }; WIDTH / STRIP];
    for ((piece, own), k) in pieces.iter_mut().zip(own).zip((0..).step_by(STRIP)) {
        let other = right.get(first + k..first + k + length + STRIP - 1).unwrap_or(&[]);
        *piece = Strip { reference: *own, other };
    }
    sad_curve(&pieces, curve);
    for (cost, sum) in costs.iter_mut().zip(curve.iter().rev()) {
        *cost = (sum >> 5) as u8;
    }
}

fn summarize(costs: &[u8]) -> Summary {
    let lowest = costs.iter().copied().min().unwrap_or(0);
    let sum: u32 = costs.iter().map(|&cost| u32::from(cost)).sum();
    let mean = sum.checked_div(costs.len() as u32).unwrap_or(0);
    let counts = costs.len() >= FEWEST && 4 * u32::from(lowest) < 3 * mean && mean > LEAST_MEAN;
    Summary { lowest, mean: if counts { mean as u8 } else { 0 } }
}
