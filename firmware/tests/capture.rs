//! The capture path on fake hardware with faults.
//!
//! Two fake cameras write rows into rings, as a DMA does, whether anybody looks or not. What is
//! injected is counted where it is injected.

use crate::support::rows::{WIDTH, faults, frames_in, frames_of, paint, read};
use crate::support::{random::Random, rectification};
use core::cell::RefCell;
use linestereo::{Dims, Matcher, Options, Params, health::HealthFlags};
use linestereo_firmware::boards::mps2_an386::BoardMemory;
use linestereo_firmware::capture::*;
use linestereo_firmware::memory::Memory;
use linestereo_firmware::ports::{CapturedPair, FrameStart, PairSource};
use linestereo_rig::{CameraSide, RowError};
use linestereo_wire::CaptureReport;
use std::collections::{BTreeSet, VecDeque};
use std::rc::Rc;

const ROWS: u32 = 12;
const RING: u32 = 4;
/// Microseconds of a row, and of the pause between two frames.
const ROW_US: u64 = 10;
const PAUSE_US: u64 = 80;
const PERIOD_US: u64 = ROWS as u64 * ROW_US + PAUSE_US;
/// Signals that are kept for somebody who does not look.
const QUEUE: usize = 1 << 12;

const LIMITS: Limits = Limits {
    rows: ROWS as u16,
    row_bytes: WIDTH,
    row_gap_us: 3 * ROW_US as u32,
    readout_us: PERIOD_US as u32,
    silence_us: 2 * PERIOD_US as u32,
    pair_us: PERIOD_US as u32 / 4,
};

/// Fate of a frame of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Injected {
    Nothing,
    /// After this row.
    Overrun(u32),
    MissingVsync,
    /// Ends after this many rows; the next frame follows with its VSYNC.
    Early(u32),
    /// This row is short.
    Short(u32),
    /// Pauses after this many rows; the rest of the rows is the next frame's, whose VSYNC is lost.
    Torn(u32),
    /// Nothing comes, from this row on, for this frame and a few after it.
    Stops(u32),
    /// Still stopped.
    Silent,
}

/// Actions of a camera's hardware, in order.
#[derive(Clone, Copy, Debug)]
enum Step {
    Vsync,
    /// Row of a frame, with so many bytes.
    Row {
        frame: u32,
        row: u32,
        bytes: u32,
    },
    Overrun,
}

/// The steps of a frame, from the time at which it starts.
fn script(
    eye: CameraSide,
    frame: u32,
    what: Injected,
    after_torn: Option<u32>,
) -> Vec<(u64, Step)> {
    let skew_us = if eye == CameraSide::Left { 0 } else { 3 };
    let start = u64::from(frame) * PERIOD_US + skew_us;
    let mut steps = Vec::new();
    let first = after_torn.unwrap_or(0);
    if what == Injected::Silent {
        return steps;
    }
    if what != Injected::MissingVsync && after_torn.is_none() {
        steps.push((start, Step::Vsync));
    }
    for row in first..ROWS {
        let time = start + u64::from(row + 1) * ROW_US;
        match what {
            Injected::Early(rows) | Injected::Torn(rows) | Injected::Stops(rows) if row >= rows => {
                break;
            }
            _ => {}
        }
        let bytes = if what == Injected::Short(row) { u32::from(WIDTH) - 1 } else { WIDTH.into() };
        steps.push((time, Step::Row { frame, row, bytes }));
        if what == Injected::Overrun(row) {
            steps.push((time + 1, Step::Overrun));
        }
    }
    steps
}

/// Both cameras and their clock.
struct Hardware {
    now_us: u64,
    cameras: [FakeCamera; 2],
}

impl Hardware {
    /// Both send this frame, with what happens to it.
    fn play(&mut self, frame: u32, what: impl Fn(CameraSide, u32) -> Injected) {
        for camera in &mut self.cameras {
            camera.steps.extend(script(camera.eye, frame, what(camera.eye, frame), None));
        }
    }
}

