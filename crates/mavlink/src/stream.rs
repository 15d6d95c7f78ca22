//! Schedule of messages: distances 10 to 20 times a second, a heartbeat every second, and the
//! policy for pairs that are not fit to be used or show nothing in any direction.
//!
//! # "No data" at autopilots
//! | policy | sent while the pair is unfit or shows nothing | PX4 | ArduPilot |
//! |---|---|---|---|
//! | `Silent` | no distances | stops after 0.5 s, holds its position after 5 s | free after 1 to 1.75 s |
//! | `Block` | the blocking distance in every sector in view | stops at once, on the spot | stops at once; backs away from what is nearer than its margin |
//! | `Unknown` | obstacles seen before, while they are kept; nothing else | stops after 0.5 s, never holds | free as soon as nothing is kept |
//!
//! Rules, parameters and sources are in `docs/autopilots.md`; `crates/mavlink/tests/autopilots.rs`
//! holds every cell of this table.

use crate::frame::{Mavlink, Sender};
use crate::messages::{DistanceSensor, Heartbeat, ObstacleDistance, SystemStatus, UNKNOWN_CM};
use crate::pace::Pace;
use linestereo::obstacles::{ObstaclePlan, Obstacles, Sector};

/// Content of the messages while the pair is not fit to be used, or nothing is known of any
/// direction in view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Policy {
    /// Heartbeats only.
    Silent,
    /// An obstacle at [`AutopilotParams::block_cm`] in every sector in view.
    Block,
    /// Obstacles seen before as long as they are kept, everything else unknown.
    Unknown,
}

impl Policy {
    /// Every policy.
    pub const ALL: [Self; 3] = [Self::Silent, Self::Block, Self::Unknown];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Silent => "silent",
            Self::Block => "block",
            Self::Unknown => "unknown",
        }
    }
}

/// Sender, content and rate of the messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AutopilotParams {
    /// System id of the vehicle: that of its autopilot.
    pub system: u8,
    /// Component id; 196 is MAV_COMP_ID_OBSTACLE_AVOIDANCE.
    pub component: u8,
    /// Distances a second; 10 ..= 20.
    pub rate_hz: u8,
    /// Content while the pair is not fit to be used, or nothing is known of any direction in view.
    pub policy: Policy,
    /// Shortest distance that can be measured, cm; 1 or more, below the range. ArduPilot ignores
    /// what is nearer, so that nothing nearer is sent.
    pub min_distance_cm: u16,
    /// Where [`Policy::Block`] sees obstacles, cm; from `min_distance_cm` to below the range. At
    /// most PX4's CP_DIST; as far as ArduPilot's AVOID_MARGIN, if it shall not back away.
    pub block_cm: u16,
    /// An obstacle stands in the sectors beside its own as well: PX4 with bins of 10 degrees reads
    /// every second sector only, and vehicles are wide.
    pub widen: bool,
    /// Send DISTANCE_SENSOR as well: the nearest obstacle of the three sectors ahead. ArduPilot
    /// puts both messages into one boundary: there one of them is enough.
    pub distance_sensor: bool,
}

impl AutopilotParams {
    /// The documented defaults: system 1, 15 a second, `block` at 20 cm, widened obstacles, no
    /// DISTANCE_SENSOR.
    pub const DEFAULT: Self = Self {
        system: 1,
        component: 196,
        rate_hz: 15,
        policy: Policy::Block,
        min_distance_cm: 20,
        block_cm: 20,
        widen: true,
        distance_sensor: false,
    };

    /// The defaults with the near limit of this plan as the shortest and the blocking distance.
    #[must_use]
    pub fn of(plan: &ObstaclePlan) -> Self {
        Self { min_distance_cm: plan.near_cm(), block_cm: plan.near_cm(), ..Self::DEFAULT }
    }
}

impl Default for AutopilotParams {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Number of [`AutopilotParams`] outside its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StreamError {
    /// Not 10 to 20 messages a second.
    #[error("the rate is {0} messages a second but must be 10 to 20")]
    Rate(u8),
    /// The shortest distance is 0, or not below the range.
    #[error("the shortest distance is {0} cm but must be above 0 and below the range")]
    MinDistance(u16),
    /// The blocking distance is below the shortest, or not below the range.
    #[error(
        "the blocking distance is {0} cm but must be at least the shortest distance and below the \
         range"
    )]
    Block(u16),
}

/// Messages to one autopilot.
#[derive(Clone, Debug)]
pub struct AutopilotStream {
    params: AutopilotParams,
    sender: Sender,
    distances: Pace,
    heartbeat: Pace,
}

impl AutopilotStream {
    /// For the sectors of this plan.
    pub fn new(params: AutopilotParams, plan: &ObstaclePlan) -> Result<Self, StreamError> {
        let AutopilotParams { system, component, rate_hz, min_distance_cm, block_cm, .. } = params;
        if !(10..=20).contains(&rate_hz) {
            return Err(StreamError::Rate(rate_hz));
        }
        if !(1..plan.range_cm()).contains(&min_distance_cm) {
            return Err(StreamError::MinDistance(min_distance_cm));
        }
        if !(min_distance_cm..plan.range_cm()).contains(&block_cm) {
            return Err(StreamError::Block(block_cm));
        }
        let sender = Sender { system, component, sequence: 0 };
        Ok(Self {
            params,
            sender,
            distances: Pace::per_second(rate_hz),
            heartbeat: Pace::per_second(1),
        })
    }

