//! A disparity for every fourth pixel of every fourth row, from windows of 16 x 16 px.
//!
//! In: a pair, four rows at a time. Out: a row of disparities, eight rows later.
//!
//! ```text
//! for each four rows:
//!     values of both images, four of a column in a word
//!     for each block of four columns: its costs at every disparity, four pixels an instruction
//!         sum over four blocks, by what enters and leaves; costs of the window += that sum -
//!             the sum of four rows of blocks above
//!         where there is texture: the decision
//!     left-right check of the row
//! ```
//!
//! # Bounds
//! A block costs at most 16 * 62 = 992, a window 15 872.
//!
//! # Cost
//! Memory: for each window of a row 10 bytes a disparity, two rows of words and four rows of
//! values.
//!
//! # Source
//! See the crate.

use crate::decision::{DecidedMemory, DecidedRow, decide};
use crate::kernel::{Blocks, CAP, Group, add_block, block_costs, columns_of_four};
use crate::{MOST_GROUPS, Misfit, Settings, values};
use linestereo::{Dims, Gray};

/// Side of a block, and from window to window, px.
const BLOCK: usize = 4;
/// Blocks of a side of a window.
const BLOCKS: usize = 4;
/// Side of a window, px.
const SIDE: usize = BLOCKS * BLOCK;

/// Groups that [`GridMemory`] needs for the costs of images of this width.
pub const fn grid_groups(width: usize, disparities: usize) -> usize {
    (width / BLOCK + 1).saturating_sub((disparities - 1).div_ceil(BLOCK) + BLOCKS) * disparities / 4
}

/// Memory for images of up to `ROW` px of width and [`grid_groups`] `COSTS`.
#[derive(Debug)]
pub struct GridMemory<const ROW: usize, const COSTS: usize> {
    costs: [Group; COSTS],
    /// Of the last four rows of blocks.
    rows: [[Group; COSTS]; BLOCKS],
    row: [Group; MOST_GROUPS],
    /// Of the last blocks: those of a window and the one before.
    blocks: [[Group; MOST_GROUPS]; BLOCKS + 1],
    values: [[u8; ROW]; BLOCK],
    left: [u32; ROW],
    right: [u32; ROW],
    /// Of the blocks of the last four rows.
    texture: [[u16; ROW]; BLOCKS],
    decided: DecidedMemory<ROW>,
}

impl<const ROW: usize, const COSTS: usize> GridMemory<ROW, COSTS> {
    /// Bytes of one.
    pub const BYTES: usize = size_of::<Self>();

    /// Cleared memory, all zero.
    #[expect(
        clippy::new_without_default,
        reason = "it is too large to be made but in a static or a box"
    )]
    pub const fn new() -> Self {
        Self {
            costs: [Group([0; 4]); COSTS],
            rows: [[Group([0; 4]); COSTS]; BLOCKS],
            row: [Group([0; 4]); MOST_GROUPS],
            blocks: [[Group([0; 4]); MOST_GROUPS]; BLOCKS + 1],
            values: [[0; ROW]; BLOCK],
            left: [0; ROW],
            right: [0; ROW],
            texture: [[0; ROW]; BLOCKS],
            decided: DecidedMemory::CLEARED,
        }
    }

    /// Matches a pair; `row` is given the number and the disparities of each row that has windows,
    /// in 1/16 px or [`NO_DISPARITY`](crate::NO_DISPARITY); between columns that are multiples of
    /// four there is none.
    pub fn run(
        &mut self,
        settings: &Settings,
        [left, right]: [Gray<'_>; 2],
        row: &mut dyn FnMut(usize, &[i16]),
    ) -> Result<(), Misfit> {
        let dims = left.dims();
        let groups = settings.groups(dims, SIDE + BLOCK)?;
        let width = usize::from(dims.width);
        let count = grid_groups(width, 4 * groups);
        if right.dims() != dims || width > ROW || count > COSTS {
            return Err(Misfit);
        }
        self.costs.fill(Group::default());
        self.rows.as_flattened_mut().fill(Group::default());
        self.texture.as_flattened_mut().fill(0);
        State {
            settings,
            dims,
            groups,
            costs: &mut self.costs[..count],
            rows: self.rows.each_mut().map(|row| &mut row[..count]),
            row: &mut self.row[..groups],
            blocks: &mut self.blocks,
            values: self.values.each_mut().map(|row| &mut row[..width]),
            left: &mut self.left[..width],
            right: &mut self.right[..width],
            texture: self.texture.each_mut().map(|row| &mut row[..width]),
            decided: self.decided.row(width),
        }
        .run([left, right], row);
        Ok(())
    }
}

