//! QEMU's mps2-an505: Arm Cortex-M33 with DSP extension, held to the flash and RAM of a part of its
//! class by `mps2_an505.x`.
//!
//! It starts in the secure state and stays there. Addresses: Arm's application note AN505; QEMU,
//! `hw/arm/mps2-tz.c`.

use linestereo_boards::Board;

/// Its description.
pub const BOARD: Board = Board::MPS2_AN505;

/// Its memory.
pub type BoardMemory = board_memory!(BOARD);

#[cfg(all(target_os = "none", feature = "mps2-an505"))]
pub use on_board::{InstructionClock, bare, peripherals};

#[cfg(all(target_os = "none", feature = "mps2-an505"))]
mod on_board {
    use crate::boards::emulated::{self, Port};
    use crate::boards::mps2::{Timer, Uart};
    use crate::ports::{BarePeripherals, NoWatchdog};

    /// Timer 0, where the secure state sees it, on the bus's 20 MHz.
    pub type InstructionClock = Timer<0x5000_0000, 20>;

    const UARTS: [usize; 2] = [0x5020_0000, 0x5020_1000];

    /// Peripherals for `live`.
    pub fn peripherals() -> Option<emulated::Peripherals<InstructionClock, Port<Uart>, Port<Uart>>>
    {
        let [host, autopilot] = Uart::start(UARTS, 20);
        emulated::peripherals(InstructionClock::start(), host, autopilot)
    }

    /// Peripherals of `selftest`.
    pub fn bare()
    -> Option<BarePeripherals<InstructionClock, InstructionClock, Port<Uart>, NoWatchdog>> {
        let [host, _] = Uart::start(UARTS, 20);
        Some(emulated::bare([InstructionClock::start(), InstructionClock::start()], host))
    }
}
