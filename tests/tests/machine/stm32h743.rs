//! An STM32H743 with two MT9V034 in turn, `live` and `selftest`: a host on a UART or on USB, an
//! autopilot on a UART.
//!
//! Not in the model, and so not shown here: caches, MPU faults, USB below its packets, the ADC, the
//! time of anything within a few tens of percent.

mod cameras;
mod kept;
mod scenes;
mod usb;

use super::{Run, bad_frames, bytes_of, frames_of, hex, host, mavlink_ids, records, rig_bytes};
use linestereo::health::HealthFlags;
use linestereo::params::{Margin, Parts};
use linestereo::units::{Confidence, Depth};
use linestereo_boards::built_in::digests::QVGA;
use linestereo_mavlink::{Fields, Mavlink, Sender, Timesync};
use linestereo_rig::CameraSide;
use linestereo_tests::board::image;
use linestereo_wire::{
    MachineReport, Message, Outcome, PairHead, ParamUpdate, RegionBox, Regions, Request, RigFault,
    RigUpdate, SETTINGS, Setting, SettingValue, SettingValues, Silicon, TimeSource,
};
use serde_json::{Value, json};
use std::sync::LazyLock;

/// Runs an image as it is flashed: for a still scene, or such cameras' pairs are refused.
fn execute(program: &'static str, scenario: &Value) -> Option<Run> {
    let image = || image(&linestereo_boards::Board::STM32H743, program);
    let mut scenario = scenario.clone();
    scenario["board"] = json!("stm32h743");
    Run::of("stm32h7.py", image, &scenario)
}

const FAULTS: [(CameraSide, u64, &str, usize); 3] = [
    (CameraSide::Left, 12, "short", 3),
    (CameraSide::Left, 23, "few", 2),
    (CameraSide::Right, 33, "overrun", 0),
];

/// Bad frames with a rig, when rows are rectified as they come. A lost left frame makes the next
/// one's number odd, or even again.
const FAULTS_AGAIN: [(CameraSide, u64, &str, usize); 5] = [
    (CameraSide::Left, 4, "short", 3),
    (CameraSide::Right, 8, "few", 2),
    (CameraSide::Left, 13, "overrun", 0),
    (CameraSide::Left, 18, "blind", 1),
    (CameraSide::Right, 24, "none", 5),
];

// Runs that tests share.
static SECONDS: LazyLock<Option<Run>> = LazyLock::new(|| {
    let mut regions = Regions::default();
    let _ = regions.boxes.push(RegionBox { label: 7, left: 80, top: 60, right: 240, bottom: 180 });
    let update =
        ParamUpdate { min_confidence: Some(Confidence::from_num(0.5)), ..ParamUpdate::default() };
    let requests = [
        (100_000, Request::Start),
        (1_500_000, Request::SetParams(update)),
        (1_700_000, Request::SetRegions(regions)),
        (2_000_000, Request::Photograph),
        (3_700_000, Request::SetRig(rig_bytes())),
    ];
    let faults = bad_frames(&FAULTS);
    let scenario = json!({ "until_us": 8_200_000, "host": host(&requests), "faults": faults, "erase_us": 4e6 });
    execute("live", &scenario)
});

static AGAIN: LazyLock<Option<Run>> = LazyLock::new(|| {
    let run = SECONDS.as_ref()?;
    let (host, faults) = (host(&[(100_000, Request::Start)]), bad_frames(&FAULTS_AGAIN));
    // The other slot of the rig: whole, newer, and of a program that knows a lens more.
    let mut flash = bytes_of(&run.result["flash"]);
    let newer = scenes::faulty(96, &[7, 0, 0, 0], 1);
    flash[3 * kept::SECTOR..][..newer.len()].copy_from_slice(&newer);
    execute(
        "live",
        &json!({ "until_us": 1_400_000, "flash": hex(&flash), "host": host, "faults": faults }),
    )
});

