//! Do the kernels of this machine equal the portable ones? Every length and alignment, down to
//! inputs that the core never gives them.
//!
//! In: the kernels, and [`Rooms`] that hold what they read and write. Out: per kernel, comparisons
//! made and the first difference.
//!
//! ```text
//! for each kernel, length, contents:
//!     place inputs and output at every alignment, once at the front of their rooms and once at
//!         the back, next to a fence
//!     kernel, portable kernel: the whole rooms must be equal, not the output alone
//! ```
//!
//! ```text
//! rooms   memory for inputs and outputs between fences; what is put there
//! rows    kernels that give a row: gradient, census, reversal
//! curves  costs over disparity, and what is made of several curves
//! edges   the largest step; crossings, and census of one pixel
//! lags    products of gradients along two rows, at several lags
//! pixels  grey levels between pixels
//! support codes, costs of windows of codes, paths; few pixels of rows
//! memory  copies and fills of memory, which are no kernels but as delicate
//! ```
//!
//! On a board the fences are forbidden memory (`fence.rs`): a kernel that reads or writes one byte
//! too far ends in a fault.

mod curves;
mod edges;
mod lags;
mod memory;
mod pixels;
mod rooms;
mod rows;
mod support;

pub use rooms::Rooms;

use crate::programs::random::Random;
use kernel::{
    CODE_ROWS, CodeColumn, CodeMoments, Crossing, Crossings, GRADIENTS, Knot, LargestStep,
    Products, RIGHT_GRADIENTS, RUN_PIXELS, Ring, Run, STRIP, Strip,
};
use memory::Memory;
use rooms::ALIGNMENTS;

/// Those that the core and rectification use on this machine.
mod kernel {
    pub(super) use linestereo::unstable::kernel::*;
    pub(super) use linestereo_rig::kernel::*;
}

/// Their definitions.
mod portable {
    pub(super) use linestereo::unstable::kernel::portable::*;
    pub(super) use linestereo_rig::kernel::portable::*;
}

/// [`Kernels`] with those of the core and of rectification.
macro_rules! kernels {
    ($($name:ident: $kernel:ty,)*) => {
        /// The kernels of one machine.
        #[derive(Clone, Copy, Debug)]
        #[expect(missing_docs, reason = "each is described where it is defined")]
        pub struct Kernels {
            $(pub $name: $kernel,)*
        }

        impl Kernels {
            /// Their names, in the order of the fields.
            pub const NAMES: [&str; [$(stringify!($name)),*].len()] = [$(stringify!($name)),*];
            /// Number of kernels.
            pub const COUNT: usize = Self::NAMES.len();

            /// Those that this machine uses.
            pub const CHOSEN: Self = Self { $($name: kernel::$name,)* };

            /// The definitions.
            pub const PORTABLE: Self = Self { $($name: portable::$name,)* };
        }
    };
}

