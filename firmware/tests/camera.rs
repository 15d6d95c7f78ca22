//! Sensor drivers: register traces replayed, and every transaction of every operation failing in
//! turn.
//!
//! A trace is what a driver says to a fake sensor that answers as the datasheet has it; it is
//! compared with the file in `traces/`, read by people against the datasheet. Then each of its
//! transactions fails in turn, on a bus that accepts nothing but what is expected.

use crate::support::sensor::{
    AEC_AGC_ENABLE, AEC_EXPOSURE_OUTPUT, AGC_GAIN_OUTPUT, COARSE_SHUTTER_WIDTH_TOTAL, Fake, Said,
    text,
};
use core::cell::Cell;
use embedded_hal::i2c::{ErrorKind, I2c, NoAcknowledgeSource, Operation};
use embedded_hal_mock::eh1::delay::NoopDelay;
use embedded_hal_mock::eh1::digital::State::{self, High, Low};
use embedded_hal_mock::eh1::digital::{Mock as Pin, Transaction as Edge};
use embedded_hal_mock::eh1::i2c::{Mock, Transaction};
use linestereo::Dims;
use linestereo_firmware::camera::*;
use linestereo_firmware::ports::FrameStart;
use linestereo_rig::CameraSide;
use std::rc::Rc;

/// Compares with `traces/NAME.txt`; `LINESTEREO_BLESS=1` writes it.
fn assert_trace(name: &str, said: &[Said]) {
    let path = format!("{}/tests/traces/{name}.txt", env!("CARGO_MANIFEST_DIR"));
    if std::env::var_os("LINESTEREO_BLESS").is_some() {
        std::fs::write(&path, text(said)).unwrap();
    }
    let expected = std::fs::read_to_string(&path).expect(&path);
    assert_eq!(
        text(said),
        expected,
        "{path}: look it up in the datasheet, then bless with LINESTEREO_BLESS=1"
    );
}

fn config(width: u16, height: u16, binning: Binning) -> Config {
    Config::new(Dims { width, height }, binning, FrameStart::Free)
}

/// Data of a sensor for its tests.
struct Case {
    name: &'static str,
    address: u8,
    config: Config,
    fixed: Exposure,
    other: Exposure,
}

fn mt9v034() -> Case {
    let config = config(320, 240, Binning::Two);
    let (fixed, other) =
        (Exposure { rows: 200, gain_code: 0x20 }, Exposure { rows: 480, gain_code: 64 });
    let (name, address) = ("mt9v034", Mt9v034::ADDRESSES[0]);
    Case { name, address, config, fixed, other }
}

fn hm01b0() -> Case {
    let config = config(324, 244, Binning::One);
    let (fixed, other) =
        (Exposure { rows: 200, gain_code: 0x500 }, Exposure { rows: 258, gain_code: 0xd40 });
    Case { name: "hm01b0", address: Hm01b0::ADDRESS, config, fixed, other }
}

/// Calls a function for each model, with its case.
macro_rules! of_each_model {
    ($check:ident) => {
        $check::<Mt9v034>(&mt9v034());
        $check::<Hm01b0>(&hm01b0());
    };
}

type OnFake<M, R = NoReset> = Chip<M, Fake, R>;

/// Something that is asked of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Asked {
    Start(Config),
    Stop,
    Expose(Exposure),
    ReadExposure,
}

impl Asked {
    fn of<M: Model, B: I2c, R: ResetLine>(
        self,
        chip: &mut Chip<M, B, R>,
    ) -> Result<(), CameraError<B::Error>> {
        match self {
            Self::Start(config) => chip.start(&config, &mut NoopDelay),
            Self::Stop => chip.stop(&mut NoopDelay),
            Self::Expose(exposure) => chip.set_exposure(exposure, &mut NoopDelay),
            Self::ReadExposure => chip.exposure().map(drop),
        }
    }
}

/// Everything that can be asked of a sensor, with a name for its trace.
fn everything(case: &Case) -> Vec<(&'static str, Asked)> {
    let fixed = Config { exposure: ExposureControl::Fixed(case.fixed), ..case.config };
    vec![
        ("auto", Asked::Start(case.config)),
        ("fixed", Asked::Start(fixed)),
        ("pattern", Asked::Start(Config { test_pattern: true, ..fixed })),
        ("expose", Asked::Expose(case.other)),
        ("read_exposure", Asked::ReadExposure),
        ("stop", Asked::Stop),
        ("triggered", Asked::Start(Config { start: FrameStart::Triggered, ..fixed })),
    ]
}

