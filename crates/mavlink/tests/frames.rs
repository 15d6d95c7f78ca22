//! MAVLink frames: byte for byte those of the `mavlink` crate, which also reads them back; and how
//! many of them a serial line carries.

use linestereo::obstacles::{ObstacleParams, ObstaclePlan, Obstacles};
use linestereo::results::{Point, Source};
use linestereo::units::{Confidence, Disparity};
use linestereo::{Dims, Params, Rig, ground::GroundPlane, health::HealthFlags};
use linestereo_mavlink::{
    AutopilotParams, AutopilotStream, DistanceSensor, Heartbeat, MAX_FRAME, Mavlink,
    ObstacleDistance, Pace, ParamValue, Policy, Received, Receiver, Sender, StreamError,
    SystemStatus, Timesync, UNKNOWN_CM,
};
use mavlink::dialects::common as theirs;
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MavlinkReader, Message as _};

/// xorshift64* (Vigna, 2016): the same numbers on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32
    }
}

/// A frame of the crate.
fn frame_of(header: MavHeader, message: &theirs::MavMessage) -> Vec<u8> {
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.serialize_message(header, message);
    raw.raw_bytes().to_vec()
}

pub(crate) fn read(bytes: &[u8]) -> (MavHeader, theirs::MavMessage) {
    MavlinkReader::new(bytes).read_any_message().unwrap()
}

/// Compares both encodings of a message from any sender, and what the crate reads from ours with
/// what it was told.
fn check<M: Mavlink>(random: &mut Random, message: &M, expected: &theirs::MavMessage) {
    let mut byte = || random.next() as u8;
    let mut sender = Sender { system: byte(), component: byte(), sequence: byte() };
    let header = MavHeader {
        system_id: sender.system.into(),
        component_id: sender.component,
        sequence: sender.sequence,
    };
    let mut bytes = Vec::new();
    let sent = sender.send(message, &mut |frame: &[u8]| {
        bytes.extend_from_slice(frame);
        Ok::<(), ()>(())
    });
    assert_eq!(sent, Ok(()));
    assert!(bytes.len() <= MAX_FRAME);
    assert_eq!(bytes, frame_of(header, expected), "{expected:?}");
    let (found_header, found) = read(&bytes);
    assert_eq!(found_header, header);
    assert_eq!(frame_of(header, &found), bytes, "{found:?} instead of {expected:?}");
}

fn their_obstacles(message: &ObstacleDistance) -> theirs::MavMessage {
    theirs::MavMessage::OBSTACLE_DISTANCE(theirs::OBSTACLE_DISTANCE_DATA {
        time_usec: message.time_usec,
        distances: message.distances,
        min_distance: message.min_distance,
        max_distance: message.max_distance,
        sensor_type: theirs::MavDistanceSensor::MAV_DISTANCE_SENSOR_UNKNOWN,
        increment: message.increment_f as u8,
        increment_f: message.increment_f,
        angle_offset: message.angle_offset,
        frame: theirs::MavFrame::MAV_FRAME_BODY_FRD,
    })
}

fn their_sensor(message: &DistanceSensor) -> theirs::MavMessage {
    theirs::MavMessage::DISTANCE_SENSOR(theirs::DISTANCE_SENSOR_DATA {
        time_boot_ms: message.time_boot_ms,
        min_distance: message.min_distance,
        max_distance: message.max_distance,
        current_distance: message.current_distance,
        mavtype: theirs::MavDistanceSensor::MAV_DISTANCE_SENSOR_UNKNOWN,
        id: message.id,
        orientation: theirs::MavSensorOrientation::MAV_SENSOR_ROTATION_NONE,
        covariance: u8::MAX,
        horizontal_fov: message.horizontal_fov,
        vertical_fov: message.vertical_fov,
        quaternion: [0.0; 4],
        signal_quality: message.signal_quality,
    })
}

