//! Cameras as the source of pairs, from the trigger to frames that are rectified while their rows
//! come; and what happens when they fail.

use crate::support::rectification;
use crate::support::rows::faults;
use crate::support::sensor::Fake;
use core::cell::{Cell, RefCell};
use core::convert::Infallible;
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, OutputPin};
use linestereo::Dims;
use linestereo_firmware::boards::mps2_an386::BoardMemory;
use linestereo_firmware::camera::{
    Binning, Chip, Config, Hm01b0Nibbles, NoReset, PairExposure, StereoCamera, StereoConfig,
    Trigger,
};
use linestereo_firmware::capture::*;
use linestereo_firmware::memory::Memory;
use linestereo_firmware::ports::{Cameras, CapturedPair, FrameStart, PairSource};
use linestereo_rig::{CameraSide, Remap};
use linestereo_wire::CaptureReport;
use std::collections::VecDeque;
use std::rc::Rc;

const DIMS: Dims = Dims { width: 64, height: 48 };
const LIMITS: Limits = Limits {
    rows: 48,
    row_bytes: 64,
    row_gap_us: 200,
    readout_us: 3000,
    silence_us: 20_000,
    pair_us: 500,
};
const PATIENCE_US: u32 = 50_000;

/// Microseconds that pass with a row on its way, with a row that is copied, and with a rest.
#[derive(Clone, Copy, Default)]
struct Pace {
    row_us: u64,
    copy_us: u64,
    rest_us: u64,
}

/// All rows of a frame are there at once.
const AT_ONCE: Pace = Pace { row_us: 0, copy_us: 0, rest_us: 1000 };
/// Fetching a row takes so long that two cameras at once are not followed.
const TIMED: Pace = Pace { row_us: 100, copy_us: 60, rest_us: 50 };
/// From the start of a frame to that of the next one, while a sensor sends without a pause.
const PERIOD_US: u64 = 52 * TIMED.row_us;

/// Two cameras whose signals come when it is time, and their clock.
#[derive(Default)]
struct Bench {
    now_us: Cell<u64>,
    pace: Pace,
    signals: [RefCell<VecDeque<(u64, Signal)>>; 2],
    begun: [Cell<u32>; 2],
    /// Of the sensors: do they work, are they to send, what happened.
    is_dead: Cell<bool>,
    is_silent: Cell<bool>,
    stops: Cell<u32>,
    rests: Cell<u32>,
    /// Of those that act on a level: is it high, since when and until when; from its rise to the
    /// start of each one's frame, if it sends any.
    edges: RefCell<Vec<(u64, bool)>>,
    late_us: Cell<[Option<u64>; 2]>,
    next_us: Cell<[Option<u64>; 2]>,
}

impl Bench {
    fn new(pace: Pace) -> Rc<Self> {
        Rc::new(Self { pace, ..Self::default() })
    }

    fn rings(self: &Rc<Self>) -> [Ring; 2] {
        CameraSide::BOTH.map(|eye| Ring(self.clone(), eye))
    }

    fn pass(&self, us: u64) {
        self.now_us.set(self.now_us.get() + us);
    }

    fn begin(&self, eye: CameraSide, time_us: u64) {
        let first = 48 * self.begun[eye as usize].get();
        let start = (time_us, Signal::FrameStart { time_us, row: first });
        let rows = (1..=48).map(|row| {
            let time_us = time_us + u64::from(row) * self.pace.row_us;
            (time_us, Signal::Rows { end: first + row, bytes: 64, time_us })
        });
        self.signals[eye as usize].borrow_mut().extend([start].into_iter().chain(rows));
        self.begun[eye as usize].set(self.begun[eye as usize].get() + 1);
    }

    /// Frames that have started by the level until now.
    fn run(&self) {
        let mut next_us = self.next_us.get();
        for (eye, next_us) in CameraSide::BOTH.into_iter().zip(&mut next_us) {
            while let Some(start_us) = next_us.filter(|&start_us| start_us <= self.now_us.get()) {
                self.begin(eye, start_us);
                *next_us = Some(start_us + PERIOD_US);
            }
        }
        self.next_us.set(next_us);
    }

    fn begun(&self) -> [u32; 2] {
        self.begun.each_ref().map(Cell::get)
    }
}

/// The grey level of a pixel of a frame.
fn grey(eye: CameraSide, frame: u32, x: usize, y: u32) -> u8 {
    (x as u32 * 3 + y * 5 + eye as u32 * 77 + frame * 11) as u8
}

/// A ring that holds the last frame.
struct Ring(Rc<Bench>, CameraSide);

impl RowRing for Ring {
    fn rows(&self) -> u32 {
        64
    }

