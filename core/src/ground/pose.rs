//! The ground plane of cameras whose height and attitude are known: by an IMU, or as they are
//! mounted.
//!
//! ```text
//! n = (sin r cos p, cos r cos p, sin p)     the ground's normal, down, in the camera's axes
//! d = f B / Z = B / h (n_x (x - cx) + n_y (y - cy) + n_z f)
//! ```
//!
//! The pose of a plane is the inverse: `d`'s gradient gives `B / h n`, its length the height.
//!
//! # Cost
//! Floating point, two sines and two cosines, or two arctangents and two roots: once a set-up, or
//! once a pair with an IMU.
//!
//! # Source
//! Arctangent: Abramowitz, Stegun 1964, 4.4.47, within 0.001 degrees.

use super::GroundPlane;
use crate::image::Dims;
use crate::rig::{Rig, nearest};
use core::f32::consts::PI;
use micromath::F32;

/// Height and attitude of the left camera above a level ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraPose {
    /// Height above the ground, m; 0.01 ..= 100.
    pub height_m: f32,
    /// How far the optical axis points down, degrees; -80 ..= 80.
    pub pitch_deg: f32,
    /// How far the camera is rolled, clockwise as it looks, degrees; -80 ..= 80.
    pub roll_deg: f32,
}

/// Reason why a pose gives no ground plane: a number out of its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[error("{name} of the camera is {value} but must be {low} to {high}")]
pub struct PoseError {
    /// Which number.
    pub name: &'static str,
    /// Its value.
    pub value: f32,
    /// Least allowed value.
    pub low: f32,
    /// Largest allowed value.
    pub high: f32,
}

impl GroundPlane {
    /// The plane that a camera of this pose sees in images of this size.
    ///
    /// ```
    /// use linestereo::{Dims, Rig};
    /// use linestereo::ground::{CameraPose, GroundPlane};
    /// let rig = Rig::new(200.0, 0.06, 0.0)?;
    /// let pose = CameraPose { height_m: 0.15, pitch_deg: 0.0, roll_deg: 0.0 };
    /// let plane = GroundPlane::of_pose(pose, &rig, Dims { width: 320, height: 240 })?;
    /// // Baseline / height px per row: 40 px at 100 rows below the horizon.
    /// assert!((plane.at_q6(160, 219) - 64 * 40).abs() < 64);
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`PoseError`] for a number out of its range.
    #[expect(
        clippy::float_arithmetic,
        clippy::cast_possible_truncation,
        reason = "set-up; ranges are checked before"
    )]
    pub fn of_pose(pose: CameraPose, rig: &Rig, dims: Dims) -> Result<Self, PoseError> {
        let CameraPose { height_m, pitch_deg, roll_deg } = pose;
        check("height (m)", height_m, 0.01, 100.0)?;
        check("pitch (degrees)", pitch_deg, -80.0, 80.0)?;
        check("roll (degrees)", roll_deg, -80.0, 80.0)?;
        let rig = rig.centred(dims);
        let [column, row] =
            rig.principal_point_q16().unwrap_or_default().map(|value| value as f32 / 65536.0);
        let focal = rig.focal_q16() as f32 / 65536.0;
        let per_row = rig.focal_baseline_q16() as f32 / 65536.0 / focal / height_m;
        // Steeper planes do not fit the numbers of an image.
        check("baseline / height", per_row, 0.0, 4.0)?;
        let [pitch, roll] = [pitch_deg, roll_deg].map(|angle| F32(angle / 180.0 * PI));
        let [sin_pitch, cos_pitch, sin_roll, cos_roll] =
            [pitch.sin(), pitch.cos(), roll.sin(), roll.cos()].map(|v| v.0);
        let (across, down) = (per_row * sin_roll * cos_pitch, per_row * cos_roll * cos_pitch);
        let on_axis = per_row * sin_pitch * focal - rig.offset_q6() as f32 / 64.0;
        let most = i64::from(super::LARGEST_Q16);
        let q16 = |value: f32| nearest(65536.0 * value).clamp(-most, most) as i32;
        Ok(Self {
            down_q16: q16(down),
            across_q16: q16(across),
            origin_q16: q16(on_axis - down * row - across * column),
        })
    }
}

#[expect(clippy::float_arithmetic, reason = "when it is asked for, once a pair")]
impl CameraPose {
    /// The pose of a camera that sees this plane in images of this size: the inverse of
    /// [`GroundPlane::of_pose`]. `None` of a plane without slope, which is at no finite height.
    #[must_use]
    pub fn of_plane(plane: GroundPlane, rig: &Rig, dims: Dims) -> Option<Self> {
        let rig = rig.centred(dims);
        let [column, row] =
            rig.principal_point_q16().unwrap_or_default().map(|value| value as f32 / 65536.0);
        let [down, across, origin] = [plane.down_q16, plane.across_q16, plane.origin_q16]
            .map(|value| value as f32 / 65536.0);
        let focal = rig.focal_q16() as f32 / 65536.0;
        let baseline = rig.focal_baseline_q16() as f32 / 65536.0 / focal;
        let on_axis = down * row + across * column + origin + rig.offset_q6() as f32 / 64.0;
        // The ground's normal, as long as baseline / height.
        let along = on_axis / focal;
        let level = root(down * down + across * across);
        let length = root(level * level + along * along);
        (length > 0.0).then(|| Self {
            height_m: baseline / length,
            pitch_deg: angle_deg(along, level),
            roll_deg: angle_deg(across, down),
        })
    }
}

