//! Peripherals that QEMU's mps2 machines have in common: APB timer 0 of Arm's CMSDK as the clock.

use crate::ports::Clock;

/// CMSDK APB timer 0 (Arm DDI 0479D, section 4.1.2): CTRL, VALUE and RELOAD, 25 MHz, counts down.
const TIMER0: *mut u32 = 0x4000_0000 as *mut u32;
const VALUE: usize = 1;
const RELOAD: usize = 2;

/// Counts instructions: with `-icount shift=6` QEMU lets 64 ns pass per instruction, and a tick of the timer is 40 ns.
///
/// On a real board it would count time; QEMU knows no cycles.
#[derive(Debug)]
pub struct InstructionClock(());

impl InstructionClock {
    /// Starts the timer.
    #[must_use]
    pub fn start() -> Self {
        // SAFETY: the registers of a timer that nothing else uses; the address is the same on every mps2 machine.
        unsafe {
            TIMER0.add(RELOAD).write_volatile(u32::MAX);
            TIMER0.add(VALUE).write_volatile(u32::MAX);
            TIMER0.write_volatile(1);
        }
        Self(())
    }
}

impl Clock for InstructionClock {
    const UNIT: &'static str = "instructions";

    #[inline]
    fn now(&self) -> u32 {
        // SAFETY: reading the timer changes nothing.
        !unsafe { TIMER0.add(VALUE).read_volatile() }
    }

    fn elapsed(&self, from: u32, to: u32) -> u64 {
        u64::from(to.wrapping_sub(from)) * 40 / 64
    }
}
