//! Rectification of a calibrated pair: two virtual cameras with the same direction, focal length
//! and centre, corresponding points on one row.
//!
//! In: a [`Calibration`], the size of the rectified images, the part of the view to keep. Out: the
//! raw position of every rectified pixel, in double precision: [`Remap`](crate::Remap) has it in
//! single, [`Mesh`](crate::Mesh) in integers.
//!
//! # Source
//! Fusiello, Trucco, Verri, 2000, and Bouguet's toolbox for the rotations; both centres are the
//! same, so that disparity 0 is infinity.
#![allow(clippy::float_arithmetic, reason = "set-up")]

use crate::calibration::{Calibration, CameraSide};
use crate::camera::{Camera, MAX_TANGENT};
use linestereo::image::{Dims, MAX_HEIGHT, MIN_SIDE};
use linestereo::{Rig, params::RigError};
use nalgebra::{Matrix3, Vector3};

/// Largest side of a rectified image, px, whether or not `linestereo` is built for wide ones.
pub(crate) const MAX_SIDE: u16 = MAX_HEIGHT;
/// Number of stretches of each border of the raw image between sampled points.
const STRETCHES: u16 = 16;
/// Number of times that the stretches around the outermost and innermost points are halved.
const HALVINGS: u16 = 6;
/// Number of directions in which the edge of a lens's view is sampled.
const DIRECTIONS: i16 = 64;
/// Margin inside the outermost raw pixels of a view without pixels that lack a source, px: more
/// than the error of a mesh.
const MARGIN: f64 = 1.0 / 32.0;
/// Number of points sampled along each border of a rectified image where the raw borders do not
/// determine the view.
const CHECKED: u16 = 64;

/// Part of the view that the rectified images keep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// 0: as much as fits without a pixel that has no source; 1: every raw pixel of both cameras is
    /// in view; interpolated between.
    Alpha(f64),
    /// Focal length, px, around the middle of the common view.
    Focal(f64),
}

impl Default for View {
    fn default() -> Self {
        Self::Alpha(0.0)
    }
}

/// Reason why a pair cannot be rectified.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RectifyError {
    /// The rectified size is outside the core's limits.
    #[error("rectified images of {0} are outside {MIN_SIDE}x{MIN_SIDE} to {MAX_SIDE}x{MAX_SIDE}")]
    Dims(Dims),
    /// Alpha is outside 0 ..= 1.
    #[error("alpha is {0} but must be 0 to 1")]
    Alpha(f64),
    /// The two cameras have no common view.
    #[error("the two cameras share no view: are they turned apart?")]
    NoCommonView,
    /// Focal length or baseline are outside the limits of [`Rig`].
    #[error("{0}")]
    Rig(RigError),
    /// A rotation is no rotation (rows not perpendicular unit vectors within 1 %).
    #[error("the {0} rectifying matrix is no rotation")]
    Rotation(CameraSide),
}

/// The common virtual camera, and the mapping to both raw images.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectification {
    cameras: [Camera; 2],
    /// Rotations from common to each camera's coordinates.
    to_camera: [Matrix3<f64>; 2],
    dims: Dims,
    focal: f64,
    centre: [f64; 2],
    baseline: f64,
}

