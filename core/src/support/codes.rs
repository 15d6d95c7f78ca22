//! Codes of the rows that the windows of a row of support points cover.
//!
//! In: both images. Out: the window of a point in the left image, and the columns of the right one
//! from any column on; a column is four codes, of two rows each.
//!
//! A code says how the grey level changes to the right and downward, in units that the noise allows
//! ([`Noise`]): a difference that is limited at some three deviations of its own noise tells more
//! than its sign, and is not led by one pixel.
//!
//! # Bounds
//! Windows of two rows of points share no row of codes: four, of rows -4 to 3 of a point; they read
//! 12 rows, whose middle is the point's row.
//!
//! # Cost
//! Some 45 instructions a column of four codes (Armv7E-M), whatever the picture.

use super::noise::Noise;
use crate::image::Gray;
use crate::kernel::{CODE_FLAT, CODE_ROWS, CodeColumn, STRIP, code_columns, code_costs};

/// Width of a window, px.
pub(super) const WINDOW_COLUMNS: usize = STRIP;
/// Number of pixels at both ends of a row that have no code.
pub(super) const BORDER: i32 = 2;

/// Bytes of memory for images of this width.
pub(super) const fn bytes(width: u16) -> usize {
    2 * CODE_ROWS * width as usize
}

/// Codes of the rows around a row of points, of both images.
pub(super) struct CodeRows<'a> {
    images: [Gray<'a>; 2],
    row_offset: i32,
    doublings: u32,
    columns: [&'a mut [CodeColumn]; 2],
}

impl<'a> CodeRows<'a> {
    pub(super) fn new(images: [Gray<'a>; 2], row_offset: i32, noise: Noise, memory: &'a mut [u8]) -> Option<Self> {
        let [left, _] = images;
        let width = left.dims().width;
        let (left, right) = memory.get_mut(..bytes(width))?.as_chunks_mut().0.split_at_mut_checked(width.into())?;
        Some(Self { images, row_offset, doublings: noise.doublings(), columns: [left, right] })
    }

    /// Computes the codes of the rows around row `y`.
    pub(super) fn code(&mut self, y: i32) {
        let [left, right] = self.images;
        for ((image, y), columns) in [(left, y), (right, y + self.row_offset)].into_iter().zip(&mut self.columns) {
            code(image, y, self.doublings, columns);
        }
    }

    /// The window that begins at column `x` of the left image.
    pub(super) fn window(&self, x: i32) -> Option<&[CodeColumn; WINDOW_COLUMNS]> {
        self.columns[0].get(usize::try_from(x).ok()?..)?.first_chunk()
    }

    /// The right image, and the row of it that matches row `y` of the left one.
    pub(super) fn right(&self, y: i32) -> (Gray<'a>, i32, u32) {
        let [_, right] = self.images;
        (right, y + self.row_offset, self.doublings)
    }

    /// The window that begins at column `x` of the left image, and the columns of the right one
    /// from `first` on.
    pub(super) fn windows(&self, x: i32, first: i32) -> Option<(&[CodeColumn; WINDOW_COLUMNS], &[CodeColumn])> {
        let [left, right] = &self.columns;
        let window = left.get(usize::try_from(x).ok()?..)?.first_chunk()?;
        Some((window, right.get(usize::try_from(first).ok()?..)?))
    }

    /// Costs of the window that begins at column `x` of the left image in the same image, from
    /// `away` px to the right on; their number.
    pub(super) fn costs_in_left(&self, x: i32, away: usize, costs: &mut [u8]) -> usize {
        let end = self.columns[0].len().saturating_sub(BORDER as usize);
        let own = || self.columns[0].get(usize::try_from(x).ok()?..end);
        let Some((window, columns)) = own().and_then(|own| Some((own.first_chunk()?, own.get(away..)?))) else {
            return 0;
        };
        let length = (columns.len() + 1).saturating_sub(WINDOW_COLUMNS).min(costs.len());
        if let (Some(columns), Some(costs)) = (columns.get(..length + WINDOW_COLUMNS - 1), costs.get_mut(..length)) {
            code_costs(window, columns, costs);
        }
        length
    }

    /// The window that begins at column `x` of the left image, with the column before and the one
    /// behind it.
    pub(super) fn around_window(&self, x: i32) -> Option<&[CodeColumn; WINDOW_COLUMNS + 2]> {
        self.columns[0].get(usize::try_from(x - 1).ok()?..)?.first_chunk()
    }
}

/// Codes of the rows around row `y`; rows outside the image repeat the nearest one. Pixels that are
/// not valid get the code of flat ones.
fn code(image: Gray<'_>, y: i32, doublings: u32, columns: &mut [CodeColumn]) {
    let last = i32::from(image.dims().height) - 1;
    let rows = core::array::from_fn(|row| (y - 6 + row as i32).max(0).min(last) as usize);
    code_columns(rows.map(|row| image.row(row).unwrap_or(&[])), doublings, columns);
    if image.valid().is_empty() {
        return;
    }
    for (k, y) in [y - 3, y - 1, y + 1, y + 3].into_iter().enumerate() {
        let valid = image.valid_columns(y);
        let (start, end) = (usize::from(valid.start), usize::from(valid.end));
        for outside in [0..start, end..columns.len()] {
            for column in columns.get_mut(outside).unwrap_or(&mut []) {
                if let Some(code) = column.get_mut(k) {
                    *code = CODE_FLAT;
                }
            }
        }
    }
}