/// Square root of a number that is not negative.
#[expect(clippy::float_arithmetic, reason = "as its caller's")]
fn root(square: f32) -> f32 {
    if square <= 0.0 {
        return 0.0;
    }
    // Within 5 %: two steps of Newton's are as exact as the type.
    let step = |root: f32| 0.5 * (root + square / root);
    step(step(F32(square).sqrt().0))
}

/// Direction of `(x, y)`, counted from the x axis to the y axis, degrees; 0 of none.
#[expect(clippy::float_arithmetic, reason = "as its caller's")]
fn angle_deg(y: f32, x: f32) -> f32 {
    let (short, long) = (x.abs().min(y.abs()), x.abs().max(y.abs()));
    let t = if long > 0.0 { short / long } else { 0.0 };
    let s = t * t;
    let series =
        0.999_866 + s * (-0.330_299_5 + s * (0.180_141 + s * (-0.085_133 + s * 0.020_835_1)));
    let within = t * series * (180.0 / PI);
    let quarter = if y.abs() > x.abs() { 90.0 - within } else { within };
    let half = if x < 0.0 { 180.0 - quarter } else { quarter };
    if y < 0.0 { -half } else { half }
}

fn check(name: &'static str, value: f32, low: f32, high: f32) -> Result<(), PoseError> {
    if (low..=high).contains(&value) { Ok(()) } else { Err(PoseError { name, value, low, high }) }
}

#[cfg(test)]
#[allow(clippy::float_arithmetic, clippy::unwrap_used, reason = "compared with double precision")]
mod tests {
    use super::*;

    const DIMS: Dims = Dims { width: 320, height: 240 };

    #[test]
    fn points_of_the_ground_lie_on_the_plane() {
        let rig =
            Rig::new(182.5, 0.049, 0.0).unwrap().with_principal_point([159.5, 119.5]).unwrap();
        for (height_m, pitch_deg, roll_deg) in
            [(0.14, 6.7, 0.3), (0.9, 35.0, -2.0), (0.3, -5.0, 12.0)]
        {
            let plane =
                GroundPlane::of_pose(CameraPose { height_m, pitch_deg, roll_deg }, &rig, DIMS)
                    .unwrap();
            let (p, r) = (f64::from(pitch_deg).to_radians(), f64::from(roll_deg).to_radians());
            for (x, y) in [(20, 200), (160, 230), (300, 220)] {
                // The ray's depth at the height.
                let (right, down) =
                    ((f64::from(x) - 159.5) / 182.5, (f64::from(y) - 119.5) / 182.5);
                let level = (right * r.sin() + down * r.cos()) * p.cos() + p.sin();
                let d = 182.5 * 0.049 * level / f64::from(height_m);
                let found = f64::from(plane.at_q6(x, y)) / 64.0;
                assert!(
                    (found - d).abs() < 0.03 + 0.003 * d.abs(),
                    "{height_m} {pitch_deg} ({x}, {y}): {found} for {d}"
                );
            }
        }
    }

    #[test]
    fn the_pose_of_a_plane_is_that_which_it_was_made_of() {
        let rig = Rig::new(182.5, 0.049, 1.5).unwrap();
        for (height_m, pitch_deg, roll_deg) in
            [(0.14, 6.7, 0.3), (0.9, 35.0, -2.0), (0.3, -5.0, 12.0), (0.2, 0.0, 75.0)]
        {
            let pose = CameraPose { height_m, pitch_deg, roll_deg };
            let plane = GroundPlane::of_pose(pose, &rig, DIMS).unwrap();
            let found = CameraPose::of_plane(plane, &rig, DIMS).unwrap();
            // 0.12 degrees and 0.2 %: the sines of `of_pose`.
            assert!(
                (found.height_m / height_m - 1.0).abs() < 0.002
                    && (found.pitch_deg - pitch_deg).abs() < 0.12
                    && (found.roll_deg - roll_deg).abs() < 0.12,
                "{found:?} of {pose:?}"
            );
        }
        let flat = GroundPlane { down_q16: 0, across_q16: 0, origin_q16: -96 * 1024 };
        assert_eq!(CameraPose::of_plane(flat, &rig, DIMS), None);
    }

    #[test]
    fn roots_and_angles_are_those_of_the_library() {
        for degrees in -179..=180 {
            let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
            let found = angle_deg(3.0 * sin as f32, 3.0 * cos as f32);
            assert!((found - degrees as f32).abs() < 0.001, "{found} of {degrees}");
        }
        for square in [1e-9_f32, 0.02, 0.5, 1.0, 7.3, 2e5] {
            // The start is off by 6 % at most, a step by half of the square.
            assert!((root(square) / square.sqrt() - 1.0).abs() < 3e-6, "{square}");
        }
    }

    #[test]
    fn numbers_out_of_range_are_named() {
        let rig = Rig::new(200.0, 0.06, 0.0).unwrap();
        let of = |height_m, pitch_deg| {
            GroundPlane::of_pose(CameraPose { height_m, pitch_deg, roll_deg: 0.0 }, &rig, DIMS)
                .map_err(|error| error.name)
        };
        assert_eq!(of(0.0, 0.0), Err("height (m)"));
        assert_eq!(of(f32::NAN, 0.0), Err("height (m)"));
        assert_eq!(of(0.1, 90.0), Err("pitch (degrees)"));
        // Four times the height.
        assert_eq!([0.0149, 0.0151].map(|height_m| of(height_m, 0.0).is_ok()), [false, true]);
    }
}
