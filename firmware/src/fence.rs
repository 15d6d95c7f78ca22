//! Forbidden memory around the inputs and outputs of kernels: reading or writing it is a fault.

use crate::arch::protection;
use crate::programs::kernels::Rooms;
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};

struct Cell(UnsafeCell<Rooms>);

// SAFETY: only `take` reaches the content, and hands it out once.
unsafe impl Sync for Cell {}

static ROOMS: Cell = Cell(UnsafeCell::new(Rooms::new()));
static TAKEN: AtomicBool = AtomicBool::new(false);

/// The rooms, fenced from now on; `None` when they were taken before, or where the processor has too few regions.
pub fn take() -> Option<&'static mut Rooms> {
    if TAKEN.swap(true, Ordering::Relaxed) || !protection::has_fences() {
        return None;
    }
    // SAFETY: `TAKEN` was false until now, so this is the only reference there will ever be.
    let rooms = unsafe { &mut *ROOMS.0.get() };
    protection::forbid_fences(&rooms.fences());
    Some(rooms)
}
