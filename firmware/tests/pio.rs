//! The PIO programs of the RP2350's cameras, run word by word on drawn waveforms; their words
//! through the DMA's chain into the ring; its signals through the capture.
//!
//! The interpreter knows only what the datasheet says of the instructions that are used, and panics
//! at any other.

use crate::support::random::Random;
use core::cell::RefCell;
use linestereo::Dims;
use linestereo_firmware::boards::rp235x::program::{FRAMES, Program, ROWS, Wire, nibbles};
use linestereo_firmware::boards::rp235x::rows::{
    BORDER, DIMS, FRAME_ROWS, RING_ROWS, ROW_BYTES, RowCounter, SLOT_WORDS, Seen,
};
use linestereo_firmware::capture::{Capture, Fault, Limits, Report, RowRing, RowSink, Signal};
use linestereo_firmware::ports::FrameStart;
use linestereo_rig::{CameraSide, RowError};
use std::collections::VecDeque;
use std::rc::Rc;

/// Cycles of a period of PCLKO: 150 MHz, 6 MHz.
const PERIOD: u32 = 25;
/// Nibbles of time that a row takes, of which the pixels take 648.
const ROW_NIBBLES: u32 = 2 * 376;
/// Pixels of a row that are kept.
const WIDTH: usize = DIMS.width as usize;
/// Words that the joined queues of a state machine hold.
const QUEUE: usize = 8;

/// A state machine.
struct Machine {
    program: Program,
    number: u8,
    slot: u8,
    x: u32,
    shift: u32,
    count: u32,
    queue: VecDeque<u32>,
    is_overrun: bool,
    /// Pins two cycles ago: the synchronisers.
    late: [u32; 2],
}

impl Machine {
    fn new(program: Program, number: u8) -> Self {
        let (slot, queue) = (program.wrap_target, VecDeque::new());
        let (x, shift, count, is_overrun, late) = (0, 0, 0, false, [0; 2]);
        Self { program, number, slot, x, shift, count, queue, is_overrun, late }
    }

    /// One cycle. The flag that it sets, if any.
    fn step(&mut self, pins: u32) -> Option<u8> {
        let seen = self.late[1];
        self.late = [pins, self.late[0]];
        let word = self.program.words[usize::from(self.slot)];
        assert_eq!(word >> 8 & 31, 0, "no delay is used");
        let (high, low) = (word >> 5 & 7, word & 31);
        let next = if usize::from(self.slot) + 1 == self.program.words.len() {
            self.program.wrap_target
        } else {
            self.slot + 1
        };
        let pin = |number: u16| seen >> number & 1;
        match (word >> 13, high) {
            // JMP PIN; the pin is LVLD.
            (0b000, 0b110) => {
                self.slot = if pin(Wire::LineValid as u16) == 1 { low as u8 } else { next }
            }
            // JMP X--
            (0b000, 0b010) => {
                self.slot = if self.x == 0 { next } else { low as u8 };
                self.x = self.x.wrapping_sub(1);
            }
            // WAIT polarity PIN number
            (0b001, 0b101) => self.slot = if pin(low) == 1 { next } else { self.slot },
            (0b001, 0b001) => self.slot = if pin(low) == 0 { next } else { self.slot },
            // IN PINS, IN X
            (0b010, source @ (0b000 | 0b001)) => {
                let bits = if low == 0 { 32 } else { u32::from(low) };
                let value = if source == 0 { seen } else { self.x };
                if self.count + bits >= 32 && self.queue.len() == QUEUE {
                    self.is_overrun = true; // it stalls
                    return None;
                }
                self.shift =
                    if bits == 32 { value } else { self.shift >> bits | value << (32 - bits) };
                self.count = (self.count + bits).min(32);
                if self.count == 32 {
                    self.queue.push_back(self.shift);
                    (self.shift, self.count) = (0, 0);
                }
                self.slot = next;
            }
            // MOV X, !NULL
            (0b101, 0b001) => {
                assert_eq!(low, 0b01_011);
                self.x = u32::MAX;
                self.slot = next;
            }
            // IRQ set, relative
            (0b110, 0b000) => {
                assert_eq!(low >> 3, 0b10);
                self.slot = next;
                return Some((low as u8 & 4) | (((low as u8 & 3) + self.number) % 4));
            }
            _ => panic!("instruction {word:#018b} is not known"),
        }
        None
    }

