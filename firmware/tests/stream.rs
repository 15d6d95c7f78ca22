//! One stream of rows for both eyes, on a fake camera interface and DMA.
//!
//! The fake moves bytes, not rows: its DMA knows only a place in a ring, its interrupts are flags
//! that stay set until somebody looks, however late.

use crate::support::random::Random;
use crate::support::rows::{WIDTH, faults, frames_in, frames_of, paint};
use core::cell::{Cell, RefCell};
use linestereo::Dims;
use linestereo_firmware::boards::mps2_an386::BoardMemory;
use linestereo_firmware::capture::*;
use linestereo_firmware::ports::{Cameras, FrameStart, PairSource};
use linestereo_rig::CameraSide;
use linestereo_wire::CaptureReport;
use std::collections::VecDeque;
use std::rc::Rc;

const ROWS: u32 = 24;
const DIMS: Dims = Dims { width: WIDTH, height: ROWS as u16 };
const BAND: u32 = 4;
const ROW_US: u64 = 10;
/// Of a row's time, from its first bytes to its last ones.
const BUSY_US: u64 = 7;
const PAUSE_US: u64 = 200;
const PERIOD_US: u64 = ROWS as u64 * ROW_US + PAUSE_US;

const fn limits(row_bytes: u16, pair_us: u32) -> Limits {
    let silence_us = 4 * PERIOD_US as u32;
    Limits {
        rows: ROWS as u16,
        row_bytes,
        row_gap_us: 200,
        readout_us: PERIOD_US as u32,
        silence_us,
        pair_us,
    }
}

/// Event in a stream.
#[derive(Clone, Debug)]
enum Step {
    Start,
    /// The first bytes of a row.
    Begin(Vec<u8>),
    /// Its other bytes.
    Row(Vec<u8>),
    End,
    Overrun,
}

/// A camera interface, its DMA, and what its interrupts make of it.
struct Fake {
    now_us: u64,
    steps: VecDeque<(u64, Step)>,
    ring: Vec<u8>,
    /// Where the DMA writes next.
    place: u32,
    /// Frames are taken: not before the first start after it was started anew.
    is_capturing: bool,
    /// A row has begun that has not ended.
    is_in_row: bool,
    /// Of the interrupt, and since when they wait.
    flags: Events,
    since_us: Option<u64>,
    latency_us: u64,
    /// Every fourth interrupt comes later than that, by up to three rows.
    late: Option<Random>,
    bands: Bands<64>,
    restarts: u32,
}

impl Fake {
    fn new(layout: RingLayout) -> Self {
        Self {
            now_us: 0,
            steps: VecDeque::new(),
            ring: vec![0xee; layout.bytes() as usize],
            place: 0,
            is_capturing: false,
            is_in_row: false,
            flags: Events::default(),
            since_us: None,
            latency_us: 0,
            late: None,
            bands: Bands::new(layout),
            restarts: 0,
        }
    }

    /// Lets time pass: steps at their times, interrupts when they are due.
    fn pass_to(&mut self, until_us: u64) {
        loop {
            let step_us = self.steps.front().map(|step| step.0).filter(|&time| time <= until_us);
            let due_us =
                self.since_us.map(|since| since + self.latency_us).filter(|&time| time <= until_us);
            match (step_us, due_us) {
                (None, None) => break,
                (Some(step), due) if due.is_none_or(|due| step < due) => {
                    self.now_us = step;
                    let (_, step) = self.steps.pop_front().unwrap();
                    self.take(step);
                    if self.since_us.is_none() {
                        self.since_us = Some(self.now_us);
                        self.latency_us = self.late.as_mut().map_or(0, |late| {
                            let most_us = if late.below(4) == 0 { 28 } else { 3 };
                            late.below(most_us).into()
                        });
                    }
                }
                (_, Some(due)) => {
                    self.now_us = due;
                    self.since_us = None;
                    let mut events = core::mem::take(&mut self.flags);
                    events.row_ended &= !self.is_in_row;
                    if self.bands.serve(events, self.place, due) == Dma::Restart {
                        (self.place, self.is_capturing, self.flags) = (0, false, Events::default());
                        self.restarts += 1;
                    }
                }
                (Some(_), None) => unreachable!("the second arm has it"),
            }
        }
        self.now_us = until_us;
    }