struct FakeCamera {
    eye: CameraSide,
    steps: VecDeque<(u64, Step)>,
    ring: Vec<[u8; WIDTH as usize]>,
    written: u32,
    queue: VecDeque<Signal>,
    is_lost: bool,
}

impl FakeCamera {
    fn new(eye: CameraSide, first_row: u32) -> Self {
        let ring = vec![[0xee; WIDTH as usize]; RING as usize];
        Self {
            eye,
            steps: VecDeque::new(),
            ring,
            written: first_row,
            queue: VecDeque::new(),
            is_lost: false,
        }
    }

    fn say(&mut self, signal: Signal) {
        if self.is_lost || self.queue.len() >= QUEUE {
            self.is_lost = true;
        } else {
            self.queue.push_back(signal);
        }
    }

    /// Does what was to be done until now. The row that is being written is half new and half old.
    fn advance(&mut self, now_us: u64) {
        while let Some(&(time_us, step)) = self.steps.front()
            && time_us <= now_us
        {
            self.steps.pop_front();
            match step {
                Step::Vsync => self.say(Signal::FrameStart { time_us, row: self.written }),
                Step::Row { frame, row, bytes } => {
                    self.ring[(self.written % RING) as usize] = paint(self.eye, frame, row);
                    self.written = self.written.wrapping_add(1);
                    self.say(Signal::Rows { end: self.written, bytes, time_us });
                }
                Step::Overrun => self.say(Signal::Overrun { time_us }),
            }
        }
        if let Some(&(time_us, Step::Row { frame, row, .. })) = self.steps.front()
            && time_us.saturating_sub(now_us) < ROW_US
        {
            let half = usize::from(WIDTH / 2);
            let next = paint(self.eye, frame, row);
            self.ring[(self.written % RING) as usize][..half].copy_from_slice(&next[..half]);
        }
    }
}

/// One camera's ring, of the hardware that both share.
struct FakeRing {
    hardware: Rc<RefCell<Hardware>>,
    eye: CameraSide,
    /// Time passes with every row that is copied.
    copy_us: u64,
    /// Time passes with every look at the clock.
    look_us: u64,
}

impl FakeRing {
    fn camera<T>(&self, with: impl FnOnce(&mut FakeCamera) -> T) -> T {
        with(&mut self.hardware.borrow_mut().cameras[self.eye as usize])
    }
}

fn pass(hardware: &RefCell<Hardware>, us: u64) {
    let mut hardware = hardware.borrow_mut();
    hardware.now_us += us;
    let now_us = hardware.now_us;
    hardware.cameras.iter_mut().for_each(|camera| camera.advance(now_us));
}

impl RowRing for FakeRing {
    fn rows(&self) -> u32 {
        RING
    }

    fn next_signal(&mut self) -> Option<Signal> {
        self.camera(|camera| {
            let lost = (camera.queue.is_empty() && camera.is_lost).then_some(Signal::Lost);
            camera.is_lost &= lost.is_none();
            camera.queue.pop_front().or(lost)
        })
    }

    fn written(&self) -> u32 {
        self.camera(|camera| camera.written)
    }

    fn copy(&self, row: u32, into: &mut [u8]) {
        assert_eq!(into.len(), usize::from(WIDTH), "a row has another length");
        // From the end: the row that is being written is new at its start.
        let half = into.len() / 2;
        self.camera(|camera| {
            assert!(
                camera.written.wrapping_sub(row) < 1 << 31 && camera.written != row,
                "row {row} is not complete"
            );
            into[half..].copy_from_slice(&camera.ring[(row % RING) as usize][half..]);
        });
        // The hardware does not wait for a copy.
        pass(&self.hardware, self.copy_us);
        self.camera(|camera| {
            into[..half].copy_from_slice(&camera.ring[(row % RING) as usize][..half])
        });
    }

