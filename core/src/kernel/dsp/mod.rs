//! Kernels for cores with Arm's DSP extension (Armv7E-M: Cortex-M4 and M7; Armv8-M Mainline with
//! it: Cortex-M33 and above): four bytes or two half words per instruction.
//!
//! In and out as the [`portable`](super::portable) versions, the same bits for every input: they do
//! what a loop here cannot.
//!
//! ```text
//! rows    gradient, census, reversal of a row
//! curves  costs over disparity: sums of strips and points, operations on curves
//! codes   codes of texture, and how they change
//! support costs of windows of codes, paths
//! edges   the largest step along a row or column, gradients where an edge crosses
//! lags    products of gradients along two rows, at several lags
//! ```
//!
//! # Bounds
//! Words are read and written at any address, which these cores allow for single words (Armv7-M
//! Architecture Reference Manual, A3.2.1; Armv8-M the same). `firmware/src/programs/kernels.rs`
//! compares every kernel with its portable version between fences of forbidden memory.
//!
//! # Cost
//! In the modules.
//!
//! # Source
//! Armv7-M Architecture Reference Manual, A7.7: USADA8, USAD8, USUB8, SEL, QADD8, QSUB8, SHADD8,
//! UQADD8, UQSUB8, UQADD16, USUB16, SSUB16, UXTB16, UXTAB16, PKHBT, SMLAD, SMUAD.

/// `asm!` for a processor with the extension, also where the crate is compiled for Armv8-M without
/// one by name.
#[cfg(armv8m)]
macro_rules! asm {
    ($($arguments:tt)*) => { core::arch::asm!(".cpu cortex-m33", $($arguments)*) };
}
#[cfg(not(armv8m))]
macro_rules! asm {
    ($($arguments:tt)*) => { core::arch::asm!($($arguments)*) };
}

mod codes;
mod curves;
mod edges;
mod lags;
mod rows;
mod support;

pub use codes::{code_columns, code_moments, code_steps, row_difference};
pub use curves::{hamming_curve, lower_curve, lower_sum_curve, lowest, sad_curve, sum_curve};
pub use edges::{crossing, largest_step, second_differences};
pub use lags::add_products;
pub use rows::{census_code, census_row, gradient_row, limited_steps, reverse_row};
pub use support::{code_costs, lowest_byte, path_step, place_of_byte, sum_paths};

/// A function of two words that is one instruction, which leaves all flags as they are.
macro_rules! two_operands {
    ($(#[$doc:meta])* $visible:vis $name:ident, $instruction:literal) => {
        two_operands!($(#[$doc])* $visible $name, $instruction, preserves_flags);
    };
    ($(#[$doc:meta])* $visible:vis $name:ident, $instruction:literal, $($flags:ident)?) => {
        $(#[$doc])*
        #[inline(always)]
        $visible fn $name(a: u32, b: u32) -> u32 {
            let result: u32;
            // SAFETY: the instruction reads and writes registers alone; every core this module is
            // compiled for has it.
            unsafe {
                asm!($instruction, r = lateout(reg) result, a = in(reg) a, b = in(reg) b,
                    options(pure, nomem, nostack $(, $flags)?));
            }
            result
        }
    };
}
use two_operands;

/// The four bytes from `at` on.
///
/// # Safety
/// They can be read.
#[inline(always)]
unsafe fn word(at: *const u8) -> u32 {
    // SAFETY: the caller's.
    unsafe { at.cast::<u32>().read_unaligned() }
}
