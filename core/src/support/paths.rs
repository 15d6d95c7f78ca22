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

    /// Continues the paths from above and from the left through these points of the next row;
    /// `fill(column, costs)` sets the costs of each.
    pub(super) fn forward(
        &mut self,
        columns: Range<usize>,
        mut fill: impl FnMut(usize, &mut [u8]),
    ) {
        self.along.fill(0);
        let mut lowest = 0;
        let (stride, labels) = (self.stride.max(1), self.labels);
        let within = columns.start * stride..columns.end * stride;
        let (Some(costs), Some(above), Some(sums), Some(above_lowest)) = (
            self.costs.get_mut(within.clone()),
            self.above.get_mut(within.clone()),
            self.sums.get_mut(within),
            self.above_lowest.get_mut(columns.clone()),
        ) else {
            return;
        };
        let points = costs
            .chunks_exact_mut(stride)
            .zip(above.chunks_exact_mut(stride))
            .zip(sums.chunks_exact_mut(stride));
        for (((costs, above), sum), (above_lowest, column)) in
            points.zip(above_lowest.iter_mut().zip(columns))
        {
            if let Some(costs) = costs.get_mut(..labels) {
                fill(column, costs);
            }
            *above_lowest = path_step(costs, *above_lowest, above);
            lowest = path_step(costs, lowest, self.along);
            // As long as each other; cut to one length, so that the copy has no panic path.
            let length = sum.len().min(self.along.len());
            if let (Some(sum), Some(along)) = (sum.get_mut(..length), self.along.get(..length)) {
                sum.copy_from_slice(along);
            }
        }
    }

    /// Computes the path from the right through these points, last first, and calls `visit(column,
    /// costs)` for each.
    pub(super) fn back(
        &mut self,
        columns: Range<usize>,
        mut visit: impl FnMut(usize, PointCosts<'_>),
    ) {
        self.along.fill(0);
        let mut lowest = 0;
        let stride = self.stride.max(1);
        let within = columns.start * stride..columns.end * stride;
        let (Some(costs), Some(above), Some(sums)) = (
            self.costs.get_mut(within.clone()),
            self.above.get(within.clone()),
            self.sums.get_mut(within),
        ) else {
            return;
        };
        let points = costs
            .chunks_exact_mut(stride)
            .zip(above.chunks_exact(stride))
            .zip(sums.chunks_exact_mut(stride));
        for (((costs, above), sums), column) in points.zip(columns).rev() {
            lowest = path_step(costs, lowest, self.along);
            let lowest = sum_paths(above, self.along, sums);
            visit(column, PointCosts { costs, sums, lowest });
        }
    }
}
