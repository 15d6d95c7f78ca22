//! Three semi-global paths over rows of points: from the left, from the right, from above.
//!
//! In: the costs of a row of points, one byte a disparity. Out: for each point the sum of its three path costs.
//!
//! ```text
//! memory   costs | path from above | sum      of each point of a row, and the path from the left or right
//! ```
//! Lengths are rounded up to whole words; what lies beyond the disparities is the largest cost.

use crate::kernel::path_step;

/// Points of the widest row.
const MAX_COLUMNS: usize = crate::image::MAX_WIDTH as usize / super::SUPPORT_PITCH as usize;

/// Bytes of one curve.
const fn stride(disparities: usize) -> usize {
    disparities.next_multiple_of(4)
}

/// Bytes of memory for rows of so many points.
pub(super) const fn bytes(disparities: usize, columns: usize) -> usize {
    stride(disparities) * (3 * columns + 1)
}

/// The costs of one row of points.
pub(super) struct Paths<'m> {
    costs: &'m mut [u8],
    above: &'m mut [u8],
    sums: &'m mut [u8],
    along: &'m mut [u8],
    disparities: usize,
    stride: usize,
    /// Lowest path cost of the point before.
    along_lowest: u8,
    above_lowest: [u8; MAX_COLUMNS],
}

/// Costs of a point along the disparities.
pub(super) struct Answer<'p> {
    /// The window's own cost.
    pub(super) costs: &'p [u8],
    /// Sum of the three path costs.
    pub(super) sums: &'p [u8],
}

impl<'m> Paths<'m> {
    pub(super) fn new(disparities: usize, columns: usize, memory: &'m mut [u8]) -> Option<Self> {
        let stride = stride(disparities);
        let memory = memory.get_mut(..bytes(disparities, columns))?;
        let (costs, memory) = memory.split_at_mut_checked(stride * columns)?;
        let (above, memory) = memory.split_at_mut_checked(stride * columns)?;
        let (sums, along) = memory.split_at_mut_checked(stride * columns)?;
        let above_lowest = [0; MAX_COLUMNS];
        Some(Self { costs, above, sums, along, disparities, stride, along_lowest: 0, above_lowest })
    }

    /// The next row is the first one.
    pub(super) fn restart(&mut self) {
        self.above.fill(0);
        self.above_lowest.fill(0);
        // Beyond the disparities.
        for costs in self.costs.chunks_exact_mut(self.stride.max(1)) {
            if let Some(beyond) = costs.get_mut(self.disparities..) {
                beyond.fill(u8::MAX);
            }
        }
    }

    /// The next point is the first one of its row, from the left or from the right.
    pub(super) fn start_row(&mut self) {
        self.along.fill(0);
        self.along_lowest = 0;
    }

    fn place(&self, column: usize) -> core::ops::Range<usize> {
        column * self.stride..(column + 1) * self.stride
    }

    /// The costs of a point, to be filled.
    pub(super) fn costs(&mut self, column: usize) -> &mut [u8] {
        let start = column * self.stride;
        self.costs.get_mut(start..start + self.disparities).unwrap_or(&mut [])
    }

    /// Takes the paths from the left and from above on to this point.
    pub(super) fn reach_from_left_and_above(&mut self, column: usize) {
        let place = self.place(column);
        let (Some(costs), Some(above), Some(sums)) =
            (self.costs.get(place.clone()), self.above.get_mut(place.clone()), self.sums.get_mut(place))
        else {
            return;
        };
        let Some(above_lowest) = self.above_lowest.get_mut(column) else { return };
        *above_lowest = path_step(costs, *above_lowest, above, sums, true);
        self.along_lowest = path_step(costs, self.along_lowest, self.along, sums, false);
    }

    /// Takes the path from the right on to this point, whose sum is then complete.
    pub(super) fn reach_from_right(&mut self, column: usize) {
        let place = self.place(column);
        if let (Some(costs), Some(sums)) = (self.costs.get(place.clone()), self.sums.get_mut(place)) {
            self.along_lowest = path_step(costs, self.along_lowest, self.along, sums, false);
        }
    }

    /// Costs of the point at `column`, when all three paths have reached it.
    pub(super) fn answer(&self, column: usize) -> Answer<'_> {
        let costs = self.costs.get(self.place(column)).unwrap_or(&[]);
        let sums = self.sums.get(self.place(column)).unwrap_or(&[]);
        Answer { costs, sums }
    }
}