    fn take(&mut self, step: Step) {
        match step {
            Step::Start => {
                self.is_capturing = true;
                self.flags.has_started = true;
            }
            Step::Begin(bytes) => {
                self.write(bytes);
                self.is_in_row = true;
            }
            Step::Row(bytes) => {
                self.write(bytes);
                self.is_in_row = false;
                self.flags.row_ended = true; // of rows that are not captured as well
            }
            Step::End => self.flags.frame_ended = true,
            Step::Overrun => self.flags.is_lost = true,
        }
    }

    fn write(&mut self, bytes: Vec<u8>) {
        for byte in bytes.into_iter().filter(|_| self.is_capturing) {
            self.ring[self.place as usize] = byte;
            self.place = (self.place + 1) % self.ring.len() as u32;
        }
    }

    /// A frame from this time on, of rows that end one after the other.
    fn play(&mut self, start_us: u64, rows: impl IntoIterator<Item = Vec<u8>>) {
        self.steps.push_back((start_us, Step::Start));
        let mut time_us = start_us;
        for mut row in rows {
            time_us += ROW_US;
            let rest = row.split_off(row.len() / 2);
            self.steps.push_back((time_us - BUSY_US, Step::Begin(row)));
            self.steps.push_back((time_us, Step::Row(rest)));
        }
        self.steps.push_back((time_us + 1, Step::End));
    }
}

/// The fake as a board has it.
#[derive(Clone)]
struct FakeStream(Rc<RefCell<Fake>>);

impl Stream for FakeStream {
    fn rows(&self) -> u32 {
        self.0.borrow().bands.layout().rows
    }

    fn next_signal(&mut self) -> Option<Signal> {
        self.0.borrow_mut().bands.next_signal()
    }

    fn written(&self) -> u32 {
        let fake = self.0.borrow();
        fake.bands.written(fake.place)
    }

    fn is_in_frame(&self) -> bool {
        self.0.borrow().bands.is_in_frame()
    }

    fn copy(&self, row: u32, from: usize, into: &mut [u8]) {
        let fake = self.0.borrow();
        let layout = fake.bands.layout();
        let start = ((row % layout.rows) * layout.row_bytes) as usize + from;
        assert!(from + into.len() <= layout.row_bytes as usize, "more than a row");
        into.copy_from_slice(&fake.ring[start..start + into.len()]);
    }

    fn now_us(&self) -> u64 {
        self.0.borrow().now_us
    }

    fn rest(&self) {
        let mut fake = self.0.borrow_mut();
        let next = fake.now_us + 1;
        fake.pass_to(next);
    }
}

fn both(frame: u32) -> Vec<Vec<u8>> {
    (0..ROWS)
        .map(|row| {
            [paint(CameraSide::Left, frame, row), paint(CameraSide::Right, frame, row)].concat()
        })
        .collect()
}

const TWO_ROWS: RingLayout = RingLayout { rows: 16, row_bytes: 2 * WIDTH as u32, band: BAND };

/// A fault of a stream, what is said of it (once for each eye), and a frame with it.
fn injected(random: &mut Random, fake: &mut Fake, frame: u32, start_us: u64) -> Option<Fault> {
    let row = 1 + random.below(ROWS - 2) as usize;
    let mut rows = both(frame);
    let fault = match random.below(24) {
        0 => {
            rows[row].truncate(2 * WIDTH as usize - 4 * (1 + random.below(7) as usize));
            Some(Fault::ShortLine)
        }
        1 => {
            rows[row].extend([0x55; 12]);
            Some(Fault::ShortLine)
        }
        // Short by as much as the next one is long: the frame has the right number of bytes.
        2 => {
            rows[row].truncate(2 * WIDTH as usize - 8);
            rows[row + 1].extend([0x66; 8]);
            Some(Fault::ShortLine)
        }
        // A row without bytes is a row that is missing at the end.
        3 => {
            rows[row].clear();
            Some(Fault::EarlyVsync)
        }
        4 => {
            rows.truncate(row);
            Some(Fault::EarlyVsync)
        }
        5 => {
            rows.push(vec![0x77; 2 * WIDTH as usize]);
            Some(Fault::MissingVsync)
        }
        6 => Some(Fault::Overrun),
        _ => None,
    };
    fake.play(start_us, rows);
    if fault == Some(Fault::Overrun) {
        let lost = (start_us + row as u64 * ROW_US + 5, Step::Overrun);
        let place = fake.steps.iter().position(|step| step.0 > lost.0).unwrap();
        fake.steps.insert(place, lost);
    }
    fault
}

