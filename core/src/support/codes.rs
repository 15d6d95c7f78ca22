//! Codes of the rows that the windows of a row of support points cover, at the size of the images
//! or at half of it.
//!
//! In: both images. Out: the window of a point in the left image, and the columns of the right one
//! from any column on; a column is four codes, of two rows each.
//!
//! A code says how the grey level changes to the right and downward, in units that the noise allows
//! ([`Noise`](super::Noise)): a difference that is limited at some three deviations of its own
//! noise tells more than its sign, and is not led by one pixel.
//!
//! # Bounds
//! Windows of two rows of points share no row of codes: four, of rows -4 to 3 of a point; they read
//! 12 rows, whose middle is the point's row.
//!
//! # Cost
//! Some 45 instructions a column of four codes (Armv7E-M), whatever the picture.

use crate::cores::{Cores, join};
use crate::image::{Gray, Span, halve_rows};
use crate::kernel::{
    CODE_FLAT, CODE_ROWS, CodeColumn, STRIP, code_columns, code_costs, code_costs_in, spread_bytes,
    spread_codes,
};

/// Width of a window, px.
pub(super) const WINDOW_COLUMNS: usize = STRIP;
/// Number of pixels at both ends of a row that have no code.
pub(super) const BORDER: i32 = 2;

/// Rows that the codes of a row of points read.
pub(super) const ROWS: usize = 2 * CODE_ROWS + 4;

/// Bytes of memory for images of this width.
pub(super) const fn bytes(width: u16) -> usize {
    2 * CODE_ROWS * width as usize
}

/// Bytes of memory for the rows of half of an image, of this width.
pub(super) const fn bytes_of_half(width: u16) -> usize {
    ROWS * width as usize
}

