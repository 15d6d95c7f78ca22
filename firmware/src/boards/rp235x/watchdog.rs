//! The watchdog, and why the board was reset.
//!
//! # Source
//! RP2350 datasheet: 12.9 (watchdog), 6.4 (POWMAN: CHIP_RESET), 7.1 (resets), 7.4 (PSM: WDSEL).

use crate::ending;
use crate::ports::Watchdog;
use embassy_rp::Peri;
use embassy_rp::pac::{POWMAN, PSM, WATCHDOG};
use embassy_rp::peripherals;
use embassy_rp::watchdog;
use embassy_time::Duration;
use linestereo_wire::{Reset, ResetCause};

/// Reset after so long without a finished frame: the longest thing that may lie between two is
/// making ready for a rig, 115 million instructions.
const PATIENCE: Duration = Duration::from_secs(8);

/// In a scratch register, which survives what the watchdog does: it was this program that had
/// started it. The boot ROM restarts the chip by the watchdog as well, after it was loaded by USB
/// for example.
const OURS: u32 = 0x6c69_6e65;

/// Resets the board when no frame is finished for 8 s.
#[expect(missing_debug_implementations, reason = "the HAL's driver has none")]
pub struct FrameWatchdog(watchdog::Watchdog);

impl FrameWatchdog {
    /// Runs from now on; it waits while a debugger has stopped the processor.
    pub fn start(peripheral: Peri<'static, peripherals::WATCHDOG>) -> Self {
        let mut watchdog = watchdog::Watchdog::new(peripheral);
        watchdog.pause_on_debug(true);
        WATCHDOG.scratch0().write_value(OURS);
        watchdog.start(PATIENCE);
        // The HAL selects what to reset by the RP2040's layout, without processors, XIP and half of
        // the SRAM.
        PSM.wdsel().write_value(ending::RESET_BY_WATCHDOG);
        Self(watchdog)
    }
}

impl Watchdog for FrameWatchdog {
    fn feed(&mut self) {
        self.0.feed(PATIENCE);
    }
}

/// Why the board was reset. Before the watchdog is started: starting it forgets.
pub fn reset_cause() -> Reset {
    let words = ending::last_note();
    let (last, reason) = (POWMAN.chip_reset().read(), WATCHDOG.reason().read());
    let is_ours = WATCHDOG.scratch0().read() == OURS;
    WATCHDOG.scratch0().write_value(0);
    // The watchdog's own reason is cleared by every other reset, on the RP2350 by SYSRESETREQ as
    // well. A panic or a fault resets by the watchdog too, and leaves a note.
    words.unwrap_or(Reset::of(if reason.timer() && is_ours {
        ResetCause::Watchdog
    } else if reason.timer() || reason.force() {
        ResetCause::Software
    } else if last.had_por() {
        ResetCause::PowerOn
    } else if last.had_bor() || last.had_glitch_detect() {
        ResetCause::BrownOut
    } else if last.had_run_low() || last.had_dp_reset_req() || last.had_rescue() {
        ResetCause::Pin
    } else {
        ResetCause::Unknown
    }))
}
