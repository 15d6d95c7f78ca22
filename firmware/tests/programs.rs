//! The programs `replay` and `live` on a PC, with fakes for what a board has.

use crate::support::flash::Flash;
use crate::support::live::{DIMS, Running, rig_numbers, scripted};
use crate::support::port::{Port, heads, mavlink_frames};
use core::cell::Cell;
use linestereo::health::{HealthFlags, Skewed};
use linestereo::{Dims, Matcher, Options, Params, results::Match};
use linestereo_boards::built_in::Scene;
use linestereo_firmware::boards::NODES;
use linestereo_firmware::boards::mps2_an386::{BOARD, BoardMemory};
use linestereo_firmware::memory::Memory;
use linestereo_firmware::painter::Painter;
use linestereo_firmware::ports::{ByteSink as _, CapturedPair, FrameStart, PairSource as _};
use linestereo_firmware::programs::replay::{self, Event};
use linestereo_firmware::session::Session;
use linestereo_rig::{Band, Calibration, Camera, CameraSide, Lens, Mesh, RigImage, View};
use linestereo_wire::*;
use std::collections::BTreeSet;

fn pair_head(dims: Dims, capture_time_us: u64) -> PairHead {
    PairHead {
        width: dims.width,
        height: dims.height,
        capture_time_us,
        right_capture_time_us: None,
    }
}

fn painted(dims: Dims, scene: Scene) -> [Vec<u8>; 2] {
    let pixels = usize::from(dims.width) * usize::from(dims.height);
    let (mut left, mut right) = (vec![0; pixels], vec![0; pixels]);
    scene.paint(dims, &mut left, &mut right);
    [left, right]
}

/// Bytes of a host: commands, numbered from 1, and pixels.
#[derive(Clone, Default)]
struct Input {
    bytes: Vec<u8>,
    count: u16,
}

impl Input {
    fn ask(mut self, request: Request) -> Self {
        self.count += 1;
        let command = Command { id: self.count, request };
        self.bytes.push(DELIMITER);
        self.bytes.extend_from_slice(encode(&command, &mut [0; MAX_COMMAND]).unwrap());
        self
    }

    fn pixels(mut self, pixels: impl IntoIterator<Item = u8>) -> Self {
        self.bytes.extend(pixels);
        self
    }

    fn pair(self, dims: Dims, scene: Scene) -> Self {
        let head = pair_head(dims, 1000 * u64::from(self.count + 1));
        self.ask(Request::Pair(head)).pixels(painted(dims, scene).concat())
    }

    /// A raw pair, its rows in turn.
    fn raw(self, dims: Dims, scene: Scene) -> Self {
        let [left, right] = painted(dims, scene);
        let width = usize::from(dims.width);
        let rows = left.chunks(width).zip(right.chunks(width));
        let rows = rows.flat_map(|(left, right)| [left, right].concat());
        self.ask(Request::RawPair(pair_head(dims, 0))).pixels(rows)
    }

    fn rig(self, image: &[u8]) -> Self {
        self.ask(Request::SetRig(image.iter().copied().collect()))
    }
}

/// Output of `replay` for this input, which comes in pieces of so many bytes.
fn replay(
    session: &mut Session<'_>,
    memory: &mut BoardMemory,
    input: Input,
    step: usize,
) -> (Port, Counters, Vec<Event>) {
    let (port, mut events) = (Port::holding(input.bytes, step), Vec::new());
    let (mut source, mut sink) = (port.clone(), port.clone());
    let report = |event: &Event| events.push(event.clone());
    let counters = replay::run(memory, &port, session, &mut source, &mut sink, |_, _| (), report);
    (port, counters, events)
}

/// Depths of objects from the board, pair by pair.
fn objects(messages: &[Message]) -> Vec<Vec<ObjectRecord>> {
    let mut pairs = Vec::new();
    for message in messages {
        match message {
            Message::Frame(_) => pairs.push(Vec::new()),
            Message::Objects(objects) => pairs.last_mut().unwrap().extend(&objects.list),
            _ => {}
        }
    }
    pairs
}

