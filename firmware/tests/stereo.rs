//! A pair of sensors at work, from the first start to failures in the middle of a flight; and what
//! the host is told of losses.

use crate::support::port::Port;
use crate::support::sensor::Fake;
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Edge};
use linestereo::Dims;
use linestereo_firmware::boards::mps2_an386::{BOARD, BoardMemory};
use linestereo_firmware::camera::*;
use linestereo_firmware::capture::Fault;
use linestereo_firmware::memory::Memory;
use linestereo_firmware::painter::Painter;
use linestereo_firmware::ports::{Cameras, CapturedPair, FrameStart, PairSource};
use linestereo_firmware::programs::live::{Live, Turn};
use linestereo_firmware::session::Session;
use linestereo_wire::*;

const AEC_EXPOSURE_OUTPUT: u16 = 0xbb;
const AGC_GAIN_OUTPUT: u16 = 0xba;
const AEC_AGC_ENABLE: u16 = 0xaf;
const COARSE_SHUTTER_WIDTH_TOTAL: u16 = 0x0b;

type Stereo = StereoCamera<Mt9v034, Fake, NoReset, Fake, NoReset, Pin, NoopDelay>;

/// Two fakes, and a trigger that is to be fired so often.
fn stereo(pulses: usize, start: FrameStart) -> (Stereo, [Fake; 2], Pin) {
    let fakes = [Fake::of::<Mt9v034>(), Fake::of::<Mt9v034>()];
    fakes[0].set(AEC_EXPOSURE_OUTPUT, 100);
    fakes[0].set(AGC_GAIN_OUTPUT, 16);
    let [left, right] = fakes.clone().map(|fake| Chip::<Mt9v034, _, _>::new(fake, 0x48, NoReset));
    let states = [State::Low]
        .into_iter()
        .chain([State::Low, State::High, State::Low].into_iter().cycle().take(3 * pulses));
    let pin = Pin::new(&states.map(Edge::set).collect::<Vec<_>>());
    let config = StereoConfig {
        config: Config::new(Dims { width: 320, height: 240 }, Binning::Two, start),
        exposure: PairExposure::LeftChooses,
        row_ns: 27_500,
        readout_us: 6600,
    };
    let trigger = Trigger::new(pin.clone()).unwrap();
    (StereoCamera::new((left, right), Some(trigger), NoopDelay, config), fakes, pin)
}

#[test]
fn a_pair_is_started_once_triggered_each_time_and_exposed_alike() {
    let (mut cameras, [left, right], mut pin) = stereo(2, FrameStart::Triggered);
    assert_eq!(left.get(0x07), 0, "nothing is sent before the first pair");
    assert!(cameras.shoot());
    let starting = left.said().len();
    assert_eq!(cameras.follow(), Some([-(100 * 27_500 / 2000); 2])); // a global shutter: half of the exposure before the readout
    left.set(AEC_EXPOSURE_OUTPUT, 300);
    assert!(cameras.shoot());
    assert_eq!(cameras.follow(), Some([-(300 * 27_500 / 2000); 2]));
    assert_eq!(right.get(COARSE_SHUTTER_WIDTH_TOTAL), 300);
    assert!(left.said().len() < starting, "started once");
    assert_eq!((cameras.failures(), cameras.last_error()), ([0, 0], None));
    pin.done();
}

#[test]
fn cameras_that_run_free_get_no_pulse() {
    let (mut cameras, _, mut pin) = stereo(0, FrameStart::Free);
    assert!(cameras.shoot() && cameras.shoot());
    pin.done();
}

#[test]
fn a_pair_whose_left_sensor_has_not_chosen_yet_is_started() {
    // No frame yet: 0 rows, which nobody can fix.
    let (mut cameras, [left, right], mut pin) = stereo(2, FrameStart::Triggered);
    left.set(AEC_EXPOSURE_OUTPUT, 0);
    assert!(cameras.shoot());
    assert_eq!([left.get(AEC_AGC_ENABLE), right.get(AEC_AGC_ENABLE)], [0b11; 2], "each for itself");
    assert_eq!((cameras.follow(), cameras.failures()), (None, [0, 0]));
    left.set(AEC_EXPOSURE_OUTPUT, 120);
    assert!(cameras.shoot());
    assert_eq!(cameras.follow(), Some([-(120 * 27_500 / 2000); 2]));
    assert_eq!([right.get(AEC_AGC_ENABLE), right.get(COARSE_SHUTTER_WIDTH_TOTAL)], [0, 120]);
    pin.done();
}

