//! A calibrated pair -> two virtual cameras that look alike: same direction, focal length and centre, points on the same row.
//!
//! In: a [`Calibration`], the size of the rectified images, how much of the view to keep. Out: for every rectified pixel its place in the
//! raw image, in floating point. [`Mesh`](super::Mesh) makes it integer.
//!
//! # Source
//! Fusiello, Trucco, Verri, 2000, and Bouguet's toolbox for the rotations; both centres are the same, so that disparity 0 is infinity.
#![allow(clippy::float_arithmetic, reason = "set-up")]

use super::calibration::{Calibration, Eye};
use super::camera::Camera;
use crate::image::{Dims, MAX_HEIGHT, MAX_WIDTH, MIN_SIDE};
use crate::rig::{Rig, RigError};
use core::fmt;
use nalgebra::{Matrix3, Vector3};

/// Points looked at along each border of the raw image.
const BORDER: u16 = 33;

/// How much of the view the rectified images keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// 0: as much as fits without a pixel that has no source; 1: every raw pixel of both cameras is seen; between them: between.
    Alpha(f64),
    /// This focal length in px, around the middle of the common view.
    Focal(f64),
}

impl Default for View {
    fn default() -> Self {
        Self::Alpha(0.0)
    }
}

/// Why a pair cannot be rectified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RectifyError {
    /// The rectified size is outside the core's limits.
    Dims(Dims),
    /// Alpha is outside 0 ..= 1.
    Alpha(f64),
    /// The two cameras share no view.
    NoCommonView,
    /// Focal length or baseline are outside the limits of [`Rig`].
    Rig(RigError),
    /// A rotation is no rotation (rows not perpendicular unit vectors within 1 %).
    Rotation(Eye),
}

impl fmt::Display for RectifyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Dims(dims) => {
                write!(f, "rectified images of {dims} are outside {MIN_SIDE}x{MIN_SIDE} to {MAX_WIDTH}x{MAX_HEIGHT}")
            }
            Self::Alpha(v) => write!(f, "alpha is {v}, allowed are 0 to 1"),
            Self::NoCommonView => write!(f, "the two cameras share no view: are they turned apart?"),
            Self::Rig(error) => error.fmt(f),
            Self::Rotation(Eye::Left) => write!(f, "the left rectifying matrix is no rotation"),
            Self::Rotation(Eye::Right) => write!(f, "the right rectifying matrix is no rotation"),
        }
    }
}

impl core::error::Error for RectifyError {}

/// The common virtual camera and the way back to both raw images.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectification {
    cameras: [Camera; 2],
    /// From common to each camera's coordinates.
    to_camera: [Matrix3<f64>; 2],
    dims: Dims,
    focal: f64,
    centre: [f64; 2],
    baseline: f64,
}

impl Calibration {
    /// Chooses the common view for rectified images of this size.
    pub fn rectify(&self, dims: Dims, view: View) -> Result<Rectification, RectifyError> {
        let mut found = Rectification::new(self, dims)?;
        let whole = |bound: &Bounds| bound.outer;
        let filled = |bound: &Bounds| bound.inner;
        let [left, right] = Eye::BOTH.map(|eye| found.bounds(eye));
        let (Some(left), Some(right)) = (left, right) else { return Err(RectifyError::NoCommonView) };
        let inner = filled(&left).common(filled(&right)).ok_or(RectifyError::NoCommonView)?;
        match view {
            View::Alpha(alpha) if (0.0..=1.0).contains(&alpha) => {
                let (narrow, wide) = (inner.filling(dims), whole(&left).around(whole(&right)).holding(dims));
                let mix = |a: f64, b: f64| a + (b - a) * alpha;
                found.focal = mix(narrow.0, wide.0);
                found.centre = [mix(narrow.1[0], wide.1[0]), mix(narrow.1[1], wide.1[1])];
            }
            View::Alpha(alpha) => return Err(RectifyError::Alpha(alpha)),
            View::Focal(focal) => {
                found.focal = focal;
                found.centre = inner.centred(dims, focal);
            }
        }
        found.rig().map_err(RectifyError::Rig)?;
        Ok(found)
    }