/// Seconds of a board: pairs, three bad frames, a photograph, a rig that is erased and written,
/// objects by their boxes, an autopilot. Then power is lost, and comes back, and frames are bad
/// again.
#[test]
fn seconds_of_a_board() {
    let Some(run) = &*SECONDS else { return };
    run.assert_whole();

    let frames = run.frames_in_order();
    assert!(frames.len() > 30, "{}", frames.len());

    // Each bad frame by its name, and it costs that frame alone.
    run.assert_bad_frames(
        &frames,
        &FAULTS.map(|(eye, _, _, kind)| (eye, kind)),
        FAULTS.len(),
        60_000,
    );

    let objects = frames_of(run).into_iter().flat_map(|frame| frame.objects);
    let is_right = |d_q6: i16| d_q6.abs_diff(640) < 16;
    let mut of_box = objects.filter(|object| object.label == 7);
    assert!(of_box.any(|object| object.disparity_q6.is_ok_and(is_right)), "none is 10 px apart");

    run.assert_photograph();

    // The rig was erased, written, and is used; nothing waited for longer than half of what the
    // watchdog allows.
    run.assert_all_accepted();
    assert_eq!(run.result["erases"], 1);
    let unfed_us = run.result["longest_unfed_us"].as_f64().unwrap();
    assert!((4e6..0.5 * 9.5e6).contains(&unfed_us), "{unfed_us} us");
    let last = frames.last().unwrap();
    assert!(last.segments > 0, "{last:?}");

    run.assert_autopilot();
    run.assert_uncached_dma();
    let used = run.result["handler_stack"].as_u64().unwrap();
    assert!((100..4096).contains(&used), "{used} bytes of the handlers' stack");
    run.assert_stack();

    // Power is lost and comes back: the rig is there, and used before a newer one that cannot be.
    let again = AGAIN.as_ref().unwrap();
    again.assert_whole();
    again.assert_all_accepted();
    assert_eq!(again.assert_rig_is_used().rig.slots, [Ok(0), Err(RigFault::LeftCamera)]);

    // Bad frames cost what they did without it. While a right one is waited for nobody triggers the
    // left camera, which is called silent as well.
    let mut bad = FAULTS_AGAIN.map(|(eye, _, _, kind)| (eye, kind)).to_vec();
    bad.push((CameraSide::Left, 5));
    let frames = again.frames_in_order();
    again.assert_bad_frames(&frames, &bad, FAULTS_AGAIN.len(), 60_000);
    let last = frames.last().unwrap();
    assert!(last.counts.matched > 0 && last.capture_time_us > 1_250_000, "{last:?}");
}

fn boxes(boxes: &[RegionBox], only: bool) -> Request {
    Request::SetRegions(Regions { boxes: boxes.iter().copied().collect(), only })
}

/// Settings other than those that a board was built with; a confidence is kept in 1/65536.
const VALUES: SettingValues = [
    -1.0, 48.0, 56.0, 28.0, 10.0, 32.0, 2.0, 0.625, 0.0, 10.0, 8.0, -0.5, 0.5, 3.0, 12.0, 1.0,
    30.0, 1.0, 0.08, 1.0,
];

/// Times at which the host resets the bus, closes the port, and opens it; the clock that it sets,
/// us.
const RESET_US: u64 = 1_800_000;
const CLOSED_US: u64 = 2_100_000;
const OPENED_US: u64 = 2_300_000;
const HOST_CLOCK_US: u64 = 1_000_000_000;
/// Lead of the autopilot's clock over the board's, us: frames have its time until the host sets
/// another.
const AUTOPILOT_CLOCK_US: u64 = 500_000_000;