/// Codes of the rows around a row of points, of both images.
pub(super) struct CodeRows<'a> {
    images: [Gray<'a>; 2],
    row_offset: i32,
    doublings: u32,
    columns: [&'a mut [CodeColumn]; 2],
    /// Columns of the right image as [`code_costs_in`] takes them.
    spread: &'a mut [u8],
    /// Rows of half of the image that was coded last, where codes are of halves.
    half: Option<&'a mut [u8]>,
}

impl<'a> CodeRows<'a> {
    /// For codes of these images, or of their halves. Spare memory may make searches faster.
    pub(super) fn new(
        images: [Gray<'a>; 2],
        row_offset: i32,
        doublings: u32,
        is_half: bool,
        memory: &'a mut [u8],
        spare: &'a mut [u8],
    ) -> Option<Self> {
        let [left, _] = images;
        let width = left.dims().width / if is_half { 2 } else { 1 };
        let (codes, rows) = memory.split_at_mut_checked(bytes(width))?;
        let (left, right) = codes.as_chunks_mut().0.split_at_mut_checked(width.into())?;
        let half = if is_half { Some(rows.get_mut(..bytes_of_half(width))?) } else { None };
        let spread = spare.get_mut(..spread_bytes(width.into())).unwrap_or_default();
        Some(Self { images, row_offset, doublings, columns: [left, right], spread, half })
    }

    /// Computes the codes of the rows around row `y`.
    pub(super) fn code(&mut self, y: i32, cores: Option<&mut dyn Cores>) {
        let (offsets, scale) = ([0, self.row_offset], i32::from(self.scale()));
        let doublings = self.doublings;
        let code =
            |(image, offset): (Gray<'_>, i32), rows: [&[u8]; ROWS], columns: &mut [CodeColumn]| {
                code_columns(rows, doublings, columns);
                let coded = [-3, -1, 1, 3].map(|down| scale * (y + down) + offset);
                flatten(image, coded, scale as usize, columns);
            };
        // The memory for rows of halves is that of one image.
        if let Some(cores) = cores
            && self.half.is_none()
        {
            let ([left, right], [a, b]) = (self.images, &mut self.columns);
            let spread = &mut *self.spread;
            let here = || code((left, 0), rows_around(left, y), a);
            let there = || {
                code((right, offsets[1]), rows_around(right, y + offsets[1]), b);
                spread_codes(b, spread);
            };
            return join(Some(cores), here, there);
        }
        for ((image, offset), columns) in
            self.images.into_iter().zip(offsets).zip(&mut self.columns)
        {
            let rows = match &mut self.half {
                Some(half) => {
                    fill_half(image, (y, offset), half);
                    half_rows(half)
                }
                None => rows_around(image, y + offset),
            };
            code((image, offset), rows, columns);
        }
        spread_codes(self.columns[1], self.spread);
    }

    /// Pixels of the images in one of those that are coded: 2 where these are halves.
    pub(super) fn scale(&self) -> u16 {
        1 + u16::from(self.half.is_some())
    }

    /// True when the grey levels of the left image that the codes of a window read differ by so
    /// much, where rows are coded as `y`.
    pub(super) fn has_contrast(&self, y: i32, window: i32, contrast: u8) -> bool {
        let (scale, middle) = (i32::from(self.scale()), ROWS as i32 / 2);
        let [start, end] = [window - BORDER, window + WINDOW_COLUMNS as i32 + BORDER]
            .map(|x| (scale * x).max(0) as usize);
        let (mut least, mut most) = (u8::MAX, 0);
        (scale * (y - middle)..scale * (y + middle)).any(|y| {
            let row = self.images[0].row(y.max(0) as usize).unwrap_or(&[]);
            for &level in row.get(start..end).unwrap_or(&[]) {
                (least, most) = (level.min(least), level.max(most));
            }
            most.saturating_sub(least) >= contrast
        })
    }

    /// Columns with valid pixels of the rows that are coded as `y`.
    pub(super) fn valid(&self, y: i32) -> [Span; 2] {
        let scale = self.scale();
        [(0, 0), (1, self.row_offset)].map(|(which, offset)| {
            let of = self
                .images
                .get(which)
                .map(|image| image.valid_columns(i32::from(scale) * y + offset));
            let Span { start, end } = of.unwrap_or_default();
            Span { start: start.div_ceil(scale), end: end / scale }
        })
    }

    /// Codes of the right image.
    pub(super) fn columns_of_right(&self) -> &[CodeColumn] {
        let [_, right] = &self.columns;
        right
    }

    /// The window that begins at column `x` of the left image.
    pub(super) fn window(&self, x: i32) -> Option<&[CodeColumn; WINDOW_COLUMNS]> {
        self.columns[0].get(usize::try_from(x).ok()?..)?.first_chunk()
    }

    /// Rows of the right image, or of its half, that the codes around row `y` read, which were
    /// coded last; how often these are doubled.
    pub(super) fn right(&self, y: i32) -> ([&[u8]; ROWS], u32) {
        let [_, right] = self.images;
        let rows = match &self.half {
            Some(half) => half_rows(half),
            None => rows_around(right, y + self.row_offset),
        };
        (rows, self.doublings)
    }

    /// Costs of the window that begins at column `x` of the left image in the right one, from
    /// column `first` on. Returns the window; `None` where there is none.
    pub(super) fn costs(
        &self,
        x: i32,
        first: i32,
        costs: &mut [u8],
    ) -> Option<&[CodeColumn; WINDOW_COLUMNS]> {
        let window = self.window(x)?;
        let first = usize::try_from(first).ok()?;
        code_costs_in(window, self.columns_of_right(), first, self.spread, costs);
        Some(window)
    }

    /// Costs of the window that begins at column `x` of the left image in the same image, from
    /// `away` px to the right on; their number.
    pub(super) fn costs_in_left(&self, x: i32, away: usize, costs: &mut [u8]) -> usize {
        let end = self.columns[0].len().saturating_sub(BORDER as usize);
        let own = || self.columns[0].get(usize::try_from(x).ok()?..end);
        let Some((window, columns)) =
            own().and_then(|own| Some((own.first_chunk()?, own.get(away..)?)))
        else {
            return 0;
        };
        let length = (columns.len() + 1).saturating_sub(WINDOW_COLUMNS).min(costs.len());
        if let (Some(columns), Some(costs)) =
            (columns.get(..length + WINDOW_COLUMNS - 1), costs.get_mut(..length))
        {
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

/// The rows around row `y`; outside of the image the nearest one.
fn rows_around(image: Gray<'_>, y: i32) -> [&[u8]; ROWS] {
    let last = i32::from(image.dims().height) - 1;
    let rows: [usize; ROWS] =
        core::array::from_fn(|row| (y - 6 + row as i32).max(0).min(last) as usize);
    rows.map(|row| image.row(row).unwrap_or(&[]))
}

/// Sets the rows around row `y` of half of an image, means of 2 x 2 pixels; outside of the image
/// they are the nearest ones.
fn fill_half(image: Gray<'_>, (y, offset): (i32, i32), half: &mut [u8]) {
    let last = i32::from(image.dims().height) - 1;
    for (half, y) in half.chunks_exact_mut((half.len() / ROWS).max(1)).zip(y - 6..) {
        let row = |y: i32| image.row((y + offset).max(0).min(last) as usize).unwrap_or(&[]);
        let y = 2 * y.max(0).min(last / 2);
        halve_rows(row(y), row(y + 1), half);
    }
}

/// The rows that [`fill_half`] has set.
fn half_rows(half: &[u8]) -> [&[u8]; ROWS] {
    let width = half.len() / ROWS;
    core::array::from_fn(|row| half.get(row * width..(row + 1) * width).unwrap_or(&[]))
}

/// Gives pixels that are not valid the code of flat ones; `scale` pixels of a row of the image are
/// one of the columns.
fn flatten(image: Gray<'_>, rows: [i32; CODE_ROWS], scale: usize, columns: &mut [CodeColumn]) {
    if image.valid().is_empty() {
        return;
    }
    for (k, y) in rows.into_iter().enumerate() {
        let valid = image.valid_columns(y);
        let (start, end) =
            (usize::from(valid.start).div_ceil(scale), usize::from(valid.end) / scale);
        for outside in [0..start, end..columns.len()] {
            for column in columns.get_mut(outside).unwrap_or(&mut []) {
                if let Some(code) = column.get_mut(k) {
                    *code = CODE_FLAT;
                }
            }
        }
    }
}
