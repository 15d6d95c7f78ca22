//! State after a reset: slots of the flash that are damaged, a bank that fails, the cause.

use super::super::{Run, hex, host, rig, rig_bytes};
use super::execute;
use linestereo_firmware::settings::{KeptSettings, built};
use linestereo_wire::{Message, Outcome, Refusal, Regions, Request, ResetCause, RigFault, Setting};
use serde_json::json;
use std::sync::LazyLock;

pub(super) const SECTOR: usize = 128 * 1024;

/// Four sectors: two of the settings, two of the rig. A setting out of its range; none; a rig of
/// which a byte is not what was written; one whose first word was being written when power failed.
fn damaged_flash() -> Vec<u8> {
    let mut flash = vec![0xff; 4 * SECTOR];
    let mut values = built().map(Some);
    values[Setting::VEHICLE] = Some(1e6);
    KeptSettings { rig: None, values, regions: Regions::default() }
        .put(3, &mut flash[..KeptSettings::BYTES]);
    let rig = rig().encode(8);
    flash[2 * SECTOR..][..rig.len()].copy_from_slice(&rig);
    flash[2 * SECTOR + 100] ^= 1;
    flash[3 * SECTOR..][..rig.len()].copy_from_slice(&rig);
    flash
}

pub(super) static DAMAGED: LazyLock<Option<Run>> = LazyLock::new(|| {
    let fails = [[140_000, 400_000]];
    let requests = [
        (100_000, Request::Settings),
        (150_000, Request::SetRig(rig_bytes())),
        (300_000, Request::KeepSettings),
        (420_000, Request::SetRig(rig_bytes())),
        (600_000, Request::KeepSettings),
        (700_000, Request::Settings),
        (705_000, Request::Describe),
    ];
    let scenario = json!({
        "until_us": 820_000, "host": host(&requests), "flash": hex(&damaged_flash()), "broken": [3 * SECTOR], "flash_errors": fails,
        "erase_us": 1000,
    });
    execute("live", &scenario)
});

/// Each slot says what is wrong with it, and nothing of it is used. A flash that fails refuses what
/// is to be kept; when it works again it keeps it.
#[test]
fn damaged_slots_and_a_flash_that_fails_are_named() {
    let Some(run) = &*DAMAGED else { return };
    run.assert_whole();
    let hellos: Vec<_> = run.hellos().collect();
    let [first, .., last] = &hellos[..] else { panic!("{hellos:?}") };
    assert_eq!(
        (first.rig.in_use, first.rig.slots),
        (None, [Err(RigFault::Damaged), Err(RigFault::Unreadable)])
    );
    let not_kept = || Outcome::Refused(Refusal::NotKept);
    let outcomes: Vec<_> = run.answers().map(|answer| answer.outcome.clone()).collect();
    let done = || Outcome::Accepted;
    assert_eq!(outcomes, [done(), not_kept(), not_kept(), done(), done(), done(), done()]);
    let kept = run.all(|record| if let Message::Kept(kept) = record { Some(kept) } else { None });
    let kept: Vec<_> = kept.map(|kept| (kept.is_kept, kept.slots)).collect();
    assert_eq!(
        kept,
        [(false, [Err(RigFault::OutOfRange), Err(RigFault::Empty)]), (true, [Ok(3), Ok(4)])]
    );
    assert_eq!(last.rig.in_use.and_then(|rig| rig.slot), Some(0));
    assert_eq!(last.rig.slots, [Ok(0), Err(RigFault::Unreadable)]);
}

const PIN: u32 = 1 << 22;
/// Flags of RCC_RSR (RM0433: 8.7.39), of which every reset sets that of its pin, and the cause that
/// a host is told.
const CAUSES: [(u32, ResetCause); 7] = [
    (0x00ee_0000, ResetCause::PowerOn),
    (PIN | 1 << 21, ResetCause::BrownOut),
    (PIN, ResetCause::Pin),
    (PIN | 1 << 26, ResetCause::Watchdog),
    (PIN | 1 << 28, ResetCause::Watchdog),
    (PIN | 1 << 24, ResetCause::Software),
    (0, ResetCause::Unknown),
];
/// From one reset to the next.
const RESET_US: usize = 150_000;
/// One reset behind the other from outside, then a fault of the processor and a stack that
/// overflows.
pub(super) static RESETS: LazyLock<Option<Run>> = LazyLock::new(|| {
    let at = |reset: usize| RESET_US * reset;
    let outside: Vec<_> = (1..CAUSES.len()).map(at).collect();
    let fault_us = at(CAUSES.len());
    let scenario = json!({
        "until_us": fault_us + 500_000, "reset_flags": CAUSES.map(|(flags, _)| flags), "resets_us": outside,
        "hard_fault_us": fault_us, "overflow_us": fault_us + 250_000, "resets": CAUSES.len() + 1,
    });
    execute("live", &scenario)
});

#[test]
fn each_cause_of_a_reset_is_told() {
    let Some(run) = &*RESETS else { return };
    run.assert_whole();
    let causes = CAUSES
        .iter()
        .map(|&(_, cause)| cause)
        .chain([ResetCause::Fault, ResetCause::StackOverflow]);
    assert_eq!(run.reset_causes(), causes.map(Some).collect::<Vec<_>>());
}
