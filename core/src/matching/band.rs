//! A band of rows with their horizontal gradients and census codes, moved down the pair as matching
//! proceeds.
//!
//! In: the two images. Out: padded rows of both, computed once per frame, held for [`BAND_ROWS`]
//! rows.
//!
//! Rows of the right image are stored mirrored, so that for a fixed left pixel rising disparities
//! lie at rising addresses.
//!
//! # Cost
//! `PLANES * BAND_ROWS * row_bytes(width)` bytes. A whole gradient image of both views would take
//! the memory of the frames again.

use super::codes::{census, gradients};
use crate::area::Area;
use crate::image::{Dims, Gray, Span};
use crate::kernel::{FLAT, STRIP, Strip, census_code, portable, reverse_row};
use crate::lines::Segment;
use crate::row_memory::{BAND_ROWS, PAD, PLANES, row_bytes};
use crate::units::quotient;

/// Distance between rows of the band, px.
pub(crate) const ROW_STEP: i32 = 2;
/// Reach of windows above and below a near-horizontal segment, px; other windows end with their
/// segment.
const WINDOW_REACH: i32 = 6;

/// Reach of windows beside their segment, 10 px, and two columns whose values at the end of a row
/// are not valid.
const WINDOW_COLUMNS: i32 = 12;

/// Reach beside a segment within which the left image may repeat it, px.
pub(crate) const REPEAT_REACH: i32 = 96;

/// One quantity of both images.
struct Planes<'a> {
    left: &'a mut [u8],
    right_mirrored: &'a mut [u8],
}

/// The rows around the current position.
pub(crate) struct Band<'a> {
    images: [Gray<'a>; 2],
    gradient: Planes<'a>,
    /// Codes of the right image, mirrored; left codes are computed for single points.
    census: &'a mut [u8],
    width: usize,
    height: i32,
    stride: usize,
    /// First row computed.
    first_row: i32,
    next_row: i32,
    /// Row of the right image that matches row 0 of the left one.
    row_offset: i32,
    /// Pixels that windows reach; all without.
    extents: Option<&'a [WindowExtent]>,
}

/// Rows and columns that windows may reach.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WindowExtent {
    /// Rows of the left image.
    rows: Span,
    /// Columns of the left and of the right image.
    columns: [Span; 2],
}

impl WindowExtent {
    /// The extent of windows of segments in an area, at disparities `min .. max`.
    pub(crate) fn around(area: Area, (min, max): (i32, i32), dims: Dims) -> Self {
        let span = |from: i32, to: i32, size: u16| {
            let inside = |at: i32| u16::try_from(at.max(0)).unwrap_or(u16::MAX).min(size);
            Span { start: inside(from), end: inside(to) }
        };
        let Area { left, top, right, bottom } = area;
        let rows = span(
            i32::from(top) - WINDOW_REACH - ROW_STEP,
            i32::from(bottom) + WINDOW_REACH + ROW_STEP,
            dims.height,
        );
        let (first, end) = (i32::from(left) - WINDOW_COLUMNS, i32::from(right) + WINDOW_COLUMNS);
        let columns = [(first - REPEAT_REACH, end + REPEAT_REACH), (first - max, end - min)];
        Self { rows, columns: columns.map(|(first, end)| span(first, end, dims.width)) }
    }
}