    fn now_us(&self) -> u64 {
        pass(&self.hardware, self.look_us);
        self.hardware.borrow().now_us
    }
}

/// The hardware as a source of pairs; a microsecond passes with every look at its clock.
fn source(
    hardware: &Rc<RefCell<Hardware>>,
    start: FrameStart,
    patience_us: u64,
) -> CameraSource<FakeRing> {
    let rings = rings(hardware).map(|ring| FakeRing { look_us: 1, ..ring });
    CameraSource::new(rings, FreeCameras, Capture::new(LIMITS, start), DIMS, patience_us as u32)
}

fn hardware(first_row: u32) -> Rc<RefCell<Hardware>> {
    let cameras = CameraSide::BOTH.map(|eye| FakeCamera::new(eye, first_row));
    Rc::new(RefCell::new(Hardware { now_us: 0, cameras }))
}

fn rings(hardware: &Rc<RefCell<Hardware>>) -> [FakeRing; 2] {
    CameraSide::BOTH.map(|eye| FakeRing { hardware: hardware.clone(), eye, copy_us: 0, look_us: 0 })
}

const DIMS: Dims = Dims { width: WIDTH, height: ROWS as u16 };
type Frames = [[u8; WIDTH as usize * ROWS as usize]; 2];

/// The frame that lies there whole, of both cameras. Anything else is the failure that must not be.
fn frame_of(frames: Result<[u32; 2], String>) -> Result<u32, String> {
    let [left, right] = frames?;
    if left == right { Ok(left) } else { Err(format!("frame {left} beside frame {right}")) }
}

/// Faults of the left and the right camera, by kind.
type Faults = [[u32; Fault::ALL.len()]; 2];

/// Events, and the outcome that they must have.
struct Plan {
    injected: [Vec<Injected>; 2],
    /// Before this frame's row 3 has come nothing is worked on, until its row 9.
    stalls: BTreeSet<u32>,
    faults: Faults,
    /// Frames that nothing has happened to, in either camera.
    good: Vec<u32>,
}

impl Plan {
    /// Faults in a part of the frames; a fault changes nothing but its own camera's frames.
    fn random(frames: u32, percent: u32, seed: u64) -> Self {
        let mut random = Random(seed);
        let mut plan = Self {
            injected: [const { Vec::new() }; 2],
            stalls: BTreeSet::new(),
            faults: Faults::default(),
            good: Vec::new(),
        };
        // Faults of each camera's frame, for the reasons before it.
        let mut carried = [0_u32; 2];
        for frame in 0..frames {
            let mut is_good = true;
            for (eye, (list, carried)) in plan.injected.iter_mut().zip(&mut carried).enumerate() {
                let is_last = frame + 8 > frames;
                if *carried > 0 {
                    // Silent, or the second half of what was torn.
                    let before = list[frame as usize - 1];
                    let torn = matches!(before, Injected::Torn(_));
                    list.push(if torn { Injected::Nothing } else { Injected::Silent });
                    *carried -= 1;
                    is_good = false;
                    continue;
                }
                let row = 2 + random.below(ROWS - 4);
                let (what, fault) = match random.below(100 * 6 / percent.max(1)) {
                    _ if is_last => (Injected::Nothing, None),
                    0 => (Injected::Overrun(row), Some(Fault::Overrun)),
                    // The first frame is not known to be missing, and what ends early ends with a
                    // VSYNC: else it is torn.
                    1 if frame > 0 && !matches!(list[frame as usize - 1], Injected::Early(_)) => {
                        (Injected::MissingVsync, Some(Fault::MissingVsync))
                    }
                    2 => (Injected::Early(row), Some(Fault::EarlyVsync)),
                    3 => (Injected::Short(row), Some(Fault::ShortLine)),
                    4 => {
                        *carried = 1;
                        (Injected::Torn(row), Some(Fault::TornFrame))
                    }
                    5 => {
                        *carried = 3 + random.below(3);
                        (Injected::Stops(row), Some(Fault::Stopped))
                    }
                    _ => (Injected::Nothing, None),
                };
                list.push(what);
                is_good &= fault.is_none();
                if let Some(fault) = fault {
                    plan.faults[eye][fault as usize] += 1;
                }
            }
            // A pair that all is well with is worked on too slowly.
            if is_good && frame > 0 && frame + 8 < frames && random.below(100) < percent / 2 {
                plan.stalls.insert(frame);
                // More rows than the ring holds come of both meanwhile.
                plan.faults.iter_mut().for_each(|of| of[Fault::TooSlow as usize] += 1);
                is_good = false;
            }
            if is_good {
                plan.good.push(frame);
            }
        }
        plan
    }
}

