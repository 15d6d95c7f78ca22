//! Why the chip was reset, and what resets it when no frame is finished.
//!
//! # Source
//! RM0433, section 8.7.39 (RCC_RSR; RM0399 has the same flags for the Cortex-M7), section 48
//! (IWDG).

use crate::ending;
use crate::ports::Watchdog;
use embassy_stm32::pac::{DBGMCU, RCC};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Peri, peripherals};
use linestereo_wire::{Reset, ResetCause};

/// Twice the longest time without a finished frame: a sector takes up to 4 s to be erased (DS12110,
/// table "Flash memory programming"), making ready for its rig half a second; the watchdog's
/// oscillator may be 5 % fast.
const WATCHDOG_US: u32 = 10_000_000;

/// Cause of the reset by the flags and the note of the last run, once. Power on sets the
/// brown-out's and the pin's flags as well, and every reset the pin's.
pub fn cause() -> Option<Reset> {
    let flags = RCC.rsr().read();
    RCC.rsr().modify(|flags| flags.set_rmvf(true));
    let note = ending::last_note();
    let cause = if flags.porrstf() {
        ResetCause::PowerOn
    } else if flags.borrstf() {
        ResetCause::BrownOut
    } else if flags.iwdg1rstf() || flags.wwdg1rstf() {
        ResetCause::Watchdog
    } else if flags.sftrstf() {
        return note.or(Some(Reset::of(ResetCause::Software)));
    } else if flags.pinrstf() {
        ResetCause::Pin
    } else {
        ResetCause::Unknown // a bootloader has cleared them, perhaps
    };
    Some(match cause {
        ResetCause::Unknown => note.unwrap_or(Reset::of(cause)),
        _ => Reset::of(cause),
    })
}

/// The independent watchdog. It has an oscillator of its own, and nothing but a reset or a debugger
/// stops it.
#[expect(missing_debug_implementations, reason = "the HAL's driver has none")]
pub struct IndependentDog(IndependentWatchdog<'static, peripherals::IWDG1>);

impl IndependentDog {
    /// Resets the chip when it is not fed for 10 s.
    pub fn start(peripheral: Peri<'static, peripherals::IWDG1>) -> Self {
        DBGMCU.apb4fzr1().modify(|frozen| frozen.set_iwdg1(true)); // while a debugger has stopped the processor
        let mut dog = IndependentWatchdog::new(peripheral, WATCHDOG_US);
        dog.unleash();
        Self(dog)
    }
}

impl Watchdog for IndependentDog {
    fn feed(&mut self) {
        self.0.pet();
    }
}
