//! Forbidden memory around the inputs and outputs of kernels: reading or writing it is a fault.

use crate::programs::kernels::{Fence, Rooms};
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};
use cortex_m::peripheral::MPU;

struct Cell(UnsafeCell<Rooms>);

// SAFETY: only `take` reaches the content, and hands it out once.
unsafe impl Sync for Cell {}

static ROOMS: Cell = Cell(UnsafeCell::new(Rooms::new()));
static TAKEN: AtomicBool = AtomicBool::new(false);

/// The rooms, fenced from now on; `None` when they were taken before, or where the processor has too few regions.
pub fn take() -> Option<&'static mut Rooms> {
    // SAFETY: a read of a register that says what the processor has.
    let regions = unsafe { (*MPU::PTR)._type.read() } >> 8 & 0xff;
    if TAKEN.swap(true, Ordering::Relaxed) || (regions as usize) < FIRST_REGION as usize + Rooms::FENCES {
        return None;
    }
    // SAFETY: `TAKEN` was false until now, so this is the only reference there will ever be.
    let rooms = unsafe { &mut *ROOMS.0.get() };
    for (region, fence) in (FIRST_REGION..).zip(rooms.fences()) {
        forbid(region, fence);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
    Some(rooms)
}

/// The regions before are those of [`crate::startup`], which also enables the unit.
const FIRST_REGION: u32 = 1;

fn forbid(region: u32, fence: &Fence) {
    /// The address and number of the region are those given (Armv7-M reference manual, B3.5.8).
    const VALID: u32 = 1 << 4;
    /// Never executed, no access, 2^9 bytes, enabled (B3.5.9).
    const NO_ACCESS: u32 = 1 << 28 | 8 << 1 | 1;
    const { assert!(Fence::BYTES == 1 << 9 && align_of::<Rooms>().is_multiple_of(Fence::BYTES)) };
    // SAFETY: nothing else writes these regions, and nothing else lies in a fence.
    unsafe {
        let mpu = &*MPU::PTR;
        mpu.rbar.write((&raw const *fence).addr() as u32 | VALID | region);
        mpu.rasr.write(NO_ACCESS);
    }
}
