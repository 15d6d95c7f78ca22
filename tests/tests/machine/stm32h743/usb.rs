//! Unusual acts of a host on USB: requests of all kinds, results that it does not read.

use super::super::{Run, host};
use super::{execute, frames};
use linestereo_wire::{FrameHead, Health, Request};
use serde_json::json;
use std::sync::LazyLock;

const PAUSED_US: u64 = 500_000;
const RESUMED_US: u64 = 1_250_000;

pub(super) static ASKED: LazyLock<Option<Run>> = LazyLock::new(|| {
    let requests = [(350_000, Request::Start), (RESUMED_US + 100_000, Request::Describe)];
    let mut host = host(&requests).as_array().unwrap().clone();
    host.extend([
        json!([150_000, "ask"]),
        json!([300_000, "suspend"]),
        json!([330_000, "wake"]),
        json!([PAUSED_US, "pause"]),
        json!([RESUMED_US, "resume"]),
    ]);
    host.sort_by_key(|at| at[0].as_u64());
    execute("live", &json!({ "until_us": RESUMED_US + 200_000, "port": "usb", "host": host }))
});

/// Requests that no enumeration makes: answered as USB 2.0 and CDC say, stalled where there is nothing to answer. The port works afterwards, and
/// after the bus was suspended.
#[test]
fn other_requests_are_answered_or_stalled() {
    let Some(run) = &*ASKED else { return };
    run.assert_whole();
    run.assert_usb("stm32h743", "2E0031000E51303434363337", false);
    let expected = json!({
        "status": "0000", "wake": "", "woken status": "0200", "no wake": "", "configuration": "01", "interface": "00", "no such setting": null,
        "languages": "04030904", "no such text": null, "no such descriptor": null,
        "endpoint": "0000", "halt": "", "halted": "0100", "go on": "", "gone on": "0000",
        "set coding": "", "coding": "00e10000000008", "unknown in": null, "unknown out": null, "too long": null,
    });
    assert_eq!(run.result["answers"], expected);
    run.assert_all_accepted();
    assert_eq!(run.answers().count(), 2);
}

/// A host that does not read for a while: the board goes on, and the frame after it says that some are missing.
#[test]
fn what_a_host_does_not_read_is_told() {
    let Some(run) = &*ASKED else { return };
    let heads: Vec<&FrameHead> = run.frames_in_order();
    let told: Vec<_> = heads.iter().filter(|head| head.health.contains(Health::RESULTS_SKIPPED)).collect();
    assert!(told.len() == 1 && told[0].capture_time_us > RESUMED_US - 100_000, "{told:?}");
    assert!(heads.last().unwrap().capture_time_us > RESUMED_US + 50_000, "{heads:?}");
    // Each came as a whole; of the last one the run may have seen a part.
    let frames = frames(run);
    for frame in &frames[..frames.len() - 1] {
        assert_eq!(frame.segments.len(), usize::from(frame.head.segments), "{:?}", frame.head);
    }
}
