//! RISC-V, 32 bit, in machine mode.

// Reset, and the linker script.
use riscv_rt as _;

pub(crate) mod protection;

use crate::stack;
use core::arch::asm;
use linestereo_boards::Exit;

/// Goes to `enter` with the program, on the program's stack. Handlers begin at the end of theirs:
/// see `fault/riscv.rs`.
#[expect(
    improper_ctypes_definitions,
    reason = "both sides are this crate; a function pointer is one register"
)]
pub(crate) fn switch_stack(enter: extern "C" fn(fn() -> Exit) -> !, program: fn() -> Exit) -> ! {
    // SAFETY: the stack pointer is the end of memory that nothing else uses; what this stack holds
    // is never returned to.
    unsafe {
        asm!(
            "mv sp, {top}",
            "jr {enter}",
            top = in(reg) stack::top() & !15, // as calls expect it
            enter = in(reg) enter,
            in("a0") program,
            options(noreturn),
        );
    }
}

/// One operation of semihosting ("RISC-V Semihosting", 1.0): three instructions that say together
/// that the breakpoint is a call. They are not compressed, and lie on one page.
///
/// # Safety
/// `argument` is what the operation expects, and memory it points to may be read or written as the
/// operation does.
#[cfg(feature = "emulated")]
pub(crate) unsafe fn semihosting_call(operation: u32, argument: *const u32) -> u32 {
    let result;
    // SAFETY: the breakpoint is answered by the PC, which changes a0 and the memory that the caller
    // vouches for.
    unsafe {
        asm!(
            ".option push",
            ".option norvc",
            ".balign 16",
            "slli x0, x0, 0x1f",
            "ebreak",
            "srai x0, x0, 7",
            ".option pop",
            inout("a0") operation => result,
            in("a1") argument,
            options(nostack, preserves_flags),
        );
    }
    result
}
