//! Undamaged records: what is sent is what arrives, in packets of the promised size and these very
//! bytes.

use crate::support::*;
use linestereo::health::{CameraHealth, HealthFlags, Rows, Still, Tear};
use linestereo::params::{Margin, Parts};
use linestereo::results::{ImagePosition, Match, Owner, Point, Rejection, Source, Techniques};
use linestereo::units::{Confidence, Depth, Disparity, Position};
use linestereo::{Capacity, Dims, Matcher, Params, Rig};
use linestereo_wire::*;

#[test]
fn every_record_comes_back() {
    for message in messages() {
        let (results, counters) = decode(&packet(&message));
        assert_eq!(results, [Ok(message)]);
        assert_eq!((counters.good, counters.bad(), counters.skipped_bytes), (1, 0, 0));
    }
    for command in commands() {
        assert_eq!(decode(&packet(&command)).0, [Ok(command)]);
    }
}

#[test]
fn matches_of_any_bits_come_back_equal() {
    let mut random = Random(1);
    for length in [0, 1, SEGMENTS_PER_PACKET - 1, SEGMENTS_PER_PACKET, SEGMENTS_PER_PACKET + 1, 174]
    {
        let matches: Vec<_> = (0..length).map(|_| any_match(&mut random)).collect();
        let mut wire = Vec::new();
        let mut packets = 0;
        let sent = send_frame(&head(8, 0), &matches, &mut |packet| {
            assert!(packet.len() <= MAX_PACKET);
            packets += 1;
            wire.extend_from_slice(packet);
            Ok::<(), ()>(())
        });
        assert_eq!((sent, packets), (Ok(()), 1 + length.div_ceil(SEGMENTS_PER_PACKET)));

        let mut results = decode::<Message>(&wire).0.into_iter();
        assert_eq!(results.next(), Some(Ok(Message::Frame(head(8, length as u16)))));
        let mut received = Vec::new();
        for result in results {
            let Ok(Message::Segments(segments)) = result else { panic!("no segments: {result:?}") };
            assert_eq!((segments.sequence, usize::from(segments.first)), (8, received.len()));
            received.extend(segments.list);
        }
        assert_eq!(received, matches);
    }
}

#[test]
fn a_port_that_fails_ends_the_frame() {
    let matches = [any_match(&mut Random(2)); 25];
    let mut calls = 0;
    let sent = send_frame(&head(1, 0), &matches, &mut |_| {
        calls += 1;
        if calls == 3 { Err("full") } else { Ok(()) }
    });
    assert_eq!((sent, calls), (Err(SendError::Port("full")), 3));
}

/// A pair of vertical bars that are nearer than the wall behind them: enough for the core to count
/// something of most kinds.
fn bars() -> (linestereo::results::Counts, Dims) {
    let dims = Dims { width: 96, height: 64 };
    let mut random = Random(3);
    let wall: Vec<u8> = (0..200 * 64).map(|_| 90 + random.byte() / 8).collect();
    let image = |shift: usize| -> Vec<u8> {
        let pixel = |x: usize, y: usize| match x + shift {
            at if at % 24 < 8 => 200 + (wall[y * 200 + at] % 32),
            _ => wall[y * 200 + x + shift / 2],
        };
        (0..64 * 96).map(|i| pixel(i % 96, i / 96)).collect()
    };
    let (left, right) = (image(0), image(12));
    let view = |pixels| linestereo::Gray::new(pixels, dims, 96).unwrap();
    let mut memory = Box::new(<linestereo::Memory<
        { Capacity::new(Dims { width: 96, height: 64 }).words() },
    >>::new());
    let params = Params { max_disparity: 32, ..Params::default() };
    let mut matcher = Matcher::new(params, dims).unwrap();
    let counts = *matcher.run(&mut memory, view(&left), view(&right)).unwrap().counts();
    (counts, dims)
}