impl<'a> Band<'a> {
    /// A band in `rows`, memory of three planes of [`BAND_ROWS`] padded rows. With `extents`, only
    /// the pixels in them are computed.
    pub(crate) fn new(
        [left, right]: [Gray<'a>; 2],
        row_offset: i32,
        extents: Option<&'a [WindowExtent]>,
        rows: &'a mut [u8],
    ) -> Option<Self> {
        let dims = left.dims();
        let stride = row_bytes(dims.width);
        let plane = stride * BAND_ROWS;
        let rows = rows.get_mut(..plane * PLANES)?;
        rows.fill(FLAT);
        let (gradients, census) = rows.split_at_mut_checked(plane * 2)?;
        let (left_gradient, right_gradient) = gradients.split_at_mut_checked(plane)?;
        Some(Self {
            images: [left, right],
            gradient: Planes { left: left_gradient, right_mirrored: right_gradient },
            census,
            width: dims.width.into(),
            height: dims.height.into(),
            stride,
            first_row: 0,
            next_row: 0,
            row_offset,
            extents,
        })
    }

    /// Valid columns of the right image at a row of the left one.
    pub(crate) fn right_columns(&self, y: i32) -> (i32, i32) {
        let [_, right] = self.images;
        let Span { start, end } = right.valid_columns(y + self.row_offset);
        (start.into(), end.into())
    }

    /// True when not all pixels of the right image are valid.
    pub(crate) fn is_restricted(&self) -> bool {
        let [_, right] = self.images;
        !right.valid().is_empty()
    }

    /// Columns of an image.
    pub(crate) fn width(&self) -> i32 {
        self.width as i32
    }

    /// Padded gradients of a row that the band holds: of the left image, and of the right one,
    /// mirrored.
    pub(crate) fn gradient_rows(&self, y: i32) -> Option<(&[u8], &[u8])> {
        self.rows(&self.gradient, y)
    }

    /// Computes the rows that the windows of `segment` reach; its top row is not above that of the
    /// segment before. Calls `watch` with each computed row: left gradients, right gradients, right
    /// census codes, the right ones mirrored.
    pub(crate) fn advance_for(
        &mut self,
        segment: &Segment,
        watch: &mut dyn FnMut([&[u8]; PLANES]),
    ) {
        let (_, y0, _, y1) = segment.ends_q5();
        let reach = if segment.near_horizontal { WINDOW_REACH } else { 0 };
        // Where parts of the image are matched, rows between them are not needed.
        let first = (segment.top() - WINDOW_REACH) / ROW_STEP * ROW_STEP;
        if first > self.next_row {
            (self.first_row, self.next_row) = (first, first);
        }
        self.advance(((y0.max(y1) + 31) >> 5) + reach, watch);
    }

    /// Computes rows up to and including `last`; overwrites rows that are [`BAND_ROWS`] rows of the
    /// band older.
    #[inline(never)] // one copy, whoever watches
    fn advance(&mut self, last: i32, watch: &mut dyn FnMut([&[u8]; PLANES])) {
        while self.next_row <= last.min(self.height - 1) {
            let y = self.next_row;
            self.next_row += ROW_STEP;
            let [left, right] = self.images;
            let start = self.start(y);
            let [left_columns, right_columns] = self.columns(y);
            let indices = |columns: Span| {
                start + usize::from(columns.start)..start + usize::from(columns.end)
            };
            let ends = |columns: Span| columns.start.into()..columns.end.into();
            if let Some(out) = self.gradient.left.get_mut(indices(left_columns)) {
                gradients(left, y, ends(left_columns), out);
            }
            // Mirrored, the last column comes first.
            let width = self.width as u16;
            let Span { start: first, end } = right_columns;
            let mirrored = indices(Span {
                start: width.saturating_sub(end),
                end: width.saturating_sub(first),
            });
            if let Some(out) = self.gradient.right_mirrored.get_mut(mirrored.clone()) {
                gradients(right, y + self.row_offset, ends(right_columns), out);
                reverse_row(out);
            }
            if let Some(out) = self.census.get_mut(mirrored.clone()) {
                census(right, y + self.row_offset, ends(right_columns), out);
                reverse_row(out);
            }
            let Planes { left, right_mirrored } = &self.gradient;
            if let (Some(left), Some(right), Some(census)) = (
                left.get(indices(left_columns)),
                right_mirrored.get(mirrored.clone()),
                self.census.get(mirrored),
            ) {
                watch([left, right, census]);
            }
        }
    }

    /// Columns of both images to compute for a row of the left one.
    fn columns(&self, y: i32) -> [Span; 2] {
        let Some(extents) = self.extents else {
            return [Span { start: 0, end: self.width as u16 }; 2];
        };
        let of_row = extents
            .iter()
            .filter(|extents| extents.rows.contains(y))
            .map(|extents| extents.columns);
        of_row.reduce(|[a, b], [c, d]| [join(a, c), join(b, d)]).unwrap_or_default()
    }

    /// Index of a row's column 0 in a plane.
    fn start(&self, y: i32) -> usize {
        ((y.max(0) / ROW_STEP) as usize % BAND_ROWS) * self.stride + PAD
    }

    #[inline(always)]
    fn row(plane: &[u8], stride: usize, y: i32) -> Option<&[u8]> {
        let start = (y as usize / ROW_STEP as usize % BAND_ROWS) * stride;
        plane.get(start..start + stride)
    }

    /// Eight gradients at `x..x + 8` of row `y` of the left image, and the right row in which they
    /// are searched from disparity `first` on.
    #[inline]
    pub(crate) fn strip(&self, x: i32, y: i32, first: i32) -> Option<Strip<'_>> {
        let (reference, other) = self.rows(&self.gradient, y)?;
        self.strip_of(reference, other, x, first)
    }

    /// Three strips of the same row, or none.
    pub(crate) fn strips(&self, [a, b, c]: [i32; 3], y: i32, first: i32) -> Option<[Strip<'_>; 3]> {
        let (reference, other) = self.rows(&self.gradient, y)?;
        Some([
            self.strip_of(reference, other, a, first)?,
            self.strip_of(reference, other, b, first)?,
            self.strip_of(reference, other, c, first)?,
        ])
    }

