//! Pairs that are triggered while the ones before them are worked on, by the fake of a camera
//! interface with both cameras' rows.

use crate::stream::{
    DIMS, Fake, FakeStream, PERIOD_US, ROW_US, ROWS, Step, TWO_ROWS, both, injected, limits,
};
use crate::support::random::Random;
use crate::support::rows::{WIDTH, frames_in};
use core::cell::RefCell;
use linestereo_firmware::boards::mps2_an386::BoardMemory;
use linestereo_firmware::capture::*;
use linestereo_firmware::ports::{Cameras, FrameStart, PairSource, TimedCameras};
use linestereo_wire::CaptureReport;
use std::rc::Rc;

/// 32 rows: more than a frame, and fewer than two.
const A_FRAME: RingLayout = RingLayout { rows: 32, ..TWO_ROWS };
/// From a trigger to the start of the frame; time that a pair is worked on; and time that is too
/// long for one.
const LONG_EXPOSURE_US: u64 = 300;
const WORK_US: u64 = 480;
const PATIENCE_US: u64 = 4 * PERIOD_US;

/// Start of a frame, and its fault.
type Shot = (u64, Option<Fault>);

/// Both cameras behind a joiner, with faults or none. What is told to sensors while a frame is on
/// its way would reach one or the other image.
struct Joined {
    fake: Rc<RefCell<Fake>>,
    faults: Option<Random>,
    shots: Rc<RefCell<Vec<Shot>>>,
}

impl Joined {
    /// Is no frame on its way? One that has a row too many is taken for one that has ended.
    fn is_between(&self) -> bool {
        let has_one_more =
            self.shots.borrow().last().is_some_and(|shot| shot.1 == Some(Fault::MissingVsync));
        has_one_more || self.fake.borrow().steps.iter().all(|step| matches!(step.1, Step::End))
    }
}

impl Cameras for Joined {
    fn shoot(&mut self) -> bool {
        self.shoot_at(0)
    }

    fn follow(&mut self) -> Option<[i32; 2]> {
        assert!(self.is_between(), "exposed anew in the middle of a frame");
        Some([-5; 2])
    }

    fn stopped(&mut self) {}
}

impl TimedCameras for Joined {
    fn shoot_at(&mut self, time_us: u64) -> bool {
        assert!(self.is_between(), "triggered in the middle of a frame");
        let mut fake = self.fake.borrow_mut();
        let (frame, start_us) =
            (self.shots.borrow().len() as u32, fake.now_us.max(time_us) + LONG_EXPOSURE_US);
        let fault = match &mut self.faults {
            Some(random) => injected(random, &mut fake, frame, start_us),
            None => {
                fake.play(start_us, both(frame));
                None
            }
        };
        self.shots.borrow_mut().push((start_us, fault));
        true
    }
}

/// Number of a pair's frame, when it was captured, and when it was handed on.
type Taken = (u32, u64, u64);

/// A run: the pair of each call; the shots; losses.
struct Work {
    pairs: Vec<Option<Taken>>,
    shots: Vec<Shot>,
    losses: CaptureReport,
}

/// Takes pairs and works on each for its time.
fn take(
    mut source: impl PairSource,
    fake: &RefCell<Fake>,
    works_us: impl Iterator<Item = u64>,
) -> (Vec<Option<Taken>>, CaptureReport) {
    let mut memory = Box::new(BoardMemory::CLEARED);
    let turn = |work_us: u64| {
        let times_us = source.next_pair(&mut *memory, None)?.times_us.unwrap();
        let [left, right] = frames_in(&mut *memory, ROWS).unwrap();
        assert_eq!((left, times_us[0]), (right, times_us[1]));
        let now_us = fake.borrow().now_us;
        fake.borrow_mut().pass_to(now_us + work_us);
        Some((left, times_us[0], now_us))
    };
    (works_us.map(turn).collect(), source.losses().unwrap())
}

/// Asks for so many pairs and works on each for a time that its number says.
fn work(
    layout: RingLayout,
    is_ahead: bool,
    seed: Option<u64>,
    count: u64,
    work_us: impl Fn(u64) -> u64,
) -> Work {
    let fake = Rc::new(RefCell::new(Fake::new(layout)));
    let shots = Rc::new(RefCell::new(Vec::new()));
    let cameras = Joined { fake: fake.clone(), faults: seed.map(Random), shots: shots.clone() };
    let eyes = SideBySide::new(FakeStream(fake.clone()));
    let capture = Capture::new(limits(2 * WIDTH, 1), FrameStart::Triggered);
    let source = CameraSource::new(eyes.eyes(WIDTH), cameras, capture, DIMS, PATIENCE_US as u32);
    let works_us = (0..count).map(work_us);
    let (pairs, losses) = if is_ahead {
        take(AheadSource::new(source), &fake, works_us)
    } else {
        take(source, &fake, works_us)
    };
    let shots = shots.borrow().clone();
    Work { pairs, shots, losses }
}