    fn next_signal(&mut self) -> Option<Signal> {
        self.0.run();
        let mut signals = self.0.signals[self.1 as usize].borrow_mut();
        signals
            .pop_front_if(|(time_us, _)| *time_us <= self.0.now_us.get())
            .map(|(_, signal)| signal)
    }

    fn written(&self) -> u32 {
        48 * self.0.begun[self.1 as usize].get()
    }

    fn copy(&self, row: u32, into: &mut [u8]) {
        for (x, pixel) in into.iter_mut().enumerate() {
            *pixel = grey(self.1, row / 48, x, row % 48);
        }
        self.0.pass(self.0.pace.copy_us);
    }

    fn now_us(&self) -> u64 {
        self.0.now_us.get()
    }

    fn rest(&self) {
        self.0.pass(self.0.pace.rest_us);
        self.0.rests.set(self.0.rests.get() + 1);
    }
}

/// Sensors that send a frame when they are triggered.
struct Sensors(Rc<Bench>);

impl Cameras for Sensors {
    fn shoot(&mut self) -> bool {
        let bench = &self.0;
        if bench.is_dead.get() {
            return false;
        }
        if !bench.is_silent.get() {
            CameraSide::BOTH.into_iter().for_each(|eye| bench.begin(eye, bench.now_us.get()));
        }
        true
    }

    fn follow(&mut self) -> Option<[i32; 2]> {
        Some([-300, -300])
    }

    fn stopped(&mut self) {
        self.0.stops.set(self.0.stops.get() + 1);
    }

    fn failures(&self) -> [u32; 2] {
        [u32::from(self.0.is_dead.get()), 0]
    }
}

fn source(start_us: u64) -> (Rc<Bench>, CameraSource<Ring, Sensors>) {
    let bench = Bench::new(AT_ONCE);
    bench.now_us.set(start_us);
    let capture = Capture::new(LIMITS, FrameStart::Triggered);
    let sensors = Sensors(bench.clone());
    (bench.clone(), CameraSource::new(bench.rings(), sensors, capture, DIMS, PATIENCE_US))
}

/// The pair that lies in a memory.
fn pixels(memory: &BoardMemory) -> [Vec<u8>; 2] {
    memory
        .views(DIMS)
        .unwrap()
        .map(|view| (0..48).flat_map(|y| view.row(y).unwrap().to_vec()).collect())
}

/// A frame of both cameras, by a rig.
fn rectified(remap: &Remap, frame: u32) -> [Vec<u8>; 2] {
    let mut memory = Box::new(BoardMemory::CLEARED);
    memory.set_rig(remap).unwrap();
    memory.restart();
    for y in 0..48 {
        for eye in CameraSide::BOTH {
            let row = memory.raw_row();
            row.iter_mut().enumerate().for_each(|(x, pixel)| *pixel = grey(eye, frame, x, y));
            memory.push_row(eye).unwrap();
        }
    }
    pixels(&memory)
}

#[test]
fn rows_are_rectified_as_they_come_and_times_are_those_of_the_exposure() {
    let (_, mut source) = source(1_000_000);
    let mut memory = Box::new(BoardMemory::CLEARED);
    memory.set_rig(&rectification().remap()).unwrap();
    for frame in 0..3 {
        let pair = source.next_pair(&mut *memory, Some(DIMS)).unwrap();
        assert_eq!((pair.dims, pair.frame_start), (DIMS, Some(FrameStart::Triggered)));
        // The times of `follow` after one pair count from the next one on.
        let middle_us = if frame == 0 { 0 } else { 300 };
        assert_eq!(pair.times_us, Some([1_000_000 - middle_us; 2]));

        assert_eq!(pixels(&memory), rectified(&rectification().remap(), frame));
    }
    assert_eq!((source.raw_dims(), source.losses()), (Some(DIMS), Some(CaptureReport::default())));
}

/// The next pair, of which nobody looks at the pixels.
fn next(source: &mut impl PairSource) -> Option<CapturedPair> {
    source.next_pair(&mut *Box::new(BoardMemory::CLEARED), None)
}

#[test]
fn sensors_that_cannot_be_triggered_give_no_pair_and_are_counted() {
    let (bench, mut source) = source(0);
    bench.is_dead.set(true);
    assert_eq!(next(&mut source), None);
    assert!(bench.now_us.get() > u64::from(PATIENCE_US), "a loop without a camera would not pause");
    assert_eq!(bench.rests.get(), bench.now_us.get() as u32 / 1000, "it sleeps all the time");
    assert_eq!(source.losses().unwrap().sensors, [1, 0]);
    bench.is_dead.set(false);
    assert!(next(&mut source).is_some());
}