#[test]
fn what_fails_is_counted_and_started_again() {
    let (mut cameras, [left, right], mut pin) = stereo(3, FrameStart::Triggered);
    right.0.borrow_mut().fails_after = Some(3);
    assert!(!cameras.shoot(), "no pulse for half a pair");
    assert_eq!(cameras.failures(), [0, 1]);
    assert!(
        cameras
            .last_error()
            .is_some_and(|error| error.to_string().starts_with("right camera: the bus failed"))
    );
    assert!(cameras.shoot());

    // A choice that cannot be read: both run on, nothing is started anew.
    left.said();
    left.0.borrow_mut().fails_after = Some(0);
    assert_eq!((cameras.follow(), cameras.failures()), (None, [1, 1]));
    assert!(cameras.shoot());
    assert_eq!(left.said().len(), 0);

    // A choice that cannot be written: neither runs until the next pair.
    left.set(AEC_EXPOSURE_OUTPUT, 200);
    right.0.borrow_mut().fails_after = Some(0);
    assert_eq!((cameras.follow(), cameras.failures()), (None, [1, 2]));
    assert_eq!([left.get(0x07), right.get(0x07)], [0, 0], "both in standby");
    assert!(cameras.shoot());
    assert_ne!([left.get(0x07), right.get(0x07)], [0, 0]);
    pin.done();
}

#[test]
fn a_camera_that_has_stopped_is_started_again_before_the_next_pair() {
    let (mut cameras, [left, _], mut pin) = stereo(2, FrameStart::Triggered);
    assert!(cameras.shoot());
    let starting = left.said().len();
    cameras.stopped();
    left.0.borrow_mut().fails_after = Some(0);
    assert_eq!((cameras.follow(), cameras.failures()), (None, [0, 0]), "it is not asked any more");
    left.0.borrow_mut().fails_after = None;
    assert!(cameras.shoot());
    assert_eq!((left.said().len(), cameras.failures()), (starting, [0, 0]));
    pin.done();
}

fn losses(port: &Port) -> Vec<CaptureReport> {
    let report = |message| if let Message::Capture(lost) = message { Some(lost) } else { None };
    port.received().into_iter().filter_map(report).collect()
}

/// Every second pair is lost, with a torn left frame.
struct Lossy {
    calls: u32,
    painter: Painter,
}

impl PairSource for Lossy {
    fn next_pair(
        &mut self,
        memory: &mut impl Memory,
        rectified: Option<Dims>,
    ) -> Option<CapturedPair> {
        self.calls += 1;
        if self.calls.is_multiple_of(2) { None } else { self.painter.next_pair(memory, rectified) }
    }

    fn losses(&self) -> Option<CaptureReport> {
        let mut losses = CaptureReport::default();
        losses.faults[0][Fault::TornFrame as usize] = self.calls / 2;
        losses.unpaired = self.calls / 2;
        Some(losses)
    }
}

#[test]
fn the_host_is_told_of_losses_when_they_change_and_a_watchdog_is_fed_by_finished_frames() {
    let port = Port::default();
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut camera = Lossy { calls: 0, painter: Painter::new(Dims { width: 128, height: 96 }) };
    let mut live = Live::start(Session::new(BOARD), port.clone(), port.clone());
    assert_eq!(live.turn(&mut *memory, &mut camera), Turn::Idle);
    assert!(Turn::Idle.is_work() && Turn::Finished.is_work() && !Turn::Missing.is_work());
    port.send(1, Request::Start);
    let mut turn = |after_us: u32| {
        port.pass(after_us);
        (live.turn(&mut *memory, &mut camera), losses(&port))
    };
    assert_eq!(turn(0), (Turn::Finished, vec![]));
    let (missing, told) = turn(50_000);
    assert_eq!((missing, told.len()), (Turn::Missing, 1));
    assert_eq!((told[0].faults[0][4], told[0].unpaired), (1, 1));
    assert_eq!(told[0].to_string(), "left: torn_frame 1; unpaired 1");
    assert_eq!(turn(50_000), (Turn::Finished, vec![]));
    assert_eq!(turn(50_000), (Turn::Missing, vec![]), "not more than once a second");
    let (_, told) = turn(1_000_000);
    assert_eq!((told.len(), told[0].unpaired), (1, 2));
    assert_eq!(turn(1_000_000).1.len(), 1);
}

