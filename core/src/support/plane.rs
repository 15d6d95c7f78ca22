//! Labels of support points beside the ground plane: there the disparity changes by up to a pixel
//! per row, and a window spans several.
//!
//! In: the plane, the codes of the left rows, the right image. Out: the costs of 15 labels a point,
//! 7 px beyond the plane to 7 px before it.
//!
//! ```text
//! each of the 12 rows that codes read is moved by the plane's own whole disparity
//! D(y) = floor(b y + a + 1/2); then codes and costs as elsewhere
//! label r of a point is the disparity D + round(c x) + r; its cost is the mean of the point's and
//! of those beside it in the row
//! d = plane(x, y) + r + sub-pixel - rest
//! rest: the mean over the rows of plane - D
//! ```
//!
//! # Cost
//! Codes of one more row, and 15 labels a point, where the plane is seen.

use super::Grid;
use super::codes::{BORDER, CodeRows, ROWS, WINDOW_COLUMNS};
use super::paths::{MAX_COLUMNS, PLANE_LABELS as LABELS};
use crate::ground::GroundPlane;
use crate::image::Span;
use crate::kernel::{CODE_FLAT, CODE_ROWS, CodeColumn, code_columns, code_costs};

/// The nearest of them, px before the plane: labels fall, as disparities do.
const NEAREST: i32 = LABELS as i32 / 2;
/// How often each of them is read by the codes of a window: see [`code_columns`].
const READ: [i32; ROWS] = [1, 1, 2, 2, 4, 4, 4, 4, 3, 3, 2, 2];
/// Cost of a label that does not exist.
const NONE: u8 = u8::MAX;

/// Costs of the labels of a row of points.
pub(super) struct PlaneLabels<'m> {
    plane: GroundPlane,
    columns: &'m mut [CodeColumn],
    costs: &'m mut [[u8; LABELS]],
    /// Whole disparity of the row of points.
    row: i32,
    /// Largest whole disparity of the rows around: column 0 is there.
    nearest: i32,
    /// True when its labels exist.
    is_seen: bool,
    /// Mean over the rows of a window of the plane less its whole disparities, 1/64 px.
    rest_q6: i32,
    /// First label of each point whose window lies on valid pixels.
    first: [u8; MAX_COLUMNS],
}

/// A label beside the plane.
#[derive(Clone, Copy)]
pub(super) struct PlaneLabel {
    /// Its whole disparity, px.
    pub(super) disparity: i32,
    /// Disparity of the first label at the point's place in the grid, 1/64 px.
    pub(super) at_zero_q6: i32,
    /// Disparity of the plane there, 1/64 px.
    pub(super) plane_q6: i32,
}

impl<'m> PlaneLabels<'m> {
    pub(super) fn new(plane: GroundPlane, grid: Grid, memory: &'m mut [u8]) -> Option<Self> {
        let (columns, costs) = memory.split_at_mut_checked(CODE_ROWS * usize::from(grid.width))?;
        let costs = costs.as_chunks_mut().0.get_mut(..grid.columns)?;
        let columns = columns.as_chunks_mut().0;
        Some(Self {
            plane,
            columns,
            costs,
            row: 0,
            nearest: 0,
            is_seen: false,
            rest_q6: 0,
            first: [0; MAX_COLUMNS],
        })
    }

    /// Computes the costs of the points around row `y`.
    pub(super) fn measure(&mut self, y: i32, grid: Grid, codes: &CodeRows<'_>, valid: Span) {
        self.costs.fill([NONE; LABELS]);
        self.first.fill(LABELS as u8);
        if !self.shift(y, codes) {
            return;
        }
        let (plane, nearest) = (self.plane, self.nearest);
        for (column, (costs, first)) in self.costs.iter_mut().zip(&mut self.first).enumerate() {
            let x = grid.window(column);
            // Columns of the moved rows begin at the largest disparity of these.
            let start = x - plane.of_column(grid.x(column)) - NEAREST - nearest;
            let missing = (i32::from(valid.start).max(BORDER) - start).clamp(0, LABELS as i32);
            let Some(window) = codes.window(x) else { continue };
            *first = missing as u8;
            if let Ok(from) = usize::try_from(start + missing)
                && let Some(costs) = costs.get_mut(missing as usize..)
            {
                let there = self.columns.get(from..).unwrap_or(&[]);
                let length = (there.len() + 1).saturating_sub(WINDOW_COLUMNS).min(costs.len());
                if let (Some(there), Some(costs)) =
                    (there.get(..length + WINDOW_COLUMNS - 1), costs.get_mut(..length))
                {
                    code_costs(window, there, costs);
                }
            }
        }
    }

