//! Settings of a vehicle. A robot starts without a host: they are kept in flash
//! ([`crate::settings`]), or chosen before a build: change [`VEHICLE`], build, flash.
//! `docs/autopilots.md` says what suits which autopilot.

use linestereo::obstacles::{ObstacleParams, ObstaclePlan};
use linestereo_mavlink::{AutopilotParams, Policy};
use linestereo_wire::{Refusal, SETTINGS, Setting};

/// Settings of `live` where nobody has changed them.
pub const VEHICLE: Vehicle = Vehicle { ..Vehicle::DEFAULT };

/// How the cameras sit on a vehicle, and what its autopilot gets of obstacles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vehicle {
    /// Where the cameras look, degrees clockwise from ahead, seen from above; -180 ..= 180.
    pub yaw_deg: f32,
    /// Obstacles at this distance or further do not matter, m; 0.1 ..= 600.
    pub range_m: f32,
    /// Lowest and highest height that matters, m above the camera; -1000 ..= 1000.
    pub heights_m: [f32; 2],
    /// Least depth of a drop-off, m; 0 ..= 100. `None` for a vehicle that flies.
    pub drop_m: Option<f32>,
    /// System id of the autopilot.
    pub system: u8,
    /// Distances a second, at most one a pair; 10 ..= 20.
    pub rate_hz: u8,
    /// Distances that are sent while the pair is not fit, or shows nothing.
    pub policy: Policy,
    /// Where [`Policy::Block`] sees obstacles, cm; the near limit of the rig if `None`, and never
    /// nearer.
    pub block_cm: Option<u16>,
    /// Send DISTANCE_SENSOR as well.
    pub distance_sensor: bool,
    /// Send the host the directions of every pair.
    pub sectors: bool,
}

impl Vehicle {
    /// Cameras that look ahead, obstacles to 10 m at all heights, drop-offs of 5 cm; system 1, 15
    /// distances a second, `block` at the near limit.
    pub const DEFAULT: Self = Self {
        yaw_deg: 0.0,
        range_m: 10.0,
        heights_m: [-1000.0, 1000.0],
        drop_m: ObstacleParams::DEFAULT.drop_m,
        system: AutopilotParams::DEFAULT.system,
        rate_hz: AutopilotParams::DEFAULT.rate_hz,
        policy: AutopilotParams::DEFAULT.policy,
        block_cm: None,
        distance_sensor: AutopilotParams::DEFAULT.distance_sensor,
        sectors: false,
    };

    /// How the view is cut into directions.
    pub fn directions(&self) -> ObstacleParams {
        let Self { yaw_deg, range_m, heights_m, drop_m, .. } = *self;
        ObstacleParams { yaw_deg, range_m, heights_m, drop_m, ..ObstacleParams::DEFAULT }
    }

    /// Parameters of the stream to its autopilot, for these directions.
    pub fn autopilot(&self, plan: &ObstaclePlan) -> AutopilotParams {
        let Self { system, rate_hz, policy, block_cm, distance_sensor, .. } = *self;
        let near = AutopilotParams::of(plan);
        let block_cm =
            block_cm.map_or(near.block_cm, |block_cm| block_cm.max(near.min_distance_cm));
        AutopilotParams { system, rate_hz, policy, block_cm, distance_sensor, ..near }
    }

    /// Its settings, in the order of [`Setting::ALL`].
    pub const fn values(&self) -> [f32; SETTINGS - Setting::VEHICLE] {
        let Self { yaw_deg, range_m, heights_m: [lowest, highest], rate_hz, .. } = *self;
        let block_cm = match self.block_cm {
            Some(block_cm) => block_cm as f32,
            None => 0.0,
        };
        let drop_m = match self.drop_m {
            Some(drop_m) => drop_m,
            None => 0.0,
        };
        let (system, policy, distance_sensor) =
            (self.system as f32, self.policy as u8, self.distance_sensor as u8);
        [
            yaw_deg, range_m, lowest, highest, system, rate_hz as f32, policy as f32, block_cm,
            distance_sensor as f32, drop_m, self.sectors as u8 as f32,
        ]
    }

    /// Settings that depend on another one: heights in their order, a block within the range.
    pub fn check(&self) -> Result<(), Refusal> {
        let [_, range_m, lowest, highest, _, _, _, block_cm, ..] = self.values();
        let refusal = |of: usize, value, least, largest| {
            Err(Refusal::Setting { number: (Setting::VEHICLE + of) as u8, value, least, largest })
        };
        if !is_ordered(lowest, highest) {
            return refusal(3, highest, lowest, 1000.0);
        }
        if is_within(block_cm, range_m) {
            Ok(())
        } else {
            refusal(7, block_cm, 0.0, 100.0 * range_m)
        }
    }

