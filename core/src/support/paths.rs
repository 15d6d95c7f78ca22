//! Three semi-global paths over rows of points: from the left, from the right, from above.
//!
//! In: the costs of a row of points, one byte a disparity. Out: for each point the sum of its three
//! path costs.
//!
//! ```text
//! memory   costs | path from above | path from the left, then the sum      of each point of a row, and the path along it
//! ```
//! Lengths are rounded up to fours of words; entries beyond the disparities are the largest cost.
//!
//! # Cost
//! Three steps of a path and a sum for every point and disparity, whatever the costs are: 930
//! instructions a point at 64 disparities (Armv7E-M).

use crate::cores::Cores;
use crate::curve::MAX_DISPARITIES;
use crate::kernel::{path_step, sum_paths};
use core::ops::Range;

/// Number of points of the widest row.
pub(super) const MAX_COLUMNS: usize =
    crate::image::MAX_WIDTH as usize / super::SUPPORT_PITCH as usize;

/// Labels of a point beside the ground plane, behind its disparities.
pub(super) const PLANE_LABELS: usize = 15;

/// Bytes of one curve.
const fn stride(labels: usize) -> usize {
    labels.next_multiple_of(16)
}

/// Bytes of memory for rows of `columns` points.
pub(super) const fn bytes(labels: usize, columns: usize) -> usize {
    stride(labels) * (3 * columns + 1)
}

/// Costs and path costs of one row of points.
pub(super) struct Paths<'m> {
    costs: &'m mut [u8],
    above: &'m mut [u8],
    sums: &'m mut [u8],
    along: &'m mut [u8],
    labels: usize,
    stride: usize,
    /// Lowest cost of each path from above.
    above_lowest: [u8; MAX_COLUMNS],
}

/// Costs of a point along its labels: disparities, then those beside the plane.
pub(super) struct PointCosts<'p> {
    /// The window's own cost, with P2.
    pub(super) costs: &'p mut [u8],
    /// Sum of the three path costs.
    pub(super) sums: &'p mut [u8],
    /// The lowest of the sums.
    pub(super) lowest: u8,
}

/// A path along the row: its costs at the point that it has come to.
struct Path<'p> {
    costs: &'p mut [u8],
    lowest: u8,
}

impl<'p> Path<'p> {
    fn new(costs: &'p mut [u8]) -> Self {
        costs.fill(0);
        Self { costs, lowest: 0 }
    }
}

/// Some points of the row, one beside the other.
struct Part<'p> {
    columns: Range<usize>,
    costs: &'p mut [u8],
    above: &'p mut [u8],
    sums: &'p mut [u8],
    above_lowest: &'p mut [u8],
    labels: usize,
    stride: usize,
}

/// The points of a row, or of a part of it.
pub(super) trait Points {
    /// Sets the costs of a point.
    fn fill(&mut self, column: usize, costs: &mut [u8]);

    /// Takes the sums of a point.
    fn visit(&mut self, column: usize, costs: PointCosts<'_>);
}

impl<'m> Paths<'m> {
    pub(super) fn new(labels: usize, columns: usize, memory: &'m mut [u8]) -> Option<Self> {
        let stride = stride(labels);
        let memory = memory.get_mut(..bytes(labels, columns))?;
        let (costs, memory) = memory.split_at_mut_checked(stride * columns)?;
        let (above, memory) = memory.split_at_mut_checked(stride * columns)?;
        let (sums, along) = memory.split_at_mut_checked(stride * columns)?;
        let above_lowest = [0; MAX_COLUMNS];
        Some(Self { costs, above, sums, along, labels, stride, above_lowest })
    }

    /// Resets the paths: the next row is the first one.
    pub(super) fn restart(&mut self) {
        self.above.fill(0);
        self.above_lowest.fill(0);
        // Entries beyond the disparities.
        for costs in self.costs.chunks_exact_mut(self.stride.max(1)) {
            if let Some(beyond) = costs.get_mut(self.labels..) {
                beyond.fill(u8::MAX);
            }
        }
    }

    /// Continues the paths from above and from the left through these points of the next row, then
    /// computes the path from the right, last point first.
    pub(super) fn pass(&mut self, columns: Range<usize>, points: &mut impl Points) {
        let end = columns.end;
        if let Some(([mut all, _], along)) = self.parts(columns, end) {
            all.begin(&mut Path::new(along), points);
            all.close_back(&mut Path::new(along), points);
        }
    }

    /// As [`Paths::pass`], on two cores: the points before column `middle`, and the others.
    ///
    /// ```text
    /// here     left: costs, from above, from the left      right: on from the left, sums
    /// there    right: costs, from above, from the right    left: on from the right, sums
    /// ```
    #[inline(never)] // its memory is on the stack only while it runs
    pub(super) fn pass_on<P: Points + Send>(
        &mut self,
        cores: &mut dyn Cores,
        columns: Range<usize>,
        middle: usize,
        [left_points, right_points]: &mut [P; 2],
    ) {
        let Some(([mut left, mut right], along)) = self.parts(columns, middle) else { return };
        let mut spare = [0; stride(MAX_DISPARITIES + 1 + PLANE_LABELS)];
        let Some(spare) = spare.get_mut(..along.len()) else { return };
        let (mut from_left, mut from_right) = (Path::new(along), Path::new(spare));
        cores.join(&mut || left.begin(&mut from_left, left_points), &mut || {
            right.begin_back(&mut from_right, right_points);
        });
        cores.join(&mut || right.close(&mut from_left, right_points), &mut || {
            left.close_back(&mut from_right, left_points);
        });
    }

