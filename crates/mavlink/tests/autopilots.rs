//! Reactions of two autopilots to our messages, by small models of their rules: every cell of the
//! table in `src/stream.rs`.
//!
//! PX4: `src/lib/collision_prevention/CollisionPrevention.cpp` (`_addObstacleSensorData`,
//! `_enterData`, `_updateObstacleData`, `_checkSetpointDirectionFeasability`,
//! `_calculateConstrainedSetpoint`); 36 bins up to 1.15, 72 since. ArduPilot:
//! `libraries/AP_Proximity/AP_Proximity_MAV.cpp` (`handle_obstacle_distance_msg`),
//! `AP_Proximity_Boundary_3D.cpp` (`get_face`, `check_face_timeout`),
//! `libraries/AC_Avoidance/AC_Avoid.cpp` (`adjust_velocity_proximity`).

use crate::frames::{plan, read};
use linestereo::health::HealthFlags;
use linestereo::obstacles::{ObstaclePlan, Obstacles};
use linestereo::results::{ImagePosition, Match, Owner, Techniques};
use linestereo::units::{Confidence, Disparity, Position};
use linestereo_mavlink::{AutopilotParams, AutopilotStream, Policy};
use mavlink::dialects::common::{MavMessage, MavState, OBSTACLE_DISTANCE_DATA};

/// RANGE_STREAM_TIMEOUT_US and TIMEOUT_HOLD_US.
const PX4_STALE_MS: u64 = 500;
const PX4_HOLD_MS: u64 = 5000;
/// CP_DIST, cm.
const CP_DIST: u16 = 200;

/// Collision prevention in position mode.
struct Px4 {
    distances: Vec<u16>,
    max_ranges: Vec<u16>,
    times_ms: Vec<u64>,
    in_view: Vec<bool>,
    message_ms: u64,
    /// CP_GO_NO_DATA
    go_no_data: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Px4Says {
    Moves,
    Stops,
    Holds,
}

impl Px4 {
    fn new(bins: usize) -> Self {
        Self {
            distances: vec![u16::MAX; bins],
            max_ranges: vec![0; bins],
            times_ms: vec![0; bins],
            in_view: vec![false; bins],
            message_ms: 0,
            go_no_data: false,
        }
    }

    fn receive(&mut self, message: &OBSTACLE_DISTANCE_DATA, now_ms: u64) {
        self.message_ms = now_ms;
        let bins = self.distances.len();
        for bin in 0..bins {
            // ceil(bin angle / increment), with 5 degrees each.
            let reading = message.distances[bin * (72 / bins)];
            let (known, its_range) = (self.distances[bin], self.max_ranges[bin]);
            let range = message.max_distance;
            let enters = if reading < range {
                known >= its_range || range <= its_range
            } else {
                (known >= its_range && range >= its_range)
                    || (known < its_range && range == its_range)
            };
            if reading != u16::MAX && enters {
                (self.distances[bin], self.max_ranges[bin]) = (reading, range);
                (self.times_ms[bin], self.in_view[bin]) = (now_ms, true);
            }
        }
    }

