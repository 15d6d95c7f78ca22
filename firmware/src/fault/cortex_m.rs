//! All faults escalate to HardFault, which runs on the stack of handlers and reads the program's
//! stack only where it is readable.

use crate::arch::guard;
#[cfg(feature = "rp235x")]
use crate::boards::rp235x::second_core;
use crate::ending::{begin, end, report, report_number};
use crate::stack;
use core::ops::Range;
use core::ptr;
use cortex_m::peripheral::SCB;
use cortex_m::register::psp;
use cortex_m_rt::exception;
use linestereo_boards::Exit;

/// Bits of CFSR: the registers could not be saved on the stack (MSTKERR, STKERR), or the stack
/// pointer went below its limit (STKOF, Armv8-M).
const STACKING_ERROR: u32 = 1 << 4 | 1 << 12;
const BELOW_LIMIT: u32 = 1 << 20;
/// Bits of CFSR: MMFAR and BFAR hold the address.
const MMFAR_VALID: u32 = 1 << 7;
const BFAR_VALID: u32 = 1 << 15;
/// Bit of ICSR: no handler was running before this one (RETTOBASE).
const FROM_PROGRAM: u32 = 1 << 11;

/// The stack of the program, on a second core that of its work.
fn stack() -> Range<usize> {
    #[cfg(feature = "rp235x")]
    if !second_core::is_first() {
        return second_core::stack();
    }
    stack::bottom()..stack::top()
}

#[exception(trampoline = false)]
unsafe fn HardFault() -> ! {
    // SAFETY: reads of status registers.
    let (cfsr, hfsr, mmfar, bfar, icsr) = unsafe {
        let scb = &*SCB::PTR;
        (scb.cfsr.read(), scb.hfsr.read(), scb.mmfar.read(), scb.bfar.read(), scb.icsr.read())
    };
    let address = match cfsr {
        bits if bits & MMFAR_VALID != 0 => Some(mmfar),
        bits if bits & BFAR_VALID != 0 => Some(bfar),
        _ => None,
    };
    let frame = psp::read() as usize;
    let stack = stack();
    // The registers of a handler are saved on its own stack: what lies on the program's says where
    // the program was.
    let from_program = icsr & FROM_PROGRAM != 0;
    let overflow = from_program && frame < stack.start
        || cfsr & (STACKING_ERROR | BELOW_LIMIT) != 0
        || address.is_some_and(|address| guard().contains(&(address as usize)));
    // Where they were not saved the stack pointer is left at its limit.
    let saved = from_program
        && cfsr & STACKING_ERROR == 0
        && (cfsr & BELOW_LIMIT == 0 || frame != stack.start);
    let pc = (saved && stack.contains(&frame) && stack.contains(&(frame + 28)))
        // SAFETY: both ends of the saved registers lie in the program's stack. Number 6 of them is
        // the program counter.
        .then(|| unsafe { ptr::with_exposed_provenance::<u32>(frame).add(6).read_volatile() });
    super::refused(overflow, pc, &[(" cfsr ", cfsr), (" hfsr ", hfsr)], address)
}

/// An interrupt that no driver of the board has: a fault.
#[exception]
unsafe fn DefaultHandler(number: i16) -> ! {
    if begin(Exit::Fault, 0) {
        report_number("fault: unexpected exception ", number as u32);
        report("\n");
    }
    end(Exit::Fault, 0)
}