/// Writes to a sensor that runs, or is started.
fn trace<M: Model>(case: &Case, asked: Asked) -> Vec<Said> {
    let fake = Fake::of::<M>();
    let mut chip = OnFake::<M>::new(fake.clone(), case.address, NoReset);
    if !matches!(asked, Asked::Start(_)) {
        chip.start(&case.config, &mut NoopDelay).unwrap();
        fake.said();
    }
    asked.of(&mut chip).unwrap();
    fake.said()
}

/// The same for a bus that accepts nothing else.
fn transactions<M: Model>(case: &Case, asked: Asked) -> Vec<Transaction> {
    trace::<M>(case, asked).iter().map(Said::transaction).collect()
}

/// The transactions up to one that fails.
fn failing(said: &[Transaction], place: usize, error: ErrorKind) -> Vec<Transaction> {
    let mut said = said[..=place].to_vec();
    said[place] = said[place].clone().with_error(error);
    said
}

/// A sensor on a bus that accepts nothing else; it runs already, unless it is to be started.
fn replay<M: Model>(
    case: &Case,
    asked: Asked,
    then: &[Transaction],
) -> (Result<(), CameraError<ErrorKind>>, Chip<M, Mock, NoReset>) {
    let before = match asked {
        Asked::Start(_) => Vec::new(),
        _ => transactions::<M>(case, Asked::Start(case.config)),
    };
    let all = [&before, then].concat();
    let mut chip = Chip::<M, Mock, NoReset>::new(Mock::new(&all), case.address, NoReset);
    if !before.is_empty() {
        chip.start(&case.config, &mut NoopDelay).unwrap();
    }
    let result = asked.of(&mut chip);
    (result, chip)
}

fn done<M: Model, R: ResetLine>(chip: Chip<M, Mock, R>) -> R {
    let (mut bus, reset) = chip.release();
    bus.done();
    reset
}

/// Every transaction of every operation fails in turn; returns how many there were.
fn fail_everywhere<M: Model>(case: &Case) -> usize {
    let standby = transactions::<M>(case, Asked::Stop);
    let mut count = 0;
    for (name, asked) in everything(case) {
        let trace = transactions::<M>(case, asked);
        let identity = if let Asked::Start(_) = asked { M::IDENTITY.len() } else { 0 };
        for place in 0..trace.len() {
            count += 1;
            let so_far = failing(&trace, place, ErrorKind::Bus);
            let what = format!("{} {name}, transaction {place} of {}", case.name, trace.len());
            // Where nothing was written nothing is touched. Else, the bus works again: standby.
            let (left, then) = match asked {
                Asked::ReadExposure => (Condition::Running, &[][..]),
                _ if place < identity => (Condition::Unknown, &[][..]),
                _ => (Condition::Standby, &standby[..]),
            };
            let (result, chip) = replay::<M>(case, asked, &[&so_far, then].concat());
            let error = result.expect_err(&what);
            assert!(
                matches!(error.cause, Cause::Bus { error: ErrorKind::Bus, .. }),
                "{what}: {error}"
            );
            assert_eq!((error.left, chip.condition()), (left, left), "{what}");
            done(chip);
            if then.is_empty() {
                continue;
            }
            // It does not, at each transaction of the way to standby: said so, and nothing but a
            // start is taken.
            for stop in 0..standby.len() {
                let broken = failing(&standby, stop, ErrorKind::ArbitrationLoss);
                let then = [&so_far[..], &broken].concat();
                let (result, mut chip) = replay::<M>(case, asked, &then);
                let error = result.expect_err(&what);
                assert_eq!(
                    (error.left, chip.condition()),
                    (Condition::HalfConfigured, Condition::HalfConfigured),
                    "{what}"
                );
                assert!(error.to_string().contains("half configured"), "{error}");
                let refused = chip.set_exposure(case.fixed, &mut NoopDelay).unwrap_err();
                assert_eq!(
                    refused,
                    CameraError { cause: Cause::NotRunning, left: Condition::HalfConfigured }
                );
                assert_eq!(chip.exposure().unwrap_err().cause, Cause::NotRunning);
                done(chip);
            }
        }
    }
    count
}

#[test]
fn what_is_said_is_what_was_read_against_the_datasheet() {
    fn check<M: Model>(case: &Case) {
        for (name, asked) in everything(case) {
            assert_trace(&format!("{}_{name}", case.name), &trace::<M>(case, asked));
        }
    }
    of_each_model!(check);
}

