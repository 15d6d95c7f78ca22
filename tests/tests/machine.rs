//! The programs `live` and `selftest` as they are flashed, in a model of the STM32H743 (`tests/machine`): from reset to the bytes on both UARTs.
//!
//! Not in the model, and so not shown here: caches, MPU faults, USB, the ADC, the time of anything within a few tens of percent.

use linestereo::Dims;
use linestereo_firmware::programs::expected::QVGA;
use linestereo_rig::{Calibration, Camera, Lens, RigImage, View};
use linestereo_sim::board::{firmware, toolchain::Toolchain};
use linestereo_tests::board::or_skip;
use linestereo_wire::{
    Command as HostCommand, Decoder, Health, MAX_COMMAND, MAX_PACKET, MachineReport, Message, Outcome, ParamUpdate,
    RegionBox, Regions, Request, ResetCause, Silicon, encode,
};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// A Python that has Unicorn: the system's, or one of a folder of its own.
fn python() -> Option<PathBuf> {
    let has_unicorn = |python: &Path| {
        Command::new(python).args(["-c", "import unicorn"]).output().is_ok_and(|out| out.status.success())
    };
    let system = PathBuf::from("python3");
    if has_unicorn(&system) {
        return Some(system);
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("unicorn");
    let own = folder.join("bin/python");
    if !has_unicorn(&own) {
        let done = |command: &mut Command| command.output().is_ok_and(|out| out.status.success());
        let _ = done(Command::new("python3").args(["-m", "venv"]).arg(&folder))
            && done(Command::new(&own).args(["-m", "pip", "install", "--quiet", "unicorn==2.1.4"]));
    }
    has_unicorn(&own).then_some(own)
}

/// The images of `live` and `selftest`, and what runs them; none where either cannot be had.
fn machine() -> Option<&'static (PathBuf, Vec<PathBuf>)> {
    static MACHINE: OnceLock<Option<(PathBuf, Vec<PathBuf>)>> = OnceLock::new();
    let made = MACHINE.get_or_init(|| {
        let Some(python) = python() else {
            eprintln!("\nSKIPPED, no machine model here: pip install unicorn==2.1.4\n");
            return None;
        };
        let board = linestereo_boards::Board::STM32H743;
        let toolchain = or_skip(Toolchain::for_board(&board))?;
        let features = ["still-scene".to_owned()];
        let built = firmware::build_all(&toolchain, &board, &["live", "selftest"], firmware::Logs::None, &features);
        Some((python, or_skip(built)?))
    });
    made.as_ref()
}

/// Result of a run: see `tests/machine/stm32h743.py`.
struct Run {
    result: Value,
    /// Records that the host got, with the time of their last byte, us.
    records: Vec<(u64, Message)>,
    damaged: usize,
}

impl Run {
    /// Of `live`.
    fn of(scenario: &Value) -> Option<Self> {
        Self::of_program(0, scenario)
    }

    fn of_program(program: usize, scenario: &Value) -> Option<Self> {
        let (python, images) = machine()?;
        let folder = tempfile::tempdir().unwrap();
        let [asked, given] = ["scenario.json", "result.json"].map(|name| folder.path().join(name));
        std::fs::write(&asked, scenario.to_string()).unwrap();
        let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("machine/stm32h743.py");
        let run = Command::new(python).arg(model).arg(&images[program]).arg(asked).arg(&given).output().unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let result: Value = serde_json::from_slice(&std::fs::read(given).unwrap()).unwrap();
        let (mut decoder, mut records, mut damaged) = (Decoder::<Message, MAX_PACKET>::new(), Vec::new(), 0);
        for (byte, time) in bytes_of(&result["host"]).into_iter().zip(result["host_us"].as_array().unwrap()) {
            match decoder.push(byte) {
                Some(Ok(record)) => records.push((time.as_u64().unwrap(), record)),
                Some(Err(_)) => damaged += 1,
                None => {}
            }
        }
        Some(Self { result, records, damaged })
    }

    fn frames(&self) -> Vec<&linestereo_wire::FrameHead> {
        self.records
            .iter()
            .filter_map(|(_, record)| if let Message::Frame(head) = record { Some(head) } else { None })
            .collect()
    }
}

