//! The rectified rig: disparity to depth (Eqs. 5, 12), pixel and disparity to a position in space,
//! and depth margin to disparity interval (Eq. 13).
//!
//! In: focal length, baseline, offset and principal point, checked once at set-up (the only
//! floating point here). Out: metres and disparity intervals, by 64-bit integer divisions.
//!
//! # Bounds
//! `f*B` is at most 10^6 px*m, in Q16 below 2^37; shifted by 6 for a quotient in Q16 below 2^43:
//! fits `i64`. Columns and rows are less than 2^12 px from the principal point, 2^28 in Q16; times
//! a depth below 2^31 less than 2^59.

use crate::image::Dims;
use crate::result::ImagePosition;
use crate::units::{Depth, Disparity, INFINITE_DEPTH};

/// Focal length, baseline, disparity offset and principal point of a rectified pair:
/// `z = f*B / (d + offset)`.
///
/// ```
/// use linestereo::Rig;
/// use linestereo::units::{Depth, Disparity, INFINITE_DEPTH};
/// let rig = Rig::new(400.0, 0.1, 0.0).unwrap();
/// assert_eq!(rig.depth(Disparity::from_num(20)), Depth::from_num(2)); // 400 * 0.1 / 20
/// assert_eq!(rig.depth(Disparity::ZERO), INFINITE_DEPTH);
///
/// let rig = rig.with_principal_point([160.0, 120.0]).unwrap();
/// let at = linestereo::results::ImagePosition { x: 180_u8.into(), y: 120_u8.into() };
/// // 20 px right of the optical axis, 2 m away: 2 * 20 / 400.
/// let [x, y, z] = rig.xyz(at, Disparity::from_num(20)).unwrap();
/// assert!((x.to_num::<f64>() - 0.1).abs() < 1e-4 && y == 0 && z == 2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rig {
    /// Focal length, px, Q16.
    focal_q16: i64,
    /// Focal length times baseline, px*m, Q16.
    focal_baseline_q16: i64,
    /// Disparity offset, 1/64 px (the step of [`Disparity`]).
    offset_q6: i64,
    /// Principal point of the left image, px in Q16; `None`: the centre of the image.
    principal_point_q16: Option<[i32; 2]>,
}

/// Number of a rig that is not valid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RigError {
    /// Focal length in pixels, outside 1 ..= 100 000 or not finite.
    #[error("focal length {0} px is outside 1 to 100000")]
    Focal(f32),
    /// Baseline in metres, outside 0.0001 ..= 10 or not finite.
    #[error("baseline {0} m is outside 0.0001 to 10: is it in mm?")]
    Baseline(f32),
    /// Disparity offset in pixels, outside -4096 ..= 4096 or not finite.
    #[error("disparity offset {0} px is outside -4096 to 4096")]
    Offset(f32),
    /// Column or row of the principal point in pixels, outside -2048 ..= 2048 or not finite.
    #[error("principal point: {0} px is outside -2048 to 2048")]
    PrincipalPoint(f32),
}

impl Rig {
    /// A rig from its focal length in px, baseline in m and the offset in px that is added to every
    /// disparity (`x_centre_right - x_centre_left`; 0 for most rigs). The principal point is the
    /// centre of the image.
    #[expect(clippy::float_arithmetic, reason = "set-up")]
    pub fn new(focal_px: f32, baseline_m: f32, offset_px: f32) -> Result<Self, RigError> {
        if !(1.0..=100_000.0).contains(&focal_px) {
            return Err(RigError::Focal(focal_px));
        }
        if !(0.0001..=10.0).contains(&baseline_m) {
            return Err(RigError::Baseline(baseline_m));
        }
        if !(-4096.0..=4096.0).contains(&offset_px) {
            return Err(RigError::Offset(offset_px));
        }
        Ok(Self {
            focal_q16: nearest(focal_px * 65536.0),
            focal_baseline_q16: nearest(focal_px * baseline_m * 65536.0),
            offset_q6: nearest(offset_px * 64.0),
            principal_point_q16: None,
        })
    }