/// Segments of a frame, in order.
fn segments(messages: &[Message], sequence: u32) -> Vec<Match> {
    let mut all = Vec::new();
    for message in messages {
        if let Message::Segments(part) = message
            && part.sequence == sequence
        {
            assert_eq!(usize::from(part.first), all.len());
            all.extend(part.list.clone());
        }
    }
    all
}

#[test]
fn objects_that_are_asked_for_come_with_every_pair() {
    let boxes = [(7, 20, 20, 90, 70), (9, 60, 30, 150, 110), (300, 0, 0, 160, 120)];
    let boxes = boxes.map(|(label, left, top, right, bottom)| RegionBox {
        label,
        left,
        top,
        right,
        bottom,
    });
    let regions = |only| Request::SetRegions(Regions { boxes: boxes.into_iter().collect(), only });
    let outside = RegionBox { left: 160, right: 200, ..boxes[0] };
    let wrong = Regions { boxes: [boxes[0], outside].into_iter().collect(), only: true };
    let input = Input::default()
        .ask(regions(false))
        .pair(DIMS, Scene::Bricks)
        .ask(regions(true))
        .pair(DIMS, Scene::Blocks)
        .ask(Request::SetRegions(wrong))
        .pair(DIMS, Scene::Bricks) // what was refused changed nothing
        .ask(Request::SetRegions(Regions::default()))
        .pair(DIMS, Scene::Blocks);

    let messages = replay(&mut Session::new(BOARD), &mut Box::new(BoardMemory::CLEARED), input, 64)
        .0
        .received();
    let found = objects(&messages);
    let refused =
        Message::Answer(Answer { command: 5, outcome: Outcome::Refused(Refusal::Region(1)) });
    assert!(messages.contains(&refused));
    assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [3, 3, 3, 0]);

    let mut twin = Box::new(BoardMemory::CLEARED);
    let regions = boxes.map(|of| of.region(DIMS).unwrap());
    let areas = regions.map(|region| region.area());
    let mut matcher = Matcher::new(Params::DEFAULT, DIMS).unwrap();
    for (scene, found) in [Scene::Bricks, Scene::Blocks].into_iter().zip(&found) {
        let [left, right] = twin.frames();
        scene.paint(DIMS, left, right);
        // The second pair is matched around the boxes alone, by the rows of the first.
        let options = Options { areas: Some(&areas), ..Options::default() };
        let mut matched = twin.run(None, &mut matcher, options).unwrap();
        let expected =
            regions.map(|region| ObjectRecord::new(region.label(), &matched.object(&region)));
        assert!(*found == expected[..], "{found:?} instead of {expected:?}");
    }
    assert!(found[0].iter().any(|object| object.disparity_q6.is_ok()), "{:?}", found[0]);
}

