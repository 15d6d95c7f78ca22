//! Parameters of a camera and a pose: plain vectors of numbers, and the projection they stand for.
//!
//! The lens is the core's own [`Lens`]: one definition for estimating and for rectifying.

use crate::interchange::LensModel;
use linestereo::Dims;
use linestereo_rig::{Camera, CameraError, Lens};
use nalgebra::{Rotation3, Vector3};

impl LensModel {
    /// Names of a camera's numbers, in their order.
    #[must_use]
    pub fn names(self) -> &'static [&'static str] {
        match self {
            Self::BrownConrady => &["fx", "fy", "cx", "cy", "skew", "k1", "k2", "k3", "p1", "p2"],
            Self::Fisheye => &["fx", "fy", "cx", "cy", "skew", "k1", "k2", "k3", "k4"],
        }
    }
}

/// Numbers of a camera at most.
pub(super) const NUMBERS: usize = 10;
pub(super) const FX: usize = 0;
pub(super) const FY: usize = 1;
pub(super) const SKEW: usize = 4;
pub(super) const K1: usize = 5;

/// A corner of a board in an image: its place on the board in m, and in the image in px.
pub(super) type Sighting = ([f64; 2], [f64; 2]);

/// A camera as numbers: fx, fy, cx, cy, skew, then the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Intrinsics {
    pub(super) model: LensModel,
    pub(super) numbers: [f64; NUMBERS],
}

impl Intrinsics {
    /// A camera without distortion, its centre in the image's middle.
    pub(super) fn plain(model: LensModel, dims: Dims, focal: f64) -> Self {
        let mut numbers = [0.0; NUMBERS];
        let middle = [dims.width, dims.height].map(|side| f64::from(side - 1) / 2.0);
        numbers[..4].copy_from_slice(&[focal, focal, middle[0], middle[1]]);
        Self { model, numbers }
    }

    fn lens(&self) -> Lens {
        let [.., a, b, c, d, e] = self.numbers;
        match self.model {
            LensModel::BrownConrady => Lens::BrownConrady { k: [a, b, c], p: [d, e] },
            LensModel::Fisheye => Lens::Fisheye { k: [a, b, c, d] },
        }
    }

    pub(super) fn camera(&self, dims: Dims) -> Result<Camera, CameraError> {
        let [fx, fy, cx, cy, skew, ..] = self.numbers;
        Camera::new(dims, [fx, fy], [cx, cy], skew, self.lens())
    }

    /// Pixel of a point in the camera's coordinates; smooth everywhere in front of the camera,
    /// which a solver needs.
    pub(super) fn project(&self, point: Vector3<f64>) -> [f64; 2] {
        let z = point.z.max(1e-6);
        let [x, y] = self.lens().distort([point.x / z, point.y / z]);
        let [fx, fy, cx, cy, skew, ..] = self.numbers;
        [fx * x + skew * y + cx, fy * y + cy]
    }

    /// Predicted less seen, px, of each corner of a board that stands here.
    pub(super) fn errors(&self, pose: Pose, seen: &[Sighting]) -> impl Iterator<Item = [f64; 2]> {
        let (turn, shift) = (pose.rotation(), pose.translation());
        seen.iter().map(move |&([x, y], [u, v])| {
            let [pu, pv] = self.project(turn * Vector3::new(x, y, 0.0) + shift);
            [pu - u, pv - v]
        })
    }
}

/// Where coordinates are seen from: a rotation vector and a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pose(pub(super) [f64; 6]);

impl Pose {
    pub(super) fn new(rotation: Rotation3<f64>, translation: Vector3<f64>) -> Self {
        let [turn, shift] = [rotation.scaled_axis(), translation];
        Self([turn.x, turn.y, turn.z, shift.x, shift.y, shift.z])
    }

    pub(super) fn rotation(&self) -> Rotation3<f64> {
        let [x, y, z, ..] = self.0;
        Rotation3::from_scaled_axis(Vector3::new(x, y, z))
    }

    pub(super) fn translation(&self) -> Vector3<f64> {
        let [.., x, y, z] = self.0;
        Vector3::new(x, y, z)
    }

    /// First `self`, then `next`.
    pub(super) fn then(&self, next: &Self) -> Self {
        let turn = next.rotation();
        Self::new(turn * self.rotation(), turn * self.translation() + next.translation())
    }

    pub(super) fn inverse(&self) -> Self {
        let back = self.rotation().inverse();
        Self::new(back, -(back * self.translation()))
    }
}
