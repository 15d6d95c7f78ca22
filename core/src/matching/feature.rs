//! Directed feature matching: the edge with the same properties in the right image, at the disparity of the window.
//!
//! In: the line of a left segment, the disparity of its window, the band of rows. Out: the disparity by the edge itself, sub-pixel. Evidence,
//! not a requirement: an edge between two surfaces may have another gradient in the right image.
//!
//! # Cost
//! Some 130 instructions a row, at most [`FEATURE_ROWS`] a segment.

use super::band::{Band, SampledRows};
use crate::kernel::FLAT;
use crate::lines::Segment;
use crate::units::quotient;

/// A line x(y) in 1/32 px with its row range.
#[derive(Clone, Copy)]
pub(crate) struct SteepLine {
    x0: i32,
    y0: i32,
    y1: i32,
    /// dx/dy, Q12.
    slope_q12: i32,
}

impl SteepLine {
    pub(crate) fn new(segment: &Segment) -> Self {
        let (mut x0, mut y0, mut x1, mut y1) = segment.ends_q5();
        if y0 > y1 {
            (x0, y0, x1, y1) = (x1, y1, x0, y0);
        }
        let slope_q12 = quotient((x1 - x0) << 12, y1 - y0).clamp(-(8 << 12), 8 << 12);
        Self { x0, y0, y1, slope_q12 }
    }

    pub(crate) fn slope_q12(&self) -> i32 {
        self.slope_q12
    }

    /// First and last whole row.
    pub(crate) fn rows(&self) -> (i32, i32) {
        ((self.y0 + 31) >> 5, self.y1 >> 5)
    }

    /// x at a row given in 1/32 px, in 1/32 px.
    pub(crate) fn x_q5(&self, y_q5: i32) -> i32 {
        self.x0 + (((y_q5 - self.y0) * self.slope_q12 + 2048) >> 12)
    }

    /// Nearest column at a whole row.
    pub(crate) fn column(&self, y: i32) -> i32 {
        (self.x_q5(y << 5) + 16) >> 5
    }
}

/// Most rows of the band that are evaluated.
const FEATURE_ROWS: i32 = 4;
/// Search range on both sides of the expected column, px.
const FEATURE_REACH: usize = 2;

/// Disparity, 1/64 px, mean of the rows, of the edge in the right image that corresponds to the left one: within [`FEATURE_REACH`] of
/// `disparity`, with the same sign and at least half of the gradient, in at least half of the rows. `None` where there is none.
pub(crate) fn find(line: &SteepLine, rising: bool, disparity: i32, band: &Band<'_>) -> Option<i32> {
    let rows = SampledRows::new(line.rows(), FEATURE_ROWS);
    let sign = |gradient: u8| {
        let gradient = i32::from(gradient) - i32::from(FLAT);
        if rising { gradient } else { -gradient }
    };
    let (mut sum_q6, mut found) = (0, 0);
    for y in rows {
        // The strip's middle is the edge; the expected edge of the other row lies in the middle of the search range.
        let x = line.column(y);
        let Some(strip) = band.strip(x - 4, y, disparity - FEATURE_REACH as i32) else { continue };
        let [_, _, _, left, ..] = strip.reference;
        let Some(near) = strip.other.get(2..).and_then(|other| other.first_chunk::<7>()) else { continue };
        let near = near.map(sign);
        let mut best = (0, 0, 0);
        for (window, index) in near.windows(3).zip(0..) {
            if let &[before, here, after] = window
                && here > best.0
            {
                // A parabola through three gradients.
                let shift_q6 = quotient((after - before) << 5, 2 * here - before - after).clamp(-32, 32);
                best = (here, index, shift_q6);
            }
        }
        let (gradient, index, shift_q6) = best;
        if gradient > 2 && 2 * gradient >= sign(left) {
            let off_q6 = ((index - FEATURE_REACH as i32) << 6) + shift_q6;
            // Distance of the left edge's line from its whole column.
            let own_q6 = (line.x_q5(y << 5) << 1) - (x << 6);
            sum_q6 += own_q6 + off_q6;
            found += 1;
        }
    }
    (2 * found >= rows.count() && found > 0).then(|| (disparity << 6) + quotient(sum_q6, found))
}