#[test]
fn a_failure_at_any_transaction_is_told_with_the_state_that_it_leaves() {
    // Fewer would mean that operations are left out.
    assert!(fail_everywhere::<Mt9v034>(&mt9v034()) > 150);
    assert!(fail_everywhere::<Hm01b0>(&hm01b0()) > 450);
}

#[test]
fn a_register_that_keeps_something_else_is_named() {
    fn check<M: Model>(case: &Case) {
        let config = Config { exposure: ExposureControl::Fixed(case.fixed), ..case.config };
        let mut checked = Vec::new();
        for Said { written, .. } in trace::<M>(case, Asked::Start(config)) {
            let register = match (M::WIRE, &written[..]) {
                (Wire::Long8, [high, low, _]) => u16::from_be_bytes([*high, *low]),
                (Wire::Short16, [register, _, ..]) => (*register).into(),
                _ => continue, // a read
            };
            let fake = Fake::of::<M>();
            // Every bit that can be wrong is; of a register that is written several times, the
            // first write already.
            let value = if M::WIRE == Wire::Short16 { 0xffff } else { 0xff };
            let last = u16::from(*written.last().unwrap());
            fake.0.borrow_mut().stuck.insert(register, value ^ last);
            let mut chip = OnFake::<M>::new(fake, case.address, NoReset);
            let Err(error) = chip.start(&config, &mut NoopDelay) else { continue }; // a command
            let Cause::NotKept { register: named, .. } = error.cause else { panic!("{error}") };
            assert_eq!(named, register, "{}: {error}", case.name);
            let is_stop = M::STANDBY.iter().any(|step| step.register == register);
            let expected = if is_stop { Condition::HalfConfigured } else { Condition::Standby };
            assert_eq!(error.left, expected, "{}: {error}", case.name);
            checked.push(register);
        }
        checked.sort_unstable();
        checked.dedup();
        assert!(checked.len() > 15, "{} registers of {}", checked.len(), case.name);
    }
    of_each_model!(check);
}

#[test]
fn another_chip_is_not_written_to() {
    fn check<M: Model>(case: &Case) {
        for identity in M::IDENTITY {
            let fake = Fake::of::<M>();
            fake.set(identity.register, identity.value ^ 1);
            let mut chip = OnFake::<M>::new(fake.clone(), case.address, NoReset);
            let error = chip.start(&case.config, &mut NoopDelay).unwrap_err();
            let (register, found) = (identity.register, identity.value ^ 1);
            assert_eq!(
                error,
                CameraError {
                    cause: Cause::Identity { register, found },
                    left: Condition::Unknown
                }
            );
            let register_bytes = if M::WIRE == Wire::Long8 { 2 } else { 1 };
            let is_written = fake.said().iter().any(|said| said.written.len() > register_bytes);
            assert!(!is_written, "{}", case.name);
        }
    }
    of_each_model!(check);
}

#[test]
fn nobody_answers() {
    let nobody = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
    let said = [Transaction::write_read(0x48, vec![0], vec![0, 0]).with_error(nobody)];
    let mut chip = Chip::<Mt9v034, Mock, _>::new(Mock::new(&said), 0x48, NoReset);
    let error = chip.start(&mt9v034().config, &mut NoopDelay).unwrap_err();
    assert_eq!(error, CameraError { cause: Cause::Missing, left: Condition::Unknown });
    assert_eq!(
        error.to_string(),
        "no camera answers: check power, clock and wires (the camera is as it was)"
    );
    done(chip);
}

fn edges(states: &[State]) -> Vec<Edge> {
    states.iter().cloned().map(Edge::set).collect()
}

/// The same, of which one fails.
fn edges_failing(states: &[State], place: usize) -> Vec<Edge> {
    let error = embedded_hal_mock::eh1::MockError::Io(std::io::ErrorKind::Other);
    let mut edges = edges(states);
    edges[place] = edges[place].clone().with_error(error);
    edges
}