#[test]
fn a_pair_is_exposed_while_the_one_before_it_is_worked_on_and_is_no_older() {
    let readout_us = u64::from(ROWS) * ROW_US;
    for (is_ahead, waited_us) in [(false, LONG_EXPOSURE_US + readout_us), (true, readout_us)] {
        let Work { pairs, shots, losses } = work(A_FRAME, is_ahead, None, 50, |_| WORK_US);
        assert_eq!(losses, CaptureReport::default());
        let pairs: Vec<_> = pairs.into_iter().flatten().collect();
        for (number, &(frame, captured_us, handed_us)) in pairs.iter().enumerate() {
            // Of each shot one pair, with the time of its own exposure.
            let middle_us = if number == 0 { 0 } else { 5 };
            assert_eq!((frame, captured_us + middle_us), (number as u32, shots[number].0));
            // Two are triggered before it is known how long the work takes.
            let is_timed = !is_ahead || ![1, 2].contains(&number);
            assert!(
                !is_timed || (readout_us..readout_us + 9).contains(&(handed_us - captured_us)),
                "{number}"
            );
        }
        assert_eq!((pairs.len(), shots.len()), (50, 50 + usize::from(is_ahead)));
        for pair in pairs[3..].windows(2) {
            let period_us = pair[1].2 - pair[0].2;
            assert!((0..4).contains(&(period_us - WORK_US - waited_us)), "{period_us}");
        }
    }
}

#[test]
fn a_bad_frame_costs_its_pair_alone() {
    let seed = 7;
    let Work { pairs, shots, losses } =
        work(A_FRAME, true, Some(seed), 3000, |number| WORK_US + number % 5 * 40);
    let mut expected = [0; Fault::ALL.len()];
    // The last shot is still on its way.
    shots[..shots.len() - 1]
        .iter()
        .filter_map(|shot| shot.1)
        .for_each(|fault| expected[fault as usize] += 1);
    for of in losses.faults {
        assert_eq!(of, expected, "seed {seed}");
    }
    let is_lost = |fault: Option<Fault>| fault.is_some_and(|fault| fault != Fault::MissingVsync);
    let good: Vec<_> =
        (0..).zip(&shots).filter(|(_, shot)| !is_lost(shot.1)).map(|(number, _)| number).collect();
    let delivered: Vec<_> = pairs.iter().flatten().map(|pair| pair.0).collect();
    assert_eq!(delivered, good[..delivered.len()], "seed {seed}");
    assert!(pairs.len() - delivered.len() > 500, "{}", delivered.len());
}

#[test]
fn a_pair_that_nobody_asked_for_in_time_is_left() {
    let pauses = [(9, PATIENCE_US - 50), (19, PATIENCE_US + WORK_US), (29, 1_000_000)];
    let pause_us =
        |number| pauses.iter().find(|pause| pause.0 == number).map_or(WORK_US, |pause| pause.1);
    let Work { pairs, shots, losses } = work(A_FRAME, true, None, 40, pause_us);
    assert_eq!(losses, CaptureReport::default(), "cameras that nobody asks are not silent");
    let frames: Vec<_> = pairs.iter().map(|pair| pair.unwrap().0).collect();
    let expected = (0..42).filter(|frame| ![20, 31].contains(frame));
    assert_eq!(frames, expected.collect::<Vec<_>>());
    for (number, pair) in pairs.into_iter().enumerate() {
        let (_, captured_us, handed_us) = pair.unwrap();
        assert!(handed_us - captured_us < PATIENCE_US, "{number}: {captured_us} at {handed_us}");
    }
    assert_eq!(shots.len(), 43);
}

#[test]
fn longer_work_finds_its_rows_in_a_ring_of_a_frame_and_none_torn_in_a_smaller_one() {
    for (layout, lost) in [(A_FRAME, 0), (TWO_ROWS, 1)] {
        let Work { pairs, losses, .. } =
            work(layout, true, None, 20, |number| if number == 9 { 900 } else { WORK_US });
        let frames: Vec<_> = pairs.iter().map(|pair| pair.map(|pair| pair.0)).collect();
        let is_lost = |frame| lost == 1 && [1, 3, 10].contains(&frame);
        assert_eq!(
            frames,
            (0..20).map(|frame| (!is_lost(frame)).then_some(frame)).collect::<Vec<_>>()
        );
        assert_eq!((losses.skipped, losses.faults), (6 * lost, [[0; Fault::ALL.len()]; 2]));
    }
}
