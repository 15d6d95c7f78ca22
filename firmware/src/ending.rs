//! How a program ends, and its last report.
//!
//! ```text
//! emulated   text to the PC's error output; the exit code of the simulator
//! hardware   text nowhere; after a panic or a fault a note in memory that survives the reset that
//!            follows, so that the next run can tell the host; a program that has ended otherwise
//!            sleeps
//! ```

use linestereo_boards::Exit;

/// Says a number in hexadecimal behind its name.
pub(crate) fn report_number(name: &str, number: u32) {
    report(name);
    report_hex(number);
}

#[cfg(feature = "emulated")]
mod by_semihosting {
    use super::Exit;
    use crate::semihosting;

    pub(crate) use semihosting::{report, report_decimal, report_hex};

    /// True: whatever ends is reported.
    pub(crate) fn begin(_exit: Exit, _location: u32) -> bool {
        true
    }

    /// Ends the program; the location where it could not go on has been reported.
    pub(crate) fn end(exit: Exit, _location: u32) -> ! {
        semihosting::exit(exit as u32)
    }
}
#[cfg(feature = "emulated")]
pub(crate) use by_semihosting::{begin, end, report, report_decimal, report_hex};

#[cfg(feature = "hardware")]
mod by_reset {
    use super::Exit;
    use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};
    use linestereo_wire::{Reset, ResetCause};

    /// The note in four words: its mark, the exit code, its complement, the location
    /// ([`Reset::location`]). Memory holds anything when power comes: the first word and the
    /// complement say that it was written.
    // SAFETY: the section is not initialised, and every pattern of bits is a number.
    #[unsafe(link_section = ".uninit.note")]
    static NOTE: [AtomicU32; 4] = [const { AtomicU32::new(0) }; 4];
    const WRITTEN: u32 = 0x6c69_6e65;

    /// To the debugger, in builds with logs.
    pub(crate) fn report(text: &str) {
        crate::error!("{=str}", text);
    }

    pub(crate) fn report_hex(number: u32) {
        crate::error!("{=u32:#010x}", number);
    }

    pub(crate) fn report_decimal(number: u32) {
        crate::error!("{=u32}", number);
    }

    /// A note is written, for the reset to come.
    static HAS_BEGUN: AtomicBool = AtomicBool::new(false);

    /// Notes a panic or a fault at this location. False after the first one: a report of that one
    /// has failed, and another would fail, too.
    pub(crate) fn begin(exit: Exit, location: u32) -> bool {
        let is_first = !HAS_BEGUN.swap(true, Ordering::Relaxed);
        if is_first {
            let words = [WRITTEN, exit as u32, !(exit as u32), location];
            for (note, word) in NOTE.iter().zip(words) {
                note.store(word, Ordering::Relaxed);
            }
        }
        is_first
    }

    /// Ends the program; after a panic or a fault by a reset.
    pub(crate) fn end(exit: Exit, location: u32) -> ! {
        if matches!(exit, Exit::Panic | Exit::Fault | Exit::StackOverflow) {
            begin(exit, location);
            cortex_m::asm::dsb(); // the note is in memory before the reset
            reset()
        }
        loop {
            cortex_m::asm::wfi();
        }
    }

    #[cfg(not(feature = "rp235x"))]
    #[inline(always)] // smaller
    fn reset() -> ! {
        cortex_m::peripheral::SCB::sys_reset()
    }

    /// Resets both cores, by the watchdog: SYSRESETREQ resets the one that asks.
    #[cfg(feature = "rp235x")]
    fn reset() -> ! {
        use embassy_rp::pac::{PSM, WATCHDOG};
        PSM.wdsel().write_value(super::RESET_BY_WATCHDOG);
        WATCHDOG.ctrl().modify(|w| w.set_trigger(true));
        loop {
            cortex_m::asm::nop();
        }
    }

    /// Note of the last run before its end, once.
    pub fn last_note() -> Option<Reset> {
        let [written, exit, complement, location] =
            NOTE.each_ref().map(|word| word.load(Ordering::Relaxed));
        NOTE[0].store(0, Ordering::Relaxed);
        let cause = match Exit::ALL.into_iter().find(|&known| known as u32 == exit)? {
            Exit::Panic => ResetCause::Panic,
            Exit::Fault => ResetCause::Fault,
            Exit::StackOverflow => ResetCause::StackOverflow,
            _ => return None,
        };
        (written == WRITTEN && complement == !exit).then_some(Reset { cause, location })
    }
}
/// Everything but the oscillators: reset by the watchdog of an RP2350 (RP2350 datasheet, 7.4).
#[cfg(all(target_os = "none", feature = "rp235x"))]
pub(crate) const RESET_BY_WATCHDOG: embassy_rp::pac::psm::regs::Wdsel =
    embassy_rp::pac::psm::regs::Wdsel(0x01ff_fff3);

#[cfg(feature = "hardware")]
pub use by_reset::last_note;
#[cfg(feature = "hardware")]
pub(crate) use by_reset::{begin, end, report, report_decimal, report_hex};
