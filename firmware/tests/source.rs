//! Cameras as the source of pairs, from the trigger to frames that are rectified while their rows come; and what happens when they fail.

use core::cell::{Cell, RefCell};
use linestereo::{Calibration, Camera, Dims, Eye, Lens, Rectification, View};
use linestereo_firmware::boards::mps2_an386::Workspace;
use linestereo_firmware::camera::FrameStart;
use linestereo_firmware::capture::*;
use linestereo_firmware::memory::Memory;
use linestereo_firmware::ports::PairSource;
use std::collections::VecDeque;
use std::rc::Rc;

const DIMS: Dims = Dims { width: 64, height: 48 };
const LIMITS: Limits = Limits { rows: 48, row_bytes: 64, row_gap_us: 200, silence_us: 20_000, pair_us: 500 };
const PATIENCE_US: u32 = 50_000;

/// What both cameras and their clock share.
#[derive(Default)]
struct Bench {
    now_us: Cell<u64>,
    signals: [RefCell<VecDeque<Signal>>; 2],
    frames: Cell<u32>,
    /// Of the sensors: do they work, are they to send, what happened.
    is_dead: Cell<bool>,
    is_silent: Cell<bool>,
    stops: Cell<u32>,
    rests: Cell<u32>,
}

/// The grey level of a pixel of a frame.
fn grey(eye: Eye, frame: u32, x: usize, y: u32) -> u8 {
    (x as u32 * 3 + y * 5 + eye as u32 * 77 + frame * 11) as u8
}

/// A ring that holds the last frame, whose rows are there at once.
struct Ring(Rc<Bench>, Eye);

impl RowRing for Ring {
    fn rows(&self) -> u32 {
        64
    }

    fn next_signal(&mut self) -> Option<Signal> {
        self.0.signals[self.1 as usize].borrow_mut().pop_front()
    }

    fn written(&self) -> u32 {
        48 * self.0.frames.get()
    }

    fn copy(&self, row: u32, into: &mut [u8]) {
        for (x, pixel) in into.iter_mut().enumerate() {
            *pixel = grey(self.1, row / 48, x, row % 48);
        }
    }

    fn now_us(&self) -> u64 {
        self.0.now_us.get()
    }

    fn rest(&self) {
        self.0.now_us.set(self.0.now_us.get() + 1000);
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
        if bench.is_silent.get() {
            return true;
        }
        let (time_us, first) = (bench.now_us.get(), 48 * bench.frames.get());
        for signals in &bench.signals {
            let rows = Signal::Rows { end: first + 48, bytes: 48 * 64, time_us: time_us + 100 };
            signals.borrow_mut().extend([Signal::FrameStart { time_us, row: first }, rows]);
        }
        bench.frames.set(bench.frames.get() + 1);
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
    let bench = Rc::new(Bench::default());
    bench.now_us.set(start_us);
    let rings = Eye::BOTH.map(|eye| Ring(bench.clone(), eye));
    let capture = Capture::new(LIMITS, FrameStart::Triggered);
    (bench.clone(), CameraSource::new(rings, Sensors(bench), capture, DIMS, PATIENCE_US))
}

fn rectification() -> Rectification {
    let lens = Lens::BrownConrady { k: [-0.1, 0.0, 0.0], p: [0.0; 2] };
    let camera = || Camera::new(DIMS, [50.0; 2], [31.0, 24.0], 0.0, lens).unwrap();
    let rig = Calibration::new(camera(), camera(), [1.0, 0.001, -0.002, 0.003], [-0.06, 0.0, 0.0]).unwrap();
    *rig.rectify(DIMS, View::default()).as_ref().unwrap()
}

#[test]
fn rows_are_rectified_as_they_come_and_times_are_those_of_the_exposure() {
    let (_, mut source) = source(1_000_000);
    let mut memory = Box::new(Workspace::new());
    memory.set_rig(&rectification()).unwrap();
    for frame in 0..3 {
        let pair = source.next_pair(&mut *memory, Some(DIMS)).unwrap();
        assert_eq!((pair.dims, pair.frame_start), (DIMS, Some(FrameStart::Triggered)));
        // What `follow` has said after one pair counts from the next one on.
        let middle_us = if frame == 0 { 0 } else { 300 };
        assert_eq!(pair.times_us, Some([1_000_000 - middle_us; 2]));

        let mut expected = Box::new(Workspace::new());
        expected.set_rig(&rectification()).unwrap();
        expected.restart();
        for y in 0..48 {
            for eye in Eye::BOTH {
                let row = expected.raw_row();
                row.iter_mut().enumerate().for_each(|(x, pixel)| *pixel = grey(eye, frame, x, y));
                expected.push_row(eye).unwrap();
            }
        }
        let pixels = |memory: &Workspace| {
            let views = memory.views(DIMS).unwrap();
            views.map(|view| (0..48).flat_map(|y| view.row(y).unwrap().to_vec()).collect::<Vec<u8>>())
        };
        assert_eq!(pixels(&memory), pixels(&expected));
    }
    assert_eq!((source.raw_dims(), source.losses()), (Some(DIMS), Some(Losses::default())));
}

#[test]
fn sensors_that_cannot_be_triggered_give_no_pair_and_are_counted() {
    let (bench, mut source) = source(0);
    let mut memory = Box::new(Workspace::new());
    bench.is_dead.set(true);
    assert_eq!(source.next_pair(&mut *memory, None), None);
    assert!(bench.now_us.get() > u64::from(PATIENCE_US), "a loop without a camera would not pause");
    assert_eq!(bench.rests.get(), bench.now_us.get() as u32 / 1000, "it sleeps all the time");
    assert_eq!(source.losses().unwrap().sensors, [1, 0]);
    bench.is_dead.set(false);
    assert!(source.next_pair(&mut *memory, None).is_some());
}

#[test]
fn a_camera_that_stops_is_started_again_and_its_next_pair_comes() {
    let (bench, mut source) = source(0);
    let mut memory = Box::new(Workspace::new());
    assert!(source.next_pair(&mut *memory, None).is_some());
    bench.is_silent.set(true);
    assert_eq!(source.next_pair(&mut *memory, None), None);
    assert_eq!(bench.stops.get(), 2, "both are told of, once each");
    let losses = source.losses().unwrap();
    assert_eq!(Eye::BOTH.map(|eye| losses.of(eye, Fault::Stopped)), [1, 1]);
    bench.is_silent.set(false);
    let pair = source.next_pair(&mut *memory, None).unwrap();
    assert_eq!(pair.times_us.unwrap()[0], bench.now_us.get() - 300);
}

#[test]
fn nobody_says_that_nothing_moves_unless_somebody_does() {
    let (_, source) = source(0);
    assert_eq!(source.still_us(), None);
    assert_eq!(source.still(40_000).still_us(), Some(40_000));
}