    /// Reaction of PX4 to a stick in this direction.
    fn moves(&mut self, degrees: usize, now_ms: u64) -> Px4Says {
        for (distance, time_ms) in self.distances.iter_mut().zip(&self.times_ms) {
            if now_ms - time_ms > PX4_STALE_MS {
                *distance = u16::MAX;
            }
        }
        let is_fresh = now_ms - self.message_ms < PX4_STALE_MS;
        if !(is_fresh && self.distances.iter().any(|&distance| distance < u16::MAX)) {
            return if now_ms - self.message_ms > PX4_HOLD_MS {
                Px4Says::Holds
            } else {
                Px4Says::Stops
            };
        }
        let bin = degrees * self.distances.len() / 360;
        let may_go = match self.distances[bin] {
            u16::MAX => self.go_no_data && !self.in_view[bin],
            distance => distance > CP_DIST,
        };
        if may_go { Px4Says::Moves } else { Px4Says::Stops }
    }
}

/// PROXIMITY_FACE_RESET_MS, PROXIMITY_BOUNDARY_3D_TIMEOUT_MS.
const FACE_RESET_MS: u64 = 1000;
const FACE_CHECK_MS: u64 = 750;
/// AVOID_MARGIN and AVOID_BACKUP_DZ, cm.
const AVOID_MARGIN: u16 = 200;
const BACKUP_DEADZONE: u16 = 10;

/// Simple avoidance with a proximity sensor: the faces of 45 degrees around the body, without their
/// low-pass filter.
#[derive(Default)]
struct ArduPilot {
    faces: [Option<u16>; 8],
    times_ms: [u64; 8],
    checked_ms: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ArduSays {
    Free,
    Stops,
    BacksAway,
}

impl ArduPilot {
    fn receive(&mut self, message: &OBSTACLE_DISTANCE_DATA, now_ms: u64) {
        self.faces = [None; 8];
        let increment = f64::from(message.increment_f);
        for (index, &distance) in message.distances.iter().enumerate() {
            let is_ignored = distance == 0
                || distance == u16::MAX
                || distance < message.min_distance
                || distance > message.max_distance;
            if is_ignored {
                continue;
            }
            let degrees = index as f64 * increment + f64::from(message.angle_offset);
            let face = ((degrees + 22.5).rem_euclid(360.0) / 45.0) as usize;
            self.faces[face] = Some(self.faces[face].map_or(distance, |known| known.min(distance)));
            self.times_ms[face] = now_ms;
        }
    }

    fn says(&mut self, degrees: usize, now_ms: u64) -> ArduSays {
        if now_ms - self.checked_ms >= FACE_CHECK_MS {
            self.checked_ms = now_ms;
            for (face, time_ms) in self.faces.iter_mut().zip(self.times_ms) {
                if now_ms - time_ms > FACE_RESET_MS {
                    *face = None;
                }
            }
        }
        match self.faces[(degrees + 22) % 360 / 45] {
            Some(distance) if distance < AVOID_MARGIN - BACKUP_DEADZONE => ArduSays::BacksAway,
            Some(distance) if distance <= AVOID_MARGIN => ArduSays::Stops,
            _ => ArduSays::Free,
        }
    }
}

/// A sure vertical edge; its distance ahead is 30 m / disparity.
fn edge(x: u16, disparity: f64) -> Match {
    let d = Disparity::from_num(disparity);
    let point = |y: u16| ImagePosition { x: Position::from_num(x), y: Position::from_num(y) };
    Match {
        ends: [point(110), point(130)],
        disparity: [d; 2],
        sigma: Disparity::ZERO,
        confidence: Confidence::from_num(0.995),
        owner: Owner::Both,
        depth: None,
        depth_sigma: None,
        techniques: Techniques { feature: None, window: d, census: d },
    }
}

/// 20 m away in every column: free, with a range of 10 m.
fn far() -> Vec<Match> {
    (0..320).step_by(4).map(|x| edge(x, 1.5)).collect()
}

/// Obstacles of a pair of these.
fn seen(plan: &ObstaclePlan, matches: &[Match], time_us: u64) -> Obstacles {
    let mut obstacles = Obstacles::new();
    obstacles.update(plan, matches, None, HealthFlags::GOOD, time_us);
    obstacles
}

/// Distances that a stream sends at this time.
fn sent(
    stream: &mut AutopilotStream,
    obstacles: &Obstacles,
    plan: &ObstaclePlan,
    now_us: u64,
) -> Option<OBSTACLE_DISTANCE_DATA> {
    let mut distances = None;
    let turned = stream.turn(obstacles, plan, now_us, &mut |frame: &[u8]| {
        if let (_, MavMessage::OBSTACLE_DISTANCE(message)) = read(frame) {
            distances = Some(message);
        }
        Ok::<(), ()>(())
    });
    assert_eq!(turned, Ok(()));
    distances
}

/// The vehicle: pairs every 50 ms, fit until `unfit_ms`; both autopilots asked every 10 ms whether
/// they go ahead.
struct Flight {
    px4: Px4,
    ardu: ArduPilot,
    /// Time, and what each says.
    log: Vec<(u64, Px4Says, ArduSays)>,
}

fn fly(params: AutopilotParams, matches: &[Match], unfit_ms: u64, end_ms: u64) -> Flight {
    let plan = plan();
    let mut stream = AutopilotStream::new(params, &plan).unwrap();
    let mut obstacles = Obstacles::new();
    let mut flight = Flight { px4: Px4::new(72), ardu: ArduPilot::default(), log: Vec::new() };
    for now_ms in (0..end_ms).step_by(10) {
        if now_ms % 50 == 0 {
            let health =
                if now_ms < unfit_ms { HealthFlags::GOOD } else { HealthFlags::FEW_MATCHES };
            obstacles.update(&plan, matches, None, health, now_ms * 1000);
            if let Some(message) = sent(&mut stream, &obstacles, &plan, now_ms * 1000) {
                flight.px4.receive(&message, now_ms);
                flight.ardu.receive(&message, now_ms);
            }
        }
        flight.log.push((now_ms, flight.px4.moves(0, now_ms), flight.ardu.says(0, now_ms)));
    }
    flight
}

impl Flight {
    /// The one state of PX4 in this time.
    fn px4(&self, from: u64, to: u64) -> Px4Says {
        self.only(from, to, |&(_, px4, _)| px4)
    }

