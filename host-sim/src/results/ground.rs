//! The ground plane in JSON and in words: how the cameras stand above it.

use super::directions::five_decimals;
use linestereo::ground::{CameraPose, GroundPlane};
use linestereo::{Dims, Rig};
use serde::Serialize;

/// The ground plane of a pair: `d = down * y + across * x + origin`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ground {
    /// Change of the disparity down the rows: baseline / height of the cameras.
    pub down_px_per_row: f64,
    pub across_px_per_column: f64,
    /// At the left top pixel.
    pub origin_px: f64,
    /// Height of the cameras above it; `None` without a rig that has directions.
    pub camera_height_m: Option<f64>,
    /// Angle of the optical axis below the ground's horizon, degrees; `None` without such a rig.
    pub pitch_deg: Option<f64>,
    /// Roll of the cameras, clockwise, degrees; `None` without such a rig.
    pub roll_deg: Option<f64>,
}

impl Ground {
    /// Of a plane in images of this size.
    pub fn new(plane: GroundPlane, rig: Option<&Rig>, dims: Dims) -> Self {
        let [down, across, origin] = [plane.down_q16, plane.across_q16, plane.origin_q16]
            .map(|value| f64::from(value) / 65_536.0);
        let pose = rig.and_then(|rig| CameraPose::of_plane(plane, rig, dims));
        let stated =
            |value: fn(CameraPose) -> f32| pose.map(|pose| five_decimals(f64::from(value(pose))));
        Self {
            down_px_per_row: five_decimals(down),
            across_px_per_column: five_decimals(across),
            origin_px: five_decimals(origin),
            camera_height_m: stated(|pose| pose.height_m),
            pitch_deg: stated(|pose| pose.pitch_deg),
            roll_deg: stated(|pose| pose.roll_deg),
        }
    }

    pub fn summary(&self) -> String {
        let slope = self.down_px_per_row;
        match (self.camera_height_m, self.pitch_deg, self.roll_deg) {
            (Some(height), Some(pitch), Some(roll)) => format!(
                "ground: {slope:.2} px per row; cameras {height:.3} m above it, pitched {pitch:.1} and rolled {roll:.1} degrees\n"
            ),
            _ => format!("ground: {slope:.2} px per row\n"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_camera_has_the_height_that_its_slope_tells() {
        let dims = Dims { width: 320, height: 240 };
        let rig = Rig::new(200.0, 0.06, 0.0).unwrap();
        // 0.4 px per row from the middle row on: 0.06 m / 0.4.
        let plane = GroundPlane {
            down_q16: 26_214,
            across_q16: 0,
            origin_q16: (-0.4 * 119.5 * 65_536.0) as i32,
        };
        let ground = Ground::new(plane, Some(&rig), dims);
        let near = |value: Option<f64>, expected: f64| {
            (value.unwrap() - expected).abs() < 0.01 * expected.abs().max(1.0)
        };
        assert!((ground.camera_height_m.unwrap() - 0.15).abs() < 0.001, "{ground:?}");
        assert!(near(ground.pitch_deg, 0.0) && near(ground.roll_deg, 0.0), "{ground:?}");
        // Pitched down by 10 degrees: the horizon lies f * tan(10 degrees) higher, and the same
        // slope is of a lower camera.
        let horizon = 119.5 - 200.0 * 10.0_f64.to_radians().tan();
        let pitched = GroundPlane { origin_q16: (-0.4 * horizon * 65_536.0) as i32, ..plane };
        let ground = Ground::new(pitched, Some(&rig), dims);
        assert!(near(ground.pitch_deg, 10.0), "{ground:?}");
        assert!(
            (ground.camera_height_m.unwrap() - 0.15 * 10.0_f64.to_radians().cos()).abs() < 0.001,
            "{ground:?}"
        );
        // As it was stated.
        let pose = CameraPose { height_m: 0.2, pitch_deg: 10.0, roll_deg: 4.0 };
        let rolled = GroundPlane::of_pose(pose, &rig, dims).unwrap();
        let rolled = Ground::new(rolled, Some(&rig), dims);
        assert!((rolled.roll_deg.unwrap() - 4.0).abs() < 0.1, "{rolled:?}");
        assert!(near(rolled.pitch_deg, 10.0), "{rolled:?}");
        let text = ground.summary();
        assert!(
            text.starts_with("ground: 0.40 px per row; cameras 0.148 m above it, pitched 10.0"),
            "{text}"
        );
        assert!(Ground::new(plane, None, dims).summary() == "ground: 0.40 px per row\n");
    }
}
