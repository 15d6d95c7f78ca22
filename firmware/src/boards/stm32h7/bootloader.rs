//! From the program to a boot loader that takes another one over USB.
//!
//! ```text
//! STM32H743   a word in memory that a reset leaves alone, reset; at the start, before clocks are
//!             set: the chip's own, in system memory
//! Portenta    a word in a backup register, reset: Arduino's, which starts first and knows it; the
//!             chip's own has no USB on this board
//! ```
//! Not yet run on hardware. ST's forum knows boot loaders of version 0x91 (chips of revision V)
//! that run when jumped to and then fail to erase: there BOOT0 has to be high at a reset.
//!
//! # Source
//! AN2606, "STM32H74xxx/75xxx devices", and ST's "Jump to bootloader from application on STM32H7
//! devices": 0x1FF0_9800. ArduinoCore-mbed, `variants/PORTENTA_H7_M7/portenta_bootloader.cpp`:
//! RTC_BKP_DR0, 0xDF59.

use embassy_time::{Duration, block_for};

/// Time in which bytes that wait for the host are sent.
const FAREWELL: Duration = Duration::from_millis(200);

/// Ends the program.
pub fn enter() -> ! {
    block_for(FAREWELL);
    leave_word();
    cortex_m::asm::dsb();
    cortex_m::peripheral::SCB::sys_reset()
}

#[cfg(feature = "portenta-h7")]
fn leave_word() {
    use embassy_stm32::pac::{PWR, RCC, RTC};
    RCC.apb4enr().modify(|enable| enable.set_rtcapben(true));
    PWR.cr1().modify(|control| control.set_dbp(true)); // backup registers can be written
    RTC.bkpr(0).write(|word| word.set_bkp(0xdf59));
    let _ = RTC.bkpr(0).read(); // written before the reset
}

/// On a Portenta Arduino's boot loader has looked before.
#[cfg(feature = "portenta-h7")]
pub fn follow_word() {}

#[cfg(feature = "stm32h743")]
pub use word::follow as follow_word;
#[cfg(feature = "stm32h743")]
use word::leave as leave_word;

#[cfg(feature = "stm32h743")]
mod word {
    use core::sync::atomic::{AtomicU32, Ordering};

    /// The word and its complement: memory holds anything when power comes.
    // SAFETY: the section is not initialised, and every pattern of bits is a number.
    #[unsafe(link_section = ".uninit.note")]
    static WORD: [AtomicU32; 2] = [const { AtomicU32::new(0) }; 2];
    const BOOT: u32 = 0x626f_6f74;
    /// Vectors of the chip's boot loader.
    const SYSTEM_MEMORY: *const u32 = core::ptr::with_exposed_provenance(0x1ff0_9800);

    pub(super) fn leave() {
        for (slot, word) in WORD.iter().zip([BOOT, !BOOT]) {
            slot.store(word, Ordering::Relaxed);
        }
    }

    /// Goes on in the chip's boot loader if the last run wanted that, once. To be called before
    /// anything else: it expects the chip as after a reset.
    pub fn follow() {
        let found = WORD.each_ref().map(|word| word.swap(0, Ordering::Relaxed));
        if found != [BOOT, !BOOT] {
            return;
        }
        // SAFETY: nothing of this program runs on: no interrupt is enabled yet, and the stack that
        // it used is not used any more. Memory protection, the one thing that has changed since the
        // reset, is off before.
        unsafe {
            (*cortex_m::peripheral::MPU::PTR).ctrl.write(0);
            cortex_m::asm::dsb();
            cortex_m::asm::isb();
            cortex_m::asm::bootload(SYSTEM_MEMORY)
        }
    }
}