#[test]
fn replay_gives_the_same_however_the_bytes_arrive() {
    let mut input = Input::default()
        .pixels(*b"noise before the first command")
        .ask(Request::Describe)
        .pair(DIMS, Scene::Blocks)
        .pair(Dims { width: 161, height: 100 }, Scene::Noise)
        .pair(DIMS, Scene::Bricks);
    input.bytes.pop();
    input = input.ask(Request::Stop); // the delimiter before it is taken for the last pixel
    let mut outputs = Vec::new();
    for step in [1, 7, 256, usize::MAX] {
        let (port, counters, events) = replay(
            &mut Session::new(BOARD),
            &mut Box::new(BoardMemory::CLEARED),
            input.clone(),
            step,
        );
        assert_eq!((counters.good, counters.bad()), (5, 1), "{counters:?}");
        assert!(matches!(
            events[..],
            [
                Event::Matched { sequence: 0, .. },
                Event::Refused { sequence: 1, .. },
                Event::Matched { sequence: 2, .. }
            ]
        ));
        outputs.push(port.received());
    }
    assert!(outputs.iter().all(|output| *output == outputs[0]));

    let mut memory = Box::new(BoardMemory::CLEARED);
    let [left, right] = memory.frames();
    Scene::Blocks.paint(DIMS, left, right);
    let mut matcher = Matcher::new(Params::DEFAULT, DIMS).unwrap();
    let (mut points, mut answers) = (Vec::new(), Vec::new());
    let messages = outputs.swap_remove(0);
    for message in &messages {
        match message {
            Message::Hello(hello) => {
                assert_eq!((hello.largest_width, hello.largest_height), (160, 120))
            }
            Message::Points(list) if list.sequence == 0 => {
                assert_eq!(list.first as usize, points.len());
                points.extend(list.list.clone());
            }
            Message::Answer(answer) => answers.push((answer.command, answer.outcome.clone())),
            Message::Frame(_) | Message::Segments(_) | Message::Points(_) => {}
            other => panic!("nobody asked for {other:?}"),
        }
    }
    let mut matched = memory.run(None, &mut matcher, Options::default()).unwrap();
    let listed: Vec<_> = matched.points().collect();
    assert!(
        points == listed && !listed.is_empty(),
        "{} points instead of {}",
        points.len(),
        listed.len()
    );
    assert_eq!(segments(&messages, 0), matched.segments());
    let times_us: Vec<_> = heads(&messages).iter().map(|head| head.capture_time_us).collect();
    assert_eq!(times_us, [2000, 4000]);
    let name: Name = "width".try_into().unwrap();
    let too_wide = Refusal::OutOfRange { name, value: 161, low: 16, high: 160 };
    let expected = [
        (1, Outcome::Accepted),
        (2, Outcome::Accepted),
        (3, Outcome::Refused(too_wide)),
        (4, Outcome::Accepted),
        (5, Outcome::Accepted),
    ];
    assert_eq!(answers, expected);
}

const RAW: Dims = Dims { width: 200, height: 150 };

/// A rig with barrel distortion, a turned right camera and this rectified size.
fn rig(rectified: Dims) -> RigImage {
    let lens = Lens::BrownConrady { k: [-0.2, 0.03, 0.0], p: [1e-3, 0.0] };
    let camera = |cx| Camera::new(RAW, [170.0, 171.0], [cx, 74.0], 0.0, lens).unwrap();
    let turned = [0.9999, 0.002, 0.004, 0.01];
    let calibration =
        Calibration::new(camera(99.0), camera(101.0), turned, [-0.07, 0.0, 0.0]).unwrap();
    RigImage::new(calibration, rectified, View::default(), (0, 40)).unwrap()
}

/// Answers of `replay`: by command, and the frames.
fn replayed(
    session: &mut Session<'_>,
    memory: &mut BoardMemory,
    input: Input,
) -> (Vec<(u16, Outcome)>, Vec<Message>) {
    let (port, counters, _) = replay(session, memory, input, 97);
    assert_eq!(counters.bad(), 0);
    let (mut answers, mut others) = (Vec::new(), Vec::new());
    for message in port.received() {
        match message {
            Message::Answer(answer) => answers.push((answer.command, answer.outcome)),
            other => others.push(other),
        }
    }
    (answers, others)
}

#[test]
fn raw_pairs_are_rectified_row_by_row() {
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut session = Session::new(BOARD);
    let input = Input::default()
        .raw(RAW, Scene::Blocks)
        .rig(&rig(DIMS).encode(0))
        .raw(RAW, Scene::Blocks)
        .raw(DIMS, Scene::Blocks)
        .raw(RAW, Scene::Blocks);
    let (answers, frames) = replayed(&mut session, &mut memory, input);
    let wrong_size = Refusal::RawSize { needed: [200, 150], given: [128, 96] };
    let expected = [
        (1, Outcome::Refused(Refusal::NoRig)),
        (2, Outcome::Accepted),
        (3, Outcome::Accepted),
        (4, Outcome::Refused(wrong_size)),
        (5, Outcome::Accepted),
    ];
    assert_eq!(answers, expected);

    // The same frames, rectified whole.
    let image = rig(DIMS);
    let mut twin = Box::new(BoardMemory::CLEARED);
    for (eye, raw) in CameraSide::BOTH.into_iter().zip(painted(RAW, Scene::Blocks)) {
        let mut mesh: Box<Mesh<NODES, 96>> = Box::new(Mesh::new());
        let mut band: Box<Band<{ 200 * 150 }>> = Box::new(Band::new());
        mesh.build(image.remap(), eye).unwrap();
        for row in raw.chunks(200) {
            band.push(&mesh, row, twin.frames()[eye as usize]).unwrap();
        }
    }
    let mut matcher = Matcher::new(image.params(Params::DEFAULT).unwrap(), DIMS).unwrap();
    let expected = twin.run(None, &mut matcher, Options::default()).unwrap().segments().to_vec();
    assert!(
        expected.len() > 3 && expected.iter().all(|found| found.depth.is_some()),
        "{}",
        expected.len()
    );
    assert_eq!(segments(&frames, 1), expected);
    assert_eq!(segments(&frames, 3), [], "both images are those of the pair before: frozen");
    assert!(heads(&frames).iter().all(|head| (head.width, head.height) == (128, 96)));
}

