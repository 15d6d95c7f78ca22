//! Cost of each kernel on this machine: the one that the core uses, and the portable one as
//! compiled for the same processor.
//!
//! In: the pixels of a frame, memory for a row, a clock. Out: per kernel both costs, in the clock's
//! unit, with the call and two looks at the clock (some ten instructions). Work of the usual size:
//! rows of 320 px, curves of 64 disparities, 12 strips or points, 20 cells of 16 px.

use super::kernels::Kernels;
use crate::ports::Clock;
use core::hint::black_box;
use linestereo::unstable::kernel::{
    CELL, CODE_ROWS, Crossings, Knot, Products, RUN_PIXELS, Ring, Run, STRIP, Strip,
};

const WIDTH: usize = 320;
const DISPARITIES: usize = 64;
const WINDOWS: usize = 12;
const CELLS: usize = WIDTH / CELL;
/// Rows of the ring that grey levels come from.
const ROWS: usize = 8;
/// Pixels that are read.
pub const PIXELS: usize = 16 * WIDTH;

/// Columns of codes, which begin at a whole word as in the core.
#[repr(align(4))]
struct Columns<const N: usize>([[u8; CODE_ROWS]; N]);

/// Cost of one kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KernelCost {
    /// Its name.
    pub kernel: &'static str,
    /// The one that the core uses here.
    pub chosen: u64,
    /// The portable one.
    pub portable: u64,
}

/// Measures every kernel; none where there are less than [`PIXELS`].
pub fn measure(clock: &impl Clock, pixels: &[u8]) -> Option<[KernelCost; Kernels::COUNT]> {
    let pixels = pixels.first_chunk::<PIXELS>()?;
    let [chosen, portable] = [Kernels::CHOSEN, Kernels::PORTABLE]
        .map(|kernels| costs(&black_box(kernels), clock, pixels));
    let mut pairs = chosen.into_iter().zip(portable);
    Some(core::array::from_fn(|_| {
        let ((kernel, chosen), (_, portable)) = pairs.next().unwrap_or_default();
        KernelCost { kernel, chosen, portable }
    }))
}