#[test]
fn a_reset_pin_holds_what_has_failed() {
    let case = mt9v034();
    let trace = transactions::<Mt9v034>(&case, Asked::Start(case.config));
    for place in 0..trace.len() {
        let said = failing(&trace, place, ErrorKind::Bus);
        // Held and released, then held for good: nothing more is said on the bus, and it is in
        // reset already when it is to stop.
        let pin = Pin::new(&edges(&[Low, High, Low]));
        let mut chip = Chip::<Mt9v034, Mock, _>::new(Mock::new(&said), case.address, ResetPin(pin));
        let error = chip.start(&case.config, &mut NoopDelay).unwrap_err();
        assert_eq!(error.left, Condition::InReset, "{place}");
        assert_eq!(chip.stop(&mut NoopDelay), Ok(()));
        assert_eq!(chip.condition(), Condition::InReset);
        done(chip).0.done();
    }
}

#[test]
fn a_reset_pin_that_fails_is_told() {
    let case = mt9v034();
    for (place, states) in [(0, &[Low][..]), (1, &[Low, High])] {
        let edges = edges_failing(states, place);
        let mut chip =
            Chip::<Mt9v034, Mock, _>::new(Mock::new(&[]), case.address, ResetPin(Pin::new(&edges)));
        let error = chip.start(&case.config, &mut NoopDelay).unwrap_err();
        assert_eq!(error, CameraError { cause: Cause::Pin, left: Condition::Unknown });
        done(chip).0.done();
    }
    // It fails only when it is needed most: standby does.
    let said = transactions::<Mt9v034>(&case, Asked::Start(case.config));
    let standby = transactions::<Mt9v034>(&case, Asked::Stop);
    let said = [failing(&said, 1, ErrorKind::Bus), standby].concat();
    let edges = edges_failing(&[Low, High, Low], 2);
    let mut chip =
        Chip::<Mt9v034, Mock, _>::new(Mock::new(&said), case.address, ResetPin(Pin::new(&edges)));
    assert_eq!(chip.start(&case.config, &mut NoopDelay).unwrap_err().left, Condition::Standby);
    done(chip).0.done();
}

#[test]
fn what_a_model_cannot_do_is_refused_before_anything_is_said() {
    fn refused<M: Model>(config: Config) -> Unsupported {
        let mut chip = Chip::<M, Mock, _>::new(Mock::new(&[]), 0x10, NoReset);
        let error = chip.start(&config, &mut NoopDelay).unwrap_err();
        assert_eq!(error.left, Condition::Unknown);
        done(chip);
        let Cause::Unsupported(what) = error.cause else { panic!("{error}") };
        what
    }
    fn refuses_size<M: Model>(width: u16, height: u16, binning: Binning) {
        let expected = Unsupported::Size(Dims { width, height }, binning);
        assert_eq!(refused::<M>(config(width, height, binning)), expected);
    }
    fn exposed<M: Model>(case: &Case, rows: u16, gain_code: u16) -> Unsupported {
        let exposure = ExposureControl::Fixed(Exposure { rows, gain_code });
        refused::<M>(Config { exposure, ..case.config })
    }
    refuses_size::<Mt9v034>(756, 480, Binning::One);
    refuses_size::<Mt9v034>(320, 241, Binning::One);
    refuses_size::<Mt9v034>(378, 240, Binning::Two);
    refuses_size::<Hm01b0>(320, 240, Binning::One);
    assert_eq!(exposed::<Mt9v034>(&mt9v034(), 0, 16), Unsupported::Rows(0));
    assert_eq!(exposed::<Mt9v034>(&mt9v034(), 1, 15), Unsupported::Gain(15));
    assert_eq!(exposed::<Hm01b0>(&hm01b0(), 259, 0x100), Unsupported::Rows(259));
    assert_eq!(exposed::<Hm01b0>(&hm01b0(), 258, 0x3f), Unsupported::Gain(0x3f));
    assert_eq!(Unsupported::Gain(15).to_string(), "the sensor has no gain 0xf");
    assert_eq!(Unsupported::Rows(9).to_string(), "the sensor cannot be exposed for 9 rows");
    let size = Unsupported::Size(Dims { width: 320, height: 240 }, Binning::Four).to_string();
    assert_eq!(size, "the sensor has no images of 320x240 with 4x4 pixels made one");
    // A running sensor goes on.
    let mut chip = OnFake::<Mt9v034>::new(Fake::of::<Mt9v034>(), 0x48, NoReset);
    chip.start(&mt9v034().config, &mut NoopDelay).unwrap();
    let error = chip.set_exposure(Exposure { rows: 5, gain_code: 65 }, &mut NoopDelay).unwrap_err();
    assert_eq!(
        error,
        CameraError { cause: Cause::Unsupported(Unsupported::Gain(65)), left: Condition::Running }
    );
}

