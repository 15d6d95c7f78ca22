//! Gradients and census codes of a part of a row.
//!
//! In: an image, a row and columns of it. Out: a byte each. A row beyond the border is the nearest one; a column there is flat, and so is what
//! is not usable.
//!
//! The first and last column (two, of census) inside the image are as good as a border: whoever needs a pixel asks for two more on both sides.

use crate::image::{Gray, Span};
use crate::kernel::{FLAT, census_row, gradient_row};
use core::ops::Range;

/// Horizontal gradients; `out` has a byte for each column.
pub(crate) fn gradients(image: Gray<'_>, y: i32, columns: Range<i32>, out: &mut [u8]) {
    fill(image, [y - 1, y, y + 1], columns, out, |[above, row, below], out| gradient_row(above, row, below, out));
}

/// Census codes; `out` has a byte for each column.
pub(crate) fn census(image: Gray<'_>, y: i32, columns: Range<i32>, out: &mut [u8]) {
    fill(image, [y - 2, y, y + 2], columns, out, census_row);
}

fn fill(
    image: Gray<'_>,
    rows: [i32; 3],
    columns: Range<i32>,
    out: &mut [u8],
    kernel: impl FnOnce([&[u8]; 3], &mut [u8]),
) {
    let dims = image.dims();
    let inside = |x: i32| x.max(0).min(dims.width.into());
    let (from, to) = (inside(columns.start), inside(columns.end));
    let place = |x: i32| usize::try_from(x - columns.start).unwrap_or(usize::MAX);
    let [_, y, _] = rows;
    if from < to {
        let last = i32::from(dims.height) - 1;
        let rows = rows.map(|y| {
            let row = image.row(y.max(0).min(last) as usize).unwrap_or(&[]);
            row.get(from as usize..to as usize).unwrap_or(&[])
        });
        if let Some(inner) = out.get_mut(place(from)..place(to)) {
            kernel(rows, inner);
        }
    }
    let Span { start, end } = if from < to { image.usable_columns(y) } else { Span::default() };
    let [start, end] = [start, end].map(|x| place(i32::from(x).max(from).min(to)));
    if let Some(before) = out.get_mut(..start) {
        before.fill(FLAT);
    }
    if let Some(after) = out.get_mut(end..) {
        after.fill(FLAT);
    }
}
