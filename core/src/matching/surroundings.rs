//! Evidence for and against the claims of a segment by the support points around it.
//!
//! In: candidates, the grid of support points. Out: evidence of agreement and conflict for each side.
//!
//! ```text
//! weight    = how sure the point is * nearness to the middle of the side's window
//! agreeing  = log2(1 + sum of the weights of those that agree)
//! conflict  = conflicting / (agreeing + conflicting + 0.2)
//! ```
//! A point agrees when its disparity differs from the side's line, continued to its row, by at most 1 px plus 0.06 px per px of distance.
//!
//! # Bounds
//! Sureness is at most 255, nearness 20 * 20: a point weighs below 2^17; at most 6 * 9 points are asked.
//!
//! # Cost
//! Some 25 instructions a point, 15 points a side.

use super::evidence::log2_mean_q8;
use super::{Candidate, narrow};
use crate::support::{Grid, SupportPoint};
use crate::units::quotient;

/// Distance from the middle of the side's window at which a point says nothing, px.
const REACH: i32 = 14;
/// Middle of a side's window, from the edge, px.
const WINDOW_MIDDLE: i32 = 4;
/// Weight of a sure point at a quarter of the largest nearness.
const FULL: i32 = 255 * REACH * REACH / 4;
/// Contradicting weight that says nothing: a fifth of [`FULL`].
const LITTLE: i32 = FULL / 5;

/// Sets what support points say of every claim.
pub(crate) fn ask(candidates: &mut [Candidate], grid: Grid, points: &mut [SupportPoint]) {
    if points.is_empty() {
        return;
    }
    for candidate in candidates {
        let (x0, y0, x1, y1) = candidate.segment.ends_q5();
        let ([x0, x1], [y0, y1]) = ([x0, x1].map(|q5| q5 >> 5), [y0, y1].map(|q5| q5 >> 5));
        let flat = candidate.segment.near_horizontal;
        for (side, sign) in candidate.sides.iter_mut().zip([-1, 1]) {
            let Some(side) = side else { continue };
            let off = sign * WINDOW_MIDDLE;
            let (dx, dy) = if flat { (0, off) } else { (off, 0) };
            let [d0, d1] = side.disparity_q6.map(i32::from);
            let line = Line { sign, ends: [[x0 + dx, y0 + dy], [x1 + dx, y1 + dy]], disparity_q6: [d0, d1], flat };
            let (agreeing, conflicting) = line.ask(grid, points, side.weight_q8.into());
            let [said, against] = &mut side.heard_q8;
            *said = narrow(log2_mean_q8(agreeing.unsigned_abs(), FULL));
            *against = narrow(quotient(conflicting >> 2, (agreeing + conflicting + LITTLE) >> 10));
        }
    }
}

/// The middle line of a side's window, with its disparities.
struct Line {
    ends: [[i32; 2]; 2],
    disparity_q6: [i32; 2],
    sign: i32,
    flat: bool,
}

impl Line {
    /// Weights of the points that agree and of those that contradict.
    fn ask(&self, grid: Grid, points: &mut [SupportPoint], side_weight_q8: i32) -> (i32, i32) {
        let [[x0, y0], [x1, y1]] = self.ends;
        let [d0, d1] = self.disparity_q6;
        let (mut agreeing, mut conflicting) = (0, 0);
        // On the other side of the edge another surface may begin.
        let (before, after) = if self.sign < 0 { (REACH, WINDOW_MIDDLE) } else { (WINDOW_MIDDLE, REACH) };
        let ((left, right), (up, down)) =
            if self.flat { ((REACH, REACH), (before, after)) } else { ((before, after), (REACH, REACH)) };
        let columns = grid.columns_within(x0.min(x1) - left, x0.max(x1) + right);
        for row in grid.rows_within(y0.min(y1) - up, y0.max(y1) + down) {
            for column in columns.clone() {
                let (x, y) = (grid.x(column), Grid::y(row));
                let place = row * grid.columns + column;
                let Some(point) = points.get_mut(place).filter(|point| point.is_matched()) else { continue };
                // The foot of the point on the line, along the segment's direction.
                let (along, from, to) = if self.flat { (x, x0, x1) } else { (y, y0, y1) };
                let foot = along.max(from.min(to)).min(from.max(to));
                let part = |a: i32, b: i32| a + quotient((b - a) * (foot - from), to - from);
                let (across, beyond) =
                    if self.flat { (y - part(y0, y1), along - foot) } else { (x - part(x0, x1), along - foot) };
                if across * self.sign < -WINDOW_MIDDLE {
                    continue; // on the other side of the edge
                }
                let (across, beyond) = (across.abs(), beyond.abs());
                if across >= REACH || beyond >= REACH {
                    continue;
                }
                let weight = (i32::from(point.sure_q8) * (REACH - across) * (REACH - beyond)) >> 2;
                let apart = (i32::from(point.disparity_q6) - part(d0, d1)).abs();
                let word = (side_weight_q8 * (REACH - across) * (REACH - beyond)) >> 11;
                let [for_it, against_it] = &mut point.heard;
                let (sum, heard) = if apart <= 64 + 4 * (across + beyond) {
                    (&mut agreeing, for_it)
                } else {
                    (&mut conflicting, against_it)
                };
                *sum += weight;
                *heard = heard.saturating_add(u8::try_from(word).unwrap_or(u8::MAX));
            }
        }
        (agreeing, conflicting)
    }
}
