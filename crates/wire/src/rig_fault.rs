//! State of a board's rig: which one it uses, and what is wrong with the slots that hold none.
//!
//! The numbers behind a fault stay on the board: who made the image gets them from
//! [`RigImage::decode`].

use core::fmt;
use linestereo::Dims;
use linestereo_rig::{CameraSide, RigImage, RigImageError};
use serde::{Deserialize, Serialize};

/// Why an image, or what lies in a slot, is no rig: a [`RigImageError`] without its numbers, or
/// that there is no image to look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RigFault {
    /// The board has no flash for rigs.
    #[error("no flash")]
    NoFlash,
    /// The flash cannot be read.
    #[error("unreadable")]
    Unreadable,
    /// [`RigImageError::Empty`].
    #[error("empty")]
    Empty,
    /// [`RigImageError::Foreign`].
    #[error("foreign")]
    Foreign,
    /// [`RigImageError::Truncated`].
    #[error("truncated")]
    Truncated,
    /// [`RigImageError::Surplus`].
    #[error("surplus bytes")]
    Surplus,
    /// [`RigImageError::Damaged`].
    #[error("damaged")]
    Damaged,
    /// [`RigImageError::OtherVersion`].
    #[error("other version")]
    OtherVersion,
    /// [`RigImageError::Length`].
    #[error("damaged or of another version")]
    Length,
    /// The left camera: [`RigImageError::Camera`], [`RigImageError::LensKind`].
    #[error("left camera unusable")]
    LeftCamera,
    /// The right camera.
    #[error("right camera unusable")]
    RightCamera,
    /// [`RigImageError::View`], or no pixel of it lies inside a raw image.
    #[error("view unusable")]
    View,
    /// [`RigImageError::Range`].
    #[error("disparity range unusable")]
    Range,
    /// A rig, but one whose images or bands this board has no memory for.
    #[error("too large for this board")]
    TooLarge,
    /// Settings of which one is out of its range.
    #[error("a setting out of its range")]
    OutOfRange,
}

impl From<RigImageError> for RigFault {
    fn from(error: RigImageError) -> Self {
        match error {
            RigImageError::Empty => Self::Empty,
            RigImageError::Foreign => Self::Foreign,
            RigImageError::Truncated { .. } => Self::Truncated,
            RigImageError::Surplus { .. } => Self::Surplus,
            RigImageError::Damaged => Self::Damaged,
            RigImageError::OtherVersion { .. } => Self::OtherVersion,
            RigImageError::Length { .. } => Self::Length,
            RigImageError::Camera(CameraSide::Left, _)
            | RigImageError::LensKind(CameraSide::Left, _) => Self::LeftCamera,
            RigImageError::Camera(CameraSide::Right, _)
            | RigImageError::LensKind(CameraSide::Right, _) => Self::RightCamera,
            RigImageError::View(_) => Self::View,
            RigImageError::Range(_) => Self::Range,
        }
    }
}

/// The rig that a board uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RigInUse {
    /// Width and height of the raw images.
    pub raw: [u16; 2],
    /// Width and height of the rectified images.
    pub rectified: [u16; 2],
    /// The slot that it lies in, 0 or 1; `None` when it is lost with the power.
    pub slot: Option<u8>,
}

impl RigInUse {
    /// A rig in this slot.
    #[must_use]
    pub fn new(image: &RigImage, slot: Option<u8>) -> Self {
        let size = |Dims { width, height }: Dims| [width, height];
        let remap = image.remap();
        Self { raw: size(remap.raw_dims()), rectified: size(remap.dims()), slot }
    }
}

/// Rig in use and state of its slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RigReport {
    /// The one in use; without one nothing is rectified.
    pub in_use: Option<RigInUse>,
    /// Of each slot of the flash the number of its image, or what is wrong with it.
    pub slots: [Result<u32, RigFault>; 2],
}

impl RigReport {
    /// Of a board without rig and flash.
    pub const NONE: Self = Self { in_use: None, slots: [Err(RigFault::NoFlash); 2] };
}

/// Such as `rig: none; slots: empty, damaged`.
impl fmt::Display for RigReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.in_use {
            None => write!(f, "rig: none")?,
            Some(RigInUse { raw: [w, h], rectified: [width, height], .. }) => {
                write!(f, "rig: {w}x{h} rectified to {width}x{height}")?;
            }
        }
        if self.slots == Self::NONE.slots {
            return write!(f, "; no flash to keep one");
        }
        for (number, (slot, text)) in self.slots.iter().zip(["; slots: ", ", "]).enumerate() {
            match slot {
                Ok(sequence) => write!(f, "{text}image {sequence}")?,
                Err(fault) => write!(f, "{text}{fault}")?,
            }
            if self.in_use.and_then(|rig| rig.slot).is_some_and(|slot| usize::from(slot) == number)
            {
                write!(f, " (in use)")?;
            }
        }
        Ok(())
    }
}