#[test]
fn what_is_no_rig_for_this_board_is_refused_and_the_old_one_stays() {
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut session = Session::new(BOARD);
    let good = rig(DIMS).encode(0);
    let mut damaged = good;
    damaged[50] ^= 8;
    let too_wide = rig(Dims { width: 192, height: 96 }).encode(0);
    // A band that holds most of the image: the cameras are rolled against each other by 20 degrees.
    let camera =
        Camera::new(Dims { width: 640, height: 480 }, [500.0; 2], [320.0, 240.0], 0.0, Lens::NONE)
            .unwrap();
    let rolled =
        Calibration::new(camera, camera, [0.9848, 0.0, 0.0, 0.1736], [-0.1, 0.0, 0.0]).unwrap();
    let rolled = RigImage::new(rolled, DIMS, View::default(), (0, 40)).unwrap().encode(0);
    let images = [&good[..], &damaged, &good[..100], b"rubbish", &[], &too_wide, &rolled];
    let input = images.into_iter().fold(Input::default(), Input::rig);
    let input = input.raw(RAW, Scene::Bricks).ask(Request::Describe);
    let (answers, frames) = replayed(&mut session, &mut memory, input);
    let texts: Vec<String> = answers
        .iter()
        .map(|(_, outcome)| match outcome {
            Outcome::Accepted => "accepted".to_owned(),
            Outcome::Refused(why) => why.to_string(),
        })
        .collect();
    assert_eq!(
        texts[..6],
        [
            "accepted", "the rig image is refused: damaged", "the rig image is refused: truncated",
            "the rig image is refused: foreign", "the rig image is refused: truncated",
            "width is 192 but must be 16 to 160",
        ]
    );
    assert!(texts[6].starts_with("band of the board's memory holds "), "{}", texts[6]);
    assert_eq!(texts[7..], ["accepted", "accepted"]);
    let hello = frames
        .iter()
        .find_map(|message| if let Message::Hello(hello) = message { Some(hello) } else { None });
    assert_eq!(
        hello.unwrap().rig.to_string(),
        "rig: 200x150 rectified to 128x96; no flash to keep one"
    );
}