fn bytes_of(hex: &Value) -> Vec<u8> {
    let hex = hex.as_str().unwrap().as_bytes();
    hex.chunks(2).map(|pair| u8::from_str_radix(core::str::from_utf8(pair).unwrap(), 16).unwrap()).collect()
}

/// Identifiers of MAVLink 2 messages that follow each other without a gap.
fn mavlink_ids(mut bytes: &[u8]) -> Vec<u32> {
    let mut ids = Vec::new();
    while let [0xfd, length, _, _, _, _, _, a, b, c, ..] = *bytes {
        ids.push(u32::from_le_bytes([a, b, c, 0]));
        bytes = bytes.get(usize::from(length) + 12..).unwrap_or_default();
    }
    assert!(bytes.is_empty() || bytes[0] == 0xfd, "bytes between messages");
    ids
}

/// Commands of a host, each at its time, us.
fn host(requests: &[(u64, Request)]) -> Value {
    let commands = (1..).zip(requests).map(|(id, (time, request))| {
        let mut buffer = [0; MAX_COMMAND];
        let packet = encode(&HostCommand { id, request: request.clone() }, &mut buffer).unwrap();
        json!([time, packet.iter().map(|byte| format!("{byte:02x}")).collect::<String>()])
    });
    commands.collect()
}

/// A rig of the board's cameras, as `flash-image` makes one.
fn rig() -> RigImage {
    let dims = Dims { width: 320, height: 240 };
    let lens = Lens::BrownConrady { k: [-0.05, 0.0, 0.0], p: [0.0; 2] };
    let camera = Camera::new(dims, [250.0; 2], [159.5, 119.5], 0.0, lens).unwrap();
    let calibration = Calibration::new(camera, camera, [1.0, 0.0, 0.0, 0.0], [-0.08, 0.0, 0.0]).unwrap();
    RigImage::new(calibration, dims, View::default(), (0, 64)).unwrap()
}

/// Grey level of a pixel of a sensor's frame: see `sensor_row` of the model.
fn sensor_pixel(is_right: bool, frame: u64, x: u64, y: u64) -> u8 {
    let x = if is_right { x + 10 } else { x };
    (40 + (((x / 8 * 73 + y / 8 * 151 + frame / 2 * 29) * 2_654_435_761) >> 13) % 180) as u8
}