#[test]
fn other_sizes_have_their_registers() {
    fn check<M: Model>(name: &str, case: &Case, config: Config) {
        assert_trace(&format!("{}_{name}", case.name), &trace::<M>(case, Asked::Start(config)));
    }
    check::<Mt9v034>("full", &mt9v034(), config(752, 480, Binning::One));
    check::<Mt9v034>("small", &mt9v034(), config(160, 120, Binning::Four));
    check::<Hm01b0>("small", &hm01b0(), config(162, 122, Binning::Two));
    check::<Hm01b0Nibbles>("nibbles", &hm01b0(), hm01b0().config);
}

#[test]
fn gains_are_the_nearest_from_below() {
    /// Largest loss, and the gains there are (1/64).
    fn check<M: Model>(gains: core::ops::RangeInclusive<u16>, worst: f64) {
        for gain_q6 in gains.clone() {
            let code = M::gain_code(gain_q6).unwrap();
            let loss = 1.0 - f64::from(M::gain_q6(code)) / f64::from(gain_q6);
            assert!((0.0..worst).contains(&loss), "{} {gain_q6} {code:#x} {loss}", M::NAME);
            assert_eq!(M::check_exposure(Exposure { rows: 10, gain_code: code }), Ok(()));
        }
        assert_eq!(
            [M::gain_code(gains.start() - 1), M::gain_code(u16::MAX)],
            [None, None],
            "{}",
            M::NAME
        );
    }
    check::<Mt9v034>(64..=259, 1.0 / 16.0); // sixteenths of 1 ..= 4
    check::<Hm01b0>(64..=4079, 1.0 / 64.0); // 1 ..= 16, times 1 ..= 3.98
}

#[test]
fn the_middle_of_an_exposure() {
    assert_eq!(Shutter::Global.middle_us(4000, 16_000), -2000);
    assert_eq!(Shutter::Rolling.middle_us(4000, 30_000), 13_000);
    assert_eq!(Shutter::Global.middle_us(u32::MAX, 0), -i32::MAX);
    assert_eq!([Mt9v034::SHUTTER, Hm01b0::SHUTTER], [Shutter::Global, Shutter::Rolling]);
}

/// Two sensors, each on a fake of its own.
type Both<M> = CameraPair<M, Fake, NoReset, Fake, NoReset>;

fn both<M: Model>(address: u8) -> (Both<M>, [Fake; 2]) {
    let fakes = [Fake::of::<M>(), Fake::of::<M>()];
    let [left, right] = fakes.clone().map(|fake| OnFake::<M>::new(fake, address, NoReset));
    (CameraPair::new(left, right), fakes)
}

/// Two MT9V034 that run, the left one with an exposure of so many rows.
fn started(rows: u16) -> (Both<Mt9v034>, [Fake; 2]) {
    let (mut pair, fakes) = both::<Mt9v034>(0x48);
    fakes[0].set(AEC_EXPOSURE_OUTPUT, rows);
    fakes[0].set(AGC_GAIN_OUTPUT, 16);
    pair.start(&mt9v034().config, PairExposure::LeftChooses, &mut NoopDelay).unwrap();
    (pair, fakes)
}

const ANALOG_GAIN: u16 = 0x35;

#[test]
fn the_left_camera_chooses_for_both() {
    let (mut pair, [left, right]) = both::<Mt9v034>(0x48);
    left.set(AEC_EXPOSURE_OUTPUT, 111);
    left.set(AGC_GAIN_OUTPUT, 0x8000 | 33); // bits that are no gain
    let triggered = Config { start: FrameStart::Triggered, ..mt9v034().config };
    pair.start(&triggered, PairExposure::LeftChooses, &mut NoopDelay).unwrap();
    assert_eq!(pair.conditions(), [Condition::Running; 2]);
    let of = |camera: &Fake| {
        [COARSE_SHUTTER_WIDTH_TOTAL, ANALOG_GAIN].map(|register| camera.get(register))
    };
    assert_eq!([left.get(AEC_AGC_ENABLE), right.get(AEC_AGC_ENABLE)], [0b11, 0]);
    assert_eq!(of(&right), [111, 33]);

    left.set(AEC_EXPOSURE_OUTPUT, 222);
    let followed = pair.follow(&mut NoopDelay).unwrap();
    assert_eq!(followed, Some(Exposure { rows: 222, gain_code: 33 }));
    assert_eq!(of(&right), [222, 33]);
    right.said();
    assert_eq!(pair.follow(&mut NoopDelay).unwrap(), followed);
    assert_eq!(text(&right.said()), "", "nothing has changed");

    left.set(AEC_EXPOSURE_OUTPUT, 0); // nobody can fix that
    assert_eq!(pair.follow(&mut NoopDelay).unwrap(), followed);
    pair.stop(&mut NoopDelay).unwrap();
    assert_eq!(pair.conditions(), [Condition::Standby; 2]);
}

