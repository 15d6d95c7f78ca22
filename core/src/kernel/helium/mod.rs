//! Kernels for cores with Helium, Arm's M-profile vector extension (Armv8.1-M: Cortex-M55 and M85):
//! sixteen bytes per instruction.
//!
//! In and out as the [`portable`](super::portable) versions, the same bits for every input. What is
//! not here, and what is too short for a vector, is done by [`dsp`](super::dsp).
//!
//! ```text
//! rows    gradient, census, limited steps
//! curves  sums of strips over disparity, lowest entry
//! codes   codes of texture
//! support costs of windows of codes, paths
//! ```
//!
//! # Bounds
//! Vectors of bytes are read and written at any address (Armv8-M Architecture Reference Manual,
//! VLDRB, VSTRB). `firmware/src/programs/kernels` compares every kernel with its portable version
//! between fences of forbidden memory. Stable Rust has no types of these vectors: each kernel loads
//! and stores them itself. The coprocessor that has the floating-point unit has Helium too.
//!
//! # Cost
//! In the modules, as instructions under QEMU, with those of the DSP version behind them.
//!
//! # Source
//! Armv8-M Architecture Reference Manual, C2.4: VABAV, VHADD, VHSUB, VMIN, VMINV, VQADD, VQSUB,
//! VSHLC, VSRI, VST4.

/// `asm!` for a processor with the extension.
macro_rules! asm {
    ($($arguments:tt)*) => { core::arch::asm!(".cpu cortex-m55", $($arguments)*) };
}

mod codes;
mod curves;
mod rows;
mod support;

pub use codes::code_columns;
pub use curves::{lowest, sad_curve};
pub use rows::{census_row, gradient_row, limited_steps};
pub use support::{code_costs, lowest_byte, path_step, place_of_byte, sum_paths};

/// Bytes of a vector.
const VECTOR: usize = 16;