#[test]
fn counts_are_the_cores() {
    let (counts, dims) = bars();
    let counts = &counts;
    let sent = FrameHead::new(1, 2, dims, Health::RESULTS_SKIPPED, counts);
    let Ok(Message::Frame(head)) = decode(&packet(&Message::Frame(sent))).0.remove(0) else {
        panic!("no frame")
    };
    let wire = head.counts;
    assert!(
        counts.segments_left > 0 && counts.segments_right > 0,
        "the bars are found: {counts:?}"
    );
    assert!(
        Rejection::ALL.iter().any(|&reason| counts.rejected(reason) > 0),
        "something is rejected: {counts:?}"
    );
    for reason in Rejection::ALL {
        assert_eq!(wire.rejected(reason), counts.rejected(reason), "{}", reason.name());
    }
    assert_eq!(
        (wire.segments_left, wire.segments_right, wire.matched),
        (counts.segments_left, counts.segments_right, counts.matched)
    );
    assert_eq!(
        (wire.segments_left_dropped, wire.segments_right_dropped),
        (counts.segments_left_dropped, counts.segments_right_dropped)
    );
    assert_eq!((wire.edges_cut, wire.comparisons_cut), (counts.edges_cut, counts.comparisons_cut));
    assert_eq!(
        (head.width, head.height, head.health),
        (96, 64, Health::RESULTS_SKIPPED | Health::of(counts))
    );
}

#[test]
fn health_follows_full_lists() {
    assert_eq!(Health::of(&linestereo::results::Counts::default()), Health::GOOD);
    let kinds: [fn(&mut linestereo::results::Counts) -> &mut u16; 4] = [
        |counts| &mut counts.segments_left_dropped,
        |counts| &mut counts.segments_right_dropped,
        |counts| &mut counts.edges_cut,
        |counts| &mut counts.comparisons_cut,
    ];
    for kind in kinds {
        let mut counts = linestereo::results::Counts::default();
        *kind(&mut counts) = 1;
        assert_eq!(Health::of(&counts), Health::SEGMENTS_DROPPED);
    }
    let all = Health::NAMES.iter().fold(Health::GOOD, |set, &(flag, _)| set | flag);
    assert_eq!(all.bits().count_ones() as usize, Health::NAMES.len(), "one bit each");
    assert_eq!(Health::GOOD.to_string(), "good");
    assert_eq!(
        (Health::SIZE_MISMATCH | Health::from_bits_retain(1 << 7)).to_string(),
        "size_mismatch+0x00000080"
    );
}

#[test]
fn the_largest_packets_are_exactly_as_large_as_promised() {
    let largest = |lengths: Vec<usize>| lengths.into_iter().max().unwrap();
    assert_eq!(
        largest(messages().iter().map(|message| packet(message).len()).collect()),
        MAX_PACKET
    );
    assert_eq!(
        largest(commands().iter().map(|command| packet(command).len()).collect()),
        MAX_COMMAND
    );
    const { assert!(MAX_PACKET < 600) };
}

#[test]
fn a_buffer_needs_every_byte_of_the_packet() {
    for message in messages() {
        let whole = packet(&message);
        for length in 0..whole.len() {
            assert_eq!(
                encode(&message, &mut vec![0x55; length]),
                Err(EncodeError::BufferTooSmall),
                "{length}"
            );
        }
        assert_eq!(encode(&message, &mut vec![0x55; whole.len()]), Ok(&whole[..]));
        assert_eq!(whole.iter().position(|&byte| byte == DELIMITER), Some(whole.len() - 1));
    }
}