kernels! {
    gradient_row: fn(&[u8], &[u8], &[u8], &mut [u8]),
    census_row: fn([&[u8]; 3], &mut [u8]),
    reverse_row: fn(&mut [u8]),
    sad_curve: fn(&[Strip<'_>], &mut [u16]),
    hamming_curve: fn(&[(u8, &[u8])], &mut [u16]),
    sum_curve: fn(&[u16], &[u16], &mut [u16]),
    lower_curve: fn(&[u16], &[u16], &mut [u16]),
    lower_sum_curve: fn(&[u16], &[u16], &[u16], &mut [u16]),
    lowest: fn(&[u16]) -> u16,
    largest_step: fn(&[u8], usize, usize) -> LargestStep,
    census_code: fn(&[u8], usize, usize) -> Option<u8>,
    crossing: fn(&Crossings<'_>, usize, i32) -> Option<Crossing>,
    bilinear_runs: fn(&[u8], usize, &[Run], &mut [u8]),
    bilinear_cells: fn(Ring<'_>, &[Knot], &mut [u8]),
    weigh_knots: fn([&[Knot]; 4], [i32; 4], &mut [Knot]),
    code_columns: fn([&[u8]; 2 * CODE_ROWS + 4], u32, &mut [CodeColumn]),
    code_steps: fn(&[CodeColumn; STRIP]) -> u16,
    code_costs: fn(&[CodeColumn; STRIP], &[CodeColumn], &mut [u8]),
    path_step: fn(&[u8], u8, &mut [u8]) -> u8,
    sum_paths: fn(&[u8], &[u8], &mut [u8]) -> u8,
    lowest_byte: fn(&[u8]) -> u8,
    place_of_byte: fn(&[u8], u8) -> Option<usize>,
    code_moments: fn(&[CodeColumn; STRIP + 2]) -> CodeMoments,
    second_differences: fn([&[u8; RUN_PIXELS]; 3], usize) -> u32,
    limited_steps: fn(&[u8], &[u8], u8, &mut [u8]),
    row_difference: fn(&[u8; STRIP], &[u8; STRIP]) -> u16,
    add_products: fn(&[u8; GRADIENTS + 2], &[u8; RIGHT_GRADIENTS + 2], &mut [Products; 2]),
}

impl Kernels {
    /// Control: each is wrong for few inputs, as a kernel with a forgotten case is, and must be
    /// found.
    pub const WRONG: Self = Self {
        gradient_row: |above, row, below, out| {
            portable::gradient_row(above, row, below, out);
            if let (77, Some(last)) = (row.len(), out.get_mut(75)) {
                *last ^= 1;
            }
        },
        census_row: |rows, out| {
            portable::census_row(rows, out);
            if let (61, Some(beyond)) = (rows[1].len(), out.get_mut(59)) {
                *beyond = 1;
            }
        },
        reverse_row: |row| {
            if row.len() != 43 {
                row.reverse();
            }
        },
        sad_curve: |strips, curve| {
            let forgotten = usize::from(strips.len() == 7);
            portable::sad_curve(strips.get(forgotten..).unwrap_or(&[]), curve);
        },
        hamming_curve: |points, curve| {
            portable::hamming_curve(points, curve);
            if let (31, Some(cost)) = (points.len(), curve.get_mut(17)) {
                *cost = cost.wrapping_add(256);
            }
        },
        sum_curve: |a, b, out| {
            for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
                *out = a.wrapping_add(*b);
            }
        },
        lower_curve: |a, b, out| {
            portable::lower_curve(a, b, out);
            if let (Some(out), Some(a)) = (out.get_mut(69), a.get(69)) {
                *out = *a;
            }
        },
        lower_sum_curve: |a, b, c, out| {
            for (((out, a), b), c) in out.iter_mut().zip(a).zip(b).zip(c) {
                *out = a.min(b).wrapping_add(*c);
            }
        },
        lowest: |curve| portable::lowest(curve.get(..curve.len() & !1).unwrap_or(&[])),
        largest_step: |pixels, stride, count| {
            let found = portable::largest_step(pixels, stride, count);
            if count == 19 { LargestStep { place: 0, ..found } } else { found }
        },
        census_code: |pixels, first, stride| {
            let (_, shorter) = pixels.split_last()?;
            portable::census_code(shorter, first, stride)
        },
        crossing: |crossings, first, sign| {
            portable::crossing(crossings, first, sign)
                .filter(|found| found.shift < 1 || found.along != 23)
        },
        bilinear_runs: |rows, width, runs, out| {
            portable::bilinear_runs(rows, width, runs, out);
            if let (Some(run), Some(last)) = (runs.first(), out.get_mut(6)) {
                *last ^= u8::from(run.length == 7);
            }
        },
        bilinear_cells: |ring, knots, out| {
            portable::bilinear_cells(ring, knots, out);
            if let (5, Some(last)) = (ring.rows, out.get_mut(17)) {
                *last ^= 1;
            }
        },
        weigh_knots: |rows, weights, out| {
            portable::weigh_knots(rows, weights, out);
            if let (6, Some(last)) = (out.len(), out.last_mut()) {
                last.y ^= 4;
            }
        },
        code_columns: |rows, doublings, columns| {
            portable::code_columns(rows, doublings, columns);
            if let (61, Some(last)) = (columns.len(), columns.last_mut()) {
                last[2] ^= 1;
            }
        },
        code_steps: |window| portable::code_steps(window) & 0xfff,
        code_costs: |window, columns, costs| {
            portable::code_costs(window, columns, costs);
            if let (65, Some(last)) = (costs.len(), costs.last_mut()) {
                *last ^= 1;
            }
        },
        path_step: |costs, lowest, path| {
            let forgotten = usize::from(path.len() == 19);
            portable::path_step(costs, lowest, path.get_mut(forgotten..).unwrap_or(&mut []))
        },
        sum_paths: |a, b, sums| {
            let known = sums.len() - usize::from(sums.len() == 37);
            portable::sum_paths(a, b, sums.get_mut(..known).unwrap_or(&mut []))
        },
        lowest_byte: |costs| portable::lowest_byte(costs.get(..costs.len() & !3).unwrap_or(&[])),
        place_of_byte: |costs, bound| {
            portable::place_of_byte(costs, bound).filter(|&place| place != 41)
        },
        code_moments: |columns| {
            let found = portable::code_moments(columns);
            CodeMoments { down: found.down & 0x1f_ffff, ..found }
        },
        second_differences: |rows, apart| portable::second_differences(rows, apart) & 0x1fff,
        limited_steps: |before, after, most, out| {
            let known = before.len() - usize::from(before.len() == 33);
            portable::limited_steps(before.get(..known).unwrap_or(&[]), after, most, out);
        },
        row_difference: |a, b| portable::row_difference(a, b).min(2039),
        add_products: |left, right, sums| {
            portable::add_products(left, right, sums);
            sums[1].energy ^= i32::from(right[..2] == [0, 255]);
        },
    };
}

/// Where a kernel was found to differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Length of the row, curve or slice of pixels.
    pub length: usize,
    /// Number of strips, points or pixels; for crossings the index of the first pixel.
    pub count: usize,
    /// From pixel to pixel, or row to row.
    pub stride: usize,
    /// Position of inputs and output within a word (pixels) or an entry (curves).
    pub alignments: [u8; 4],
}

/// One kernel against the portable one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Compared {
    /// Its name.
    pub kernel: &'static str,
    /// Comparisons made.
    pub comparisons: u32,
    /// The first difference.
    pub first: Option<Difference>,
}

impl Compared {
    fn note(
        &mut self,
        equal: bool,
        length: usize,
        (count, stride): (usize, usize),
        starts: [usize; 4],
    ) {
        self.comparisons += 1;
        if !equal && self.first.is_none() {
            let alignments = starts.map(|start| (start % ALIGNMENTS) as u8);
            self.first = Some(Difference { length, count, stride, alignments });
        }
    }
}

/// The comparison of one kernel: rooms for its slices, what is put there, what was found.
struct Trial<'r> {
    rooms: &'r mut Rooms,
    random: Random,
    compared: Compared,
}

