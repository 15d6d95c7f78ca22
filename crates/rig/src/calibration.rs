//! Calibration of a pair: two cameras and the pose between them.
#![allow(clippy::float_arithmetic, reason = "set-up")]

use crate::camera::Camera;
use crate::turn::{half, rotation_matrix};
use core::fmt;
use nalgebra::Vector3;

/// Camera of the pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraSide {
    /// The left camera, the reference.
    Left,
    /// The right camera.
    Right,
}

impl CameraSide {
    /// Both, the reference first.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// This side's of a left and a right one.
    pub(crate) fn of<T>(self, [left, right]: &[T; 2]) -> &T {
        match self {
            Self::Left => left,
            Self::Right => right,
        }
    }
}

impl fmt::Display for CameraSide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Left => "left",
            Self::Right => "right",
        })
    }
}

/// A calibrated pair: a point at `X` in the left camera's coordinates is at `R X + t` in the right
/// one's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    cameras: [Camera; 2],
    rotation: [f64; 4],
    translation: [f64; 3],
}

/// Reason why two cameras are no stereo pair.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// The images of the two cameras differ in size.
    #[error("the images of the two cameras differ in size")]
    SizesDiffer,
    /// The quaternion's length is not 1 (within 1 %), or it is not finite.
    #[error("the rotation between the cameras is no unit quaternion")]
    Rotation,
    /// The cameras are turned against each other by more than 60 degrees.
    #[error("the cameras are turned against each other by more than 60 degrees")]
    Turned,
    /// The baseline is outside 0.0001 ..= 10 m, or not finite.
    #[error(
        "a baseline of {0} m is outside 0.0001 to 10: lengths are in metres, not in millimetres"
    )]
    Baseline(f64),
    /// The right camera lies to the left of the left one.
    #[error(
        "the right camera lies to the left of the left one: exchange their images, or correct the translation's sign"
    )]
    Swapped,
    /// The cameras lie above each other, or one behind the other, more than side by side.
    #[error("the cameras do not lie side by side")]
    NotSideBySide,
}

impl Calibration {
    /// A pair from its cameras, the rotation as a unit quaternion `[w, x, y, z]` and the
    /// translation in metres.
    pub fn new(
        left: Camera,
        right: Camera,
        rotation: [f64; 4],
        translation: [f64; 3],
    ) -> Result<Self, CalibrationError> {
        if left.dims() != right.dims() {
            return Err(CalibrationError::SizesDiffer);
        }
        let length = libm::sqrt(rotation.iter().map(|q| q * q).sum());
        if !(0.99..=1.01).contains(&length) {
            return Err(CalibrationError::Rotation);
        }
        // A unit quaternion is not divided, so that a stored one keeps its bits: once divided, its
        // length is 1 within 1e-15.
        let length = if (length - 1.0).abs() < 1e-14 { 1.0 } else { length };
        let sign = if rotation[0] < 0.0 { -length } else { length };
        let rotation = rotation.map(|q| q / sign);
        if rotation[0] < 0.866 {
            return Err(CalibrationError::Turned);
        }
        let baseline = libm::sqrt(translation.iter().map(|t| t * t).sum());
        if !(0.0001..=10.0).contains(&baseline) {
            return Err(CalibrationError::Baseline(baseline));
        }
        let calibration = Self { cameras: [left, right], rotation, translation };
        let [x, ..] = calibration.direction();
        if x < -0.7 {
            return Err(CalibrationError::Swapped);
        }
        if x < 0.7 {
            return Err(CalibrationError::NotSideBySide);
        }
        Ok(calibration)
    }

    /// One of the cameras.
    #[must_use]
    pub fn camera(&self, eye: CameraSide) -> &Camera {
        eye.of(&self.cameras)
    }

    /// Rotation from left to right coordinates, unit quaternion `[w, x, y, z]`, w >= 0.
    #[must_use]
    pub fn rotation(&self) -> [f64; 4] {
        self.rotation
    }

    /// Translation from left to right coordinates in metres.
    #[must_use]
    pub fn translation(&self) -> [f64; 3] {
        self.translation
    }

    /// Distance between the cameras in metres.
    #[must_use]
    pub fn baseline(&self) -> f64 {
        libm::sqrt(self.translation.iter().map(|t| t * t).sum())
    }

    /// Unit vector from the left to the right camera, in coordinates turned half way from one to
    /// the other.
    fn direction(&self) -> [f64; 3] {
        let t = rotation_matrix(half(self.rotation)).tr_mul(&Vector3::from(self.translation));
        (t / -self.baseline()).into()
    }

    /// Rotations from each camera's coordinates to common ones whose x axis runs along the
    /// baseline, as rows: each camera is turned half of the way to the other, then both by the
    /// smallest angle (Bouguet's choice, as OpenCV's `stereoRectify`).
    pub(crate) fn common_rotations(&self) -> [[[f64; 3]; 3]; 2] {
        let half = rotation_matrix(half(self.rotation));
        let [x, y, z] = self.direction();
        // The shortest rotation that takes the direction to the x axis: about their cross product
        // (0, z, -y).
        let length = libm::sqrt(2.0 * (1.0 + x));
        let align = rotation_matrix([length / 2.0, 0.0, z / length, -y / length]);
        [align * half, align * half.transpose()].map(|m| m.transpose().into())
    }
}