#[test]
fn a_rig_is_kept_where_there_is_flash() {
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut damaged = rig(DIMS).encode(7);
    damaged[50] ^= 8;
    let mut store = Flash::with_second_rig(&damaged).store();
    let mut session = Session::with_flash(BOARD, &mut store, &mut *memory);
    assert_eq!(session.hello().rig.to_string(), "rig: none; slots: empty, damaged");
    let input = Input::default().rig(&rig(DIMS).encode(0));
    let (answers, _) = replayed(&mut session, &mut memory, input);
    assert_eq!(answers, [(1, Outcome::Accepted)]);
    // One after the number of the damaged one.
    let expected = "rig: 200x150 rectified to 128x96; slots: image 8 (in use), damaged";
    assert_eq!(session.hello().rig.to_string(), expected);

    // After a reset.
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut session = Session::with_flash(BOARD, &mut store, &mut *memory);
    assert_eq!(session.hello().rig.to_string(), expected);
    let raw = Input::default().raw(RAW, Scene::Blocks);
    let (answers, frames) = replayed(&mut session, &mut memory, raw);
    assert_eq!(answers, [(1, Outcome::Accepted)]);
    assert!(frames.len() > 1);

    // Flash that does not keep: nothing changes.
    let mut flash = store.into_flash();
    flash.is_worn = true;
    let mut store = flash.store();
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut session = Session::with_flash(BOARD, &mut store, &mut *memory);
    let other = rig(Dims { width: 100, height: 80 }).encode(0);
    let other = Input::default().rig(&other).raw(RAW, Scene::Blocks);
    let (answers, again) = replayed(&mut session, &mut memory, other);
    assert_eq!(answers, [(1, Outcome::Refused(Refusal::NotKept)), (2, Outcome::Accepted)]);
    assert_eq!(again, frames);
    assert_eq!(session.hello().rig.to_string(), expected);

    // A rig that another firmware left and this board cannot hold.
    let large = rig(Dims { width: 320, height: 240 });
    let mut store = Flash::with_second_rig(&large.encode(3)).store();
    let session = Session::with_flash(BOARD, &mut store, &mut *memory);
    assert_eq!(
        session.hello().rig.to_string(),
        "rig: none; slots: empty, too large for this board"
    );
}

/// A camera with a loose cable: no pair, a pair of a wrong size, one with a late right image, then
/// painted ones.
fn loose(call: u32, paint: &mut dyn FnMut() -> Option<CapturedPair>) -> Option<CapturedPair> {
    match call {
        1 => None,
        2 => Some(CapturedPair::of(Dims { width: 320, height: 240 })),
        3 => Some(CapturedPair {
            times_us: Some([7_000_000, 7_002_500]),
            frame_start: Some(FrameStart::Free),
            ..paint()?
        }),
        _ => paint(),
    }
}

#[test]
fn live_serves_commands_and_survives_its_camera() {
    let mut board = Running::start(Session::new(BOARD), &Port::with_look(1), scripted(loose));
    let hello = board.port.received();
    assert!(matches!(&hello[..], [Message::Hello(hello)] if hello.board == BOARD.name));
    assert_eq!(board.messages(1), []); // nobody asked

    let accepted = |command| Message::Answer(Answer { command, outcome: Outcome::Accepted });
    let answers = board.ask(1, Request::Start);
    assert_eq!(answers[0], accepted(1));
    assert!(matches!(&answers[1..], [Message::Frame(head)] if head.health == Health::PAIR_MISSING));
    let wrong = board.messages(1);
    assert!(matches!(wrong[..], [Message::Frame(head)] if head.health == Health::SIZE_MISMATCH));
    let skewed = board.messages(1);
    let [Message::Frame(head)] = skewed[..] else {
        panic!("a head alone was expected: {skewed:?}")
    };
    assert_eq!((head.sequence, head.segments, head.capture_time_us), (2, 0, 7_000_000));
    assert!(head.health.of_pair().contains(HealthFlags::SKEW), "{}", head.health);
    assert_eq!(head.pair.unwrap().skew_us, Some(2500));
    assert!(head.health.contains(Health::FREE_RUNNING), "{}", head.health);
    let frame = board.messages(1);
    let Message::Frame(head) = &frame[0] else { panic!("no frame: {frame:?}") };
    assert_eq!((head.sequence, head.width), (3, 128));
    assert!(head.pair.unwrap().skew_us.is_none() && head.pair.unwrap().cameras[0].level > 0);
    // Three pairs without the fault clear its flag: until then there are no results.
    assert!(
        head.segments == 0
            && head.capture_time_us > 0
            && head.health.of_pair().contains(HealthFlags::SKEW)
    );
    assert_eq!(frame.len(), 1 + usize::from(head.segments).div_ceil(SEGMENTS_PER_PACKET));

    let pair = Request::Pair(pair_head(Dims { width: 16, height: 16 }, 0));
    assert_eq!(
        board.ask(2, pair)[0],
        Message::Answer(Answer { command: 2, outcome: Outcome::Refused(Refusal::Unsupported) })
    );
    assert_eq!(board.ask(3, Request::Stop), [accepted(3)]);
}

