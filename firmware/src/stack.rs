//! The program's stack: painted before it is used, so that its largest depth can be seen.

use core::ops::Range;
use core::ptr;

const PAINT: u32 = 0x5ac4_5ac4;

unsafe extern "C" {
    /// Lowest address of the stacks; see `memory.x`.
    static _stack_end: u32;
    /// Where the program's stack begins to grow down.
    static _program_stack_start: u32;
}

/// Lowest address of the program's stack.
pub fn bottom() -> usize {
    (&raw const _stack_end).addr()
}

/// Where the program's stack begins to grow down.
pub fn top() -> usize {
    (&raw const _program_stack_start).addr()
}

/// Paints a stack that nobody uses yet.
pub(crate) fn paint(stack: Range<usize>) {
    for address in stack.step_by(4) {
        // SAFETY: nobody uses this memory yet.
        unsafe { ptr::with_exposed_provenance_mut::<u32>(address).write_volatile(PAINT) };
    }
}

/// The largest depth so far in bytes.
pub fn depth() -> usize {
    // SAFETY: addresses of the stack, which is always readable.
    let painted = |address: &usize| unsafe { ptr::with_exposed_provenance::<u32>(*address).read_volatile() } == PAINT;
    top() - (bottom()..top()).step_by(4).find(|address| !painted(address)).unwrap_or(top())
}
