//! Search range: images of one size, disparities from 0.

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
    pub(crate) fn width(&self) -> usize {
        self.dims.width.into()
    }

    /// Height in px.
    pub(crate) fn height(&self) -> usize {
        self.dims.height.into()
    }

    /// The first left column that has all its disparities in the right image.
    pub(crate) fn first(&self) -> usize {
        self.count - 1
    }

    /// Left columns that have all their disparities in the right image.
    pub(crate) fn columns(&self) -> usize {
        self.width().saturating_sub(self.first())
    }
}