#[test]
fn of_what_takes_long_there_is_one_a_turn() {
    let image = rig(DIMS).encode(0);
    let input = Input::default()
        .rig(&image)
        .rig(&image)
        .ask(Request::Photograph)
        .ask(Request::Photograph)
        .ask(Request::Stop)
        .ask(Request::Describe);
    let port = Port::holding(input.bytes, 0);
    let mut board = Running::start(Session::new(BOARD), &port, Painter::new(DIMS));
    // The watchdog is fed between two turns, and waits for one sector that is erased, not for two.
    let mut answered_in = Vec::new();
    for turn in 0..200 {
        for message in board.messages(1) {
            if let Message::Answer(answer) = message {
                answered_in.push((turn, answer.command));
            }
        }
    }
    let commands: Vec<u16> = answered_in.iter().map(|&(_, command)| command).collect();
    assert_eq!(commands, [1, 2, 3, 4, 5, 6], "nothing is lost");
    let slow: BTreeSet<usize> = answered_in.iter().take(4).map(|&(turn, _)| turn).collect();
    assert_eq!(slow.len(), 4, "{answered_in:?}");
}

#[test]
fn a_range_beyond_the_width_of_the_rig_is_refused() {
    let set = |value| Request::Set(SettingValue { number: 1, value }); // MAX_DISPARITY
    let input = Input::default().ask(set(150.0)).rig(&rig(DIMS).encode(0));
    let input = input.ask(set(130.0)).ask(set(100.0));
    let update = ParamUpdate { max_disparity: Some(130), ..ParamUpdate::default() };
    let input = input.ask(Request::SetParams(update));
    let (answers, _) =
        replayed(&mut Session::new(BOARD), &mut Box::new(BoardMemory::CLEARED), input);
    let is_accepted = answers.iter().map(|(_, outcome)| *outcome == Outcome::Accepted);
    assert_eq!(is_accepted.collect::<Vec<_>>(), [true, true, false, true, false], "{answers:?}");
}

/// Times that a still scene allows are none for an autopilot.
#[test]
fn a_pair_of_two_moments_is_matched_where_nothing_moves() {
    for (still_us, is_matched) in [(None, false), (Some(21_000), false), (Some(30_000), true)] {
        let mut camera =
            scripted(|_, paint| Some(CapturedPair { times_us: Some([5_000, 27_000]), ..paint()? }));
        camera.still_us = still_us;
        let (port, autopilot) = (Port::with_look(1), Port::default());
        let mut board =
            Running::start(Session::new(BOARD), &port, camera).with_autopilot(&autopilot);
        let numbers = RigUpdate { focal_px: 110.0, baseline_m: 0.1, offset_px: 0.0 };
        port.send(1, rig_numbers(numbers));
        let head = heads(&board.ask(2, Request::Start))[0];
        board.turns(2);
        let told = mavlink_frames(&autopilot.bytes());
        let critical = told.iter().find(|(id, _)| *id == 0).map(|(_, heartbeat)| heartbeat[7] == 5);
        assert_eq!(critical, is_matched.then_some(true), "without a view nothing is sent");
        assert_eq!(head.pair.unwrap().skew_us, Some(22_000), "it is told all the same");
        assert_eq!(
            (head.segments > 10, head.health.of_pair().contains(HealthFlags::SKEW)),
            (is_matched, !is_matched)
        );
    }
}

