//! QEMU's mps2-an386: Arm Cortex-M4, held to the flash and RAM of a part of its class by `mps2_an386.x`.

use super::capacities::qqvga;
use super::{Board, Device};

/// Its description.
pub const BOARD: Board = qqvga::board(
    "mps2-an386",
    "Cortex-M4",
    "thumbv7em-none-eabihf",
    Device::Qemu { program: "qemu-system-arm", arguments: &["-machine", "mps2-an386"] },
);

/// Its memory.
pub type Workspace = qqvga::Workspace;

#[cfg(all(target_os = "none", feature = "mps2-an386"))]
pub use super::mps2::{InstructionClock, peripherals};
