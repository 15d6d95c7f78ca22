//! Unusual acts of a host on USB: requests of all kinds, results that it does not read.

use super::super::{Run, frames_of, host};
use super::execute;
use linestereo_wire::{FrameHead, Health, RegionBox, Regions, Request};
use serde_json::{Value, json};
use std::sync::LazyLock;

const PAUSED_US: u64 = 500_000;
const RESUMED_US: u64 = 1_250_000;
/// Objects whose depths are asked for.
const BOXES: usize = 12;

pub(super) static ASKED: LazyLock<Option<Run>> = LazyLock::new(|| {
    let person = RegionBox { label: 1, left: 40, top: 30, right: 120, bottom: 200 };
    let boxes = (0..BOXES as u16).map(|n| RegionBox {
        label: n,
        left: 40 + 10 * n,
        right: 120 + 10 * n,
        ..person
    });
    let regions = Regions { boxes: boxes.collect(), only: false };
    let requests = [
        (340_000, Request::SetRegions(regions)),
        (350_000, Request::Start),
        (RESUMED_US + 100_000, Request::Describe),
    ];
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

/// Requests as `usb_host.py` names them, and the answers in hexadecimal; none where the device has
/// to refuse.
const ANSWERS: [(&str, Option<&str>); 43] = [
    ("status", Some("0000")),
    ("wake", Some("")),
    ("woken status", Some("0200")),
    ("no wake", Some("")),
    ("configuration", Some("01")),
    ("interface", Some("00")),
    ("no such setting", None),
    ("interface status", Some("0000")),
    ("no such interface", None),
    ("setting", Some("")),
    ("no such setting of none", None),
    ("capabilities", Some("050f0c000107100200000000")),
    ("no such feature", None),
    ("no such feature of an interface", None),
    ("no such feature of an endpoint", None),
    ("no such request", None),
    ("no such request of an endpoint", None),
    ("halt results", Some("")),
    ("halted results", Some("0100")),
    ("results go on", Some("")),
    ("halt commands", Some("")),
    ("halted commands", Some("0100")),
    ("commands go on", Some("")),
    ("no configuration", Some("")),
    ("none", Some("00")),
    ("configuration again", Some("")),
    ("again", Some("01")),
    ("encapsulated", Some("")),
    ("short coding", None),
    ("coding of results", None),
    ("languages", Some("04030904")),
    ("no such text", None),
    ("no such descriptor", None),
    ("endpoint", Some("0000")),
    ("halt", Some("")),
    ("halted", Some("0100")),
    ("go on", Some("")),
    ("gone on", Some("0000")),
    ("set coding", Some("")),
    ("coding", Some("00e10000000008")),
    ("unknown in", None),
    ("unknown out", None),
    ("too long", None),
];

/// Requests that no enumeration makes: answered as USB 2.0 and CDC say, stalled where there is
/// nothing to answer. The port works afterwards, and after the bus was suspended.
///
/// They come before any data: with a new configuration or setting, or at the end of a halt,
/// embassy-usb-synopsys-otg 0.3.3 does not begin with DATA0 again, and after an odd number of
/// packets the next one would be lost (mended after that release: embassy-rs/embassy #6687).
#[test]
fn other_requests_are_answered_or_stalled() {
    let Some(run) = &*ASKED else { return };
    run.assert_whole();
    run.assert_usb("stm32h743", "2E0031000E51303434363337", false);
    let answers = ANSWERS.iter().map(|&(request, answer)| (request.to_owned(), json!(answer)));
    assert_eq!(run.result["answers"], Value::Object(answers.collect()));
    run.assert_all_accepted();
    assert_eq!(run.answers().count(), 3);
}

/// A host that does not read for a while: the board goes on, and the frame after it says that some
/// are missing.
#[test]
fn what_a_host_does_not_read_is_told() {
    let Some(run) = &*ASKED else { return };
    let heads: Vec<&FrameHead> = run.frames_in_order();
    let told: Vec<_> =
        heads.iter().filter(|head| head.health.contains(Health::RESULTS_SKIPPED)).collect();
    assert!(told.len() == 1 && told[0].capture_time_us > RESUMED_US - 100_000, "{told:?}");
    assert!(heads.last().unwrap().capture_time_us > RESUMED_US + 50_000, "{heads:?}");
    // Each came as a whole; of the last one the run may have seen a part.
    let frames = frames_of(run);
    for frame in &frames[..frames.len() - 1] {
        assert_eq!(frame.segments.len(), usize::from(frame.head.segments), "{:?}", frame.head);
        assert_eq!(frame.objects.len(), BOXES, "{:?}", frame.head);
    }
}
