//! Sensors that do not answer as they should: named by their camera, and started again when they
//! do.

use super::super::{Run, host};
use super::execute;
use linestereo_wire::{CaptureReport, FrameHead, Health, Message, Request};
use serde_json::json;
use std::sync::LazyLock;

/// Faults of sensors at the bus: from, to, us, which one, and the fault's name in the model.
const WRONG: [(u64, u64, &str, &str); 9] = [
    (0, 500_000, "right", "absent"),
    (500_000, 660_000, "left", "other"), // another chip at its address
    (660_000, 820_000, "left", "hung"),  // the clock is held, and the bus stays busy
    (820_000, 1_000_000, "left", "mute"), // the clock is held when a byte is to be read
    (1_000_000, 1_320_000, "right", "forgets"), // registers do not keep what is written
    (1_320_000, STARTED_US, "right", "held"), // the clock is held after the last byte
    // Its clock line is held: the choice of exposure cannot be read.
    (HUNG_US, HUNG_US + 45_000, "left", "hung"),
    (BUS_US, BUS_US + 60_000, "right", "bus"), // errors while it is given another exposure
    (ARBITRATION_US, ARBITRATION_US + 120_000, "right", "arbitration"), // and for two pairs it cannot be started
];
const STARTED_US: u64 = 1_500_000;
const HUNG_US: u64 = 1_900_000;
const BUS_US: u64 = 2_050_000;
const ARBITRATION_US: u64 = 2_250_000;
const END_US: u64 = 2_620_000;

pub(super) static SENSORS: LazyLock<Option<Run>> = LazyLock::new(|| {
    // 0 rows is what a sensor says in the dark, and what nobody can fix.
    let exposures =
        [[1_450_000, 0], [1_800_000, 220], [BUS_US + 1000, 180], [ARBITRATION_US + 1000, 240]];
    let scenario = json!({
        "until_us": END_US, "host": host(&[(100_000, Request::Start)]), "i2c": WRONG, "exposures": exposures,
    });
    execute("live", &scenario)
});

/// As long as a sensor does not start there is no pair, and the report counts the one that failed.
/// When both are there pairs come. A choice of exposure that cannot be read costs no pair; when one
/// cannot be written both are started again, before the next pair if that is possible.
#[test]
fn sensors_that_fail_are_named_and_started_again() {
    let Some(run) = &*SENSORS else { return };
    run.assert_whole();
    let lost = |record: &Message| match record {
        Message::Capture(CaptureReport { sensors, faults, .. }) => Some((*sensors, *faults)),
        _ => None,
    };
    let reports: Vec<_> = run.all(lost).collect();
    let [([0, absent], _), ([other, before], _), .., ([left, right], faults)] = reports[..] else {
        panic!("{reports:?}")
    };
    assert!(absent > 0 && other > 0 && left == other + 1 && right > before + 2, "{reports:?}");
    // And while neither ran, both were silent.
    let stopped = CaptureReport::KINDS.iter().position(|&kind| kind == "stopped").unwrap();
    let others =
        faults.iter().flat_map(|of| of.iter().enumerate().filter(|&(kind, _)| kind != stopped));
    assert!(others.into_iter().all(|(_, &count)| count == 0), "{reports:?}");

    let frames = run.frames();
    let is_missing = |head: &&FrameHead| head.health.contains(Health::PAIR_MISSING);
    let between = |from_us: u64, to_us: u64| {
        frames.iter().copied().filter(move |head| (from_us..to_us).contains(&head.capture_time_us))
    };
    assert!(
        between(0, STARTED_US).count() > 5 && between(0, STARTED_US).all(|head| is_missing(&head))
    );
    let first = frames.iter().copied().find(|head| !is_missing(head)).unwrap();
    assert!(first.capture_time_us < HUNG_US - 100_000, "{first:?}");
    assert!(!between(first.capture_time_us, ARBITRATION_US).any(|head| is_missing(&head)));
    assert!(between(ARBITRATION_US, END_US).any(|head| is_missing(&head)));
    assert!(frames.last().is_some_and(|head| !is_missing(head)), "{:?}", frames.last());
}