    /// With rotations, focal length and centre chosen elsewhere (OpenCV's R1, R2, P1, P2): each rotation by rows, from the camera's
    /// coordinates to common ones.
    pub fn rectify_as(
        &self,
        dims: Dims,
        rotations: [[[f64; 3]; 3]; 2],
        focal: f64,
        centre: [f64; 2],
    ) -> Result<Rectification, RectifyError> {
        let mut found = Rectification::new(self, dims)?;
        for ((rows, to_camera), eye) in rotations.into_iter().zip(&mut found.to_camera).zip(Eye::BOTH) {
            // nalgebra reads columns: the rows of a rotation are the columns of its inverse.
            *to_camera = Matrix3::from(rows);
            let off = (to_camera.tr_mul(&*to_camera) - Matrix3::identity()).abs().max();
            if off.is_nan() || off > 0.01 {
                return Err(RectifyError::Rotation(eye));
            }
        }
        (found.focal, found.centre) = (focal, centre);
        found.rig().map_err(RectifyError::Rig)?;
        Ok(found)
    }
}

impl Rectification {
    fn new(calibration: &Calibration, dims: Dims) -> Result<Self, RectifyError> {
        if !(MIN_SIDE..=MAX_WIDTH).contains(&dims.width) || !(MIN_SIDE..=MAX_HEIGHT).contains(&dims.height) {
            return Err(RectifyError::Dims(dims));
        }
        Ok(Self {
            cameras: Eye::BOTH.map(|eye| *calibration.camera(eye)),
            to_camera: calibration.common_rotations().map(Matrix3::from),
            dims,
            focal: 1.0,
            centre: [0.0; 2],
            baseline: calibration.baseline(),
        })
    }

    /// Size of the rectified images.
    #[must_use]
    pub fn dims(&self) -> Dims {
        self.dims
    }

    /// Focal length of both rectified images in px.
    #[must_use]
    pub fn focal(&self) -> f64 {
        self.focal
    }

    /// Centre of both rectified images in px.
    #[must_use]
    pub fn centre(&self) -> [f64; 2] {
        self.centre
    }

    /// Distance between the cameras in metres.
    #[must_use]
    pub fn baseline(&self) -> f64 {
        self.baseline
    }

    /// What turns disparities into depths.
    pub fn rig(&self) -> Result<Rig, RigError> {
        Rig::new(self.focal, self.baseline, 0.0)
    }

    /// The camera behind one of the rectified images.
    #[must_use]
    pub fn camera(&self, eye: Eye) -> &Camera {
        let [left, right] = &self.cameras;
        match eye {
            Eye::Left => left,
            Eye::Right => right,
        }
    }

    /// Rotations from left and right camera coordinates to common ones, by rows, as [`Calibration::rectify_as`] takes them.
    #[must_use]
    pub fn rotations(&self) -> [[[f64; 3]; 3]; 2] {
        // The columns of a rotation are the rows of its inverse.
        self.to_camera.map(Into::into)
    }

    fn turn(&self, eye: Eye) -> &Matrix3<f64> {
        let [left, right] = &self.to_camera;
        match eye {
            Eye::Left => left,
            Eye::Right => right,
        }
    }

    /// Raw position of a rectified one, px; may lie outside the raw image. `None` where the camera cannot see.
    #[must_use]
    pub fn source(&self, eye: Eye, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let [cx, cy] = self.centre;
        let ray = Vector3::new((x - cx) / self.focal, (y - cy) / self.focal, 1.0);
        self.camera(eye).project((self.turn(eye) * ray).into())
    }

    /// Rectified position of a raw one, px: the inverse of [`Rectification::source`]. `None` where it is behind the rectified view.
    #[must_use]
    pub fn rectified(&self, eye: Eye, raw: [f64; 2]) -> Option<[f64; 2]> {
        let [x, y] = self.normalised(eye, raw)?;
        let [cx, cy] = self.centre;
        Some([x * self.focal + cx, y * self.focal + cy])
    }

    fn normalised(&self, eye: Eye, raw: [f64; 2]) -> Option<[f64; 2]> {
        let [x, y] = self.camera(eye).unproject(raw)?;
        let ray = self.turn(eye).tr_mul(&Vector3::new(x, y, 1.0));
        (ray.z > 1e-3).then(|| [ray.x / ray.z, ray.y / ray.z])
    }

