//! A disparity for every pixel, from windows of 15 x 15 px.
//!
//! In: a pair, row by row. Out: a row of disparities, seven rows later.
//!
//! ```text
//! for each row:
//!     values of both images into rings of 16 rows, the right ones from right to left
//!     for each column: what it costs more in this row than in the one 15 above, at every disparity
//!         sum over 15 columns, by what enters and leaves; costs of the window += that sum
//!         where there is texture: the lowest costs, the decision
//!     left-right check of the row
//! ```
//! The costs are read and written once for each pixel and row: what a column changed is held in
//! bytes, for 15 columns.
//!
//! # Bounds
//! A window costs at most 225 * 62 = 13 950, a column's texture is at most 15 * 31 = 465.
//!
//! # Cost
//! Memory: 2 bytes a disparity for each window of a row, 32 rows of values, 15 columns of changes,
//! five rows of what is decided.
//!
//! # Source
//! See the crate.

use crate::decision::{DecidedMemory, DecidedRow, decide};
use crate::kernel::{CAP, Column, Group, Windows, add_column, slide_windows};
use crate::{MOST_GROUPS, Misfit, Settings, values};
use linestereo::diagnostics::kernel::reverse_row;
use linestereo::{Dims, Gray};

/// Side of a window, px.
const SIDE: usize = 15;
const HALF: usize = SIDE / 2;
/// Rows of values that are held: a window's and the one above it.
const ROWS: usize = SIDE + 1;

/// Groups that [`DenseMemory`] needs for the costs of images of this width.
#[must_use]
pub const fn dense_groups(width: usize, disparities: usize) -> usize {
    (width + 2).saturating_sub(disparities + SIDE) * disparities / 4
}

/// Memory for images of up to `ROW` px of width and [`dense_groups`] `COSTS`.
#[derive(Debug)]
pub struct DenseMemory<const ROW: usize, const COSTS: usize> {
    costs: [Group; COSTS],
    sums: [Group; MOST_GROUPS],
    changes: [[[i8; 4]; MOST_GROUPS]; SIDE],
    left: [[u8; ROW]; ROWS],
    right: [[u8; ROW]; ROWS],
    /// Without texture, in place of the row above the first window.
    flat: [u8; ROW],
    texture: [u16; ROW],
    asked: [bool; ROW],
    lowest: [Group; ROW],
    decided: DecidedMemory<ROW>,
}

impl<const ROW: usize, const COSTS: usize> DenseMemory<ROW, COSTS> {
    /// Bytes of one.
    pub const BYTES: usize = size_of::<Self>();

    /// Cleared memory, all zero.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            costs: [Group([0; 4]); COSTS],
            sums: [Group([0; 4]); MOST_GROUPS],
            changes: [[[0; 4]; MOST_GROUPS]; SIDE],
            left: [[0; ROW]; ROWS],
            right: [[0; ROW]; ROWS],
            flat: [0; ROW],
            texture: [0; ROW],
            asked: [false; ROW],
            lowest: [Group([0; 4]); ROW],
            decided: DecidedMemory::CLEARED,
        }
    }

    /// Matches a pair; `row` is given the number and the disparities of each row that has windows,
    /// in 1/16 px or [`NO_DISPARITY`](crate::NO_DISPARITY).
    pub fn run(
        &mut self,
        settings: &Settings,
        [left, right]: [Gray<'_>; 2],
        row: &mut dyn FnMut(usize, &[i16]),
    ) -> Result<(), Misfit> {
        let dims = left.dims();
        let groups = settings.groups(dims, SIDE)?;
        let width = usize::from(dims.width);
        let costs =
            self.costs.get_mut(..dense_groups(width, 4 * groups)).ok_or(Misfit::Size(dims))?;
        if right.dims() != dims || width > ROW {
            return Err(Misfit::Size(dims));
        }
        self.flat.fill(CAP);
        let windows = costs.len() / groups;
        self.texture.fill(0);
        self.asked.fill(false);
        costs.fill(Group::default());
        State {
            settings,
            dims,
            groups,
            costs,
            sums: self.sums.get_mut(..groups).unwrap_or_default(),
            changes: &mut self.changes,
            left: self.left.each_mut().map(|row| &mut row[..width]),
            right: self.right.each_mut().map(|row| &mut row[..width]),
            flat: &self.flat[..width],
            texture: &mut self.texture[..width],
            asked: &mut self.asked[..windows],
            lowest: &mut self.lowest[..windows],
            decided: self.decided.row(width),
        }
        .run([left, right], row);
        Ok(())
    }
}

