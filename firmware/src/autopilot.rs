//! Obstacles of every pair to an autopilot, as MAVLink on a port of its own.
//!
//! In: the view of the rig, and of every pair its matches and health. Out: frames on a port, paced by [`AutopilotStream`].
//!
//! # Cost
//! 0.6 KB; instructions in `docs/board-numbers.toml`.

use crate::ports::{ByteSink, packets};
use crate::vehicle::Vehicle;
use linestereo::obstacles::{ObstaclePlan, Obstacles};
use linestereo::{HealthFlags, Matched};
use linestereo_mavlink::AutopilotStream;

/// Obstacles by direction, and their stream to an autopilot. Silent until there is a rig.
#[derive(Clone, Debug)]
pub struct Autopilot {
    vehicle: Vehicle,
    obstacles: Obstacles,
    view: Option<(ObstaclePlan, AutopilotStream)>,
}

impl Autopilot {
    /// Nothing seen, no rig.
    #[must_use]
    pub const fn new(vehicle: Vehicle) -> Self {
        Self { vehicle, obstacles: Obstacles::new(), view: None }
    }

    /// Another vehicle from now on: what is known of obstacles is forgotten.
    pub fn set_vehicle(&mut self, vehicle: Vehicle) {
        if vehicle != self.vehicle {
            (self.vehicle, self.view) = (vehicle, None);
        }
    }

    /// Pairs are seen so from now on; if it is another view than before, nothing is known any more.
    pub fn set_view(&mut self, plan: Option<ObstaclePlan>) {
        if plan == self.view.as_ref().map(|(plan, _)| *plan) {
            return;
        }
        self.obstacles = Obstacles::new();
        self.view =
            plan.and_then(|plan| Some((plan, AutopilotStream::new(self.vehicle.autopilot(&plan), &plan).ok()?)));
    }

    /// Is it known how pairs are seen?
    #[must_use]
    pub fn has_view(&self) -> bool {
        self.view.is_some()
    }

    /// Takes the result of a pair.
    pub fn see(&mut self, matched: &Matched<'_>, health: HealthFlags, time_us: u64) {
        match &self.view {
            Some((plan, _)) => {
                self.obstacles.update(plan, matched.segments(), matched.support_points(), health, time_us);
            }
            None => self.obstacles.mark_missing(),
        }
    }

    /// There was no pair, or it could not be matched.
    pub fn miss(&mut self) {
        self.obstacles.mark_missing();
    }

    /// Writes what is due.
    pub fn turn(&mut self, time_us: u64, port: &mut impl ByteSink) {
        if let Some((plan, stream)) = &mut self.view {
            let Ok(()) = stream.turn(&self.obstacles, plan, time_us, &mut packets(port));
        }
    }
}
