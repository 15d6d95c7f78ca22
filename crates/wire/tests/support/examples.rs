//! Records with ordinary numbers, no two alike, and the bytes of each in this version: its packet
//! without byte stuffing and checksum.

use super::{camera, counts, head};
use linestereo::health::{HealthFlags, Noise, Rows, Still, Tear};
use linestereo::params::{Margin, Parts};
use linestereo::results::{ImagePosition, Match, Owner, Point, Source, Techniques};
use linestereo::units::{Confidence, Depth, Disparity, Position};
use linestereo_wire::*;

pub(crate) fn messages() -> Vec<(Message, Vec<u8>)> {
    let rig = RigInUse { raw: [752, 480], rectified: [320, 204], slot: Some(1) };
    let hello = Hello {
        board: "qemu".try_into().unwrap(),
        largest_width: 320,
        largest_height: 240,
        segments: 512,
        rig: RigReport { in_use: Some(rig), slots: [Err(RigFault::Damaged), Ok(300)] },
        reset: Some(Reset { cause: ResetCause::Fault, location: 300 }),
    };
    let hello_bytes = vec![
        8, 0, 4, b'q', b'e', b'm', b'u', 0xc0, 2, 0xf0, 1, 0x80, 4, 1, 0xf0, 5, 0xe0, 3, 0xc0, 2,
        0xcc, 1, 1, 1, 1, 6, 0, 0xac, 2, 1, 6, 0xac, 2,
    ];
    let head = FrameHead { capture_time_us: 300, counts: counts(1), ..head(2, 3) };
    let pair = PairReport {
        cameras: [camera(1), camera(6)],
        skew_us: Some(7),
        rows: Some(Rows { offset_q8: -1, spread_q8: 9, samples: 10 }),
        row_offset_q8: Some(-6),
        row_drift_q8: None,
        least_disparity_q6: Some(6),
        range: Some(RangeReport { windows: 13, beyond: 14, disparity: 15 }),
        noise: Some([
            Noise { deviation_q4: 20, noiseless_permille: 21 },
            Noise { deviation_q4: 22, noiseless_permille: 23 },
        ]),
        still: Some(Still { still_permille: 16, pattern_permille: -17 }),
        tear: Some(Tear { row: 18, shift: -19 }),
    };
    let health = Health::SEGMENTS_DROPPED | HealthFlags::ROWS_OFF.into();
    let watched = FrameHead { health, pair: Some(pair), ..head };
    let (before, after) = (
        [8, 1, 2, 0xac, 2, 0xc0, 2, 0xf0, 1],
        [
            1, 0xac, 2, 2, 1, 2, 3, 4, 11, 12, 10, 5, 0x80, 0x80, 4, 7, 8, 9, 10, 11, 12, 13, 14,
            15, 16, 3, 0,
        ],
    );
    let report = [
        1, 1, 2, 3, 4, 5, 6, 2, 3, 4, 5, 1, 7, 1, 1, 9, 10, 1, 11, 0, 1, 12, 1, 13, 14, 15, 1, 20,
        21, 22, 23, 1, 16, 33, 1, 18, 37,
    ];
    let px = Disparity::from_bits;
    let segment = Match {
        ends: [[1, 2], [3, 4]]
            .map(|[x, y]| ImagePosition { x: Position::from_bits(x), y: Position::from_bits(y) }),
        disparity: [5, -6].map(px),
        sigma: px(7),
        confidence: Confidence::from_bits(8),
        owner: Owner::Right,
        depth: Some([9, 10].map(Depth::from_bits)),
        depth_sigma: None,
        techniques: Techniques { feature: Some(px(11)), window: px(12), census: px(13) },
    };
    let segments = Segments { sequence: 2, first: 10, list: [segment].into_iter().collect() };
    let point = |source| Point {
        x: 1,
        y: 2,
        disparity: px(-3),
        confidence: Confidence::from_bits(4),
        source,
    };
    let points = [Source::Side, Source::Segment(300), Source::Support].map(point);
    let points = Points { sequence: 5, first: 9, list: points.into_iter().collect() };
    let refused =
        Refusal::OutOfRange { name: "cell".try_into().unwrap(), value: 7, low: 8, high: 256 };
    let object = ObjectRecord {
        label: 9,
        disparity_q6: Ok(64),
        sigma_q6: 3,
        slope_q10: [-1, 1],
        spread_q6: 2,
        depth_q16: Some([1, 2, 3]),
        support: 5,
        confidence_q16: 6,
    };
    let without_depth = ObjectRecord { disparity_q6: Err(2), depth_q16: None, ..object };
    let objects = Objects { sequence: 4, list: [object, without_depth].into_iter().collect() };
    let silicon = Silicon {
        processor_id: 1,
        chip_id: 300,
        core_hz: 2,
        flash_wait: 3,
        instruction_cache: true,
        data_cache: false,
    };
    let machine = MachineReport {
        firmware: "1.2".try_into().unwrap(),
        unit: "ns".try_into().unwrap(),
        cases: 22,
        expected: 4,
        silicon: Some(silicon),
    };
    let case = CaseReport {
        case: 1,
        name: "rows".try_into().unwrap(),
        segments: 2,
        costs: [3, 4, 5, 6, 7, 8, 9, 10, 300],
        total: 11,
        time_us: 12,
        digests: [13; DIGESTS],
    };
    let case_bytes = [
        &[8, 10, 1, 4, b'r', b'o', b'w', b's', 2][..],
        &[3, 4, 5, 6, 7, 8, 9, 10, 0xac, 2, 11, 12],
        &[13; DIGESTS],
    ];
    let seen = Sighting { distance_cm: 300, confidence_q16: 2, age_ms: 3 };
    let far = SectorRecord { index: 71, nearest: Some(seen), drop_off: None };
    let free = Sighting { distance_cm: 0, ..seen };
    let both = SectorRecord { index: 0, nearest: Some(free), drop_off: Some(seen) };
    let sectors = Sectors { sequence: 4, turn: 72, list: [far, both].into_iter().collect() };
    vec![
        (Message::Hello(hello), hello_bytes),
        (Message::Frame(head), [&before[..], &[2, 0], &after].concat()),
        (Message::Frame(watched), [&before[..], &[0x82, 0x80, 0x80, 2], &report, &after].concat()),
        (
            Message::Segments(segments),
            vec![8, 2, 2, 10, 1, 1, 2, 3, 4, 10, 11, 14, 8, 1, 1, 18, 20, 0, 1, 22, 24, 26],
        ),
        (
            Message::Points(points),
            vec![8, 4, 5, 9, 3, 1, 2, 5, 4, 0, 1, 2, 5, 4, 1, 0xac, 2, 1, 2, 5, 4, 2],
        ),
        (
            Message::Answer(Answer { command: 3, outcome: Outcome::Refused(refused) }),
            vec![8, 3, 3, 1, 0, 4, b'c', b'e', b'l', b'l', 14, 16, 0x80, 4],
        ),
        (
            Message::Objects(objects),
            vec![
                8, 5, 4, 2, 9, 0, 0x80, 1, 6, 1, 2, 4, 1, 2, 4, 6, 5, 6, 9, 1, 2, 6, 1, 2, 4, 0, 5,
                6,
            ],
        ),
        (
            Message::Machine(machine),
            vec![8, 9, 3, b'1', b'.', b'2', 2, b'n', b's', 22, 4, 1, 1, 0xac, 2, 2, 3, 1, 0],
        ),
        (Message::Case(case), case_bytes.concat()),
        (
            Message::Sectors(sectors),
            vec![8, 14, 4, 72, 2, 71, 1, 0xac, 2, 2, 3, 0, 0, 1, 0, 2, 3, 1, 0xac, 2, 2, 3],
        ),
    ]
}

