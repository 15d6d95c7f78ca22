//! Two slots of a flash that hold the rig, written in turn: whenever power fails, one of them is whole.
//!
//! In: a flash (any `embedded-storage` NOR flash) and where in it the two slots lie. Out: the newest rig that is whole and usable, and
//! what is wrong with the slots that hold none.
//!
//! ```text
//! load    both slots -> sequence numbers of whole images -> the newest one that decodes
//! store   erase the slot that is not in use, write the image with the next sequence number, read it back
//! ```
//!
//! The slot in use is never touched, and an image is whole only when its last bytes, the checksum, are written.
//!
//! # Bounds
//! Sequence numbers wrap: of two, the one that is less than 2^31 ahead is newer.
//!
//! # Cost
//! 512 bytes of stack and what [`RigImage::decode`] takes. A store erases once and writes each word once; an image that is in use already
//! is not written again.

use core::fmt;
use embedded_storage::nor_flash::{NorFlash, NorFlashError, NorFlashErrorKind};
use linestereo_rig::{RigImage, RigImageError, RigImageHead};
use linestereo_wire::RigFault;

/// Bytes read or written at once: an image, filled up to what the flash reads and writes.
const MOST_BYTES: usize = 512;

/// One of the two slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// The one that is written first.
    First,
    /// The other.
    Second,
}

impl Slot {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::First, Self::Second];

    /// The other one.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::First => Self::Second,
            Self::Second => Self::First,
        }
    }

    pub(crate) fn of<T>(self, [first, second]: &mut [T; 2]) -> &mut T {
        match self {
            Self::First => first,
            Self::Second => second,
        }
    }
}

impl fmt::Display for Slot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::First { "first slot" } else { "second slot" })
    }
}

/// Why a slot holds no usable rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SlotError {
    /// What lies there is refused.
    Image(RigImageError),
    /// The flash cannot be read.
    Flash(NorFlashErrorKind),
}

impl From<SlotError> for RigFault {
    fn from(error: SlotError) -> Self {
        match error {
            SlotError::Image(error) => error.into(),
            SlotError::Flash(_) => Self::Unreadable,
        }
    }
}

impl fmt::Display for SlotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Image(error) => error.fmt(f),
            Self::Flash(kind) => write!(f, "the flash cannot be read: {kind}"),
        }
    }
}

impl core::error::Error for SlotError {}

/// What the slots hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loaded {
    /// The newest usable rig and its slot; without one there is no depth.
    pub rig: Option<(Slot, RigImage)>,
    /// The sequence number of each slot's image, or what is wrong with it. An older image than the one in use is only known to be whole.
    pub slots: [Result<u32, SlotError>; 2],
}

/// Why an image is not stored. The rig that was in use still is, unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// The flash cannot be erased.
    Erase(NorFlashErrorKind),
    /// The flash cannot be written.
    Write(NorFlashErrorKind),
    /// What was written is not what is read: the flash is worn out.
    NotKept,
}

impl fmt::Display for StoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Erase(kind) => write!(f, "the flash cannot be erased: {kind}"),
            Self::Write(kind) => write!(f, "the flash cannot be written: {kind}"),
            Self::NotKept => write!(f, "the flash does not keep what is written"),
        }
    }
}

impl core::error::Error for StoreError {}

/// Why two slots cannot lie where they should.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayoutError {
    /// The flash reads or writes more than 512 bytes at once, or its sizes do not divide each other.
    Granularity,
    /// A slot does not start where the flash can erase.
    NotAligned(Slot),
    /// A slot ends beyond the flash.
    OutOfBounds(Slot),
    /// The slots share bytes that are erased together.
    Overlap,
}

impl fmt::Display for LayoutError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Granularity => write!(f, "the flash reads or writes in steps that no rig image fits into"),
            Self::NotAligned(slot) => write!(f, "the {slot} does not start where the flash can erase"),
            Self::OutOfBounds(slot) => write!(f, "the {slot} ends beyond the flash"),
            Self::Overlap => write!(f, "the two slots overlap"),
        }
    }
}

impl core::error::Error for LayoutError {}

/// [`RigStore`] over any flash.
pub trait RigKeeper {
    /// Looks for the newest usable rig.
    fn load(&mut self) -> Loaded;

    /// Keeps this rig, and says where. One that is in use already stays where it is.
    fn store(&mut self, image: &RigImage) -> Result<Slot, StoreError>;
}

/// The two slots in a flash.
#[derive(Debug)]
pub struct RigStore<F> {
    flash: F,
    starts: [u32; 2],
}