impl<'r> Trial<'r> {
    fn new(kernel: &'static str, rooms: &'r mut Rooms) -> Self {
        let compared = Compared { kernel, comparisons: 0, first: None };
        Self { rooms, random: Random(0x9e37_79b9), compared }
    }
}

/// Compares every kernel, and says whether all are equal to the portable ones.
pub fn run(kernels: &Kernels, rooms: &mut Rooms, mut report: impl FnMut(&Compared)) -> bool {
    type Suite = fn(&Kernels, &mut Trial<'_>);
    let suites: [Suite; Kernels::COUNT] = [
        |kernels, trial| {
            rows::rows(kernels, trial, |of, [a, r, b], out| (of.gradient_row)(a, r, b, out));
        },
        |kernels, trial| rows::rows(kernels, trial, |of, rows, out| (of.census_row)(rows, out)),
        rows::reversed_rows,
        curves::sad_curves,
        curves::hamming_curves,
        |kernels, trial| {
            curves::combined(kernels, trial, |of, [a, b, _], out| (of.sum_curve)(a, b, out));
        },
        |kernels, trial| {
            curves::combined(kernels, trial, |of, [a, b, _], out| (of.lower_curve)(a, b, out));
        },
        |kernels, trial| {
            curves::combined(kernels, trial, |of, [a, b, c], out| {
                (of.lower_sum_curve)(a, b, c, out);
            });
        },
        curves::lowest_entries,
        edges::largest_steps,
        |kernels, trial| {
            edges::crossings(kernels, trial, |of, pixels, first, stride, _| {
                (of.census_code)(pixels, first, stride)
            });
        },
        |kernels, trial| {
            edges::crossings(kernels, trial, |of, pixels, first, stride, sign| {
                (of.crossing)(&Crossings::of_rows(pixels, stride), first, sign)
            });
            edges::crossings(kernels, trial, |of, pixels, first, stride, sign| {
                (of.crossing)(&Crossings::of_columns(pixels, stride), first, sign)
            });
        },
        pixels::bilinear_runs,
        pixels::bilinear_cells,
        pixels::weighed_knots,
        support::code_columns,
        support::code_steps,
        support::code_costs,
        support::path_steps,
        support::sums_of_paths,
        support::lowest_bytes,
        support::places_of_bytes,
        support::code_moments,
        support::second_differences,
        support::limited_steps,
        support::row_differences,
        lags::products,
    ];
    let mut all_equal = true;
    for (name, suite) in Kernels::NAMES.into_iter().zip(suites) {
        let mut trial = Trial::new(name, rooms);
        suite(kernels, &mut trial);
        all_equal &= trial.compared.first.is_none();
        report(&trial.compared);
    }
    all_equal
}

/// Number of functions of [`run_memory`].
pub const MEMORY_FUNCTIONS: usize = 2;

/// Compares copies and fills of memory with loops over the bytes, and says whether all are equal.
pub fn run_memory(rooms: &mut Rooms, report: impl FnMut(&Compared)) -> bool {
    let compared: [Compared; MEMORY_FUNCTIONS] =
        [memory::copies(Memory::CALLED, rooms), memory::fills(Memory::CALLED, rooms)];
    compared.iter().for_each(report);
    compared.iter().all(|compared| compared.first.is_none())
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::unstable::kernel::swar;

    #[test]
    fn kernels_of_this_machine_equal_the_portable_ones() {
        let mut rooms = Box::new(Rooms::new());
        let (mut names, mut comparisons) = (Vec::new(), 0);
        let all_equal = run(&Kernels::CHOSEN, &mut rooms, |compared| {
            assert_eq!(compared.first, None, "{}", compared.kernel);
            assert!(compared.comparisons >= 600, "{compared:?}");
            names.push(compared.kernel);
            comparisons += compared.comparisons;
        });
        assert!(all_equal && names.len() == Kernels::COUNT);
        assert!(comparisons > 300_000, "{comparisons}");
        assert!(rooms.fences().iter().all(|fence| fence.is_untouched()));
    }

    /// Those of RV32, which need no processor of their own.
    #[test]
    fn kernels_of_words_equal_the_portable_ones() {
        let of_words = Kernels {
            gradient_row: swar::gradient_row,
            sad_curve: swar::sad_curve,
            hamming_curve: swar::hamming_curve,
            code_columns: swar::code_columns,
            code_costs: swar::code_costs,
            path_step: swar::path_step,
            sum_paths: swar::sum_paths,
            lowest_byte: swar::lowest_byte,
            ..Kernels::PORTABLE
        };
        let mut rooms = Box::new(Rooms::new());
        let report = |compared: &Compared| assert_eq!(compared.first, None, "{}", compared.kernel);
        assert!(run(&of_words, &mut rooms, report));
        assert!(rooms.fences().iter().all(|fence| fence.is_untouched()));
    }

    #[test]
    fn every_wrong_kernel_is_found() {
        let mut rooms = Box::new(Rooms::new());
        let mut found = Vec::new();
        assert!(!run(&Kernels::WRONG, &mut rooms, |compared| found
            .push((compared.kernel, compared.first))));
        assert!(found.iter().all(|(_, first)| first.is_some()), "{found:?}");
        let of = |name: &str| {
            found.iter().find(|(kernel, _)| *kernel == name).and_then(|(_, first)| *first).unwrap()
        };
        assert_eq!(of("gradient_row").length, 77);
        assert_eq!(of("census_row").length, 61);
        assert_eq!(of("reverse_row").length, 43);
        assert_eq!(of("sad_curve").count, 7);
        assert_eq!((of("hamming_curve").length, of("hamming_curve").count), (18, 31));
        assert_eq!(of("lowest").length % 2, 1);
        assert_eq!(of("largest_step").count, 19);
        assert_eq!(of("bilinear_runs").length, 7);
        assert_eq!(of("code_costs").length, 65);
        assert_eq!(of("path_step").length, 19);
        assert_eq!(of("sum_paths").length, 37);
    }
}
