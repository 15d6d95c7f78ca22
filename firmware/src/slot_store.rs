//! Two slots of a flash for the rig and two for settings, written in turn: whenever power fails,
//! one of them is whole.
//!
//! In: a flash (any `embedded-storage` NOR flash) and where in it the two slots lie. Out: the
//! newest image that is whole and usable, and what is wrong with the slots that hold none.
//!
//! ```text
//! load    both slots -> sequence numbers of whole images -> the newest one that decodes
//! store   erase the slot that is not in use, write the image with the next sequence number, read
//!         it back
//! ```
//!
//! The slot in use is never touched, and an image is whole only when its last bytes, the checksum,
//! are written.
//!
//! # Bounds
//! Sequence numbers wrap: of two, the one that is less than 2^31 ahead is newer.
//!
//! # Cost
//! 1 KiB of stack and what decoding an image takes ([`RigImage::decode`]). A store erases once and
//! writes each word once; an image that is in use already is not written again. Both kinds of
//! images share the code: they are bytes here.

use crate::settings::KeptSettings;
use core::fmt;
use core::marker::PhantomData;
use embedded_storage::nor_flash::{NorFlash, NorFlashError, NorFlashErrorKind};
use linestereo_rig::checksum::CRC_BYTES;
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

/// An image of a fixed size. It starts as a [`RigImage`] does, with magic, version, length and
/// sequence number, and ends with a CRC-32.
pub trait SlotImage: Sized {
    /// Its size, bytes.
    const BYTES: usize;

    /// Writes the image at the start of `bytes`, which are [`SlotImage::BYTES`] or more.
    fn put(&self, sequence: u32, bytes: &mut [u8]);

    /// The sequence number of a whole image.
    fn sequence(bytes: &[u8]) -> Result<u32, RigImageError>;

    /// Decodes an image.
    fn decode(bytes: &[u8]) -> Result<Self, RigImageError>;
}

/// Bytes before the content of an image: magic, version, length, sequence number.
const HEAD: usize = 12;

impl SlotImage for RigImage {
    const BYTES: usize = Self::BYTES;

    fn put(&self, sequence: u32, bytes: &mut [u8]) {
        if let Some(start) = bytes.first_chunk_mut() {
            *start = self.encode(sequence);
        }
    }

    fn sequence(bytes: &[u8]) -> Result<u32, RigImageError> {
        RigImageHead::check(bytes).map(|head| head.sequence)
    }

    fn decode(bytes: &[u8]) -> Result<Self, RigImageError> {
        Self::decode(bytes)
    }
}

impl SlotImage for KeptSettings {
    const BYTES: usize = Self::BYTES;

    fn put(&self, sequence: u32, bytes: &mut [u8]) {
        self.put(sequence, bytes);
    }

    fn sequence(bytes: &[u8]) -> Result<u32, RigImageError> {
        Self::sequence(bytes)
    }

    fn decode(bytes: &[u8]) -> Result<Self, RigImageError> {
        Self::decode(bytes)
    }
}

/// Why a slot holds no usable image.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SlotError {
    /// The image in the slot is refused.
    #[error("{0}")]
    Image(RigImageError),
    /// The flash cannot be read.
    #[error("the flash cannot be read: {0}")]
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

/// Contents of both slots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loaded<T> {
    /// The newest usable image and its slot.
    pub newest: Option<(Slot, T)>,
    /// The sequence number of each slot's image, or what is wrong with it. An older image than the
    /// one in use is only known to be whole.
    pub slots: [Result<u32, SlotError>; 2],
}

/// Why an image is not stored. The one that was in use still is, unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// The flash cannot be erased.
    Erase(NorFlashErrorKind),
    /// The flash cannot be written.
    Write(NorFlashErrorKind),
    /// The bytes read differ from those written: the flash is worn out.
    NotKept,
}

/// Why two slots cannot lie where they should.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayoutError {
    /// The flash reads or writes more than 512 bytes at once, or its sizes do not divide each
    /// other.
    Granularity,
    /// A slot does not start where the flash can erase.
    NotAligned(Slot),
    /// A slot ends beyond the flash.
    OutOfBounds(Slot),
    /// The slots share bytes that are erased together.
    Overlap,
}

/// [`BoardStore`] over any flash.
pub trait Keeper {
    /// Looks for the newest usable rig.
    fn load_rig(&mut self) -> Loaded<RigImage>;

    /// Keeps this rig, and says where. One that is in use already stays where it is.
    fn store_rig(&mut self, image: &RigImage) -> Result<Slot, StoreError>;

    /// Looks for the newest settings.
    fn load_settings(&mut self) -> Loaded<KeptSettings>;

    /// Keeps these settings, and says where. Those that are in use already stay where they are.
    fn store_settings(&mut self, settings: &KeptSettings) -> Result<Slot, StoreError>;
}