    fn restart(&mut self) {
        (self.slot, self.shift, self.count, self.is_overrun) =
            (self.program.wrap_target, 0, 0, false);
        self.queue.clear();
    }
}

/// One camera: its state machines, its DMA channels, its interrupt.
struct Camera {
    rows: Machine,
    frames: Machine,
    ring: Vec<[u32; SLOT_WORDS]>,
    /// Place in the table that is read next, words of the row that have come.
    next_slot: u32,
    words: usize,
    is_held: bool,
    counter: RowCounter,
    frame_rows: u32,
    flags: [bool; 2],
    is_row_done: bool,
    /// Cycles from an interrupt to its handler.
    latency: u32,
    pending_since: Option<u64>,
    cycle: u64,
}

impl Camera {
    fn new(number: u8, rows: u32) -> Self {
        Self {
            rows: Machine::new(ROWS, number),
            frames: Machine::new(FRAMES, number + 1),
            ring: vec![[0; SLOT_WORDS]; RING_ROWS],
            next_slot: 1,
            words: 0,
            is_held: false,
            counter: RowCounter::new(),
            frame_rows: rows,
            flags: [false; 2],
            is_row_done: false,
            latency: 60,
            pending_since: None,
            cycle: 0,
        }
    }

    fn time_us(&self) -> u64 {
        self.cycle / 150
    }

    fn step(&mut self, pins: u32) {
        self.cycle += 1;
        assert_eq!(self.rows.step(pins), None);
        let first = self.frames.number - 1;
        if let Some(flag) = self.frames.step(pins) {
            assert!((first..first + 2).contains(&flag));
            self.flags[usize::from(flag - first)] = true;
        }
        let word = if self.is_held { None } else { self.rows.queue.pop_front() };
        if let Some(word) = word {
            let slot = (self.next_slot as usize + RING_ROWS - 1) % RING_ROWS;
            self.ring[slot][self.words] = word;
            self.words += 1;
            if self.words == SLOT_WORDS {
                self.words = 0;
                self.next_slot = (self.next_slot + 1) % RING_ROWS as u32;
                self.is_row_done = true;
            }
        }
        if self.is_row_done || self.flags != [false; 2] {
            let since = *self.pending_since.get_or_insert(self.cycle);
            if self.cycle - since >= u64::from(self.latency) {
                self.interrupt();
            }
        }
    }

    fn interrupt(&mut self) {
        self.pending_since = None;
        self.is_row_done = false;
        let [is_started, is_ended] = core::mem::take(&mut self.flags);
        let seen = Seen {
            is_started,
            is_ended,
            is_overrun: self.rows.is_overrun,
            next_slot: self.next_slot,
            is_begun: self.words > 0 || !self.rows.queue.is_empty(),
            time_us: self.time_us(),
        };
        let ring = &self.ring;
        if let Some(slot) =
            self.counter.take(self.frame_rows, &seen, |slot| ring[slot as usize][SLOT_WORDS - 1])
        {
            self.rows.restart();
            self.words = 0;
            self.next_slot = (slot + 1) % RING_ROWS as u32;
        }
    }
}

/// The ring as the capture sees it.
struct Ring(Rc<RefCell<Camera>>);

impl RowRing for Ring {
    fn rows(&self) -> u32 {
        RING_ROWS as u32
    }

    fn next_signal(&mut self) -> Option<Signal> {
        self.0.borrow_mut().counter.next_signal()
    }

    fn written(&self) -> u32 {
        let camera = self.0.borrow();
        camera.counter.written(camera.next_slot)
    }

    fn copy(&self, row: u32, into: &mut [u8]) {
        let camera = self.0.borrow();
        let words = &camera.ring[row as usize % RING_ROWS];
        for (byte, from) in into
            .iter_mut()
            .zip(words.iter().flat_map(|word| word.to_le_bytes()).skip(BORDER as usize))
        {
            *byte = from;
        }
    }