/// Feeds the cameras frame by frame, and collects what is reported.
struct Run {
    pairs: Vec<(u32, CapturedPair)>,
    reported: Faults,
    losses: CaptureReport,
}

fn run(plan: &Plan, first_row: u32) -> Result<Run, String> {
    let hardware = hardware(first_row);
    let mut rings = rings(&hardware);
    let mut capture = Capture::new(LIMITS, FrameStart::Triggered);
    let mut sink = Kept::EMPTY;
    let (mut pairs, mut reported) = (Vec::new(), Faults::default());
    let count = plan.injected[0].len() as u32;
    for frame in 0..count {
        for (camera, list) in hardware.borrow_mut().cameras.iter_mut().zip(&plan.injected) {
            let before = frame.checked_sub(1).and_then(|before| list.get(before as usize));
            let after_torn =
                if let Some(Injected::Torn(rows)) = before { Some(*rows) } else { None };
            let what = list.get(frame as usize).copied().unwrap_or(Injected::Silent);
            camera.steps.extend(script(camera.eye, frame, what, after_torn));
        }
        let start = u64::from(frame) * PERIOD_US;
        let end = start + PERIOD_US;
        loop {
            // From one thing that happens to the next; a stall goes to row 9 at once.
            let now = hardware.borrow().now_us;
            let next_us = |camera: &FakeCamera| camera.steps.front().map(|step| step.0);
            let next = hardware.borrow().cameras.iter().filter_map(next_us).min();
            let next = next.unwrap_or(end).min(end);
            let is_stalled = plan.stalls.contains(&frame)
                && (start + 3 * ROW_US..start + 9 * ROW_US).contains(&next);
            pass(&hardware, next - now);
            if !is_stalled {
                while let Some(report) = capture.turn(&mut rings, &mut sink) {
                    match report {
                        Report::Pair(pair) => pairs.push((frame_of(frames_of(sink.frames))?, pair)),
                        Report::Fault(eye, fault) => reported[eye as usize][fault as usize] += 1,
                        other => return Err(format!("{other:?}")),
                    }
                }
            }
            if next == end {
                break;
            }
        }
    }
    Ok(Run { pairs, reported, losses: *capture.losses() })
}

/// Frames that stay while the hardware's time passes; refuses what a rectifier would.
struct Kept {
    rows: [u16; 2],
    frames: Frames,
}

impl Kept {
    const EMPTY: Self = Self { rows: [0; 2], frames: [[0; _]; 2] };
}

impl RowSink for Kept {
    fn restart(&mut self, eye: CameraSide) {
        self.rows[eye as usize] = 0;
    }

    fn row(&mut self, eye: CameraSide) -> &mut [u8] {
        let row = usize::from(self.rows[eye as usize]);
        self.frames[eye as usize].chunks_mut(WIDTH.into()).nth(row).expect("a row too many")
    }

