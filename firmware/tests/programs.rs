//! The programs `replay` and `live` on a PC, with fakes for what a board has.

use core::cell::{Cell, RefCell};
use linestereo::{Dims, HealthFlags};
use linestereo_firmware::boards::mps2_an386::{BOARD, Workspace};
use linestereo_firmware::memory::Memory;
use linestereo_firmware::painter::Scene;
use linestereo_firmware::ports::{ByteSink, ByteSource, CapturedPair, Clock, PairSource};
use linestereo_firmware::programs::live::{Live, Painter};
use linestereo_firmware::programs::replay::{self, Event};
use linestereo_firmware::session::Session;
use linestereo_wire::*;
use std::collections::VecDeque;

const DIMS: Dims = Dims { width: 128, height: 96 };

/// A microsecond passes with every look.
#[derive(Default)]
struct Microseconds(Cell<u32>);

impl Clock for Microseconds {
    const UNIT: &'static str = "microseconds";

    fn now(&self) -> u32 {
        self.0.set(self.0.get().wrapping_add(1));
        self.0.get()
    }

    fn elapsed(&self, from: u32, to: u32) -> u64 {
        to.wrapping_sub(from).into()
    }

    fn microseconds(&self, from: u32, to: u32) -> u64 {
        self.elapsed(from, to)
    }
}

/// Gives at most `step` bytes at a time, as ports do.
struct Trickle {
    bytes: VecDeque<u8>,
    step: usize,
}

impl ByteSource for Trickle {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let count = bytes.len().min(self.step).min(self.bytes.len());
        bytes.iter_mut().zip(self.bytes.drain(..count)).for_each(|(place, byte)| *place = byte);
        count
    }
}

#[derive(Default)]
struct Written(Vec<u8>);

impl ByteSink for Written {
    fn write(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }
}

fn push(bytes: &mut Vec<u8>, id: u16, request: Request) {
    bytes.push(DELIMITER);
    bytes.extend_from_slice(encode(&Command { id, request }, &mut [0; MAX_COMMAND]).unwrap());
}

fn push_pair(bytes: &mut Vec<u8>, id: u16, dims: Dims, scene: Scene) {
    let head = PairHead {
        width: dims.width,
        height: dims.height,
        capture_time_us: 1000 * u64::from(id),
        right_capture_time_us: None,
    };
    push(bytes, id, Request::Pair(head));
    let pixels = usize::from(dims.width) * usize::from(dims.height);
    let (mut left, mut right) = (vec![0; pixels], vec![0; pixels]);
    scene.paint(dims, &mut left, &mut right);
    bytes.extend([left, right].concat());
}

fn messages(bytes: &[u8]) -> Vec<Message> {
    let mut decoder: Decoder<Message, MAX_PACKET> = Decoder::new();
    bytes.iter().filter_map(|&byte| decoder.push(byte)).collect::<Result<_, _>>().unwrap()
}

