//! Rows around one pixel: gradients of both images and census codes of the right one, computed for
//! this pixel alone.
//!
//! In: the pair, a pixel, the disparities to compare. Out: strips of eight pixels for the kernels,
//! relative to the pixel.
//!
//! As in the band of a run, rows of the right image are stored mirrored, so that rising disparities
//! lie at rising addresses. Only columns that the search reads are computed. Rows outside the image
//! repeat the nearest one; columns outside are flat.
//!
//! # Bounds
//! A row has at most `len + 38` pixels for `len` disparities (whole blocks of 16), which is fewer
//! than a padded row of the band has.
//!
//! # Cost
//! Four planes of nine rows, in the memory of the run's band. At 64 disparities some 1500
//! instructions a row.

use crate::image::Gray;
use crate::kernel::{FLAT, LANES, STRIP, Strip, census_code, reverse_row};
use crate::matching::codes::{census, gradients};
use crate::row_memory::{BAND_ROWS, PLANES};
use core::ops::Range;

/// Rows above and below the pixel's, px.
pub(super) const ROWS_REACH: i32 = 4;
const ROWS: usize = 2 * ROWS_REACH as usize + 1;
/// Largest distance of a strip's columns from the middle one, px.
pub(super) const COLUMNS_REACH: i32 = 10;
/// Pixels computed beyond both ends of a row, whose own gradients and census codes are not valid.
const BORDER: i32 = 2;

/// Columns that a plane's rows hold, px.
#[derive(Clone, Copy, Debug, Default)]
struct Columns {
    first: i32,
    length: i32,
}

