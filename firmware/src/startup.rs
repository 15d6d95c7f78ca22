//! From reset to the program: memory protection, a painted stack, and the program on a stack of its own.
//!
//! ```text
//! 0x2000_0000 - 256 MiB   no access: the memory protection unit turns every overflow of the stack into a fault, however large its step
//! 0x2000_0000             stack of the program (PSP), grows down
//!                         stack of fault handlers (MSP), 1 KiB: still good when the other has overflowed
//!                         statics
//! ```

/// How a program ends; the number is the exit code of the simulator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Exit {
    /// All is well.
    Success = 0,
    /// A result is not what it should be.
    Difference = 1,
    /// The command line or a file cannot be used.
    Usage = 2,
    /// The code panicked.
    Panic = 101,
    /// The processor refused an instruction or an address.
    Fault = 102,
    /// The stack grew out of its memory.
    StackOverflow = 103,
}

impl Exit {
    /// Every way to end.
    pub const ALL: [Self; 6] =
        [Self::Success, Self::Difference, Self::Usage, Self::Panic, Self::Fault, Self::StackOverflow];

    /// What this exit code means.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Success => "all is well",
            Self::Difference => "a result is not what it should be",
            Self::Usage => "its command line or a file cannot be used",
            Self::Panic => "it panicked",
            Self::Fault => "the processor refused an instruction or an address",
            Self::StackOverflow => "the stack grew out of its memory",
        }
    }
}

/// Makes a function `fn() -> Exit` the program of a binary. On a PC, where it cannot run, the binary says how to build it.
#[macro_export]
macro_rules! program {
    ($program:path) => {
        #[cfg(target_os = "none")]
        #[unsafe(no_mangle)]
        extern "C" fn main() -> ! {
            $crate::startup::start($program)
        }

        #[cfg(not(target_os = "none"))]
        fn main() {
            eprintln!("{} runs on a board: cargo xtask run --program {0}", env!("CARGO_BIN_NAME"));
            std::process::exit(2);
        }
    };
}

#[cfg(target_os = "none")]
mod board {
    use super::Exit;
    use crate::{ending, stack};
    use core::arch::asm;
    use cortex_m::peripheral::MPU;

    /// Runs the program and ends with its exit code.
    pub fn start(program: fn() -> Exit) -> ! {
        guard();
        stack::paint();
        // SAFETY: the stack pointers are ends of memory that nothing else uses; what this stack holds is never returned to. A branch
        // from here leaves the handler's stack empty but for this frame.
        unsafe {
            asm!(
                "msr psp, {top}",
                "msr control, {use_psp}",
                "isb",
                "bx {enter}",
                top = in(reg) stack::top(),
                use_psp = in(reg) 2,
                enter = in(reg) enter as extern "C" fn(fn() -> Exit) -> !,
                in("r0") program,
                options(noreturn),
            );
        }
    }

    #[expect(improper_ctypes_definitions, reason = "both sides are this file; a function pointer is one register")]
    extern "C" fn enter(program: fn() -> Exit) -> ! {
        ending::end(program(), 0)
    }

    /// Forbids the 256 MiB below the stack.
    fn guard() {
        /// Least address, valid, region 0 (Armv7-M reference manual, B3.5.8).
        const BELOW_RAM: u32 = 0x1000_0000 | 1 << 4;
        /// Never executed, no access, 2^28 bytes, enabled (B3.5.9).
        const NO_ACCESS: u32 = 1 << 28 | 27 << 1 | 1;
        /// Enabled, all else as without protection (B3.5.5).
        const ENABLE: u32 = 1 << 2 | 1;
        // SAFETY: nothing else writes these registers, and no code or data lies in the region.
        unsafe {
            let mpu = &*MPU::PTR;
            mpu.rbar.write(BELOW_RAM);
            mpu.rasr.write(NO_ACCESS);
            mpu.ctrl.write(ENABLE);
        }
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
    }
}
#[cfg(target_os = "none")]
pub use board::start;
