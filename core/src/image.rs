//! Grey images as borrowed views: the only place where image geometry is validated.
//!
//! In: a byte slice, its dimensions and the distance between rows. Out: a view whose rows cannot fail to exist.

use core::fmt;

/// Smallest accepted width and height: below this no window fits between the borders.
pub const MIN_SIDE: u16 = 16;
/// Largest accepted width: positions carry 1/32 px in 16 bits.
pub const MAX_WIDTH: u16 = 1280;
/// Largest accepted height, for the same reason as [`MAX_WIDTH`].
pub const MAX_HEIGHT: u16 = 1280;

/// Width and height of an image in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dims {
    /// Pixels in a row.
    pub width: u16,
    /// Rows.
    pub height: u16,
}

impl fmt::Display for Dims {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

/// Why a slice is not an image of the stated geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewError {
    /// A side is outside [`MIN_SIDE`] ..= [`MAX_WIDTH`] / [`MAX_HEIGHT`].
    Dims(Dims),
    /// The distance between rows is smaller than a row.
    Stride {
        /// The distance given.
        stride: usize,
        /// The least possible one.
        width: u16,
    },
    /// The slice ends before the last row does.
    TooShort {
        /// Bytes needed.
        needed: usize,
        /// Bytes given.
        given: usize,
    },
}

impl fmt::Display for ViewError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Dims(dims) => {
                write!(f, "an image of {dims} is outside {MIN_SIDE}x{MIN_SIDE} to {MAX_WIDTH}x{MAX_HEIGHT}")
            }
            Self::Stride { stride, width } => write!(f, "a stride of {stride} is shorter than a row of {width}"),
            Self::TooShort { needed, given } => write!(f, "the image needs {needed} bytes, {given} were given"),
        }
    }
}

impl core::error::Error for ViewError {}

/// A read-only 8-bit grey image, row-major, origin top left.
///
/// ```
/// use linestereo::{Dims, Gray};
/// let pixels = [7_u8; 20 * 16];
/// let view = Gray::new(&pixels, Dims { width: 16, height: 16 }, 20).unwrap(); // rows 20 bytes apart
/// assert_eq!(view.row(15), Some(&[7_u8; 16][..]));
/// assert_eq!(view.row(16), None);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Gray<'a> {
    pixels: &'a [u8],
    dims: Dims,
    stride: usize,
}

impl<'a> Gray<'a> {
    /// A view of `pixels`, rows `stride` bytes apart; the last row may end with the slice.
    pub fn new(pixels: &'a [u8], dims: Dims, stride: usize) -> Result<Self, ViewError> {
        let (width, height) = (dims.width, dims.height);
        if !(MIN_SIDE..=MAX_WIDTH).contains(&width) || !(MIN_SIDE..=MAX_HEIGHT).contains(&height) {
            return Err(ViewError::Dims(dims));
        }
        if stride < usize::from(width) {
            return Err(ViewError::Stride { stride, width });
        }
        let needed = stride.saturating_mul(usize::from(height).saturating_sub(1)).saturating_add(usize::from(width));
        if pixels.len() < needed {
            return Err(ViewError::TooShort { needed, given: pixels.len() });
        }
        Ok(Self { pixels, dims, stride })
    }

    /// Width and height.
    #[must_use]
    pub fn dims(self) -> Dims {
        self.dims
    }

    /// All bytes and the distance between rows, for code that walks along columns.
    pub(crate) fn as_slice(self) -> (&'a [u8], usize) {
        (self.pixels, self.stride)
    }

    /// Row `y`, `width` bytes, or `None` below the image.
    #[must_use]
    #[inline]
    pub fn row(self, y: usize) -> Option<&'a [u8]> {
        if y >= usize::from(self.dims.height) {
            return None;
        }
        let start = y.wrapping_mul(self.stride); // in range: `new` checked the last row
        self.pixels.get(start..)?.get(..usize::from(self.dims.width))
    }
}
