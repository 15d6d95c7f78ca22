//! Armv7-M: a region may forbid every access, and wins over those with lower numbers.
//!
//! ```text
//! region 0        the guard
//! region 1        between both stacks, the lowest 32 bytes of that of handlers: one that takes too
//!                 much locks the processor up (a watchdog's work) instead of changing what the
//!                 program keeps there, unless it steps over them
//! regions 1 - 7   fences, while kernels are compared: eight regions is all that some of these
//!                 processors have
//! ```

use crate::{arch, stack};
use cortex_m::peripheral::MPU;
use cortex_m::peripheral::mpu::RegisterBlock;

const GUARD: u32 = 0;
const BETWEEN_STACKS: u32 = 1;
/// The first region for fences.
pub(super) const FIRST_FENCE: u32 = 1;

pub(super) fn forbid_below_stack() {
    let below = arch::guard();
    forbid(GUARD, below.start, below.len());
    forbid(BETWEEN_STACKS, stack::top(), 32);
}

/// The region that RNR names does nothing any more.
pub(super) unsafe fn forget(mpu: &RegisterBlock) {
    // SAFETY: as the caller says.
    unsafe { mpu.rasr.write(0) }
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