    #[inline(always)] // called, three strips take seven times as long
    fn strip_of<'s>(
        &self,
        reference: &[u8],
        other: &'s [u8],
        x: i32,
        first: i32,
    ) -> Option<Strip<'s>> {
        let (at, target) = self.indices(x, STRIP as i32, first)?;
        let &[a, b, c, d, e, f, g, h] = reference.get(at..)?.first_chunk::<STRIP>()?;
        Some(Strip { reference: [h, g, f, e, d, c, b, a], other: other.get(target..)? })
    }

    /// The census code at `(x, y)` of the left image, and the codes it is compared with from
    /// disparity `first` on.
    #[inline]
    pub(crate) fn census(&self, x: i32, y: i32, first: i32) -> Option<(u8, &[u8])> {
        if !self.holds(y) || x < 0 || x >= self.width as i32 {
            return None;
        }
        let other = Self::row(self.census, self.stride, y)?;
        let (_, target) = self.indices(x, 1, first)?;
        let [left, _] = self.images;
        let is_valid = left.valid().is_empty() || left.valid_columns(y).contains(x);
        let has_code = is_valid && x >= 2 && x + 2 < self.width as i32;
        let code = if has_code { self.left_code(x, y) } else { 0 };
        Some((code, other.get(target..)?))
    }

    #[inline(always)] // called once
    fn left_code(&self, x: i32, y: i32) -> u8 {
        let [left, _] = self.images;
        let (pixels, stride) = left.as_slice();
        if y >= 2 && y + 2 < self.height {
            let first = (y as usize - 2).wrapping_mul(stride).wrapping_add(x as usize - 2);
            return census_code(pixels, first, stride).unwrap_or(0);
        }
        border_code(left, x, y)
    }

    #[inline]
    fn holds(&self, y: i32) -> bool {
        y >= (self.next_row - BAND_ROWS as i32 * ROW_STEP).max(self.first_row) && y < self.next_row
    }

    #[inline]
    fn rows<'s>(&'s self, planes: &'s Planes<'_>, y: i32) -> Option<(&'s [u8], &'s [u8])> {
        if !self.holds(y) {
            return None;
        }
        let left = Self::row(planes.left, self.stride, y)?;
        let right = Self::row(planes.right_mirrored, self.stride, y)?;
        Some((left, right))
    }

    /// Index of the `length` pixels from column `x` on in the left row, and of those at disparity
    /// `first` in the mirrored right one.
    #[inline(always)]
    fn indices(&self, x: i32, length: i32, first: i32) -> Option<(usize, usize)> {
        let mirrored = PAD as i32 + self.width as i32 - length - x;
        Some((usize::try_from(PAD as i32 + x).ok()?, usize::try_from(mirrored + first).ok()?))
    }
}

fn join(a: Span, b: Span) -> Span {
    Span { start: a.start.min(b.start), end: a.end.max(b.end) }
}

/// The census code of a pixel near the top or the bottom: rows outside the image repeat the nearest
/// one.
#[cold]
fn border_code(image: Gray<'_>, x: i32, y: i32) -> u8 {
    let mut patch = [0; 25];
    for (five, y) in patch.as_chunks_mut::<5>().0.iter_mut().zip(y - 2..) {
        let row = clamped_row(image, y).get(x as usize - 2..).and_then(|row| row.first_chunk());
        *five = row.copied().unwrap_or_default();
    }
    portable::census_code(&patch, 0, 5).unwrap_or(0)
}

fn clamped_row(image: Gray<'_>, y: i32) -> &[u8] {
    let last = i32::from(image.dims().height) - 1;
    image.row(y.max(0).min(last) as usize).unwrap_or(&[])
}

/// Evenly spaced rows of the band between two rows, with an upper limit on their number.
#[derive(Clone, Copy)]
pub(crate) struct SampledRows {
    next: i32,
    last: i32,
    step: i32,
}

impl SampledRows {
    /// At most `most` rows of `first ..= last`.
    pub(crate) fn new((first, last): (i32, i32), most: i32) -> Self {
        let there = quotient(last - first + ROW_STEP, ROW_STEP);
        Self {
            next: on_band(first + ROW_STEP - 1),
            last,
            step: ROW_STEP * quotient(there + most - 1, most).max(1),
        }
    }

    /// Mean row, in half rows.
    pub(crate) fn centre_q1(self) -> i32 {
        2 * self.next + self.step * (self.count() - 1).max(0)
    }

    pub(crate) fn count(self) -> i32 {
        if self.next > self.last { 0 } else { quotient(self.last - self.next, self.step) + 1 }
    }
}

impl Iterator for SampledRows {
    type Item = i32;

    fn next(&mut self) -> Option<i32> {
        let row = self.next;
        if row > self.last {
            return None;
        }
        self.next += self.step;
        Some(row)
    }
}

/// The nearest row of the band at or above `y`.
pub(crate) fn on_band(y: i32) -> i32 {
    y & !(ROW_STEP - 1)
}