    /// Codes the right rows around row `y`, each moved by its own whole disparity; false where the
    /// plane is not seen.
    pub(super) fn shift(&mut self, y: i32, codes: &CodeRows<'_>) -> bool {
        self.row = self.plane.of_row(y);
        self.is_seen = self.row >= 0 && self.code(y, codes).is_some();
        self.is_seen
    }

    /// Column of the moved rows that matches column `x` of the left image at this label of the
    /// point at column `x_point`.
    pub(super) fn column(&self, x: i32, x_point: i32, label: i32) -> i32 {
        x - self.plane.of_column(x_point) - label - self.nearest
    }

    /// Codes of the moved rows.
    pub(super) fn columns(&self) -> &[CodeColumn] {
        self.columns
    }

    /// Disparity of the label of the plane itself at a pixel of the row, 1/64 px.
    pub(super) fn at_zero_q6(&self, x: i32, y: i32) -> i32 {
        let across_rest_q6 = (self.plane.across_q16 * x - (self.plane.of_column(x) << 16)) >> 10;
        self.plane.at_q6(x, y) - self.rest_q6 - across_rest_q6
    }

    fn code(&mut self, y: i32, codes: &CodeRows<'_>) -> Option<()> {
        let (right, doublings) = codes.right(y);
        let rows: [i32; ROWS] = core::array::from_fn(|row| y - 6 + row as i32);
        let moves = rows.map(|row| self.plane.of_row(row));
        let (nearest, farthest) = moves
            .iter()
            .fold((i32::MIN, i32::MAX), |(most, least), &d| (most.max(d), least.min(d)));
        let span = usize::try_from(nearest - farthest).ok()?;
        // Whole words, as kernels take them.
        let width = right.first()?.len().checked_sub(span)? & !3;
        let mut slices: [&[u8]; ROWS] = [&[]; ROWS];
        for ((slice, row), d) in slices.iter_mut().zip(right).zip(moves) {
            let from = usize::try_from(nearest - d).ok()?;
            *slice = row.get(from..from + width)?;
        }
        let columns = self.columns.get_mut(..width)?;
        code_columns(slices, doublings, columns);
        self.columns.get_mut(width..)?.fill([CODE_FLAT; CODE_ROWS]);
        let rest_q16 =
            |(row, d): (i32, i32)| self.plane.down_q16 * row + self.plane.origin_q16 - (d << 16);
        let sum: i64 = rows
            .into_iter()
            .zip(moves)
            .zip(READ)
            .map(|(row, read)| i64::from(rest_q16(row)) * i64::from(read))
            .sum();
        self.rest_q6 = (sum >> (5 + 10)) as i32;
        self.nearest = nearest;
        Some(())
    }

    /// Sets the costs of a point's labels: the mean of its own and those beside it.
    pub(super) fn fill(&self, column: usize, x: i32, out: &mut [u8]) {
        let costs = |column: usize| self.costs.get(column);
        let Some(own) = costs(column).filter(|_| self.is_seen) else {
            out.fill(NONE);
            return;
        };
        let before = column.checked_sub(1).and_then(costs).unwrap_or(own);
        let after = costs(column + 1).unwrap_or(own);
        for (out, ((&own, &before), &after)) in
            out.iter_mut().zip(own.iter().zip(before).zip(after))
        {
            let beside = |cost: u8| u32::from(if cost == NONE { own } else { cost });
            *out = if own == NONE {
                super::OUTSIDE
            } else {
                ((beside(before) + u32::from(own) + beside(after)) / 3) as u8
            };
        }
        // Disparities below 0 are among the others, if they are searched.
        let exist = usize::try_from(self.row + self.plane.of_column(x) + NEAREST + 1).unwrap_or(0);
        if let Some(below) = out.get_mut(exist..) {
            below.fill(NONE);
        }
    }

    /// The label of a point's index among those beside the plane, and the first whose window lies
    /// on valid pixels.
    pub(super) fn label(&self, column: usize, grid: Grid, y: i32) -> Option<(PlaneLabel, usize)> {
        let x = grid.x(column);
        let own = self.plane.of_column(x);
        let first = usize::from(*self.first.get(column)?);
        self.is_seen.then(|| {
            let plane_q6 = self.plane.at_q6(x, y);
            let at_zero_q6 = self.at_zero_q6(x, y) + (NEAREST << 6);
            let label = PlaneLabel { disparity: self.row + own + NEAREST, at_zero_q6, plane_q6 };
            (label, first)
        })
    }
}