#[test]
fn heartbeats_are_those_of_the_crate() {
    let mut random = Random(1);
    for (status, their_status) in [
        (SystemStatus::Active, theirs::MavState::MAV_STATE_ACTIVE),
        (SystemStatus::Critical, theirs::MavState::MAV_STATE_CRITICAL),
    ] {
        let expected = theirs::MavMessage::HEARTBEAT(theirs::HEARTBEAT_DATA {
            custom_mode: 0,
            mavtype: theirs::MavType::MAV_TYPE_ONBOARD_CONTROLLER,
            autopilot: theirs::MavAutopilot::MAV_AUTOPILOT_INVALID,
            base_mode: theirs::MavModeFlag::empty(),
            system_status: their_status,
            mavlink_version: 3,
        });
        for _ in 0..300 {
            check(&mut random, &Heartbeat { status }, &expected);
        }
    }
}

#[test]
fn distances_of_any_values_are_those_of_the_crate() {
    let mut random = Random(2);
    for round in 0..3000 {
        // Zeros at the end are what is cut off: some rounds have many.
        let zeros = round % 4 == 0;
        let mut word =
            || if zeros && random.next().is_multiple_of(3) { 0 } else { random.next() as u16 };
        let message = ObstacleDistance {
            time_usec: [u64::from(word()), u64::MAX, 0][round % 3],
            distances: core::array::from_fn(|_| word()),
            min_distance: word(),
            max_distance: word(),
            increment_f: [5.0, 7.5, 0.0, 90.0][round % 4],
            angle_offset: f32::from(word()) / 64.0 - 500.0,
        };
        check(&mut random, &message, &their_obstacles(&message));

        let mut word = || if zeros { 0 } else { random.next() as u16 };
        let message = DistanceSensor {
            time_boot_ms: u32::from(word()) << 8,
            min_distance: word(),
            max_distance: word(),
            current_distance: word(),
            id: word() as u8,
            horizontal_fov: f32::from(word()) / 10_000.0,
            vertical_fov: f32::from(word()) / 10_000.0,
            signal_quality: if round % 3 == 0 { 0 } else { word() as u8 },
        };
        check(&mut random, &message, &their_sensor(&message));
    }
}

pub(crate) fn plan() -> ObstaclePlan {
    let params = Params { rig: Some(Rig::new(300.0, 0.1, 0.0).unwrap()), ..Params::default() };
    ObstacleParams::DEFAULT.plan(&params, Dims { width: 320, height: 240 }).unwrap()
}

/// Messages of a stream over some seconds, each with its time.
fn messages(
    params: AutopilotParams,
    seconds: u64,
    step_us: u64,
    is_fit: bool,
) -> Vec<(u64, Vec<u8>)> {
    let plan = plan();
    let mut stream = AutopilotStream::new(params, &plan).unwrap();
    let mut obstacles = Obstacles::new();
    let health = if is_fit { HealthFlags::GOOD } else { HealthFlags::SKEW };
    let mut sent = Vec::new();
    let mut time = 0;
    while time < seconds * 1_000_000 {
        obstacles.update(&plan, &[], None, health, time);
        let written = stream.turn(&obstacles, &plan, time, &mut |frame: &[u8]| {
            sent.push((time, frame.to_vec()));
            Ok::<(), ()>(())
        });
        assert_eq!(written, Ok(()));
        time += step_us;
    }
    sent
}

#[test]
fn a_line_of_57600_baud_carries_the_fastest_stream() {
    const SECONDS: u64 = 10;
    for rate_hz in [10, 15, 20] {
        let params = AutopilotParams {
            rate_hz,
            distance_sensor: true,
            policy: Policy::Block,
            ..Default::default()
        };
        // Blocked, so that DISTANCE_SENSOR is sent every time as well: the most that a stream ever
        // sends.
        let sent = messages(params, SECONDS, 1000, false);
        let count = |id: u32| {
            sent.iter().filter(|(_, frame)| read(frame).1.message_id() == id).count() as u64
        };
        assert_eq!(count(ObstacleDistance::ID), SECONDS * u64::from(rate_hz));
        assert_eq!(count(DistanceSensor::ID), SECONDS * u64::from(rate_hz));
        assert_eq!(count(Heartbeat::ID), SECONDS);
        let bytes: u64 = sent.iter().map(|(_, frame)| frame.len() as u64).sum();
        assert!(bytes < SECONDS * 5760, "{bytes} bytes in {SECONDS} s at {rate_hz} Hz");
        // Never more than fits into any 100 ms and the two frames under way.
        for &(start, _) in &sent {
            let window = sent.iter().filter(|(time, _)| (start..start + 100_000).contains(time));
            let bytes: usize = window.map(|(_, frame)| frame.len()).sum();
            assert!(bytes <= 576 + 2 * MAX_FRAME, "{bytes} bytes within 100 ms from {start} us");
        }
        // Numbered without a gap.
        let numbers = sent.iter().map(|(_, frame)| frame[4]);
        assert!(numbers.zip(0..).all(|(number, index): (u8, u32)| number == index as u8));
    }
}

