//! A file of the PC in place of flash, which QEMU's mps2 machines do not have. It stays when the
//! machine ends, as flash does.

use crate::ports::{ByteSink as _, ByteSource as _};
use crate::semihosting::{CannotOpen, File, Mode};
use crate::slot_store::BoardStore;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

/// Two slots for the rig and two for settings, of one block each: the file has as many bytes.
pub const BYTES: usize = 4 * FlashFile::ERASE_SIZE;

/// Flash of 512-byte blocks and 8-byte words in a file. What the file cannot do, a full disk for
/// example, is an error as of worn flash.
#[derive(Debug)]
pub struct FlashFile {
    file: File,
    bytes: usize,
}

impl FlashFile {
    /// The slots in the file of this name.
    pub fn slots(name: &[u8]) -> Result<BoardStore<Self>, CannotOpen> {
        let file = File::open(name, Mode::Change)?;
        let bytes = file.length() as usize;
        let [first, second, third, fourth] =
            [0, 1, 2, 3].map(|block| block * Self::ERASE_SIZE as u32);
        BoardStore::new(Self { file, bytes }, [first, second], [third, fourth])
            .map_err(|_| CannotOpen)
    }

    fn seek(&mut self, offset: u32) -> Result<(), NorFlashErrorKind> {
        if self.file.seek(offset) { Ok(()) } else { Err(NorFlashErrorKind::Other) }
    }
}

impl ErrorType for FlashFile {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for FlashFile {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        check_read(self, offset, bytes.len())?;
        self.seek(offset)?;
        if self.file.read(bytes) == bytes.len() { Ok(()) } else { Err(NorFlashErrorKind::Other) }
    }

    fn capacity(&self) -> usize {
        self.bytes
    }
}

impl NorFlash for FlashFile {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = 512;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        check_erase(self, from, to)?;
        self.seek(from)?;
        for _ in (from..to).step_by(Self::WRITE_SIZE) {
            self.file.write(&[0xff; Self::WRITE_SIZE]);
        }
        Ok(())
    }

    /// Only clears bits, as flash does.
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        check_write(self, offset, bytes.len())?;
        for (word, at) in bytes.chunks(Self::WRITE_SIZE).zip((offset..).step_by(Self::WRITE_SIZE)) {
            let mut there = [0; Self::WRITE_SIZE];
            self.read(at, &mut there)?;
            for (there, byte) in there.iter_mut().zip(word) {
                *there &= byte;
            }
            self.seek(at)?;
            self.file.write(&there);
        }
        Ok(())
    }
}
