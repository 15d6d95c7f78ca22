//! Pixels beside a segment that have the disparity of one of its sides.
//!
//! In: a candidate, a side, a distance from the edge. Out: `(x, y, disparity)` for every row
//! (column, when near-horizontal) of the segment.
//!
//! # Cost
//! Some 20 instructions a row (column) of the segment, at most 32.

use crate::image::{Dims, Gray, Span};
use crate::matching::Candidate;
use crate::matching::feature::SteepLine;
use crate::matching::near_horizontal::HorizontalLine;

/// Additional distance of the first pixels beside a near-horizontal segment, px.
const FLAT_OFFSET: i32 = 1;

/// Valid pixels of a pair: the size of both images and their valid pixels.
#[derive(Clone, Copy, Debug)]
pub struct ValidPixels<'a> {
    dims: Dims,
    left: &'a [Span],
    right: &'a [Span],
}

impl<'a> ValidPixels<'a> {
    /// The valid pixels of a pair of the same size.
    #[must_use]
    pub fn of(left: Gray<'a>, right: Gray<'a>) -> Self {
        Self { dims: left.dims(), left: left.valid(), right: right.valid() }
    }

    /// The valid pixels of pairs whose pixels are all valid.
    #[must_use]
    pub const fn whole(dims: Dims) -> Self {
        Self { dims, left: &[], right: &[] }
    }

    pub(crate) fn dims(&self) -> Dims {
        self.dims
    }

    /// True when the left pixel and its match at this disparity are valid.
    pub(crate) fn allow(&self, x: i32, y: i32, d_q6: i32) -> bool {
        let right_q6 = (x << 6) - d_q6;
        let valid = |spans: &[Span], x: i32| {
            let span = usize::try_from(y).ok().and_then(|y| spans.get(y));
            span.is_none_or(|span| span.contains(x))
        };
        (0..i32::from(self.dims.width)).contains(&x)
            && (0..i32::from(self.dims.height)).contains(&y)
            && (0..i32::from(self.dims.width) << 6).contains(&right_q6)
            && valid(self.left, x)
            && valid(self.right, (right_q6 + 32) >> 6)
    }
}

impl Candidate {
    /// Calls `each(x, y, disparity in 1/64 px)` for each pixel `distance` (1, 2, ...; 0 is the edge
    /// itself) from the edge on `side` (0 = left or above). Pixels that are not valid are left out.
    pub fn for_each_pixel(
        &self,
        side: usize,
        distance: u16,
        views: ValidPixels<'_>,
        mut each: impl FnMut(u16, u16, i32),
    ) {
        let Some(Some(owner)) = self.sides.get(side) else { return };
        let sign = if side == 0 { -1 } else { 1 };
        let flat_offset = if distance == 0 { 0 } else { FLAT_OFFSET };
        let [d0, d1] = owner.disparity_q6.map(i32::from);
        let mut emit = |x: i32, y: i32, edge_q6: i32, off: i32| {
            let d_q6 = edge_q6 + ((i32::from(owner.across_q10) * off) >> 4);
            if views.allow(x, y, d_q6)
                && let (Ok(column), Ok(row)) = (u16::try_from(x), u16::try_from(y))
            {
                each(column, row, d_q6);
            }
        };
        // Change of d along the segment, 1/64 px in Q8.
        let ramp = |from: i32, to: i32| ((d1 - d0) << 8) / (to - from).max(1);
        if self.segment.near_horizontal {
            let line = HorizontalLine::new(&self.segment);
            let (from, to) = line.columns();
            let step = ramp(from, to);
            for x in from..to + 1 {
                let off = i32::from(distance) + flat_offset;
                emit(x, line.row(x) + sign * off, d0 + (((x - from) * step) >> 8), off);
            }
        } else {
            let line = SteepLine::new(&self.segment);
            let (from, to) = line.rows();
            let step = ramp(from, to);
            for y in from..to + 1 {
                let off = i32::from(distance);
                emit(line.column(y) + sign * off, y, d0 + (((y - from) * step) >> 8), off);
            }
        }
    }
}
