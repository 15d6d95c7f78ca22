//! Ranks of the rows that the windows of a row of support points cover.
//!
//! In: both images. Out: the window of a point in the left image, and the columns of the right one from any column on; a column is four ranks, of
//! every second row.
//!
//! # Bounds
//! Windows of two rows of points share no row of the image: 7 rows, points 8 rows apart.
//!
//! # Cost
//! 6 instructions a pixel of every second row, and 6 for their order by columns (Armv7E-M), whatever the picture.

use crate::image::Gray;
use crate::kernel::{RANK_FLAT, RANK_ROWS, RankColumn, STRIP, rank_columns, rank_row};

/// Width of a window, px.
pub(super) const WINDOW_COLUMNS: usize = STRIP;
/// Number of pixels at both ends of a row whose neighbours lie outside of it.
pub(super) const BORDER: i32 = 2;
/// First and last row of a window, relative to its point.
const WINDOW: [i32; 2] = [-4, 2];
/// Distance between the rows of a window, px.
const ROW_STEP: usize = 2;

/// Bytes of memory for images of this width.
pub(super) const fn bytes(width: u16) -> usize {
    3 * RANK_ROWS * width as usize
}

/// Ranks of the rows around a row of points, of both images.
pub(super) struct RankRows<'a> {
    images: [Gray<'a>; 2],
    row_offset: i32,
    columns: [&'a mut [RankColumn]; 2],
    /// One image's ranks row by row.
    rows: &'a mut [u8],
}

impl<'a> RankRows<'a> {
    pub(super) fn new(images: [Gray<'a>; 2], row_offset: i32, memory: &'a mut [u8]) -> Option<Self> {
        let [left, _] = images;
        let width = left.dims().width;
        let (columns, rows) =
            memory.get_mut(..bytes(width))?.split_at_mut_checked(2 * RANK_ROWS * usize::from(width))?;
        let (left, right) = columns.as_chunks_mut().0.split_at_mut_checked(width.into())?;
        Some(Self { images, row_offset, columns: [left, right], rows })
    }

    /// Computes the ranks of the rows around row `y`.
    pub(super) fn code(&mut self, y: i32) {
        let [left, right] = self.images;
        let width = usize::from(left.dims().width);
        for ((image, y), columns) in [(left, y), (right, y + self.row_offset)].into_iter().zip(&mut self.columns) {
            let [first, last] = WINDOW.map(|row| y + row);
            for (y, row) in (first..=last).step_by(ROW_STEP).zip(self.rows.chunks_exact_mut(width.max(1))) {
                code(image, y, row);
            }
            rank_columns(self.rows, columns);
        }
    }

    /// The window that begins at column `x` of the left image, and the columns of the right one from `first` on.
    pub(super) fn windows(&self, x: i32, first: i32) -> Option<(&[RankColumn; WINDOW_COLUMNS], &[RankColumn])> {
        let [left, right] = &self.columns;
        let window = left.get(usize::try_from(x).ok()?..)?.first_chunk()?;
        Some((window, right.get(usize::try_from(first).ok()?..)?))
    }
}

/// Ranks of a row; rows outside the image repeat the nearest one. Pixels that are not valid get the rank of flat ones.
fn code(image: Gray<'_>, y: i32, out: &mut [u8]) {
    let last = i32::from(image.dims().height) - 1;
    let rows = [y - 2, y, y + 2].map(|y| image.row(y.max(0).min(last) as usize).unwrap_or(&[]));
    rank_row(rows, out);
    let valid = image.valid_columns(y);
    let (start, end) = (usize::from(valid.start), usize::from(valid.end));
    if let Some(before) = out.get_mut(..start) {
        before.fill(RANK_FLAT);
    }
    if let Some(after) = out.get_mut(end..) {
        after.fill(RANK_FLAT);
    }
}
