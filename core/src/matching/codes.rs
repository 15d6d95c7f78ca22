//! Gradients and census codes of a part of a row.
//!
//! In: an image, a row and columns of it. Out: a byte per column. Rows outside the image repeat the
//! nearest one; columns outside are flat, and so are pixels that are not valid.
//!
//! The first and last column computed (two, of census) are treated like the image's border: request
//! two more columns on both sides than needed.
//!
//! # Cost
//! A pass over the columns by a kernel, and one over the border's: 4 instructions a gradient, 8 a
//! census code (Armv7E-M).

use crate::image::Gray;
use crate::kernel::{FLAT, census_row, gradient_row};
use core::ops::Range;

/// Horizontal gradients; `out` has a byte for each column.
pub(crate) fn gradients(image: Gray<'_>, y: i32, columns: Range<i32>, out: &mut [u8]) {
    fill(image, [y - 1, y, y + 1], columns, out, |[above, row, below], out| {
        gradient_row(above, row, below, out)
    });
}

/// Census codes; `out` has a byte for each column.
pub(crate) fn census(image: Gray<'_>, y: i32, columns: Range<i32>, out: &mut [u8]) {
    fill(image, [y - 2, y, y + 2], columns, out, census_row);
}

/// Both kernels share one copy of it.
#[inline(never)]
fn fill(
    image: Gray<'_>,
    rows: [i32; 3],
    columns: Range<i32>,
    out: &mut [u8],
    kernel: fn([&[u8]; 3], &mut [u8]),
) {
    let dims = image.dims();
    let inside = |x: i32| x.max(0).min(dims.width.into());
    let (from, to) = (inside(columns.start), inside(columns.end));
    if from >= to {
        return out.fill(FLAT);
    }
    let index = |x: i32| usize::try_from(x - columns.start).unwrap_or(usize::MAX);
    let [above, y, below] = rows;
    let last = i32::from(dims.height) - 1;
    let (pixels, stride) = image.as_slice();
    let row = |y: i32| {
        let first = (y.max(0).min(last) as usize).wrapping_mul(stride).wrapping_add(from as usize);
        pixels.get(first..first.wrapping_add((to - from) as usize)).unwrap_or(&[])
    };
    if let Some(inner) = out.get_mut(index(from)..index(to)) {
        kernel([row(above), row(y), row(below)], inner);
    }
    let (mut first, mut end) = (from, to);
    if !image.valid().is_empty() {
        let valid = image.valid_columns(y);
        [first, end] = [valid.start, valid.end].map(|x| i32::from(x).max(from).min(to));
    }
    // Most often both are empty: a call less each.
    if let Some(before) = out.get_mut(..index(first)).filter(|before| !before.is_empty()) {
        before.fill(FLAT);
    }
    if let Some(after) = out.get_mut(index(end)..).filter(|after| !after.is_empty()) {
        after.fill(FLAT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Dims;

    #[test]
    fn what_lies_outside_is_flat_whatever_was_there() {
        let (dims, mut pixels) = (Dims { width: 20, height: 20 }, [0; 400]);
        for (i, pixel) in pixels.iter_mut().enumerate() {
            *pixel = (i % 20 * 12) as u8;
        }
        let image = Gray::new(&pixels, dims, 20).unwrap();
        for first in [-40, -11, -10, -4, 0, 5, 12, 19, 20, 21, 60] {
            let mut out = [0xaa; 10];
            gradients(image, 1, first..first + 10, &mut out);
            for (&found, x) in out.iter().zip(first..) {
                // Steps of 12 grey levels a pixel, but for the first and last column computed
                // inside.
                let inside = (first.max(0) + 1..(first + 10).min(20) - 1).contains(&x);
                assert_eq!(found, if inside { FLAT + 24 } else { FLAT }, "column {x} of {first}..");
            }
        }
    }
}
