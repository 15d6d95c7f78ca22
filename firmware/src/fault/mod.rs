//! Ends of programs that failed: a report and an exit code, never a hang.
//!
//! The processor's handlers find out what it was, on the stack of handlers.

#[cfg(target_arch = "arm")]
mod cortex_m;
#[cfg(target_arch = "riscv32")]
mod riscv;

use crate::ending::{begin, end, report, report_decimal, report_number};
use core::panic::PanicInfo;
use linestereo_boards::Exit;

/// The end after an instruction or an address that the processor refused: what is known of it, and
/// its registers by name.
fn refused(overflow: bool, pc: Option<u32>, registers: &[(&str, u32)], address: Option<u32>) -> ! {
    let (exit, location) =
        (if overflow { Exit::StackOverflow } else { Exit::Fault }, pc.unwrap_or(0));
    if begin(exit, location) {
        report(if overflow { "stack overflow:" } else { "fault:" });
        if let Some(pc) = pc {
            report_number(" pc ", pc);
        }
        for (name, bits) in registers {
            report_number(name, *bits);
        }
        if let Some(address) = address {
            report_number(" address ", address);
        }
        report("\n");
    }
    end(exit, location)
}

/// Where, in every build; why, in builds with logs.
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let line = info.location().map_or(0, |location| location.line());
    if begin(Exit::Panic, line) {
        report_panic(info);
    }
    end(Exit::Panic, line)
}

fn report_panic(info: &PanicInfo<'_>) {
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
