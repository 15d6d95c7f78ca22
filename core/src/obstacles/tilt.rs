//! Directions and distances along the ground, by pixels of a camera that is not level.
//!
//! In: the ground plane of a pair. Out: for a pixel, the column in which a camera of the same place
//! and heading, but level, sees what it shows, and how much farther that is along the ground than
//! along the optical axis.
//!
//! ```text
//! (u, v)  = pixel's offset from the principal point / focal length; r, p: roll and pitch
//! right   = u cos r - v sin r                              along the ground, per depth
//! forward = cos p - sin p (u sin r + v cos r)
//! column  = principal column + focal length * right / forward
//! distance along the ground = depth * sqrt(right^2 + forward^2)
//! ```
//!
//! # Bounds
//! Rays within some 7 degrees of straight down, or more than 8 times as far to the right as deep,
//! have no direction.
//!
//! # Cost
//! Some 120 instructions a pixel.

use crate::units::quotient;

/// 1 in Q12.
const ONE_Q12: i64 = 1 << 12;
/// Least part of a ray's depth that is forward, Q12.
const LEAST_FORWARD_Q12: i64 = ONE_Q12 / 8;
/// Largest distance of a column from the principal one, 1/32 px.
const FARTHEST_Q5: i64 = 1 << 24;
/// Largest part of a ray's depth that is forward or to the right, Q12: squares of both fit 32 bits.
const MOST_Q12: i64 = 8 * ONE_Q12 - 1;

/// Pitch and roll of a camera above the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tilt {
    /// Cosine of the pitch, Q20.
    cosine_q20: i32,
    /// Change of `forward` per 1/32 px to the right and downward, Q39.
    forward_q39: [i64; 2],
    /// The same of `right`.
    right_q39: [i64; 2],
    /// Cosine and minus sine of the roll, Q24.
    roll_q24: [i32; 2],
    /// Principal point, 1/32 px.
    origin_q5: [i32; 2],
    /// Focal length, 1/32 px.
    focal_q5: i32,
}

/// Ray of a pixel along the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Along {
    /// Column in which a level camera sees it, 1/32 px.
    pub(super) column_q5: i32,
    /// Forward, per depth, Q12.
    pub(super) forward_q12: i32,
    /// Distance per depth, Q12.
    length_q12: i32,
}

impl Tilt {
    /// Of a camera with the same lens to which the ground's normal is `(across, down, along)`, of
    /// any length, in its axes. `None` where it looks straight up or down.
    pub(super) fn above(&self, [across, down, along]: [i64; 3]) -> Option<Self> {
        let [across, down, along] = [across, down, along].map(|part| part.saturating_mul(1 << 8));
        let length = |squares: i64| i64::try_from(squares.unsigned_abs().isqrt()).ok();
        let level = across.checked_mul(across)?.checked_add(down.checked_mul(down)?)?;
        let all = length(level.checked_add(along.checked_mul(along)?)?)?;
        let level = length(level)?;
        let share_q24 = |part: i64, whole: i64| part.checked_mul(1 << 24)?.checked_div(whole);
        let (cosine_q24, sine_q24) = (share_q24(level, all)?, share_q24(along, all)?);
        let (sin_roll_q24, cos_roll_q24) = (share_q24(across, level)?, share_q24(down, level)?);
        let per_px = |q24: i64| (q24 << 15).checked_div(self.focal_q5.into());
        let [by_x_q24, by_y_q24] =
            [sin_roll_q24, cos_roll_q24].map(|of_roll_q24| (sine_q24 * of_roll_q24) >> 24);
        Some(Self {
            cosine_q20: (cosine_q24 >> 4) as i32, // at most 1
            forward_q39: [per_px(-by_x_q24)?, per_px(-by_y_q24)?],
            right_q39: [per_px(cos_roll_q24)?, per_px(-sin_roll_q24)?],
            roll_q24: [cos_roll_q24 as i32, -sin_roll_q24 as i32], // at most 1 each
            ..*self
        })
    }

    /// Of a level camera with this principal point and focal length, 1/32 px.
    pub(super) fn level(origin_q5: [i32; 2], focal_q5: i32) -> Self {
        let per_px_q39 = (1_i64 << 39).checked_div(focal_q5.into()).unwrap_or(0);
        Self {
            cosine_q20: 1 << 20,
            forward_q39: [0; 2],
            right_q39: [per_px_q39, 0],
            roll_q24: [1 << 24, 0],
            origin_q5,
            focal_q5,
        }
    }

    /// Of the same camera, but level.
    pub(super) fn levelled(&self) -> Self {
        Self::level(self.origin_q5, self.focal_q5)
    }

    /// The image's column in this row, 1/32 px, that shows what a level camera sees in a column;
    /// `None` where no pixel of the row does.
    pub(super) fn column_q5(&self, level_q5: i32, row_q5: i32) -> Option<i32> {
        let [column_q5, origin_row_q5] = self.origin_q5;
        let (level, y) = (i64::from(level_q5 - column_q5), i64::from(row_q5 - origin_row_q5));
        let ([forward_x, forward_y], [right_x, right_y]) = (self.forward_q39, self.right_q39);
        // focal * (right_x x + right_y y) = level * (cosine + forward_x x + forward_y y)
        let forward_q27 = (i64::from(self.cosine_q20) << 7) + ((forward_y * y) >> 12);
        let [focal_x_q27, focal_y_q27] =
            [right_x, right_y].map(|q39| (i64::from(self.focal_q5) * q39) >> 12);
        let per_column_q27 = focal_x_q27 - ((level * forward_x) >> 12);
        let x = (level * forward_q27 - focal_y_q27 * y).checked_div(per_column_q27)?;
        let x_q5 = column_q5 + x.clamp(-FARTHEST_Q5, FARTHEST_Q5) as i32;
        self.along(x_q5, row_q5).map(|_| x_q5)
    }

