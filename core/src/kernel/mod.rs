//! The inner loops, as free functions over slices.
//!
//! `portable` is the definition, written so that a compiler can vectorise it. A version for a particular core must equal it bit for bit.

mod portable;

pub use portable::{FLAT, LANES, STRIP, Strip, census_row, gradient_row, hamming_curve, sad_curve};