    /// The points before and from column `middle` on, and memory for a path.
    fn parts(
        &mut self,
        columns: Range<usize>,
        middle: usize,
    ) -> Option<([Part<'_>; 2], &mut [u8])> {
        let (stride, labels) = (self.stride.max(1), self.labels);
        let within = columns.start * stride..columns.end * stride;
        let (of_left, at) = (middle.checked_sub(columns.start)?, middle * stride - within.start);
        let (costs, right_costs) = self.costs.get_mut(within.clone())?.split_at_mut_checked(at)?;
        let (above, right_above) = self.above.get_mut(within.clone())?.split_at_mut_checked(at)?;
        let (sums, right_sums) = self.sums.get_mut(within)?.split_at_mut_checked(at)?;
        let (above_lowest, right_lowest) =
            self.above_lowest.get_mut(columns.clone())?.split_at_mut_checked(of_left)?;
        let left = Part {
            columns: columns.start..middle,
            costs,
            above,
            sums,
            above_lowest,
            labels,
            stride,
        };
        let right = Part {
            columns: middle..columns.end,
            costs: right_costs,
            above: right_above,
            sums: right_sums,
            above_lowest: right_lowest,
            labels,
            stride,
        };
        Some(([left, right], self.along))
    }
}

/// A point of the row: its memory, and the lowest cost of the path to it from above.
struct PointMemory<'p> {
    column: usize,
    costs: &'p mut [u8],
    above: &'p mut [u8],
    sums: &'p mut [u8],
    above_lowest: &'p mut u8,
}

impl Part<'_> {
    fn each(&mut self) -> impl DoubleEndedIterator<Item = PointMemory<'_>> {
        let stride = self.stride.max(1);
        let costs = self.costs.chunks_exact_mut(stride);
        let sums = self.above.chunks_exact_mut(stride).zip(self.sums.chunks_exact_mut(stride));
        let points = self.above_lowest.iter_mut().zip(self.columns.clone());
        costs.zip(sums).zip(points).map(|((costs, (above, sums)), (above_lowest, column))| {
            PointMemory { column, costs, above, sums, above_lowest }
        })
    }

    /// Continues the path from above and that from the left; of each point.
    fn begin(&mut self, path: &mut Path<'_>, points: &mut impl Points) {
        let labels = self.labels;
        for mut point in self.each() {
            point.descend(labels, points);
            path.begin(point);
        }
    }

    /// Continues the path from above, then computes that from the right, last point first.
    fn begin_back(&mut self, path: &mut Path<'_>, points: &mut impl Points) {
        let labels = self.labels;
        self.each().for_each(|mut point| point.descend(labels, points));
        self.each().rev().for_each(|point| path.begin(point));
    }

    /// Completes the path from the left, and calls `visit(column, costs)` for each point.
    fn close(&mut self, path: &mut Path<'_>, points: &mut impl Points) {
        self.each().for_each(|point| path.close(point, points));
    }

    /// The same from the right, last point first.
    fn close_back(&mut self, path: &mut Path<'_>, points: &mut impl Points) {
        self.each().rev().for_each(|point| path.close(point, points));
    }
}

impl PointMemory<'_> {
    /// Sets the costs and continues the path from above.
    #[inline(always)]
    fn descend(&mut self, labels: usize, points: &mut impl Points) {
        if let Some(costs) = self.costs.get_mut(..labels) {
            points.fill(self.column, costs);
        }
        *self.above_lowest = path_step(self.costs, *self.above_lowest, self.above);
    }
}

impl Path<'_> {
    /// Goes on to a point, whose sum it is the first of.
    #[inline(always)]
    fn begin(&mut self, PointMemory { costs, sums, .. }: PointMemory<'_>) {
        self.lowest = path_step(costs, self.lowest, self.costs);
        // As long as each other; cut to one length, so that the copy has no panic path.
        let length = sums.len().min(self.costs.len());
        if let (Some(sums), Some(path)) = (sums.get_mut(..length), self.costs.get(..length)) {
            sums.copy_from_slice(path);
        }
    }

    /// Goes on to a point, whose sum it completes.
    #[inline(always)]
    fn close(&mut self, point: PointMemory<'_>, points: &mut impl Points) {
        let PointMemory { column, costs, above, sums, .. } = point;
        self.lowest = path_step(costs, self.lowest, self.costs);
        let lowest = sum_paths(above, self.costs, sums);
        points.visit(column, PointCosts { costs, sums, lowest });
    }
}