/// Requests of a host over USB, and is each accepted.
fn wishes() -> Vec<(Request, bool)> {
    let set =
        |number: usize, value: f32| Request::Set(SettingValue { number: number as u8, value });
    let rig = RigUpdate { focal_px: 250.0, baseline_m: 0.08, offset_px: 0.0 };
    let update = ParamUpdate {
        min_disparity: Some(-2),
        max_disparity: Some(64),
        anchor_gradient: Some(48),
        edge_gradient: Some(32),
        min_extent: Some(8),
        cell: Some(16),
        margin: Some(Margin::Metres {
            nearer: Depth::from_num(0.125),
            farther: Depth::from_num(0.25),
        }),
        min_confidence: Some(Confidence::from_num(0.5)),
        reach: Some(3),
        rig: Some(rig),
        parts: Some(Parts::Both),
    };
    let pair =
        PairHead { width: 320, height: 240, capture_time_us: 0, right_capture_time_us: None };
    let person = RegionBox { label: 1, left: 40, top: 30, right: 120, bottom: 200 };
    let mut damaged = rig_bytes();
    damaged[40] ^= 1;
    let mut wishes = vec![
        (Request::Describe, true),
        (Request::Start, true),
        (Request::Settings, true),
        (
            Request::SetParams(ParamUpdate { margin: update.margin, ..ParamUpdate::default() }),
            false,
        ), // without a rig
        (Request::SetParams(update), true),
        (Request::SetParams(ParamUpdate { cell: Some(7), ..update }), false),
        (
            Request::SetParams(ParamUpdate {
                rig: Some(RigUpdate { focal_px: -1.0, ..rig }),
                ..update
            }),
            false,
        ),
        (boxes(&[person, RegionBox { label: 2, left: 200, right: 280, ..person }], false), true),
        (boxes(&[RegionBox { left: 400, right: 410, ..person }], false), false),
        (Request::Pair(pair), false),
        (Request::RawPair(pair), false),
        (Request::RunCase(0), false),
        (Request::ReadClock, true),
        (Request::SetRig(damaged), false),
        (set(SETTINGS, 0.0), false),
        (set(0, 5.0), false),
        (set(7, f32::NAN), false),
    ];
    wishes.extend((0..).zip(VALUES).map(|(number, value)| (set(number, value), true)));
    wishes.extend([
        (set(Setting::VEHICLE + 3, -5.0), false), // below `lowest_m`
        (Request::KeepSettings, true),
        (Request::Settings, true),
        (boxes(&[person], true), true),
        (Request::SetClock(HOST_CLOCK_US), true),
        (Request::Stop, true),
        (Request::Start, true),
        (Request::Photograph, true),
    ]);
    wishes
}

static BY_USB: LazyLock<Option<Run>> = LazyLock::new(|| {
    let mut requests: Vec<_> =
        (0..).zip(wishes()).map(|(number, (wish, _))| (200_000 + number * 20_000, wish)).collect();
    requests.extend([
        (RESET_US + 50_000, Request::Describe),
        (OPENED_US + 100_000, Request::Describe),
        (OPENED_US + 300_000, Request::ResetSettings),
        (OPENED_US + 400_000, Request::Settings),
        (OPENED_US + 500_000, Request::Bootloader),
    ]);
    let mut host = host(&requests).as_array().unwrap().clone();
    host.extend([
        json!([210_000, hex(&[3, 0x55, 0x66, 0, 9, 1, 2, 0, 0])]), // no packets
        json!([RESET_US, "reset"]),
        json!([CLOSED_US, "close"]),
        json!([OPENED_US, "open"]),
    ]);
    host.sort_by_key(|at| at[0].as_u64());
    let messages = json!([
        [300_000, hex(&message(&Raw::<21, 159>(vec![1, 196])))],
        [
            500_000,
            hex(&message(&Raw::<20, 214>([vec![0xff, 0xff, 1, 196], name("RANGE_M")].concat())))
        ],
        [520_000, hex(&message(&Raw::<20, 214>([vec![3, 0, 1, 196], name("")].concat())))],
        [540_000, hex(&message(&Timesync { tc1: 0, ts1: 123_456_789 }))],
        [
            560_000,
            hex(&message(&Raw::<23, 168>(
                [1f32.to_le_bytes().to_vec(), vec![1, 196], name("POLICY"), vec![9]].concat()
            )))
        ],
    ]);
    let scenario = json!({
        "until_us": OPENED_US + 1_000_000, "port": "usb", "host": host, "autopilot": messages, "erase_us": 1e5, "resets": 1,
        "autopilot_clock_us": AUTOPILOT_CLOCK_US,
    });
    execute("live", &scenario)
});

/// A message of these fields.
struct Raw<const ID: u32, const EXTRA: u8>(Vec<u8>);

impl<const ID: u32, const EXTRA: u8> Mavlink for Raw<ID, EXTRA> {
    const ID: u32 = ID;
    const CRC_EXTRA: u8 = EXTRA;

    fn put(&self, fields: &mut Fields) {
        fields.put(&self.0);
    }
}

/// The frame of a ground station.
fn message(message: &impl Mavlink) -> Vec<u8> {
    let (mut station, mut bytes) =
        (Sender { system: 255, component: 190, sequence: 0 }, Vec::new());
    let mut write = |frame: &[u8]| {
        bytes.extend_from_slice(frame);
        Ok::<(), ()>(())
    };
    station.send(message, &mut write).unwrap();
    bytes
}

