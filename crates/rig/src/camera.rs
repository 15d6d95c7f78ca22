//! Camera model: projection of rays to raw pixels, and its inverse.
//!
//! In: focal lengths, centre, skew and lens, checked once. Out: raw positions of rays. Set-up only:
//! floating point.
//!
//! ```text
//! (x, y) = (X/Z, Y/Z)                              normalised plane
//! (x', y') = lens(x, y)                            Brown-Conrady, rational or equidistant fisheye
//! u = fx x' + skew y' + cx,   v = fy y' + cy       pixels; whole numbers are pixel centres
//! ```
//!
//! # Source
//! Brown, "Close-range camera calibration", 1971, and Conrady, 1919, in the form and with the names
//! of OpenCV (k1 k2 p1 p2 k3); Claus and Fitzgibbon, 2005, in the form of OpenCV's
//! `CALIB_RATIONAL_MODEL` (k4 k5 k6 too); Kannala and Brandt, 2006, in the form of OpenCV's and
//! Kalibr's equidistant fisheye model (k1 .. k4).
#![allow(clippy::float_arithmetic, reason = "set-up")]

use crate::real::Real;
use linestereo::image::Dims;

/// Tangent of the largest angle of rays off the axis, 76 degrees; a flat rectified image cannot
/// show more.
pub const MAX_TANGENT: f64 = 4.0;

/// Largest lens coefficient: those of the rational model reach some hundreds.
const MOST_COEFFICIENT: f32 = 10_000.0;

/// Number of steps in which a lens is tested for folding.
const STEPS: u32 = 512;

/// Distortion of a lens on the normalised plane, in double precision or, behind a
/// [`Remap`](crate::Remap), in single.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens<T = f64> {
    /// Radial (barrel, pincushion, and both at once: mustache) and tangential.
    BrownConrady {
        /// Radial: `1 + k1 r^2 + k2 r^4 + k3 r^6`.
        k: [T; 3],
        /// Tangential: `2 p1 x y + p2 (r^2 + 2 x^2)`, `p1 (r^2 + 2 y^2) + 2 p2 x y`.
        p: [T; 2],
    },
    /// Rational: radial `(1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)`, and
    /// tangential.
    Rational {
        /// Radial: k1 k2 k3 above, k4 k5 k6 below the line.
        k: [T; 6],
        /// Tangential, as of Brown-Conrady.
        p: [T; 2],
    },
    /// Equidistant: `theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)` in place of
    /// `tan(theta)`.
    Fisheye {
        /// Coefficients of the polynomial in the angle.
        k: [T; 4],
    },
}

impl Lens {
    /// No distortion.
    pub const NONE: Self = Self::BrownConrady { k: [0.0; 3], p: [0.0; 2] };

    /// Distorted position of a point of the normalised plane. The polynomial may fold far outside
    /// of the image: [`Camera::project`] excludes that.
    #[must_use]
    pub fn distort(&self, point: [f64; 2]) -> [f64; 2] {
        self.distorted(point)
    }

    /// Derivative of the distorted by the undistorted radius.
    fn radial_slope(&self, r: f64) -> f64 {
        match *self {
            Self::BrownConrady { k: [k1, k2, k3], .. } => {
                let s = r * r;
                1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3))
            }
            Self::Rational { k: [k1, k2, k3, k4, k5, k6], .. } => {
                let s = r * r;
                let slope = 1.0 + s * (3.0 * k1 + s * (5.0 * k2 + s * 7.0 * k3));
                let (above, below) = (cubic(s, [k1, k2, k3]), cubic(s, [k4, k5, k6]));
                (slope - 2.0 * s * (k4 + s * (2.0 * k5 + s * 3.0 * k6)) * above / below) / below
            }
            Self::Fisheye { k: [k1, k2, k3, k4] } => {
                let theta = libm::atan(r);
                let t = theta * theta;
                (1.0 + t * (3.0 * k1 + t * (5.0 * k2 + t * (7.0 * k3 + t * 9.0 * k4))))
                    / (1.0 + r * r)
            }
        }
    }

    /// Undistorted radius up to which the distorted one grows, in steps of 1/128.
    fn limit(&self) -> f64 {
        let step = MAX_TANGENT / f64::from(STEPS);
        let mut last = 0.0;
        for i in 1..=STEPS {
            let r = f64::from(i) * step;
            let distorted = r * self.radial(r * r);
            if distorted <= last || distorted.is_nan() {
                return f64::from(i - 1) * step;
            }
            last = distorted;
        }
        MAX_TANGENT
    }

    /// The same in single precision.
    #[must_use]
    #[allow(clippy::cast_possible_truncation, reason = "the range is checked")]
    pub(crate) fn to_single(self) -> Lens<f32> {
        self.map(|v| v as f32)
    }
}

