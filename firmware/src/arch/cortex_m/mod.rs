//! Arm Cortex-M.

mod memory;
pub(crate) mod protection;

use crate::stack;
use core::arch::asm;
use linestereo_boards::Exit;

/// Goes to `enter` with the program, on the program's stack (PSP). Handlers keep theirs (MSP).
#[expect(
    improper_ctypes_definitions,
    reason = "both sides are this crate; a function pointer is one register"
)]
pub(crate) fn switch_stack(enter: extern "C" fn(fn() -> Exit) -> !, program: fn() -> Exit) -> ! {
    // SAFETY: the stack pointers are ends of memory that nothing else uses; what this stack holds
    // is never returned to. A branch from here leaves the handler's stack empty but for this frame.
    unsafe {
        asm!(
            "msr psp, {top}",
            "msr control, {use_psp}",
            "isb",
            "bx {enter}",
            top = in(reg) stack::top(),
            use_psp = in(reg) 2,
            enter = in(reg) enter,
            in("r0") program,
            options(noreturn),
        );
    }
}

/// One operation of semihosting ("Semihosting for AArch32 and AArch64", 2.0).
///
/// # Safety
/// `argument` is what the operation expects, and memory it points to may be read or written as the
/// operation does.
#[cfg(feature = "emulated")]
pub(crate) unsafe fn semihosting_call(operation: u32, argument: *const u32) -> u32 {
    let result;
    // SAFETY: the breakpoint is answered by the PC, which changes r0 and the memory that the caller
    // vouches for.
    unsafe {
        asm!("bkpt #0xab", inout("r0") operation => result, in("r1") argument, options(nostack, preserves_flags));
    }
    result
}
