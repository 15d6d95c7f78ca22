//! Stack limits and the memory protection unit of Armv8-M. No region can forbid access, but an address in two regions is refused
//! (Armv8-M Architecture Reference Manual, DDI 0553, "Protected Memory System Architecture"): forbidden is what lies in a second region.
//!
//! ```text
//! region 0        from the guard's start to the end of the SRAM's addresses, as without protection
//! region 1        the guard
//! regions 1 - 7   fences, while kernels are compared: eight regions is all that most of these processors have
//! PSPLIM          the stack's end: what goes below it is a fault, whatever the step, and with fences instead of the guard too
//! MSPLIM          the end of the handlers' stack, which is where the program's begins: a handler that takes too much locks the processor up
//!                 (a watchdog's work) instead of changing what the program keeps there
//! ```

use crate::programs::kernels::{Fence, Rooms};
use crate::{arch, stack};
use cortex_m::peripheral::MPU;
use cortex_m::register::{msplim, psplim};

/// The first region over region 0.
const FIRST: u32 = 1;
/// The end of the SRAM's addresses in the default memory map.
const SRAM_END: usize = 0x4000_0000;

/// Forbids the memory below the stack, and sets the limits of both stacks.
pub(crate) fn guard() {
    let below = arch::guard();
    // SAFETY: nothing else writes these registers.
    unsafe {
        psplim::write(below.end as u32);
        msplim::write(stack::top() as u32);
        // MPU_MAIR0, memory attribute 0: normal, write-back, as SRAM is without protection.
        (*MPU::PTR).mair[0].write(0xff);
    }
    write(0, below.start, SRAM_END - below.start);
    write(FIRST, below.start, below.len());
    /// MPU_CTRL: enabled, all else as without protection.
    const ENABLE: u32 = 1 << 2 | 1;
    // SAFETY: nothing else writes this register, and no code or data lies in the guard.
    unsafe { (*MPU::PTR).ctrl.write(ENABLE) };
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Are there regions for all fences?
pub(crate) fn has_fences() -> bool {
    // SAFETY: a read of a register that says what the processor has.
    let regions = unsafe { (*MPU::PTR)._type.read() } >> 8 & 0xff;
    regions as usize >= FIRST as usize + Rooms::FENCES
}

/// Forbids the fences.
pub(crate) fn forbid_fences(fences: &[&Fence]) {
    for (region, &fence) in (FIRST..).zip(fences) {
        write(region, (&raw const *fence).addr(), Fence::BYTES);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// One region.
fn write(region: u32, start: usize, bytes: usize) {
    const { assert!(Fence::BYTES.is_multiple_of(32) && align_of::<Rooms>().is_multiple_of(32)) };
    /// MPU_RLAR: memory attribute 0, enabled. MPU_RBAR is the address alone: privileged code reads, writes and executes.
    const ENABLE: u32 = 1;
    // SAFETY: nothing else writes these regions.
    unsafe {
        let mpu = &*MPU::PTR;
        mpu.rnr.write(region);
        mpu.rbar.write(start as u32);
        mpu.rlar.write((start + bytes - 32) as u32 | ENABLE);
    }
}
