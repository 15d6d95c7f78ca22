//! Which part of a pair is matched: a detector says where depth is needed, and the rest of the frame costs nothing.
//!
//! In: areas of the left image. Out: where edges have to start in both images, which segments are matched, and the pixels that their windows may
//! look at, so that the candidates that speak of the areas are those of a run over the whole frame.
//!
//! ```text
//! matched   what can speak of an object in an area: a window's middle lies in it
//! left      edges that start in the squares of selection that such windows meet, or within a scan of them: every competitor is known
//! right     near-horizontal edges that start on the rows of those of the left, to the left by the disparity range: they tell the row offset
//! rows      gradients and census codes in the columns that windows reach
//! ```
//!
//! # Source
//! The chapter's first idea: other perception rules out the pixels whose depth nobody needs.

use crate::area::Area;
use crate::image::Dims;
use crate::lines::{SCAN_STEP, Segment};
use crate::matching::band::WindowExtent;
use crate::objects::region_support::{OBJECT_REACH, supports_area};
use crate::params::Params;
use heapless::Vec;

/// How far a right segment may begin beyond what its left one says, px.
const VOTES: u16 = 8;

/// Which part of a pair is matched ([`Plan::run_on`](crate::Plan::run_on)).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Focus<'a> {
    /// Areas of the left image. Of more than [`Focus::MAX_AREAS`] the last ones are joined to one. `None` is the whole frame; without a pixel
    /// in any of them nothing is matched.
    pub areas: Option<&'a [Area]>,
    /// Rows to add to a left row for the matching right one, 1/32 px, as a run over the whole frame found it
    /// ([`Summary::row_offset_q5`](crate::Summary::row_offset_q5)); `None` to find it in what is looked at, where too little may tell it.
    pub row_offset_q5: Option<i16>,
}

impl Focus<'_> {
    /// The whole frame.
    pub const WHOLE: Self = Self { areas: None, row_offset_q5: None };
    /// Most areas that are told apart.
    pub const MAX_AREAS: usize = 16;
}

type Areas = Vec<Area, { Focus::MAX_AREAS }>;

/// Where to look: everywhere, or around these areas.
pub(crate) struct SearchRegions {
    areas: Option<Areas>,
    dims: Dims,
}

impl SearchRegions {
    pub(crate) fn new(focus: &Focus<'_>, dims: Dims) -> Self {
        let areas = focus.areas.map(|areas| {
            let mut list = Areas::new();
            for area in areas.iter().map(|area| area.common(Area::of(dims))).filter(|area| !area.is_empty()) {
                if let Err(area) = list.push(area)
                    && let Some(last) = list.last_mut()
                {
                    *last = last.joined(area);
                }
            }
            list
        });
        Self { areas, dims }
    }

    /// The areas; everywhere without.
    pub(crate) fn areas(&self) -> Option<&[Area]> {
        self.areas.as_deref()
    }

    /// Where edges of the left image start; everywhere without.
    pub(crate) fn left(&self, cell: u16) -> Option<Areas> {
        // The middle of what is matched lies within OBJECT_REACH of the area, and its competitors' middles in the same squares.
        let squares = |area: Area| {
            let Area { left, top, right, bottom } = area.grown(OBJECT_REACH, self.dims);
            let before = |at: u16| at - at.checked_rem(cell).unwrap_or(0);
            let after = |at: u16| before(at.saturating_add(cell - 1));
            Area { left: before(left), top: before(top), right: after(right), bottom: after(bottom) }
        };
        self.each(|area| squares(area).grown(SCAN_STEP as u16, self.dims))
    }

    /// Where edges of the right image start that can be those of these left segments; everywhere without.
    pub(crate) fn right(&self, left: &[Segment], params: &Params) -> Option<Areas> {
        self.each(|area| {
            let flat = left.iter().filter(|segment| segment.near_horizontal && supports_area(segment, area));
            let Area { left, top, right, bottom } = boxes(flat).grown(VOTES, self.dims);
            let right = right.saturating_add_signed(params.min_disparity.saturating_neg());
            Area { left: left.saturating_sub(params.max_disparity), top, right, bottom }
        })
    }

    /// Pixels that windows of the segments in each area may look at, at these disparities; everything without.
    pub(crate) fn extents(
        &self,
        left: &[Segment],
        disparities: (i32, i32),
    ) -> Option<Vec<WindowExtent, { Focus::MAX_AREAS }>> {
        self.areas.as_ref().map(|areas| {
            let mut list = Vec::new();
            for &area in areas {
                let boxes = boxes(left.iter().filter(|segment| supports_area(segment, area)));
                if !boxes.is_empty() {
                    let _ = list.push(WindowExtent::around(boxes, disparities, self.dims)); // no more than areas
                }
            }
            list
        })
    }

    /// Is this left segment matched?
    pub(crate) fn contains(&self, segment: &Segment) -> bool {
        self.areas.as_ref().is_none_or(|areas| areas.iter().any(|&area| supports_area(segment, area)))
    }

    fn each(&self, of: impl Fn(Area) -> Area) -> Option<Areas> {
        self.areas.as_ref().map(|areas| {
            let mut list = Areas::new();
            for &area in areas {
                let _ = list.push(of(area)); // as many as there are
            }
            list
        })
    }
}

/// The smallest area with all of these segments.
fn boxes<'a>(segments: impl Iterator<Item = &'a Segment>) -> Area {
    segments.map(Segment::area).fold(Area::default(), Area::joined)
}