    /// A rectifier would use the row at once: it has to be whole, of this camera, in its place, and
    /// of the frame that it is in.
    fn push(&mut self, eye: CameraSide) -> Result<(), RowError> {
        let rows = &mut self.rows[eye as usize];
        let mut all = self.frames[eye as usize].chunks(WIDTH.into()).map(read);
        let last = all.clone().nth((*rows).into()).unwrap();
        let first = all.next().unwrap().expect("the first row is torn").1;
        let expected = Some((eye, first, (*rows).into()));
        assert_eq!(last, expected, "a row that is torn or of another frame");
        *rows += 1;
        Ok(())
    }

    fn complete(&self) -> Option<Dims> {
        (self.rows == [ROWS as u16; 2]).then_some(DIMS)
    }
}

#[test]
fn a_hundred_thousand_frames_with_faults() {
    let seed = 7;
    for (frames, percent, first_row) in [(100_000, 12, 0), (10_000, 60, u32::MAX - 50_000)] {
        let plan = Plan::random(frames, percent, seed);
        let run = run(&plan, first_row).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        assert_eq!([run.reported, run.losses.faults], [plan.faults; 2], "seed {seed}");
        for (fault, injected) in Fault::ALL.iter().zip(plan.faults[0]) {
            assert!(injected > 0, "{fault:?} was never injected");
        }
        // Every pair that nothing happened to is delivered, in order, and no other.
        let delivered = run.pairs.iter().map(|(frame, _)| *frame).collect::<Vec<_>>();
        assert!(delivered.windows(2).all(|two| two[0] < two[1]), "a frame came twice, or late");
        assert!(delivered.iter().eq(&plan.good), "seed {seed}");
        // How long it takes from the last frame that something happened to.
        let is_good = |frame: u32| plan.good.binary_search(&frame).is_ok();
        let recovery = delivered
            .iter()
            .map(|&frame| (0..frame).rev().take_while(|&before| !is_good(before)).count());
        let behind = recovery.filter(|&bad| bad > 0).count();
        assert!(behind as u32 > frames / 100);
        for (frame, pair) in &run.pairs {
            let start = u64::from(*frame) * PERIOD_US;
            assert_eq!((pair.dims, pair.times_us), (DIMS, Some([start, start + 3])));
            assert_eq!(pair.frame_start, Some(FrameStart::Triggered));
        }
        assert_eq!(run.losses.skipped, 0);
    }
}

/// Plays frames of both cameras from a list, with a consumer that works on every pair for a while.
fn play(
    frames: u32,
    work_us: u64,
    what: impl Fn(CameraSide, u32) -> Injected,
    copy_us: u64,
) -> (Vec<u32>, CaptureReport) {
    let hardware = hardware(0);
    // The cameras go on while the last pair is worked on.
    for frame in 0..frames + (work_us / PERIOD_US) as u32 + 4 {
        hardware.borrow_mut().play(frame, &what);
    }
    let mut rings = rings(&hardware).map(|ring| FakeRing { copy_us, ..ring });
    let mut capture = Capture::new(LIMITS, FrameStart::Triggered);
    let mut sink = Kept::EMPTY;
    let mut delivered = Vec::new();
    while hardware.borrow().now_us < u64::from(frames) * PERIOD_US {
        pass(&hardware, 1);
        while let Some(report) = capture.turn(&mut rings, &mut sink) {
            if let Report::Pair(_) = report {
                delivered.push(frame_of(frames_of(sink.frames)).unwrap());
                let before = sink.frames;
                pass(&hardware, work_us);
                assert_eq!(sink.frames, before, "a pair changes while it is worked on");
            }
        }
    }
    (delivered, *capture.losses())
}

