//! Cost curves of a segment, for observers.
//!
//! In: the working memory after a segment was matched or rejected. Out: the curves that were
//! computed for it, by technique, side and half.

use super::Workspace;
use crate::curve::{CURVES, Curve};
use crate::lines::Segment;

/// Kinds of a segment's cost curves. Sides: 0 is left of the segment or above it, 1 is right or
/// below. Halves: 0 is the upper or left one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveKind {
    /// Window of one side over one half of the segment; without the edge itself.
    Window {
        /// Side.
        side: usize,
        /// Half.
        half: usize,
    },
    /// Window of the edge itself over one half; near-vertical segments alone have it.
    Edge {
        /// Half.
        half: usize,
    },
    /// Census points of one side.
    Census {
        /// Side.
        side: usize,
    },
}

/// Cost curves of one segment.
#[derive(Clone, Copy, Debug)]
pub struct SegmentCurves<'a> {
    near_horizontal: bool,
    curves: &'a [Curve; CURVES],
}

impl<'a> SegmentCurves<'a> {
    pub(crate) fn new(segment: &Segment, work: &'a Workspace) -> Self {
        Self { near_horizontal: segment.near_horizontal, curves: &work.curves }
    }

    /// First disparity, px, and the costs from there on, one per px; `None` where no test before
    /// asked for it.
    #[must_use]
    pub fn of(&self, kind: CurveKind) -> Option<(i32, &'a [u16])> {
        let place = match (kind, self.near_horizontal) {
            (CurveKind::Window { side: side @ 0..=1, half: half @ 0..=1 }, false) => {
                3 * half + 2 * side
            }
            (CurveKind::Edge { half: half @ 0..=1 }, false) => 3 * half + 1,
            (CurveKind::Window { side: side @ 0..=1, half: half @ 0..=1 }, true) => {
                5 * side + 2 + half
            }
            (CurveKind::Census { side: side @ 0..=1 }, _) => 10 + side,
            _ => return None,
        };
        self.curves.get(place)?.listed()
    }
}