/// Ten seconds of a board: pairs, three bad frames, a photograph, a rig that is erased and written, objects by their boxes, an autopilot. Then
/// power is lost, and comes back.
#[test]
fn ten_seconds_of_a_board() {
    const FAULTS: [(&str, u64, &str, usize); 3] =
        [("left", 12, "short", 3), ("left", 23, "few", 2), ("right", 33, "overrun", 0)];
    let mut bytes = linestereo_wire::RigBytes::new();
    bytes.extend_from_slice(&rig().encode(0)).unwrap();
    let mut regions = Regions::default();
    let _ = regions.boxes.push(RegionBox { label: 7, left: 80, top: 60, right: 240, bottom: 180 });
    let update = ParamUpdate { min_confidence_q16: Some(0x8000), ..ParamUpdate::default() };
    let requests = [
        (100_000, Request::Start),
        (1_500_000, Request::SetParams(update)),
        (2_000_000, Request::SetRegions(regions)),
        (3_000_000, Request::Photograph),
        (5_500_000, Request::SetRig(bytes)),
    ];
    let faults: Vec<_> = FAULTS.iter().map(|(eye, frame, kind, _)| json!([eye, frame, kind])).collect();
    let scenario = json!({ "until_us": 10_000_000, "host": host(&requests), "faults": faults, "erase_us": 4e6 });
    let Some(run) = Run::of(&scenario) else { return };
    assert_eq!((run.damaged, &run.result["ending"]), (0, &Value::Null), "{}", run.result["at"]);

    // Frames in order, none lost without a word.
    let frames = run.frames();
    assert!(frames.len() > 60, "{}", frames.len());
    for (before, after) in frames.iter().zip(frames.iter().skip(1)) {
        let gap = after.sequence - before.sequence;
        let is_told = after.health.contains(Health::RESULTS_SKIPPED);
        assert!(gap == 1 || is_told, "{} follows {}", after.sequence, before.sequence);
        assert!(after.capture_time_us > before.capture_time_us, "{after:?} follows {before:?}");
    }

    // Each bad frame by its name, and it costs that frame alone.
    let missing: Vec<_> = frames.iter().filter(|head| head.health.contains(Health::PAIR_MISSING)).collect();
    assert_eq!(missing.len(), FAULTS.len());
    for head in missing {
        let next = frames.iter().find(|next| next.sequence == head.sequence + 1).unwrap();
        let lost_us = next.capture_time_us - head.capture_time_us;
        assert!(!next.health.contains(Health::PAIR_MISSING) && lost_us < 60_000, "{lost_us} us");
    }
    let losses = run.records.iter().rev().find_map(|(_, record)| match record {
        Message::Capture(losses) => Some(*losses),
        _ => None,
    });
    let losses = losses.unwrap();
    for (eye, _, kind, fault) in FAULTS {
        assert_eq!(losses.faults[usize::from(eye == "right")][fault], 1, "{kind}: {losses:?}");
    }
    assert_eq!((losses.faults.as_flattened().iter().sum::<u32>(), losses.sensors), (3, [0; 2]), "{losses:?}");

    let objects = run
        .records
        .iter()
        .filter_map(|(_, record)| if let Message::Objects(found) = record { Some(found) } else { None });
    assert!(
        objects
            .flat_map(|found| &found.list)
            .any(|object| object.label == 7 && object.disparity_q6.is_ok_and(|d_q6| d_q6.abs_diff(640) < 16)),
        "no box is 10 px apart"
    );

    // The photograph is what the sensors sent.
    let mut photo = [vec![0; 320 * 240], vec![0; 320 * 240]];
    let mut pixels = 0;
    for (_, record) in &run.records {
        if let Message::Pixels(part) = record {
            let first = part.first as usize;
            photo[usize::from(part.is_right)][first..first + part.list.len()].copy_from_slice(&part.list);
            pixels += part.list.len();
        }
    }
    assert_eq!(pixels, 2 * 320 * 240);
    let is_frame = |frame: &u64| {
        let equals = |is_right: bool| {
            let pixel = |i: usize| sensor_pixel(is_right, *frame, i as u64 % 320, i as u64 / 320);
            photo[usize::from(is_right)].iter().enumerate().all(|(i, found)| *found == pixel(i))
        };
        // Both are triggered for either: the right one that is captured is its next frame.
        equals(false) && (*frame..frame + 3).any(|_| equals(true))
    };
    assert!((0..300).any(|frame| is_frame(&frame)), "a photograph of no frame");

    // The rig was erased, written, and is used; nothing waited for longer than half of what the watchdog allows.
    let answers = run
        .records
        .iter()
        .filter_map(|(_, record)| if let Message::Answer(answer) = record { Some(answer) } else { None });
    assert!(answers.clone().all(|answer| answer.outcome == Outcome::Accepted), "{:?}", answers.collect::<Vec<_>>());
    assert_eq!(run.result["erases"], 1);
    let unfed_us = run.result["longest_unfed_us"].as_f64().unwrap();
    assert!((4e6..0.5 * 9.5e6).contains(&unfed_us), "{unfed_us} us");
    let last = frames.last().unwrap();
    assert!(last.segments > 0, "{last:?}");

    // The autopilot got obstacles in whole messages.
    let messages = mavlink_ids(&bytes_of(&run.result["autopilot"]));
    assert!(messages.contains(&0) && messages.contains(&330), "{messages:?}");

    // What the DMA writes lies in memory that is not cached: normal memory, TEX 1, neither C nor B.
    let number = |value: &Value, at: usize| value[at].as_u64().unwrap();
    for target in run.result["dma"].as_array().unwrap() {
        let (start, end) = (number(target, 0), number(target, 0) + number(target, 1));
        let regions = run.result["regions"].as_array().unwrap().iter();
        let holding = regions.filter(|region| {
            (number(region, 0)..=number(region, 0) + number(region, 1)).contains(&end) && number(region, 0) <= start
        });
        assert!(holding.clone().any(|region| number(region, 2) & 0x3b == 0x08), "{:?}", holding.collect::<Vec<_>>());
    }
    let used = run.result["handler_stack"].as_u64().unwrap();
    assert!((100..4096).contains(&used), "{used} bytes of the handlers' stack");
    let executed = run.result["executed"].as_u64().unwrap();
    println!("executed {executed} of {} bytes of code; never: {}", run.result["code"], run.result["never"]);
    assert!(executed > 150_000, "{executed} of {}: {}", run.result["code"], run.result["never"]);

    // Power is lost and comes back: the rig is there.
    let again = json!({ "until_us": 1_000_000, "flash": run.result["flash"] });
    let Some(Message::Hello(hello)) = Run::of(&again).unwrap().records.first().map(|(_, record)| record.clone()) else {
        panic!()
    };
    assert_eq!(hello.rig.in_use.map(|rig| rig.rectified), Some([320, 240]));
    assert_eq!(hello.rig.slots[0], Ok(0));
}