#[test]
fn the_same_exposure_for_both() {
    let (mut pair, [left, right]) = both::<Hm01b0>(0x24);
    let fixed = hm01b0().fixed;
    pair.start(&hm01b0().config, PairExposure::Fixed(fixed), &mut NoopDelay).unwrap();
    assert_eq!(text(&left.said()), text(&right.said()));
    assert_eq!(pair.follow(&mut NoopDelay), Ok(Some(fixed)));
    assert_eq!(text(&left.said()), "", "nobody is asked");
    let (mut left, mut right) = pair.release();
    assert_eq!([left.exposure(), right.exposure()], [Ok(fixed); 2]);
}

#[test]
fn one_of_two_cameras_is_missing() {
    let nobody = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Unknown);
    let absent = [Transaction::write_read(0x48, vec![0], vec![0, 0]).with_error(nobody)];
    let case = mt9v034();

    let left = Chip::<Mt9v034, Mock, _>::new(Mock::new(&absent), 0x48, NoReset);
    let right = OnFake::<Mt9v034>::new(Fake::of::<Mt9v034>(), 0x48, NoReset);
    let mut pair = CameraPair::new(left, right);
    let error = pair.start(&case.config, PairExposure::LeftChooses, &mut NoopDelay).unwrap_err();
    assert_eq!(
        (error.eye, error.error.cause, error.other),
        (CameraSide::Left, Cause::Missing, Condition::Unknown)
    );
    done(pair.release().0);

    let fake = Fake::of::<Mt9v034>();
    let left = OnFake::<Mt9v034>::new(fake.clone(), 0x48, NoReset);
    let right = Chip::<Mt9v034, Mock, _>::new(Mock::new(&absent), 0x48, NoReset);
    let mut pair = CameraPair::new(left, right);
    let error =
        pair.start(&case.config, PairExposure::Fixed(case.fixed), &mut NoopDelay).unwrap_err();
    assert_eq!(
        (error.eye, error.error.cause, error.other),
        (CameraSide::Right, Cause::Missing, Condition::Standby)
    );
    assert_eq!(pair.conditions(), [Condition::Standby, Condition::Unknown]);
    assert_eq!(fake.get(0x07), 0, "the left one sends nothing");
    let text = error.to_string();
    assert!(
        text.starts_with("right camera: no camera answers")
            && text.ends_with("the left one is in standby"),
        "{text}"
    );
    done(pair.release().1);
}

#[test]
fn a_camera_that_fails_later_stops_the_other_one() {
    const CHIP_CONTROL: u16 = 0x07;
    // The right one does not take the left one's choice.
    let (mut pair, [left, right]) = started(100);
    right.0.borrow_mut().stuck.insert(COARSE_SHUTTER_WIDTH_TOTAL, 7);
    left.set(AEC_EXPOSURE_OUTPUT, 101);
    let error = pair.follow(&mut NoopDelay).unwrap_err();
    let not_kept = Cause::NotKept { register: COARSE_SHUTTER_WIDTH_TOTAL, written: 101, read: 7 };
    assert_eq!((error.eye, error.error.cause), (CameraSide::Right, not_kept));
    assert_eq!(pair.conditions(), [Condition::Standby; 2]);
    assert_eq!([left.get(CHIP_CONTROL), right.get(CHIP_CONTROL)], [0, 0]);
    assert!(pair.follow(&mut NoopDelay).is_err_and(|error| error.error.cause == Cause::NotRunning));

    // Neither can be stopped, and both are tried.
    for camera in [&left, &right] {
        camera.0.borrow_mut().stuck.insert(CHIP_CONTROL, 0x188);
    }
    let error = pair.stop(&mut NoopDelay).unwrap_err();
    assert_eq!((error.eye, error.other), (CameraSide::Left, Condition::HalfConfigured));
    assert_eq!(pair.conditions(), [Condition::HalfConfigured; 2]);
    left.0.borrow_mut().stuck.clear();
    let error = pair.stop(&mut NoopDelay).unwrap_err();
    assert_eq!((error.eye, error.other), (CameraSide::Right, Condition::Standby));
    let text = error.to_string();
    assert!(text.contains("register 0x0007 holds 0x0188 after 0x0000 was written"), "{text}");
}

