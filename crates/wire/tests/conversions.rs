//! Records made of the core's results, sent and read back: segments, objects, points, health and
//! settings.

use crate::support::*;
use linestereo::health::{HealthFlags, Noise, PairHealth, Rows, Still, Tear};
use linestereo::objects::{ObjectMetres, Reason};
use linestereo::obstacles::{ObstacleParams, Obstacles, Sector};
use linestereo::results::{Point, Source};
use linestereo::units::{Confidence, Depth, Disparity};
use linestereo::{Dims, NoDepth, ObjectDepth, Params, Rig, ground::GroundPlane};
use linestereo_wire::*;

/// Sends by `send` and gives the messages that arrive.
fn received(
    send: impl FnOnce(&mut dyn FnMut(&[u8]) -> Result<(), ()>) -> Result<(), SendError<()>>,
) -> Vec<Message> {
    let mut wire = Vec::new();
    let sent = send(&mut |packet| {
        assert!(packet.len() <= MAX_PACKET);
        wire.extend_from_slice(packet);
        Ok(())
    });
    assert_eq!(sent, Ok(()));
    decode(&wire).0.into_iter().map(Result::unwrap).collect()
}

/// Directions of a wide camera, of which one is unknown and one has a drop-off.
#[test]
fn directions_come_back_equal() {
    let dims = Dims { width: 640, height: 480 };
    let rig = Rig::new(120.0, 0.1, 0.0).unwrap(); // 139 degrees
    let params = Params { rig: Some(rig), ..Params::default() };
    let plan = ObstacleParams::DEFAULT.plan(&params, dims).unwrap();
    // 0.1 px of disparity down each row: 1 m below the camera.
    let ground = GroundPlane { down_q16: 6554, across_q16: 0, origin_q16: -6554 * 240 };
    let point = |x, y, disparity: f64| Point {
        x,
        y,
        disparity: Disparity::from_num(disparity),
        confidence: Confidence::from_num(0.95),
        source: Source::Support,
    };
    // 2 m away above the floor at all columns but some; and below the floor.
    let walls = (0..640).step_by(8).filter(|x| !(300..340).contains(x));
    let points = walls.flat_map(|x| (176..224).step_by(8).map(move |y| point(x, y, 6.0)));
    let points = points.chain((315..325).map(|x| point(x, 400, 10.0)));
    let mut obstacles = Obstacles::new();
    obstacles.update(&plan.on_ground(Some(ground)), &[], points, HealthFlags::GOOD, 1_000_000);

    let messages = received(|mut write| send_sectors(7, &plan, &obstacles, 1_250_000, &mut write));
    assert_eq!(messages.len(), 2);
    let mut back = vec![(Sector::Unknown, None); 72];
    for message in messages {
        let Message::Sectors(Sectors { sequence: 7, turn: 72, list }) = message else {
            panic!("{message:?}")
        };
        for record in list {
            back[usize::from(record.index)] = (record.sector(), record.drop_off());
        }
    }
    let mut found = [0; 3];
    for (index, (sector, drop_off)) in (0..72).zip(back) {
        let expected = match obstacles.sector(&plan, index, 1_250_000) {
            Sector::Outside => Sector::Unknown,
            sector => sector,
        };
        let expected_drop = obstacles.drop_off(&plan, index, 1_250_000);
        assert_eq!((sector, drop_off), (expected, expected_drop), "sector {index}");
        found[0] += usize::from(matches!(sector, Sector::Obstacle { age_ms: 250, .. }));
        found[1] += usize::from(drop_off.is_some());
        found[2] += usize::from(sector == Sector::Unknown && drop_off.is_none());
    }
    assert!(found[0] > SECTORS_PER_PACKET && found[1] > 0 && found[2] > 0, "{found:?}");

    let free = Sector::Free { confidence: Confidence::from_num(0.99), age_ms: 70_000 };
    let record = SectorRecord::new(3, free, None).unwrap();
    assert_eq!(record.nearest.unwrap().age_ms, u16::MAX);
    assert!(matches!(record.sector(), Sector::Free { age_ms: 65_535, .. }));
    assert_eq!(SectorRecord::new(3, Sector::Unknown, None), None);
    assert_eq!(SectorRecord::new(3, Sector::Outside, None), None);

    // Nothing known: a host learns that, too.
    let none = received(|mut write| send_sectors(8, &plan, &Obstacles::new(), 0, &mut write));
    let list = heapless::Vec::new();
    assert_eq!(none, [Message::Sectors(Sectors { sequence: 8, turn: 72, list })]);
}

/// An object of arbitrary bits; every third is refused.
fn any_object(random: &mut Random, label: u16) -> Result<ObjectDepth, NoDepth> {
    let disparity = Disparity::from_bits(random.next() as i16);
    let reason = Reason::ALL[random.below(Reason::ALL.len())];
    let mut metres = || Depth::from_bits(random.next() as i32);
    let metres = ObjectMetres { depth: metres(), sigma: metres(), nearest: metres() };
    let support = random.next() as u16;
    if label.is_multiple_of(3) {
        return Err(NoDepth { reason, support });
    }
    Ok(ObjectDepth {
        disparity,
        sigma: Disparity::from_bits(random.next() as i16),
        slope_q10: [random.next() as i16, random.next() as i16],
        spread: Disparity::from_bits(random.next() as i16),
        metres: (random.below(2) == 0).then_some(metres),
        support,
        confidence: Confidence::from_bits(random.next() as u16),
    })
}