fn costs(
    kernels: &Kernels,
    clock: &impl Clock,
    pixels: &[u8; PIXELS],
) -> [(&'static str, u64); Kernels::COUNT] {
    let row = |k: usize| pixels.get(k * WIDTH..(k + 1) * WIDTH).unwrap_or(&[]);
    let mut gradients = [[0; WIDTH]; 2];
    for (k, gradients) in gradients.iter_mut().enumerate() {
        (kernels.gradient_row)(row(k), row(k + 1), row(k + 2), gradients);
    }
    let [left, right] = &gradients;
    let strips = core::array::from_fn::<_, WINDOWS, _>(|k| {
        let from = |row: &'_ [u8; WIDTH]| row.get(k..).and_then(<[u8]>::first_chunk).copied();
        Strip { reference: from(left).unwrap_or_default(), other: right.get(k..).unwrap_or(&[]) }
    });
    let points = core::array::from_fn::<_, WINDOWS, _>(|k| (k as u8, row(k)));
    // A slope of a fiftieth of a pixel per pixel, over the middle of the ring.
    let knots = core::array::from_fn::<_, { CELLS + 3 }, _>(|k| {
        let x = (k * CELL) as i32 * 65_000 / 66_000;
        Knot { x: x << 16, y: (3 << 16) + (k as i32 * 6_000) }
    });
    let runs = core::array::from_fn::<_, CELLS, _>(|k| Run {
        top: (3 * WIDTH) as u32,
        bottom: (4 * WIDTH) as u32,
        x_q16: (k * CELL) as i32 * 64_000,
        dx_q16: 64_000,
        fy_q14: 5_000,
        dfy_q14: 100,
        length: CELL as u32,
        ..Run::default()
    });
    let ring = Ring {
        bytes: pixels.get(..(ROWS + 2) * WIDTH).unwrap_or(&[]),
        width: WIDTH,
        rows: ROWS as u32,
        first: 0,
    };
    let (mut out, mut curve, mut between) =
        ([0_u8; WIDTH], [0_u16; DISPARITIES], [Knot::default(); CELLS + 3]);
    let [a, b, c] = core::array::from_fn(|k| {
        core::array::from_fn(|i| row(k).get(i).copied().unwrap_or(0).into())
    });
    let [a, b, c]: [&[u16; DISPARITIES]; 3] = [&a, &b, &c];
    let codes = Columns([[1; CODE_ROWS]; DISPARITIES + STRIP - 1]);
    let mut columns = Columns([[0; CODE_ROWS]; WIDTH]);
    let window = Columns([[2; CODE_ROWS]; STRIP]);
    let mut bytes = [[0_u8; DISPARITIES]; 3];
    let [costs, path, sums] = &mut bytes;
    let mut products = [Products::default(); 2];
    let columns_of_pixels = Crossings::of_columns(pixels, WIDTH);
    [
        ("gradient_row", time(clock, || (kernels.gradient_row)(row(0), row(1), row(2), &mut out))),
        ("census_row", time(clock, || (kernels.census_row)([row(0), row(2), row(4)], &mut out))),
        ("reverse_row", time(clock, || (kernels.reverse_row)(&mut out))),
        ("sad_curve", time(clock, || (kernels.sad_curve)(&strips, &mut curve))),
        ("hamming_curve", time(clock, || (kernels.hamming_curve)(&points, &mut curve))),
        ("sum_curve", time(clock, || (kernels.sum_curve)(a, b, &mut curve))),
        ("lower_curve", time(clock, || (kernels.lower_curve)(a, b, &mut curve))),
        ("lower_sum_curve", time(clock, || (kernels.lower_sum_curve)(a, b, c, &mut curve))),
        ("lowest", time(clock, || (kernels.lowest)(a))),
        ("largest_step", time(clock, || (kernels.largest_step)(row(0), 2, 9))),
        ("census_code", time(clock, || (kernels.census_code)(pixels, 100, WIDTH))),
        ("crossing", time(clock, || (kernels.crossing)(&columns_of_pixels, 100, 1))),
        ("bilinear_runs", time(clock, || (kernels.bilinear_runs)(pixels, WIDTH, &runs, &mut out))),
        ("bilinear_cells", time(clock, || (kernels.bilinear_cells)(ring, &knots, &mut out))),
        (
            "weigh_knots",
            time(clock, || (kernels.weigh_knots)([&knots; 4], [1 << 28; 4], &mut between)),
        ),
        (
            "code_columns",
            time(clock, || (kernels.code_columns)(core::array::from_fn(row), 4, &mut columns.0)),
        ),
        ("code_steps", time(clock, || (kernels.code_steps)(&window.0))),
        ("code_costs", time(clock, || (kernels.code_costs)(&window.0, &codes.0, costs))),
        ("path_step", time(clock, || (kernels.path_step)(costs, 0, path))),
        ("sum_paths", time(clock, || (kernels.sum_paths)(costs, path, sums))),
        ("lowest_byte", time(clock, || (kernels.lowest_byte)(costs))),
        ("place_of_byte", time(clock, || (kernels.place_of_byte)(costs, 0))),
        ("code_moments", time(clock, || (kernels.code_moments)(&[[3; CODE_ROWS]; STRIP + 2]))),
        (
            "second_differences",
            time(clock, || (kernels.second_differences)([&[5; RUN_PIXELS]; 3], 2)),
        ),
        ("limited_steps", time(clock, || (kernels.limited_steps)(row(0), row(1), 63, &mut out))),
        ("row_difference", time(clock, || (kernels.row_difference)(&[7; STRIP], &[9; STRIP]))),
        ("add_products", time(clock, || (kernels.add_products)(&[7; 10], &[9; 22], &mut products))),
    ]
}

fn time<T>(clock: &impl Clock, work: impl FnOnce() -> T) -> u64 {
    let start = clock.now();
    black_box(work());
    // Worked out at once, not behind the next look at the clock.
    black_box(clock.elapsed(start, clock.now()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ports::NoClock;

    #[test]
    fn every_kernel_has_a_line_where_there_are_pixels() {
        let costs = measure(&NoClock, &[7; PIXELS]).unwrap();
        assert!(
            costs
                .iter()
                .all(|cost| !cost.kernel.is_empty() && (cost.chosen, cost.portable) == (0, 0))
        );
        assert_eq!(measure(&NoClock, &[7; PIXELS - 1]), None);
    }
}
