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
pub use super::mps2::{bare, peripherals};

/// Timer 0, where the secure state sees it.
#[cfg(all(target_os = "none", feature = "mps2-an505"))]
pub type InstructionClock = super::mps2::Timer<0x5000_0000, MHZ>;
/// Addresses of the host's UART and of the autopilot's.
pub const UARTS: [usize; 2] = [0x5020_0000, 0x5020_1000];
/// Of the bus.
pub const MHZ: u32 = 20;
