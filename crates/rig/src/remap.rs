//! Raw positions of rectified pixels, in single precision: what a mesh is built from, and what a
//! rig image holds.
//!
//! In: a [`Rectification`](crate::Rectification), or the numbers of a
//! [`RigImage`](crate::RigImage). Out: the raw position of any rectified one. The search for the
//! common view, in double precision, is behind it: a board that gets its rig as an image needs none
//! of that.
//!
//! ```text
//! ray   = R ((x - cx) / f, (y - cy) / f, 1)        R: from common to the camera's coordinates
//! (u, v) = camera(ray)                             lens and pixel equation of `camera`
//! ```
//!
//! # Bounds
//! A dozen roundings of 2^-24: positions are within 1/1000 px of those in double precision for raw
//! images up to 1280 px, where meshes tolerate 1/64 px. Additions, products, quotients and square
//! roots alone, and `atan` by libm for a fisheye: equal bits on every machine.
#![allow(clippy::float_arithmetic, reason = "set-up")]

use crate::calibration::CameraSide;
use crate::camera::{CameraError, Lens, MAX_TANGENT, check_numbers};
use crate::rectification::{Rectification, RectifyError, check_dims};
use linestereo::{Rig, image::Dims, params::RigError};

/// Both cameras of a rectified pair: `remap` of a rectified position is the raw position that is
/// shown there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remap {
    pub(crate) dims: Dims,
    pub(crate) raw: Dims,
    pub(crate) focal: f32,
    pub(crate) centre: [f32; 2],
    pub(crate) baseline: f32,
    pub(crate) cameras: [RemapCamera; 2],
}

/// Raw camera behind a rectified image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemapCamera {
    /// Rotation from common to the camera's coordinates, by rows.
    pub rotation: [[f32; 3]; 3],
    /// Focal lengths, px.
    pub focal: [f32; 2],
    /// Optical centre, px.
    pub centre: [f32; 2],
    /// Skew, px.
    pub skew: f32,
    /// Distortion.
    pub lens: Lens<f32>,
    /// Tangent of the largest viewing angle that is used: where the lens starts to fold, at most
    /// [`MAX_TANGENT`].
    pub limit: f32,
}

impl Remap {
    /// Size of the rectified images.
    #[must_use]
    pub fn dims(&self) -> Dims {
        self.dims
    }

    /// Size of the raw images.
    #[must_use]
    pub fn raw_dims(&self) -> Dims {
        self.raw
    }

    /// Focal length of both rectified images, px.
    #[must_use]
    pub fn focal(&self) -> f32 {
        self.focal
    }

    /// Centre of both rectified images, px.
    #[must_use]
    pub fn centre(&self) -> [f32; 2] {
        self.centre
    }

    /// Distance between the cameras, m.
    #[must_use]
    pub fn baseline(&self) -> f32 {
        self.baseline
    }

    /// Raw camera of one side.
    #[must_use]
    pub fn camera(&self, side: CameraSide) -> &RemapCamera {
        side.of(&self.cameras)
    }

    /// The rig that converts disparities to depths, and pixels to positions in space.
    pub fn rig(&self) -> Result<Rig, RigError> {
        Rig::new(self.focal, self.baseline, 0.0)?.with_principal_point(self.centre)
    }

    /// Raw position of a rectified one, px, continued smoothly beyond the limit of the lens, with a
    /// flag that is true within the limit; may lie outside the raw image. `None` behind the camera.
    pub(crate) fn source(&self, side: CameraSide, [x, y]: [f32; 2]) -> Option<([f32; 2], bool)> {
        let ([cx, cy], f) = (self.centre, self.focal);
        let ray = [(x - cx) / f, (y - cy) / f];
        self.camera(side).project(ray)
    }

    /// Checks every number, as those of a file have to be.
    pub(crate) fn checked(self) -> Result<Self, RemapError> {
        check_dims(self.dims).map_err(RemapError::View)?;
        self.rig().map_err(|error| RemapError::View(RectifyError::Rig(error)))?;
        for (camera, side) in self.cameras.iter().zip(CameraSide::BOTH) {
            let RemapCamera { rotation, focal, centre, skew, lens, limit } = camera;
            check_numbers(self.raw, *focal, *centre, *skew, lens)
                .map_err(|error| RemapError::Camera(side, error))?;
            if !(0.0..=MAX_TANGENT as f32).contains(limit) {
                return Err(RemapError::Camera(side, CameraError::Folds((*limit).into())));
            }
            if !is_rotation(rotation) {
                return Err(RemapError::View(RectifyError::Rotation(side)));
            }
        }
        Ok(self)
    }
}

/// Number of a [`Remap`] that is not usable.
pub(crate) enum RemapError {
    Camera(CameraSide, CameraError),
    View(RectifyError),
}

impl RemapCamera {
    /// Raw position of a ray `(x, y, 1)` in common coordinates: see [`Remap::source`].
    fn project(&self, [x, y]: [f32; 2]) -> Option<([f32; 2], bool)> {
        let [rx, ry, rz] = self.rotation.map(|[a, b, c]| a * x + b * y + c);
        if rz <= 0.0 {
            return None;
        }
        let point = [rx / rz, ry / rz];
        let radius = libm::sqrtf(point[0] * point[0] + point[1] * point[1]);
        let ([fx, fy], [cx, cy], [x, y]) = (self.focal, self.centre, self.lens.distorted(point));
        Some(([fx * x + self.skew * y + cx, fy * y + cy], radius <= self.limit))
    }
}

impl Rectification {
    /// The same in single precision.
    #[must_use]
    #[allow(
        clippy::cast_possible_truncation,
        reason = "the range is checked; see the module's bounds"
    )]
    pub fn remap(&self) -> Remap {
        let single = |v: f64| v as f32;
        let cameras = CameraSide::BOTH.map(|side| {
            let camera = self.camera(side);
            RemapCamera {
                rotation: self.rotation(side).map(|row| row.map(single)),
                focal: camera.focal().map(single),
                centre: camera.centre().map(single),
                skew: single(camera.skew()),
                lens: camera.lens().to_single(),
                limit: single(camera.limit()),
            }
        });
        Remap {
            dims: self.dims(),
            raw: self.camera(CameraSide::Left).dims(),
            focal: single(self.focal()),
            centre: self.centre().map(single),
            baseline: single(self.baseline()),
            cameras,
        }
    }
}

/// True when the rows are perpendicular unit vectors within 1 %.
fn is_rotation(rows: &[[f32; 3]; 3]) -> bool {
    let product = |a: &[f32; 3], b: &[f32; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
    rows.iter().zip(0..).all(|(a, i)| {
        rows.iter().zip(0..).all(|(b, j)| {
            let off = product(a, b) - if i == j { 1.0 } else { 0.0 };
            (-0.01..=0.01).contains(&off)
        })
    })
}