    fn now_us(&self) -> u64 {
        self.0.borrow().time_us()
    }
}

/// Output of a sensor: a frame, with its faults.
#[derive(Clone, Copy, Debug)]
struct Frame {
    seed: u32,
    rows: u32,
    /// A row that has so many pixels, in halves.
    odd: Option<(u32, u32)>,
    /// FVLD does not fall behind it.
    is_end_missing: bool,
    /// FVLD rises so many periods of PCLKO before the first row, and falls as many behind the last
    /// one.
    margin: u32,
    /// The DMA takes nothing during these rows.
    held: Option<(u32, u32)>,
}

impl Frame {
    const fn good(seed: u32, rows: u32) -> Self {
        Self { seed, rows, odd: None, is_end_missing: false, margin: 4, held: None }
    }

    /// At a nibble of a row.
    fn wires(self, y: u32, n: u32) -> u32 {
        let halves = self
            .odd
            .filter(|(row, _)| *row == y)
            .map_or(2 * ROW_BYTES as u32, |(_, halves)| halves);
        if y >= self.rows {
            self.rest()
        } else if n < halves {
            let pixel = self.pixel(n / 2, y);
            FRAME_VALID
                | LINE_VALID
                | u32::from(if n.is_multiple_of(2) { pixel & 15 } else { pixel >> 4 })
        } else {
            FRAME_VALID
        }
    }

    /// Behind its rows.
    fn rest(self) -> u32 {
        if self.is_end_missing { FRAME_VALID } else { 0 }
    }

    fn pixel(self, x: u32, y: u32) -> u8 {
        (x.wrapping_mul(7) ^ y.wrapping_mul(13) ^ self.seed.wrapping_mul(91)) as u8 ^ (x >> 3) as u8
    }
}

const FRAME_VALID: u32 = 1 << Wire::FrameValid as u32;
const LINE_VALID: u32 = 1 << Wire::LineValid as u32;
const CLOCK: u32 = 1 << Wire::PixelClock as u32;

/// Both frames as they are fetched.
struct Kept {
    frames: [Vec<u8>; 2],
    row: Vec<u8>,
    rows: usize,
}

impl RowSink for Kept {
    fn restart(&mut self, eye: CameraSide) {
        self.frames[eye as usize].clear();
    }

    fn row(&mut self, _: CameraSide) -> &mut [u8] {
        &mut self.row
    }

    fn push(&mut self, eye: CameraSide) -> Result<(), RowError> {
        self.frames[eye as usize].extend_from_slice(&self.row);
        Ok(())
    }

    fn complete(&self) -> Option<Dims> {
        let is_whole = |frame: &Vec<u8>| frame.len() == WIDTH * self.rows;
        let dims = Dims { width: WIDTH as u16, height: self.rows as u16 };
        self.frames.iter().all(is_whole).then_some(dims)
    }
}

/// Two cameras and who fetches their rows.
struct Bench {
    cameras: [Rc<RefCell<Camera>>; 2],
    rings: [Ring; 2],
    capture: Capture,
    kept: Kept,
    reports: Vec<Report>,
}

impl Bench {
    fn new(rows: u16) -> Self {
        let cameras = [0, 2].map(|number| Rc::new(RefCell::new(Camera::new(number, rows.into()))));
        let kept = rows - 2 * BORDER as u16;
        let rings = [0, 1].map(|i: usize| Ring(cameras[i].clone()));
        let limits = Limits {
            rows: kept,
            row_bytes: ROW_BYTES as u16,
            row_gap_us: 1000,
            readout_us: 60_000,
            silence_us: 100_000,
            pair_us: 2000,
        };
        let kept = Kept { frames: [vec![], vec![]], row: vec![0; WIDTH], rows: kept.into() };
        Self {
            cameras,
            rings,
            capture: Capture::new(limits, FrameStart::Triggered),
            kept,
            reports: vec![],
        }
    }

