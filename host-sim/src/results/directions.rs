//! Distance per direction of one pair: what an autopilot would be told, as a table, a list and the
//! bytes of MAVLink.

use core::convert::Infallible;
use core::fmt::Write;
use linestereo::health::HealthFlags;
use linestereo::obstacles::{DropOff, ObstaclePlan, Obstacles, Sector};
use linestereo::results::{Match, Point};
use linestereo_mavlink::{AutopilotParams, AutopilotStream, Policy};
use serde::Serialize;

/// Sectors after one pair.
#[derive(Clone, Debug)]
pub struct Directions {
    plan: ObstaclePlan,
    obstacles: Obstacles,
}

/// One direction in JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Direction {
    /// Of the sector, 0 is ahead.
    pub index: u8,
    /// Its middle, clockwise from ahead, -180 .. 180.
    pub direction_deg: f64,
    /// `obstacle`, `free`, `unknown`, `outside`.
    pub state: &'static str,
    /// Along the ground; of an obstacle.
    pub distance_m: Option<f64>,
    /// Of an obstacle and of what is free.
    pub confidence: Option<f64>,
    /// Since it was seen.
    pub age_ms: Option<u32>,
    /// Along the ground, to the edge of the nearest drop-off.
    pub drop_off_m: Option<f64>,
    /// Of the drop-off.
    pub drop_off_confidence: Option<f64>,
}

impl Direction {
    /// The sector of this index among `turn` sectors of a full turn.
    pub fn new(index: u8, turn: u8, sector: Sector, drop_off: Option<DropOff>) -> Self {
        let turned = 360.0 * f64::from(index) / f64::from(turn);
        let metres = |cm: u16| f64::from(cm) / 100.0;
        let (state, distance_m, seen) = match sector {
            Sector::Outside => ("outside", None, None),
            Sector::Unknown => ("unknown", None, None),
            Sector::Free { confidence, age_ms } => ("free", None, Some((confidence, age_ms))),
            Sector::Obstacle { distance_cm, confidence, age_ms } => {
                ("obstacle", Some(metres(distance_cm)), Some((confidence, age_ms)))
            }
        };
        Self {
            index,
            direction_deg: if turned < 180.0 { turned } else { turned - 360.0 },
            state,
            distance_m,
            confidence: seen.map(|(confidence, _)| five_decimals(confidence.to_num())),
            age_ms: seen.map(|(_, age_ms)| age_ms),
            drop_off_m: drop_off.map(|found| metres(found.distance_cm)),
            drop_off_confidence: drop_off.map(|found| five_decimals(found.confidence.to_num())),
        }
    }
}

impl Directions {
    /// Of the matches and points of a pair with this health.
    pub fn new(
        plan: ObstaclePlan,
        matches: &[Match],
        points: &[Point],
        health: HealthFlags,
    ) -> Self {
        let mut obstacles = Obstacles::new();
        obstacles.update(&plan, matches, points.iter().copied(), health, 0);
        Self { plan, obstacles }
    }

    /// How far obstacles matter, m.
    pub fn range_m(&self) -> f64 {
        f64::from(self.plan.range_cm()) / 100.0
    }

    pub fn width_deg(&self) -> f64 {
        360.0 / f64::from(self.plan.sectors())
    }

    /// Every direction of the turn, from ahead on, clockwise.
    pub fn list(&self) -> Vec<Direction> {
        let direction = |(sector, index): (Sector, u8)| {
            let drop_off = self.obstacles.drop_off(&self.plan, index, 0);
            Direction::new(index, self.plan.sectors(), sector, drop_off)
        };
        self.obstacles.sectors(&self.plan, 0).zip(0..).map(direction).collect()
    }

    /// The directions in view from left to right, one line each.
    pub fn table(&self) -> String {
        let mut text =
            format!("sectors of {} degrees, up to {} m", self.width_deg(), self.range_m());
        if !self.obstacles.is_fit() {
            text.push_str(": the pair is not fit to be used, nothing is taken from it");
        }
        text.push('\n');
        let mut seen = self.list();
        seen.retain(|direction| direction.state != "outside");
        seen.sort_by(|a, b| a.direction_deg.total_cmp(&b.direction_deg));
        for sector in &seen {
            let (degrees, state) = (sector.direction_deg, sector.state);
            let _ = match (sector.distance_m, sector.confidence) {
                (Some(metres), Some(p)) => {
                    write!(text, "  {degrees:6.1}  {metres:7.2} m  p {p:.3}")
                }
                (None, Some(p)) => write!(text, "  {degrees:6.1}  {state:>9}  p {p:.3}"),
                _ => write!(text, "  {degrees:6.1}  {state:>9}"),
            };
            if let (Some(metres), Some(p)) = (sector.drop_off_m, sector.drop_off_confidence) {
                let _ = write!(text, "  the floor ends at {metres:.2} m  p {p:.3}");
            }
            text.push('\n');
        }
        text
    }

    /// HEARTBEAT and OBSTACLE_DISTANCE, as a board sends them first.
    pub fn mavlink(&self, policy: Policy) -> Vec<u8> {
        let params = AutopilotParams { policy, ..AutopilotParams::of(&self.plan) };
        let mut bytes = Vec::new();
        if let Ok(mut stream) = AutopilotStream::new(params, &self.plan) {
            let Ok(()) = stream.turn(&self.obstacles, &self.plan, 0, &mut |frame| {
                bytes.extend_from_slice(frame);
                Ok::<(), Infallible>(())
            });
        }
        bytes
    }
}

/// One step of a probability or of a depth is 1.5e-5: five decimals tell all values apart.
pub fn five_decimals(value: f64) -> f64 {
    (value * 1e5).round() / 1e5
}
