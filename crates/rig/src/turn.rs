//! Rotations as unit quaternions `[w, x, y, z]`: no trigonometry, so that results are equal on
//! every machine.
#![allow(clippy::float_arithmetic, reason = "set-up")]

use nalgebra::Matrix3;

/// Half of a rotation; `w >= 0`.
pub(crate) fn half([w, x, y, z]: [f64; 4]) -> [f64; 4] {
    let length = libm::sqrt(2.0 * (1.0 + w));
    [length / 2.0, x / length, y / length, z / length]
}

/// Rotation matrix of a unit quaternion `[w, x, y, z]`: equal bits on every machine.
#[must_use]
pub fn rotation_matrix([w, x, y, z]: [f64; 4]) -> Matrix3<f64> {
    Matrix3::new(
        1.0 - 2.0 * (y * y + z * z),
        2.0 * (x * y - w * z),
        2.0 * (x * z + w * y),
        2.0 * (x * y + w * z),
        1.0 - 2.0 * (x * x + z * z),
        2.0 * (y * z - w * x),
        2.0 * (x * z - w * y),
        2.0 * (y * z + w * x),
        1.0 - 2.0 * (x * x + y * y),
    )
}