impl fmt::Debug for dyn Keeper + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("flash")
    }
}

/// The rig and the settings of a board in one flash.
#[derive(Debug)]
pub struct BoardStore<F> {
    flash: F,
    rig: [u32; 2],
    settings: [u32; 2],
}

impl<F: NorFlash> BoardStore<F> {
    /// The rig's slots, each of [`SlotStore::SLOT`] bytes, and those of the settings, start at
    /// these addresses of the flash.
    pub fn new(mut flash: F, rig: [u32; 2], settings: [u32; 2]) -> Result<Self, LayoutError> {
        RigStore::new(&mut flash, rig)?;
        SettingsStore::new(&mut flash, settings)?;
        let largest = SettingsStore::<F>::SLOT.max(RigStore::<F>::SLOT);
        let is_apart = |&of: &u32| rig.iter().all(|&rig| rig.abs_diff(of) >= largest);
        if settings.iter().all(is_apart) {
            Ok(Self { flash, rig, settings })
        } else {
            Err(LayoutError::Overlap)
        }
    }

    /// The flash.
    pub fn into_flash(self) -> F {
        self.flash
    }

    fn slots<T>(&mut self, starts: [u32; 2]) -> SlotStore<&mut F, T> {
        SlotStore { flash: &mut self.flash, starts, image: PhantomData }
    }
}

impl<F: NorFlash> Keeper for BoardStore<F> {
    fn load_rig(&mut self) -> Loaded<RigImage> {
        self.slots(self.rig).load()
    }

    fn store_rig(&mut self, image: &RigImage) -> Result<Slot, StoreError> {
        self.slots(self.rig).store(image)
    }

    fn load_settings(&mut self) -> Loaded<KeptSettings> {
        self.slots(self.settings).load()
    }

    fn store_settings(&mut self, settings: &KeptSettings) -> Result<Slot, StoreError> {
        self.slots(self.settings).store(settings)
    }
}

/// Two slots for a rig.
pub type RigStore<F> = SlotStore<F, RigImage>;
/// Two slots for settings.
pub type SettingsStore<F> = SlotStore<F, KeptSettings>;

/// Two slots in a flash.
#[derive(Debug)]
pub struct SlotStore<F, T> {
    flash: F,
    starts: [u32; 2],
    image: PhantomData<fn() -> T>,
}

impl<F: NorFlash, T: SlotImage> SlotStore<F, T> {
    /// Bytes of a slot: they are erased together.
    pub const SLOT: u32 = slot_bytes::<F>(T::BYTES);

    /// Slots that start at these addresses of the flash, each of [`SlotStore::SLOT`] bytes.
    pub fn new(flash: F, starts: [u32; 2]) -> Result<Self, LayoutError> {
        let step = step::<F>();
        let divides = |size: usize| step.is_multiple_of(size);
        if T::BYTES.next_multiple_of(step) > MOST_BYTES
            || !divides(F::READ_SIZE)
            || !divides(F::WRITE_SIZE)
        {
            return Err(LayoutError::Granularity);
        }
        for (slot, start) in Slot::BOTH.into_iter().zip(starts) {
            if !(start as usize).is_multiple_of(F::ERASE_SIZE) {
                return Err(LayoutError::NotAligned(slot));
            }
            if flash
                .capacity()
                .checked_sub(start as usize)
                .is_none_or(|rest| rest < Self::SLOT as usize)
            {
                return Err(LayoutError::OutOfBounds(slot));
            }
        }
        let [first, second] = starts;
        if first.abs_diff(second) < Self::SLOT {
            Err(LayoutError::Overlap)
        } else {
            Ok(Self { flash, starts, image: PhantomData })
        }
    }

    /// The flash.
    pub fn into_flash(self) -> F {
        self.flash
    }

    fn slots(&mut self) -> Slots<'_, F> {
        let format = Format {
            bytes: T::BYTES,
            sequence: T::sequence,
            check: |bytes| T::decode(bytes).map(drop),
        };
        Slots { flash: &mut self.flash, starts: self.starts, format }
    }

    /// Looks for the newest usable image.
    pub fn load(&mut self) -> Loaded<T> {
        let mut bytes = [0; MOST_BYTES];
        let (slots, newest) = self.slots().load(&mut bytes);
        let image = T::decode(bytes.get(..T::BYTES).unwrap_or_default()).ok();
        Loaded { newest: newest.zip(image), slots }
    }

    /// Keeps this image, and says where. One that is in use already stays where it is.
    pub fn store(&mut self, image: &T) -> Result<Slot, StoreError> {
        let mut bytes = [0xff; MOST_BYTES];
        self.slots().store(&mut bytes, &mut |sequence, bytes| image.put(sequence, bytes))
    }
}

/// Bytes read or written at once.
const fn step<F: NorFlash>() -> usize {
    if F::READ_SIZE > F::WRITE_SIZE { F::READ_SIZE } else { F::WRITE_SIZE }
}