/// The memory as far as images of this size need it.
struct State<'a> {
    settings: &'a Settings,
    dims: Dims,
    groups: usize,
    costs: &'a mut [Group],
    rows: [&'a mut [Group]; BLOCKS],
    row: &'a mut [Group],
    blocks: &'a mut [[Group; MOST_GROUPS]; BLOCKS + 1],
    values: [&'a mut [u8]; BLOCK],
    left: &'a mut [u32],
    right: &'a mut [u32],
    texture: [&'a mut [u16]; BLOCKS],
    decided: DecidedRow<'a>,
}

impl State<'_> {
    /// Not inlined, or it would be compiled as small as its caller may be.
    #[inline(never)]
    fn run(&mut self, [left, right]: [Gray<'_>; 2], row: &mut dyn FnMut(usize, &[i16])) {
        for r in 0..usize::from(self.dims.height) / BLOCK {
            for (image, columns) in [(left, &mut *self.left), (right, &mut *self.right)] {
                for (y, out) in (BLOCK * r..).zip(&mut self.values) {
                    values(image, y, out);
                }
                columns_of_four(self.values.each_ref().map(|row| &**row), columns);
            }
            self.decided.clear();
            self.slide(r);
            if r + 1 >= BLOCKS {
                row(BLOCK * (r - 1), self.decided.checked(self.settings.left_right));
            }
        }
    }

    /// Takes in row `r` of blocks, and decides on the windows that it completes.
    #[inline(never)]
    fn slide(&mut self, r: usize) {
        let (count, groups) = (4 * self.groups, self.groups);
        let first = (count - 1).div_ceil(BLOCK);
        let is_complete = r + 1 >= BLOCKS;
        let threshold = self.settings.texture_threshold * (SIDE * SIDE) as u32 / 225;
        self.row.fill(Group::default());
        self.blocks.as_flattened_mut().fill(Group::default());
        let mut windows =
            self.costs.chunks_exact_mut(groups).zip(self.rows[r % BLOCKS].chunks_exact_mut(groups));
        let mut columns = [0_u16; BLOCKS];
        for (b, left) in self.left.as_chunks::<BLOCK>().0.iter().enumerate().skip(first) {
            let x = BLOCK * b;
            let place = b % (BLOCKS + 1);
            let next = if place == BLOCKS { 0 } else { place + 1 };
            let Ok([enters, leaves]) = self.blocks.get_disjoint_mut([place, next]) else { return };
            let (enters, leaves) = (&mut enters[..groups], &leaves[..groups]);
            block_costs(left, &self.right[x + 1 - count..x + BLOCK], enters);
            self.texture[r % BLOCKS][b] = texture(left);
            columns[b % BLOCKS] = self.texture.iter().map(|row| row[b]).sum();
            if b + 1 < first + BLOCKS {
                for (sum, enters) in self.row.iter_mut().zip(enters.iter()) {
                    *sum = sum.plus(*enters);
                }
                continue;
            }
            let Some((costs, kept)) = windows.next() else { return };
            let lowest = add_block(&mut Blocks { enters, leaves, row: self.row, kept }, costs);
            let texture: u16 = columns.iter().sum();
            if is_complete
                && u32::from(texture) >= threshold
                && let Some(found) = decide(costs, lowest, self.settings.uniqueness_ratio)
            {
                self.decided.note(x - BLOCK, found);
            }
        }
    }
}

/// Sum of `abs(value - CAP)` over a block.
fn texture(left: &[u32; BLOCK]) -> u16 {
    const FLAT: [u32; 2 * BLOCK - 1] = [u32::from_ne_bytes([CAP; 4]); 2 * BLOCK - 1];
    let mut out = [Group::default()];
    block_costs(left, &FLAT, &mut out);
    out[0].0[0]
}
