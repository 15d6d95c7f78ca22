//! Ranks of the rows that the windows of a row of support points cover.
//!
//! In: both images. Out: the window of a point in the left image, and the columns of the right one from any column on; a column is four ranks, of
//! every second row.
//!
//! # Bounds
//! Windows of two rows of points share no row of the image: 7 rows, points 8 rows apart.
//!
//! # Cost
//! 21 instructions a column of four rows (Armv7E-M), whatever the picture.

use crate::image::Gray;
use crate::kernel::{RANK_FLAT, RANK_ROWS, RankColumn, STRIP, rank_columns};

/// Width of a window, px.
pub(super) const WINDOW_COLUMNS: usize = STRIP;
/// Number of pixels at both ends of a row whose neighbours lie outside of it.
pub(super) const BORDER: i32 = 2;
/// Distance between the rows of a window, px: -4, -2, 0 and 2 px from its point.
const ROW_STEP: i32 = 2;

/// Bytes of memory for images of this width.
pub(super) const fn bytes(width: u16) -> usize {
    2 * RANK_ROWS * width as usize
}

/// Ranks of the rows around a row of points, of both images.
pub(super) struct RankRows<'a> {
    images: [Gray<'a>; 2],
    row_offset: i32,
    columns: [&'a mut [RankColumn]; 2],
}

impl<'a> RankRows<'a> {
    pub(super) fn new(images: [Gray<'a>; 2], row_offset: i32, memory: &'a mut [u8]) -> Option<Self> {
        let [left, _] = images;
        let width = left.dims().width;
        let (left, right) = memory.get_mut(..bytes(width))?.as_chunks_mut().0.split_at_mut_checked(width.into())?;
        Some(Self { images, row_offset, columns: [left, right] })
    }

    /// Computes the ranks of the rows around row `y`.
    pub(super) fn code(&mut self, y: i32) {
        let [left, right] = self.images;
        for ((image, y), columns) in [(left, y), (right, y + self.row_offset)].into_iter().zip(&mut self.columns) {
            code(image, y, columns);
        }
    }

    /// The window that begins at column `x` of the left image, and the columns of the right one from `first` on.
    pub(super) fn windows(&self, x: i32, first: i32) -> Option<(&[RankColumn; WINDOW_COLUMNS], &[RankColumn])> {
        let [left, right] = &self.columns;
        let window = left.get(usize::try_from(x).ok()?..)?.first_chunk()?;
        Some((window, right.get(usize::try_from(first).ok()?..)?))
    }
}

/// Ranks of the rows around row `y`; rows outside the image repeat the nearest one. Pixels that are not valid get the rank of flat ones.
fn code(image: Gray<'_>, y: i32, columns: &mut [RankColumn]) {
    let last = i32::from(image.dims().height) - 1;
    // A row more above and below: neighbours are as far as the next row of the window.
    let rows = [-3, -2, -1, 0, 1, 2].map(|row| y + row * ROW_STEP);
    rank_columns(rows.map(|y| image.row(y.max(0).min(last) as usize).unwrap_or(&[])), columns);
    if image.valid().is_empty() {
        return;
    }
    let [_, inner @ .., _] = rows;
    for (k, y) in inner.into_iter().enumerate() {
        let valid = image.valid_columns(y);
        let (start, end) = (usize::from(valid.start), usize::from(valid.end));
        for outside in [0..start, end..columns.len()] {
            for column in columns.get_mut(outside).unwrap_or(&mut []) {
                if let Some(rank) = column.get_mut(k) {
                    *rank = RANK_FLAT;
                }
            }
        }
    }
}