#[test]
fn a_pair_of_two_moments_is_refused_and_named_for_a_while() {
    let [left, right] = painted(DIMS, Scene::Blocks);
    let mut input = Input::default();
    for (changed, skew_us) in (0..).zip([None, Some(1001), Some(1000), Some(0), Some(7)]) {
        let capture_time_us = 50_000 * (1 + u64::from(changed));
        let right_capture_time_us = skew_us.map(|skew_us| capture_time_us - skew_us);
        let head = PairHead { right_capture_time_us, ..pair_head(DIMS, capture_time_us) };
        // A sensor never gives the same picture twice.
        let pixels = [&left, &right].into_iter().flatten().map(|&grey| grey + changed);
        input = input.ask(Request::Pair(head)).pixels(pixels);
    }
    let (port, ..) =
        replay(&mut Session::new(BOARD), &mut Box::new(BoardMemory::CLEARED), input, 256);
    let (mut heads, mut refused) = (Vec::new(), Vec::new());
    for message in port.received() {
        match message {
            Message::Frame(head) => {
                heads.push((head.sequence, head.pair.unwrap().skew_us, head.health.of_pair()))
            }
            Message::Answer(Answer { command, outcome: Outcome::Refused(why) }) => {
                refused.push((command, why))
            }
            _ => {}
        }
    }
    assert_eq!(refused, [(2, Refusal::Skewed(Skewed { skew_us: 1001, limit_us: 1000 }))]);
    let (good, skew) = (HealthFlags::GOOD, HealthFlags::SKEW);
    assert_eq!(
        heads,
        [(0, None, good), (2, Some(1000), skew), (3, Some(0), skew), (4, Some(7), good)]
    );
}

#[test]
fn live_tells_an_autopilot_as_soon_as_there_is_a_rig_and_blocks_without_pairs() {
    // A look at the clock takes 8.5 ms, a turn with a pair four looks: 60 turns are two seconds.
    let (port, autopilot) = (Port::with_look(8_500), Port::default());
    // But for questions of the time.
    let told = || {
        let mut frames = mavlink_frames(&autopilot.bytes());
        frames.retain(|(id, _)| *id != 111);
        frames
    };
    let is_silent = Cell::new(false);
    let camera = scripted(|call, paint| if is_silent.get() { None } else { loose(call, paint) });
    let mut board = Running::start(Session::new(BOARD), &port, camera).with_autopilot(&autopilot);
    board.turns(5);
    assert_eq!(told(), [], "without a rig nothing has a distance");
    port.send(1, rig_numbers(RigUpdate { focal_px: 110.0, baseline_m: 0.1, offset_px: 0.0 }));
    port.bytes();

    // No pair, a pair of a wrong size and a skewed one come first: no view is known yet.
    board.turns(3);
    assert_eq!(told(), []);
    let answers = board.messages(60);
    assert!(matches!(answers[..], [Message::Answer(_)]), "no host asked for results: {answers:?}");
    let frames = told();
    let (beats, distances): (Vec<_>, Vec<_>) = frames.iter().partition(|(id, _)| *id == 0);
    assert!(beats.len() == 2 || beats.len() == 3, "{} heartbeats in 2 s", beats.len());
    assert!((20..=31).contains(&distances.len()), "{} messages in 2 s at 15 Hz", distances.len());
    let sectors = |payload: &[u8]| -> Vec<u16> {
        payload[8..152].chunks(2).map(|bytes| u16::from_le_bytes([bytes[0], bytes[1]])).collect()
    };
    let known = distances.iter().any(|(id, payload)| {
        assert_eq!(*id, 330);
        let list = sectors(payload);
        assert!(list[10..62].iter().all(|&cm| cm == u16::MAX), "outside of the view: {list:?}");
        assert!(list.iter().all(|&cm| cm > 0));
        list.iter().any(|&cm| cm != u16::MAX)
    });
    assert!(known, "the painted scenes have something at a distance");

    // The camera falls silent: every sector in view is blocked at the near limit, 11 m px by 62.5
    // px.
    is_silent.set(true);
    board.turns(8);
    let list = sectors(&told().iter().rfind(|(id, _)| *id == 330).unwrap().1);
    assert_eq!((list[0], list[5], list[67], list[36]), (18, 18, 18, u16::MAX));
}