    /// After a good pair.
    fn started() -> Self {
        let mut bench = Self::new(ROWS_SENT as u16);
        bench.expect_pair(1, ROWS_SENT);
        bench
    }

    /// Two good frames: one pair, byte for byte.
    fn expect_pair(&mut self, seed: u32, rows: u32) {
        let frames = [Frame::good(seed, rows), Frame::good(seed + 1, rows)];
        let before = self.reports.len();
        self.send(frames);
        assert!(
            matches!(self.reports[before..], [Report::Pair(_)]),
            "{:?}",
            &self.reports[before..]
        );
        self.assert_kept(frames, "good");
    }

    /// Both frames lie there, byte for byte.
    fn assert_kept(&self, frames: [Frame; 2], what: impl core::fmt::Display) {
        for (frame, kept) in frames.iter().zip(&self.kept.frames) {
            let inside = |side: u32| BORDER..side - BORDER;
            let drawn = inside(frame.rows)
                .flat_map(|y| inside(ROW_BYTES as u32).map(move |x| frame.pixel(x, y)));
            assert!(drawn.eq(kept.iter().copied()), "{what}: {frames:?}");
        }
    }

    /// Both frames, side by side, then a pause; rows are fetched meanwhile. What was reported.
    fn send(&mut self, frames: [Frame; 2]) -> Vec<Report> {
        let before = self.reports.len();
        self.clocks([FRAME_VALID; 2], frames[0].margin);
        for y in 0..frames[0].rows.max(frames[1].rows) {
            for (camera, frame) in self.cameras.iter().zip(&frames) {
                camera.borrow_mut().is_held =
                    frame.held.is_some_and(|(from, to)| (from..to).contains(&y));
            }
            for n in 0..ROW_NIBBLES {
                self.clock(frames.map(|frame| frame.wires(y, n)));
            }
            self.fetch();
        }
        let end = |frame: Frame| {
            if frame.rows < frames[0].rows.max(frames[1].rows) { frame.rest() } else { FRAME_VALID }
        };
        self.clocks(frames.map(end), frames[0].margin);
        for _ in 0..16 {
            self.clocks(frames.map(Frame::rest), ROW_NIBBLES);
            self.fetch();
        }
        self.reports[before..].to_vec()
    }

    /// A period of PCLKO: data change at its rising edge.
    fn clock(&mut self, wires: [u32; 2]) {
        for cycle in 0..PERIOD {
            let clock = if cycle < PERIOD / 2 { CLOCK } else { 0 };
            for (camera, wires) in self.cameras.iter().zip(wires) {
                camera.borrow_mut().step(wires | clock);
            }
        }
    }

    fn clocks(&mut self, wires: [u32; 2], periods: u32) {
        for _ in 0..periods {
            self.clock(wires);
        }
    }

    fn fetch(&mut self) {
        while let Some(report) = self.capture.turn(&mut self.rings, &mut self.kept) {
            self.reports.push(report);
        }
    }
}

/// Of the frames of most tests.
const ROWS_SENT: u32 = 10;

#[test]
fn the_words_are_those_of_the_assembler() {
    // pioasm's for the programs that the head of program.rs describes.
    assert_eq!(
        ROWS.words,
        [0xa02b, 0x4004, 0x0043, 0x20a4, 0x2024, 0x00c1, 0x4020, 0x20a4, 0x2024, 0x00c0]
    );
    assert_eq!(FRAMES.words, [0x20a6, 0xc013, 0x2026, 0xc010]);
}

#[test]
fn a_row_is_its_pixels_and_its_length() {
    let mut camera = Camera::new(0, 1);
    let frame = Frame::good(3, 1);
    let mut words = vec![];
    for n in 0..ROW_NIBBLES {
        let wires = frame.wires(0, n);
        for cycle in 0..PERIOD {
            camera.rows.step(wires | if cycle < PERIOD / 2 { CLOCK } else { 0 });
            words.extend(camera.rows.queue.pop_front());
        }
    }
    let bytes: Vec<u8> =
        words[..SLOT_WORDS - 1].iter().flat_map(|word| word.to_le_bytes()).collect();
    assert_eq!(bytes, (0..ROW_BYTES as u32).map(|x| frame.pixel(x, 0)).collect::<Vec<_>>());
    assert_eq!((words.len(), nibbles(words[SLOT_WORDS - 1])), (SLOT_WORDS, 2 * ROW_BYTES as u32));
}

