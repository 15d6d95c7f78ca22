//! Where a support point stands: in the middle of its window's texture, since that is what is
//! matched, and not the middle of the window.
//!
//! In: the codes of a window and of a column on each side. Out: a pixel in the point's square of
//! the grid.
//!
//! # Cost
//! Some 160 instructions a point that is matched.

use super::codes::WINDOW_COLUMNS;
use crate::kernel::{CodeColumn, CodeMoments, code_moments};

/// Least offset of a point from its place in the grid, px.
pub(super) const LEAST: i32 = -4;
/// Largest offset.
pub(super) const MOST: i32 = 3;

/// Bit of a point beside the ground plane.
const ON_PLANE: u8 = 8;

/// Offset of a point from its place in the grid, [`LEAST`] ..= [`MOST`] px across and down.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Place(u8);

impl Place {
    /// No offset.
    pub(crate) const MIDDLE: Self = Self(0x44);

    /// The centroid of a window's squared changes of codes along the row; the window begins `start`
    /// px from the place in the grid.
    pub(super) fn of(columns: &[CodeColumn; WINDOW_COLUMNS + 2], start: i32) -> Self {
        let CodeMoments { all, across, down } = code_moments(columns);
        if all == 0 {
            return Self::MIDDLE;
        }
        // Rounded to nearest. Changes along the row are of four rows of pixels each, whose middles
        // are at -2.5, -0.5, 1.5 and 3.5 px.
        let nearest = |doubled: u32| (doubled + all).checked_div(2 * all).unwrap_or(0) as i32;
        Self::new(start + nearest(2 * across), nearest(4 * down + all) - 3)
    }

    fn new(dx: i32, dy: i32) -> Self {
        let offset = |at: i32| (at.clamp(LEAST, MOST) - LEAST) as u8;
        Self(offset(dx) | offset(dy) << 4)
    }

    /// The same place of a point whose disparity is a label beside the ground plane.
    pub(super) const fn on_plane(self) -> Self {
        Self(self.0 | ON_PLANE)
    }

    /// True when the point's disparity is a label beside the ground plane.
    pub(crate) const fn is_on_plane(self) -> bool {
        self.0 & ON_PLANE != 0
    }

    /// The place so many px to the right and downward, in the same square of the grid.
    pub(super) fn moved(self, dx: i32, dy: i32) -> Self {
        Self(Self::new(self.dx() + dx, self.dy() + dy).0 | self.0 & ON_PLANE)
    }

    /// To the right, px.
    pub(crate) fn dx(self) -> i32 {
        i32::from(self.0 & 7) + LEAST
    }

    /// Downward, px.
    pub(crate) fn dy(self) -> i32 {
        i32::from(self.0 >> 4) + LEAST
    }
}
