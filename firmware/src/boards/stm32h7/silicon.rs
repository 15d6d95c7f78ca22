//! Identification of the chip, its clock, wait states and caches, for a host that records the cost
//! of a pair.
//!
//! # Source
//! RM0433, sections 4.9.1 (FLASH_ACR) and 60.5.8 (DBGMCU_IDC).

use super::clocks::MicrosecondClock;
use super::ports::HostPort;
use super::reset::IndependentDog;
use crate::boards::cycles::{CycleCounter, processor_id};
use crate::ports::BarePeripherals;
use cortex_m::peripheral::SCB;
use embassy_stm32::pac::{DBGMCU, FLASH};
use embassy_stm32::peripherals::RCC;
use embassy_stm32::{Peri, rcc};
use linestereo_wire::{Reset, Silicon};

/// Peripherals of a board with one of these chips, for `selftest`.
pub type Bare = BarePeripherals<CycleCounter, MicrosecondClock, HostPort, IndependentDog>;

/// The registers as they are now.
fn silicon(core_hz: u32) -> Silicon {
    Silicon {
        processor_id: processor_id(),
        chip_id: DBGMCU.idc().read().0,
        core_hz,
        flash_wait: FLASH.acr().read().latency(),
        instruction_cache: SCB::icache_enabled(),
        data_cache: SCB::dcache_enabled(),
    }
}

/// Around what the board has started.
pub fn bare(
    clocks: Peri<'static, RCC>,
    host: HostPort,
    watchdog: IndependentDog,
    reset: Option<Reset>,
) -> Bare {
    let core_hz = rcc::clocks(&clocks).sys.to_hertz().map_or(0, |frequency| frequency.0);
    BarePeripherals {
        counter: CycleCounter::start(core_hz),
        clock: MicrosecondClock,
        host,
        watchdog,
        rest: cortex_m::asm::wfe,
        reset,
        silicon: Some(silicon(core_hz)),
    }
}