impl<T: Real> Lens<T> {
    /// Radial ones, then tangential ones; zeros fill up.
    pub(crate) fn coefficients(&self) -> [T; 8] {
        let zero = T::from(0.0);
        match *self {
            Self::BrownConrady { k: [k1, k2, k3], p: [p1, p2] } => {
                [k1, k2, k3, p1, p2, zero, zero, zero]
            }
            Self::Rational { k: [k1, k2, k3, k4, k5, k6], p: [p1, p2] } => {
                [k1, k2, k3, p1, p2, k4, k5, k6]
            }
            Self::Fisheye { k: [k1, k2, k3, k4] } => [k1, k2, k3, k4, zero, zero, zero, zero],
        }
    }

    fn map<U>(self, each: impl Fn(T) -> U) -> Lens<U> {
        match self {
            Self::BrownConrady { k, p } => Lens::BrownConrady { k: k.map(&each), p: p.map(&each) },
            Self::Rational { k, p } => Lens::Rational { k: k.map(&each), p: p.map(&each) },
            Self::Fisheye { k } => Lens::Fisheye { k: k.map(&each) },
        }
    }

    /// Distorted position of a point of the normalised plane.
    pub(crate) fn distorted(&self, [x, y]: [T; 2]) -> [T; 2] {
        let factor = self.radial(x * x + y * y);
        let [dx, dy] = self.tangential([x, y]);
        [x * factor + dx, y * factor + dy]
    }

    /// Ratio of the distorted to the undistorted radius, from the square of the latter.
    fn radial(&self, s: T) -> T {
        let one = T::from(1.0);
        match *self {
            Self::BrownConrady { k, .. } => cubic(s, k),
            Self::Rational { k: [k1, k2, k3, k4, k5, k6], .. } => {
                cubic(s, [k1, k2, k3]) / cubic(s, [k4, k5, k6])
            }
            Self::Fisheye { k: [k1, k2, k3, k4] } => {
                let r = s.sqrt();
                let theta = r.atan();
                let t = theta * theta;
                let ratio = if r > T::from(1e-9) { theta / r } else { one };
                ratio * (one + t * (k1 + t * (k2 + t * (k3 + t * k4))))
            }
        }
    }

    fn tangential(&self, [x, y]: [T; 2]) -> [T; 2] {
        match *self {
            Self::BrownConrady { p: [p1, p2], .. } | Self::Rational { p: [p1, p2], .. } => {
                let two = T::from(2.0);
                let s = x * x + y * y;
                [
                    two * p1 * x * y + p2 * (s + two * x * x),
                    p1 * (s + two * y * y) + two * p2 * x * y,
                ]
            }
            Self::Fisheye { .. } => [T::from(0.0); 2],
        }
    }
}

/// `1 + a s + b s^2 + c s^3`.
fn cubic<T: Real>(s: T, [a, b, c]: [T; 3]) -> T {
    T::from(1.0) + s * (a + s * (b + s * c))
}