/// Bytes erased for an image of `bytes`.
const fn slot_bytes<F: NorFlash>(bytes: usize) -> u32 {
    bytes.next_multiple_of(step::<F>()).next_multiple_of(F::ERASE_SIZE) as u32
}

/// A kind of images.
#[derive(Clone, Copy)]
struct Format {
    bytes: usize,
    sequence: fn(&[u8]) -> Result<u32, RigImageError>,
    /// Can it be used?
    check: fn(&[u8]) -> Result<(), RigImageError>,
}

/// Two slots of a kind of images, as bytes.
struct Slots<'f, F> {
    flash: &'f mut F,
    starts: [u32; 2],
    format: Format,
}

impl<F: NorFlash> Slots<'_, F> {
    /// Reads a slot's image to the start of `bytes`.
    fn read<'a>(
        &mut self,
        slot: Slot,
        bytes: &'a mut [u8; MOST_BYTES],
    ) -> Result<&'a [u8], SlotError> {
        // `new` checked that it fits.
        let bytes =
            bytes.get_mut(..self.format.bytes.next_multiple_of(step::<F>())).unwrap_or_default();
        let start = *slot.of(&mut self.starts);
        self.flash.read(start, bytes).map_err(|error| SlotError::Flash(error.kind()))?;
        Ok(bytes.get(..self.format.bytes).unwrap_or_default())
    }

    /// The sequence number of each slot, and the slot of the newest usable image, which then is at
    /// the start of `bytes`.
    #[inline(never)]
    fn load(
        &mut self,
        bytes: &mut [u8; MOST_BYTES],
    ) -> ([Result<u32, SlotError>; 2], Option<Slot>) {
        let format = self.format;
        let mut slots = Slot::BOTH
            .map(|slot| (format.sequence)(self.read(slot, bytes)?).map_err(SlotError::Image));
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
            match self
                .read(slot, bytes)
                .and_then(|bytes| (format.check)(bytes).map_err(SlotError::Image))
            {
                Ok(()) => return (slots, Some(slot)),
                Err(error) => *state = Err(error),
            }
        }
        (slots, None)
    }

    /// A number after those of images of this kind that cannot be used, such as those of another
    /// version: settings that name one of these are not for the next image.
    fn next_sequence(&mut self, of_kind: &[u8], found: &mut [u8; MOST_BYTES]) -> u32 {
        let [first, second] = Slot::BOTH.map(|slot| {
            let (head, _) = self.read(slot, found).ok()?.split_first_chunk::<HEAD>()?;
            let (words, _) = head.as_chunks();
            let [magic, _, sequence] = *words else { return None };
            of_kind.starts_with(&magic).then(|| u32::from_le_bytes(sequence))
        });
        let newest = match (first, second) {
            (Some(first), Some(second)) if is_newer(second, first) => Some(second),
            _ => first.or(second),
        };
        newest.map_or(0, |sequence| sequence.wrapping_add(1))
    }

    /// Stores the image that `put` writes with a sequence number into `bytes`, which hold ones.
    #[inline(never)]
    fn store(
        &mut self,
        bytes: &mut [u8; MOST_BYTES],
        put: &mut dyn FnMut(u32, &mut [u8]),
    ) -> Result<Slot, StoreError> {
        let mut found = [0; MOST_BYTES];
        let (mut slots, newest) = self.load(&mut found);
        put(0, bytes);
        let content = HEAD..self.format.bytes - CRC_BYTES;
        let (slot, sequence) = match newest {
            Some(used) if found.get(content.clone()) == bytes.get(content.clone()) => {
                return Ok(used);
            }
            Some(used) => {
                (used.other(), used.of(&mut slots).map_or(0, |sequence| sequence.wrapping_add(1)))
            }
            None => (Slot::First, self.next_sequence(bytes, &mut found)),
        };
        put(sequence, bytes);
        // `new` checked that it fits.
        let image =
            bytes.get(..self.format.bytes.next_multiple_of(step::<F>())).unwrap_or_default();
        let start = *slot.of(&mut self.starts);
        let end = start + slot_bytes::<F>(self.format.bytes);
        self.flash.erase(start, end).map_err(|error| StoreError::Erase(error.kind()))?;
        self.flash.write(start, image).map_err(|error| StoreError::Write(error.kind()))?;
        let (_, newest) = self.load(&mut found);
        let is_kept = newest == Some(slot)
            && found.get(..self.format.bytes) == bytes.get(..self.format.bytes);
        if is_kept { Ok(slot) } else { Err(StoreError::NotKept) }
    }
}

/// Is a sequence number newer than another? Those of two slots are never far apart.
fn is_newer(a: u32, than: u32) -> bool {
    a != than && a.wrapping_sub(than) < 1 << 31
}