impl Calibration {
    /// Computes the common view for rectified images of this size.
    pub fn rectify(&self, dims: Dims, view: View) -> Result<Rectification, RectifyError> {
        let mut found = Rectification::new(self, dims)?;
        let [left, right] = CameraSide::BOTH.map(|eye| found.bounds(eye));
        let (Some(left), Some(right)) = (left, right) else {
            return Err(RectifyError::NoCommonView);
        };
        let inner = left.inner.common(right.inner).ok_or(RectifyError::NoCommonView)?;
        match view {
            View::Alpha(alpha) if (0.0..=1.0).contains(&alpha) => {
                let mut narrow = inner.fitted(dims, f64::max);
                if !(left.is_closed && right.is_closed) {
                    narrow = found.shrunk(inner, narrow.0).ok_or(RectifyError::NoCommonView)?;
                }
                let wide = left.outer.around(right.outer).fitted(dims, f64::min);
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

    /// A rectification with given rotations, focal length and centre (OpenCV's R1, R2, P1, P2):
    /// each rotation by rows, from the camera's coordinates to common ones.
    pub fn rectify_as(
        &self,
        dims: Dims,
        rotations: [[[f64; 3]; 3]; 2],
        focal: f64,
        centre: [f64; 2],
    ) -> Result<Rectification, RectifyError> {
        let mut found = Rectification::new(self, dims)?;
        for ((rows, to_camera), eye) in
            rotations.into_iter().zip(&mut found.to_camera).zip(CameraSide::BOTH)
        {
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
        check_dims(dims)?;
        Ok(Self {
            cameras: CameraSide::BOTH.map(|eye| *calibration.camera(eye)),
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

    /// Focal length of both rectified images, px.
    #[must_use]
    pub fn focal(&self) -> f64 {
        self.focal
    }

    /// Centre of both rectified images, px.
    #[must_use]
    pub fn centre(&self) -> [f64; 2] {
        self.centre
    }

    /// Distance between the cameras, m.
    #[must_use]
    pub fn baseline(&self) -> f64 {
        self.baseline
    }

    /// The rig that converts disparities to depths, and pixels to positions in space.
    pub fn rig(&self) -> Result<Rig, RigError> {
        self.remap().rig()
    }

    /// The camera behind one of the rectified images.
    #[must_use]
    pub fn camera(&self, eye: CameraSide) -> &Camera {
        eye.of(&self.cameras)
    }

    /// Rotations from left and right camera coordinates to common ones, by rows, as
    /// [`Calibration::rectify_as`] takes them.
    #[must_use]
    pub fn rotations(&self) -> [[[f64; 3]; 3]; 2] {
        // The columns of a rotation are the rows of its inverse.
        self.to_camera.map(Into::into)
    }

    fn turn(&self, eye: CameraSide) -> &Matrix3<f64> {
        eye.of(&self.to_camera)
    }

    /// Raw position of a rectified one, px; may lie outside the raw image. `None` outside of the
    /// camera's view.
    #[must_use]
    pub fn source(&self, eye: CameraSide, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        self.camera(eye).project(self.ray(eye, [x, y]))
    }

    /// Rotation from common to a camera's coordinates, by rows.
    pub(crate) fn rotation(&self, side: CameraSide) -> [[f64; 3]; 3] {
        self.turn(side).transpose().into()
    }

    /// Ray of a rectified position, in the camera's coordinates.
    fn ray(&self, eye: CameraSide, [x, y]: [f64; 2]) -> [f64; 3] {
        let [cx, cy] = self.centre;
        (self.turn(eye) * Vector3::new((x - cx) / self.focal, (y - cy) / self.focal, 1.0)).into()
    }

    /// Rectified position of a raw one, px: the inverse of [`Rectification::source`]. `None` where
    /// it is behind the rectified view.
    #[must_use]
    pub fn rectified(&self, eye: CameraSide, raw: [f64; 2]) -> Option<[f64; 2]> {
        let [x, y] = self.normalised(eye, raw)?;
        let [cx, cy] = self.centre;
        Some([x * self.focal + cx, y * self.focal + cy])
    }

    fn normalised(&self, eye: CameraSide, raw: [f64; 2]) -> Option<[f64; 2]> {
        let [x, y] = self.camera(eye).unproject(raw)?;
        self.common(eye, [x, y, 1.0])
    }

    /// Intersection of a ray in a camera's coordinates with the common normalised plane.
    fn common(&self, eye: CameraSide, ray: [f64; 3]) -> Option<[f64; 2]> {
        let ray = self.turn(eye).tr_mul(&Vector3::from(ray));
        (ray.z > 1e-3).then(|| [ray.x / ray.z, ray.y / ray.z])
    }

    /// View of one camera on the common normalised plane; `None` when it is empty.
    fn bounds(&self, eye: CameraSide) -> Option<Bounds> {
        let camera = self.camera(eye);
        let mut bounds =
            Bounds { inner: Window::EVERYTHING, outer: Window::NOTHING, is_closed: true };
        for border in Border::ALL {
            self.walk(eye, border, &mut bounds);
        }
        if !bounds.is_closed {
            self.extend_to_limit(eye, &mut bounds);
        }
        // The borders were sampled inside of the outermost pixels.
        bounds.outer = bounds.outer.grown(camera.dims());
        (bounds.outer.low[0] < bounds.outer.high[0])
            .then(|| Bounds { inner: bounds.inner.limited(bounds.outer), ..bounds })
    }

    /// Samples points along a border, more densely where it reaches furthest to the inside or
    /// outside, or enters the view.
    fn walk(&self, eye: CameraSide, border: Border, bounds: &mut Bounds) {
        let (mut innermost, mut outermost) = (None, None);
        let mut sample = |share: f64| {
            // A border out of view (a fisheye beyond the limit) does not limit the window.
            let point = self.normalised(eye, border.point(self.camera(eye).dims(), share));
            bounds.is_closed &= point.is_some();
            if let Some(point) = point {
                bounds.outer.extend(point);
                bounds.inner.cut(border, point);
                let depth = border.depth(point);
                if innermost.is_none_or(|(deepest, _)| depth > deepest) {
                    innermost = Some((depth, share));
                }
                if outermost.is_none_or(|(least, _)| depth < least) {
                    outermost = Some((depth, share));
                }
            }
            (point.is_some(), innermost, outermost)
        };
        let mut step = 1.0 / f64::from(STRETCHES);
        let (mut was_seen, mut inner, mut outer) = sample(0.0);
        for i in 1..=STRETCHES {
            let share = f64::from(i) * step;
            let is_seen;
            (is_seen, inner, outer) = sample(share);
            let (mut here, mut there) = (share - step, share);
            for _ in 0..if is_seen == was_seen { 0 } else { 2 * HALVINGS } {
                let middle = (here + there) / 2.0;
                if sample(middle).0 == was_seen {
                    here = middle;
                } else {
                    there = middle;
                }
            }
            was_seen = is_seen;
        }
        for _ in 0..HALVINGS {
            step /= 2.0;
            for middle in [inner, outer].into_iter().flatten().map(|(_, share): (f64, f64)| share) {
                for share in [middle - step, middle + step] {
                    if (0.0..=1.0).contains(&share) {
                        (_, inner, outer) = sample(share);
                    }
                }
            }
        }
    }

    /// Extends the view to the angle up to which the lens can be used, where borders are out of
    /// view.
    fn extend_to_limit(&self, eye: CameraSide, bounds: &mut Bounds) {
        let camera = self.camera(eye);
        let radius = camera.limit() * 0.9999;
        for i in 0..DIRECTIONS {
            // Directions around a square.
            let along = f64::from(i % (DIRECTIONS / 4)) / f64::from(DIRECTIONS / 8) - 1.0;
            let [x, y] = match i / (DIRECTIONS / 4) {
                0 => [along, -1.0],
                1 => [1.0, along],
                2 => [-along, 1.0],
                _ => [-1.0, -along],
            };
            let scale = radius / libm::sqrt(x * x + y * y);
            let ray = [x * scale, y * scale, 1.0];
            if camera.project(ray).is_some_and(|raw| camera.is_inside(raw))
                && let Some(point) = self.common(eye, ray)
            {
                bounds.outer.extend(point);
            }
        }
    }

    /// Least focal length, not below `focal`, at which every pixel of both images has a source
    /// around the middle of the window.
    fn shrunk(&mut self, window: Window, focal: f64) -> Option<(f64, [f64; 2])> {
        let (mut fits, mut low) = (None, focal);
        let mut high = focal;
        for _ in 0..16 {
            let middle = if fits.is_some() { (low + high) / 2.0 } else { high };
            self.focal = middle;
            self.centre = window.centred(self.dims, middle);
            match (self.is_filled(), fits) {
                (true, _) => {
                    (fits, high) = (Some((self.focal, self.centre)), middle);
                    if middle <= focal {
                        break;
                    }
                }
                (false, None) => (low, high) = (middle, middle * 1.5),
                (false, Some(_)) => low = middle,
            }
        }
        fits
    }

    /// True when the border pixels of both rectified images have a source: then all others have.
    fn is_filled(&self) -> bool {
        let [right, bottom] = [self.dims.width - 1, self.dims.height - 1].map(f64::from);
        CameraSide::BOTH.into_iter().all(|eye| {
            let dims = self.camera(eye).dims();
            let inside = |v: f64, side: u16| (MARGIN..=f64::from(side - 1) - MARGIN).contains(&v);
            (0..=CHECKED).all(|i| {
                let share = f64::from(i) / f64::from(CHECKED);
                let (x, y) = (right * share, bottom * share);
                [[0.0, y], [right, y], [x, 0.0], [x, bottom]].into_iter().all(|position| {
                    self.source(eye, position)
                        .is_some_and(|[u, v]| inside(u, dims.width) && inside(v, dims.height))
                })
            })
        })
    }
}

/// Checks the size of rectified images against the core's limits.
pub(crate) fn check_dims(dims: Dims) -> Result<(), RectifyError> {
    if (MIN_SIDE..=MAX_SIDE).contains(&dims.width) && (MIN_SIDE..=MAX_SIDE).contains(&dims.height) {
        Ok(())
    } else {
        Err(RectifyError::Dims(dims))
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

    /// The point of the raw image at a share of this border, just inside.
    fn point(self, dims: Dims, share: f64) -> [f64; 2] {
        let along = |side: u16, share: f64| MARGIN + (f64::from(side - 1) - 2.0 * MARGIN) * share;
        let (w, h) = (dims.width, dims.height);
        match self {
            Self::Left => [along(w, 0.0), along(h, share)],
            Self::Right => [along(w, 1.0), along(h, share)],
            Self::Top => [along(w, share), along(h, 0.0)],
            Self::Bottom => [along(w, share), along(h, 1.0)],
        }
    }

    /// Coordinate of a point of the normalised plane that grows from this border inwards.
    fn depth(self, [x, y]: [f64; 2]) -> f64 {
        match self {
            Self::Left => x,
            Self::Right => -x,
            Self::Top => y,
            Self::Bottom => -y,
        }
    }
}

/// Rectangles of the normalised plane inside of a camera's view, and around it.
#[derive(Clone, Copy)]
struct Bounds {
    inner: Window,
    outer: Window,
    /// True when every border of the raw image is in view.
    is_closed: bool,
}

#[derive(Clone, Copy)]
struct Window {
    low: [f64; 2],
    high: [f64; 2],
}

impl Window {
    const EVERYTHING: Self = Self { low: [f64::MIN; 2], high: [f64::MAX; 2] };
    const NOTHING: Self = Self { low: [f64::MAX; 2], high: [f64::MIN; 2] };

    /// Extends the window to a point, limited to [`MAX_TANGENT`].
    fn extend(&mut self, point: [f64; 2]) {
        let [x, y] = point.map(|v| v.clamp(-MAX_TANGENT, MAX_TANGENT));
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

    /// The window with an eighth of a raw pixel more on each side.
    fn grown(self, raw: Dims) -> Self {
        let more = |i: usize, side: u16| -> f64 {
            let (Some(low), Some(high)) = (self.low.get(i), self.high.get(i)) else { return 0.0 };
            (high - low) / (8.0 * f64::from(side))
        };
        let (x, y) = (more(0, raw.width), more(1, raw.height));
        Self { low: [self.low[0] - x, self.low[1] - y], high: [self.high[0] + x, self.high[1] + y] }
    }

    /// The intersection of both; `None` when it is empty.
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

    /// Focal length, px, and centre of an image that fits the window in one direction: by
    /// `f64::max` it lies inside of the window, by `f64::min` it contains it.
    fn fitted(self, dims: Dims, pick: fn(f64, f64) -> f64) -> (f64, [f64; 2]) {
        let [x, y] = [self.high[0] - self.low[0], self.high[1] - self.low[1]];
        let focal = pick(f64::from(dims.width - 1) / x, f64::from(dims.height - 1) / y);
        (focal, self.centred(dims, focal))
    }

    /// The centre that puts the window's middle into the image's middle.
    fn centred(self, dims: Dims, focal: f64) -> [f64; 2] {
        let middle = [(self.low[0] + self.high[0]) / 2.0, (self.low[1] + self.high[1]) / 2.0];
        let [x, y] = [f64::from(dims.width - 1) / 2.0, f64::from(dims.height - 1) / 2.0];
        [x - middle[0] * focal, y - middle[1] * focal]
    }
}