fn name(name: &str) -> Vec<u8> {
    [name.as_bytes(), &vec![0; 16 - name.len()]].concat()
}

/// A host on USB: enumeration, every request and its answer, a bus reset, a port that is closed and
/// opened, and the boot loader.
#[test]
fn a_host_on_usb() {
    let Some(run) = &*BY_USB else { return };
    assert_eq!(run.result["ending"], "the chip's boot loader");
    run.assert_usb("stm32h743", "2E0031000E51303434363337", false);
    assert_eq!(run.damaged, 0);

    // An answer to each request, in order.
    let mut expected: Vec<_> = wishes().into_iter().map(|(_, is_done)| is_done).collect();
    expected.extend([true; 5]);
    let answers: Vec<_> =
        run.answers().map(|answer| (answer.command, answer.outcome == Outcome::Accepted)).collect();
    assert_eq!(answers, (1..).zip(expected).collect::<Vec<_>>());
    let value = |record: &Message| match record {
        Message::Setting(SettingValue { value, .. }) => Some(*value),
        _ => None,
    };
    let settings: Vec<f32> = run.all(value).collect();
    let [before, changed, after] =
        [0, 1, 2].map(|report| &settings[report * SETTINGS..][..SETTINGS]);
    assert_eq!((settings.len(), changed), (3 * SETTINGS, &VALUES[..]));
    assert_eq!(after, before);

    // Frames follow each other, but for what the host itself cut off. What it did not fetch is not
    // for the next one.
    let frames = run.frames_in_order_but(&[RESET_US, CLOSED_US]);
    // 36 when this was written; with pictures of fewer points, which take less of the bus, 42.
    assert!(frames.len() > 30, "{}", frames.len());
    let (_, first) = frames.iter().find(|(time, _)| *time > OPENED_US).unwrap();
    // Nothing of before the port was closed. How old it is depends on when in a pair it is opened.
    assert!(first.capture_time_us > HOST_CLOCK_US + CLOSED_US, "{first:?}");
    let autopilots = frames.iter().find(|(_, head)| head.clock == TimeSource::Autopilot);
    let (at, head) = autopilots.unwrap();
    let late_us = (at + AUTOPILOT_CLOCK_US).checked_sub(head.capture_time_us);
    assert!(late_us.is_some_and(|late_us| late_us < 200_000), "{head:?} came at {at} us");
    run.assert_photograph();

    // The UART, on which nobody has said anything, has whole records of the same.
    let (on_uart, damaged) = records(&run.result["uart"], &run.result["uart_us"]);
    assert!(
        damaged == 0 && on_uart.iter().any(|(_, record)| matches!(record, Message::Frame(_))),
        "{damaged}"
    );

    // The autopilot: all parameters and three more, an answer about the time.
    let ids = mavlink_ids(&bytes_of(&run.result["autopilot"]));
    assert_eq!(ids.iter().filter(|&&id| id == 22).count(), SETTINGS + 3, "{ids:?}");
    assert!(ids.contains(&111), "{ids:?}");
}

/// Faults of pictures, each for [`PICTURES_US`], and a flag that names it. The pattern has 8 px
/// blocks: a lower or a swapped one looks like one without matches.
const PICTURES: [(&str, HealthFlags); 6] = [
    ("covered", HealthFlags::LEFT_EXPOSURE),
    ("bright", HealthFlags::RIGHT_SATURATED),
    ("dark", HealthFlags::RIGHT_EXPOSURE),
    ("lower", HealthFlags::FEW_MATCHES),
    ("swapped", HealthFlags::FEW_MATCHES),
    ("frozen", HealthFlags::RIGHT_FROZEN),
];
const PICTURES_US: u64 = 400_000;
static BAD_PICTURES: LazyLock<Option<Run>> = LazyLock::new(|| {
    let pictures = (1..).zip(PICTURES);
    let pictures: Vec<_> = pictures
        .map(|(part, (kind, _))| json!([PICTURES_US * part, PICTURES_US * (part + 1), kind]))
        .collect();
    let scenario = json!({ "until_us": 3_000_000, "host": host(&[(100_000, Request::Start)]), "pictures": pictures });
    execute("live", &scenario)
});