/// The bytes of version 7. When this fails, the records changed: give them another [`VERSION`].
#[test]
fn the_layout_of_this_version_is_exactly_this() {
    /// Payload: without byte stuffing and checksum.
    fn payload<T: Record>(record: &T) -> Vec<u8> {
        let mut bytes = packet(record);
        let length = cobs::decode_in_place(&mut bytes).unwrap();
        let (payload, crc) = bytes[..length].split_last_chunk().unwrap();
        assert_eq!(
            u32::from_le_bytes(*crc),
            crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(payload)
        );
        payload.to_vec()
    }
    assert_eq!(VERSION, 7);
    let rig = RigInUse { raw: [752, 480], rectified: [320, 204], slot: Some(1) };
    let rig = RigReport { in_use: Some(rig), slots: [Err(RigFault::Damaged), Ok(300)] };
    let hello = Hello {
        board: "qemu".try_into().unwrap(),
        largest_width: 320,
        largest_height: 240,
        segments: 512,
        rig,
        reset: Some(Reset { cause: ResetCause::Fault, location: 300 }),
    };
    let expected = [
        7, 0, 4, b'q', b'e', b'm', b'u', 0xc0, 2, 0xf0, 1, 0x80, 4, 1, 0xf0, 5, 0xe0, 3, 0xc0, 2,
        0xcc, 1, 1, 1, 1, 6, 0, 0xac, 2, 1, 6, 0xac, 2,
    ];
    assert_eq!(payload(&Message::Hello(hello)), expected);
    let head = FrameHead { capture_time_us: 300, counts: counts(1), ..head(2, 3) };
    let expected = [
        7, 1, 2, 0xac, 2, 0xc0, 2, 0xf0, 1, 2, 0, 1, 0xac, 2, 2, 1, 2, 3, 4, 11, 12, 10, 5, 0x80,
        0x80, 4, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 3, 0,
    ];
    assert_eq!(payload(&Message::Frame(head)), expected);
    let camera = |level| CameraHealth {
        level,
        detail_q4: 2,
        black_permille: 3,
        white_permille: 4,
        view_permille: 5,
    };
    let pair = PairReport {
        cameras: [camera(1), camera(6)],
        skew_us: Some(7),
        rows: Some(Rows { offset_q8: -1, spread_q8: 9, samples: 10 }),
        row_offset_q8: Some(-6),
        row_drift_q8: None,
        least_disparity_q6: Some(6),
        range: Some(RangeReport { windows: 13, beyond: 14, disparity: 15 }),
        still: Some(Still { still_permille: 16, pattern_permille: -17 }),
        tear: Some(Tear { row: 18, shift: -19 }),
    };
    let health = Health::SEGMENTS_DROPPED | HealthFlags::ROWS_OFF.into();
    let watched = payload(&Message::Frame(FrameHead { health, pair: Some(pair), ..head }));
    let report = [
        1, 1, 2, 3, 4, 5, 6, 2, 3, 4, 5, 1, 7, 1, 1, 9, 10, 1, 11, 0, 1, 12, 1, 13, 14, 15, 1, 16,
        33, 1, 18, 37,
    ];
    assert_eq!(
        watched,
        [&expected[..9], &[0x82, 0x80, 0x80, 2], &report, &expected[11..]].concat()
    );
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
    let expected = [7, 2, 2, 10, 1, 1, 2, 3, 4, 10, 11, 14, 8, 1, 1, 18, 20, 0, 1, 22, 24, 26];
    assert_eq!(payload(&Message::Segments(segments)), expected);
    let point = |source| Point {
        x: 1,
        y: 2,
        disparity: px(-3),
        confidence: Confidence::from_bits(4),
        source,
    };
    let list =
        [Source::Side, Source::Segment(300), Source::Support].map(point).into_iter().collect();
    let expected = [7, 4, 5, 9, 3, 1, 2, 5, 4, 0, 1, 2, 5, 4, 1, 0xac, 2, 1, 2, 5, 4, 2];
    assert_eq!(payload(&Message::Points(Points { sequence: 5, first: 9, list })), expected);
    let margins = [
        Margin::Pixels(px(1)),
        Margin::Metres { nearer: Depth::from_bits(-1), farther: Depth::from_bits(1) },
    ];
    for (margin, expected) in margins.into_iter().zip([&[0, 2][..], &[1, 1, 2]]) {
        let (min_confidence, parts) = (Some(Confidence::from_bits(300)), Some(Parts::Support));
        let update =
            ParamUpdate { margin: Some(margin), min_confidence, parts, ..ParamUpdate::default() };
        let bytes = payload(&Command { id: 5, request: Request::SetParams(update) });
        assert_eq!(
            bytes,
            [&[0x87, 5, 3, 0, 0, 0, 0, 0, 0, 1], expected, &[1, 0xac, 2, 0, 0, 1, 1]].concat()
        );
    }
    let refused =
        Refusal::OutOfRange { name: "cell".try_into().unwrap(), value: 7, low: 8, high: 256 };
    let answer = Answer { command: 3, outcome: Outcome::Refused(refused) };
    let expected = [7, 3, 3, 1, 0, 4, b'c', b'e', b'l', b'l', 14, 16, 0x80, 4];
    assert_eq!(payload(&Message::Answer(answer)), expected);
    assert_eq!(payload(&Command { id: 4, request: Request::Stop }), [0x87, 4, 2]);
    let update = ParamUpdate {
        min_disparity: Some(-1),
        cell: Some(16),
        reach: Some(4),
        ..ParamUpdate::default()
    };
    let expected = [0x87, 5, 3, 1, 1, 0, 0, 0, 0, 1, 16, 0, 0, 1, 4, 0, 0];
    assert_eq!(payload(&Command { id: 5, request: Request::SetParams(update) }), expected);
    let bytes = [7, 8, 9].into_iter().collect();
    assert_eq!(
        payload(&Command { id: 6, request: Request::SetRig(bytes) }),
        [0x87, 6, 5, 3, 7, 8, 9]
    );
    let head =
        PairHead { width: 752, height: 480, capture_time_us: 300, right_capture_time_us: None };
    let expected = [0x87, 7, 6, 0xf0, 5, 0xe0, 3, 0xac, 2, 0];
    assert_eq!(payload(&Command { id: 7, request: Request::RawPair(head) }), expected);
    let of = RegionBox { label: 9, left: 1, top: 2, right: 300, bottom: 4 };
    let regions = Regions { boxes: [of].into_iter().collect(), only: true };
    let expected = [0x87, 8, 7, 1, 9, 1, 2, 0xac, 2, 4, 1];
    assert_eq!(payload(&Command { id: 8, request: Request::SetRegions(regions) }), expected);
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
    let refused = ObjectRecord { disparity_q6: Err(2), depth_q16: None, ..object };
    let objects = Objects { sequence: 4, list: [object, refused].into_iter().collect() };
    let expected =
        [7, 5, 4, 2, 9, 0, 0x80, 1, 6, 1, 2, 4, 1, 2, 4, 6, 5, 6, 9, 1, 2, 6, 1, 2, 4, 0, 5, 6];
    assert_eq!(payload(&Message::Objects(objects)), expected);
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
    let expected = [7, 9, 3, b'1', b'.', b'2', 2, b'n', b's', 22, 4, 1, 1, 0xac, 2, 2, 3, 1, 0];
    assert_eq!(payload(&Message::Machine(machine)), expected);
    let case = CaseReport {
        case: 1,
        name: "rows".try_into().unwrap(),
        segments: 2,
        costs: [3, 4, 5, 6, 7, 8, 9, 10, 300],
        total: 11,
        time_us: 12,
        digests: [13; DIGESTS],
    };
    let (head, digests) = ([7, 10, 1, 4, b'r', b'o', b'w', b's', 2], [13; DIGESTS]);
    let costs = [3, 4, 5, 6, 7, 8, 9, 10, 0xac, 2, 11, 12];
    assert_eq!(payload(&Message::Case(case)), [&head[..], &costs, &digests].concat());
    assert_eq!(payload(&Command { id: 9, request: Request::RunCase(300) }), [0x87, 9, 9, 0xac, 2]);
    let seen = Sighting { distance_cm: 300, confidence_q16: 2, age_ms: 3 };
    let of = SectorRecord { index: 71, nearest: Some(seen), drop_off: None };
    let free = Sighting { distance_cm: 0, ..seen };
    let both = SectorRecord { index: 0, nearest: Some(free), drop_off: Some(seen) };
    let sectors = Sectors { sequence: 4, turn: 72, list: [of, both].into_iter().collect() };
    let expected = [7, 14, 4, 72, 2, 71, 1, 0xac, 2, 2, 3, 0, 0, 1, 0, 2, 3, 1, 0xac, 2, 2, 3];
    assert_eq!(payload(&Message::Sectors(sectors)), expected);
}

