//! Place in space of what was matched: points from above, and sectors.

use super::Args;
use crate::commands::input::Setup;
use crate::results::directions::Directions;
use crate::serve::Event;
use anyhow::Result;
use linestereo::results::{ImagePosition, Match, Point};
use linestereo::{
    Dims, Params, Rig, ground::GroundPlane, obstacles::ObstaclePlan, units::Disparity,
};
use linestereo_wire::Health;
use serde_json::{Value, json};

/// Rig and sectors of all pairs of one set-up.
pub(super) struct Space {
    set_up_as: (Params, Dims),
    rig: Rig,
    sectors: ObstaclePlan,
    yaw_deg: f32,
}

impl Space {
    /// That of this set-up, made anew where it is another one than before; `None` without a rig.
    pub(super) fn of<'s>(
        held: &'s mut Option<Self>,
        args: &Args,
        setup: &Setup<'_>,
    ) -> Result<Option<&'s Self>> {
        let set_up_as = (setup.params, setup.dims());
        if held.as_ref().is_none_or(|space| space.set_up_as != set_up_as) {
            let plan = |&rig: &Rig| -> Result<Self> {
                let sectors = args.sectors.plan(&setup.params, setup.dims())?;
                Ok(Self { set_up_as, rig, sectors, yaw_deg: args.sectors.yaw_deg() })
            };
            *held = setup.geometry().map(plan).transpose()?;
        }
        Ok(held.as_ref())
    }

    /// The ends of matches and the points, from above.
    pub(super) fn above(&self, matches: &[Match], points: &[Point]) -> Event {
        let above = |at: ImagePosition, disparity: Disparity| {
            let [x, _, z] = self
                .rig
                .xyz(at, disparity)?
                .map(|metres| (metres.to_num::<f64>() * 1e3).round() / 1e3);
            Some(json!([x, z, disparity.to_num::<f64>()]))
        };
        let of_points = points.iter().filter_map(|point| above(point.position(), point.disparity));
        let ends = matches.iter().flat_map(|found| found.ends.into_iter().zip(found.disparity));
        let placed: Vec<Value> =
            of_points.chain(ends.filter_map(|(at, disparity)| above(at, disparity))).collect();
        let product = self.rig.focal_baseline_q16() as f64 / 65536.0;
        let rig = json!({"product": product, "offset": self.rig.offset_q6() as f64 / 64.0});
        ("above", json!({"points": placed, "rig": rig, "yaw_deg": self.yaw_deg}).to_string())
    }

    /// Sectors of these matches, and of the points that sectors take.
    pub(super) fn sectors(
        &self,
        matches: &[Match],
        points: &[Point],
        ground: Option<GroundPlane>,
        health: Health,
    ) -> Result<Event> {
        let plan = self.sectors.on_ground(ground);
        let directions = Directions::new(plan, matches, points, health.of_pair()).list();
        Ok(("sectors", serde_json::to_string(&directions)?))
    }
}
