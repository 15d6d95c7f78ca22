//! Focus: the areas of a pair that are matched, where depth is needed; the rest of the frame costs
//! nothing.
//!
//! In: areas of the left image, of which some are joined where that costs less. Out: the areas in
//! which edges start in both images, the segments that are matched, and the pixels that their
//! windows may reach, so that the candidates for objects in the areas are those of a run over the
//! whole frame.
//!
//! ```text
//! matched   segments that can count for an object in an area: a window's middle lies in it
//! left      edges that start in the squares of selection that such windows meet, or within a scan
//!           of them, so that every competitor is found
//! right     near-horizontal edges that start on the rows of those of the left, to the left by the
//!           disparity range: for the row offset
//! rows      gradients and census codes in the columns that windows reach
//! ```
//!
//! # Cost
//! A pass over the segments for each area, at most [`MAX_AREAS`]: some 20 instructions each.
//!
//! # Source
//! The chapter's first idea: other perception excludes the pixels whose depth is not needed.

use crate::area::Area;
use crate::image::Dims;
use crate::lines::{SCAN_STEP, Segment};
use crate::matching::band::WindowExtent;
use crate::objects::region_support::{OBJECT_REACH, supports_area};
use crate::params::Params;
use crate::support::SURROUNDINGS;
use heapless::Vec;

/// Margin around the expected position of a right segment, px.
const VOTES: u16 = 8;

/// Largest number of separate areas.
pub(crate) const MAX_AREAS: usize = 16;

type Areas = Vec<Area, MAX_AREAS>;

/// Part of an image's width whose points cost as much as the codes of a row, which are those of the
/// whole width: by three times of a PC for one pair of 320x240. Answers do not depend on it but
/// near the borders of areas.
const CODES_SHARE: u32 = 6;

/// Cost of matching the support points of an area, in pixels of points.
fn cost(area: Area, dims: Dims) -> u32 {
    let Area { left, top, right, bottom } = area.grown(SURROUNDINGS, dims);
    u32::from(bottom - top) * (u32::from(right - left) + u32::from(dims.width) / CODES_SHARE)
}

/// Joins areas where that costs less.
fn join(areas: &mut Areas, dims: Dims) {
    let mut index = 0;
    while let Some(&area) = areas.get(index) {
        let other = areas.iter().take(index).position(|&other| {
            cost(area.joined(other), dims) <= cost(area, dims) + cost(other, dims)
        });
        if let Some(other) = other.and_then(|other| areas.get_mut(other)) {
            *other = other.joined(area);
            // The last one takes its place.
            if let Some(last) = areas.pop()
                && let Some(place) = areas.get_mut(index)
            {
                *place = last;
            }
            index = 0; // those before may be joined with what it has become
        } else {
            index += 1;
        }
    }
}

/// Areas to search, or everywhere.
pub(crate) struct SearchRegions {
    areas: Option<Areas>,
    dims: Dims,
}

impl SearchRegions {
    /// Of more than [`MAX_AREAS`] areas the last ones are joined to one. `None` is the whole frame;
    /// without a pixel in any of them nothing is matched.
    pub(crate) fn new(areas: Option<&[Area]>, dims: Dims) -> Self {
        let areas = areas.map(|areas| {
            let mut list = Areas::new();
            for area in
                areas.iter().map(|area| area.common(Area::of(dims))).filter(|area| !area.is_empty())
            {
                if let Err(area) = list.push(area)
                    && let Some(last) = list.last_mut()
                {
                    *last = last.joined(area);
                }
            }
            join(&mut list, dims);
            list
        });
        Self { areas, dims }
    }

    /// The areas; `None` for everywhere.
    pub(crate) fn areas(&self) -> Option<&[Area]> {
        self.areas.as_deref()
    }

    /// Areas in which edges of the left image start; `None` for everywhere.
    pub(crate) fn left(&self, cell: u16) -> Option<Areas> {
        // Middles of matched segments lie within OBJECT_REACH of the area, and their competitors'
        // in the same squares.
        let squares = |area: Area| {
            let Area { left, top, right, bottom } = area.grown(OBJECT_REACH, self.dims);
            let before = |at: u16| at - at.checked_rem(cell).unwrap_or(0);
            let after = |at: u16| before(at.saturating_add(cell - 1));
            Area {
                left: before(left),
                top: before(top),
                right: after(right),
                bottom: after(bottom),
            }
        };
        self.each(|area| squares(area).grown(SCAN_STEP as u16, self.dims))
    }

    /// Areas in which edges of the right image start that can correspond to these left segments;
    /// `None` for everywhere.
    pub(crate) fn right(&self, left: &[Segment], params: &Params) -> Option<Areas> {
        self.each(|area| {
            let flat = left
                .iter()
                .filter(|segment| segment.near_horizontal && supports_area(segment, area));
            let Area { left, top, right, bottom } = boxes(flat).grown(VOTES, self.dims);
            let right = right.saturating_add_signed(params.min_disparity.saturating_neg());
            Area { left: left.saturating_sub(params.max_disparity), top, right, bottom }
        })
    }

    /// Pixels that windows of the segments in each area may reach, at these disparities; `None` for
    /// all.
    pub(crate) fn extents(
        &self,
        left: &[Segment],
        disparities: (i32, i32),
    ) -> Option<Vec<WindowExtent, MAX_AREAS>> {
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

    /// True when this left segment is matched.
    pub(crate) fn contains(&self, segment: &Segment) -> bool {
        self.areas
            .as_ref()
            .is_none_or(|areas| areas.iter().any(|&area| supports_area(segment, area)))
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

/// Bounding box of segments.
fn boxes<'a>(segments: impl Iterator<Item = &'a Segment>) -> Area {
    segments.map(Segment::area).fold(Area::default(), Area::joined)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIMS: Dims = Dims { width: 320, height: 240 };

    fn joined<const N: usize>(areas: [Area; N]) -> Areas {
        SearchRegions::new(Some(&areas), DIMS).areas.unwrap_or_default()
    }

    #[test]
    fn areas_are_joined_where_that_costs_less() {
        let at = |left, top| Area { left, top, right: left + 16, bottom: top + 16 };
        let [a, near, far] = [at(40, 40), at(60, 50), at(260, 190)];
        assert_eq!(joined([a; MAX_AREAS])[..], [a], "the same ones");
        assert_eq!(joined([a, far])[..], [a, far], "far from each other");
        assert_eq!(joined([a, far, near])[..], [a.joined(near), far]);
        // Of a row of them each brings the next one near.
        let row = core::array::from_fn::<_, 12, _>(|k| at(20 * (k as u16 * 7 % 12), 100));
        assert_eq!(joined(row)[..], [Area { left: 0, top: 100, right: 236, bottom: 116 }]);
        let whole = Area::of(DIMS);
        assert_eq!(joined([a, whole, far])[..], [whole]);
    }
}
