//! The rig in the last two sectors of the QSPI flash, settings in the two before them.
//!
//! A store stops every interrupt for as long as the flash erases and programs, some 50 ms (400 ms
//! at most: W25Q32JV datasheet, tSE), because nothing can be read from it meanwhile: rows that come
//! then are lost, and said to be.

use crate::slot_store::BoardStore;
use embassy_rp::Peri;
use embassy_rp::flash::{Blocking, ERASE_SIZE, Flash};
use embassy_rp::peripherals::FLASH;
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// The board's flash of so many bytes.
#[expect(missing_debug_implementations, reason = "the HAL's driver has none")]
pub struct BoardFlash<const BYTES: usize>(Flash<'static, FLASH, Blocking, BYTES>);

/// Where such a board keeps its rig and its settings.
pub type Kept<const BYTES: usize> = BoardStore<BoardFlash<BYTES>>;

/// Two slots for each, the rig's in the last two sectors.
pub fn keeper<const BYTES: usize>(flash: Peri<'static, FLASH>) -> Option<Kept<BYTES>> {
    let (end, sector) = (BYTES as u32, ERASE_SIZE as u32);
    let [settings, rig] =
        [4, 2].map(|sectors| [end - sectors * sector, end - (sectors - 1) * sector]);
    BoardStore::new(BoardFlash(Flash::new_blocking(flash)), rig, settings).ok()
}

impl<const BYTES: usize> ErrorType for BoardFlash<BYTES> {
    type Error = embassy_rp::flash::Error;
}

impl<const BYTES: usize> ReadNorFlash for BoardFlash<BYTES> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.0.blocking_read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

/// Written in whole pages: what a page has beside the bytes is written as ones, which changes
/// nothing.
impl<const BYTES: usize> NorFlash for BoardFlash<BYTES> {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.0.blocking_erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        self.0.blocking_write(offset, bytes)
    }
}