#[test]
fn ten_thousand_frames_side_by_side_with_faults() {
    let seed = 11;
    let mut random = Random(seed);
    let fake = Rc::new(RefCell::new(Fake::new(TWO_ROWS)));
    let eyes = SideBySide::new(FakeStream(fake.clone()));
    let mut rings = eyes.eyes(WIDTH);
    let mut capture = Capture::new(limits(2 * WIDTH, 1), FrameStart::Triggered);
    let mut expected = CaptureReport::default();
    let [mut left, mut right] = [[0; (WIDTH * DIMS.height) as usize]; 2];
    let (mut good, mut delivered) = (Vec::new(), Vec::new());
    let frames = 10_000;
    for frame in 0..frames {
        let start_us = 50 + u64::from(frame) * PERIOD_US;
        let fault = injected(&mut random, &mut fake.borrow_mut(), frame, start_us);
        match fault {
            Some(fault) => expected.faults.iter_mut().for_each(|of| of[fault as usize] += 1),
            None => good.push(frame),
        }
        // Interrupts that come late change nothing, whether in the middle of a row or between two.
        // Only a row that is short while the next one is long by as much needs one in time.
        fake.borrow_mut().late =
            fault.is_none_or(|fault| fault != Fault::ShortLine).then(|| Random(frame.into()));
        let mut sink = FrameRows::new([&mut left, &mut right], DIMS);
        let mut is_paired = false;
        for step in 0..PERIOD_US {
            fake.borrow_mut().pass_to(start_us + step);
            while let Some(report) = capture.turn(&mut rings, &mut sink) {
                match report {
                    Report::Pair(pair) => {
                        assert_eq!(
                            pair.times_us.map(|[left, right]| left.abs_diff(right)),
                            Some(0)
                        );
                        assert!(!is_paired, "frame {frame} came twice");
                        is_paired = true;
                    }
                    Report::Fault(..) => {}
                    other => panic!("seed {seed}, frame {frame}: {other:?}"),
                }
            }
        }
        if is_paired {
            // With a row too many the rows before it are whole, if somebody looks before it comes.
            if fault != Some(Fault::MissingVsync) {
                delivered.push(frame);
            }
            let found = frames_of([&left, &right])
                .unwrap_or_else(|error| panic!("seed {seed}, frame {frame}: {error}"));
            assert_eq!(found, [frame; 2], "seed {seed}");
        }
    }
    assert!(delivered == good, "seed {seed}: others were delivered than were good");
    assert_eq!(capture.losses().faults, expected.faults, "seed {seed}");
    let count = |fault| faults(&expected, fault)[0];
    for fault in [Fault::ShortLine, Fault::EarlyVsync, Fault::MissingVsync, Fault::Overrun] {
        assert!(count(fault) > 100, "{fault:?} was hardly ever injected");
    }
    // Set to the start of the ring after wrong rows and overruns, and only then.
    assert_eq!(fake.borrow().restarts, count(Fault::ShortLine) + count(Fault::Overrun));
}

#[test]
fn rows_that_wait_are_good_until_they_are_overwritten() {
    // Nobody looks until so many rows of the second frame have come.
    for rows in [0, 9] {
        let fake = Rc::new(RefCell::new(Fake::new(TWO_ROWS)));
        for frame in 0..2 {
            fake.borrow_mut().play(10 + u64::from(frame) * PERIOD_US, both(frame));
        }
        let eyes = SideBySide::new(FakeStream(fake.clone()));
        let mut rings = eyes.eyes(WIDTH);
        let mut capture = Capture::new(limits(2 * WIDTH, 1), FrameStart::Triggered);
        let [mut left, mut right] = [[0; (WIDTH * DIMS.height) as usize]; 2];
        let mut sink = FrameRows::new([&mut left, &mut right], DIMS);
        fake.borrow_mut().pass_to(10 + PERIOD_US + rows * ROW_US);
        let mut pairs = 0;
        for time_us in 10 + PERIOD_US + rows * ROW_US..10 + 2 * PERIOD_US {
            while let Some(report) = capture.turn(&mut rings, &mut sink) {
                pairs += u32::from(matches!(report, Report::Pair(_)));
            }
            fake.borrow_mut().pass_to(time_us);
        }
        // The ring holds 16 of 24 rows: the first frame is skipped, the second one is whole.
        assert_eq!((pairs, capture.losses().skipped), (1, 2), "{rows}");
        assert_eq!(frames_of([&left, &right]), Ok([1; 2]));
    }
}

