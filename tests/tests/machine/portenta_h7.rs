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
use linestereo_tests::board::{image, image_with};
use linestereo_wire::{Request, ResetCause};
use serde_json::{Value, json};
use std::path::PathBuf;

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
    assert!(frames.last().unwrap().segments > 0, "{:?}", frames.last());
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

/// Medians of the last pairs, us: from an exposure to the next one, and to the last byte of the
/// result at the host.
fn pace(run: &Run) -> [u64; 2] {
    let frames = run.frames_in_order_but(&[]);
    let median = |mut times: Vec<u64>| {
        times.sort_unstable();
        times[times.len() / 2]
    };
    let last = &frames[frames.len() - 11..];
    let periods = last.windows(2).map(|pair| pair[1].1.capture_time_us - pair[0].1.capture_time_us);
    [
        median(periods.collect()),
        median(last.iter().map(|(came_us, head)| came_us - head.capture_time_us).collect()),
    ]
}

/// As it is built by default, and captured ahead: a rig that comes while a pair is on its way, bad
/// frames, more pairs that are no older. By USB at high speed, which starts when its PHY has power
/// and is out of reset: a UART takes 43 ms for a result, longer than a pair.
#[test]
fn ahead_gives_more_pairs_that_are_no_older() {
    const FAULTS: [(CameraSide, u64, &str, usize); 3] = [
        (CameraSide::Left, 3, "short", 3),
        (CameraSide::Left, 6, "few", 2),
        (CameraSide::Left, 9, "overrun", 0),
    ];
    if !is_long() {
        return; // LINESTEREO_LONG=1
    }
    let scenario = || {
        let requests = [(60_000, Request::Start), (150_000, Request::SetRig(rig_bytes()))];
        let faults = bad_frames(&FAULTS);
        json!({ "board": "portenta-h7", "until_us": 1_400_000, "port": "usb", "host": host(&requests), "faults": faults, "erase_us": 1000 })
    };
    let run = |image: fn() -> Option<PathBuf>| {
        let run = Run::of("stm32h7.py", image, &scenario())?;
        assert_pairs(&run, &FAULTS);
        run.assert_usb("portenta-h7", "2E0031000E51303434363337", true);
        Some(pace(&run))
    };
    let paces = std::thread::scope(|scope| {
        let turns = scope.spawn(|| run(|| image(&Board::PORTENTA_H7, "live")));
        [run(|| image_with(&Board::PORTENTA_H7, "live", &["ahead"])), turns.join().unwrap()]
    });
    let [Some(ahead), Some(turns)] = paces else { return };
    println!("us from pair to pair, us to the host: {turns:?}, ahead {ahead:?}");
    assert!(
        ahead[0] * 10 < turns[0] * 9 && ahead[1] * 20 < turns[1] * 21,
        "{turns:?}, ahead {ahead:?}"
    );
}