#[test]
fn a_camera_that_stops_is_started_again_and_its_next_pair_comes() {
    let (bench, mut source) = source(0);
    assert!(next(&mut source).is_some());
    bench.is_silent.set(true);
    assert_eq!(next(&mut source), None);
    assert_eq!(bench.stops.get(), 2, "both are told of, once each");
    assert_eq!(faults(&source.losses().unwrap(), Fault::Stopped), [1, 1]);
    bench.is_silent.set(false);
    let pair = next(&mut source).unwrap();
    assert_eq!(pair.times_us.unwrap()[0], bench.now_us.get() - 300);
}

#[test]
fn nobody_says_that_nothing_moves_unless_somebody_does() {
    let (_, source) = source(0);
    assert_eq!(source.still_us(), None);
    assert_eq!(source.still(40_000).still_us(), Some(40_000));
}

/// Sensors that expose after the trigger and then send, the right one like the left one was last
/// told to be. The left one makes its exposure longer by itself.
struct Exposing {
    bench: Rc<Bench>,
    exposures_us: [u64; 2],
}

impl Cameras for Exposing {
    fn shoot(&mut self) -> bool {
        let now_us = self.bench.now_us.get();
        for (eye, exposure_us) in CameraSide::BOTH.into_iter().zip(self.exposures_us) {
            self.bench.begin(eye, now_us + exposure_us);
        }
        let [left_us, _] = &mut self.exposures_us;
        *left_us = (*left_us + 800).min(9_000);
        true
    }

    fn follow(&mut self) -> Option<[i32; 2]> {
        self.exposures_us = [self.exposures_us[0]; 2];
        Some([-(self.exposures_us[0] as i32) / 2; 2])
    }

    fn stopped(&mut self) {
        panic!("both send");
    }
}

#[test]
fn a_pair_that_is_missing_because_exposures_differ_makes_them_alike() {
    let bench = Bench::new(TIMED);
    // Further apart than `pair_us` from the beginning.
    let cameras = Exposing { bench: bench.clone(), exposures_us: [3000, 1000] };
    let capture = Capture::new(LIMITS, FrameStart::Triggered);
    let mut source = CameraSource::new(bench.rings(), cameras, capture, DIMS, 15_000);
    assert_eq!(next(&mut source), None);
    assert_eq!(source.losses().unwrap().unpaired, 1);
    for exposure_us in [3800, 4600, 5400] {
        let shot_us = bench.now_us.get();
        let pair = next(&mut source).expect("alike again");
        // From the middle of the exposure that follows from what it was told after the missing
        // pair.
        assert_eq!(pair.times_us, Some([shot_us + exposure_us - exposure_us / 2; 2]));
    }
}

/// The pin of [`Bench`]'s level, and its pause.
struct Level(Rc<Bench>);

impl ErrorType for Level {
    type Error = Infallible;
}

impl OutputPin for Level {
    fn set_high(&mut self) -> Result<(), Infallible> {
        let now_us = self.0.now_us.get();
        assert!(self.0.next_us.get() == [None; 2], "raised twice");
        self.0.next_us.set(self.0.late_us.get().map(|late_us| Some(now_us + late_us?)));
        self.0.edges.borrow_mut().push((now_us, true));
        Ok(())
    }

    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.run();
        self.0.next_us.set([None; 2]);
        if self.0.edges.borrow().last().is_some_and(|&(_, is_high)| is_high) {
            self.0.edges.borrow_mut().push((self.0.now_us.get(), false));
        }
        Ok(())
    }
}

impl DelayNs for Level {
    fn delay_ns(&mut self, ns: u32) {
        self.0.pass(u64::from(ns).div_ceil(1000));
    }
}

type Held = StereoCamera<Hm01b0Nibbles, Fake, NoReset, Fake, NoReset, Level, Level>;

/// Two HM01B0 whose frames start so long after the trigger's rise, the source of their pairs, and
/// their registers.
fn held(
    late_us: [Option<u64>; 2],
    limits: Limits,
) -> (Rc<Bench>, CameraSource<Ring, Held>, [Fake; 2]) {
    let bench = Bench::new(TIMED);
    bench.late_us.set(late_us);
    let fakes = [Fake::of::<Hm01b0Nibbles>(), Fake::of::<Hm01b0Nibbles>()];
    let [left, right] = fakes.clone().map(|fake| Chip::new(fake, Hm01b0Nibbles::ADDRESS, NoReset));
    let config = StereoConfig {
        config: Config::new(Dims { width: 324, height: 244 }, Binning::One, FrameStart::Triggered),
        exposure: PairExposure::LeftChooses,
        row_ns: 125_333,
        readout_us: 30_500,
    };
    let trigger = Trigger::new(Level(bench.clone())).unwrap();
    let cameras = StereoCamera::new((left, right), Some(trigger), Level(bench.clone()), config);
    let capture = Capture::new(limits, FrameStart::Triggered);
    let source = CameraSource::new(bench.rings(), cameras, capture, DIMS, PATIENCE_US);
    (bench, source, fakes)
}