#[test]
fn pairs_that_come_rarely_or_in_bursts_neither_speed_nor_stop_the_stream() {
    let params = AutopilotParams { rate_hz: 20, ..Default::default() };
    let times = |step| {
        messages(params, 6, step, true)
            .into_iter()
            .filter(|(_, frame)| frame[7] != 0)
            .map(|(time, _)| time)
    };
    assert_eq!(times(250_000).count(), 24, "every pair is sent at 4 a second");
    let counted = times(33_333).collect::<Vec<_>>();
    assert!(
        (115..=120).contains(&counted.len()),
        "{} in 6 s at 20 Hz and 30 pairs a second",
        counted.len()
    );
    assert!(counted.windows(2).all(|pair| pair[1] - pair[0] >= 33_333));
}

#[test]
fn a_pace_keeps_its_rhythm_and_forgets_a_pause() {
    let mut pace = Pace::per_second(10);
    let mut due = |times: &[u64]| times.iter().map(|&time| pace.is_due(time)).collect::<Vec<_>>();
    assert_eq!(
        due(&[7, 8, 100_006, 130_000, 200_008, 200_009]),
        [true, false, true, false, true, false]
    );
    assert_eq!(due(&[9_000_000, 9_000_001, 9_099_999, 9_100_000]), [true, false, false, true]);
    assert!(Pace::per_second(0).is_due(u64::MAX));
}

#[test]
fn a_stream_without_sense_is_refused() {
    let plan = plan();
    let refused = |params| AutopilotStream::new(params, &plan).unwrap_err();
    let good = AutopilotParams::DEFAULT;
    for rate_hz in [0, 9, 21, 255] {
        assert_eq!(refused(AutopilotParams { rate_hz, ..good }), StreamError::Rate(rate_hz));
    }
    for cm in [0, 1000, u16::MAX] {
        let params = AutopilotParams { min_distance_cm: cm, ..good };
        assert_eq!(refused(params), StreamError::MinDistance(cm));
    }
    for block_cm in [19, 1000] {
        assert_eq!(refused(AutopilotParams { block_cm, ..good }), StreamError::Block(block_cm));
    }
    assert_eq!(
        StreamError::Rate(9).to_string(),
        "the rate is 9 messages a second but must be 10 to 20"
    );
}

#[test]
fn a_port_that_fails_ends_the_turn() {
    let plan = plan();
    let mut stream = AutopilotStream::new(AutopilotParams::default(), &plan).unwrap();
    let mut calls = 0;
    let turned = stream.turn(&Obstacles::new(), &plan, 0, &mut |_| {
        calls += 1;
        Err("full")
    });
    assert_eq!((turned, calls), (Err("full"), 1));
}

/// The bytes of a message in which nothing is known: sector by sector unknown, never 0, the whole
/// turn.
#[test]
fn nothing_known_is_65535_everywhere() {
    let params = AutopilotParams { policy: Policy::Unknown, ..AutopilotParams::default() };
    let sent = messages(params, 1, 1_000_000, true);
    let theirs::MavMessage::OBSTACLE_DISTANCE(found) = read(&sent[1].1).1 else {
        panic!("{sent:?}")
    };
    assert_eq!(found.distances, [UNKNOWN_CM; 72]);
    assert_eq!((found.increment, found.increment_f, found.angle_offset), (5, 5.0, 0.0));
    assert_eq!((found.min_distance, found.max_distance), (20, 1000));
    assert_eq!(found.frame, theirs::MavFrame::MAV_FRAME_BODY_FRD);
    assert_eq!(sent[1].1.len(), 179);
}