impl<F: NorFlash> RigStore<F> {
    /// Bytes read or written at once.
    const STEP: usize = if F::READ_SIZE > F::WRITE_SIZE { F::READ_SIZE } else { F::WRITE_SIZE };
    /// Bytes of an image with what fills its last step.
    const IMAGE: usize = RigImage::BYTES.next_multiple_of(Self::STEP);
    /// Bytes of a slot: they are erased together.
    pub const SLOT: u32 = Self::IMAGE.next_multiple_of(F::ERASE_SIZE) as u32;

    /// Slots that start at these addresses of the flash, each of [`RigStore::SLOT`] bytes.
    pub fn new(flash: F, starts: [u32; 2]) -> Result<Self, LayoutError> {
        let divides = |size: usize| Self::STEP.is_multiple_of(size);
        if Self::IMAGE > MOST_BYTES || !divides(F::READ_SIZE) || !divides(F::WRITE_SIZE) {
            return Err(LayoutError::Granularity);
        }
        for (slot, start) in Slot::BOTH.into_iter().zip(starts) {
            if !(start as usize).is_multiple_of(F::ERASE_SIZE) {
                return Err(LayoutError::NotAligned(slot));
            }
            if flash.capacity().checked_sub(start as usize).is_none_or(|rest| rest < Self::SLOT as usize) {
                return Err(LayoutError::OutOfBounds(slot));
            }
        }
        let [first, second] = starts;
        if first.abs_diff(second) < Self::SLOT { Err(LayoutError::Overlap) } else { Ok(Self { flash, starts }) }
    }

    /// The flash.
    pub fn into_flash(self) -> F {
        self.flash
    }

    fn decode(&mut self, slot: Slot) -> Result<RigImage, SlotError> {
        let mut bytes = [0; MOST_BYTES];
        RigImage::decode(self.read(slot, &mut bytes)?).map_err(SlotError::Image)
    }

    /// The bytes of a slot's image.
    fn read<'a>(&mut self, slot: Slot, memory: &'a mut [u8; MOST_BYTES]) -> Result<&'a [u8], SlotError> {
        let bytes = memory.get_mut(..Self::IMAGE).unwrap_or_default(); // `new` checked that it fits
        let start = *slot.of(&mut self.starts);
        self.flash.read(start, bytes).map_err(|error| SlotError::Flash(error.kind()))?;
        Ok(bytes.get(..RigImage::BYTES).unwrap_or_default())
    }
}

/// Not of what keeps it: the formatting of a flash's fields is 3 KB of every image, and nothing there prints it.
impl fmt::Debug for dyn RigKeeper + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("RigKeeper")
    }
}

impl<F: NorFlash> RigKeeper for RigStore<F> {
    fn load(&mut self) -> Loaded {
        let mut slots = Slot::BOTH.map(|slot| {
            let mut bytes = [0; MOST_BYTES];
            RigImageHead::check(self.read(slot, &mut bytes)?).map(|head| head.sequence).map_err(SlotError::Image)
        });
        let newest = match slots {
            [Ok(first), Ok(second)] if !is_newer(second, first) => Slot::First,
            [Ok(_), Err(_)] => Slot::First,
            _ => Slot::Second,
        };
        for slot in [newest, newest.other()] {
            let state = slot.of(&mut slots);
            if state.is_err() {
                continue;
            }
            match self.decode(slot) {
                Ok(rig) => return Loaded { rig: Some((slot, rig)), slots },
                Err(error) => *state = Err(error),
            }
        }
        Loaded { rig: None, slots }
    }

    fn store(&mut self, image: &RigImage) -> Result<Slot, StoreError> {
        let Loaded { rig, mut slots } = self.load();
        let (slot, sequence) = match rig {
            Some((used, same)) if is_same(&same, image) => return Ok(used),
            Some((used, _)) => (used.other(), used.of(&mut slots).map_or(0, |sequence| sequence.wrapping_add(1))),
            None => (Slot::First, 0),
        };
        let mut bytes = [0xff; MOST_BYTES];
        let bytes = bytes.get_mut(..Self::IMAGE).unwrap_or_default(); // `new` checked that it fits
        if let Some(start) = bytes.first_chunk_mut() {
            *start = image.encode(sequence);
        }
        let start = *slot.of(&mut self.starts);
        self.flash.erase(start, start + Self::SLOT).map_err(|error| StoreError::Erase(error.kind()))?;
        self.flash.write(start, bytes).map_err(|error| StoreError::Write(error.kind()))?;
        match self.load().rig {
            Some((used, kept)) if used == slot && is_same(&kept, image) => Ok(slot),
            _ => Err(StoreError::NotKept),
        }
    }
}

/// Are two rigs the same bytes?
fn is_same(one: &RigImage, other: &RigImage) -> bool {
    one.encode(0) == other.encode(0)
}

/// Is a sequence number newer than another? Those of two slots are never far apart.
fn is_newer(a: u32, than: u32) -> bool {
    a != than && a.wrapping_sub(than) < 1 << 31
}
