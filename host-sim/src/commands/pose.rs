//! How the left camera stands above the ground, and where it sees the ground then.

use anyhow::{Result, anyhow, bail};
use linestereo::ground::{CameraPose, GroundPlane};
use linestereo::{Dims, Rig};

/// Height, pitch and roll of the left camera.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub(super) struct PoseArgs {
    /// Height of the left camera above the ground; fixes the ground plane, with --camera-pitch
    /// [default: the scene file's, else the plane is found in the images].
    #[arg(long, value_name = "M", requires = "camera_pitch")]
    camera_height: Option<f32>,
    /// How far the camera looks down.
    #[arg(long, value_name = "DEG", requires = "camera_height", allow_negative_numbers = true)]
    camera_pitch: Option<f32>,
    /// How far the camera is rolled, clockwise as it looks [default: 0].
    #[arg(long, value_name = "DEG", requires = "camera_height", allow_negative_numbers = true)]
    camera_roll: Option<f32>,
}

impl PoseArgs {
    /// The ground in images of this size and rig, by the options, else by the pose of the scene
    /// file; `None` where nobody says it, or there is no rig with directions for the scene file's.
    pub(super) fn ground(
        &self,
        of_scene: Option<CameraPose>,
        rig: Option<&Rig>,
        dims: Dims,
    ) -> Result<Option<GroundPlane>> {
        let given = self.camera_height.zip(self.camera_pitch).map(|(height_m, pitch_deg)| {
            CameraPose { height_m, pitch_deg, roll_deg: self.camera_roll.unwrap_or(0.0) }
        });
        let Some(rig) = rig else {
            if given.is_some() {
                bail!(
                    "--camera-height needs a rig; give --focal-px and --baseline-m, --scene, or \
                     --rig (not --fb, which gives no directions)"
                );
            }
            return Ok(None);
        };
        let remedy = if given.is_some() { "its option" } else { "\"camera\" in the scene file" };
        let plane =
            given.or(of_scene).map(|pose| GroundPlane::of_pose(pose, rig, dims)).transpose();
        plane.map_err(|error| anyhow!("{error}; correct {remedy}"))
    }
}