/// Pictures that are wrong for some time; the last of each kind are named, and good ones come
/// again.
#[test]
fn bad_pictures_are_named() {
    let Some(run) = &*BAD_PICTURES else { return };
    run.assert_whole();
    let frames = run.frames_in_order();
    let during = |part: u64| {
        let last_half = PICTURES_US * part + PICTURES_US / 2..PICTURES_US * (part + 1) - 100_000;
        frames.iter().filter(move |head| last_half.contains(&head.capture_time_us))
    };
    for (part, (kind, expected)) in (1..).zip(PICTURES) {
        let names = || during(part).map(|head| head.health.to_string()).collect::<Vec<_>>();
        assert!(during(part).count() > 0, "{kind}");
        assert!(
            during(part).all(|head| head.health.of_pair().contains(expected)),
            "{kind}: {:?}",
            names()
        );
        let is_refused =
            expected != HealthFlags::FEW_MATCHES && expected != HealthFlags::RIGHT_FROZEN;
        assert!(
            !is_refused || during(part).all(|head| head.segments == 0),
            "{kind}: {:?}",
            names()
        );
    }
    let first = during(0).next().unwrap();
    assert!(first.health.of_pair().is_fit(), "{first:?}");
}

/// Code that these runs of `live` execute together, bytes: 151 776 of 175 834 when this was
/// written, some 740 of which are constants; 2 % less is allowed, since compilers differ. Of the
/// rest a quarter is out of reach here: masks, cameras wider than 512 px, portable forms of
/// kernels, records of other programs. The rest is printed.
#[test]
fn most_of_the_code_runs() {
    let runs = [
        &SECONDS,
        &AGAIN,
        &BY_USB,
        &BAD_PICTURES,
        &scenes::SCENES,
        &cameras::SENSORS,
        &usb::ASKED,
        &kept::DAMAGED,
        &kept::RESETS,
    ];
    let codes = runs.iter().map(|run| run.as_ref().map(Run::code));
    let Some(code) = codes.reduce(|all, more| Some(all?.and(more?))).flatten() else { return };
    code.assert_executed(150_000);
}

/// The clocks and caches of `live`, cycles by the core's counter, and the PC's digests.
#[test]
fn selftest_counts_cycles_and_has_the_digests_of_the_pc() {
    const CASES: [u16; 2] = [13, 16];
    let requests = [
        (100_000, Request::Describe),
        (200_000, Request::RunCase(CASES[0])),
        (210_000, Request::RunCase(CASES[1])),
    ];
    let Some(run) = execute("selftest", &json!({ "until_us": 500_000, "host": host(&requests) }))
    else {
        return;
    };
    run.assert_whole();
    assert_eq!(run.answers().count(), requests.len(), "{:?}", run.records.last());

    let mut machines =
        run.all(|record| if let Message::Machine(of) = record { Some(of) } else { None });
    let machine = machines.next_back();
    let Some(MachineReport { unit, cases: 22, silicon: Some(silicon), .. }) = machine else {
        panic!("{machine:?}")
    };
    let expected = Silicon {
        processor_id: 0x411f_c271,
        chip_id: 0x2003_6450,
        core_hz: 400_000_000,
        flash_wait: 2,
        instruction_cache: true,
        data_cache: true,
    };
    assert_eq!((&**unit, silicon), ("cycles", &expected));

    let reports =
        run.all(|record| if let Message::Case(report) = record { Some(report) } else { None });
    assert_eq!(reports.clone().count(), CASES.len());
    for (report, case) in reports.zip(CASES) {
        assert_eq!(
            (report.case, report.digests),
            (case, QVGA[usize::from(case)]),
            "{}",
            report.name
        );
        let cost: u64 = report.costs.iter().sum();
        assert!(cost > 300_000 && cost <= report.total, "{report:?}");
        // The model's core runs at 400 MHz.
        let hz = report.total * 1_000_000 / u64::from(report.time_us);
        assert!(hz.abs_diff(400_000_000) < 4_000_000, "{hz}: {report:?}");
    }
    let unfed_us = run.result["longest_unfed_us"].as_f64().unwrap();
    assert!(unfed_us < 0.5 * 9.5e6, "{unfed_us} us");
}