    /// The same rig with the principal point of its left image, px.
    #[expect(
        clippy::float_arithmetic,
        clippy::cast_possible_truncation,
        reason = "set-up; the range is checked"
    )]
    pub fn with_principal_point(self, point: [f32; 2]) -> Result<Self, RigError> {
        if let Some(outside) = point.into_iter().find(|v| !(-2048.0..=2048.0).contains(v)) {
            return Err(RigError::PrincipalPoint(outside));
        }
        Ok(Self { principal_point_q16: Some(point.map(|v| nearest(v * 65536.0) as i32)), ..self })
    }

    /// The same rig with its principal point in the centre of images of this size, unless it has
    /// one.
    #[must_use]
    pub fn centred(self, dims: Dims) -> Self {
        let centre = [dims.width, dims.height].map(|side| (i32::from(side) - 1) << 15);
        Self { principal_point_q16: self.principal_point_q16.or(Some(centre)), ..self }
    }

    /// Focal length, px in Q16.
    #[must_use]
    pub fn focal_q16(&self) -> i64 {
        self.focal_q16
    }

    /// Principal point of the left image, px in Q16; `None` stands for the centre of the image.
    #[must_use]
    pub fn principal_point_q16(&self) -> Option<[i32; 2]> {
        self.principal_point_q16
    }

    /// Position in space of the point seen at `at` in the left image with this disparity: x right,
    /// y down, z forward of the left camera, m, rounded to nearest. `None` where the depth is
    /// infinite or the principal point unknown: see [`Rig::centred`].
    #[must_use]
    pub fn xyz(&self, at: ImagePosition, disparity: Disparity) -> Option<[Depth; 3]> {
        let [cx, cy] = self.principal_point_q16?;
        let z = self.depth(disparity);
        let along = |position_q5: u16, centre_q16: i32| {
            let product = ((i64::from(position_q5) << 11) - i64::from(centre_q16))
                .wrapping_mul(z.to_bits().into());
            let metres_q16 =
                product.wrapping_add(self.focal_q16 >> 1).checked_div_euclid(self.focal_q16)?;
            i32::try_from(metres_q16).ok().map(Depth::from_bits)
        };
        (z != INFINITE_DEPTH).then_some([along(at.x.to_bits(), cx)?, along(at.y.to_bits(), cy)?, z])
    }

    /// Focal length times baseline, px*m in Q16.
    #[must_use]
    pub fn focal_baseline_q16(&self) -> i64 {
        self.focal_baseline_q16
    }

    /// Offset that is added to every disparity, 1/64 px.
    #[must_use]
    pub const fn offset_q6(&self) -> i64 {
        self.offset_q6
    }

    /// Depth of a disparity (Eqs. 5, 12), rounded to nearest, saturating at [`INFINITE_DEPTH`]; a
    /// disparity that is zero or less after the offset is infinitely far.
    #[must_use]
    pub fn depth(&self, disparity: Disparity) -> Depth {
        let d_q6 = i64::from(disparity.to_bits()).wrapping_add(self.offset_q6);
        if d_q6 <= 0 {
            return INFINITE_DEPTH;
        }
        let z_q16 = (self.focal_baseline_q16 << 6)
            .wrapping_add(d_q6 >> 1)
            .checked_div(d_q6)
            .unwrap_or(i64::MAX);
        i32::try_from(z_q16).map_or(INFINITE_DEPTH, Depth::from_bits)
    }

    /// Standard deviation of depth in metres for one of disparity: `|dz/dd| * sigma = z^2 / (f*B) *
    /// sigma`.
    #[must_use]
    pub fn depth_sigma(&self, disparity: Disparity, sigma: Disparity) -> Depth {
        let d_q6 = i64::from(disparity.to_bits()).wrapping_add(self.offset_q6);
        let z = self.depth(disparity);
        if d_q6 <= 0 || z == INFINITE_DEPTH {
            return INFINITE_DEPTH;
        }
        // z * sigma / (d + offset): the same quantity without squaring z.
        let sigma_z = i64::from(z.to_bits())
            .wrapping_mul(i64::from(sigma.to_bits()))
            .checked_div(d_q6)
            .unwrap_or(i64::MAX);
        i32::try_from(sigma_z).map_or(INFINITE_DEPTH, Depth::from_bits)
    }

    /// The disparity interval of a depth margin around the depth of `disparity` (Eq. 13): `nearer`
    /// metres in front and `farther` metres behind, as `[f*B/(z+farther), f*B/(z-nearer)] -
    /// offset`. It is open upwards (`Disparity::MAX`) when `z <= nearer`, and starts at `-offset`
    /// when z is infinite.
    #[must_use]
    pub fn disparity_interval(
        &self,
        disparity: Disparity,
        nearer: Depth,
        farther: Depth,
    ) -> (Disparity, Disparity) {
        let z = self.depth(disparity);
        let at = |z_q16: i64| {
            let d_q6 = (self.focal_baseline_q16 << 6)
                .wrapping_add(z_q16 >> 1)
                .checked_div(z_q16)
                .unwrap_or(i64::MAX);
            saturate(d_q6.saturating_sub(self.offset_q6))
        };
        let low = if z == INFINITE_DEPTH {
            saturate(self.offset_q6.wrapping_neg())
        } else {
            at(i64::from(z.to_bits()).wrapping_add(i64::from(farther.to_bits())))
        };
        let near_q16 = i64::from(z.to_bits()).wrapping_sub(i64::from(nearer.to_bits()));
        let high = if near_q16 <= 0 { Disparity::MAX } else { at(near_q16) };
        (low, high)
    }
}

/// Rounded to nearest, halves away from zero.
#[inline(never)] // 100 bytes at each of 19 places that run once a rig
#[expect(
    clippy::float_arithmetic,
    clippy::cast_possible_truncation,
    reason = "set-up; callers check the range"
)]
pub(crate) fn nearest(v: f32) -> i64 {
    let whole = v as i64;
    let rest = v - whole as f32; // exact, unlike v + 0.5 above 2^23
    whole + i64::from(rest >= 0.5) - i64::from(rest <= -0.5)
}

fn saturate(d_q6: i64) -> Disparity {
    let clamped = d_q6.clamp(i64::from(i16::MIN), i64::from(i16::MAX));
    Disparity::from_bits(i16::try_from(clamped).unwrap_or(i16::MAX))
}
