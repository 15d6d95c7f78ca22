//! Armv7-M: a region may forbid every access, and wins over those with lower numbers.

use crate::arch;
use cortex_m::peripheral::MPU;

/// The region of the guard, and the first one for fences.
const GUARD: u32 = 0;
pub(super) const FIRST_FENCE: u32 = 1;

pub(super) fn forbid_below_stack() {
    let below = arch::guard();
    forbid(GUARD, below.start, below.len());
}

/// No access to `bytes`, a power of two to which `start` is aligned.
pub(super) fn forbid(region: u32, start: usize, bytes: usize) {
    /// The address and number of the region are those given (B3.5.8).
    const VALID: u32 = 1 << 4;
    /// Never executed, no access, enabled (B3.5.9).
    const NO_ACCESS: u32 = 1 << 28 | 1;
    // SAFETY: nothing else writes these regions, and nothing but what is forbidden lies there.
    unsafe {
        let mpu = &*MPU::PTR;
        mpu.rbar.write(start as u32 | VALID | region);
        mpu.rasr.write(NO_ACCESS | (bytes.trailing_zeros() - 1) << 1);
    }
}
