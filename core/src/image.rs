//! Grey images as borrowed views: the only place where image geometry is validated.
//!
//! In: a byte slice, its dimensions and the distance between rows. Out: a view all of whose rows
//! exist.
//!
//! # Cost
//! Rows are checked once, when a view is made.

use core::fmt;

/// Smallest accepted width and height: below this no window fits between the borders.
pub const MIN_SIDE: u16 = 16;
/// Largest accepted width: positions carry 1/32 px in 16 bits. Without the feature `wide` only
/// images are accepted that are matched at their own size.
pub const MAX_WIDTH: u16 = if cfg!(feature = "wide") { 1280 } else { WIDEST };
/// Largest accepted height: positions carry 1/32 px in 16 bits.
pub const MAX_HEIGHT: u16 = 1280;

/// Width and height of an image in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Dims {
    /// Width, px.
    pub width: u16,
    /// Height, px.
    pub height: u16,
}

/// Widest image that is matched, and searched for the ground, at its own size, px. In wider ones a
/// small window finds its like among twice as many disparities (`docs/experiments.md`).
pub(crate) const WIDEST: u16 = 450;

impl Dims {
    /// True for images that are matched at half of their size first.
    pub(crate) const fn is_large(self) -> bool {
        MAX_WIDTH > WIDEST && self.width > WIDEST
    }
}

/// Sets a row of half of an image: means of 2 x 2 pixels of these rows.
pub(crate) fn halve_rows(upper: &[u8], lower: &[u8], half: &mut [u8]) {
    let pairs = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
    for (mean, (&[a, b], &[c, d])) in half.iter_mut().zip(pairs) {
        *mean = ((u16::from(a) + u16::from(b) + u16::from(c) + u16::from(d) + 2) >> 2) as u8;
    }
}

/// Columns `start .. end` of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(C)]
pub struct Span {
    /// First column, px.
    pub start: u16,
    /// Column after the last one, px; equal to `start` when there is none.
    pub end: u16,
}

impl Span {
    /// True when column `x` is one of them.
    #[must_use]
    pub fn contains(self, x: i32) -> bool {
        (i32::from(self.start)..i32::from(self.end)).contains(&x)
    }

    fn common(self, other: Self) -> Self {
        let start = self.start.max(other.start);
        Self { start, end: self.end.min(other.end).max(start) }
    }
}

/// Largest distance of pixels that are read from a valid one, px.
pub const MARGIN: u16 = 4;

/// Spans of pixels with content -> spans of pixels that are valid: everything within [`MARGIN`] of
/// them has content. Pixels outside the image count as content, because borders are handled
/// everywhere. `spans` has the rows of the image in order; the result holds for all frames.
///
/// ```
/// use linestereo::image::Span;
/// use linestereo::image::shrink_to_valid;
/// let mut spans = [Span { start: 3, end: 40 }; 20];
/// spans[0].end = 0; // nothing in the first row
/// shrink_to_valid(&mut spans, 40);
/// assert!(spans[..5].iter().all(|span| span.start == span.end));
/// assert!(spans[5..].iter().all(|&span| span == Span { start: 7, end: 40 }));
/// ```
pub fn shrink_to_valid(spans: &mut [Span], width: u16) {
    for _ in 0..MARGIN {
        let mut above = None::<Span>;
        for y in 0..spans.len() {
            let below = spans.get(y + 1).copied();
            let Some(span) = spans.get_mut(y) else { break };
            let here = *span;
            *span = [above, below].into_iter().flatten().fold(here, Span::common);
            above = Some(here);
        }
    }
    for span in spans {
        let start = if span.start > 0 { span.start.saturating_add(MARGIN) } else { 0 };
        let end = if span.end < width { span.end.saturating_sub(MARGIN) } else { span.end };
        *span = if start < end { Span { start, end } } else { Span::default() };
    }
}

impl fmt::Display for Dims {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

/// As [`Display`](fmt::Display).
#[cfg(feature = "defmt")]
impl defmt::Format for Dims {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "{=u16}x{=u16}", self.width, self.height);
    }
}

/// Reason why a slice is not an image of the given geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ViewError {
    /// A side is outside [`MIN_SIDE`] ..= [`MAX_WIDTH`] / [`MAX_HEIGHT`].
    #[error("an image of {0} is outside {MIN_SIDE}x{MIN_SIDE} to {MAX_WIDTH}x{MAX_HEIGHT}")]
    Dims(Dims),
    /// The distance between rows is smaller than a row.
    #[error("a stride of {stride} is shorter than a row of {width}")]
    Stride {
        /// Distance given, bytes.
        stride: usize,
        /// Least possible distance, bytes.
        width: u16,
    },
    /// The slice ends before the last row does.
    #[error("the image needs {needed} bytes, {given} were given")]
    TooShort {
        /// Bytes needed.
        needed: usize,
        /// Bytes given.
        given: usize,
    },
    /// The number of spans of valid pixels is not that of rows.
    #[error("an image of {rows} rows has {given} spans of valid pixels")]
    Spans {
        /// Rows of the image.
        rows: u16,
        /// Spans given.
        given: usize,
    },
    /// The span of this row starts after its end, or ends outside the image.
    #[error("the valid pixels {} .. {} of row {row} are no part of the image", .span.start, .span.end)]
    Span {
        /// The row.
        row: usize,
        /// Its span.
        span: Span,
    },
}

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
    valid: &'a [Span],
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
        let needed = stride
            .saturating_mul(usize::from(height).saturating_sub(1))
            .saturating_add(usize::from(width));
        if pixels.len() < needed {
            return Err(ViewError::TooShort { needed, given: pixels.len() });
        }
        Ok(Self { pixels, dims, stride, valid: &[] })
    }

    /// The view restricted to these pixels, a span for each row: edges and disparities lie in them,
    /// and pixels more than [`MARGIN`] px outside never influence a result. See
    /// [`shrink_to_valid`].
    pub fn with_valid(self, spans: &'a [Span]) -> Result<Self, ViewError> {
        if spans.len() != usize::from(self.dims.height) {
            return Err(ViewError::Spans { rows: self.dims.height, given: spans.len() });
        }
        match spans.iter().position(|span| span.start > span.end || span.end > self.dims.width) {
            Some(row) => {
                Err(ViewError::Span { row, span: spans.get(row).copied().unwrap_or_default() })
            }
            None => Ok(Self { valid: spans, ..self }),
        }
    }

    /// The spans of [`Gray::with_valid`]; empty when every pixel is valid.
    #[must_use]
    pub fn valid(self) -> &'a [Span] {
        self.valid
    }

    /// Valid columns of a row; above and below the image those of the nearest row.
    #[inline]
    pub(crate) fn valid_columns(self, y: i32) -> Span {
        let last = i32::from(self.dims.height) - 1;
        let whole = Span { start: 0, end: self.dims.width };
        self.valid.get(y.max(0).min(last) as usize).copied().unwrap_or(whole)
    }

    /// Width and height.
    #[must_use]
    pub fn dims(self) -> Dims {
        self.dims
    }

    /// All bytes and the distance between rows, bytes, for access along columns.
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