const DIMS: Dims = Dims { width: 320, height: 240 };

#[test]
fn an_update_changes_what_it_names_and_nothing_else() {
    let before = Params { max_disparity: 48, reach: 3, ..Params::default() };
    assert_eq!(ParamUpdate::default().apply(before), Ok(before));
    let none = ParamUpdate::default();
    let rig = RigUpdate { focal_px: 400.0, baseline_m: 0.1, offset_px: -0.5 };
    let cases = [
        (ParamUpdate { min_disparity: Some(-4), ..none }, Params { min_disparity: -4, ..before }),
        (ParamUpdate { max_disparity: Some(99), ..none }, Params { max_disparity: 99, ..before }),
        (
            ParamUpdate { anchor_gradient: Some(50), ..none },
            Params { anchor_gradient: 50, ..before },
        ),
        (ParamUpdate { edge_gradient: Some(30), ..none }, Params { edge_gradient: 30, ..before }),
        (ParamUpdate { min_extent: Some(8), ..none }, Params { min_extent: 8, ..before }),
        (ParamUpdate { cell: Some(32), ..none }, Params { cell: 32, ..before }),
        (ParamUpdate { reach: Some(5), ..none }, Params { reach: 5, ..before }),
        (
            ParamUpdate { min_confidence: Some(Confidence::from_num(0.5)), ..none },
            Params { min_confidence: Confidence::from_num(0.5), ..before },
        ),
        (
            ParamUpdate { margin: Some(Margin::Pixels(Disparity::from_num(2))), ..none },
            Params { margin: Margin::Pixels(Disparity::from_num(2)), ..before },
        ),
        (
            ParamUpdate { rig: Some(rig), ..none },
            Params { rig: Some(Rig::new(400.0, 0.1, -0.5).unwrap()), ..before },
        ),
    ];
    for (update, expected) in cases {
        assert_eq!(update.apply(before), Ok(expected));
        assert_eq!(update.checked(before, DIMS), Ok(expected));
    }
    let margin = Margin::Metres { nearer: Depth::from_num(0.5), farther: Depth::ONE };
    let metres = ParamUpdate { margin: Some(margin), rig: Some(rig), ..none };
    assert_eq!(metres.checked(before, DIMS).unwrap().margin, margin);
}

