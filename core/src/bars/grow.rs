//! Bars beyond the segment that they were found at: along their line while both edges stand.
//!
//! In: the bars that are told, both images. Out: further parts of them, each with its own line.
//!
//! ```text
//! from each end, two rows a step, at most 48 rows:
//!     both edges within 1 px, with their sign and 0.3 of the weaker one's gradient
//!     cost at the disparity or 1 px beside it at most 0.6 of the row's own gradients
//!     the line follows the edges, the disparity its lowest cost, both by a fifth of the distance
//!     four misses in a row end it
//! ```
//!
//! # Bounds
//! At most 48 steps a bar; a row of at most 26 columns of gradients that differ by 62.
//!
//! # Cost
//! 900 instructions a step. Only bars that are told are grown.

use super::{Bar, GROWN};
use crate::image::Gray;
use crate::kernel::FLAT;
use crate::list::List;
use crate::matching::codes::gradients;
use crate::units::{Confidence, narrow, quotient};

/// Rows of a step.
const STEP: i32 = 2;
/// Most rows beyond an end.
const MOST_ROWS: i32 = 48;
/// Fewest rows of a part.
const LEAST_ROWS: i32 = 8;
/// Misses in a row that end it.
const MISSES: u32 = 4;
/// Columns beyond both edges that are read.
const BESIDE: i32 = 3;
/// Columns of the widest bar, and those beside it.
const COLUMNS: usize = 32;
/// Pixels at the border where it ends.
const BORDER: i32 = 5;
/// Least mean gradient of an edge, 1/8.
const LEAST_EDGE_Q3: i32 = 20;
/// Probability less than that of the bar, Q16: 0.02.
const LESS_Q16: u16 = 1311;

