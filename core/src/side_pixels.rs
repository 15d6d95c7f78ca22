//! Pixels beside a segment that have the disparity of one of its sides.
//!
//! In: a candidate, a side, a distance from the edge. Out: `(x, y, disparity)` for every row
//! (column, when near-horizontal) of the segment.
//!
//! # Cost
//! Some 80 instructions a row (column) of the segment, at most 32.

use crate::image::{Dims, Gray, Span};
use crate::lines::Line;
use crate::matching::Candidate;

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
    #[inline(always)] // of each pixel that is listed: a call, 35 instructions more
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

/// Pixels at one distance from an edge, one after the other.
#[derive(Debug)]
pub(crate) struct SidePixels {
    near_horizontal: bool,
    /// Row, or column of a near-horizontal segment: the next, and the end.
    at: i32,
    end: i32,
    /// Column, or row, of the next pixel, px in Q17, and its change.
    across_q17: i32,
    slope_q17: i32,
    /// Disparity of the next one, 1/64 px in Q8, and its change.
    disparity_q14: i32,
    step_q14: i32,
}

impl SidePixels {
    /// None.
    pub(crate) const NONE: Self = Self {
        near_horizontal: false,
        at: 0,
        end: 0,
        across_q17: 0,
        slope_q17: 0,
        disparity_q14: 0,
        step_q14: 0,
    };

    /// As [`Candidate::pixels`].
    #[inline(never)] // a loop that mostly ends at once: inlined, 13 instructions more a pixel
    pub(crate) fn next(&mut self, views: &ValidPixels<'_>) -> Option<(u16, u16, i32)> {
        while self.at < self.end {
            let (at, across, d_q6) = (self.at, self.across_q17 >> 17, self.disparity_q14 >> 8);
            self.at += 1;
            self.across_q17 += self.slope_q17;
            self.disparity_q14 += self.step_q14;
            let (x, y) = if self.near_horizontal { (at, across) } else { (across, at) };
            if views.allow(x, y, d_q6)
                && let (Ok(x), Ok(y)) = (u16::try_from(x), u16::try_from(y))
            {
                return Some((x, y, d_q6));
            }
        }
        None
    }
}

impl Candidate {
    /// Column, row and disparity, 1/64 px, of each pixel `distance` (1, 2, ...; 0 is the edge
    /// itself) from the edge on `side` (0 = left or above). Pixels that are not valid are left out.
    pub fn pixels<'v>(
        &self,
        side: usize,
        distance: u16,
        views: ValidPixels<'v>,
    ) -> impl Iterator<Item = (u16, u16, i32)> + use<'v> {
        let mut pixels = self.side_pixels(side, distance);
        core::iter::from_fn(move || pixels.next(&views))
    }

    pub(crate) fn side_pixels(&self, side: usize, distance: u16) -> SidePixels {
        let Some(Some(owner)) = self.sides.get(side) else { return SidePixels::NONE };
        let near_horizontal = self.segment.near_horizontal;
        let line = Line::of(&self.segment);
        let (from, to) = line.extent();
        let flat_offset = if near_horizontal && distance > 0 { FLAT_OFFSET } else { 0 };
        let off = i32::from(distance) + flat_offset;
        let [d0, d1] = owner.disparity_q6.map(i32::from);
        SidePixels {
            near_horizontal,
            at: from,
            end: to + 1,
            across_q17: line.at_q17(from) + ((if side == 0 { -off } else { off }) << 17),
            slope_q17: line.step_q17(),
            disparity_q14: (d0 + ((i32::from(owner.across_q10) * off) >> 4)) << 8,
            step_q14: ((d1 - d0) << 8) / (to - from).max(1),
        }
    }
}
