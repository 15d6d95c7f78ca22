//! Sliding sums: the cost of every window at every disparity, whatever the window's area.
//!
//! In: a [`Cost`] and a window. Out: row by row the costs of all windows that lie inside both images at every disparity.
//!
//! ```text
//! for each row:    column sums += terms of the row that comes in - terms of the row that goes out
//! for each column: window sum  += column sum that comes in - column sum that goes out
//! ```
//! once for each rectangle of the window's shape. A curve of costs over disparity is contiguous in memory, so that every step is one
//! loop over disparities.
//!
//! # Bounds
//! A term has 16 bits; 65 536 pixels of a window fit 32 bits.
//!
//! # Cost
//! Six additions a disparity, pixel and rectangle; memory for the rows of the window, `2 * rows * width * disparities` bytes.

use super::cost::Cost;
use super::search::Search;
use super::window::{Part, Window};
use core::ops::Range;

/// The costs of one row of windows.
#[derive(Clone, Copy, Debug)]
pub struct CurveRow<'a> {
    /// The row.
    pub y: usize,
    /// Column of the first curve.
    pub first: usize,
    /// Disparities of a curve.
    pub count: usize,
    /// Curve after curve.
    pub costs: &'a [u32],
}

impl<'a> CurveRow<'a> {
    /// Columns and their costs at disparities 0, 1, 2, ...
    pub fn curves(self) -> impl Iterator<Item = (usize, &'a [u32])> {
        self.costs.chunks_exact(self.count).enumerate().map(move |(i, curve)| (self.first + i, curve))
    }
}

/// Tells `row` the costs of every row of windows, from the top.
pub fn for_each_row(cost: &dyn Cost, search: Search, window: &Window, mut row: impl FnMut(CurveRow<'_>)) {
    let (columns, rows) = (search.window_columns(window), search.window_rows(window));
    if columns.is_empty() || rows.is_empty() {
        return;
    }
    let stride = search.columns() * search.count;
    let mut terms = TermRows { rows: vec![0; stride * (2 * window.half_rows() + 2)], stride, next: 0 };
    let mut sliding: Vec<Sliding> = window.parts().into_iter().map(|part| Sliding::new(part, stride)).collect();
    let mut costs = vec![0_u32; columns.len() * search.count];
    let offset = window.half_columns();
    for y in rows {
        terms.fill_to(y + window.half_rows(), cost);
        costs.fill(0);
        for sums in &mut sliding {
            sums.move_to(y, &terms);
            sums.add_windows(offset, search.count, &mut costs);
        }
        cost.costs(y, columns.start, &mut costs);
        row(CurveRow { y, first: columns.start, count: search.count, costs: &costs });
    }
}

/// The last rows of terms, one more than the window has.
struct TermRows {
    rows: Vec<u16>,
    stride: usize,
    next: usize,
}

impl TermRows {
    fn fill_to(&mut self, last: usize, cost: &dyn Cost) {
        while self.next <= last {
            let slot = self.slot(self.next);
            cost.terms(self.next, &mut self.rows[slot]);
            self.next += 1;
        }
    }

    fn slot(&self, y: usize) -> Range<usize> {
        let start = y % (self.rows.len() / self.stride) * self.stride;
        start..start + self.stride
    }

    fn row(&self, y: usize) -> &[u16] {
        &self.rows[self.slot(y)]
    }
}

/// Column sums of one rectangle.
struct Sliding {
    part: Part,
    columns: Vec<u32>,
    window: Vec<u32>,
    filled: bool,
}

impl Sliding {
    fn new(part: Part, stride: usize) -> Self {
        Self { part, columns: vec![0; stride], window: Vec::new(), filled: false }
    }

    fn move_to(&mut self, y: usize, terms: &TermRows) {
        let half = self.part.half_rows;
        if self.filled {
            let (enter, leave) = (terms.row(y + half), terms.row(y - half - 1));
            for ((sum, &new), &old) in self.columns.iter_mut().zip(enter).zip(leave) {
                *sum = sum.wrapping_add(u32::from(new)).wrapping_sub(u32::from(old));
            }
            return;
        }
        for row in y - half..=y + half {
            for (sum, &new) in self.columns.iter_mut().zip(terms.row(row)) {
                *sum += u32::from(new);
            }
        }
        self.filled = true;
    }

    /// `offset` is the column of the first window's centre among the column sums.
    fn add_windows(&mut self, offset: usize, count: usize, costs: &mut [u32]) {
        let (half, column) = (self.part.half_columns, |x: usize| x * count..(x + 1) * count);
        self.window.clear();
        self.window.resize(count, 0);
        for x in offset - half..offset + half {
            add(&mut self.window, &self.columns[column(x)]);
        }
        for (i, curve) in costs.chunks_exact_mut(count).enumerate() {
            let x = offset + i;
            add(&mut self.window, &self.columns[column(x + half)]);
            if self.part.added {
                add(curve, &self.window);
            } else {
                subtract(curve, &self.window);
            }
            subtract(&mut self.window, &self.columns[column(x - half)]);
        }
    }
}

fn add(sums: &mut [u32], values: &[u32]) {
    for (sum, &value) in sums.iter_mut().zip(values) {
        *sum = sum.wrapping_add(value);
    }
}

fn subtract(sums: &mut [u32], values: &[u32]) {
    for (sum, &value) in sums.iter_mut().zip(values) {
        *sum = sum.wrapping_sub(value);
    }
}