/// Gradients and census around a pixel.
#[derive(Debug)]
pub(super) struct Patch<'a> {
    left: Gray<'a>,
    right: Gray<'a>,
    x: i32,
    y: i32,
    /// Row of the right image that matches row 0 of the left one.
    row_offset: i32,
    stride: usize,
    /// Left gradients around the pixel.
    near: (&'a mut [u8], Columns),
    /// Right gradients, mirrored, in which they are searched; `census` holds the same columns.
    target: (&'a mut [u8], Columns),
    census: &'a mut [u8],
    /// Left gradients in which a right window is searched for the left-right check.
    back: (&'a mut [u8], Columns),
}

impl<'a> Patch<'a> {
    /// A patch in `rows`, the memory of a band whose rows are `stride` bytes long.
    pub(super) fn new(
        [left, right]: [Gray<'a>; 2],
        (x, y): (i32, i32),
        row_offset: i32,
        rows: &'a mut [u8],
        stride: usize,
    ) -> Self {
        const { assert!(4 * ROWS <= BAND_ROWS * PLANES) };
        let mut planes = rows.chunks_exact_mut((stride * ROWS).max(1));
        let mut plane = || (planes.next().unwrap_or_default(), Columns::default());
        Self {
            left,
            right,
            x,
            y,
            row_offset,
            stride,
            near: plane(),
            target: plane(),
            census: plane().0,
            back: plane(),
        }
    }

    /// Sum of absolute gradients around the pixel, and their number.
    pub(super) fn gradient_sum(&mut self) -> (u32, i32) {
        let (plane, columns) = &mut self.near;
        let reach = COLUMNS_REACH + BORDER;
        *columns = Columns { first: self.x - reach, length: 2 * reach };
        let (mut sum, mut count) = (0, 0);
        for (row, slot) in (self.y - ROWS_REACH..).zip(plane.chunks_exact_mut(self.stride.max(1))) {
            fill(slot, *columns, |columns, out| gradients(self.left, row, columns, out));
            for &gradient in slot.get(BORDER as usize..(2 * reach - BORDER) as usize).unwrap_or(&[])
            {
                sum += u32::from(gradient.abs_diff(FLAT));
                count += 1;
            }
        }
        (sum, count)
    }

    /// Computes the right rows that a search over the disparities `first .. first + len` reads;
    /// census codes of the rows `codes`, relative to the pixel's.
    pub(super) fn fill(&mut self, (first, len): (i32, i32), codes: &[i32]) {
        let len = whole_blocks(len);
        let reach = COLUMNS_REACH + BORDER;
        let columns =
            Columns { first: self.x - reach - (first + len - 1), length: 2 * reach + len - 1 };
        self.target.1 = columns;
        let top = self.y - ROWS_REACH + self.row_offset;
        for (row, slot) in (top..).zip(self.target.0.chunks_exact_mut(self.stride.max(1))) {
            fill(slot, columns, |columns, out| {
                gradients(self.right, row, columns, out);
                reverse_row(out);
            });
        }
        for (dy, slot) in (-ROWS_REACH..).zip(self.census.chunks_exact_mut(self.stride.max(1))) {
            if codes.contains(&dy) {
                fill(slot, columns, |columns, out| {
                    census(self.right, self.y + dy + self.row_offset, columns, out);
                    reverse_row(out);
                });
            }
        }
    }

    /// Computes the left rows `rows`, relative to the pixel's, that the left-right check of
    /// disparity `at` reads.
    pub(super) fn fill_back(&mut self, at: i32, (first, len): (i32, i32), rows: (i32, i32)) {
        let len = whole_blocks(len);
        let reach = COLUMNS_REACH + BORDER;
        let columns = Columns { first: self.x - at - reach + first, length: 2 * reach + len - 1 };
        self.back.1 = columns;
        for (dy, slot) in (-ROWS_REACH..).zip(self.back.0.chunks_exact_mut(self.stride.max(1))) {
            if (rows.0..=rows.1).contains(&dy) {
                fill(slot, columns, |columns, out| gradients(self.left, self.y + dy, columns, out));
            }
        }
    }

    fn row<'s>(&'s self, plane: &'s [u8], dy: i32) -> Option<&'s [u8]> {
        let start = usize::try_from(dy + ROWS_REACH).ok()?.checked_mul(self.stride)?;
        plane.get(start..)?.get(..self.stride)
    }

    /// Eight left pixels from `column` on, relative to the pixel, and the right row in which they
    /// are searched from disparity `first` on.
    pub(super) fn forward(&self, dy: i32, column: i32, first: i32) -> Option<Strip<'_>> {
        let at = usize::try_from(self.x + column - self.near.1.first).ok()?;
        let mut reference = *self.row(self.near.0, dy)?.get(at..)?.first_chunk::<STRIP>()?;
        reference.reverse();
        let start = self.mirrored(column, first)?;
        Some(Strip { reference, other: self.row(self.target.0, dy)?.get(start..)? })
    }

    /// Eight right pixels, those of `column` at disparity `at`, and the left row in which they are
    /// searched from disparity `first` on.
    pub(super) fn backward(&self, dy: i32, column: i32, at: i32, first: i32) -> Option<Strip<'_>> {
        let index = self.mirrored(column, at)?;
        let mut reference = *self.row(self.target.0, dy)?.get(index..)?.first_chunk::<STRIP>()?;
        reference.reverse();
        let start = usize::try_from(self.x + column - at + first - self.back.1.first).ok()?;
        Some(Strip { reference, other: self.row(self.back.0, dy)?.get(start..)? })
    }

    /// Census code of a left pixel, and the right codes that it is compared with; `None` where it
    /// has none.
    pub(super) fn census(&self, dy: i32, column: i32, first: i32) -> Option<(u8, &[u8])> {
        let (x, y) = (self.x + column, self.y + dy);
        let inside = |v: i32, side: u16| v >= 2 && v + 2 < i32::from(side);
        let dims = self.left.dims();
        if !inside(x, dims.width)
            || !inside(y, dims.height)
            || !self.left.valid_columns(y).contains(x)
        {
            return None;
        }
        let (pixels, stride) = self.left.as_slice();
        let corner = (y as usize - 2).wrapping_mul(stride).wrapping_add(x as usize - 2);
        let code = census_code(pixels, corner, stride)?;
        let start = self.mirrored(column + 1 - STRIP as i32, first)?;
        Some((code, self.row(self.census, dy)?.get(start..)?))
    }

    /// Index in a mirrored row of the eight right pixels that match those from `column` on at a
    /// disparity.
    fn mirrored(&self, column: i32, disparity: i32) -> Option<usize> {
        let Columns { first, length } = self.target.1;
        usize::try_from(first + length - STRIP as i32 - (self.x + column) + disparity).ok()
    }
}

fn whole_blocks(len: i32) -> i32 {
    (len + LANES as i32 - 1) & !(LANES as i32 - 1)
}

/// Fills the front of a row with `codes`.
fn fill(
    slot: &mut [u8],
    Columns { first, length }: Columns,
    codes: impl FnOnce(Range<i32>, &mut [u8]),
) {
    if let Some(out) = usize::try_from(length).ok().and_then(|length| slot.get_mut(..length)) {
        codes(first..first + length, out);
    }
}