/// The last two edges: when the level was raised, and for how long it was high. There were so many
/// before.
fn last_pulse(bench: &Bench, before: usize) -> (u64, u64) {
    let edges = bench.edges.borrow();
    let [(from_us, true), (to_us, false)] = edges[before..] else { panic!("{edges:?}") };
    (from_us, to_us - from_us)
}

#[test]
fn a_level_is_high_from_the_shot_to_the_start_of_the_second_frame() {
    for late_us in [[300, 700], [700, 300], [500, 500], [0, 0]] {
        let (bench, mut source, _) = held(late_us.map(Some), LIMITS);
        for pairs in 0..3 {
            let requested_us = bench.now_us.get();
            // Starting the sensors takes longer than the longest silence, and than a pair may take.
            let pair = next(&mut source).expect("a pair");
            let (shot_us, held_us) = last_pulse(&bench, 2 * pairs);
            let second_us = late_us[0].max(late_us[1]);
            // Looked for every 50 us, while rows of the other camera are fetched.
            assert!((second_us..second_us + 150).contains(&held_us), "{late_us:?}: {held_us}");
            assert_eq!(shot_us > requested_us, pairs == 0, "started once");
            let middle_us = if pairs == 0 { 0 } else { 15_250 - 258 * 125_333 / 2000 };
            let times_us = late_us.map(|late_us| shot_us + late_us);
            assert_eq!(
                pair.times_us,
                Some(times_us.map(|time_us| time_us.saturating_add_signed(middle_us)))
            );
            assert_eq!(bench.begun(), [pairs as u32 + 1; 2], "one frame of each, no second one");
        }
        assert_eq!(source.losses(), Some(CaptureReport::default()));
    }
}

#[test]
fn a_level_is_lowered_when_no_pair_comes() {
    let patient = Limits { silence_us: 1_000_000, ..LIMITS };
    for late_us in [[None, None], [Some(300), None], [None, Some(300)]] {
        for (limits, least_us) in [(LIMITS, LIMITS.silence_us), (patient, PATIENCE_US)] {
            let (bench, mut source, _) = held(late_us, limits);
            assert_eq!(next(&mut source), None);
            let (_, held_us) = last_pulse(&bench, 0);
            let least_us = u64::from(least_us);
            assert!((least_us..least_us + 500).contains(&held_us), "{late_us:?}: {held_us}");
            // Frames under way end; then both work.
            bench.pass(2 * PERIOD_US);
            bench.late_us.set([Some(300); 2]);
            assert!((0..2).any(|_| next(&mut source).is_some()), "{late_us:?}");
            assert_eq!(bench.edges.borrow().last().map(|&(_, is_high)| is_high), Some(false));
        }
    }
}

#[test]
fn a_level_is_not_raised_for_sensors_that_do_not_start() {
    let (bench, mut source, [left, _]) = held([Some(300); 2], LIMITS);
    left.0.borrow_mut().fails_after = Some(9);
    assert_eq!(next(&mut source), None);
    assert_eq!((bench.edges.borrow().len(), source.losses().unwrap().sensors), (0, [1, 0]));
    assert!(next(&mut source).is_some());
}

#[test]
fn frames_that_nobody_asked_for_do_not_lower_a_level() {
    let (bench, mut source, _) = held([Some(8000); 2], LIMITS);
    assert!(next(&mut source).is_some());
    for eye in CameraSide::BOTH {
        bench.begin(eye, bench.now_us.get() + 50);
        bench.pass(PERIOD_US); // too far apart for a pair
    }
    let pair = next(&mut source).expect("a pair");
    let (shot_us, held_us) = last_pulse(&bench, 2);
    assert!(pair.times_us.unwrap()[0].abs_diff(shot_us) < 20_000 && held_us >= 8000);
    assert_eq!(bench.begun(), [3; 2]);
}

#[test]
fn sensors_that_are_started_again_have_not_been_silent() {
    let (_, mut source, [left, right]) = held([Some(300); 2], LIMITS);
    // The right one does not take what the left one has chosen: neither runs.
    assert!(next(&mut source).is_some());
    [(0x0202, 0), (0x0203, 77)].into_iter().for_each(|(register, value)| left.set(register, value)); // rows
    right.0.borrow_mut().fails_after = Some(0);
    assert!(next(&mut source).is_some());
    assert_eq!(source.losses().unwrap().sensors, [0, 1]);
    assert!(next(&mut source).is_some(), "starting takes longer than the longest silence");
    assert_eq!(source.losses().unwrap().faults, [[0; 7]; 2]);
}
