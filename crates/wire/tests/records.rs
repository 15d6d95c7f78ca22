//! Undamaged records: what is sent is what arrives, in packets of the promised size and these very
//! bytes.

use crate::support::*;
use linestereo::params::Margin;
use linestereo::results::Rejection;
use linestereo::units::{Confidence, Depth, Disparity};
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
    assert_eq!(VERSION, 8);
    for (message, expected) in examples::messages() {
        assert_eq!(payload(&message), expected, "{message:?}");
    }
    for (command, expected) in examples::commands() {
        assert_eq!(payload(&command), expected, "{command:?}");
    }
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