#[test]
fn work_that_takes_longer_than_a_frame_skips_frames() {
    let nothing = |_, _| Injected::Nothing;
    for work_us in [0, PAUSE_US / 2, PERIOD_US, PERIOD_US * 3 / 2, PERIOD_US * 5, PERIOD_US * 400] {
        let (delivered, losses) = play(2000, work_us, nothing, 0);
        assert!(
            delivered.windows(2).all(|two| two[0] < two[1]),
            "{work_us}: a frame came twice, or late"
        );
        assert!(
            delivered.len() as u64 >= 2000 * PERIOD_US / (work_us + 3 * PERIOD_US),
            "{work_us}: {}",
            delivered.len()
        );
        let is_lost = work_us > QUEUE as u64 / u64::from(ROWS + 1) * PERIOD_US;
        let is_skipped = work_us > PAUSE_US;
        assert_eq!(losses.skipped > 0, is_skipped, "{work_us}: {losses:?}");
        // Signals that nobody fetched are lost, and that is said, of each camera.
        let slow = faults(&losses, Fault::TooSlow);
        assert_eq!(slow.map(|count| count > 0), [is_lost; 2], "{work_us}: {losses:?}");
        let all: u32 = losses.faults.iter().flatten().sum();
        assert_eq!(all, slow[0] + slow[1], "{work_us}: {losses:?}");
        if !is_skipped {
            assert_eq!(delivered, (0..2000).collect::<Vec<_>>());
        }
    }
}

#[test]
fn a_row_that_is_overwritten_while_it_is_copied_is_not_used() {
    for copy_us in [2, 6, 11, 25, 39] {
        let (delivered, losses) = play(500, 0, |_, _| Injected::Nothing, copy_us);
        let is_slow = faults(&losses, Fault::TooSlow) != [0; 2];
        // A row of both takes 2 * copy_us and comes every 10: after 12 rows the ring has to hold
        // what is behind, in less than 4 rows.
        let is_late =
            u64::from(ROWS) * (2 * copy_us).saturating_sub(ROW_US) > u64::from(RING - 1) * ROW_US;
        assert_eq!((is_slow, delivered.len() == 500), (is_late, !is_late), "{copy_us}: {losses:?}");
    }
}

#[test]
fn both_cameras_stop_and_come_back() {
    let what = |_, frame| match frame {
        5 => Injected::Stops(4),
        6..10 => Injected::Silent,
        _ => Injected::Nothing,
    };
    let (delivered, losses) = play(20, 0, what, 0);
    assert_eq!(delivered, (0..5).chain(10..20).collect::<Vec<_>>());
    assert_eq!(faults(&losses, Fault::Stopped), [1, 1]);
    assert_eq!((losses.faults.iter().flatten().sum::<u32>(), losses.unpaired), (2, 0));
}

#[test]
fn a_frame_without_a_partner_is_counted() {
    // The right camera starts three frames late; the left one's are whole and of no use.
    let what = |eye, frame| {
        if eye == CameraSide::Right && frame < 3 { Injected::Silent } else { Injected::Nothing }
    };
    let (delivered, losses) = play(10, 0, what, 0);
    assert_eq!(delivered, (3..10).collect::<Vec<_>>());
    assert_eq!((losses.unpaired, faults(&losses, Fault::Stopped)[1]), (3, 1));
}

/// Cameras that run by themselves, each at its own pace; the right one starts so much later.
fn running(frames: u32, later_us: u64, longer_us: u64) -> Rc<RefCell<Hardware>> {
    let hardware = hardware(0);
    for frame in 0..frames {
        let [left, right] = &mut hardware.borrow_mut().cameras;
        left.steps.extend(script(CameraSide::Left, frame, Injected::Nothing, None));
        let late_us = later_us + u64::from(frame) * longer_us;
        let steps = script(CameraSide::Right, frame, Injected::Nothing, None);
        right.steps.extend(steps.into_iter().map(|(time_us, step)| (time_us - 3 + late_us, step)));
    }
    hardware
}

