//! Evidence for the hypotheses of a segment by the support points around it, and the reverse.
//!
//! In: candidates, the grid of support points. Out: evidence of agreement and conflict for each
//! side; weights of segments at each point.
//!
//! ```text
//! weight    = uniqueness of the point * nearness to the middle of the side's window
//! agreeing  = log2(1 + sum of the weights of those that agree)
//! farther   = sum of those that are farther / (sum of all + 0.2), nearer likewise: a hypothesis
//!           before a surface may be of a thin object, one
//!             behind it is not
//! ```
//! A point agrees when its disparity, continued along the ground plane if it lies beside it,
//! differs from the side's line, continued to its row, by at most 1 px plus 0.06 px per px of
//! distance.
//!
//! # Bounds
//! Uniqueness is at most 255, nearness 14 * 14: a point's weight is below 2^14; at most 3 * 9
//! points count.
//!
//! # Cost
//! Some 25 instructions a point, 15 points a side.

use super::{Candidate, WINDOW_MIDDLE};
use crate::evidence::log2_mean_q8;
use crate::ground::GroundPlane;
use crate::support::{Grid, SupportPoint};
use crate::units::{narrow, quotient};

/// Distance from the middle of the side's window from which a point has no weight, px.
const REACH: i32 = 14;
/// Weight of a unique point at a quarter of the largest nearness.
const FULL: i32 = 255 * REACH * REACH / 4;
/// Conflicting weight that halves a share: a fifth of [`FULL`].
const LITTLE: i32 = FULL / 5;

/// Sets the evidence by support points of every hypothesis, and the weights of segments around
/// every point.
pub(crate) fn evaluate_sides(
    candidates: &mut [Candidate],
    grid: Grid,
    plane: Option<GroundPlane>,
    points: &mut [SupportPoint],
) {
    if points.is_empty() {
        return;
    }
    for candidate in candidates {
        let (x0, y0, x1, y1) = candidate.segment.ends_q5();
        let ([x0, x1], [y0, y1]) = ([x0, x1].map(|q5| q5 >> 5), [y0, y1].map(|q5| q5 >> 5));
        let near_horizontal = candidate.segment.near_horizontal;
        let (along, across) =
            if near_horizontal { ([x0, x1], [y0, y1]) } else { ([y0, y1], [x0, x1]) };
        for (side, sign) in candidate.sides.iter_mut().zip([-1, 1]) {
            let Some(side) = side else { continue };
            let off = sign * WINDOW_MIDDLE;
            // Along the ground a side has its disparity at the edge, else in its window.
            let is_moved = near_horizontal && plane.is_some();
            let across_q10 = if is_moved { side.across_q10.into() } else { 0 };
            let [d0, d1] = side
                .disparity_q6
                .map(|end_q6| i32::from(end_q6) + ((across_q10 * WINDOW_MIDDLE) >> 4));
            let line = Line {
                sign,
                along,
                across: across.map(|at| at + off),
                disparity_q6: [d0, d1],
                near_horizontal,
                plane,
            };
            let [agreeing, farther, nearer] = line.weights_of(grid, points, side.weight_q8.into());
            let share =
                |sum: i32| narrow(quotient(sum >> 2, (agreeing + farther + nearer + LITTLE) >> 10));
            side.nearby.agreeing = narrow(log2_mean_q8(agreeing.unsigned_abs(), FULL));
            side.nearby.farther = share(farther);
            side.nearby.nearer = share(nearer);
        }
    }
}

/// The middle line of a side's window, with its disparities; `along` and `across` are y and x, or x
/// and y where it is near horizontal.
struct Line {
    along: [i32; 2],
    across: [i32; 2],
    disparity_q6: [i32; 2],
    sign: i32,
    near_horizontal: bool,
    plane: Option<GroundPlane>,
}

impl Line {
    /// Weights of the points that agree, of those that are farther and of those that are nearer.
    fn weights_of(&self, grid: Grid, points: &mut [SupportPoint], side_weight_q8: i32) -> [i32; 3] {
        let [from, to] = self.along;
        let [first, last] = [from.min(to), from.max(to)];
        // Per px along the line: px and 1/64 px, in Q8.
        let slope_q8 = |[a, b]: [i32; 2]| quotient((b - a) << 8, to - from);
        let (across_q8, disparity_q8) = (slope_q8(self.across), slope_q8(self.disparity_q6));
        // Points beyond the edge may be of another surface.
        let (before, after) =
            if self.sign < 0 { (REACH - 1, WINDOW_MIDDLE) } else { (WINDOW_MIDDLE, REACH - 1) };
        let [mut grid_along, mut grid_across] = grid.axes();
        if self.near_horizontal {
            core::mem::swap(&mut grid_along, &mut grid_across);
        }
        let [mut agreeing, mut farther, mut nearer] = [0; 3];
        for i in grid_along.within(first - REACH + 1, last + REACH - 1) {
            // Foot of the points on the line, along the segment's direction.
            let along = grid_along.pixel(i);
            let foot = along.max(first).min(last);
            let beyond = (along - foot).abs();
            let edge = self.across[0] + ((across_q8 * (foot - from)) >> 8);
            let disparity_q6 = self.disparity_q6[0] + ((disparity_q8 * (foot - from)) >> 8);
            for k in grid_across.within(edge - before, edge + after) {
                let index = i * grid_along.step + k * grid_across.step;
                let Some(point) = points.get_mut(index).filter(|point| point.is_matched()) else {
                    continue;
                };
                let [dx, dy] = [point.place.dx(), point.place.dy()];
                let (own_along, own_across) =
                    if self.near_horizontal { (dx, dy) } else { (dy, dx) };
                let from_edge = grid_across.pixel(k) + own_across - edge;
                let across = from_edge.abs();
                let nearness = (REACH - across).max(0) * (REACH - beyond);
                // A point beside the ground plane goes on along it.
                let change_q6 = match self.plane.filter(|_| point.place.is_on_plane()) {
                    Some(plane) => {
                        let from_foot = along + own_along - foot;
                        let (dx, dy) = if self.near_horizontal {
                            (from_foot, from_edge)
                        } else {
                            (from_edge, from_foot)
                        };
                        plane.change_q6(dx, dy)
                    }
                    None => 0,
                };
                let apart = i32::from(point.disparity_q6) - change_q6 - disparity_q6;
                let [supporting, conflicting] = &mut point.segments;
                let (sum, weight) = if apart.abs() <= 64 + 4 * (across + beyond) {
                    (&mut agreeing, supporting)
                } else {
                    (if apart < 0 { &mut farther } else { &mut nearer }, conflicting)
                };
                *sum += (i32::from(point.uniqueness_q8) * nearness) >> 2;
                // At most 256 * 14 * 14 / 2^11.
                *weight = weight.saturating_add(((side_weight_q8 * nearness) >> 11) as u8);
            }
        }
        [agreeing, farther, nearer]
    }
}