    fn ardu(&self, from: u64, to: u64) -> ArduSays {
        self.only(from, to, |&(.., ardu)| ardu)
    }

    fn only<T: Copy + PartialEq + core::fmt::Debug>(
        &self,
        from: u64,
        to: u64,
        of: fn(&(u64, Px4Says, ArduSays)) -> T,
    ) -> T {
        let is_then = |(time, ..): &&(u64, _, _)| (from..to).contains(time);
        let said: Vec<T> = self.log.iter().filter(is_then).map(of).collect();
        assert!(said.iter().all(|says| *says == said[0]), "{from} to {to} ms: {said:?}");
        said[0]
    }
}

const UNFIT: u64 = 2000;
const END: u64 = 10_000;
/// 20 messages a second: the next one comes within 50 ms.
const NEXT: u64 = 60;

fn policy(policy: Policy) -> AutopilotParams {
    AutopilotParams { policy, rate_hz: 20, ..Default::default() }
}

#[test]
fn before_anything_goes_wrong_both_fly_where_it_is_free_and_stop_at_obstacles() {
    for kind in Policy::ALL {
        let flight = fly(policy(kind), &far(), END, END);
        assert_eq!(
            (flight.px4(NEXT, END), flight.ardu(NEXT, END)),
            (Px4Says::Moves, ArduSays::Free)
        );
        // 2 m: at the margin of both.
        let flight = fly(policy(kind), &[edge(160, 15.0)], END, END);
        assert_eq!(
            (flight.px4(NEXT, END), flight.ardu(NEXT, END)),
            (Px4Says::Stops, ArduSays::Stops)
        );
    }
}

#[test]
fn silence_stops_px4_and_frees_ardupilot() {
    for matches in [far(), vec![edge(160, 15.0)]] {
        let flight = fly(policy(Policy::Silent), &matches, UNFIT, END);
        assert_eq!(flight.px4(UNFIT + PX4_STALE_MS, UNFIT + 4900), Px4Says::Stops);
        assert_eq!(flight.px4(UNFIT + PX4_HOLD_MS + NEXT, END), Px4Says::Holds);
        let latest = UNFIT + FACE_RESET_MS + FACE_CHECK_MS + NEXT;
        assert_eq!(flight.ardu(latest, END), ArduSays::Free, "even where it was blocked before");
    }
    let flight = fly(policy(Policy::Silent), &[edge(160, 15.0)], UNFIT, END);
    assert_eq!(
        flight.ardu(UNFIT, UNFIT + FACE_RESET_MS - NEXT),
        ArduSays::Stops,
        "it remembers for a second"
    );
}

#[test]
fn block_stops_both_at_once() {
    let flight = fly(policy(Policy::Block), &far(), UNFIT, END);
    assert_eq!(flight.px4(UNFIT + NEXT, END), Px4Says::Stops);
    assert_eq!(
        flight.ardu(UNFIT + NEXT, END),
        ArduSays::BacksAway,
        "20 cm is far within its margin"
    );
    // At the margin, it stays where it is.
    let params = AutopilotParams { block_cm: AVOID_MARGIN, ..policy(Policy::Block) };
    let flight = fly(params, &far(), UNFIT, END);
    assert_eq!(
        (flight.px4(UNFIT + NEXT, END), flight.ardu(UNFIT + NEXT, END)),
        (Px4Says::Stops, ArduSays::Stops)
    );
    // Behind CP_DIST a blocked sector is an obstacle that moves away: PX4 creeps on.
    let params = AutopilotParams { block_cm: CP_DIST + 1, ..policy(Policy::Block) };
    assert_eq!(fly(params, &far(), UNFIT, END).px4(UNFIT + NEXT, END), Px4Says::Moves);
}

#[test]
fn pairs_that_show_nothing_count_as_those_that_are_not_fit() {
    let flight = fly(policy(Policy::Block), &[], END, END);
    assert_eq!(flight.px4(0, END), Px4Says::Stops);
    assert_eq!(flight.ardu(0, END), ArduSays::BacksAway);
    let silent = fly(policy(Policy::Silent), &[], END, END);
    assert_eq!(silent.px4(PX4_HOLD_MS + NEXT, END), Px4Says::Holds);
    // An obstacle that is kept is known; when it is forgotten, nothing is.
    let (plan, mut heartbeat) = (plan(), Vec::new());
    let obstacles = seen(&plan, &[edge(160, 15.0)], 0);
    for now_us in [0, 1_000_000] {
        let mut stream = AutopilotStream::new(policy(Policy::Block), &plan).unwrap();
        let turned = stream.turn(&obstacles, &plan, now_us, &mut |frame: &[u8]| {
            if let (_, MavMessage::HEARTBEAT(message)) = read(frame) {
                heartbeat.push(message.system_status);
            }
            Ok::<(), ()>(())
        });
        assert_eq!(turned, Ok(()));
    }
    assert_eq!(heartbeat, [MavState::MAV_STATE_ACTIVE, MavState::MAV_STATE_CRITICAL]);
}

#[test]
fn unknown_stops_px4_for_good_and_frees_ardupilot_when_nothing_is_kept() {
    let flight = fly(policy(Policy::Unknown), &far(), UNFIT, END);
    assert_eq!(
        flight.px4(UNFIT + PX4_STALE_MS + NEXT, END),
        Px4Says::Stops,
        "and never holds: messages arrive"
    );
    assert_eq!(flight.ardu(UNFIT, END), ArduSays::Free, "nothing says that anything is wrong");
    let flight = fly(policy(Policy::Unknown), &[edge(160, 15.0)], UNFIT, END);
    assert_eq!(
        flight.ardu(UNFIT, UNFIT + 400),
        ArduSays::Stops,
        "an obstacle is kept for half a second"
    );
    assert_eq!(flight.ardu(UNFIT + 500 + NEXT, END), ArduSays::Free);
    assert_eq!(flight.px4(UNFIT, END), Px4Says::Stops);
}

#[test]
fn where_nothing_is_seen_px4_goes_only_if_it_is_told_to() {
    let mut flight = fly(policy(Policy::Block), &far(), END, 1000);
    assert_eq!(flight.px4.moves(90, 1000), Px4Says::Stops);
    assert_eq!(flight.ardu.says(90, 1000), ArduSays::Free);
    flight.px4.go_no_data = true;
    assert_eq!(flight.px4.moves(90, 1000), Px4Says::Moves);
    // But not with no data at all, nor where there was data once.
    assert_eq!(flight.px4.moves(0, 2000), Px4Says::Stops);
    assert_eq!(flight.px4.moves(90, 2000), Px4Says::Stops);
}

#[test]
fn px4_with_36_bins_sees_an_obstacle_between_them_because_it_is_widened() {
    let plan = plan();
    let mut matches = far();
    matches.push(edge(187, 20.0)); // 5.2 degrees to the right: sector 1, which is not read
    let obstacles = seen(&plan, &matches, 0);
    for (widen, expected) in [(false, Px4Says::Moves), (true, Px4Says::Stops)] {
        let params = AutopilotParams { widen, ..policy(Policy::Block) };
        let mut stream = AutopilotStream::new(params, &plan).unwrap();
        let mut px4 = Px4::new(36);
        px4.receive(&sent(&mut stream, &obstacles, &plan, 0).unwrap(), 0);
        assert_eq!(px4.moves(0, 0), expected);
    }
}

/// Sector by sector: what is sent for what is known.
#[test]
fn distances_are_never_0_clear_is_beyond_the_range_and_outside_stays_unknown() {
    let plan = plan();
    let mut matches = far();
    matches.extend([edge(160, 64.0), edge(240, 29.0)]);
    let obstacles = seen(&plan, &matches, 0);
    let params =
        AutopilotParams { min_distance_cm: 60, block_cm: 60, widen: false, ..Default::default() };
    let message = AutopilotStream::new(params, &plan).unwrap().distances(&obstacles, &plan, 7);
    assert_eq!(
        message.distances[0], 60,
        "47 cm are nearer than what can be measured: ArduPilot would ignore them"
    );
    assert_eq!(message.distances[3], 107);
    assert_eq!([message.distances[1], message.distances[2]], [1001; 2]);
    assert!(message.distances[7..66].iter().all(|&distance| distance == u16::MAX));
    assert!(message.distances.iter().all(|&distance| distance > 0));

    let stream = AutopilotStream::new(AutopilotParams { widen: true, ..params }, &plan).unwrap();
    let wide = stream.distances(&obstacles, &plan, 7);
    assert_eq!([wide.distances[71], wide.distances[0], wide.distances[1]], [60; 3]);
    assert_eq!([wide.distances[2], wide.distances[3], wide.distances[4]], [107; 3]);
    assert_eq!(stream.forward(&wide, &plan).unwrap().current_distance, 60);
    assert!(wide.distances[7..66].iter().all(|&distance| distance == u16::MAX));
}

#[test]
fn the_sensor_ahead_is_clear_only_if_all_ahead_is() {
    let plan = plan();
    let params = AutopilotParams { widen: false, ..policy(Policy::Unknown) };
    let stream = AutopilotStream::new(params, &plan).unwrap();
    let ahead = |matches: &[Match]| {
        let distances = stream.distances(&seen(&plan, matches, 0), &plan, 0);
        stream.forward(&distances, &plan).map(|sensor| sensor.current_distance)
    };
    assert_eq!(ahead(&far()), Some(1001));
    assert_eq!(ahead(&[edge(160, 1.5)]), None, "free ahead, unknown beside it");
    assert_eq!(ahead(&[edge(160, 15.0)]), Some(200), "an obstacle is enough");
    assert_eq!(ahead(&[]), None);
    let later = stream.distances(&seen(&plan, &far(), 1_000_000), &plan, 1_234_567);
    let sensor = stream.forward(&later, &plan).unwrap();
    assert_eq!(sensor.time_boot_ms, 1234);
    assert!((sensor.horizontal_fov.to_degrees() - 15.0).abs() < 1e-4);
}