    /// The ray of a pixel, 1/32 px.
    #[inline(never)] // in four places
    pub(super) fn along(&self, x_q5: i32, y_q5: i32) -> Option<Along> {
        let [column_q5, row_q5] = self.origin_q5;
        let (x, y) = (i64::from(x_q5 - column_q5), i64::from(y_q5 - row_q5));
        let sum = |[per_x, per_y]: [i64; 2]| per_x * x + per_y * y;
        let right_q12 = sum(self.right_q39) >> 27;
        let forward_q12 = (i64::from(self.cosine_q20) + (sum(self.forward_q39) >> 19)) >> 8;
        if !(LEAST_FORWARD_Q12..=MOST_Q12).contains(&forward_q12) || right_q12.abs() > MOST_Q12 {
            return None;
        }
        let (right_q12, forward_q12) = (right_q12 as i32, forward_q12 as i32);
        let squares = (forward_q12 * forward_q12 + right_q12 * right_q12).unsigned_abs();
        // Below 2^17, in Q12.
        let away_q5 =
            quotient(((sum(self.roll_q24.map(i64::from)) >> 24) as i32) << 12, forward_q12);
        Some(Along {
            column_q5: column_q5 + away_q5,
            forward_q12,
            length_q12: squares.isqrt() as i32,
        })
    }
}

impl Along {
    /// Disparity that a camera would have at this distance along the ground on its axis, 1/64 px.
    pub(super) fn nearness_q6(&self, d_q6: i32) -> i32 {
        quotient(d_q6 << 11, self.length_q12 >> 1) // of less than 2^19, and at most 8 times as much
    }
}

#[cfg(test)]
#[allow(clippy::float_arithmetic, clippy::unwrap_used, reason = "compared with double precision")]
mod tests {
    extern crate std;
    use super::*;

    /// Degrees to the right and distance per depth of a ray, of a camera with this pitch and roll.
    fn exact([u, v]: [f64; 2], pitch: f64, roll: f64) -> [f64; 2] {
        let right = u * roll.cos() - v * roll.sin();
        let down = u * roll.sin() + v * roll.cos();
        let forward = pitch.cos() - pitch.sin() * down;
        [right.atan2(forward).to_degrees(), right.hypot(forward)]
    }

    #[test]
    fn directions_and_distances_are_those_along_the_ground() {
        for (focal, per_row) in [(37.0, 0.4), (182.5, 0.05), (300.0, 2.0), (900.0, 0.7)] {
            for (pitch_deg, roll_deg) in
                [(0.0, 0.0), (24.4, -2.7), (-15.0, 3.0), (50.0, 30.0), (0.0, -12.0)]
            {
                let [pitch, roll] = [pitch_deg, roll_deg].map(f64::to_radians);
                let normal = [roll.sin() * pitch.cos(), roll.cos() * pitch.cos(), pitch.sin()]
                    .map(|part| (part * per_row * 65536.0) as i64);
                let origin_q5 = [5104, 3824];
                let tilt = Tilt::level(origin_q5, (focal * 32.0) as i32).above(normal).unwrap();
                for (x, y) in [(0, 0), (40, 200), (160, 120), (250, 239), (319, 10)] {
                    let ray = [(f64::from(x) - 159.5) / focal, (f64::from(y) - 119.5) / focal];
                    let [direction, length] = exact(ray, pitch, roll);
                    let Some(along) = tilt.along(x << 5, y << 5) else {
                        assert!(direction.abs() > 70.0, "{focal} {pitch_deg} {x} {y}");
                        continue;
                    };
                    let found = f64::from(along.column_q5 - origin_q5[0]) / 32.0 / focal;
                    let off = found.atan().to_degrees() - direction;
                    assert!(off.abs() < 0.25, "{focal} {pitch_deg} {x} {y}: {off} degrees");
                    let found = f64::from(along.nearness_q6(1 << 14)) / 16384.0 * length;
                    assert!((found - 1.0).abs() < 0.004, "{focal} {pitch_deg} {x} {y}: {found}");
                    // The way back.
                    let column_q5 = tilt.column_q5(along.column_q5, y << 5).unwrap();
                    assert!((column_q5 - (x << 5)).abs() < 20, "{focal} {x} {y}: {column_q5}");
                }
            }
        }
    }

    #[test]
    fn rays_straight_down_have_no_direction() {
        let [pitch, focal_q5] = [80.0_f64.to_radians(), 3200.0];
        let normal = [0.0, pitch.cos(), pitch.sin()].map(|part| (part * 65536.0) as i64);
        let level = Tilt::level([0, 0], focal_q5 as i32);
        let tilt = level.above(normal).unwrap();
        assert_eq!(tilt.along(0, 18 * 32), None);
        assert!(tilt.along(0, 0).is_some());
        assert_eq!(level.above([0, 0, 65536]), None);
    }
}