    /// Writes another message of this sender.
    pub fn send<M: Mavlink, E>(
        &mut self,
        message: &M,
        write: &mut impl FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        self.sender.send(message, write)
    }

    /// Writes what is due at this time, microseconds of the clock of the pairs. To be called after
    /// every pair, and more often if pairs are rarer than messages. Stops at the first failure of
    /// the port.
    pub fn turn<E>(
        &mut self,
        obstacles: &Obstacles,
        plan: &ObstaclePlan,
        now_us: u64,
        write: &mut impl FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        if self.heartbeat.is_due(now_us) {
            let status = if sees(obstacles, plan, now_us) {
                SystemStatus::Active
            } else {
                SystemStatus::Critical
            };
            self.sender.send(&Heartbeat { status }, write)?;
        }
        if !self.distances.is_due(now_us)
            || (self.params.policy == Policy::Silent && !sees(obstacles, plan, now_us))
        {
            return Ok(());
        }
        let message = self.distances(obstacles, plan, now_us);
        self.sender.send(&message, write)?;
        match self.forward(&message, plan) {
            Some(forward) if self.params.distance_sensor => self.sender.send(&forward, write),
            _ => Ok(()),
        }
    }

    /// Distances of all directions as they are sent, cm.
    #[must_use]
    pub fn distances(
        &self,
        obstacles: &Obstacles,
        plan: &ObstaclePlan,
        now_us: u64,
    ) -> ObstacleDistance {
        let AutopilotParams { min_distance_cm, block_cm, .. } = self.params;
        let is_blocked = self.params.policy == Policy::Block && !sees(obstacles, plan, now_us);
        let mut distances = [UNKNOWN_CM; 72];
        for (distance, index) in distances.iter_mut().zip(0..plan.sectors()) {
            // The edge of a drop-off is sent as an obstacle.
            let edge_cm = obstacles
                .drop_off(plan, index, now_us)
                .map_or(UNKNOWN_CM, |drop_off| drop_off.distance_cm.max(min_distance_cm));
            *distance = match obstacles.sector(plan, index, now_us) {
                Sector::Outside => UNKNOWN_CM,
                _ if is_blocked => block_cm,
                Sector::Obstacle { distance_cm, .. } => {
                    distance_cm.max(min_distance_cm).min(edge_cm)
                }
                Sector::Free { .. } if obstacles.is_fit() => plan.range_cm().saturating_add(1),
                Sector::Free { .. } | Sector::Unknown => edge_cm,
            };
        }
        if self.params.widen {
            widen(&mut distances, plan);
        }
        ObstacleDistance {
            time_usec: now_us,
            distances,
            min_distance: min_distance_cm,
            max_distance: plan.range_cm(),
            increment_f: width_deg(plan),
            angle_offset: 0.0,
        }
    }

    /// The sector ahead and its neighbours as one distance: the nearest; clear if all are. `None`
    /// where nothing is known.
    #[must_use]
    pub fn forward(&self, all: &ObstacleDistance, plan: &ObstaclePlan) -> Option<DistanceSensor> {
        let behind = usize::from(plan.sectors().saturating_sub(1));
        let ahead =
            [behind, 0, 1].map(|index| all.distances.get(index).copied().unwrap_or(UNKNOWN_CM));
        let nearest = ahead.into_iter().min().unwrap_or(UNKNOWN_CM);
        let is_known =
            nearest <= all.max_distance || ahead.iter().all(|&distance| distance != UNKNOWN_CM);
        is_known.then(|| DistanceSensor {
            time_boot_ms: (all.time_usec / 1000) as u32,
            min_distance: all.min_distance,
            max_distance: all.max_distance,
            current_distance: nearest,
            id: 0,
            horizontal_fov: 3.0 * width_deg(plan) * (core::f32::consts::PI / 180.0),
            vertical_fov: 0.0,
            signal_quality: 0,
        })
    }
}

/// True when the last pair is fit to be used and something is known of a direction in view. Of two
/// covered cameras, in the dark and before a blank wall nothing is.
fn sees(obstacles: &Obstacles, plan: &ObstaclePlan, now_us: u64) -> bool {
    let is_known = |index| {
        !matches!(obstacles.sector(plan, index, now_us), Sector::Outside | Sector::Unknown)
            || obstacles.drop_off(plan, index, now_us).is_some()
    };
    obstacles.is_fit() && (0..plan.sectors()).any(is_known)
}

/// Puts each obstacle into the sectors beside it too, if they are in view and hold nothing nearer.
fn widen(distances: &mut [u16; 72], plan: &ObstaclePlan) {
    let narrow = *distances;
    let count = usize::from(plan.sectors());
    let of =
        |index: usize| narrow.get(index % count.max(1)).copied().filter(|&cm| cm < plan.range_cm());
    for ((distance, index), sector) in distances.iter_mut().zip(0_usize..).zip(0..plan.sectors()) {
        if plan.in_view(sector).is_some() {
            for beside in [of(index + 1), of(index + count - 1)].into_iter().flatten() {
                *distance = beside.min(*distance);
            }
        }
    }
}

fn width_deg(plan: &ObstaclePlan) -> f32 {
    360.0 / f32::from(plan.sectors())
}
