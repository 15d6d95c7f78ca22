//! The boards: one file each, with what it can hold and what its peripherals are. `docs/porting.md` adds one.

pub mod capacities;

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
pub mod pipes;
#[cfg(any(not(target_os = "none"), feature = "rp235x"))]
pub mod rp235x;
#[cfg(all(target_os = "none", feature = "hardware"))]
pub mod usb_port;

use linestereo::Dims;

/// Every board by its feature and its file, the default one first. [`selected`] is the one that is built.
macro_rules! boards {
    ($($feature:literal $board:ident)*) => {
        impl Board {
            /// Every board, the default one first.
            pub const ALL: [Self; [$($feature),*].len()] = [$($board::BOARD),*];
        }

        $(
            /// The board that is built.
            #[cfg(all(target_os = "none", feature = $feature))]
            pub use $board as selected;
        )*
    };
}

/// On a PC the default one.
#[cfg(not(target_os = "none"))]
pub use mps2_an500 as selected;

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

/// What a program or a PC has to know of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// Its name: of the feature that builds for it, of `--on`.
    pub name: &'static str,
    /// Its processor.
    pub processor: &'static str,
    /// What rustc calls it.
    pub target: &'static str,
    /// What runs its programs.
    pub device: Device,
    /// The largest pair: frames may be no wider than this and have no more pixels.
    pub largest: Dims,
    /// Segments it lists per image.
    pub segments: usize,
    /// Widest raw image that it rectifies.
    pub raw_width: usize,
    /// Bytes of raw rows that it holds of each camera.
    pub band: usize,
    /// Sizes of the built-in frames.
    pub sizes: &'static [Dims],
}

/// What runs a board's programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Device {
    /// QEMU: the program, and the arguments that choose the machine.
    Qemu {
        /// Such as `qemu-system-arm`.
        program: &'static str,
        /// Such as `-machine mps2-an500`.
        arguments: &'static [&'static str],
    },
    /// Silicon: the name of the chip for probe-rs.
    Chip(&'static str),
}

impl Board {
    /// The two whose every program is run and measured: the classes of processors that the core is made for. The others show that bits are
    /// the same elsewhere.
    pub const MEASURED: [Self; 2] = [mps2_an500::BOARD, mps2_an386::BOARD];

    /// The board of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|board| board.name == name)
    }

    /// Those that QEMU runs.
    pub fn emulated() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(Self::is_emulated)
    }

    /// Does QEMU run it?
    #[must_use]
    pub const fn is_emulated(&self) -> bool {
        matches!(self.device, Device::Qemu { .. })
    }

    /// Does it hold pairs of this size?
    #[must_use]
    pub fn fits(&self, dims: Dims) -> bool {
        dims.width <= self.largest.width && pixels(dims) <= pixels(self.largest)
    }
}

const fn pixels(dims: Dims) -> usize {
    dims.width as usize * dims.height as usize
}
