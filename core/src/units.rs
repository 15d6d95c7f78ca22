//! Fixed-point quantities with their ranges and steps.

use fixed::types::{I10F6, I16F16, U0F16, U11F5};

/// Disparity `x_left - x_right` in pixels: -512 ..= 511.98, step 1/64 px.
pub type Disparity = I10F6;
/// Depth along the optical axis in metres: up to 32767.99, step 1/65536 m. [`INFINITE_DEPTH`] marks
/// zero disparity.
pub type Depth = I16F16;
/// Sub-pixel image position in pixels: 0 ..= 2047.97, step 1/32 px. Integer positions are pixel
/// centres.
pub type Position = U11F5;
/// Probability that a disparity is within 1 px of the truth: 0 ..= 0.99998, step 1/65536.
pub type Confidence = U0F16;

/// `numerator / denominator` rounded towards zero; 0 where it is undefined, which callers exclude:
/// it replaces a panic path.
#[inline]
pub(crate) fn quotient(numerator: i32, denominator: i32) -> i32 {
    numerator.checked_div(denominator).unwrap_or(0)
}

/// Length of a vector, within 7 %.
pub(crate) fn about_length(dx: i32, dy: i32) -> i32 {
    let (dx, dy) = (dx.abs(), dy.abs());
    dx.max(dy) + ((3 * dx.min(dy)) >> 3)
}

/// Saturating conversion to 16 bits; disparities up to 256 + 6 px in 1/64 px fit.
pub(crate) fn narrow(value: i32) -> i16 {
    i16::try_from(value).unwrap_or(if value < 0 { i16::MIN } else { i16::MAX })
}

/// The nearest disparity that there is.
pub(crate) fn disparity_from_q6(d_q6: i32) -> Disparity {
    Disparity::from_bits(narrow(d_q6))
}

/// Depth of a disparity (plus offset) of zero or less: too far to measure, not an error.
pub const INFINITE_DEPTH: Depth = Depth::MAX;
