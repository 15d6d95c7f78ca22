//! Descriptions of the boards: name, target, what runs their programs, what they hold, how programs
//! end; and the pairs that are built into those programs.
//!
//! Their peripherals and their memory are `firmware/src/boards`; `docs/porting.md` adds one.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![deny(missing_debug_implementations)]

pub mod built_in;
mod exit;

pub use exit::Exit;
use linestereo::Dims;

/// Description of a board: name, processor, target, capacities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Board {
    /// Its name: of the feature that builds for it, of `--board`.
    pub name: &'static str,
    /// Its processor.
    pub processor: &'static str,
    /// Target, as rustc names it.
    pub target: &'static str,
    /// Emulator or chip that runs its programs.
    pub device: Device,
    /// The largest pair: frames may be no wider than this and have no more pixels.
    pub largest: Dims,
    /// Segments it lists per image.
    pub segments: usize,
    /// It matches pairs on two cores.
    pub two_cores: bool,
    /// Width of the widest raw image that it rectifies, px.
    pub raw_width: usize,
    /// Bytes of raw rows that it holds of each camera.
    pub band: usize,
    /// Sizes of the built-in frames.
    pub sizes: &'static [Dims],
}

/// Emulator or chip that runs a board's programs.
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

const QVGA: Dims = Dims { width: 320, height: 240 };
const QQVGA: Dims = Dims { width: 160, height: 120 };
/// Sizes of the built-in frames beside the largest.
const SMALL: Dims = Dims { width: 128, height: 96 };

const ARMV7: &str = "thumbv7em-none-eabihf";
const ARMV8: &str = "thumbv8m.main-none-eabihf";

/// A board with memory for pairs of 320x240: 290 KiB with frames and rectifiers, beside the stack.
/// On hardware raw images are as wide as the sensors', 320 px, and the bands suffice for a strong
/// barrel of 110 degrees and cameras turned by 2 degrees (11 KiB); emulated boards take images half
/// as wide again.
const fn qvga(
    name: &'static str,
    processor: &'static str,
    target: &'static str,
    device: Device,
) -> Board {
    let (raw_width, band) = match device {
        Device::Qemu { .. } => (480, 12 * 1024 + 512),
        Device::Chip(_) => (320, 12 * 1024),
    };
    Board {
        name,
        processor,
        target,
        device,
        largest: QVGA,
        segments: 640,
        two_cores: false,
        raw_width,
        band,
        sizes: &[QVGA, SMALL],
    }
}

/// A machine of `qemu-system-arm`.
const fn arm(arguments: &'static [&'static str; 2]) -> Device {
    Device::Qemu { program: "qemu-system-arm", arguments }
}

impl Board {
    /// QEMU's machine with a Cortex-M7.
    pub const MPS2_AN500: Self =
        qvga("mps2-an500", "Cortex-M7", ARMV7, arm(&["-machine", "mps2-an500"]));
    /// QEMU's machine with a Cortex-M4, and memory for pairs of 160x120: 144 KiB with frames and
    /// rectifiers, beside the stack.
    pub const MPS2_AN386: Self = Self {
        largest: QQVGA,
        segments: 256,
        raw_width: 640,
        band: 24 * 1024,
        sizes: &[QQVGA, SMALL],
        ..qvga("mps2-an386", "Cortex-M4", ARMV7, arm(&["-machine", "mps2-an386"]))
    };
    /// QEMU's machine with a Cortex-M33.
    pub const MPS2_AN505: Self =
        qvga("mps2-an505", "Cortex-M33", ARMV8, arm(&["-machine", "mps2-an505"]));
    /// QEMU's machine with a Cortex-M55.
    pub const MPS3_AN547: Self =
        qvga("mps3-an547", "Cortex-M55", ARMV8, arm(&["-machine", "mps3-an547"]));
    /// QEMU's machine with a RISC-V processor.
    pub const RISCV_VIRT: Self = qvga(
        "riscv-virt",
        "RV32IMAC",
        "riscv32imac-unknown-none-elf",
        Device::Qemu {
            program: "qemu-system-riscv32",
            arguments: &["-machine", "virt", "-bios", "none"],
        },
    );
    /// Raspberry Pi Pico 2.
    pub const PICO2: Self =
        Self { two_cores: true, ..qvga("pico2", "Cortex-M33", ARMV8, Device::Chip("RP235x")) };
    /// Boards with an STM32H743.
    pub const STM32H743: Self =
        qvga("stm32h743", "Cortex-M7", ARMV7, Device::Chip("STM32H743ZITx"));
    /// Arduino Portenta H7.
    pub const PORTENTA_H7: Self =
        qvga("portenta-h7", "Cortex-M7", ARMV7, Device::Chip("STM32H747XIHx"));

    /// Every board, the default one first.
    pub const ALL: [Self; 8] = [
        Self::MPS2_AN500,
        Self::MPS2_AN386,
        Self::MPS2_AN505,
        Self::MPS3_AN547,
        Self::RISCV_VIRT,
        Self::PICO2,
        Self::STM32H743,
        Self::PORTENTA_H7,
    ];

    /// The two whose every program is run and measured: the classes of processors that the core is
    /// made for. The others show that bits are the same elsewhere.
    pub const MEASURED: [Self; 2] = [Self::MPS2_AN500, Self::MPS2_AN386];

    /// The board of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|board| board.name == name)
    }

    /// Those that QEMU runs.
    pub fn emulated() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(Self::is_emulated)
    }

    /// Does QEMU run it?
    pub const fn is_emulated(&self) -> bool {
        matches!(self.device, Device::Qemu { .. })
    }

    /// Pixels of its largest image.
    pub const fn pixels(&self) -> usize {
        pixels(self.largest)
    }

    /// Does it hold pairs of this size?
    pub fn fits(&self, dims: Dims) -> bool {
        dims.width <= self.largest.width && pixels(dims) <= self.pixels()
    }
}

const fn pixels(dims: Dims) -> usize {
    dims.width as usize * dims.height as usize
}

/// The example of the package's page.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
