//! QEMU's mps2-an386: Arm Cortex-M4, held to the flash and RAM of a part of its class by
//! `mps2_an386.x`.

use linestereo_boards::Board;

/// Its description.
pub const BOARD: Board = Board::MPS2_AN386;

/// Its memory.
pub type BoardMemory = board_memory!(BOARD);

#[cfg(all(target_os = "none", feature = "mps2-an386"))]
pub use super::mps2::{bare, peripherals, usual::*};