#[test]
fn what_the_core_refuses_is_refused_by_name() {
    let none = ParamUpdate::default();
    let rig = |focal_px, baseline_m, offset_px| ParamUpdate {
        rig: Some(RigUpdate { focal_px, baseline_m, offset_px }),
        ..none
    };
    let cases = [
        (
            ParamUpdate { max_disparity: Some(320), ..none },
            "max_disparity is 320 but must be 8 to 256",
        ),
        (ParamUpdate { min_disparity: Some(1), ..none }, "min_disparity is 1 but must be -32 to 0"),
        (
            ParamUpdate { edge_gradient: Some(49), ..none },
            "edge_gradient is 49 but must be 4 to 48",
        ),
        (
            ParamUpdate { min_confidence: Some(Confidence::ZERO), ..none },
            "min_confidence (percent) is 0 but must be 10 to 99",
        ),
        (
            ParamUpdate {
                margin: Some(Margin::Metres { nearer: Depth::DELTA, farther: Depth::DELTA }),
                ..none
            },
            "a margin in metres needs a rig (focal length and baseline)",
        ),
        (rig(0.5, 0.1, 0.0), "focal length 0.5 px is outside 1 to 100000"),
        (rig(400.0, f64::NAN, 0.0), "baseline NaN m is outside 0.0001 to 10: is it in mm?"),
        (rig(400.0, 0.1, -1e9), "disparity offset -1000000000 px is outside -4096 to 4096"),
        (full_update(), "baseline"),
    ];
    for (update, says) in cases {
        let Err(refusal) = update.checked(Params::default(), DIMS) else {
            panic!("{update:?} is accepted")
        };
        let outcome = Outcome::from(Err(refusal.clone()));
        let text = refusal.to_string();
        if update == full_update() {
            assert!(text.starts_with("focal length"), "{text}");
        } else {
            assert_eq!(text, says);
        }
        let answer = Message::Answer(Answer { command: 1, outcome });
        let Ok(Message::Answer(answer)) = decode(&packet(&answer)).0.remove(0) else {
            panic!("no answer")
        };
        let Outcome::Refused(received) = answer.outcome else { panic!("accepted") };
        assert_eq!(received.to_string(), text);
    }
    let name = linestereo_wire::name("a name that is longer than any of them is");
    assert_eq!(name, "a name that is longer than any o");
}

#[test]
fn a_board_says_what_its_slots_hold() {
    assert_eq!(RigReport::NONE.to_string(), "rig: none; no flash to keep one");
    let slots = [Err(RigFault::Empty), Err(RigFault::Damaged)];
    assert_eq!(RigReport { in_use: None, slots }.to_string(), "rig: none; slots: empty, damaged");
    let rig = RigInUse { raw: [640, 480], rectified: [320, 240], slot: Some(0) };
    let report = RigReport { in_use: Some(rig), slots: [Ok(8), Err(RigFault::OtherVersion)] };
    assert_eq!(
        report.to_string(),
        "rig: 640x480 rectified to 320x240; slots: image 8 (in use), other version"
    );
}