/// A floor that ends ahead, and an obstacle before or behind its edge: the nearer one is sent.
#[test]
fn the_edge_of_a_drop_off_is_sent_as_an_obstacle() {
    let floor = GroundPlane { down_q16: 26_214, across_q16: 0, origin_q16: -80 * 26_214 };
    let plan = plan().on_ground(Some(floor));
    let point = |x: u16, y: u16, disparity: f64| Point {
        x,
        y,
        disparity: Disparity::from_num(disparity),
        confidence: Confidence::from_num(0.99),
        source: Source::Support,
    };
    let sent = |obstacle_px: Option<f64>| {
        let lower = (0..3).map(|n| point(150 + 8 * n, 120, 8.0));
        let standing =
            obstacle_px.map(|disparity| (0..3).map(move |n| point(150 + 8 * n, 90, disparity)));
        let mut obstacles = Obstacles::new();
        let points = lower.chain(standing.into_iter().flatten());
        obstacles.update(&plan, &[], points, HealthFlags::GOOD, 0);
        let params = AutopilotParams { widen: false, ..AutopilotParams::DEFAULT };
        let stream = AutopilotStream::new(params, &plan).unwrap();
        stream.distances(&obstacles, &plan, 0).distances[0]
    };
    // The floor has 17.2 px at row 123, the lower end of the points, and the rig 30 px m: a depth
    // of 1.744 m. The camera looks down by 7.5 degrees, and 0.990 of that is along the ground.
    assert_eq!(sent(None), 172);
    assert_eq!(sent(Some(30.0)), 100, "an obstacle before the edge");
    assert_eq!(sent(Some(10.0)), 172, "an obstacle behind it");
}

/// Messages that a receiver of system 1, component 196 takes of these bytes.
fn received(bytes: &[u8]) -> Vec<Received> {
    let mut receiver = Receiver::new();
    bytes.iter().filter_map(|&byte| receiver.push(byte, 1, 196)).collect()
}

fn id(text: &str) -> [u8; 16] {
    let mut id = [0; 16];
    id[..text.len()].copy_from_slice(text.as_bytes());
    id
}

#[test]
fn parameters_and_times_are_sent_as_the_crate_sends_them() {
    let mut random = Random(5);
    for (name, value) in [("CELL", 20.0), ("ANCHOR_GRADIENT_", -0.5), ("", 0.0)] {
        let (index, count) = (random.next() as u16, random.next() as u16);
        let expected = theirs::MavMessage::PARAM_VALUE(theirs::PARAM_VALUE_DATA {
            param_value: value,
            param_count: count,
            param_index: index,
            param_id: id(name).into(),
            param_type: theirs::MavParamType::MAV_PARAM_TYPE_REAL32,
        });
        check(&mut random, &ParamValue { id: id(name), value, index, count }, &expected);
    }
    let (tc1, ts1) = (-1, 0x0123_4567_89ab_cdef);
    let expected = theirs::TIMESYNC_DATA { tc1, ts1, ..theirs::TIMESYNC_DATA::default() };
    check(&mut random, &Timesync { tc1, ts1 }, &theirs::MavMessage::TIMESYNC(expected));
}