#[test]
fn cameras_that_run_free_say_so_and_are_paired_with_what_is_nearest() {
    let hardware = running(400, 0, 1);
    let mut source = source(&hardware, FrameStart::Free, 200 * PERIOD_US);
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut skews = Vec::new();
    while let Some(pair) = source.next_pair(&mut *memory, None) {
        assert_eq!(pair.frame_start, Some(FrameStart::Free));
        let [left_us, right_us] = pair.times_us.unwrap();
        // The times are those of the frames that lie there.
        let [left, right] = frames_in(&mut *memory, ROWS).unwrap().map(u64::from);
        assert_eq!([left_us, right_us], [left * PERIOD_US, right * (PERIOD_US + 1)]);
        skews.push(left_us.abs_diff(right_us));
    }
    assert!(skews.iter().all(|&skew| skew <= u64::from(LIMITS.pair_us)), "{skews:?}");
    assert!(skews.contains(&LIMITS.pair_us.into()) && skews.contains(&0), "{skews:?}");
    assert!(source.capture.losses().unpaired > 100, "{:?}", source.capture.losses());
}

#[test]
fn no_pair_for_long_is_a_pair_that_is_missing() {
    let hardware = hardware(0);
    let mut source = source(&hardware, FrameStart::Triggered, 5000);
    assert_eq!(source.next_pair(&mut *Box::new(BoardMemory::CLEARED), None), None);
    assert_eq!(faults(source.capture.losses(), Fault::Stopped), [1, 1]);
    assert!((5000..5010).contains(&hardware.borrow().now_us));
}

#[test]
fn cameras_that_nobody_asked_have_not_stopped() {
    let hardware = hardware(0);
    let mut source = source(&hardware, FrameStart::Triggered, PERIOD_US);
    let mut memory = Box::new(BoardMemory::CLEARED);
    // Two frames, far more than the longest silence apart, each just after it was asked for.
    for frame in [2, 40] {
        let start_us = u64::from(frame) * PERIOD_US;
        hardware.borrow_mut().play(frame, |_, _| Injected::Nothing);
        let now_us = hardware.borrow().now_us;
        pass(&hardware, start_us - 5 - now_us);
        assert!(source.next_pair(&mut *memory, None).is_some(), "frame {frame}");
    }
    assert_eq!(source.capture.losses().faults, [[0; 7]; 2]);
}

#[test]
fn a_frame_that_was_begun_for_another_call_is_left() {
    let hardware = hardware(0);
    (2..6).for_each(|frame| hardware.borrow_mut().play(frame, |_, _| Injected::Nothing));
    // The first call ends two rows after frame 2 has started.
    let mut source = source(&hardware, FrameStart::Triggered, 2 * PERIOD_US + 25);
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut next = || {
        let pair = source.next_pair(&mut *memory, None);
        pair.map(|pair| {
            (frame_of(frames_in(&mut *memory, ROWS)).unwrap(), pair.times_us.unwrap()[0])
        })
    };
    assert_eq!(
        [next(), next(), next()],
        [None, Some((3, 3 * PERIOD_US)), Some((4, 4 * PERIOD_US))]
    );
}

#[test]
fn the_skew_of_a_pair_reaches_the_health_check() {
    // Of a size that the core takes; only the times matter.
    let dims = Dims { width: 128, height: 96 };
    let matcher = Matcher::new(Params::DEFAULT, dims).unwrap();
    for (later_us, middle_us, is_refused) in
        [(20, [0, 0], false), (20, [0, 1000], true), (20, [-400, 0], false)]
    {
        let hardware = running(3, later_us, 0);
        let mut source = source(&hardware, FrameStart::Triggered, 1000);
        source.capture.set_middle_us(middle_us);
        let mut memory = Box::new(BoardMemory::CLEARED);
        let pair = source.next_pair(&mut *memory, None).unwrap();
        let options = Options { times_us: pair.times_us, ..Options::default() };
        let matched = memory.run(None, &mut matcher.clone(), options).unwrap();
        let health = *matched.health();
        // Times do not begin before 0.
        let skew_us = (20 + middle_us[1]).abs_diff(0);
        assert_eq!(health.skew_us, Some(skew_us), "{middle_us:?}");
        assert_eq!(health.is_refused(), is_refused);
        assert_eq!(health.flags.contains(HealthFlags::SKEW), is_refused);
    }
}