#[test]
fn replay_gives_the_same_however_the_bytes_arrive() {
    let mut input = b"noise before the first command".to_vec();
    push(&mut input, 1, Request::Describe);
    push_pair(&mut input, 2, DIMS, Scene::Blocks);
    push_pair(&mut input, 3, Dims { width: 161, height: 100 }, Scene::Noise);
    push_pair(&mut input, 4, DIMS, Scene::Bricks);
    input.truncate(input.len() - 1);
    push(&mut input, 5, Request::Stop); // the delimiter before it is taken for the last pixel
    let mut outputs = Vec::new();
    for step in [1, 7, 256, usize::MAX] {
        let mut memory = Box::new(Workspace::new());
        let mut source = Trickle { bytes: input.clone().into(), step };
        let (mut output, mut events) = (Written::default(), Vec::new());
        let counters = replay::run(
            &mut *memory,
            &Microseconds::default(),
            &mut Session::new(BOARD),
            &mut source,
            &mut output,
            |event| events.push(event.clone()),
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
        outputs.push(output.0);
    }
    assert!(outputs.iter().all(|output| *output == outputs[0]));

    let mut memory = Box::new(Workspace::new());
    let [left, right] = memory.frames();
    Scene::Blocks.paint(DIMS, left, right);
    memory.run(&linestereo::Params::DEFAULT, DIMS, &mut ()).unwrap();
    let (mut matches, mut points, mut heads, mut answers) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for message in messages(&outputs[0]) {
        match message {
            Message::Hello(hello) => assert_eq!((hello.largest_width, hello.largest_height), (160, 120)),
            Message::Frame(head) => heads.push(head),
            Message::Segments(list) if list.sequence == 0 => {
                assert_eq!(usize::from(list.first), matches.len());
                matches.extend(list.list.iter().map(linestereo::Match::from));
            }
            Message::Points(list) if list.sequence == 0 => {
                assert_eq!(list.first as usize, points.len());
                points.extend(list.list.iter().map(linestereo::PointClaim::from));
            }
            Message::Segments(_) | Message::Points(_) => {}
            Message::Answer(answer) => answers.push((answer.command, answer.outcome)),
        }
    }
    let mut listed = Vec::new();
    memory.for_each_point(&linestereo::Params::DEFAULT, DIMS, |point| listed.push(point));
    assert!(points == listed && !listed.is_empty(), "{} points instead of {}", points.len(), listed.len());
    assert_eq!(matches, memory.results().matches);
    assert_eq!(heads.iter().map(|head| head.capture_time_us).collect::<Vec<_>>(), [2000, 4000]);
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

/// A serial port whose other end the test holds.
struct Line<'a> {
    incoming: &'a RefCell<VecDeque<u8>>,
    outgoing: &'a RefCell<Vec<u8>>,
}

impl ByteSource for Line<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> usize {
        let mut incoming = self.incoming.borrow_mut();
        let count = bytes.len().min(incoming.len());
        bytes.iter_mut().zip(incoming.drain(..count)).for_each(|(place, byte)| *place = byte);
        count
    }
}

impl ByteSink for Line<'_> {
    fn write(&mut self, bytes: &[u8]) {
        self.outgoing.borrow_mut().extend_from_slice(bytes);
    }
}

/// A camera with a loose cable: no pair, a pair of a wrong size, one with a late right image, then painted ones.
struct Camera(u32, Painter);

impl PairSource for Camera {
    fn next_pair(&mut self, frames: [&mut [u8]; 2]) -> Option<CapturedPair> {
        self.0 += 1;
        match self.0 {
            1 => None,
            2 => Some(CapturedPair::of(Dims { width: 320, height: 240 })),
            3 => {
                let times_us = Some([7_000_000, 7_002_500]);
                Painter::new(DIMS).next_pair(frames).map(|pair| CapturedPair { times_us, ..pair })
            }
            _ => self.1.next_pair(frames),
        }
    }
}