impl<const ROW: usize, const COSTS: usize> Default for DenseMemory<ROW, COSTS> {
    fn default() -> Self {
        Self::new()
    }
}

/// The memory as far as images of this size need it.
struct State<'a> {
    settings: &'a Settings,
    dims: Dims,
    groups: usize,
    costs: &'a mut [Group],
    sums: &'a mut [Group],
    changes: &'a mut [[[i8; 4]; MOST_GROUPS]; SIDE],
    left: [&'a mut [u8]; ROWS],
    right: [&'a mut [u8]; ROWS],
    flat: &'a [u8],
    texture: &'a mut [u16],
    asked: &'a mut [bool],
    lowest: &'a mut [Group],
    decided: DecidedRow<'a>,
}

impl State<'_> {
    /// Not inlined, or it would be compiled as small as its caller may be.
    #[inline(never)]
    fn run(&mut self, [left, right]: [Gray<'_>; 2], row: &mut dyn FnMut(usize, &[i16])) {
        for y in 0..usize::from(self.dims.height) {
            let (Some(left_values), Some(right_values)) =
                (self.left.get_mut(y % ROWS), self.right.get_mut(y % ROWS))
            else {
                continue;
            };
            values(left, y, left_values);
            values(right, y, right_values);
            reverse_row(right_values);
            self.decided.clear();
            self.slide(y);
            if let Some(middle) = (y + 1).checked_sub(SIDE).map(|top| top + HALF) {
                row(middle, self.decided.checked(self.settings.left_right));
            }
        }
    }

    /// Takes in row `y`, and decides on the windows that it completes.
    #[inline(never)]
    fn slide(&mut self, y: usize) {
        let (width, first) = (self.flat.len(), 4 * self.groups - 1);
        let left = entering_and_leaving(&self.left, self.flat, y).map(|row| &row[first..]);
        let right = entering_and_leaving(&self.right, self.flat, y);
        sum_texture(left, self.texture);
        let before_last = SIDE - 1;
        let windows = left[0].len() - before_last;
        if y + 1 >= SIDE {
            ask(self.texture, self.settings.texture_threshold, self.asked);
        }
        self.changes.as_flattened_mut().fill([0; 4]);
        self.sums.fill(Group::default());
        for (i, ring) in (0..before_last).zip(&mut *self.changes) {
            let right = right.map(|row| &row[width - 1 - first - i..]);
            add_column(
                &Column { left: left.map(|row| row[i]), right },
                &mut ring[..self.groups],
                self.sums,
            );
        }
        let ending = Windows {
            left: left.map(|row| &row[before_last..]),
            right: right.map(|row| &row[..windows - 1 + 4 * self.groups]),
            asked: self.asked,
        };
        slide_windows(&ending, (self.changes, before_last), self.sums, self.costs, self.lowest);
        let all = self
            .costs
            .chunks_exact(self.groups)
            .zip(&*self.lowest)
            .zip(&*self.asked)
            .zip(first + HALF..);
        for (((costs, lowest), asked), x) in all {
            if *asked && let Some(found) = decide(costs, *lowest, self.settings.uniqueness_ratio) {
                self.decided.note(x, found);
            }
        }
    }
}

/// Row `y` and the one above the windows that end there; before the first one there is nothing.
fn entering_and_leaving<'a>(
    ring: &'a [&mut [u8]; ROWS],
    flat: &'a [u8],
    y: usize,
) -> [&'a [u8]; 2] {
    [&*ring[y % ROWS], if y >= SIDE { &*ring[(y + 1) % ROWS] } else { flat }]
}

/// Moves the texture of each column one row down.
fn sum_texture([enter, leave]: [&[u8]; 2], texture: &mut [u16]) {
    for ((texture, new), old) in texture.iter_mut().zip(enter).zip(leave) {
        *texture =
            texture.wrapping_add(new.abs_diff(CAP).into()).wrapping_sub(old.abs_diff(CAP).into());
    }
}

/// Asks for the windows that have enough texture.
fn ask(texture: &[u16], threshold: u32, asked: &mut [bool]) {
    let mut sum: u32 = texture.iter().take(SIDE - 1).map(|&column| u32::from(column)).sum();
    for ((asked, &enters), &leaves) in
        asked.iter_mut().zip(texture.iter().skip(SIDE - 1)).zip(texture)
    {
        sum += u32::from(enters);
        *asked = sum >= threshold;
        sum -= u32::from(leaves);
    }
}
