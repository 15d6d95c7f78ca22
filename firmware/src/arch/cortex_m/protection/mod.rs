//! The memory protection unit: what no access of any kind may reach. How a region forbids is each
//! architecture's own.

#[cfg(not(armv8m))]
mod v7;
#[cfg(armv8m)]
mod v8;
#[cfg(not(armv8m))]
use v7 as version;
#[cfg(armv8m)]
use v8 as version;

use crate::fence::Fence;
use cortex_m::peripheral::MPU;

/// Forbids the memory below the stack. What a bootloader has left is forgotten.
pub(crate) fn guard() {
    // SAFETY: nothing else writes these registers; without protection everything is allowed. The
    // program's stack is not in use yet, and empty, so that a fault here is none of it.
    unsafe {
        cortex_m::register::psp::write(crate::stack::top() as u32);
        let mpu = &*MPU::PTR;
        mpu.ctrl.write(0);
        for region in 0..regions() {
            mpu.rnr.write(region);
            version::forget(mpu);
        }
    }
    version::forbid_below_stack();
    /// MPU_CTRL: enabled, all else as without protection (Armv7-M reference manual, B3.5.5; the
    /// same of Armv8-M).
    const ENABLE: u32 = 1 << 2 | 1;
    // SAFETY: nothing else writes this register, and no code or data lies in what is forbidden.
    unsafe { (*MPU::PTR).ctrl.write(ENABLE) };
    take_effect();
}

/// Number of regions of the processor.
fn regions() -> u32 {
    // SAFETY: a read of a register that does not change.
    unsafe { (*MPU::PTR)._type.read() >> 8 & 0xff }
}

/// Forbids the fences, each at a multiple of its size; `false` where the processor has fewer
/// regions.
pub fn forbid_fences(fences: &[&Fence]) -> bool {
    const { assert!(Fence::BYTES.is_power_of_two()) };
    if (regions() as usize) < version::FIRST_FENCE as usize + fences.len() {
        return false;
    }
    for (region, &fence) in (version::FIRST_FENCE..).zip(fences) {
        version::forbid(region, (&raw const *fence).addr(), Fence::BYTES);
    }
    take_effect();
    true
}

fn take_effect() {
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}