#[test]
fn live_serves_commands_and_survives_its_camera() {
    let (incoming, outgoing) = (RefCell::new(VecDeque::new()), RefCell::new(Vec::new()));
    let send = |id, request| {
        let mut bytes = Vec::new();
        push(&mut bytes, id, request);
        *incoming.borrow_mut() = bytes.into();
    };
    let received = || messages(&core::mem::take(&mut *outgoing.borrow_mut()));
    let mut memory = Box::new(Workspace::new());
    let mut camera = Camera(0, Painter::new(DIMS));
    let line = Line { incoming: &incoming, outgoing: &outgoing };
    let mut live = Live::start(Session::new(BOARD), Microseconds::default(), line);
    assert!(matches!(&received()[..], [Message::Hello(hello)] if hello.board == BOARD.name));
    live.turn(&mut *memory, &mut camera);
    assert_eq!(received(), []); // nobody asked

    send(1, Request::Start);
    let accepted = |command| Message::Answer(Answer { command, outcome: Outcome::Accepted });
    live.turn(&mut *memory, &mut camera);
    let answers = received();
    assert_eq!(answers[0], accepted(1));
    assert!(matches!(&answers[1..], [Message::Frame(head)] if head.health == Health::PAIR_MISSING));
    live.turn(&mut *memory, &mut camera);
    assert!(matches!(&received()[..], [Message::Frame(head)] if head.health == Health::SIZE_MISMATCH));
    live.turn(&mut *memory, &mut camera);
    let skewed = received();
    let [Message::Frame(head)] = skewed[..] else { panic!("a head alone was expected: {skewed:?}") };
    assert_eq!((head.sequence, head.segments, head.capture_time_us), (2, 0, 7_000_000));
    assert!(head.health.of_pair().contains(HealthFlags::SKEW), "{}", head.health);
    assert_eq!(head.pair.unwrap().skew_us, Some(2500));
    live.turn(&mut *memory, &mut camera);
    let frame = received();
    let Message::Frame(head) = &frame[0] else { panic!("no frame: {frame:?}") };
    assert_eq!((head.sequence, head.width), (3, 128));
    assert!(head.pair.unwrap().skew_us.is_none() && head.pair.unwrap().cameras[0].level > 0);
    assert!(head.segments > 10 && head.capture_time_us > 0);
    assert_eq!(frame.len(), 1 + usize::from(head.segments).div_ceil(SEGMENTS_PER_PACKET));

    send(2, Request::Pair(PairHead { width: 16, height: 16, capture_time_us: 0, right_capture_time_us: None }));
    live.turn(&mut *memory, &mut camera);
    assert_eq!(received()[0], Message::Answer(Answer { command: 2, outcome: Outcome::Refused(Refusal::Unsupported) }));
    send(3, Request::Stop);
    live.turn(&mut *memory, &mut camera);
    assert_eq!(received(), [accepted(3)]);
}

#[test]
fn a_pair_of_two_moments_is_refused_and_named_for_a_while() {
    let (left, right) = {
        let mut images = [vec![0; 128 * 96], vec![0; 128 * 96]];
        let [left, right] = &mut images;
        Scene::Blocks.paint(DIMS, left, right);
        let [left, right] = images;
        (left, right)
    };
    let mut input = Vec::new();
    for (id, skew_us, changed) in
        [(1, None, 0), (2, Some(1001), 1), (3, Some(1000), 2), (4, Some(0), 3), (5, Some(7), 4)]
    {
        let (width, height, capture_time_us) = (DIMS.width, DIMS.height, 50_000 * u64::from(id));
        let right_capture_time_us = skew_us.map(|skew_us| capture_time_us - skew_us);
        push(&mut input, id, Request::Pair(PairHead { width, height, capture_time_us, right_capture_time_us }));
        // A sensor never gives the same picture twice.
        input.extend([&left, &right].into_iter().flatten().map(|&grey| grey + changed));
    }
    let (mut memory, mut source) = (Box::new(Workspace::new()), Trickle { bytes: input.into(), step: 256 });
    let (clock, mut output) = (Microseconds::default(), Written::default());
    replay::run(&mut *memory, &clock, &mut Session::new(BOARD), &mut source, &mut output, |_| {});
    let (mut heads, mut refused) = (Vec::new(), Vec::new());
    for message in messages(&output.0) {
        match message {
            Message::Frame(head) => heads.push((head.sequence, head.pair.unwrap().skew_us, head.health.of_pair())),
            Message::Answer(Answer { command, outcome: Outcome::Refused(why) }) => refused.push((command, why)),
            _ => {}
        }
    }
    assert_eq!(refused, [(2, Refusal::Skewed { skew_us: 1001, limit_us: 1000 })]);
    let (good, skew) = (HealthFlags::GOOD, HealthFlags::SKEW);
    assert_eq!(heads, [(0, None, good), (2, Some(1000), skew), (3, Some(0), skew), (4, Some(7), good)]);
}
