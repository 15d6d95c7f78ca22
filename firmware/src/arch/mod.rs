//! Differences between families of processors; one of the folders is compiled, with the same
//! interface as the others.
//!
//! ```text
//! cortex_m    Armv7E-M (M4, M7) and Armv8-M Mainline (M33 and above), on cortex-m-rt
//! riscv       RV32 in machine mode, on riscv-rt
//! ```
//!
//! ```text
//! switch_stack         leaves the stack of handlers for that of the program
//! protection           forbidden memory: the guard below the stack, fences around the memory of
//!                      kernels
//! semihosting_call     a request to the PC behind QEMU or a probe
//! ```

use crate::stack;
use core::ops::Range;

#[cfg(target_arch = "arm")]
mod cortex_m;
#[cfg(target_arch = "riscv32")]
mod riscv;

#[cfg(target_arch = "arm")]
pub use cortex_m::protection::forbid_fences;
#[cfg(target_arch = "arm")]
pub(crate) use cortex_m::{protection, switch_stack};
#[cfg(target_arch = "riscv32")]
pub use riscv::protection::forbid_fences;
#[cfg(target_arch = "riscv32")]
pub(crate) use riscv::{protection, switch_stack};

#[cfg(all(target_arch = "arm", feature = "emulated"))]
pub(crate) use cortex_m::semihosting_call;
#[cfg(all(target_arch = "riscv32", feature = "emulated"))]
pub(crate) use riscv::semihosting_call;

/// The memory below the stack that nothing may touch, at most 512 KiB: no frame is larger than all
/// RAM, so none steps over it; what lies further below may be of use, as an STM32H7's unique id. A
/// power of two, and aligned to it, as protection units want it; smaller where the stack's end is
/// not a multiple of 512 KiB.
pub(crate) fn guard() -> Range<usize> {
    const LARGEST: usize = 512 << 10;
    let end = stack::bottom();
    let lowest_bit = end & end.wrapping_neg();
    end - lowest_bit.min(LARGEST)..end
}
