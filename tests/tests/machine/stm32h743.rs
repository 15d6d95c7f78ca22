//! An STM32H743 with two MT9V034 in turn, `live` and `selftest`: both UARTs.
//!
//! Not in the model, and so not shown here: caches, MPU faults, USB, the ADC, the time of anything within a few tens of percent.

use super::{Run, bad_frames, bytes_of, host, mavlink_ids, rig};
use linestereo_firmware::programs::expected::QVGA;
use linestereo_rig::CameraSide;
use linestereo_sim::board::{firmware, toolchain::Toolchain};
use linestereo_tests::board::or_skip;
use linestereo_wire::{MachineReport, Message, ParamUpdate, RegionBox, Regions, Request, ResetCause, Silicon};
use serde_json::{Value, json};

/// Runs an image for a still scene: without the feature such cameras' pairs are refused.
fn execute(program: &'static str, scenario: &Value) -> Option<Run> {
    let image = || {
        let board = linestereo_boards::Board::STM32H743;
        let toolchain = or_skip(Toolchain::for_board(&board))?;
        let features = ["still-scene".to_owned()];
        let built = firmware::build_all(&toolchain, &board, &["live", "selftest"], firmware::Logs::None, &features);
        or_skip(built)?.into_iter().find(|image| image.ends_with(program))
    };
    let mut scenario = scenario.clone();
    scenario["board"] = json!("stm32h743");
    Run::of("stm32h7.py", image, &scenario)
}

/// Ten seconds of a board: pairs, three bad frames, a photograph, a rig that is erased and written, objects by their boxes, an autopilot. Then
/// power is lost, and comes back.
#[test]
fn ten_seconds_of_a_board() {
    const FAULTS: [(CameraSide, u64, &str, usize); 3] =
        [(CameraSide::Left, 12, "short", 3), (CameraSide::Left, 23, "few", 2), (CameraSide::Right, 33, "overrun", 0)];
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
    let faults = bad_frames(&FAULTS);
    let scenario = json!({ "until_us": 10_000_000, "host": host(&requests), "faults": faults, "erase_us": 4e6 });
    let Some(run) = execute("live", &scenario) else { return };
    assert_eq!((run.damaged, &run.result["ending"]), (0, &Value::Null), "{}", run.result["at"]);

    let frames = run.frames_in_order();
    assert!(frames.len() > 60, "{}", frames.len());

    // Each bad frame by its name, and it costs that frame alone.
    run.assert_bad_frames(&frames, &FAULTS.map(|(eye, _, _, kind)| (eye, kind)), FAULTS.len(), 60_000);

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

    run.assert_photograph();

    // The rig was erased, written, and is used; nothing waited for longer than half of what the watchdog allows.
    run.assert_all_accepted();
    assert_eq!(run.result["erases"], 1);
    let unfed_us = run.result["longest_unfed_us"].as_f64().unwrap();
    assert!((4e6..0.5 * 9.5e6).contains(&unfed_us), "{unfed_us} us");
    let last = frames.last().unwrap();
    assert!(last.segments > 0, "{last:?}");

    // The autopilot got obstacles in whole messages.
    let messages = mavlink_ids(&bytes_of(&run.result["autopilot"]));
    assert!(messages.contains(&0) && messages.contains(&330), "{messages:?}");

    run.assert_uncached_dma();
    let used = run.result["handler_stack"].as_u64().unwrap();
    assert!((100..4096).contains(&used), "{used} bytes of the handlers' stack");
    run.assert_stack();
    run.assert_executed();

    // Power is lost and comes back: the rig is there.
    let again = json!({ "until_us": 1_000_000, "flash": run.result["flash"] });
    let again = execute("live", &again).unwrap();
    let hello = again.hellos().next().unwrap();
    assert_eq!(hello.rig.in_use.map(|rig| rig.rectified), Some([320, 240]));
    assert_eq!(hello.rig.slots[0], Ok(0));
}

/// A fault of the processor ends the program, and the next run names it.
#[test]
fn a_hard_fault_is_named_after_the_reset() {
    let scenario = json!({ "until_us": 600_000, "hard_fault_us": 300_000, "resets": 1 });
    let Some(run) = execute("live", &scenario) else { return };
    assert_eq!(run.reset_causes(), [Some(ResetCause::PowerOn), Some(ResetCause::Fault)]);
    assert_eq!(run.result["resets_us"].as_array().map(Vec::len), Some(1));
}

/// The clocks and caches of `live`, cycles by the core's counter, and the PC's digests.
#[test]
fn selftest_counts_cycles_and_has_the_digests_of_the_pc() {
    const CASES: [u16; 2] = [13, 16];
    let requests =
        [(100_000, Request::Describe), (200_000, Request::RunCase(CASES[0])), (210_000, Request::RunCase(CASES[1]))];
    let Some(run) = execute("selftest", &json!({ "until_us": 500_000, "host": host(&requests) })) else { return };
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
