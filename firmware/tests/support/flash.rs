//! A flash of four blocks: two slots for rigs, then two for settings.

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use linestereo_firmware::slot_store::BoardStore;

const BLOCK: u32 = 512;

#[derive(Clone, Debug)]
pub(crate) struct Flash {
    bytes: Vec<u8>,
    /// Takes nothing, and does not say so.
    pub(crate) is_stuck: bool,
}

impl Flash {
    pub(crate) fn empty() -> Self {
        Self { bytes: vec![0xff; 4 * BLOCK as usize], is_stuck: false }
    }

    /// Empty but for these bytes in the second slot for rigs.
    pub(crate) fn with_second_rig(bytes: &[u8]) -> Self {
        let mut flash = Self::empty();
        flash.write(BLOCK, bytes).unwrap();
        flash
    }

    pub(crate) fn store(self) -> BoardStore<Self> {
        BoardStore::new(self, [0, BLOCK], [2 * BLOCK, 3 * BLOCK]).unwrap()
    }
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        bytes.copy_from_slice(&self.bytes[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = BLOCK as usize;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        if !self.is_stuck {
            self.bytes[from as usize..to as usize].fill(0xff);
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        if !self.is_stuck {
            for (old, new) in self.bytes[offset as usize..].iter_mut().zip(bytes) {
                *old &= new;
            }
        }
        Ok(())
    }
}
