//! Search range: images of one size, disparities from 0, the windows that fit.

use super::window::Window;
use core::ops::Range;
use linestereo::Dims;

/// Search range: images of one size, disparities `0 .. count`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Search {
    /// Size of both images.
    pub dims: Dims,
    /// Disparities searched, from 0.
    pub count: usize,
}

impl Search {
    /// Disparities `0 ..= largest`, but whole groups of 16, as OpenCV counts them: 64 is `0 .. 64`.
    #[must_use]
    pub fn up_to(dims: Dims, largest: u16) -> Self {
        Self { dims, count: usize::from(largest.max(1)).next_multiple_of(16) }
    }

    /// Width in px.
    #[must_use]
    pub fn width(&self) -> usize {
        self.dims.width.into()
    }

    /// Height in px.
    #[must_use]
    pub fn height(&self) -> usize {
        self.dims.height.into()
    }

    /// The first left column that has all its disparities in the right image.
    #[must_use]
    pub fn first(&self) -> usize {
        self.count - 1
    }

    /// Left columns that have all their disparities in the right image.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.width().saturating_sub(self.first())
    }

    /// Columns at which a window lies inside both images at every disparity.
    #[must_use]
    pub fn window_columns(&self, window: &Window) -> Range<usize> {
        let start = self.first() + window.half_columns();
        start..self.width().saturating_sub(window.half_columns()).max(start)
    }

    /// Rows at which a window lies inside the images.
    #[must_use]
    pub fn window_rows(&self, window: &Window) -> Range<usize> {
        let start = window.half_rows();
        start..self.height().saturating_sub(window.half_rows()).max(start)
    }
}