#[test]
fn rows_go_through_the_rectifiers_and_a_frame_that_is_begun_again_leaves_no_trace() {
    let (dims, rectification) = (Dims { width: 64, height: 48 }, rectification());
    let grey = |eye: CameraSide, x: usize, y: usize| (x * 3 + y * 5 + eye as usize * 77) as u8;
    let rectified = |torn_after: usize| {
        let mut memory = Box::new(BoardMemory::CLEARED);
        memory.set_rig(&rectification.remap()).unwrap();
        let mut sink = MemoryRows::new(&mut *memory, dims);
        sink.restart(CameraSide::Left);
        for y in 0..torn_after {
            sink.row(CameraSide::Left).fill(y as u8);
            sink.push(CameraSide::Left).unwrap();
        }
        for eye in [CameraSide::Right, CameraSide::Left] {
            sink.restart(eye);
            for y in 0..48 {
                assert_eq!(sink.complete(), None);
                sink.row(eye)
                    .iter_mut()
                    .enumerate()
                    .for_each(|(x, pixel)| *pixel = grey(eye, x, y));
                sink.push(eye).unwrap();
            }
        }
        assert_eq!(sink.complete(), Some(dims));
        assert_eq!(sink.push(CameraSide::Left), Err(RowError::TooMany));
        let [left, right] = memory.views(dims).unwrap();
        [left, right]
            .map(|view| (0..48).flat_map(|y| view.row(y).unwrap()).copied().collect::<Vec<_>>())
    };
    assert_eq!(rectified(0), rectified(20));
}

#[test]
fn frames_refuse_what_does_not_fit() {
    let (mut left, mut right) = ([0; 6], [0; 5]);
    let mut rows = FrameRows::new([&mut left, &mut right], Dims { width: 3, height: 2 });
    for y in 0..2 {
        rows.row(CameraSide::Left).fill(y);
        assert_eq!(rows.push(CameraSide::Left), Ok(()));
    }
    assert_eq!(
        (rows.row(CameraSide::Left).len(), rows.push(CameraSide::Left)),
        (0, Err(RowError::TooMany))
    );
    assert_eq!(rows.push(CameraSide::Right), Err(RowError::Frame { needed: 6, given: 5 }));
    assert_eq!(rows.complete(), None);
    rows.restart(CameraSide::Left);
    rows.row(CameraSide::Left).fill(7);
    assert_eq!(left, [7, 7, 7, 1, 1, 1]);
}

#[test]
fn rows_that_do_not_fit_are_told() {
    let all = usize::from(WIDTH) * ROWS as usize;
    let short = RowError::Frame { needed: all, given: all - 1 };
    // A frame that is too small, and one of more rows than the cameras send.
    for (height, bytes, expected) in [
        (DIMS.height, all - 1, Report::Refused(CameraSide::Left, short)),
        (DIMS.height + 1, 2 * all, Report::Incomplete),
    ] {
        let hardware = running(2, 0, 0);
        let (mut rings, mut capture) =
            (rings(&hardware), Capture::new(LIMITS, FrameStart::Triggered));
        let [mut left, mut right] = [vec![0; bytes], vec![0; bytes]];
        let mut sink = FrameRows::new([&mut left, &mut right], Dims { height, ..DIMS });
        let report = loop {
            pass(&hardware, 1);
            if let Some(report) = capture.turn(&mut rings, &mut sink) {
                break report;
            }
        };
        assert_eq!(report, expected);
    }
}

#[test]
fn faults_say_what_to_look_at() {
    let words = Fault::ALL.map(|fault| fault.to_string());
    assert!(words.iter().all(|text| text.contains(": ")), "{words:?}");
    assert_eq!(Fault::Stopped.to_string(), "the camera has stopped: start it again");
}
