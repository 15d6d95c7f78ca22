//! The memory protection unit of Armv7-M: a region may forbid every access, and wins over those with lower numbers.

use crate::arch;
use crate::programs::kernels::{Fence, Rooms};
use cortex_m::peripheral::MPU;

/// The region of the guard, and the first one for fences.
const GUARD: u32 = 0;
const FIRST_FENCE: u32 = 1;

/// Forbids the memory below the stack.
pub(crate) fn guard() {
    let below = arch::guard();
    forbid(GUARD, below.start, below.len().trailing_zeros());
    /// Enabled, all else as without protection (Armv7-M reference manual, B3.5.5).
    const ENABLE: u32 = 1 << 2 | 1;
    // SAFETY: nothing else writes this register, and no code or data lies in the region.
    unsafe { (*MPU::PTR).ctrl.write(ENABLE) };
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Are there regions for all fences?
pub(crate) fn has_fences() -> bool {
    // SAFETY: a read of a register that says what the processor has.
    let regions = unsafe { (*MPU::PTR)._type.read() } >> 8 & 0xff;
    regions as usize >= FIRST_FENCE as usize + Rooms::FENCES
}

/// Forbids the fences.
pub(crate) fn forbid_fences(fences: &[&Fence]) {
    const { assert!(Fence::BYTES.is_power_of_two() && align_of::<Rooms>().is_multiple_of(Fence::BYTES)) };
    for (region, &fence) in (FIRST_FENCE..).zip(fences) {
        forbid(region, (&raw const *fence).addr(), Fence::BYTES.trailing_zeros());
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// No access to 2^`bits` bytes.
fn forbid(region: u32, start: usize, bits: u32) {
    /// The address and number of the region are those given (B3.5.8).
    const VALID: u32 = 1 << 4;
    /// Never executed, no access, enabled (B3.5.9).
    const NO_ACCESS: u32 = 1 << 28 | 1;
    // SAFETY: nothing else writes these regions, and nothing but what is forbidden lies there.
    unsafe {
        let mpu = &*MPU::PTR;
        mpu.rbar.write(start as u32 | VALID | region);
        mpu.rasr.write(NO_ACCESS | (bits - 1) << 1);
    }
}
