//! Pixels of one detected object: a box, or a mask as runs of pixels.
//!
//! In: a box or the runs of a mask, and the size of the images. Out: a [`Region`] with at least one
//! pixel in the image.
//!
//! # Cost
//! A box is eight bytes; a mask eight bytes per run, at least one run per row. No image-sized mask
//! is ever needed.

use crate::area::Area;
use crate::image::{Dims, Span};

/// Adjacent pixels of one row with the same label.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(C)]
pub struct Run {
    /// Label of the object that they belong to.
    pub label: u16,
    /// Row, px.
    pub y: u16,
    /// Columns, px.
    pub span: Span,
}

/// Widest hole in a run, px: no two things that bars are matched for stand so close.
const HOLE: u16 = 2;

/// Representation of a region's pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape<'a> {
    /// All of an area.
    Box,
    /// The runs with the region's label, sorted by row and column; runs with other labels may lie
    /// between them.
    Mask(&'a [Run]),
}

/// Pixels of one detected object.
///
/// ```
/// use linestereo::{Area, Dims, Region};
/// use linestereo::objects::RegionError;
/// let dims = Dims { width: 320, height: 240 };
/// let cut = Region::boxed(3, Area { left: 300, top: 10, right: 400, bottom: 60 }, dims).unwrap();
/// assert_eq!(cut.area().right, 320);
/// let outside = Area { left: 320, top: 10, right: 400, bottom: 60 };
/// assert_eq!(Region::boxed(3, outside, dims), Err(RegionError::Outside));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region<'a> {
    label: u16,
    area: Area,
    shape: Shape<'a>,
}

/// Reason why a box or mask is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RegionError {
    /// It has no pixel.
    #[error("a region without pixels")]
    Empty,
    /// None of its pixels lies in the image.
    #[error("a region outside of the image")]
    Outside,
    /// The run at this position of the mask starts after its end, does not lie behind the one
    /// before, or ends outside of the image.
    #[error("run {0} of the mask is empty, outside of the image, or not behind the run before it")]
    Run(u32),
}

impl<'a> Region<'a> {
    /// A box, cut to the image.
    pub fn boxed(label: u16, area: Area, dims: Dims) -> Result<Self, RegionError> {
        if area.is_empty() {
            return Err(RegionError::Empty);
        }
        let area = area.common(Area::of(dims));
        if area.is_empty() {
            Err(RegionError::Outside)
        } else {
            Ok(Self { label, area, shape: Shape::Box })
        }
    }

    /// The pixels of a mask that have this label. Its runs are sorted by row, then by column, and
    /// do not overlap.
    pub fn masked(label: u16, runs: &'a [Run], dims: Dims) -> Result<Self, RegionError> {
        let mut area = Area::default();
        let mut before = None::<Run>;
        for (run, index) in runs.iter().zip(0_u32..) {
            let Run { y, span: Span { start, end }, .. } = *run;
            let is_behind = before.is_none_or(|b| y > b.y || (y == b.y && start >= b.span.end));
            if !is_behind || start >= end || end > dims.width || y >= dims.height {
                return Err(RegionError::Run(index));
            }
            before = Some(*run);
            if run.label == label {
                area = area.joined(Area { left: start, top: y, right: end, bottom: y + 1 });
            }
        }
        if area.is_empty() {
            Err(RegionError::Empty)
        } else {
            Ok(Self { label, area, shape: Shape::Mask(runs) })
        }
    }

    /// Label given by the detector.
    #[must_use]
    pub fn label(&self) -> u16 {
        self.label
    }

    /// Bounding box of its pixels.
    #[must_use]
    pub fn area(&self) -> Area {
        self.area
    }

    /// Box or mask.
    #[must_use]
    pub fn shape(&self) -> Shape<'a> {
        self.shape
    }

    /// A mask's first run in a row that ends behind a column, with those that holes part from it;
    /// none of a box.
    pub(crate) fn run(&self, y: u16, column: u16) -> Option<Span> {
        let Shape::Mask(runs) = self.shape else { return None };
        let first = runs.partition_point(|run| (run.y, run.span.end) <= (y, column));
        let row = runs.get(first..)?.iter().take_while(|run| run.y == y);
        let mut own = row.filter(|run| run.label == self.label).map(|run| run.span);
        let Span { start, mut end } = own.next()?;
        while let Some(next) = own.next().filter(|next| next.start.saturating_sub(end) <= HOLE) {
            end = next.end;
        }
        Some(Span { start, end })
    }

    /// True when the pixel belongs to the region.
    #[must_use]
    pub fn contains(&self, x: i32, y: i32) -> bool {
        self.area.contains(x, y)
            && match self.shape {
                Shape::Box => true,
                Shape::Mask(runs) => {
                    let first = runs.partition_point(|run| i32::from(run.y) < y);
                    let row = runs
                        .get(first..)
                        .unwrap_or(&[])
                        .iter()
                        .take_while(|run| i32::from(run.y) == y);
                    row.into_iter().any(|run| run.label == self.label && run.span.contains(x))
                }
            }
    }
}
