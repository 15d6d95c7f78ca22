//! Rectangles of pixels: what a detector's box covers, and what of an image is searched.

use crate::image::Dims;

/// Columns `left .. right` of the rows `top .. bottom`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub struct Area {
    /// First column.
    pub left: u16,
    /// First row.
    pub top: u16,
    /// The column after the last one.
    pub right: u16,
    /// The row after the last one.
    pub bottom: u16,
}

impl Area {
    /// All pixels of an image.
    #[must_use]
    pub const fn of(dims: Dims) -> Self {
        Self { left: 0, top: 0, right: dims.width, bottom: dims.height }
    }

    /// Without pixels?
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.left >= self.right || self.top >= self.bottom
    }

    /// The pixels of both.
    #[must_use]
    pub fn common(self, other: Self) -> Self {
        Self {
            left: self.left.max(other.left),
            top: self.top.max(other.top),
            right: self.right.min(other.right),
            bottom: self.bottom.min(other.bottom),
        }
    }

    /// The smallest area that has the pixels of both; an empty one has none.
    #[must_use]
    pub fn joined(self, other: Self) -> Self {
        if self.is_empty() {
            return other;
        }
        if other.is_empty() {
            return self;
        }
        Self {
            left: self.left.min(other.left),
            top: self.top.min(other.top),
            right: self.right.max(other.right),
            bottom: self.bottom.max(other.bottom),
        }
    }

    /// Larger by so many pixels on every side, as far as the image reaches.
    #[must_use]
    pub fn grown(self, by: u16, dims: Dims) -> Self {
        let grown = Self {
            left: self.left.saturating_sub(by),
            top: self.top.saturating_sub(by),
            right: self.right.saturating_add(by),
            bottom: self.bottom.saturating_add(by),
        };
        grown.common(Self::of(dims))
    }

    /// Number of pixels.
    #[must_use]
    pub const fn pixels(self) -> u32 {
        self.right.saturating_sub(self.left) as u32 * self.bottom.saturating_sub(self.top) as u32
    }

    /// Does the pixel belong to it?
    #[must_use]
    pub fn contains(self, x: i32, y: i32) -> bool {
        (i32::from(self.left)..i32::from(self.right)).contains(&x)
            && (i32::from(self.top)..i32::from(self.bottom)).contains(&y)
    }
}