/// A host that fetches less than the board sends: frames come whole or not at all, and what is
/// missing is known.
#[test]
fn a_slow_host_gets_whole_frames_and_knows_what_it_misses() {
    let port = Port::with_capacity(6000);
    let mut session = Session::new(BOARD);
    // The picture stays, and is small.
    session.limits.frozen_pairs = u8::MAX;
    session.limits.unwitnessed_permille = 0;
    let mut board = Running::start(session, &port, Painter::new(DIMS));
    port.send(1, Request::Start);
    let (mut decoder, mut heads, mut expected) =
        (Decoder::<Message, MAX_PACKET>::new(), Vec::new(), 0);
    for _ in 0..200 {
        board.turn();
        for byte in port.fetch(100) {
            match decoder.push(byte) {
                Some(Ok(Message::Frame(head))) => {
                    assert_eq!(expected, 0, "a frame in pieces before {}", head.sequence);
                    expected = head.segments;
                    heads.push(head);
                }
                Some(Ok(Message::Segments(part))) => expected -= part.list.len() as u16,
                Some(Err(error)) => panic!("{error}"),
                _ => {}
            }
        }
        assert!(port.room().free > 0, "it waits");
    }
    assert!(heads.len() > 5, "{}", heads.len());
    let mut gaps = 0;
    for pair in heads.windows(2) {
        let is_gap = pair[1].sequence > pair[0].sequence + 1;
        assert_eq!(pair[1].health.contains(Health::RESULTS_SKIPPED), is_gap, "{pair:?}");
        gaps += u32::from(is_gap);
    }
    assert!(gaps > 2, "{gaps} of {}", heads.len());
}

#[test]
fn a_photograph_is_no_pair_to_an_autopilot() {
    let (port, autopilot) = (Port::with_look(17_000), Port::default());
    let mut board =
        Running::start(Session::new(BOARD), &port, Painter::new(DIMS)).with_autopilot(&autopilot);
    port.send(1, rig_numbers(RigUpdate { focal_px: 110.0, baseline_m: 1.0, offset_px: 0.0 }));
    // All directions are blocked at the near limit, as without pairs.
    let is_blocked = || {
        let messages = mavlink_frames(&autopilot.bytes());
        let last = messages.iter().rfind(|(id, _)| *id == 330);
        last.is_none_or(|(_, last)| {
            [0, 5, 67].iter().all(|sector| last[8 + 2 * sector..][..2] == last[152..154])
        })
    };
    let seen = (0..100).any(|_| {
        board.turn();
        !is_blocked()
    });
    assert!(seen, "the painted scenes have something at a distance");
    port.send(2, Request::Photograph);
    board.turns(5);
    assert!(is_blocked());
}

#[test]
fn a_photograph_that_fails_ends_the_one_before() {
    let port = Port::with_look(1);
    let mut camera = scripted(|call, paint| if call == 1 { paint() } else { None });
    camera.clock_us = Some(5_000_000);
    let mut board = Running::start(Session::new(BOARD), &port, camera);
    port.send(1, Request::Photograph);
    board.turn();
    port.send(2, Request::Photograph);
    let messages = board.messages(20);
    let is_refused = |message: &&Message| {
        matches!(message, Message::Answer(Answer { outcome: Outcome::Refused(_), .. }))
    };
    assert_eq!(messages.iter().filter(is_refused).count(), 1);
    let pixels: usize = messages
        .iter()
        .map(|message| if let Message::Pixels(part) = message { part.list.len() } else { 0 })
        .sum();
    assert!(pixels < 2 * 128 * 96, "a torn photograph came as a whole one");
    // Pairs that are missing have the time of those that come.
    let last = board.ask(3, Request::Start);
    assert!(
        matches!(last.last(), Some(Message::Frame(head)) if head.capture_time_us == 5_000_000),
        "{last:?}"
    );
}

#[test]
fn a_new_rig_starts_anew() {
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut session = Session::new(BOARD);
    assert!(Painter::new(DIMS).next_pair(&mut *memory, None).is_some());
    memory.run(None, session.matcher(DIMS).unwrap(), Options::default()).unwrap();
    assert!(session.matcher(DIMS).unwrap().knows_rows());
    let request = Request::SetRig(rig(DIMS).encode(0).into_iter().collect());
    session.command(&Command { id: 1, request }, &mut *memory);
    assert!(!session.matcher(DIMS).unwrap().knows_rows());
}
