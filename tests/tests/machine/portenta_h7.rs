//! A Portenta H7 behind Arduino's bootloader with two MT9V034 whose rows a joiner gives as one:
//! both UARTs, and USB at high speed.
//!
//! Not in the model, and so not shown here: the bootloader and what it leaves behind, the joiner,
//! the power controller, USB below its packets and its PHY but for power, reset and pins, caches,
//! the second core, the time of anything within a few tens of percent.

use super::{Run, bad_frames, host, rig_bytes};
use linestereo_boards::Board;
use linestereo_rig::CameraSide;
use linestereo_sim::board::is_long;
use linestereo_tests::board::image;
use linestereo_wire::{Request, ResetCause};
use serde_json::{Value, json};

fn execute(mut scenario: Value) -> Option<Run> {
    scenario["board"] = json!("portenta-h7");
    Run::of("stm32h7.py", || image(&Board::PORTENTA_H7, "live"), &scenario)
}

/// A row of the joiner is one of both images: each of these bad ones costs a pair. The others come
/// from one exposure, and are rectified in the end.
fn assert_pairs(run: &Run, faults: &[(CameraSide, u64, &str, usize)]) {
    run.assert_whole();
    let frames = run.frames_in_order();
    let bad = faults.iter().flat_map(|&(_, _, _, kind)| CameraSide::BOTH.map(|eye| (eye, kind)));
    run.assert_bad_frames(&frames, &bad.collect::<Vec<_>>(), faults.len(), 120_000);
    assert!(
        frames.iter().filter_map(|head| head.pair?.skew_us).all(|skew_us| skew_us == 0),
        "one exposure"
    );
    // The model's cameras show one scene, which health calls frozen: it is matched, and not told.
    assert!(frames.last().unwrap().counts.matched > 0, "{:?}", frames.last());
    run.assert_all_accepted();
    run.assert_uncached_dma();
    run.assert_stack();
}

/// Pairs, a row that is too short, rows that are missing, a photograph, a rig that is erased and
/// written, an autopilot. Then power is lost, and comes back.
#[test]
fn seconds_of_a_portenta() {
    const FAULTS: [(CameraSide, u64, &str, usize); 2] =
        [(CameraSide::Left, 5, "short", 3), (CameraSide::Left, 9, "few", 2)];
    if !is_long() {
        return; // LINESTEREO_LONG=1
    }
    let requests = [
        (100_000, Request::Start),
        (600_000, Request::Photograph), // 1.7 s of the UART
        (2_500_000, Request::SetRig(rig_bytes())),
    ];
    let scenario = json!({
        "until_us": 3_200_000,
        "host": host(&requests),
        "faults": bad_frames(&FAULTS),
        "erase_us": 2e5,
    });
    let Some(run) = execute(scenario) else { return };
    assert_pairs(&run, &FAULTS);
    assert_eq!(run.reset_causes(), [Some(ResetCause::PowerOn)]);
    assert!(run.frames().len() > 15, "{}", run.frames().len());
    run.assert_photograph();
    // The rig was erased, written, and is used.
    assert_eq!(run.result["erases"], 1);
    run.assert_autopilot();
    run.code().assert_executed(98_700); // 55 % of the code

    let again = execute(json!({ "until_us": 400_000, "flash": run.result["flash"] })).unwrap();
    again.assert_rig_is_used();
}

/// A rig that comes while a pair is on its way, and bad frames, by USB at high speed, which starts
/// when its PHY has power and is out of reset.
#[test]
fn pairs_of_a_portenta_by_usb() {
    const FAULTS: [(CameraSide, u64, &str, usize); 3] = [
        (CameraSide::Left, 3, "short", 3),
        (CameraSide::Left, 6, "few", 2),
        (CameraSide::Left, 9, "overrun", 0),
    ];
    if !is_long() {
        return; // LINESTEREO_LONG=1
    }
    let requests = [(60_000, Request::Start), (150_000, Request::SetRig(rig_bytes()))];
    let faults = bad_frames(&FAULTS);
    let scenario = json!({ "until_us": 1_400_000, "port": "usb", "host": host(&requests), "faults": faults, "erase_us": 1000 });
    let Some(run) = execute(scenario) else { return };
    assert_pairs(&run, &FAULTS);
    run.assert_usb("portenta-h7", "2E0031000E51303434363337", true);
}
