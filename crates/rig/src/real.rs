//! Arithmetic of either precision, for formulas that both have.
#![allow(clippy::float_arithmetic, reason = "set-up")]

use core::ops::{Add, Div, Mul};

/// `f32` or `f64`. Square root and arc tangent are libm's on every machine, so that bits are the
/// same.
pub trait Real:
    Copy
    + PartialOrd
    + From<f32>
    + Into<f64>
    + Add<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    fn sqrt(self) -> Self;
    fn atan(self) -> Self;
}

impl Real for f32 {
    fn sqrt(self) -> Self {
        libm::sqrtf(self)
    }

    fn atan(self) -> Self {
        libm::atanf(self)
    }
}

impl Real for f64 {
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }

    fn atan(self) -> Self {
        libm::atan(self)
    }
}
