//! From reset to the program: memory protection, a painted stack, and the program on a stack of its
//! own.
//!
//! ```text
//! below           no access, 512 KiB: memory protection turns every overflow of the stack into a
//!                 fault, however large its step
//! start of RAM    stack of the program, grows down
//!                 stack of handlers, of the size that the board says: still good when the
//!                     other has overflowed
//!                 statics
//! ```

/// Makes a function `fn() -> Exit` the program of a binary. On a PC, where it cannot run, the
/// binary says how to build it.
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
    use crate::{arch, ending, stack};
    use linestereo_boards::Exit;

    /// Runs the program and ends with its exit code.
    pub fn start(program: fn() -> Exit) -> ! {
        arch::protection::guard();
        stack::paint(stack::bottom()..stack::top());
        arch::switch_stack(enter, program)
    }

    #[expect(
        improper_ctypes_definitions,
        reason = "both sides are this crate; a function pointer is one register"
    )]
    extern "C" fn enter(program: fn() -> Exit) -> ! {
        ending::end(program(), 0)
    }
}
#[cfg(target_os = "none")]
pub use board::start;
