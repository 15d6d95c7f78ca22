//! What must not happen ends in a report and an exit code, never in a hang.
//!
//! All faults escalate to HardFault, which runs on a stack of its own (see [`crate::startup`]) and reads the program's stack only where
//! it is readable.

use crate::ending::{end, report, report_number};
use crate::stack;
use crate::startup::Exit;
use core::panic::PanicInfo;
use core::ptr;
use cortex_m::peripheral::SCB;
use cortex_m::register::psp;
use cortex_m_rt::exception;

/// Bit of CFSR: the registers could not be saved on the stack (MSTKERR, STKERR).
const STACKING_ERROR: u32 = 1 << 4 | 1 << 12;
/// Bits of CFSR: MMFAR and BFAR hold the address.
const MMFAR_VALID: u32 = 1 << 7;
const BFAR_VALID: u32 = 1 << 15;

#[exception(trampoline = false)]
unsafe fn HardFault() -> ! {
    // SAFETY: reads of status registers.
    let (cfsr, hfsr, mmfar, bfar) = unsafe {
        let scb = &*SCB::PTR;
        (scb.cfsr.read(), scb.hfsr.read(), scb.mmfar.read(), scb.bfar.read())
    };
    let address = match cfsr {
        bits if bits & MMFAR_VALID != 0 => Some(mmfar),
        bits if bits & BFAR_VALID != 0 => Some(bfar),
        _ => None,
    };
    let frame = psp::read() as usize;
    let stack = stack::bottom()..stack::top();
    let overflow = !stack.contains(&frame)
        || cfsr & STACKING_ERROR != 0
        || address.is_some_and(|address| (address as usize) < stack.start && address >= 0x1000_0000);
    report(if overflow { "stack overflow:" } else { "fault:" });
    let mut pc = 0;
    if stack.contains(&frame) && stack.contains(&(frame + 28)) {
        // SAFETY: both ends of the saved registers lie in the program's stack. Number 6 of them is the program counter.
        pc = unsafe { ptr::with_exposed_provenance::<u32>(frame).add(6).read_volatile() };
        report_number(" pc ", pc);
    }
    report_number(" cfsr ", cfsr);
    report_number(" hfsr ", hfsr);
    if let Some(address) = address {
        report_number(" address ", address);
    }
    report("\n");
    end(if overflow { Exit::StackOverflow } else { Exit::Fault }, pc)
}

/// No interrupt is enabled: one that comes all the same is a fault.
#[exception]
unsafe fn DefaultHandler(number: i16) -> ! {
    report_number("fault: unexpected exception ", number as u32);
    report("\n");
    end(Exit::Fault, 0)
}

fn report_decimal(number: u32) {
    if number >= 10 {
        report_decimal(number / 10);
    }
    report(["0", "1", "2", "3", "4", "5", "6", "7", "8", "9"][(number % 10) as usize]);
}

/// Where, in every build; why, in builds with logs.
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let line = info.location().map_or(0, |location| location.line());
    report("panic: ");
    if let Some(location) = info.location() {
        report(location.file());
        report(":");
        report_decimal(location.line());
    }
    report("\n");
    #[cfg(any(feature = "log-semihosting", feature = "log-rtt"))]
    {
        let _ = core::fmt::Write::write_fmt(&mut Console, format_args!("{}\n", info.message()));
    }
    end(Exit::Panic, line)
}

#[cfg(any(feature = "log-semihosting", feature = "log-rtt"))]
struct Console;

#[cfg(any(feature = "log-semihosting", feature = "log-rtt"))]
impl core::fmt::Write for Console {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        report(text);
        Ok(())
    }
}
