//! Every trap is the end: no interrupt is enabled, and the program asks nobody for a service. The
//! handler has a stack of its own.

use crate::arch::guard;
use crate::stack;
use core::arch::global_asm;
use riscv::register::{mcause, mepc, mtval};

// The first instruction that is executed after a trap; riscv-rt has one of its own where there is
// none, on the stack that may be full. Traps begin at a multiple of 4 (mtvec, direct mode).
global_asm!(
    ".section .trap.start, \"ax\"",
    ".balign 4",
    ".global _start_trap",
    "_start_trap:",
    "mv a0, sp",
    "la sp, _stack_start",
    "j {refused}",
    refused = sym refused,
);

/// Causes (RISC-V privileged architecture, 1.12, "mcause") with an address in mtval: an
/// instruction, a load or a store that is misaligned or refused.
const WITH_ADDRESS: [usize; 6] = [0, 1, 4, 5, 6, 7];

extern "C" fn refused(stack_pointer: usize) -> ! {
    let (cause, pc, value) = (mcause::read(), mepc::read(), mtval::read());
    let address = (!cause.is_interrupt() && WITH_ADDRESS.contains(&cause.code())).then_some(value);
    // Before the program has its stack, it runs on that of handlers, which lies above.
    let overflow = stack_pointer < stack::bottom()
        || address.is_some_and(|address| guard().contains(&address));
    super::refused(
        overflow,
        Some(pc as u32),
        &[(" mcause ", cause.bits() as u32)],
        address.map(|address| address as u32),
    )
}
