//! A Pico 2 with two HM01B0 on one trigger: the host on USB, an autopilot on a UART. The image is
//! the shipped one, and what it has written to the PIO's instruction memory is what takes the
//! pixels.
//!
//! Not in the model, and so not shown here: levels and edges of wires, timing of the flash and its
//! cache, power, the second core, USB below its packets, what HM01B0 do that nobody has written
//! down; the time of anything within a few tens of percent.

use super::{Run, bad_frames, bytes_of, host, mavlink_ids, rig_bytes};
use linestereo_rig::CameraSide;
use linestereo_tests::board::image;
use linestereo_wire::{Health, Request, ResetCause};
use serde_json::{Value, json};

fn execute(scenario: &Value) -> Option<Run> {
    let image = || image(&linestereo_boards::Board::PICO2, "live");
    let run = Run::of("rp2350.py", image, scenario)?;
    // Nothing that the model lacks, and nothing that USB forbids.
    run.assert_whole();
    assert_eq!(run.result["usb"]["faults"], json!([]));
    Some(run)
}

/// Pairs, a row that is too short, a row that is missing, a VSYNC that is stuck, a photograph, a
/// rig that is erased and written, an autopilot. Then power is lost, and comes back.
#[test]
fn seconds_of_a_pico_2() {
    // Number of each in `CaptureReport::KINDS`.
    const FAULTS: [(CameraSide, u64, &str, usize); 3] = [
        (CameraSide::Left, 3, "short", 3),
        (CameraSide::Right, 6, "few", 2),
        (CameraSide::Left, 9, "stuck", 1),
    ];
    let requests = [
        (150_000, Request::Describe),
        (160_000, Request::Start),
        (2_000_000, Request::Photograph),
        (2_700_000, Request::SetRig(rig_bytes())),
    ];
    let faults = bad_frames(&FAULTS);
    let scenario = json!({ "until_us": 5_000_000, "host": host(&requests), "faults": faults });
    let Some(run) = execute(&scenario) else { return };

    // Clocks, by the registers that were written.
    assert_eq!((&run.result["sys_mhz"], &run.result["mclk_mhz"]), (&json!(150.0), &json!(6.0)));
    let baud = run.result["autopilot_baud"].as_f64().unwrap();
    assert!((baud - 57_600.0).abs() < 100.0, "{baud}");
    // Its serial number is the first four rows of the one-time memory, two a word.
    run.assert_usb("pico2", "0000123800001234", false);
    assert_eq!(run.reset_causes(), [Some(ResetCause::PowerOn)]);

    // Each bad frame by its name, and it costs that frame alone.
    let frames = run.frames_in_order();
    assert!(frames.len() > 24, "{}", frames.len());
    run.assert_bad_frames(
        &frames,
        &FAULTS.map(|(eye, _, _, kind)| (eye, kind)),
        FAULTS.len(),
        u64::MAX,
    );
    assert!(
        frames.iter().filter_map(|head| head.pair?.skew_us).all(|skew_us| skew_us < 50),
        "one trigger"
    );
    run.assert_photograph();

    // The rig was erased, written, and is used: pairs are rectified as their rows come.
    run.assert_all_accepted();
    assert_eq!(run.result["erases"], 1);
    let rectified = frames.iter().filter(|head| head.capture_time_us > 3_200_000);
    // Raw rows match some 13 segments, since they are not those of one point; edges of this dense
    // pattern have a budget. The scene stands still, which a camera's noise does not: such pairs
    // answer nothing.
    assert!(
        rectified.clone().count() > 8 && rectified.clone().all(|head| head.counts.matched > 65),
        "{frames:?}"
    );
    let messages = mavlink_ids(&bytes_of(&run.result["autopilot"]));
    assert!(messages.contains(&0) && messages.contains(&330), "{messages:?}");

    // Memory: of the program's stack a quarter is left, and the DMA writes behind the stacks.
    run.assert_stack();
    let used = run.result["handler_stack"].as_u64().unwrap();
    assert!((100..6144).contains(&used), "{used} bytes of the handlers' stack");
    let (stacks, dma) = (run.result["stack"][1].as_u64().unwrap() + 6144, &run.result["dma"]);
    assert!(
        dma[0].as_u64().unwrap() >= 0x2000_0000 + stacks && dma[1].as_u64().unwrap() <= 0x2008_0000,
        "{dma}"
    );
    let unfed_us = run.result["longest_unfed_us"].as_f64().unwrap();
    assert!(unfed_us < 0.5 * 8e6, "{unfed_us} us");
    run.code().assert_executed(100_000); // 108 878 when this was written

    // Power is lost and comes back: the rig is there.
    let commands = host(&[(100_000, Request::Describe)]);
    let again =
        execute(&json!({ "until_us": 1_500_000, "flash": run.result["flash"], "host": commands }))
            .unwrap();
    let hello = again.hellos().next().unwrap();
    assert_eq!(hello.rig.in_use.map(|rig| rig.rectified), Some([320, 240]));
    assert_eq!(hello.rig.slots[0], Ok(0));
}

/// A fault of the processor ends the program, and the next run names it; cameras that send nothing
/// any more let the watchdog reset the board.
#[test]
fn a_fault_and_the_watchdog_are_named_after_the_reset() {
    let requests = [
        (150_000, Request::Describe),
        (600_000, Request::Describe),
        (650_000, Request::Start),
        (9_600_000, Request::Describe),
    ];
    let scenario = json!({
        "until_us": 9_700_000, "host": host(&requests), "hard_fault_us": 300_000, "dead_us": 1_000_000, "resets": 2,
    });
    let Some(run) = execute(&scenario) else { return };
    let causes = [ResetCause::PowerOn, ResetCause::Fault, ResetCause::Watchdog].map(Some);
    assert_eq!(run.reset_causes(), causes);
    // The watchdog bites 8 s after the last pair.
    let last =
        run.frames().into_iter().rfind(|head| !head.health.contains(Health::PAIR_MISSING)).unwrap();
    let bitten_us =
        run.result["resets_us"][1].as_u64().unwrap() - run.result["resets_us"][0].as_u64().unwrap();
    assert!(
        (8_000_000..8_400_000).contains(&(bitten_us - last.capture_time_us)),
        "{bitten_us} us after {last:?}"
    );
}