#[test]
fn frames_come_byte_for_byte_and_the_ring_wraps() {
    let mut bench = Bench::new(FRAME_ROWS as u16);
    for seed in 0..3 {
        bench.expect_pair(10 * seed, FRAME_ROWS as u32);
    }
}

#[test]
fn frame_valid_may_be_as_short_as_the_rows() {
    let mut bench = Bench::new(ROWS_SENT as u16);
    for seed in 0..4 {
        let frames =
            [seed, seed + 100].map(|seed| Frame { margin: 1, ..Frame::good(seed, ROWS_SENT) });
        let reports = bench.send(frames);
        assert!(matches!(reports[..], [Report::Pair(_)]), "{reports:?}");
    }
}

/// One bad frame of the left camera: this fault, once, no pair; the next pair is whole.
fn expect_fault(bad: Frame, fault: Fault) {
    let mut bench = Bench::started();
    let mut reports = bench.send([bad, Frame::good(2, ROWS_SENT)]);
    // What is said of the bad frame may come with the next pair.
    let next = bench.send([Frame::good(3, ROWS_SENT), Frame::good(4, ROWS_SENT)]);
    let (pairs, others): (Vec<_>, Vec<_>) =
        next.into_iter().partition(|report| matches!(report, Report::Pair(_)));
    reports.extend(others);
    assert_eq!(
        (pairs.len(), reports),
        (1, vec![Report::Fault(CameraSide::Left, fault)]),
        "{bad:?}"
    );
    bench.expect_pair(5, ROWS_SENT);
}

#[test]
fn rows_of_any_wrong_length_are_seen() {
    for row in [0, 1, ROWS_SENT - 3] {
        for halves in [0, 1, 7, 8, 9, 646, 647, 649, 650, 656, 750] {
            let bad = Frame { odd: Some((row, halves)), ..Frame::good(2, ROWS_SENT) };
            // A row of which nothing comes is a frame that is too short.
            expect_fault(bad, if halves == 0 { Fault::EarlyVsync } else { Fault::ShortLine });
        }
    }
}

#[test]
fn a_queue_that_is_full_is_an_overrun() {
    expect_fault(Frame { held: Some((2, 4)), ..Frame::good(2, ROWS_SENT) }, Fault::Overrun);
}

#[test]
fn too_few_and_too_many_rows_are_seen() {
    expect_fault(Frame::good(2, ROWS_SENT - BORDER - 1), Fault::EarlyVsync);
    expect_fault(Frame::good(2, 0), Fault::EarlyVsync);
    let mut bench = Bench::started();
    let reports = bench.send([Frame::good(2, ROWS_SENT + 1), Frame::good(3, ROWS_SENT)]);
    assert!(reports.contains(&Report::Fault(CameraSide::Left, Fault::MissingVsync)), "{reports:?}");
    bench.expect_pair(5, ROWS_SENT);
}

#[test]
fn a_frame_without_an_end_is_seen() {
    let mut bench = Bench::started();
    bench.send([
        Frame { is_end_missing: true, ..Frame::good(2, ROWS_SENT) },
        Frame::good(3, ROWS_SENT),
    ]);
    let reports = bench.send([Frame::good(4, ROWS_SENT), Frame::good(5, ROWS_SENT)]);
    assert_eq!(reports, [Report::Fault(CameraSide::Left, Fault::MissingVsync)]);
    bench.expect_pair(7, ROWS_SENT);
}

#[test]
fn an_interrupt_that_comes_late_loses_nothing_up_to_a_row() {
    let mut bench = Bench::new(ROWS_SENT as u16);
    for latency in [0, 10, 200, 2000, 15_000] {
        bench.cameras.iter().for_each(|camera| camera.borrow_mut().latency = latency);
        bench.expect_pair(latency, ROWS_SENT);
    }
}