/// Requests that the crate has written, to us, to all and to others.
fn requests() -> (Vec<Vec<u8>>, Vec<Received>) {
    let header = MavHeader { system_id: 255, component_id: 190, sequence: 7 };
    let (mut frames, mut expected) = (Vec::new(), Vec::new());
    for (target_system, target_component, is_ours) in
        [(1, 196, true), (0, 0, true), (1, 0, true), (2, 196, false), (1, 1, false)]
    {
        let list = theirs::PARAM_REQUEST_LIST_DATA { target_system, target_component };
        let read = theirs::PARAM_REQUEST_READ_DATA {
            param_index: -1,
            target_system,
            target_component,
            param_id: id("CELL").into(),
        };
        let set = theirs::PARAM_SET_DATA {
            param_value: 3.5,
            target_system,
            target_component,
            param_id: id("DISTANCE_SENSOR").into(),
            param_type: theirs::MavParamType::MAV_PARAM_TYPE_REAL32,
        };
        frames.extend(
            [
                theirs::MavMessage::PARAM_REQUEST_LIST(list),
                theirs::MavMessage::PARAM_REQUEST_READ(read),
                theirs::MavMessage::HEARTBEAT(theirs::HEARTBEAT_DATA::default()),
                theirs::MavMessage::PARAM_SET(set),
            ]
            .map(|message| frame_of(header, &message)),
        );
        if is_ours {
            expected.extend([
                Received::ParamList,
                Received::ParamRead { index: -1, id: id("CELL") },
                Received::ParamSet { id: id("DISTANCE_SENSOR"), value: 3.5 },
            ]);
        }
    }
    let times =
        theirs::TIMESYNC_DATA { tc1: 0, ts1: 5_000_000_000, ..theirs::TIMESYNC_DATA::default() };
    let for_another =
        theirs::TIMESYNC_DATA { target_system: 1, target_component: 1, ..times.clone() };
    for times in [times, for_another] {
        frames.push(frame_of(header, &theirs::MavMessage::TIMESYNC(times)));
    }
    expected.push(Received::Timesync(Timesync { tc1: 0, ts1: 5_000_000_000 }));
    // Answers, of which that of the autopilot is taken.
    let answer = theirs::TIMESYNC_DATA { tc1: 9, ts1: 8, ..theirs::TIMESYNC_DATA::default() };
    for (system_id, component_id) in [(1, 191), (255, 1), (1, 1)] {
        let header = MavHeader { system_id, component_id, sequence: 7 };
        frames.push(frame_of(header, &theirs::MavMessage::TIMESYNC(answer.clone())));
    }
    expected.push(Received::Timesync(Timesync { tc1: 9, ts1: 8 }));
    (frames, expected)
}

#[test]
fn requests_are_taken_out_of_any_stream() {
    let (frames, expected) = requests();
    assert_eq!(received(&frames.concat()), expected);
    let noisy: Vec<u8> =
        frames.iter().flat_map(|frame| [b"noise\0".as_slice(), frame].concat()).collect();
    assert_eq!(received(&noisy), expected);
}

/// Of flags that have to be known there is one, of a signature.
#[test]
fn a_frame_with_a_flag_that_is_not_known_is_skipped() {
    let (frames, _) = requests();
    for flags in 2..=u8::MAX {
        let mut frame = frames[0].clone();
        frame[2] = flags;
        let end = frame.len() - 2;
        let crc = mavlink::calculate_crc(&frame[1..end], 159);
        frame[end..].copy_from_slice(&crc.to_le_bytes());
        frame.extend([0; 13]); // of a signature
        assert_eq!(
            received(&[frame, frames[0].clone()].concat()),
            [Received::ParamList],
            "{flags}"
        );
    }
}

#[test]
fn nothing_is_taken_out_of_damage() {
    let (frames, expected) = requests();
    for frame in &frames[..4] {
        for (at, bit) in (1..frame.len()).flat_map(|at| (0..8).map(move |bit| (at, bit))) {
            let mut damaged = frame.clone();
            damaged[at] ^= 1 << bit;
            // Flags of the head that change nothing for the reader are not damage: they are part of
            // the checksum.
            assert_eq!(received(&damaged), [], "byte {at}, bit {bit}");
        }
    }
    // A damaged length costs at most the 280 bytes that it announces.
    let mut random = Random(11);
    let mut bytes: Vec<u8> = (0..5000).map(|_| random.next() as u8).collect();
    bytes.extend([0; 280]);
    bytes.extend(frames.concat());
    assert!(received(&bytes).ends_with(&expected));
}