#[test]
fn a_trigger_is_one_pulse_and_never_a_missing_edge() {
    let mut trigger = Trigger::new(Pin::new(&edges(&[Low, Low, High, Low]))).unwrap();
    trigger.fire(10, &mut NoopDelay).unwrap();
    trigger.lower().unwrap(); // it is
    trigger.release().done();
    // It stays high once; the next pulse starts low.
    let stuck = edges_failing(&[Low, Low, High, Low, Low, High, Low], 3);
    let mut trigger = Trigger::new(Pin::new(&stuck)).unwrap();
    assert!(trigger.fire(10, &mut NoopDelay).is_err());
    trigger.fire(10, &mut NoopDelay).unwrap();
    trigger.release().done();
}

#[test]
fn a_trigger_that_is_held_is_lowered_until_it_is_low() {
    let states = edges_failing(&[Low, Low, High, Low, Low, Low, High], 3);
    let mut trigger = Trigger::new(Pin::new(&states)).unwrap();
    trigger.lower().unwrap(); // it is
    trigger.raise().unwrap();
    assert!(trigger.lower().is_err());
    trigger.lower().unwrap();
    trigger.lower().unwrap(); // it is
    trigger.raise().unwrap();
    trigger.release().done();
}

#[test]
fn two_hm01b0_start_although_a_reset_leaves_them_more_rows_than_a_frame_has() {
    const INTEGRATION: [u16; 2] = [0x0202, 0x0203];
    const AE_CTRL: u16 = 0x2100;
    for (config, rows) in [(hm01b0().config, 258), (config(162, 122, Binning::Two), 130)] {
        let (mut pair, [left, right]) = both::<Hm01b0>(0x24);
        assert_eq!(INTEGRATION.map(|register| left.get(register)), [0x01, 0x08]);
        pair.start(&config, PairExposure::LeftChooses, &mut NoopDelay).unwrap();
        let [high, low] = u16::to_be_bytes(rows).map(u16::from);
        for camera in [&left, &right] {
            assert_eq!(INTEGRATION.map(|register| camera.get(register)), [high, low]);
        }
        assert_eq!([left.get(AE_CTRL), right.get(AE_CTRL)], [1, 0]);
        let both_have = Exposure { rows, gain_code: 0x100 };
        assert_eq!(pair.follow(&mut NoopDelay), Ok(Some(both_have)));
    }
}

/// A sensor that says that it runs until the end of the frame in which it was stopped, and the
/// clock of this.
#[derive(Clone)]
struct InFrame(Fake, Rc<Cell<u32>>);

impl embedded_hal::i2c::ErrorType for InFrame {
    type Error = ErrorKind;
}

impl I2c for InFrame {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), ErrorKind> {
        self.0.transaction(address, operations)?;
        if let [Operation::Write([0x01, 0x00]), Operation::Read([mode])] = operations
            && self.1.get() > 0
        {
            *mode = 1;
        }
        Ok(())
    }
}

impl embedded_hal::delay::DelayNs for InFrame {
    fn delay_ns(&mut self, ns: u32) {
        self.1.set(self.1.get().saturating_sub(ns.div_ceil(1000)));
    }
}

#[test]
fn an_hm01b0_in_the_middle_of_a_frame_is_started_again() {
    let fake = Fake::of::<Hm01b0>();
    let mut sensor = InFrame(fake.clone(), Rc::new(Cell::new(0)));
    let mut chip = Chip::<Hm01b0, _, _>::new(sensor.clone(), Hm01b0::ADDRESS, NoReset);
    chip.start(&hm01b0().config, &mut sensor).unwrap();
    fake.said();
    sensor.1.set(260 * 125 + 83); // a frame of 6 MHz, and some
    chip.start(&hm01b0().config, &mut sensor).unwrap();
    let said = text(&fake.said());
    let writes = said.lines().filter(|line| line.starts_with('w')).collect::<Vec<_>>();
    assert_eq!(writes[..2], ["w 01 00 00", "w 01 03 01"], "stopped, then reset");
}

