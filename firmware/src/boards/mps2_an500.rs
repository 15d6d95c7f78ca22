//! QEMU's mps2-an500: Arm Cortex-M7, held to the flash and RAM of a part of its class by
//! `mps2_an500.x`.

use linestereo_boards::Board;

/// Its description.
pub const BOARD: Board = Board::MPS2_AN500;

/// Its memory.
pub type BoardMemory = board_memory!(BOARD);

#[cfg(all(target_os = "none", feature = "mps2-an500"))]
pub use super::mps2::{bare, peripherals, usual::*};
