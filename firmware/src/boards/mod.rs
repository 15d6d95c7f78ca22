//! The boards: one file each, with its memory and what its peripherals are. `crates/boards` says
//! what each of them holds and what runs it; `docs/porting.md` adds one.

/// The memory of a board, for what its description says that it holds.
#[macro_export]
macro_rules! board_memory {
    ($board:expr) => {
        $crate::memory::BoardMemory<
            { $board.pixels() },
            { $board.raw_width },
            linestereo::Memory<
                { $crate::memory::capacity(&$board).words() },
                { $board.segments },
                { $crate::memory::capacity(&$board).candidates() },
            >,
            $crate::memory::CameraRows<
                { $crate::boards::NODES },
                { $board.largest.height as usize },
                { $board.band },
            >,
        >
    };
}

// Not by the macro below: rustfmt finds no file that a macro declares.
pub mod mps2_an386;
pub mod mps2_an500;
pub mod mps2_an505;
pub mod mps3_an547;
pub mod pico2;
pub mod portenta_h7;
pub mod riscv_virt;
pub mod stm32h743;

#[cfg(all(target_os = "none", feature = "emulated"))]
pub mod emulated;
#[cfg(all(target_os = "none", feature = "emulated"))]
pub mod flash_file;
#[cfg(all(target_os = "none", target_arch = "arm", feature = "emulated"))]
pub mod mps2;
#[cfg(all(target_os = "none", feature = "stm32h7"))]
pub mod stm32h7;

#[cfg(all(target_os = "none", feature = "hardware"))]
pub mod cycles;
#[cfg(all(target_os = "none", feature = "hardware"))]
pub mod pipes;
#[cfg(any(not(target_os = "none"), feature = "rp235x"))]
pub mod rp235x;
#[cfg(all(target_os = "none", feature = "hardware"))]
pub mod usb_port;

use linestereo::Dims;
use linestereo_rig::mesh_nodes;

/// Nodes of a camera's mesh, the same on every board: every 16 px of 320x240, and as many every 8
/// px of 160x120, where lenses may ask for it. A mesh depends on the memory for its nodes, and so
/// do the rectified bytes: who wants a board's bytes takes as many.
pub const NODES: usize = mesh_nodes(Dims { width: 320, height: 240 });

/// Every board by its feature and its file: `selected` is the one that is built.
#[cfg(target_os = "none")]
macro_rules! boards {
    ($($feature:literal $board:ident)*) => {
        $(
            #[cfg(feature = $feature)]
            pub use $board as selected;
        )*
    };
}

#[cfg(target_os = "none")]
boards! {
    "mps2-an500" mps2_an500
    "mps2-an386" mps2_an386
    "mps2-an505" mps2_an505
    "mps3-an547" mps3_an547
    "riscv-virt" riscv_virt
    "pico2" pico2
    "stm32h743" stm32h743
    "portenta-h7" portenta_h7
}

/// The memory of the board that is built.
#[cfg(target_os = "none")]
pub static MEMORY: crate::once::Once<selected::BoardMemory> =
    crate::once::Once::new(selected::BoardMemory::CLEARED);