#[test]
fn nothing_that_a_sensor_sees_is_in_its_test_pattern() {
    // After whatever else is written: automatic exposure, black level, defect pixels, gains; and
    // walking ones.
    const REGISTERS: [u16; 7] = [0x2100, 0x1000, 0x1008, 0x0205, 0x020e, 0x020f, 0x0601];
    let fixed = PairExposure::Fixed(hm01b0().other);
    for exposure in [PairExposure::LeftChooses, fixed] {
        let (mut pair, fakes) = both::<Hm01b0>(0x24);
        let config = Config { test_pattern: true, ..hm01b0().config };
        pair.start(&config, exposure, &mut NoopDelay).unwrap();
        for fake in &fakes {
            assert_eq!(
                REGISTERS.map(|register| fake.get(register)),
                [0, 0, 0, 0, 0x01, 0x00, 0x11],
                "{exposure:?}"
            );
        }
    }
}

#[test]
fn reserved_bits_of_an_hm01b0_may_read_as_they_like() {
    // Without a public name, and those beside the bits that have a meaning.
    let unnamed = [
        0x3044, 0x3045, 0x3047, 0x3050, 0x3051, 0x3052, 0x3053, 0x3054, 0x3055, 0x3056, 0x3057,
        0x3058, 0x3065,
    ];
    let reserved = [
        (0x3059, 0x1f),
        (0x3060, 0x0a | 0xc0),
        (0x3064, 0xfb),
        (0x3067, 0xfc),
        (0x3068, 0x21 | 0xfe),
    ];
    for (register, value) in unnamed.map(|register| (register, 0xff)).into_iter().chain(reserved) {
        let fake = Fake::of::<Hm01b0>();
        fake.0.borrow_mut().stuck.insert(register, value);
        let mut chip = OnFake::<Hm01b0>::new(fake, Hm01b0::ADDRESS, NoReset);
        assert_eq!(chip.start(&hm01b0().config, &mut NoopDelay), Ok(()), "{register:#06x}");
    }
}

#[test]
fn what_went_wrong_is_said_in_words() {
    let say = |cause| CameraError::<ErrorKind> { cause, left: Condition::InReset }.to_string();
    assert_eq!(
        say(Cause::Identity { register: 0, found: 0x1313 }),
        "another chip answers: register 0x0000 holds 0x1313 (the camera is held in reset)"
    );
    assert_eq!(say(Cause::Pin), "the reset pin cannot be set (the camera is held in reset)");
    assert!(
        say(Cause::Bus { register: 7, error: ErrorKind::Overrun })
            .starts_with("the bus failed at register 0x0007: Overrun")
    );
    assert!(say(Cause::NotRunning).starts_with("the camera does not run: start it first"));
    assert!(say(Cause::Unsupported(Unsupported::Rows(9))).starts_with("the sensor cannot be"));
    assert_eq!(Condition::Running.to_string(), "running");
}

#[test]
fn a_pair_of_which_any_transaction_fails_runs_as_a_whole_or_not_at_all() {
    type Ask = fn(&mut Both<Mt9v034>) -> bool;
    /// Starts a pair, or lets it follow, with a failure after so many transactions of a camera;
    /// `None` when there are fewer.
    fn fail(eye: CameraSide, after: usize, ask: Ask) -> Option<[Condition; 2]> {
        let (mut pair, fakes) = started(76);
        let fake = &fakes[eye as usize];
        fakes[0].set(AEC_EXPOSURE_OUTPUT, 77);
        fake.0.borrow_mut().fails_after = Some(after);
        let is_done = ask(&mut pair);
        let is_left = fake.0.borrow().fails_after.is_some();
        assert_eq!(is_done, is_left, "a failure was not told");
        (!is_left).then(|| pair.conditions())
    }
    let start: Ask =
        |pair| pair.start(&mt9v034().config, PairExposure::LeftChooses, &mut NoopDelay).is_ok();
    let asks: [(Ask, [usize; 2]); 2] =
        [(start, [30, 30]), (|pair| pair.follow(&mut NoopDelay).is_ok(), [3, 8])];
    for (ask, least) in asks {
        for (eye, least) in CameraSide::BOTH.into_iter().zip(least) {
            let ends = (0..).map_while(|after| fail(eye, after, ask)).collect::<Vec<_>>();
            assert!(ends.len() >= least, "{}", ends.len());
            for (after, ends) in ends.iter().enumerate() {
                // All three that `follow` asks of the left one are reads: what runs goes on.
                let is_read = eye == CameraSide::Left && after < 3 && least < 30;
                let expected = if is_read { Condition::Running } else { Condition::Standby };
                assert_eq!(*ends, [expected; 2], "{eye:?}, transaction {after}");
            }
        }
    }
}
