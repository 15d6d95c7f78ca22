//! Rectangles of pixels: boxes of a detector, and areas that are searched.

use crate::image::Dims;

/// Columns `left .. right` of the rows `top .. bottom`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(C)]
pub struct Area {
    /// First column, px.
    pub left: u16,
    /// First row, px.
    pub top: u16,
    /// Column after the last one, px.
    pub right: u16,
    /// Row after the last one, px.
    pub bottom: u16,
}

impl Area {
    /// All pixels of an image.
    #[must_use]
    pub const fn of(dims: Dims) -> Self {
        Self { left: 0, top: 0, right: dims.width, bottom: dims.height }
    }

    /// True without pixels.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.left >= self.right || self.top >= self.bottom
    }

    /// The pixels that are in both.
    #[must_use]
    pub fn common(self, other: Self) -> Self {
        Self {
            left: self.left.max(other.left),
            top: self.top.max(other.top),
            right: self.right.min(other.right),
            bottom: self.bottom.min(other.bottom),
        }
    }

    /// Bounding box of the pixels of both; an empty area is ignored.
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

    /// The area with `by` pixels more on every side, limited to the image.
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

    /// The pixels of half of the image that show it.
    pub(crate) const fn halved(self) -> Self {
        let Self { left, top, right, bottom } = self;
        Self { left: left / 2, top: top / 2, right: right.div_ceil(2), bottom: bottom.div_ceil(2) }
    }

    /// Number of pixels.
    #[must_use]
    pub const fn pixels(self) -> u32 {
        self.right.saturating_sub(self.left) as u32 * self.bottom.saturating_sub(self.top) as u32
    }

    /// True when the pixel lies in it.
    #[must_use]
    pub fn contains(self, x: i32, y: i32) -> bool {
        (i32::from(self.left)..i32::from(self.right)).contains(&x)
            && (i32::from(self.top)..i32::from(self.bottom)).contains(&y)
    }
}
