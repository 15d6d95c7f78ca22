//! Forbidden memory around the inputs and outputs of kernels: reading or writing it is a fault.

use crate::programs::kernels::{Fence, PAGE, Rooms};
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
    /// The parts of the page behind the fence stay as they are (B3.5.9).
    const NOT_THE_REST: u32 = (0xff << Fence::PARTS & 0xff) << 8;
    /// Never executed, no access, 2^10 bytes, enabled.
    const NO_ACCESS: u32 = 1 << 28 | NOT_THE_REST | 9 << 1 | 1;
    const { assert!(PAGE == 1 << 10 && align_of::<Rooms>() == PAGE) };
    // SAFETY: nothing else writes these regions, and nothing else lies in a fence.
    unsafe {
        let mpu = &*MPU::PTR;
        mpu.rbar.write((&raw const *fence).addr() as u32 | VALID | region);
        mpu.rasr.write(NO_ACCESS);
    }
}