/// Number of a camera that is not usable.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// A side of the raw image is outside 16 ..= 4096 px.
    #[error("a raw image of {0} is outside 16x16 to 4096x4096")]
    Dims(Dims),
    /// A focal length is outside 1 ..= 100 000 px or not finite.
    #[error("focal length {0} px is outside 1 to 100000")]
    Focal(f64),
    /// The centre is further than one image size outside the image, or not finite.
    #[error("the optical centre ({x}, {y}) px lies far outside the image", x = .0[0], y = .0[1])]
    Centre([f64; 2]),
    /// The skew is outside -1000 ..= 1000 px or not finite.
    #[error("skew {0} px is outside -1000 to 1000")]
    Skew(f64),
    /// A lens coefficient is outside -10 000 ..= 10 000 or not finite.
    #[error("lens coefficient {0} is outside -10000 to 10000")]
    Lens(f64),
    /// The lens folds the image over at this tangent of the viewing angle, inside the image.
    #[error("the lens coefficients fold the image over at a tangent of {0:.2}, inside the image")]
    Folds(f64),
}

/// Checks the size of raw images, px.
///
/// # Errors
/// [`CameraError::Dims`].
pub fn check_raw_dims(dims: Dims) -> Result<(), CameraError> {
    let is_raw = [dims.width, dims.height].iter().all(|side| (16..=4096).contains(side));
    if is_raw { Ok(()) } else { Err(CameraError::Dims(dims)) }
}

/// Checks the size of raw images, px, and what a camera's numbers can be.
pub(crate) fn check_numbers<T: Real>(
    dims: Dims,
    focal: [T; 2],
    centre: [T; 2],
    skew: T,
    lens: &Lens<T>,
) -> Result<(), CameraError> {
    let within = |v: &T, low: f32, high: f32| T::from(low) <= *v && *v <= T::from(high);
    check_raw_dims(dims)?;
    if let Some(&wrong) = focal.iter().find(|f| !within(f, 1.0, 100_000.0)) {
        return Err(CameraError::Focal(wrong.into()));
    }
    let inside = |c: &T, side: u16| within(c, -f32::from(side), 2.0 * f32::from(side));
    let [cx, cy] = &centre;
    if !inside(cx, dims.width) || !inside(cy, dims.height) {
        return Err(CameraError::Centre(centre.map(T::into)));
    }
    if !within(&skew, -1000.0, 1000.0) {
        return Err(CameraError::Skew(skew.into()));
    }
    match lens.coefficients().into_iter().find(|k| !within(k, -MOST_COEFFICIENT, MOST_COEFFICIENT))
    {
        Some(wrong) => Err(CameraError::Lens(wrong.into())),
        None => Ok(()),
    }
}

/// A calibrated camera.
///
/// ```
/// use linestereo::Dims;
/// use linestereo_rig::{Camera, Lens};
/// let dims = Dims { width: 640, height: 480 };
/// let lens = Lens::BrownConrady { k: [-0.3, 0.1, 0.0], p: [0.0; 2] };
/// let camera = Camera::new(dims, [500.0, 500.0], [319.5, 239.5], 0.0, lens)?;
/// assert_eq!(camera.project([0.0, 0.0, 2.0]), Some([319.5, 239.5]));
/// let [x, y] = camera.unproject([100.0, 50.0]).unwrap();
/// let [u, v] = camera.project([x, y, 1.0]).unwrap();
/// assert!((u - 100.0).abs() < 1e-6 && (v - 50.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    dims: Dims,
    focal: [f64; 2],
    centre: [f64; 2],
    skew: f64,
    lens: Lens,
    /// Largest tangent of the viewing angle at which the lens does not fold.
    limit: f64,
}

impl Camera {
    /// A camera from the size of its raw images, focal lengths `[fx, fy]`, centre `[cx, cy]` and
    /// skew in px, and its lens.
    pub fn new(
        dims: Dims,
        focal: [f64; 2],
        centre: [f64; 2],
        skew: f64,
        lens: Lens,
    ) -> Result<Self, CameraError> {
        check_numbers(dims, focal, centre, skew, &lens)?;
        let [cx, cy] = centre;
        let camera = Self { dims, focal, centre, skew, lens, limit: lens.limit() };
        // The middle of each border must be in view: a lens that folds before that does not belong
        // to this image.
        let (right, bottom) = (f64::from(dims.width - 1), f64::from(dims.height - 1));
        for border in [[0.0, cy], [right, cy], [cx, 0.0], [cx, bottom]] {
            if camera.is_inside(border)
                && camera.unproject(border).is_none()
                && camera.limit < MAX_TANGENT
            {
                return Err(CameraError::Folds(camera.limit));
            }
        }
        Ok(camera)
    }

