//! Armv8-M, with the limits of both stacks. No region can forbid access, but an address in two
//! regions is refused (Armv8-M Architecture Reference Manual, DDI 0553, "Protected Memory System
//! Architecture"): forbidden is what lies in a second region.
//!
//! ```text
//! region 0        from the guard's start to the end of the SRAM's addresses, as without protection
//! region 1        the guard
//! regions 1 - 7   fences, while kernels are compared: eight regions is all that most of these
//!                 processors have
//! PSPLIM          the stack's end: what goes below it is a fault, whatever the step, and with
//!                 fences instead of the guard too
//! MSPLIM          the end of the handlers' stack, which is where the program's begins: a handler
//!                 that takes too much locks the processor up (a watchdog's work) instead of
//!                 changing what the program keeps there
//! ```

use crate::{arch, stack};
use cortex_m::peripheral::MPU;
use cortex_m::peripheral::mpu::RegisterBlock;
use cortex_m::register::{msplim, psplim};

/// The first region over region 0: the guard's, and while there are fences the first one's.
pub(super) const FIRST_FENCE: u32 = 1;
/// The end of the SRAM's addresses in the default memory map.
const SRAM_END: usize = 0x4000_0000;

/// Sets the limits of both stacks too.
pub(super) fn forbid_below_stack() {
    let below = arch::guard();
    // SAFETY: nothing else writes these registers.
    unsafe {
        psplim::write(below.end as u32);
        msplim::write(stack::top() as u32);
        // MPU_MAIR0, memory attribute 0: normal, write-back, as SRAM is without protection.
        (*MPU::PTR).mair[0].write(0xff);
    }
    write(0, below.start, SRAM_END - below.start);
    forbid(FIRST_FENCE, below.start, below.len());
}

/// The region that RNR names does nothing any more.
pub(super) unsafe fn forget(mpu: &RegisterBlock) {
    // SAFETY: as the caller says.
    unsafe { mpu.rlar.write(0) }
}

/// No access to `bytes`, a multiple of 32 as `start` is, in region 0.
pub(super) fn forbid(region: u32, start: usize, bytes: usize) {
    write(region, start, bytes);
}

/// One region.
fn write(region: u32, start: usize, bytes: usize) {
    /// MPU_RLAR: memory attribute 0, enabled. MPU_RBAR is the address alone: privileged code reads,
    /// writes and executes.
    const ENABLE: u32 = 1;
    // SAFETY: nothing else writes these regions.
    unsafe {
        let mpu = &*MPU::PTR;
        mpu.rnr.write(region);
        mpu.rbar.write(start as u32);
        mpu.rlar.write((start + bytes - 32) as u32 | ENABLE);
    }
}