pub(crate) fn commands() -> Vec<(Command, Vec<u8>)> {
    let none = ParamUpdate::default();
    let with_margin = |margin| ParamUpdate {
        margin: Some(margin),
        min_confidence: Some(Confidence::from_bits(300)),
        parts: Some(Parts::Support),
        ..none
    };
    let (nearer, farther) = (Depth::from_bits(-1), Depth::from_bits(1));
    let update = ParamUpdate { min_disparity: Some(-1), cell: Some(16), reach: Some(4), ..none };
    let head =
        PairHead { width: 752, height: 480, capture_time_us: 300, right_capture_time_us: None };
    let of = RegionBox { label: 9, left: 1, top: 2, right: 300, bottom: 4 };
    let regions = Regions { boxes: [of].into_iter().collect(), only: true };
    let all: [(Request, &[u8]); 8] = [
        (Request::Stop, &[2]),
        (
            Request::SetParams(with_margin(Margin::Pixels(Disparity::from_bits(1)))),
            &[3, 0, 0, 0, 0, 0, 0, 1, 0, 2, 1, 0xac, 2, 0, 0, 1, 1],
        ),
        (
            Request::SetParams(with_margin(Margin::Metres { nearer, farther })),
            &[3, 0, 0, 0, 0, 0, 0, 1, 1, 1, 2, 1, 0xac, 2, 0, 0, 1, 1],
        ),
        (Request::SetParams(update), &[3, 1, 1, 0, 0, 0, 0, 1, 16, 0, 0, 1, 4, 0, 0]),
        (Request::SetRig([7, 8, 9].into_iter().collect()), &[5, 3, 7, 8, 9]),
        (Request::RawPair(head), &[6, 0xf0, 5, 0xe0, 3, 0xac, 2, 0]),
        (Request::SetRegions(regions), &[7, 1, 9, 1, 2, 0xac, 2, 4, 1]),
        (Request::RunCase(300), &[9, 0xac, 2]),
    ];
    let command = |(id, (request, bytes)): (u8, (_, &[u8]))| {
        (Command { id: id.into(), request }, [&[0x88, id], bytes].concat())
    };
    (4..).zip(all).map(command).collect()
}
