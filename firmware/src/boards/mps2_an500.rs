//! QEMU's mps2-an500: Arm Cortex-M7, held to the flash and RAM of a part of its class by `mps2_an500.x`.

use super::capacities::qvga;
use super::{Board, Device};

/// Its description.
pub const BOARD: Board = qvga::board(
    "mps2-an500",
    "Cortex-M7",
    "thumbv7em-none-eabihf",
    Device::Qemu { program: "qemu-system-arm", arguments: &["-machine", "mps2-an500"] },
);

/// Its memory.
pub type Workspace = qvga::Workspace;

#[cfg(all(target_os = "none", feature = "mps2-an500"))]
pub use super::mps2::{InstructionClock, peripherals};
