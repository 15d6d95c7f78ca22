//! Caches on, and what must not be cached or read.
//!
//! ```text
//! 0x3000_0000, 512 KiB   SRAM of domain 2, into which the camera's DMA writes: not cached, so that
//!                        nothing has to be invalidated
//! 0x0818_0000, 512 KiB   the sectors of the rig and of settings: what was written is what is read
//! 0x6000_0000, 1 GiB     external memories: no access. By default they are normal memory, where
//!                        the processor may read ahead, and a controller that is off may not answer
//! ```
//! The alternative to the first, invalidating each row before it is copied, is two more ways to be
//! wrong: lines that rows share, and lines that speculative reads bring back. A row is read once,
//! so a cache would gain little: words of a copy come in bursts.
//!
//! # Source
//! Armv7-M reference manual (DDI 0403E), B3.1 (default memory map), B3.5 (memory protection unit);
//! RM0433 and RM0399: memory map, RCC_AHB2ENR; AN4838: reading ahead in external memories.

use cortex_m::peripheral::{CPUID, MPU, SCB};
use embassy_stm32::pac::{DBGMCU, RCC};

/// Regions of the memory protection unit; the highest number counts where they overlap. The lowest
/// are the stacks' (`firmware/src/arch`), and the others were cleared there.
const EXTERNAL_REGIONS: [u32; 2] = [12, 13];
const KEPT_REGION: u32 = 14;
const RINGS_REGION: u32 = 15;

/// To be called once, before caches, interrupts and DMA are used: takes over from a bootloader as
/// well.
pub fn prepare() {
    read_axi_sram_one_at_a_time();
    unsafe extern "C" {
        static __vector_table: u32;
    }
    // SAFETY: nothing else has these peripherals, no interrupt is enabled yet, and the regions are
    // those of the memory map: what lies in them is used by the camera's DMA and by the flash that
    // keeps the rig and settings alone. The vector table is that of cortex-m-rt.
    unsafe {
        let scb = &*SCB::PTR;
        scb.vtor.write((&raw const __vector_table).addr() as u32);
        let mut caches = Caches::steal();
        caches.0.disable_dcache(&mut caches.1); // a bootloader's; written back
        for (region, address) in EXTERNAL_REGIONS.into_iter().zip([0x6000_0000, 0x8000_0000]) {
            protect(region, address, 512 << 20, NO_ACCESS);
        }
        protect(KEPT_REGION, super::kept::FIRST_ADDRESS, 4 * super::kept::SECTOR, NOT_CACHED);
        protect(RINGS_REGION, 0x3000_0000, 512 * 1024, NOT_CACHED);
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
        caches.0.enable_icache();
        caches.0.enable_dcache(&mut caches.1);
        cortex_m::interrupt::enable(); // a bootloader may have masked them; each is enabled by its driver
    }
    RCC.ahb2enr().modify(|enable| {
        enable.set_sram1en(true);
        enable.set_sram2en(true);
        enable.set_sram3en(true);
    });
    let _ = RCC.ahb2enr().read(); // the clock runs after a read (RM0433, section 8.5.10)
}

/// Revision Y and older may read wrong data from the AXI SRAM while two requests are open (ES0392,
/// 2.2.9); ST's `SystemInit` does the same.
fn read_axi_sram_one_at_a_time() {
    /// Revisions from X on read right.
    const X: u32 = 0x2000;
    /// AXI_TARG7_FN_MOD, bit 0: READ_ISS_OVERRIDE.
    const TARGET_7: *mut u32 = core::ptr::with_exposed_provenance_mut(0x5100_8108);
    if u32::from(DBGMCU.idc().read().rev_id()) < X {
        // SAFETY: a register that nothing else writes.
        unsafe { TARGET_7.write_volatile(1) };
    }
}

struct Caches(SCB, CPUID);

impl Caches {
    /// # Safety
    /// Nobody else uses the caches' registers meanwhile.
    unsafe fn steal() -> Self {
        // SAFETY: as the caller says.
        let peripherals = unsafe { cortex_m::Peripherals::steal() };
        Self(peripherals.SCB, peripherals.CPUID)
    }
}

/// Never executed, not accessible (MPU_RASR, B3.5.9).
const NO_ACCESS: u32 = 1 << 28;

/// Never executed, everybody reads and writes; normal memory, TEX = 1, shared, not cached, not
/// buffered.
const NOT_CACHED: u32 = 1 << 28 | 0b011 << 24 | 1 << 19 | 1 << 18;

/// Gives a region of memory these attributes.
///
/// # Safety
/// Everything in the region is used as the attributes allow. `bytes` is a power of two and divides
/// `address`.
unsafe fn protect(region: u32, address: u32, bytes: u32, attributes: u32) {
    /// The address and the number of the region are those given (B3.5.8).
    const VALID: u32 = 1 << 4;
    const ENABLE: u32 = 1;
    let size = (bytes.trailing_zeros() - 1) << 1;
    // SAFETY: as the caller says.
    unsafe {
        let mpu = &*MPU::PTR;
        mpu.rbar.write(address | VALID | region);
        mpu.rasr.write(attributes | size | ENABLE);
    }
}
