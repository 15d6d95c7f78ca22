//! What all emulated machines give to the program `live`, beside a clock and ports of their own.

use super::flash_file::FlashFile;
use crate::ports::{self, NoWatchdog};
use crate::programs::live::Painter;
use crate::rig_store::RigStore;
use crate::semihosting::Arguments;

/// Frames painted in place of cameras, a file of the PC in place of flash.
pub type Peripherals<C, H, A> = ports::Peripherals<C, H, A, Painter, RigStore<FlashFile>, NoWatchdog>;

/// Around a clock, the host's port and the autopilot's. The program's argument names the file in place of flash; `None` when that cannot be used.
pub fn peripherals<C, H, A>(clock: C, host: H, autopilot: A) -> Option<Peripherals<C, H, A>> {
    Some(Peripherals {
        clock,
        host,
        autopilot,
        pairs: Painter::new(super::selected::BOARD.largest),
        flash: Arguments::ask().get(0).map(FlashFile::slots).transpose().ok()?,
        watchdog: NoWatchdog,
        reset: None,
    })
}

/// Virtual nanoseconds that QEMU lets pass per instruction, with `-icount shift=6`. It knows no cycles: on a real board these clocks would
/// count time.
pub const NS_PER_INSTRUCTION: u64 = 64;
