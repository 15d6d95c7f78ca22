//! Records of the program `selftest`: the machine, and of each built-in pair the digests and the
//! cost of each stage.

use heapless::String;
use linestereo::unstable::Stage;
use serde::{Deserialize, Serialize};

/// Digests of a built-in pair: one per stage, and one of what an autopilot gets.
pub const DIGESTS: usize = Stage::ALL.len() + 1;

/// Machine: firmware, processor, clock, wait states, caches; sent by `selftest` after each `Hello`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MachineReport {
    /// Version of the firmware.
    pub firmware: String<24>,
    /// Unit of the costs of its pairs: `cycles` of the core's own counter (DWT_CYCCNT),
    /// `instructions` of an emulator.
    pub unit: String<16>,
    /// Built-in pairs, which `Request::RunCase` counts from 0.
    pub cases: u16,
    /// FNV-1a of the digests that the firmware was built with: another one for another version of
    /// the method.
    pub expected: u32,
    /// The chip and how it is set up; `None` on an emulated board.
    pub silicon: Option<Silicon>,
}

/// A chip and how it is set up, as its registers say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Silicon {
    /// Identification of the processor with its revision: CPUID.
    pub processor_id: u32,
    /// Identification of the chip with its revision: DBGMCU_IDCODE of an STM32, SYSINFO CHIP_ID of
    /// an RP2350.
    pub chip_id: u32,
    /// Clock of the core as it was set, Hz.
    pub core_hz: u32,
    /// Wait states of the flash; of one on a serial bus, clocks of the core per clock of the bus.
    pub flash_wait: u8,
    /// Is the instruction cache on? On an RP2350, that of its flash.
    pub instruction_cache: bool,
    /// Is the data cache on? On an RP2350, that of its flash, which RAM does without.
    pub data_cache: bool,
}

/// A built-in pair that was matched.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CaseReport {
    /// Its number.
    pub case: u16,
    /// Its name, such as `bricks_320x240`.
    pub name: String<40>,
    /// Segments of the left image.
    pub segments: u16,
    /// Costs of the stages in the order of [`Stage::ALL`], of the second of two runs.
    pub costs: [u64; Stage::ALL.len()],
    /// Cost of that run as a whole, which includes reading the counter after each step.
    pub total: u64,
    /// Time of that run by another clock of the board, microseconds.
    pub time_us: u32,
    /// Digests of the first run, in the order of [`Stage::ALL`], then of what an autopilot gets.
    pub digests: [u32; DIGESTS],
}