    /// Size of the raw images.
    #[must_use]
    pub fn dims(&self) -> Dims {
        self.dims
    }

    /// Focal lengths `[fx, fy]`, px.
    #[must_use]
    pub fn focal(&self) -> [f64; 2] {
        self.focal
    }

    /// Optical centre `[cx, cy]`, px.
    #[must_use]
    pub fn centre(&self) -> [f64; 2] {
        self.centre
    }

    /// Skew, px.
    #[must_use]
    pub fn skew(&self) -> f64 {
        self.skew
    }

    /// The lens.
    #[must_use]
    pub fn lens(&self) -> Lens {
        self.lens
    }

    /// True when this position, px, lies between the centres of the outermost raw pixels, where the
    /// image can be interpolated.
    #[must_use]
    pub fn is_inside(&self, [u, v]: [f64; 2]) -> bool {
        (0.0..=f64::from(self.dims.width - 1)).contains(&u)
            && (0.0..=f64::from(self.dims.height - 1)).contains(&v)
    }

    /// Raw position, px, of a ray in this camera's coordinates (x right, y down, z forward); may
    /// lie outside the image. `None` behind the camera, beyond [`MAX_TANGENT`], and where the lens
    /// folds.
    #[must_use]
    pub fn project(&self, [x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
        if z <= 0.0 {
            return None;
        }
        let (x, y) = (x / z, y / z);
        (libm::sqrt(x * x + y * y) <= self.limit).then(|| self.pixel(self.lens.distort([x, y])))
    }

    /// Tangent of the largest viewing angle that is used: [`MAX_TANGENT`], or that at which the
    /// lens starts to fold.
    pub(crate) fn limit(&self) -> f64 {
        self.limit
    }

    fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([fx, fy], [cx, cy]) = (self.focal, self.centre);
        [fx * x + self.skew * y + cx, fy * y + cy]
    }

    /// Point of the normalised plane (z = 1) that is projected to a raw position, px, to 1e-9;
    /// `None` where there is none.
    ///
    /// # Cost
    /// A few hundred floating-point operations: the radius by Newton's method, the tangential part
    /// by iteration.
    #[must_use]
    pub fn unproject(&self, [u, v]: [f64; 2]) -> Option<[f64; 2]> {
        let ([fx, fy], [cx, cy]) = (self.focal, self.centre);
        let y = (v - cy) / fy;
        let x = (u - cx - self.skew * y) / fx;
        let mut point = [x, y];
        for _ in 0..20 {
            let [tx, ty] = self.lens.tangential(point);
            let (rx, ry) = (x - tx, y - ty);
            let distorted = libm::sqrt(rx * rx + ry * ry);
            let radius = self.radius(distorted)?;
            let scale = if distorted > 1e-12 { radius / distorted } else { 1.0 };
            let next = [rx * scale, ry * scale];
            let moved = (next[0] - point[0]).abs().max((next[1] - point[1]).abs());
            point = next;
            if moved < 1e-12 {
                break;
            }
        }
        let [u2, v2] = self.pixel(self.lens.distort(point));
        ((u2 - u).abs() < 1e-6 && (v2 - v).abs() < 1e-6).then_some(point)
    }

    /// Undistorted radius of a distorted one, without the tangential part: Newton's steps, halving
    /// where they leave the bracket.
    fn radius(&self, distorted: f64) -> Option<f64> {
        let (mut low, mut high) = (0.0, self.limit);
        if high * self.lens.radial(high * high) < distorted {
            return None;
        }
        let mut radius = distorted.min(high);
        for _ in 0..60 {
            let excess = radius * self.lens.radial(radius * radius) - distorted;
            if excess < 0.0 {
                low = radius;
            } else {
                high = radius;
            }
            let newton = radius - excess / self.lens.radial_slope(radius);
            let next = if newton > low && newton < high { newton } else { (low + high) / 2.0 };
            let moved = (next - radius).abs();
            radius = next;
            if moved < 1e-13 {
                break;
            }
        }
        Some(radius)
    }
}
