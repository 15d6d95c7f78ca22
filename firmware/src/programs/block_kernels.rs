//! Do the kernels of block matching on this machine equal the portable ones?
//!
//! In: the kernels. Out: the first that gives other bits, or that none does.
//!
//! ```text
//! for each kernel, number of groups or pixels, offset within a word:
//!     random contents, often extreme ones; slices that are too short or longer than need be among them
//!     kernel, portable kernel: all that they may write must be equal
//! ```

use super::random::Random;
use linestereo_block_matching::kernel::{self, Blocks, Column, Group, Windows};
use linestereo_block_matching::portable;

/// Groups of the rings of changes.
const GROUPS: usize = 16;
/// Columns of the longest row of windows.
const COLUMNS: usize = 18;
/// Slots of the rings of changes.
const SLOTS: usize = 15;
type Ring = [[[i8; 4]; GROUPS]];
type SlideWindows = fn(&Windows<'_>, (&mut Ring, usize), &mut [Group], &mut [Group], &mut [Group]);

/// The kernels of one machine.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, clippy::type_complexity, reason = "each is described where it is defined")]
pub struct BlockKernels {
    pub sobel_row: fn(&[u8], &[u8], &[u8], &mut [u8]),
    pub add_column: fn(&Column<'_>, &mut [[i8; 4]], &mut [Group]),
    pub slide_windows: SlideWindows,
    pub groups_within: fn(&[Group], u16) -> Option<[usize; 2]>,
    pub places_within: fn(Group, u16) -> u32,
    pub columns_of_four: fn([&[u8]; 4], &mut [u32]),
    pub block_costs: fn(&[u32; 4], &[u32], &mut [Group]),
    pub add_block: fn(&mut Blocks<'_>, &mut [Group]) -> Group,
}

impl BlockKernels {
    /// Those that are used on this machine.
    pub const CHOSEN: Self = Self {
        sobel_row: kernel::sobel_row,
        add_column: kernel::add_column,
        slide_windows: kernel::slide_windows::<GROUPS>,
        groups_within: kernel::groups_within,
        places_within: kernel::places_within,
        columns_of_four: kernel::columns_of_four,
        block_costs: kernel::block_costs,
        add_block: kernel::add_block,
    };

    /// The name of the first kernel that differs from the portable one.
    #[must_use]
    pub fn first_that_differs(&self) -> Option<&'static str> {
        let mut random = Random::new();
        type Comparison = fn(&BlockKernels, &mut Random) -> bool;
        let compared: [(&str, Comparison); 8] = [
            ("sobel_row", Self::sobel_rows),
            ("add_column", Self::columns),
            ("slide_windows", Self::windows),
            ("groups_within", Self::groups),
            ("places_within", Self::places),
            ("columns_of_four", Self::words),
            ("block_costs", Self::costs),
            ("add_block", Self::blocks),
        ];
        compared.into_iter().find(|(_, is_equal)| !is_equal(self, &mut random)).map(|(name, _)| name)
    }

    fn sobel_rows(&self, random: &mut Random) -> bool {
        (0..400).all(|round: usize| {
            let width = round / 4 % 80;
            let (mut rows, mut out) = ([[0; 84]; 3], [7; 84]);
            rows.as_flattened_mut().iter_mut().for_each(|pixel| *pixel = random.byte());
            let mut expected = out;
            let [above, row, below] = [0, 1, 2].map(|k| &rows[k][round % 4..][..width]);
            // One of another length.
            let below = if random.below(8) == 0 { &below[..width / 2] } else { below };
            (self.sobel_row)(above, row, below, &mut out[round % 3..][..width]);
            portable::sobel_row(above, row, below, &mut expected[round % 3..][..width]);
            out == expected
        })
    }

    fn columns(&self, random: &mut Random) -> bool {
        (0..1000).all(|round: usize| {
            let groups = round % (GROUPS + 3);
            let (mut ring, mut sums) = ([[0_i8; 4]; GROUPS + 2], [Group::default(); GROUPS + 2]);
            ring.as_flattened_mut().iter_mut().for_each(|change| *change = random.byte() as i8);
            sums.iter_mut().for_each(|sum| *sum = random.group());
            let (mut expected_ring, mut expected) = (ring, sums);
            let mut rows = [[0; 84]; 2];
            rows.as_flattened_mut().iter_mut().for_each(|value| *value = random.byte());
            let long = if random.below(8) == 0 { 3 * groups } else { 4 * groups + random.below(4) };
            let held = if random.below(8) == 0 { groups / 2 } else { groups };
            let column = Column {
                left: [random.byte(), random.byte()],
                right: rows.each_ref().map(|row| &row[round % 4..][..long]),
            };
            (self.add_column)(&column, &mut ring[..held], &mut sums[..groups]);
            portable::add_column(&column, &mut expected_ring[..held], &mut expected[..groups]);
            ring == expected_ring && sums == expected
        })
    }

    fn windows(&self, random: &mut Random) -> bool {
        (0..300).all(|round: usize| {
            let (groups, columns) = (1 + round % GROUPS, 1 + random.below(COLUMNS));
            let mut state = State {
                changes: [[[0; 4]; GROUPS]; SLOTS],
                sums: [Group::default(); GROUPS],
                costs: [Group::default(); GROUPS * COLUMNS],
                lowest: [Group::default(); COLUMNS],
            };
            state.changes.as_flattened_mut().as_flattened_mut().iter_mut().for_each(|c| *c = random.byte() as i8);
            let State { sums, costs, lowest, .. } = &mut state;
            sums.iter_mut().chain(costs).chain(lowest).for_each(|group| *group = random.group());
            let mut expected = state.clone();
            let (mut left, mut right, mut asked) = ([[0; COLUMNS]; 2], [[0; 88]; 2], [false; COLUMNS]);
            let values = left.as_flattened_mut().iter_mut().chain(right.as_flattened_mut());
            values.for_each(|value| *value = random.byte());
            asked.iter_mut().for_each(|asked| *asked = random.below(2) == 0);
            let long = columns - 1 + 4 * groups + random.below(2) - usize::from(random.below(10) == 0);
            let windows = Windows {
                left: left.each_ref().map(|row| &row[..columns]),
                right: right.each_ref().map(|row| &row[round % 4..][..long]),
                asked: &asked[..columns],
            };
            let slot = random.below(SLOTS + 1);
            state.run(self.slide_windows, &windows, slot, groups);
            expected.run(portable::slide_windows, &windows, slot, groups);
            state == expected
        })
    }

    fn groups(&self, random: &mut Random) -> bool {
        (0..2000).all(|round: usize| {
            let mut costs = [Group([9000; 4]); GROUPS + 2];
            for _ in 0..random.below(4) {
                costs[random.below(GROUPS + 2)].0[random.below(4)] = 1000 + random.below(3) as u16;
            }
            let bound = [1001, 1000, 999, u16::MAX][random.below(4)];
            let costs = &costs[..round % (GROUPS + 3)];
            (self.groups_within)(costs, bound) == portable::groups_within(costs, bound)
        })
    }

    fn places(&self, random: &mut Random) -> bool {
        (0..2000).all(|_| {
            let group = random.group();
            // Often one of its own costs.
            let bound = if random.below(2) == 0 { group.at(random.below(4)) } else { random.group().at(3) };
            (self.places_within)(group, bound) == portable::places_within(group, bound)
        })
    }

    fn words(&self, random: &mut Random) -> bool {
        (0..300).all(|round: usize| {
            let width = round % 41;
            let (mut rows, mut out) = ([[0; 48]; 4], [7; 41]);
            rows.as_flattened_mut().iter_mut().for_each(|pixel| *pixel = random.byte());
            let mut expected = out;
            let long = if random.below(8) == 0 { width / 2 } else { width };
            let rows = [0, 1, 2, 3].map(|k| &rows[k][round % 4..][..if k == 2 { long } else { width }]);
            (self.columns_of_four)(rows, &mut out[..width]);
            portable::columns_of_four(rows, &mut expected[..width]);
            out == expected
        })
    }

    fn costs(&self, random: &mut Random) -> bool {
        (0..300).all(|round: usize| {
            let groups = round % (GROUPS + 2);
            let (mut right, mut out) = ([0; 72], [Group([7; 4]); GROUPS + 1]);
            right.iter_mut().for_each(|word| *word = random.next());
            let mut expected = out;
            let left = [0; 4].map(|_| random.next());
            let right = &right[..(4 * groups + 2 + random.below(3))];
            (self.block_costs)(&left, right, &mut out[..groups]);
            portable::block_costs(&left, right, &mut expected[..groups]);
            out == expected
        })
    }

    fn blocks(&self, random: &mut Random) -> bool {
        (0..1000).all(|round: usize| {
            let groups = round % (GROUPS + 2);
            let mut given = [[Group::default(); GROUPS + 1]; 5];
            given.as_flattened_mut().iter_mut().for_each(|group| *group = random.group());
            let mut expected = given;
            let short = if random.below(8) == 0 { groups / 2 } else { groups };
            let run = |add_block: fn(&mut Blocks<'_>, &mut [Group]) -> Group,
                       [enters, leaves, row, kept, costs]: &mut [[Group; GROUPS + 1]; 5]| {
                let (row, kept) = (&mut row[..groups], &mut kept[..groups]);
                let mut blocks = Blocks { enters: &enters[..groups], leaves: &leaves[..short], row, kept };
                add_block(&mut blocks, &mut costs[..groups])
            };
            run(self.add_block, &mut given) == run(portable::add_block, &mut expected) && given == expected
        })
    }
}

/// Output of [`portable::slide_windows`].
#[derive(Clone, PartialEq, Eq)]
struct State {
    changes: [[[i8; 4]; GROUPS]; SLOTS],
    sums: [Group; GROUPS],
    costs: [Group; GROUPS * COLUMNS],
    lowest: [Group; COLUMNS],
}

impl State {
    fn run(&mut self, slide_windows: SlideWindows, windows: &Windows<'_>, slot: usize, groups: usize) {
        let columns = windows.asked.len();
        let (sums, costs) = (&mut self.sums[..groups], &mut self.costs[..groups * columns]);
        slide_windows(windows, (&mut self.changes, slot), sums, costs, &mut self.lowest[..columns]);
    }
}

impl Random {
    /// Any byte, often an extreme one.
    fn byte(&mut self) -> u8 {
        match self.below(6) {
            0 => 0,
            1 => u8::MAX,
            2 => 62,
            _ => (self.next() >> 11) as u8,
        }
    }

    fn group(&mut self) -> Group {
        let (low, high) = (self.next(), self.next());
        Group([
            low as u16,
            (low >> 16) as u16,
            high as u16,
            if self.below(8) == 0 { u16::MAX } else { (high >> 16) as u16 },
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernels_of_this_machine_equal_the_portable_ones() {
        assert_eq!(BlockKernels::CHOSEN.first_that_differs(), None);
    }

    /// Each is wrong for few inputs, as a kernel with a forgotten case is.
    const WRONG: BlockKernels = BlockKernels {
        sobel_row: |above, row, below, out| {
            portable::sobel_row(above, row, below, out);
            if let (77, Some(last)) = (row.len(), out.get_mut(75)) {
                *last ^= 1;
            }
        },
        add_column: |column, ring, sums| {
            portable::add_column(column, ring, sums);
            if let (12, Some(last)) = (sums.len(), sums.last_mut()) {
                last.0[3] ^= 0x8000;
            }
        },
        slide_windows: |windows, (changes, slot), sums, costs, lowest| {
            // Forgets where the ring ends.
            let slot = if slot + windows.asked.len() > SLOTS { 0 } else { slot };
            portable::slide_windows(windows, (changes, slot), sums, costs, lowest);
        },
        groups_within: |costs, bound| portable::groups_within(costs, bound - 1),
        places_within: |group, bound| portable::places_within(group, bound.saturating_sub(1)),
        columns_of_four: |rows, out| {
            let width = out.len();
            portable::columns_of_four(rows, &mut out[..width & !3]);
        },
        block_costs: |left, right, out| {
            let groups = out.len();
            portable::block_costs(left, right, &mut out[..groups.min(16)]);
        },
        add_block: |blocks, costs| {
            portable::add_block(blocks, costs);
            costs.first().copied().unwrap_or_default()
        },
    };

    #[test]
    fn every_wrong_kernel_is_found() {
        macro_rules! assert_found {
            ($($kernel:ident)*) => {$({
                let kernels = BlockKernels { $kernel: WRONG.$kernel, ..BlockKernels::CHOSEN };
                assert_eq!(kernels.first_that_differs(), Some(stringify!($kernel)));
            })*};
        }
        assert_found!(sobel_row add_column slide_windows groups_within);
        assert_found!(places_within columns_of_four block_costs add_block);
    }
}