    /// Are all numbers in their ranges?
    const fn is_valid(&self) -> bool {
        let values = self.values();
        let (mut rest, mut settings) =
            (values.as_slice(), Setting::ALL.split_at(Setting::VEHICLE).1);
        while let ([value, values @ ..], [setting, others @ ..]) = (rest, settings) {
            if !setting.takes(*value) {
                return false;
            }
            (rest, settings) = (values, others);
        }
        let [_, range_m, lowest, highest, _, _, _, block_cm, ..] = values;
        is_ordered(lowest, highest) && is_within(block_cm, range_m)
    }
}

const fn is_ordered(lowest: f32, highest: f32) -> bool {
    lowest <= highest
}

const fn is_within(block_cm: f32, range_m: f32) -> bool {
    block_cm + 0.5 < 100.0 * range_m // rounded to centimetres as well
}

const _: () = assert!(VEHICLE.is_valid(), "a number of VEHICLE is outside of its range");

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::{Dims, Params, Rig};
    use linestereo_mavlink::AutopilotStream;

    /// A rig that sees from 0.39 m on.
    fn plan(directions: ObstacleParams) -> Option<ObstaclePlan> {
        let params = Params { rig: Rig::new(250.0, 0.1, 0.0).ok(), ..Params::DEFAULT };
        directions.plan(&params, Dims { width: 320, height: 240 }).ok()
    }

    #[test]
    fn the_default_is_the_default_of_both_it_is_made_of() {
        let expected = plan(ObstacleParams::DEFAULT).unwrap();
        assert_eq!(plan(Vehicle::DEFAULT.directions()), Some(expected));
        assert_eq!(Vehicle::DEFAULT.autopilot(&expected), AutopilotParams::of(&expected));
    }

    #[test]
    fn a_block_is_never_nearer_than_what_can_be_seen() {
        for (asked, given) in [(None, 39), (Some(5), 39), (Some(250), 250)] {
            let vehicle = Vehicle { block_cm: asked, policy: Policy::Block, ..Vehicle::DEFAULT };
            let plan = plan(vehicle.directions()).unwrap();
            let params = vehicle.autopilot(&plan);
            assert_eq!(
                (params.min_distance_cm, params.block_cm),
                (plan.near_cm(), given.max(plan.near_cm()))
            );
        }
        assert!(!Vehicle { block_cm: Some(1000), ..Vehicle::DEFAULT }.is_valid());
        assert!(!Vehicle { yaw_deg: 181.0, ..Vehicle::DEFAULT }.is_valid());
        assert!(
            Vehicle { yaw_deg: -90.0, range_m: 4.0, rate_hz: 20, ..Vehicle::DEFAULT }.is_valid()
        );
    }

    /// The ranges stand here again because those who check them cannot do it while it is built.
    #[test]
    fn what_compiles_is_what_a_board_takes() {
        let of = Vehicle::DEFAULT;
        let yaws = [-180.0, -180.1, 90.0, 180.0, 180.1].map(|yaw_deg| Vehicle { yaw_deg, ..of });
        let ranges = [0.05, 0.5, 600.0, 600.1].map(|range_m| Vehicle { range_m, ..of });
        let heights = [[-1000.0, 1000.0], [-1000.1, 0.0], [0.0, 1000.1], [1.0, 1.0], [1.0, 0.5]];
        let heights = heights.map(|heights_m| Vehicle { heights_m, ..of });
        let rates = [9, 10, 20, 21].map(|rate_hz| Vehicle { rate_hz, ..of });
        let blocks = [40, 999, 1000].map(|block_cm| Vehicle { block_cm: Some(block_cm), ..of });
        let rounded = [(2.004, 200), (9.994, 999), (9.994, 998)]
            .map(|(range_m, block_cm)| Vehicle { range_m, block_cm: Some(block_cm), ..of });
        for vehicle in [&yaws[..], &ranges, &heights, &rates, &blocks, &rounded].concat() {
            let is_taken = plan(vehicle.directions())
                .is_some_and(|plan| AutopilotStream::new(vehicle.autopilot(&plan), &plan).is_ok());
            assert_eq!(vehicle.is_valid(), is_taken, "{vehicle:?}");
        }
    }
}