/// Adds the parts that bars go on by, those in front first, as far as there is room.
#[inline(never)] // its variables are on the stack only while it runs
pub(crate) fn grow(
    bars: &mut List<'_, Bar>,
    images: [Gray<'_>; 2],
    row_offset: i32,
    least: Confidence,
) {
    let found = bars.len();
    for is_in_front in [true, false] {
        let is_next = |bar: &&Bar| bar.is_prominent() && bar.is_in_front() == is_in_front;
        for index in 0..found {
            let Some(&bar) = bars.get(index).filter(is_next) else { continue };
            let probability_q16 = bar.probability_q16.saturating_sub(LESS_Q16);
            if probability_q16 < least.to_bits() {
                continue;
            }
            for step in [-STEP, STEP] {
                if let Some(part) = (Walk { bar: &bar, images, row_offset, step }).part() {
                    let flags = bar.flags | GROWN;
                    // As far as there is room.
                    let _ = bars.push(Bar { probability_q16, flags, ..part });
                }
            }
        }
    }
}

/// A walk along a bar's line beyond one of its ends.
struct Walk<'a> {
    bar: &'a Bar,
    images: [Gray<'a>; 2],
    row_offset: i32,
    step: i32,
}

/// Off the bar's line.
#[derive(Clone, Copy, Default)]
struct Off {
    shift_q5: i32,
    drift_q6: i32,
}

impl Walk<'_> {
    fn part(&self) -> Option<Bar> {
        let [first, last] = self.bar.first_and_last();
        let end = if self.step < 0 { first } else { last };
        let (mut off, mut misses) = (Off::default(), 0);
        let mut reached = None;
        for y in (1..=MOST_ROWS / STEP).map(|k| end + k * self.step) {
            if let Some((x_q5, d_q6)) = self.test(y, end, &mut off) {
                (reached, misses) = (Some((y, x_q5, d_q6)), 0);
            } else {
                misses += 1;
                if misses >= MISSES {
                    break;
                }
            }
        }
        let (y, x_q5, d_q6) = reached?;
        if (y - end).abs() < LEAST_ROWS {
            return None;
        }
        let far = (y, x_q5, d_q6);
        let near = (end, self.bar.x_at_q5(end), self.bar.disparity_at_q6(end));
        let [(y0, x0, d0), (y1, x1, d1)] = if self.step < 0 { [far, near] } else { [near, far] };
        Some(Bar {
            x_q5: u16::try_from(x0).ok()?,
            rows: [u16::try_from(y0).ok()?, u16::try_from(y1).ok()?],
            slope_q12: narrow(quotient((x1 - x0) << 7, y1 - y0)),
            disparity_q6: [narrow(d0), narrow(d1)],
            ..*self.bar
        })
    }

    /// Column of the left edge, 1/32 px, and disparity, 1/64 px, at a row where both edges stand.
    fn test(&self, y: i32, end: i32, off: &mut Off) -> Option<(i32, i32)> {
        let [left, right] = self.images;
        let (bar, width) = (self.bar, i32::from(left.dims().width));
        if y < 2 || y + 2 >= i32::from(left.dims().height) {
            return None;
        }
        let x_q5 = bar.x_at_q5(y) + off.shift_q5;
        let [from, to] = bar.disparity_q6.map(i32::from);
        let slant_q6 = quotient((to - from) * (y - end), 2 * (bar.height() - 1));
        let d_q6 = bar.disparity_at_q6(end) + slant_q6 + off.drift_q6;
        let (a, b) = ((x_q5 + 16) >> 5, (x_q5 + i32::from(bar.width_q5) + 16) >> 5);
        let d = (d_q6 + 32) >> 6;
        if a < BORDER || b + BORDER >= width || a - d < BORDER || b - d + BORDER >= width {
            return None;
        }
        let (mut own, mut there) = ([FLAT; COLUMNS], [FLAT; COLUMNS]);
        let count = usize::try_from(b - a + 1 + 2 * BESIDE).ok()?;
        gradients(left, y, a - BESIDE..b + BESIDE + 1, own.get_mut(..count)?);
        let [weak, weaker] = bar.strengths_q3.map(i32::from);
        let least_q3 = (weak.min(weaker) * 3 / 10).max(LEAST_EDGE_Q3);
        let [sign_a, sign_b] = bar.signs();
        let move_a = strongest(&own, BESIDE, sign_a, least_q3)?;
        let move_b = strongest(&own, BESIDE + b - a, sign_b, least_q3)?;
        gradients(
            right,
            y + self.row_offset,
            a - d - BESIDE..b - d + BESIDE + 1,
            there.get_mut(..count)?,
        );
        let turn = self.lowest(&own, &there, b - a)?;
        off.shift_q5 += ((move_a + move_b) << 4) / 5;
        let off_q6 = ((d + turn) << 6) - d_q6;
        if off_q6.abs() > 32 {
            off.drift_q6 += off_q6 / 5;
        }
        Some((x_q5, d_q6))
    }

    /// The disparity, -1, 0 or 1 px off, of the lowest cost, if it is low.
    fn lowest(&self, own: &[u8; COLUMNS], there: &[u8; COLUMNS], width: i32) -> Option<i32> {
        let first = usize::try_from(BESIDE - 1).ok()?;
        let own = own.get(first..first + usize::try_from(width + 3).ok()?)?;
        let energy: u32 = own.iter().map(|g| u32::from(g.abs_diff(FLAT))).sum();
        // One disparity more lies one column farther left.
        let cost = |turn: i32| {
            let other = there.get(usize::try_from(BESIDE - 1 - turn).ok()?..)?;
            Some(own.iter().zip(other).map(|(a, b)| u32::from(a.abs_diff(*b))).sum::<u32>())
        };
        let (cost, turn) = [0, -1, 1]
            .into_iter()
            .filter_map(|turn| Some((cost(turn)?, turn)))
            .min_by_key(|c| c.0)?;
        (5 * cost <= 3 * energy).then_some(turn)
    }
}

/// Where, -1, 0 or 1 px from this index, the gradient of one sign is the largest, if it is large
/// enough.
fn strongest(row: &[u8; COLUMNS], at: i32, sign: i32, least_q3: i32) -> Option<i32> {
    let of = |by: i32| {
        let gradient = row.get(usize::try_from(at + by).ok()?)?;
        Some(((i32::from(*gradient) - i32::from(FLAT)) * sign, by))
    };
    let (gradient, by) =
        [0, -1, 1].into_iter().filter_map(of).reduce(|a, b| if b.0 > a.0 { b } else { a })?;
    (gradient << 3 >= least_q3).then_some(by)
}