/// A fault of the processor ends the program, and the next run names it.
#[test]
fn a_hard_fault_is_named_after_the_reset() {
    let scenario = json!({ "until_us": 600_000, "hard_fault_us": 300_000, "resets": 1 });
    let Some(run) = Run::of(&scenario) else { return };
    let hellos = run
        .records
        .iter()
        .filter_map(|(_, record)| if let Message::Hello(hello) = record { Some(hello) } else { None });
    let causes: Vec<_> = hellos.map(|hello| hello.reset.map(|reset| reset.cause)).collect();
    assert_eq!(causes, [Some(ResetCause::PowerOn), Some(ResetCause::Fault)]);
    assert_eq!(run.result["resets_us"].as_array().map(Vec::len), Some(1));
}

/// The clocks and caches of `live`, cycles by the core's counter, and the PC's digests.
#[test]
fn selftest_counts_cycles_and_has_the_digests_of_the_pc() {
    const CASES: [u16; 2] = [13, 16];
    let requests =
        [(100_000, Request::Describe), (200_000, Request::RunCase(CASES[0])), (210_000, Request::RunCase(CASES[1]))];
    let Some(run) = Run::of_program(1, &json!({ "until_us": 500_000, "host": host(&requests) })) else { return };
    assert_eq!((run.damaged, &run.result["ending"]), (0, &Value::Null), "{}", run.result["at"]);
    let said = |found: fn(&Message) -> Option<Message>| {
        run.records.iter().filter_map(|(_, record)| found(record)).collect::<Vec<_>>()
    };
    let answers = said(|record| matches!(record, Message::Answer(_)).then(|| record.clone()));
    assert_eq!(answers.len(), requests.len(), "{:?}", run.records.last());

    let machines = said(|record| matches!(record, Message::Machine(_)).then(|| record.clone()));
    let [.., Message::Machine(MachineReport { unit, cases: 22, silicon: Some(silicon), .. })] = &machines[..] else {
        panic!("{machines:?}")
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

    let reports = said(|record| matches!(record, Message::Case(_)).then(|| record.clone()));
    assert_eq!(reports.len(), CASES.len());
    for (report, case) in reports.iter().zip(CASES) {
        let Message::Case(report) = report else { unreachable!() };
        assert_eq!((report.case, report.digests), (case, QVGA[usize::from(case)]), "{}", report.name);
        let cost: u64 = report.costs.iter().sum();
        assert!(cost > 300_000 && cost <= report.total, "{report:?}");
        // The model's core runs at 400 MHz.
        let hz = report.total * 1_000_000 / u64::from(report.time_us);
        assert!(hz.abs_diff(400_000_000) < 4_000_000, "{hz}: {report:?}");
    }
    let unfed_us = run.result["longest_unfed_us"].as_f64().unwrap();
    assert!(unfed_us < 0.5 * 9.5e6, "{unfed_us} us");
}