#[test]
fn an_interrupt_that_comes_after_a_frame_says_so() {
    let mut bench = Bench::started();
    bench.cameras[0].borrow_mut().latency = 400_000;
    let reports = bench.send([Frame::good(2, ROWS_SENT), Frame::good(3, ROWS_SENT)]);
    assert_eq!(reports, [Report::Fault(CameraSide::Left, Fault::TooSlow)]);
    bench.cameras[0].borrow_mut().latency = 60;
    bench.expect_pair(5, ROWS_SENT);
}

#[test]
fn more_signals_than_are_kept_are_lost_and_said_to_be() {
    let mut counter = RowCounter::new();
    let good = u32::MAX - 2 * ROW_BYTES as u32;
    for row in 0..400_u32 {
        let next_slot = (row + 2) % RING_ROWS as u32;
        let seen = Seen {
            is_started: row == 0,
            is_ended: false,
            is_overrun: false,
            next_slot,
            is_begun: false,
            time_us: 0,
        };
        assert_eq!(counter.take(1000, &seen, |_| good), None);
    }
    let signals: Vec<_> = core::iter::from_fn(|| counter.next_signal()).collect();
    assert_eq!(signals[0], Signal::Lost);
    assert_eq!(
        *signals.last().unwrap(),
        Signal::Rows { end: 400, bytes: ROW_BYTES as u32, time_us: 0 }
    );
    assert_eq!(counter.written(400 % RING_ROWS as u32 + 1), 400);
}

impl Random {
    /// A frame, and whether what comes behind it may suffer as well.
    fn frame(&mut self, seed: u32) -> (Frame, bool) {
        let good = Frame::good(seed, ROWS_SENT);
        match self.below(8) {
            0 => (
                Frame { odd: Some((self.below(ROWS_SENT), self.below(ROW_NIBBLES))), ..good },
                false,
            ),
            1 => (Frame { rows: self.below(ROWS_SENT + 4), ..good }, false),
            2 => (Frame { is_end_missing: true, ..good }, true),
            3 => {
                let from = self.below(ROWS_SENT);
                (Frame { held: Some((from, from + 1 + self.below(3))), ..good }, false)
            }
            _ => (good, false),
        }
    }
}

#[test]
fn no_chance_of_faults_hands_on_a_wrong_pair_or_loses_the_second_next_one() {
    const SEED: u64 = 2350;
    let mut random = Random(SEED);
    let mut bench = Bench::new(ROWS_SENT as u16);
    let (mut pairs, mut bad, mut may_suffer) = (0, 0, false);
    for n in 0..80 {
        let latency = if random.below(20) == 0 { 400_000 } else { random.below(3000) };
        bench.cameras.iter().for_each(|camera| camera.borrow_mut().latency = latency);
        let [(left, is_left_hard), (right, is_right_hard)] =
            [2 * n, 2 * n + 1].map(|seed| random.frame(seed));
        let is_good = [left, right].iter().all(|frame| {
            frame.odd.is_none_or(|(_, halves)| halves == 2 * ROW_BYTES as u32)
                && frame.rows == ROWS_SENT
                && !frame.is_end_missing
                && frame.held.is_none()
        });
        let reports = bench.send([left, right]);
        let is_pair = reports.iter().any(|report| matches!(report, Report::Pair(_)));
        if is_pair {
            bench.assert_kept(
                [left, right].map(|frame| Frame { rows: ROWS_SENT, ..frame }),
                format!("seed {SEED}, frame {n}"),
            );
        }
        if is_good && latency < 3000 && !may_suffer {
            assert!(is_pair, "seed {SEED}, frame {n}: {reports:?}");
        }
        pairs += u32::from(is_pair);
        bad += u32::from(!is_good);
        may_suffer = is_left_hard || is_right_hard || latency >= 3000;
    }
    assert!(pairs > 15 && bad > 30, "{pairs} pairs, {bad} bad ones");
}