#[test]
fn objects_of_any_bits_come_back_equal() {
    let mut random = Random(31);
    for length in [0, 1, OBJECTS_PER_PACKET, OBJECTS_PER_PACKET + 1, 60] {
        let objects: Vec<_> =
            (0..length as u16).map(|label| (label, any_object(&mut random, label))).collect();
        let records: Vec<_> =
            objects.iter().map(|(label, object)| ObjectRecord::new(*label, object)).collect();
        let messages = received(|mut write| send_objects(9, &records, &mut write));
        assert_eq!(messages.len(), length.div_ceil(OBJECTS_PER_PACKET));
        let mut back = Vec::new();
        for message in messages {
            let Message::Objects(Objects { sequence: 9, list }) = message else {
                panic!("{message:?}")
            };
            back.extend(list.iter().map(|record| (record.label, record.depth())));
        }
        assert_eq!(back, objects);
    }
    // A reason of a later version is one that claims nothing.
    let record = ObjectRecord::new(1, &any_object(&mut random, 1));
    let unknown = ObjectRecord { disparity_q6: Err(200), ..record }.depth();
    assert_eq!(unknown.map_err(|error| error.reason), Err(Reason::LittleSupport));
}

#[test]
fn matches_of_any_bits_come_back_in_order() {
    let mut random = Random(1);
    let full = SEGMENTS_PER_PACKET;
    for length in [0, 1, full - 1, full, full + 1, 174] {
        let matches: Vec<_> = (0..length).map(|_| any_match(&mut random)).collect();
        let messages = received(|mut write| send_frame(&head(8, 0), &matches, &mut write));
        assert_eq!(messages.len(), 1 + length.div_ceil(full));
        let mut messages = messages.into_iter();
        assert_eq!(messages.next(), Some(Message::Frame(head(8, length as u16))));
        let mut back = Vec::new();
        for message in messages {
            let Message::Segments(Segments { sequence: 8, first, list }) = message else {
                panic!("{message:?}")
            };
            assert_eq!(usize::from(first), back.len());
            back.extend(list);
        }
        assert_eq!(back, matches);
    }
}

#[test]
fn points_of_any_bits_come_back_in_order() {
    let mut random = Random(32);
    for length in [0, 1, POINTS_PER_PACKET - 1, POINTS_PER_PACKET, POINTS_PER_PACKET + 1, 100] {
        let mut point = || Point {
            x: random.next() as u16,
            y: random.next() as u16,
            disparity: Disparity::from_bits(random.next() as i16),
            confidence: Confidence::from_bits(random.next() as u16),
            source: [Source::Side, Source::Segment(random.next() as u16), Source::Support]
                [random.below(3)],
        };
        let points: Vec<Point> = (0..length).map(|_| point()).collect();
        let messages = received(|mut write| {
            let mut stream = PointStream::new(9);
            points.iter().try_for_each(|point| stream.push(point, &mut write))?;
            stream.finish(&mut write)
        });
        assert_eq!(messages.len(), length.div_ceil(POINTS_PER_PACKET));
        let mut back = Vec::new();
        for message in messages {
            let Message::Points(Points { sequence: 9, first, list }) = message else {
                panic!("{message:?}")
            };
            assert_eq!(first as usize, back.len());
            back.extend(list);
        }
        assert_eq!(back, points);
    }
}

#[test]
fn the_health_of_a_pair_is_in_its_head() {
    let pair = PairHealth {
        flags: HealthFlags::TORN,
        cameras: [camera(1), camera(6)],
        skew_us: Some(7),
        rows: Some(Rows { offset_q8: -8, spread_q8: 9, samples: 10 }),
        row_offset_q8: Some(-11),
        row_drift_q8: Some(12),
        least_disparity_q6: Some(-13),
        noise: Some([Noise { deviation_q4: 18, noiseless_permille: 19 }, Noise::default()]),
        still: Some(Still { still_permille: 14, pattern_permille: -15 }),
        tear: Some(Tear { row: 16, shift: -17 }),
        ..PairHealth::default()
    };
    let dims = Dims { width: 96, height: 64 };
    let head =
        FrameHead::new(1, 2, dims, Health::FREE_RUNNING, &linestereo::results::Counts::default())
            .with_pair(&pair);
    assert_eq!(head.health, Health::FREE_RUNNING | HealthFlags::TORN.into());
    assert_eq!(head.health.of_pair(), HealthFlags::TORN);
    assert_eq!(format!("{:?}", head.health), "Health(free_running+torn)");
    let expected = PairReport {
        cameras: pair.cameras,
        skew_us: Some(7),
        rows: pair.rows,
        row_offset_q8: Some(-11),
        row_drift_q8: Some(12),
        least_disparity_q6: Some(-13),
        range: None,
        noise: pair.noise,
        still: pair.still,
        tear: pair.tear,
    };
    assert_eq!(head.pair, Some(expected));
}

#[test]
fn settings_take_their_range_and_nothing_else() {
    for (number, setting) in (0..).zip(Setting::ALL) {
        let Setting { name, least, largest, is_whole } = setting;
        for (value, is_taken) in [
            (least, true),
            (largest, true),
            (least - 0.5, false),
            (largest + 0.5, false),
            (f32::NAN, false),
            (f32::INFINITY, false),
            (0.5 * least + 0.5 * largest + 0.25, !is_whole),
        ] {
            assert_eq!(setting.takes(value), is_taken, "{name} {value}");
            let refused =
                |why: Refusal| matches!(why, Refusal::Setting { number: of, .. } if of == number);
            match Setting::check(number, value) {
                Ok(()) => assert!(is_taken, "{name} {value}"),
                Err(why) => assert!(!is_taken && refused(why), "{name} {value}"),
            }
        }
        assert_eq!(Setting::number(name.to_ascii_uppercase().as_bytes()), Some(number));
    }
    assert_eq!(Setting::check(SETTINGS as u8, 0.0), Err(Refusal::Unsupported));
    assert_eq!(Setting::number(b"cel"), None);
}
