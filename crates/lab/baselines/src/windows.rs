//! Costs of square windows at every disparity, by sliding sums.
//!
//! In: a value per pixel of both images, and the term of two values. Out: row by row the costs of
//! all windows that lie inside both images at every disparity.
//!
//! ```text
//! for each row:    column sum += term of the row that comes in - term of the row that goes out
//! for each column: window sum += column sum that comes in - column sum that goes out
//! ```
//! A curve of costs over disparity is contiguous: every step is one loop over disparities.
//!
//! # Bounds
//! The largest sum is that of a block of 15 x 15 px with terms of at most 62: 13 950, an `i16`.
//! Nothing overflows: wrapping additions only keep checks out of the loops of test builds.
//!
//! # Cost
//! Six additions of 16 bits a disparity and pixel; `side * width * disparities` bytes of terms.

use crate::Search;
use crate::curve::CurveRow;

/// Half the side of the window of block matching: 15 x 15 px.
pub(crate) const BLOCK_HALF: usize = 7;

/// Costs that are compared, and their windows.
pub(crate) struct Windows<T> {
    search: Search,
    half: usize,
    left: Vec<T>,
    /// Rows from right to left, so that a curve over disparities reads upwards.
    mirrored: Vec<T>,
}

impl<T: Copy> Windows<T> {
    /// Windows of `half` px to each side of a pixel.
    ///
    /// # Panics
    /// When there is not one value for each pixel of both images.
    pub(crate) fn new(search: Search, half: usize, [left, right]: [Vec<T>; 2]) -> Self {
        let (width, pixels) = (search.width(), search.width() * search.height());
        assert!([&left, &right].iter().all(|values| values.len() == pixels), "images of one size");
        let mirrored = right.chunks(width).flat_map(|row| row.iter().rev().copied()).collect();
        Self { search, half, left, mirrored }
    }

    /// Calls `each` with the costs of every row of windows, from the top.
    pub(crate) fn for_each_row(
        &self,
        term: impl Fn(T, T) -> u8,
        mut each: impl FnMut(CurveRow<'_>),
    ) {
        let (count, side) = (self.search.count, 2 * self.half + 1);
        let stride = self.search.columns() * count;
        let mut costs = vec![0; stride.saturating_sub(2 * self.half * count)];
        if costs.is_empty() {
            return;
        }
        // The terms of the last rows, as many as a window has. Above the image they are 0.
        let mut terms = vec![0; side * stride];
        let mut column_sums = vec![0; stride];
        for bottom in 0..self.search.height() {
            let row = &mut terms[bottom % side * stride..][..stride];
            self.move_down(bottom, &term, row, &mut column_sums);
            if let Some(y) = bottom.checked_sub(self.half).filter(|&y| y >= self.half) {
                sum_windows(&column_sums, count, side, &mut costs);
                each(CurveRow { y, first: self.search.first() + self.half, count, costs: &costs });
            }
        }
    }

    /// Moves the column sums down to row `y`. `terms` holds the row that goes out, and takes `y`'s.
    fn move_down(
        &self,
        y: usize,
        term: impl Fn(T, T) -> u8,
        terms: &mut [u8],
        column_sums: &mut [i16],
    ) {
        let (width, count) = (self.search.width(), self.search.count);
        let (left, mirrored) =
            (&self.left[y * width..][..width], &self.mirrored[y * width..][..width]);
        let columns = terms.chunks_exact_mut(count).zip(column_sums.chunks_exact_mut(count));
        for (x, (terms, sums)) in (self.search.first()..).zip(columns) {
            let (value, others) = (left[x], &mirrored[width - 1 - x..][..count]);
            for ((sum, old), &other) in sums.iter_mut().zip(terms).zip(others) {
                let new = term(value, other);
                *sum = sum.wrapping_add(i16::from(new)).wrapping_sub(i16::from(*old));
                *old = new;
            }
        }
    }
}

/// Sums of `side` columns each.
fn sum_windows(column_sums: &[i16], count: usize, side: usize, costs: &mut [i16]) {
    let columns = column_sums.chunks_exact(count);
    let mut window = vec![0_i16; count];
    for column in columns.clone().take(side - 1) {
        for (sum, &enters) in window.iter_mut().zip(column) {
            *sum = sum.wrapping_add(enters);
        }
    }
    let moves = columns.clone().skip(side - 1).zip(columns);
    for (costs, (enters, leaves)) in costs.chunks_exact_mut(count).zip(moves) {
        for (((cost, sum), &enters), &leaves) in
            costs.iter_mut().zip(&mut window).zip(enters).zip(leaves)
        {
            *cost = sum.wrapping_add(enters);
            *sum = cost.wrapping_sub(leaves);
        }
    }
}
