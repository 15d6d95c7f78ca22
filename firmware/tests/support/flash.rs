//! A flash that loses power.

use crate::support::random::Random;
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use linestereo_firmware::slot_store::BoardStore;

/// A flash stricter than hardware: it panics where hardware would do something undefined, and its
/// power fails on demand.
///
/// Words that an interrupted write or erase was at hold garbage; so does an erased block beyond the
/// place where its erase was stopped.
#[derive(Clone, Debug)]
pub(crate) struct Flash<const READ: usize, const WRITE: usize, const ERASE: usize> {
    pub(crate) bytes: Vec<u8>,
    /// Was this word written since it was erased?
    is_written: Vec<bool>,
    /// Bytes that can still be erased or written.
    power: usize,
    pub(crate) erases: u32,
    random: Random,
    /// Reads of these addresses fail, as they do where error correction gives up.
    pub(crate) unreadable: core::ops::Range<usize>,
    /// Bits stay 1 where 0 is written.
    pub(crate) is_worn: bool,
}

pub(crate) const UNLIMITED: usize = usize::MAX;

impl<const READ: usize, const WRITE: usize, const ERASE: usize> Flash<READ, WRITE, ERASE> {
    pub(crate) fn new(blocks: usize) -> Self {
        let size = blocks * ERASE;
        // Not erased: what is there is nobody's.
        let bytes = (0..size).map(|at| (at * 7) as u8).collect();
        let is_written = vec![true; size / WRITE];
        Self {
            bytes,
            is_written,
            power: UNLIMITED,
            erases: 0,
            random: Random(9),
            unreadable: 0..0,
            is_worn: false,
        }
    }

    /// The same flash with power for so many bytes, and bad luck of its own.
    pub(crate) fn with_power(&self, power: usize) -> Self {
        Self { power, random: Random(power as u64), ..self.clone() }
    }

    /// Takes power for so many bytes, and says for how many it suffices.
    fn spend(&mut self, bytes: usize) -> usize {
        let spent = bytes.min(self.power);
        if self.power != UNLIMITED {
            self.power -= spent;
        }
        spent
    }

    fn garbage(&mut self, range: core::ops::Range<usize>) {
        self.bytes[range].fill_with(|| self.random.below(256) as u8);
    }

    /// The image that lies at this address, written there by somebody else.
    pub(crate) fn put(&mut self, start: usize, bytes: &[u8]) {
        self.erase(start as u32, (start + bytes.len().next_multiple_of(ERASE)) as u32).unwrap();
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(WRITE), 0xff);
        self.write(start as u32, &padded).unwrap();
    }
}

impl<const READ: usize, const WRITE: usize, const ERASE: usize> ErrorType
    for Flash<READ, WRITE, ERASE>
{
    type Error = NorFlashErrorKind;
}

impl<const READ: usize, const WRITE: usize, const ERASE: usize> ReadNorFlash
    for Flash<READ, WRITE, ERASE>
{
    const READ_SIZE: usize = READ;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        let start = offset as usize;
        assert!(
            start.is_multiple_of(READ) && bytes.len().is_multiple_of(READ),
            "an unaligned read"
        );
        if self.power == 0 || self.unreadable.contains(&start) {
            return Err(NorFlashErrorKind::Other);
        }
        bytes.copy_from_slice(&self.bytes[start..start + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl<const READ: usize, const WRITE: usize, const ERASE: usize> NorFlash
    for Flash<READ, WRITE, ERASE>
{
    const WRITE_SIZE: usize = WRITE;
    const ERASE_SIZE: usize = ERASE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        let (from, to) = (from as usize, to as usize);
        assert!(
            from.is_multiple_of(ERASE) && to.is_multiple_of(ERASE) && from < to,
            "an unaligned erase"
        );
        assert!(to <= self.bytes.len(), "an erase beyond the flash");
        self.erases += 1;
        let done = from + self.spend(to - from);
        self.bytes[from..done].fill(0xff);
        if done < to {
            // A block is not erased byte by byte: half of the time nothing of the old content is
            // left, half of the time all.
            if self.random.below(2) == 0 {
                self.garbage(done..to);
            }
            self.is_written[from / WRITE..to / WRITE].fill(true); // to be erased again
            return Err(NorFlashErrorKind::Other);
        }
        self.is_written[from / WRITE..to / WRITE].fill(false);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        let start = offset as usize;
        assert!(
            start.is_multiple_of(WRITE) && bytes.len().is_multiple_of(WRITE),
            "an unaligned write"
        );
        assert!(start + bytes.len() <= self.bytes.len(), "a write beyond the flash");
        let words = start / WRITE..(start + bytes.len()) / WRITE;
        assert!(
            self.is_written[words.clone()].iter().all(|is_written| !is_written),
            "a write without an erase"
        );
        let done = self.spend(bytes.len());
        let whole = done - done % WRITE;
        self.bytes[start..start + whole].copy_from_slice(&bytes[..whole]);
        self.is_written[words].fill(true);
        if self.is_worn {
            self.bytes[start + 11] |= 1; // of the number, which is small
        }
        if done < bytes.len() {
            if done > whole {
                self.garbage(start + whole..start + whole + WRITE);
            }
            return Err(NorFlashErrorKind::Other);
        }
        Ok(())
    }
}

const BLOCK: u32 = 512;

/// Four blocks: two slots for rigs, then two for settings.
impl Flash<1, 4, { BLOCK as usize }> {
    pub(crate) fn empty() -> Self {
        let mut flash = Self::new(4);
        flash.erase(0, 4 * BLOCK).unwrap();
        flash
    }

    /// Empty but for these bytes in the second slot for rigs.
    pub(crate) fn with_second_rig(bytes: &[u8]) -> Self {
        let mut flash = Self::empty();
        flash.put(BLOCK as usize, bytes);
        flash
    }

    pub(crate) fn store(self) -> BoardStore<Self> {
        BoardStore::new(self, [0, BLOCK], [2 * BLOCK, 3 * BLOCK]).unwrap()
    }
}
