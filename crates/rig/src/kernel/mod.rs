//! The inner loops of rectification, as free functions over slices, built as the core's.
//!
//! In: raw rows and where to read between them. Out: grey levels; positions between knots.
//!
//! ```text
//! portable    the definition of each: weigh_knots (knots of four rows -> of one between them),
//!             bilinear_cells, bilinear_runs (positions -> grey levels)
//! dsp         the same bits by Arm's DSP extension, where the core has its own such kernels
//! ```
//!
//! `firmware/src/programs/kernels` compares the chosen kernels with the portable ones, on boards
//! and on a PC.

#[cfg(dsp)]
#[allow(unsafe_code, reason = "packed instructions")]
mod dsp;
pub mod portable;

#[cfg(dsp)]
pub use dsp::{bilinear_cells, bilinear_runs, weigh_knots};
pub use portable::{CELL, Knot, Ring, Run, X_ROUNDING, bilinear, columns};
#[cfg(not(dsp))]
pub use portable::{bilinear_cells, bilinear_runs, weigh_knots};