#[test]
fn a_photo_is_answered_then_sent_in_pieces_between_commands() {
    let dims = Dims { width: 128, height: 96 };
    let port = Port::default();
    let mut memory = Box::new(BoardMemory::CLEARED);
    let mut camera = Lossy { calls: 0, painter: Painter::new(dims) };
    let mut live = Live::start(Session::new(BOARD), port.clone(), port.clone());
    port.received();
    port.send(1, Request::Photograph);
    port.pass(77);
    live.turn(&mut *memory, &mut camera);
    let mut sent = port.received();
    assert_eq!(sent[0], Message::Answer(Answer { command: 1, outcome: Outcome::Accepted }));
    let head =
        PairHead { width: 128, height: 96, capture_time_us: 77, right_capture_time_us: None };
    assert_eq!(sent[1], Message::Photo(head));
    let expected = memory.frames().map(|frame| frame[..128 * 96].to_vec());
    let mut turns = 1;
    while sent.len() < 2 + 2 * (128 * 96) / PIXELS_PER_PACKET {
        port.send(1, Request::Describe); // is answered in between
        assert!(live.turn(&mut *memory, &mut camera).is_work());
        let received = port.received();
        assert!(received.iter().any(|message| matches!(message, Message::Hello(_))));
        sent.extend(received.into_iter().filter(|message| matches!(message, Message::Pixels(_))));
        turns += 1;
        assert!(turns < 20, "{} packets", sent.len());
    }
    let mut images = [Vec::new(), Vec::new()];
    for message in &sent[2..] {
        let Message::Pixels(pixels) = message else { panic!("{message:?}") };
        let image = &mut images[usize::from(pixels.is_right)];
        assert_eq!(pixels.first as usize, image.len());
        image.extend_from_slice(&pixels.list);
    }
    assert_eq!(images, expected);
    // The second pair is missing, and nothing is left of the first one.
    port.send(1, Request::Photograph);
    live.turn(&mut *memory, &mut camera);
    let refused = Outcome::Refused(Refusal::NoPair);
    assert_eq!(port.received(), [Message::Answer(Answer { command: 1, outcome: refused })]);
    assert_eq!(live.turn(&mut *memory, &mut camera), Turn::Idle);
}

/// Says that it delivers raw images of a size, and paints rectified ones. Counts them.
struct Raw(Dims, Painter, u32);

impl PairSource for Raw {
    fn next_pair(
        &mut self,
        memory: &mut impl Memory,
        rectified: Option<Dims>,
    ) -> Option<CapturedPair> {
        self.2 += 1;
        self.1
            .next_pair(memory, rectified)
            .map(|pair| CapturedPair { dims: rectified.unwrap_or(self.0), ..pair })
    }

    fn raw_dims(&self) -> Option<Dims> {
        Some(self.0)
    }
}

#[test]
fn a_rig_of_other_cameras_is_a_size_mismatch_and_no_depth() {
    use linestereo_rig::{Calibration, Camera, Lens, RigImage, View};
    let dims = Dims { width: 128, height: 96 };
    let camera = || {
        Camera::new(
            dims,
            [100.0; 2],
            [63.5, 47.5],
            0.0,
            Lens::BrownConrady { k: [0.0; 3], p: [0.0; 2] },
        )
    };
    let rig = Calibration::new(
        camera().unwrap(),
        camera().unwrap(),
        [1.0, 0.0, 0.0, 0.0],
        [-0.06, 0.0, 0.0],
    )
    .unwrap();
    let image = RigImage::new(rig, dims, View::default(), (0, 48)).unwrap();
    for (raw, good) in [(dims, true), (Dims { width: 160, height: 120 }, false)] {
        let port = Port::default();
        let mut memory = Box::new(BoardMemory::CLEARED);
        let mut live = Live::start(Session::new(BOARD), port.clone(), port.clone());
        port.send(1, Request::SetRig(RigBytes::from_slice(&image.encode(1)).unwrap()));
        port.send(1, Request::Start);
        let mut camera = Raw(raw, Painter::new(dims), 0);
        // Commands may take two turns to come whole; none of them waits for cameras before.
        let turns = core::iter::from_fn(|| Some(live.turn(&mut *memory, &mut camera)));
        assert_eq!(turns.take(3).find(|turn| *turn != Turn::Idle), Some(Turn::Finished));
        assert_eq!(camera.2, 1, "a frame a pair: the host is not flooded");
        let heads = port.received().into_iter().filter_map(|message| match message {
            Message::Frame(head) => Some(head),
            Message::Answer(answer) => {
                assert_eq!(answer.outcome, Outcome::Accepted);
                None
            }
            _ => None,
        });
        let [head] = heads.collect::<Vec<_>>()[..] else { panic!("one frame") };
        assert_eq!(head.health.contains(Health::SIZE_MISMATCH), !good, "{}", head.health);
        assert_eq!(head.segments > 0, good);
    }
}

#[test]
fn the_kinds_of_faults_have_the_names_of_the_record() {
    let names = Fault::ALL.map(|fault| format!("{fault:?}"));
    for (name, kind) in names.iter().zip(CaptureReport::KINDS) {
        assert_eq!(name.to_lowercase(), kind.replace('_', ""));
    }
}

#[test]
fn why_the_board_was_reset_stands_in_its_description() {
    let mut session = Session::new(BOARD);
    assert_eq!(session.hello().reset, None);
    session.reset = Some(Reset::of(ResetCause::Watchdog));
    assert_eq!(session.hello().reset, Some(Reset::of(ResetCause::Watchdog)));
}
