//! Options of distance per direction.

use super::input::Setup;
use crate::engine::FrameResult;
use crate::output::OutputPath;
use crate::results::directions::Directions;
use anyhow::{Result, anyhow, bail};
use clap::ValueEnum;
use linestereo::obstacles::{ObstacleError, ObstacleParam, ObstacleParams, ObstaclePlan};
use linestereo::{Dims, Params};
use linestereo_mavlink::Policy;

/// Messages that an autopilot would be sent.
#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "Distance per direction")]
pub(super) struct SectorArgs {
    /// List the nearest obstacle and drop-off of each direction, 72 sectors of 5 degrees; needs a
    /// rig and the whole pair.
    #[arg(long, conflicts_with = "only_objects")]
    pub(super) sectors: bool,
    #[command(flatten)]
    plan: SectorPlanArgs,
    /// Draw the sectors from above, as PNG.
    #[arg(long, value_name = "FILE.png", conflicts_with = "only_objects")]
    pub(super) fan: Option<OutputPath>,
    /// Write obstacles for an autopilot: HEARTBEAT and OBSTACLE_DISTANCE of MAVLink 2, as bytes.
    #[arg(long, value_name = "FILE", conflicts_with = "only_objects")]
    pub(super) mavlink: Option<OutputPath>,
    /// Messages for a pair that is not fit to be used, or shows nothing: docs/autopilots.md.
    #[arg(long, value_name = "POLICY", default_value = "block", requires = "mavlink")]
    pub(super) policy: PolicyName,
}

/// Range, heights and direction that sectors are made for.
#[derive(Debug, Default, clap::Args)]
pub(super) struct SectorPlanArgs {
    /// Ignore obstacles at this distance or farther [default: 10].
    #[arg(long, value_name = "M")]
    sector_range: Option<f32>,
    /// Heights of obstacles, above the camera [default: all].
    #[arg(long, num_args = 2, value_names = ["LOW_M", "HIGH_M"], allow_negative_numbers = true)]
    sector_heights: Option<Vec<f32>>,
    /// Least depth of a drop-off below the floor; 0 for a vehicle that flies [default: 0.05].
    #[arg(long, value_name = "M")]
    drop_depth: Option<f32>,
    /// Where the camera looks, degrees clockwise from ahead [default: 0].
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    camera_yaw: Option<f32>,
}

/// [`Policy`] by name.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(super) enum PolicyName {
    /// Only heartbeats.
    Silent,
    /// An obstacle at the near limit everywhere in view.
    #[default]
    Block,
    /// All sectors are unknown.
    Unknown,
}

impl From<PolicyName> for Policy {
    fn from(name: PolicyName) -> Self {
        match name {
            PolicyName::Silent => Self::Silent,
            PolicyName::Block => Self::Block,
            PolicyName::Unknown => Self::Unknown,
        }
    }
}

impl SectorArgs {
    fn is_asked(&self) -> bool {
        self.sectors || self.fan.is_some() || self.mavlink.is_some()
    }

    /// Refuses options of sectors that nobody asked for.
    pub(super) fn check(&self) -> Result<()> {
        if self.is_asked() {
            return Ok(());
        }
        self.plan.refuse_unused("--sectors, --fan or --mavlink")
    }

    /// Sectors of each direction; `None` when nobody asked.
    pub(super) fn directions(
        &self,
        setup: &Setup<'_>,
        result: &FrameResult,
    ) -> Result<Option<Directions>> {
        if !self.is_asked() {
            return Ok(None);
        }
        self.plan.directions(setup, result).map(Some)
    }
}

impl SectorPlanArgs {
    pub(super) fn has_yaw(&self) -> bool {
        self.camera_yaw.is_some()
    }

    /// Refuses these options where nothing uses them; `needs` would.
    pub(super) fn refuse_unused(&self, needs: &str) -> Result<()> {
        let unused = [
            (self.sector_range.is_some(), "--sector-range"),
            (self.sector_heights.is_some(), "--sector-heights"),
            (self.drop_depth.is_some(), "--drop-depth"),
            (self.has_yaw(), "--camera-yaw"),
        ];
        match unused.into_iter().find(|(is_given, _)| *is_given) {
            Some((_, name)) => bail!("{name} has no effect alone; add {needs}, or leave it out"),
            None => Ok(()),
        }
    }

    /// Where the camera looks, degrees clockwise from ahead.
    pub(super) fn yaw_deg(&self) -> f32 {
        self.camera_yaw.unwrap_or(ObstacleParams::DEFAULT.yaw_deg)
    }

    /// Sectors of each direction after this pair alone.
    pub(super) fn directions(&self, setup: &Setup<'_>, result: &FrameResult) -> Result<Directions> {
        if setup.geometry().is_none() {
            return Err(setup.lacks("--sectors"));
        }
        let plan = self.plan(&setup.params, setup.dims())?;
        Ok(Directions::new(
            plan.on_ground(result.ground),
            &result.matches,
            &result.obstacle_points,
            result.health.of_pair(),
        ))
    }

    /// The sectors that images of this size and rig see.
    pub(super) fn plan(&self, params: &Params, dims: Dims) -> Result<ObstaclePlan> {
        self.wanted().plan(params, dims).map_err(|error| match error {
            ObstacleError::NoRig => {
                anyhow!("{error}; give --focal-px and --baseline-m, --scene, or --rig")
            }
            ObstacleError::OutOfRange { param, .. } => {
                anyhow!("{error}; change {}", option_behind(param))
            }
            _ => anyhow!("{error}"),
        })
    }

    /// Range and heights, m, and yaw, degrees; the defaults where no option is given.
    pub(super) fn wanted(&self) -> ObstacleParams {
        let mut wanted = ObstacleParams::DEFAULT;
        wanted.range_m = self.sector_range.unwrap_or(wanted.range_m);
        wanted.yaw_deg = self.yaw_deg();
        if let Some(drop_m) = self.drop_depth {
            wanted.drop_m = (drop_m != 0.0).then_some(drop_m);
        }
        if let Some([low, high]) = self.sector_heights.as_deref() {
            wanted.heights_m = [*low, *high];
        }
        wanted
    }
}

fn option_behind(param: ObstacleParam) -> &'static str {
    match param {
        ObstacleParam::Range => "--sector-range",
        ObstacleParam::DropDepth => "--drop-depth",
        ObstacleParam::Yaw => "--camera-yaw",
        ObstacleParam::LowestHeight | ObstacleParam::HighestHeight => "--sector-heights",
        _ => "the rig",
    }
}
