//! A pair of sensors at work, from the first start to failures in the middle of a flight; and what
//! the host is told of losses.

use crate::support::live::{DIMS, Running, rig, scripted};
use crate::support::port::{Port, heads};
use crate::support::sensor::{
    AEC_AGC_ENABLE, AEC_EXPOSURE_OUTPUT, AGC_GAIN_OUTPUT, COARSE_SHUTTER_WIDTH_TOTAL, Fake,
};
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Edge};
use linestereo::Dims;
use linestereo_firmware::boards::mps2_an386::BOARD;
use linestereo_firmware::camera::*;
use linestereo_firmware::capture::Fault;
use linestereo_firmware::memory::Memory as _;
use linestereo_firmware::ports::{Cameras, FrameStart, PairSource};
use linestereo_firmware::programs::live::Turn;
use linestereo_firmware::session::Session;
use linestereo_wire::*;

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

/// Every second pair is lost, with a torn left frame.
fn lossy() -> impl PairSource {
    let mut camera = scripted(|call, paint| if call.is_multiple_of(2) { None } else { paint() });
    camera.losses = |calls| {
        let mut losses = CaptureReport { unpaired: calls / 2, ..CaptureReport::default() };
        losses.faults[0][Fault::TornFrame as usize] = calls / 2;
        Some(losses)
    };
    camera
}

#[test]
fn the_host_is_told_of_losses_when_they_change_and_a_watchdog_is_fed_by_finished_frames() {
    let mut board = Running::start(Session::new(BOARD), &Port::default(), lossy());
    assert_eq!(board.turn(), Turn::Idle);
    assert!(Turn::Idle.is_work() && Turn::Finished.is_work() && !Turn::Missing.is_work());
    board.port.send(1, Request::Start);
    let report = |message| if let Message::Capture(lost) = message { Some(lost) } else { None };
    let mut turn = |after_us: u32| {
        board.port.pass(after_us);
        let turn = board.turn();
        (turn, board.port.received().into_iter().filter_map(report).collect::<Vec<_>>())
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
    let mut board = Running::start(Session::new(BOARD), &Port::default(), lossy());
    board.port.received();
    board.port.pass(77);
    let mut sent = board.ask(1, Request::Photograph);
    assert_eq!(sent[0], Message::Answer(Answer { command: 1, outcome: Outcome::Accepted }));
    let head =
        PairHead { width: 128, height: 96, capture_time_us: 77, right_capture_time_us: None };
    assert_eq!(sent[1], Message::Photo(head));
    let expected = board.memory.frames().map(|frame| frame[..128 * 96].to_vec());
    let mut turns = 1;
    while sent.len() < 2 + 2 * (128 * 96) / PIXELS_PER_PACKET {
        board.port.send(1, Request::Describe); // is answered in between
        assert!(board.turn().is_work());
        let received = board.port.received();
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
    let refused =
        Message::Answer(Answer { command: 1, outcome: Outcome::Refused(Refusal::NoPair) });
    assert_eq!(board.ask(1, Request::Photograph), [refused]);
    assert_eq!(board.turn(), Turn::Idle);
}

#[test]
fn a_rig_of_other_cameras_is_a_size_mismatch_and_no_depth() {
    for (raw, good) in [(DIMS, true), (Dims { width: 160, height: 120 }, false)] {
        let mut camera = scripted(|_, paint| paint());
        camera.raw_dims = Some(raw);
        let mut board = Running::start(Session::new(BOARD), &Port::default(), camera);
        board.port.send(1, rig(48));
        board.port.send(1, Request::Start);
        // Commands may take two turns to come whole; none of them waits for cameras before.
        let turn = (0..3).map(|_| board.turn()).find(|turn| *turn != Turn::Idle);
        assert_eq!(turn, Some(Turn::Finished));
        assert_eq!(board.camera.calls, 1, "a frame a pair: the host is not flooded");
        let messages = board.port.received();
        for message in &messages {
            if let Message::Answer(answer) = message {
                assert_eq!(answer.outcome, Outcome::Accepted);
            }
        }
        let [head] = heads(&messages)[..] else { panic!("one frame") };
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
