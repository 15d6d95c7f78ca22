//! Cycles of the core by its own counter, DWT_CYCCNT, and which core it is.
//!
//! # Source
//! Armv7-M and Armv8-M reference manuals (DDI 0403E, C1.8.8; DDI 0553, "Data Watchpoint and Trace
//! unit"). A Cortex-M7's counter is locked at first (Arm DDI 0489F, "CoreSight lock access
//! register").

use crate::ports::Clock;
use cortex_m::peripheral::{CPUID, DCB, DWT};

/// The core's clock as a clock of programs: 32 bits, which wrap after 10 s at 400 MHz.
#[derive(Clone, Copy, Debug)]
pub struct CycleCounter {
    core_hz: u32,
}

impl CycleCounter {
    /// Starts the counter of a core of this frequency.
    pub fn start(core_hz: u32) -> Self {
        // SAFETY: bits of debug registers that nothing else in a program uses.
        unsafe {
            let dcb = &*DCB::PTR;
            dcb.demcr.modify(|control| control | TRACE_ENABLE);
            DWT::unlock();
            let dwt = &*DWT::PTR;
            dwt.cyccnt.write(0);
            dwt.ctrl.modify(|control| control | 1); // CYCCNTENA
        }
        Self { core_hz }
    }
}

/// DEMCR, TRCENA: without it the counter stands.
const TRACE_ENABLE: u32 = 1 << 24;

impl Clock for CycleCounter {
    const UNIT: &'static str = "cycles";

    #[inline]
    fn now(&self) -> u32 {
        DWT::cycle_count()
    }

    fn microseconds(&self, from: u32, to: u32) -> u64 {
        self.elapsed(from, to) * 1_000_000 / u64::from(self.core_hz.max(1))
    }
}

/// CPUID: the processor and its revision.
pub fn processor_id() -> u32 {
    // SAFETY: reading it changes nothing.
    unsafe { (*CPUID::PTR).base.read() }
}
