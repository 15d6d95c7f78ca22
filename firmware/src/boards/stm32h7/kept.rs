//! Sectors of the flash that keep the rig and settings: of bank 2 the last two and the two before
//! them.
//!
//! The program runs from bank 1, so that it goes on while a sector is erased (1 to 4 s) and only
//! the command that asked for it waits.
//!
//! Power may fail while a word of 32 bytes is written. Such a word cannot be corrected, and reading
//! it is a bus fault: it is read with bus faults ignored, and the flash's own flag says that it is
//! of no use. Memory protection, which keeps the sectors out of the cache, stays on meanwhile:
//! without HFNMIENA it would be off, and what is read would be what lay there before.
//!
//! # Source
//! RM0433, sections 4.3 (sectors, words, reading while the other bank is written) and 4.7.5 (double
//! errors: bus error and DBECCERR); Armv7-M reference manual, B1.4.3 (FAULTMASK), B3.2.8
//! (CCR.BFHFNMIGN), B3.2.15 (CFSR) and B3.5.5 (MPU_CTRL.HFNMIENA).

use crate::slot_store::BoardStore;
use core::arch::asm;
use cortex_m::peripheral::{MPU, SCB};
use embassy_stm32::flash::{Blocking, Flash};
use embassy_stm32::{Peri, pac, peripherals};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError as _, NorFlashErrorKind, ReadNorFlash, check_read,
};

/// Bytes of a sector.
pub const SECTOR: u32 = 128 * 1024;
/// Where flash begins, and where the four sectors do: first those of the settings.
const FLASH: u32 = 0x0800_0000;
const FIRST: u32 = 2 * 1024 * 1024 - 4 * SECTOR;
/// Address of the first of the four.
pub const FIRST_ADDRESS: u32 = FLASH + FIRST;
/// Bank 2.
const BANK: usize = 1;

/// The flash, of which only bank 2 is read and written here.
#[expect(missing_debug_implementations, reason = "the HAL's driver has none")]
pub struct KeptFlash(Flash<'static, Blocking>);

impl KeptFlash {
    /// Two slots for each.
    pub fn slots(peripheral: Peri<'static, peripherals::FLASH>) -> Option<BoardStore<Self>> {
        let [settings, rig] = [FIRST, FIRST + 2 * SECTOR].map(|first| [first, first + SECTOR]);
        BoardStore::new(Self(Flash::new_blocking(peripheral)), rig, settings).ok()
    }
}

impl ErrorType for KeptFlash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for KeptFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        clear_errors();
        // SAFETY: `check_read` says that the bytes lie in the flash.
        unsafe { copy_ignoring_faults((FLASH + offset) as usize, bytes) };
        let is_broken = pac::FLASH.bank(BANK).sr().read().dbeccerr();
        clear_errors();
        if is_broken { Err(NorFlashErrorKind::Other) } else { Ok(()) }
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for KeptFlash {
    const WRITE_SIZE: usize = <Flash<'static, Blocking> as NorFlash>::WRITE_SIZE;
    const ERASE_SIZE: usize = <Flash<'static, Blocking> as NorFlash>::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        clear_errors();
        erase_in_parallel();
        self.0.erase(from, to).map_err(|error| error.kind())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        clear_errors();
        self.0.write(offset, bytes).map_err(|error| error.kind())
    }
}

/// Makes bank 2 erase 64 bits at once (PSIZE), which is the fastest: its registers stay unlocked
/// until the HAL has erased.
fn erase_in_parallel() {
    let bank = pac::FLASH.bank(BANK);
    if bank.cr().read().lock() {
        bank.keyr().write_value(0x4567_0123);
        bank.keyr().write_value(0xcdef_89ab);
    }
    bank.cr().modify(|control| control.set_psize(3));
}

/// Old errors would be taken for those of what follows: the HAL does not clear them.
fn clear_errors() {
    pac::FLASH.bank(BANK).ccr().write(|clear| {
        clear.set_clr_wrperr(true);
        clear.set_clr_pgserr(true);
        clear.set_clr_strberr(true);
        clear.set_clr_incerr(true);
        clear.set_clr_operr(true);
        clear.set_clr_rdperr(true); // of protected areas, which the processor reads ahead into
        clear.set_clr_rdserr(true);
        clear.set_clr_crcrderr(true);
        clear.set_clr_sneccerr(true);
        clear.set_clr_dbeccerr(true);
    });
}

/// Copies bytes while bus faults of loads are ignored.
///
/// # Safety
/// The bytes from this address on are memory that may be read.
unsafe fn copy_ignoring_faults(address: usize, bytes: &mut [u8]) {
    /// CCR: handlers of the highest priorities ignore bus faults of data.
    const BFHFNMIGN: u32 = 1 << 8;
    /// MPU_CTRL: protection counts for these handlers too.
    const HFNMIENA: u32 = 1 << 1;
    /// CFSR: what bus faults leave; a bit that is written is cleared.
    const BUS_FAULTS: u32 = 0xff00;
    // SAFETY: nothing else changes CCR and MPU_CTRL while FAULTMASK holds all handlers back, as
    // which this code counts meanwhile; all are as before afterwards. The source is memory, as the
    // caller says.
    unsafe {
        let (scb, mpu) = (&*SCB::PTR, &*MPU::PTR);
        mpu.ctrl.modify(|control| control | HFNMIENA);
        asm!("cpsid f", options(nostack, preserves_flags));
        scb.ccr.modify(|ccr| ccr | BFHFNMIGN);
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
        core::ptr::with_exposed_provenance::<u8>(address)
            .copy_to_nonoverlapping(bytes.as_mut_ptr(), bytes.len());
        cortex_m::asm::dsb();
        scb.ccr.modify(|ccr| ccr & !BFHFNMIGN);
        scb.cfsr.write(BUS_FAULTS); // or the next fault would be taken for one at this address
        asm!("cpsie f", options(nostack, preserves_flags));
        mpu.ctrl.modify(|control| control & !HFNMIENA);
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
    }
}
