//! Rows of gradients: means of columns are kept until the one two columns on.
//!
//! In: the rows around one row of an image. Out: a byte for each of its pixels.
//!
//! # Cost
//! A row of 320 pixels: 4970 (7910).
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, FLAT};

/// See [`portable::gradient_row`].
pub fn gradient_row(above: &[u8], row: &[u8], below: &[u8], out: &mut [u8]) {
    let width = row.len();
    if width < 4 || above.len() < width || below.len() < width || out.len() != width {
        return portable::gradient_row(above, row, below, out);
    }
    let mean = |above: u8, row: u8, below: u8| {
        let outer = (u32::from(above) + u32::from(below)) >> 1;
        (outer + u32::from(row)) as i32 >> 1
    };
    let gradient = |before: i32, after: i32| {
        let step = after - before;
        // Not `clamp`, which is not two branches here.
        let step = if step > 31 { 31 } else { step };
        (if step < -31 { -31 } else { step } + i32::from(FLAT)) as u8
    };
    let [(above, above1), (row, row1), (below, below1)] =
        [above, row, below].map(|row| row.get(..width).unwrap_or_default().as_chunks::<2>());
    let mut columns = above.iter().zip(row).zip(below);
    let Some(((&[a, b], &[c, d]), &[e, f])) = columns.next() else { return };
    let (mut even, mut odd) = (mean(a, c, e), mean(b, d, f));
    let inner = out.get_mut(1..).unwrap_or_default().as_chunks_mut::<2>().0;
    for (((&[a, b], &[c, d]), &[e, f]), out) in columns.zip(inner) {
        let (even_after, odd_after) = (mean(a, c, e), mean(b, d, f));
        *out = [gradient(even, even_after), gradient(odd, odd_after)];
        (even, odd) = (even_after, odd_after);
    }
    // The last column of an odd number.
    if let (&[a], &[b], &[c], Some(last)) = (above1, row1, below1, out.get_mut(width - 2)) {
        *last = gradient(even, mean(a, b, c));
    }
    for edge in [0, width - 1] {
        if let Some(edge) = out.get_mut(edge) {
            *edge = FLAT;
        }
    }
}
