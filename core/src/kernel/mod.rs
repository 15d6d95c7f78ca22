//! The inner loops, as free functions over slices.
//!
//! [`portable`] is the definition, written so that a compiler can vectorise it. A version for a
//! particular core equals it bit for bit for every input, and exists only where it is measurably
//! faster. The version follows from the target:
//!
//! ```text
//! thumbv7em (Cortex-M4, M7)             dsp       every kernel; `cfg(dsp)` is set by build.rs
//! thumbv8m.main (Cortex-M33 and above)  dsp       with the feature `dsp`, or compiled for such a processor
//! the same (Cortex-M55, M85)            helium    with the feature `helium`, or compiled for such a processor:
//!                                                 rows, codes and their windows, strips, paths, minima; others as dsp
//! x86_64                                sse2      sad_curve, code_columns, code_costs, path_step
//! wasm32 with simd128                   simd128   sad_curve, code_columns, code_costs, path_step
//! riscv32, thumbv7m (Cortex-M3),
//! thumbv8m.main without DSP             swar      codes and their windows, strips and points, paths, gradients
//! any other                             portable
//! ```
//!
//! `firmware/src/programs/kernels` compares the chosen kernels with the portable ones, on boards
//! and on a PC. Kernels of rectification are in `linestereo-rig`.

pub mod portable;
#[allow(unsafe_code, reason = "whole words among bytes")]
pub mod swar;

/// Kernels that this build has: `helium`, `dsp`, `sse2`, `simd128`, `swar` or `portable`.
pub const KERNELS: &str = if cfg!(helium) {
    "helium"
} else if cfg!(dsp) {
    "dsp"
} else if cfg!(target_arch = "x86_64") {
    "sse2"
} else if cfg!(target_feature = "simd128") {
    "simd128"
} else if cfg!(swar) {
    "swar"
} else {
    "portable"
};

#[cfg(dsp)]
#[allow(unsafe_code, reason = "vector instructions")]
pub mod dsp;
#[cfg(helium)]
#[allow(unsafe_code, reason = "vector instructions")]
mod helium;
#[cfg(target_feature = "simd128")]
#[allow(unsafe_code, reason = "vector instructions")]
mod simd128;
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code, reason = "vector instructions")]
mod sse2;

pub use portable::{
    CODE_FLAT, CODE_ROWS, CodeColumn, CodeMoments, Crossing, Crossings, FLAT, GRADIENTS,
    JUMP_PENALTY, LAGS, LANES, LargestStep, Products, RIGHT_GRADIENTS, RUN_PIXELS, STEP_PENALTY,
    STRIP, Strip,
};

#[cfg(dsp)]
pub use dsp::{
    add_products, census_code, code_moments, code_steps, crossing, hamming_curve, largest_step,
    lower_curve, lower_sum_curve, reverse_row, row_difference, second_differences, sum_curve,
};
#[cfg(all(dsp, not(helium)))]
pub use dsp::{
    census_row, code_columns, code_costs, gradient_row, limited_steps, lowest, lowest_byte,
    path_step, place_of_byte, sad_curve, sum_paths,
};
#[cfg(helium)]
pub use helium::{
    census_row, code_columns, code_costs, gradient_row, limited_steps, lowest, lowest_byte,
    path_step, place_of_byte, sad_curve, sum_paths,
};
#[cfg(not(dsp))]
pub use portable::{
    add_products, census_code, census_row, code_moments, code_steps, crossing, largest_step,
    limited_steps, lower_curve, lower_sum_curve, lowest, place_of_byte, reverse_row,
    row_difference, second_differences, sum_curve,
};
#[cfg(not(any(dsp, swar, target_arch = "x86_64", target_feature = "simd128")))]
pub use portable::{code_columns, code_costs, path_step, sad_curve};
#[cfg(not(any(dsp, swar)))]
pub use portable::{gradient_row, hamming_curve, lowest_byte, sum_paths};
#[cfg(target_feature = "simd128")]
pub use simd128::{code_columns, code_costs, path_step, sad_curve};
#[cfg(target_arch = "x86_64")]
pub use sse2::{code_columns, code_costs, path_step, sad_curve};
#[cfg(swar)]
pub use swar::{
    code_columns, code_costs, code_costs_in, gradient_row, hamming_curve, lowest_byte, path_step,
    sad_curve, spread_bytes, spread_codes, sum_paths,
};

/// Bytes in which columns are spread: only [`swar`] does.
#[cfg(not(swar))]
pub(crate) const fn spread_bytes(_columns: usize) -> usize {
    0
}

/// See [`swar::spread_codes`].
#[cfg(not(swar))]
#[inline(always)]
pub(crate) fn spread_codes(_columns: &[CodeColumn], _memory: &mut [u8]) {}

/// See [`swar::code_costs_in`].
#[cfg(not(swar))]
#[inline(always)]
pub(crate) fn code_costs_in(
    window: &[CodeColumn; STRIP],
    columns: &[CodeColumn],
    first: usize,
    _memory: &[u8],
    costs: &mut [u8],
) {
    code_costs(window, columns.get(first..).unwrap_or_default(), costs);
}