    /// What one camera sees of the common normalised plane; `None` when it sees nothing of it.
    fn bounds(&self, eye: Eye) -> Option<Bounds> {
        let dims = self.camera(eye).dims();
        let (right, bottom) = (f64::from(dims.width - 1), f64::from(dims.height - 1));
        let mut bounds = Bounds { inner: Window::EVERYTHING, outer: Window::NOTHING };
        for i in 0..BORDER {
            let share = f64::from(i) / f64::from(BORDER - 1);
            let (u, v) = (right * share, bottom * share);
            let borders = [[0.0, v], [right, v], [u, 0.0], [u, bottom]];
            for (raw, border) in borders.into_iter().zip(Border::ALL) {
                // A border that is not seen (a fisheye beyond the limit) cuts nothing off.
                let Some([x, y]) = self.normalised(eye, raw) else { continue };
                bounds.outer.extend([x, y]);
                bounds.inner.cut(border, [x, y]);
            }
        }
        (bounds.outer.low[0] < bounds.outer.high[0])
            .then(|| Bounds { inner: bounds.inner.limited(bounds.outer), ..bounds })
    }
}

#[derive(Clone, Copy)]
enum Border {
    Left,
    Right,
    Top,
    Bottom,
}

impl Border {
    const ALL: [Self; 4] = [Self::Left, Self::Right, Self::Top, Self::Bottom];
}

/// Rectangles of the normalised plane that hold only, and all, of what a camera sees.
#[derive(Clone, Copy)]
struct Bounds {
    inner: Window,
    outer: Window,
}

#[derive(Clone, Copy)]
struct Window {
    low: [f64; 2],
    high: [f64; 2],
}

impl Window {
    const EVERYTHING: Self = Self { low: [f64::MIN; 2], high: [f64::MAX; 2] };
    const NOTHING: Self = Self { low: [f64::MAX; 2], high: [f64::MIN; 2] };

    fn extend(&mut self, [x, y]: [f64; 2]) {
        self.low = [self.low[0].min(x), self.low[1].min(y)];
        self.high = [self.high[0].max(x), self.high[1].max(y)];
    }

    fn cut(&mut self, border: Border, [x, y]: [f64; 2]) {
        match border {
            Border::Left => self.low[0] = self.low[0].max(x),
            Border::Right => self.high[0] = self.high[0].min(x),
            Border::Top => self.low[1] = self.low[1].max(y),
            Border::Bottom => self.high[1] = self.high[1].min(y),
        }
    }

    fn limited(self, other: Self) -> Self {
        Self {
            low: [self.low[0].max(other.low[0]), self.low[1].max(other.low[1])],
            high: [self.high[0].min(other.high[0]), self.high[1].min(other.high[1])],
        }
    }

    /// What both hold, if that is anything.
    fn common(self, other: Self) -> Option<Self> {
        let both = self.limited(other);
        (both.high[0] - both.low[0] > 1e-3 && both.high[1] - both.low[1] > 1e-3).then_some(both)
    }

    fn around(self, other: Self) -> Self {
        let mut both = self;
        both.extend(other.low);
        both.extend(other.high);
        both
    }

    /// Least focal length at which the image lies inside, and its centre.
    fn filling(self, dims: Dims) -> (f64, [f64; 2]) {
        let [fx, fy] = self.focals(dims);
        let focal = fx.max(fy);
        (focal, self.centred(dims, focal))
    }

    /// Largest focal length at which the image shows all of it, and its centre.
    fn holding(self, dims: Dims) -> (f64, [f64; 2]) {
        let [fx, fy] = self.focals(dims);
        let focal = fx.min(fy);
        (focal, self.centred(dims, focal))
    }

    fn focals(self, dims: Dims) -> [f64; 2] {
        let [x, y] = [self.high[0] - self.low[0], self.high[1] - self.low[1]];
        [f64::from(dims.width - 1) / x, f64::from(dims.height - 1) / y]
    }

    /// The centre that puts the window's middle into the image's middle.
    fn centred(self, dims: Dims, focal: f64) -> [f64; 2] {
        let middle = [(self.low[0] + self.high[0]) / 2.0, (self.low[1] + self.high[1]) / 2.0];
        let [x, y] = [f64::from(dims.width - 1) / 2.0, f64::from(dims.height - 1) / 2.0];
        [x - middle[0] * focal, y - middle[1] * focal]
    }
}