#[test]
fn a_ring_that_nobody_empties_says_that_signals_were_lost() {
    let fake = Rc::new(RefCell::new(Fake::new(TWO_ROWS)));
    for frame in 0..40 {
        fake.borrow_mut().play(10 + u64::from(frame) * PERIOD_US, both(frame));
    }
    fake.borrow_mut().pass_to(40 * PERIOD_US);
    let eyes = SideBySide::new(FakeStream(fake));
    let [mut left, mut right] = eyes.eyes(WIDTH);
    // One eye can be ahead by no more than a few signals.
    assert!((0..40).map_while(|_| left.next_signal()).count() < 20);
    let mut lost = [0; 2];
    for _ in 0..200 {
        lost[0] += u32::from(left.next_signal() == Some(Signal::Lost));
        lost[1] += u32::from(right.next_signal() == Some(Signal::Lost));
    }
    assert_eq!(lost, [1; 2]);
}

const ONE_ROW: RingLayout = RingLayout { rows: 32, row_bytes: WIDTH as u32, band: BAND };
/// From a trigger to the start of the frame.
const EXPOSURE_US: u64 = 30;

/// A switch whose cameras take a frame when they are triggered.
struct FakeSwitch {
    fake: Rc<RefCell<Fake>>,
    /// Of the frames of both cameras.
    count: u32,
    shots: Rc<RefCell<Vec<CameraSide>>>,
    /// This shot's frame is short by a row.
    short: Option<u32>,
}

impl Switch for FakeSwitch {
    fn shoot(&mut self, eye: CameraSide) -> bool {
        let mut fake = self.fake.borrow_mut();
        let has_rows =
            fake.steps.iter().any(|step| matches!(step.1, Step::Begin(_) | Step::Row(_)));
        assert!(!has_rows, "a camera is switched off in the middle of its frame");
        if eye == CameraSide::Right {
            assert!(fake.steps.is_empty(), "the left frame has not ended");
        }
        let rows = if self.short == Some(self.count) { ROWS - 1 } else { ROWS };
        let frame = (0..rows).map(|row| paint(eye, self.count, row).to_vec());
        let start_us = fake.now_us + EXPOSURE_US;
        fake.play(start_us, frame.collect::<Vec<_>>());
        self.count += 1;
        self.shots.borrow_mut().push(eye);
        true
    }
}

/// Cameras that count how often they are let go.
struct Counted(Rc<Cell<u32>>);

impl Cameras for Counted {
    fn shoot(&mut self) -> bool {
        true
    }

    fn let_go(&mut self) {
        self.0.set(self.0.get() + 1);
    }

    fn follow(&mut self) -> Option<[i32; 2]> {
        None
    }

    fn stopped(&mut self) {}
}

#[test]
fn cameras_in_turn_are_triggered_one_after_the_other() {
    let fake = Rc::new(RefCell::new(Fake::new(ONE_ROW)));
    let shots = Rc::new(RefCell::new(Vec::new()));
    let switch = FakeSwitch { fake: fake.clone(), count: 0, shots: shots.clone(), short: Some(4) };
    let eyes = InTurn::new(FakeStream(fake.clone()), switch, ROWS as u16);
    let capture = Capture::new(limits(WIDTH, 2 * PERIOD_US as u32), FrameStart::Triggered);
    let patience_us = 3 * PERIOD_US as u32;
    let let_go = Rc::new(Cell::new(0));
    let mut source = CameraSource::new(
        eyes.eyes(),
        eyes.cameras(Counted(let_go.clone())),
        capture,
        DIMS,
        patience_us,
    );
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut seen = Vec::new();
    for _ in 0..5 {
        let pair = source.next_pair(&mut *memory, None);
        let numbers = pair.map(|_| frames_in(&mut *memory, ROWS).unwrap());
        if let Some(times_us) = pair.and_then(|pair| pair.times_us) {
            // A frame apart, and said so.
            let [left_us, right_us] = times_us;
            assert!(
                (ROWS as u64 * ROW_US..PERIOD_US).contains(&(right_us - left_us)),
                "{times_us:?}"
            );
        }
        seen.push(numbers);
    }
    // The third pair's left frame is short: its right camera is not even triggered.
    assert_eq!(seen, [Some([0, 1]), Some([2, 3]), None, Some([5, 6]), Some([7, 8])]);
    // Four pairs whose frames have both started, and five ends of waiting.
    assert_eq!(let_go.get(), 4 + 5);
    let [l, r] = CameraSide::BOTH;
    assert_eq!(*shots.borrow(), [l, r, l, r, l, l, r, l, r]);
    let losses = source.losses().unwrap();
    assert_eq!((faults(&losses, Fault::EarlyVsync), losses.faults[1]), ([1, 0], [0; 7]));
}
