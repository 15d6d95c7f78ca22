//! Identification of the chip, its clock, wait states and caches, for a host that records the cost
//! of a pair.
//!
//! # Source
//! RP2350 datasheet: 4.4 (XIP cache, XIP_CTRL), 12.14 (QMI, M0_TIMING), 12.15.1 (SYSINFO).

use crate::boards::cycles::processor_id;
use embassy_rp::clocks::clk_sys_freq;
use embassy_rp::pac::{QMI, SYSINFO, XIP_CTRL};
use linestereo_wire::Silicon;

/// The registers as they are now. The chip has one cache, before the flash, for code and tables
/// alike.
pub fn silicon() -> Silicon {
    let has_cache = XIP_CTRL.ctrl().read().en_secure();
    Silicon {
        processor_id: processor_id(),
        chip_id: SYSINFO.chip_id().read().0,
        core_hz: clk_sys_freq(),
        flash_wait: QMI.mem(0).timing().read().clkdiv(),
        instruction_cache: has_cache,
        data_cache: has_cache,
    }
}
