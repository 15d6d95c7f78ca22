//! Commands of a host, and why a board refuses one.
//!
//! In: some parameters in plain numbers. Out: the board's parameters with these put in, checked by
//! the core alone, or the name, value and range of the one that is wrong. Bytes that were damaged
//! never get here: see `Decoder`.

use crate::object::{MAX_REGIONS, Regions};
use crate::packet::{Record, Sealed, VERSION, packet_bytes};
use crate::rig_fault::RigFault;
use crate::settings::{Setting, SettingValue};
use heapless::String;
use linestereo::params::{Margin, ParamError, Parts, RigError};
use linestereo::{Dims, Params, Rig, health::Skewed, units::Confidence};
use linestereo_rig::RigImage;
use serde::{Deserialize, Serialize};

/// The name of a parameter in a refusal.
pub type Name = String<32>;

/// One record from the host to the board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Command {
    /// Chosen by the host; the answer carries it. The same command with the same id may come again,
    /// when the answer was lost.
    pub id: u16,
    /// The request.
    pub request: Request,
}

impl Sealed for Command {}

impl Record for Command {
    const TAG: u8 = VERSION | 0x80;
}

/// Bytes of the largest packet of a [`Command`]: regions.
pub const MAX_COMMAND: usize = {
    // id 3, kind 1, count 1; of each label 3 and four times 3; only 1
    let (regions, rig) = (6 + MAX_REGIONS * 15, 6 + RigImage::BYTES);
    packet_bytes(if regions > rig { regions } else { rig })
};

/// Requests of a host. Each is answered, and doing it twice is the same as doing it once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Request {
    /// Say what you are: a `Hello` and the answer.
    Describe,
    /// Match pairs and send results.
    Start,
    /// Send no more results.
    Stop,
    /// Change parameters.
    SetParams(ParamUpdate),
    /// Match this pair, whose pixels follow the packet: all of the left image, all of the right
    /// one, row by row, one byte each. For programs that are fed by a file; a board with cameras
    /// refuses it.
    Pair(PairHead),
    /// Use this rig from now on, and keep it where there is flash for it: its view, disparity range
    /// and depths.
    SetRig(RigBytes),
    /// Rectify this pair with the rig, and match it. Pixels follow the packet as two cameras
    /// deliver them: the first row of the left image, the first row of the right one, the second
    /// rows, and so on. The sizes are those of the raw images. For programs that are fed by a file,
    /// as [`Request::Pair`].
    RawPair(PairHead),
    /// Say the depth of these objects with every pair from now on; what was asked for before is
    /// forgotten.
    SetRegions(Regions),
    /// Send the next pair as the cameras deliver it, before it is rectified: `Message::Photo` and
    /// its pixels, after the answer. For calibration, and to see what a camera sees.
    Photograph,
    /// Match the built-in pair of this number: `Message::Case` and the answer. For the program
    /// `selftest`; others refuse it.
    RunCase(u16),
    /// Change a [`Setting`].
    Set(SettingValue),
    /// Say all settings: a `Message::Setting` each, `Message::Kept` and the answer.
    Settings,
    /// Keep the settings in the flash, so that they outlive a reset.
    KeepSettings,
    /// Go back to the settings that the board was built with and to the disparity range of its rig,
    /// in the flash as well.
    ResetSettings,
    /// Say the time: `Message::Clock` and the answer.
    ReadClock,
    /// From now on give times in the host's clock: its time when the board's was 0, microseconds.
    /// To be measured anew every few seconds.
    SetClock(u64),
    /// Leave the program for the boot loader, which takes another one over USB; after the answer.
    Bootloader,
}

/// The bytes of a [`RigImage`], unchecked: the board says what is wrong with them.
pub type RigBytes = heapless::Vec<u8, { RigImage::BYTES }>;

/// A pair whose pixels follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PairHead {
    /// Width of both images in px.
    pub width: u16,
    /// Height of both images in px.
    pub height: u16,
    /// When it was captured (the left image), microseconds; comes back with the result.
    pub capture_time_us: u64,
    /// When the right image was captured, by the same clock; `None` when nobody knows. Too far from
    /// the left one, the pair is refused.
    pub right_capture_time_us: Option<u64>,
}

/// Parameters to change; `None` leaves one as it is. Meanings and ranges are those of [`Params`].
#[derive(Clone, Copy, Debug, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ParamUpdate {
    /// [`Params::min_disparity`], px.
    pub min_disparity: Option<i16>,
    /// [`Params::max_disparity`], px.
    pub max_disparity: Option<u16>,
    /// [`Params::anchor_gradient`].
    pub anchor_gradient: Option<u16>,
    /// [`Params::edge_gradient`].
    pub edge_gradient: Option<u16>,
    /// [`Params::min_extent`], px.
    pub min_extent: Option<u16>,
    /// [`Params::cell`], px.
    pub cell: Option<u16>,
    /// [`Params::margin`].
    pub margin: Option<Margin>,
    /// [`Params::min_confidence`].
    pub min_confidence: Option<Confidence>,
    /// [`Params::reach`], px.
    pub reach: Option<u16>,
    /// [`Params::rig`].
    pub rig: Option<RigUpdate>,
    /// [`Params::parts`].
    pub parts: Option<Parts>,
}

/// Numbers of a [`Rig`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RigUpdate {
    /// Focal length, px.
    pub focal_px: f64,
    /// Distance between the cameras, m.
    pub baseline_m: f64,
    /// Added to every disparity, px.
    pub offset_px: f64,
}

impl RigUpdate {
    /// The rig, its principal point in the centre of the image.
    pub fn rig(&self) -> Result<Rig, RigError> {
        Rig::new(self.focal_px as f32, self.baseline_m as f32, self.offset_px as f32)
    }
}

impl ParamUpdate {
    /// `params` with these put in. Only the rig is checked here, because it cannot be made
    /// otherwise; the rest is for [`Params::check`].
    pub fn apply(&self, params: Params) -> Result<Params, Refusal> {
        let rig = match self.rig {
            Some(rig) => Some(rig.rig()?),
            None => params.rig,
        };
        Ok(Params {
            min_disparity: self.min_disparity.unwrap_or(params.min_disparity),
            max_disparity: self.max_disparity.unwrap_or(params.max_disparity),
            rig,
            anchor_gradient: self.anchor_gradient.unwrap_or(params.anchor_gradient),
            edge_gradient: self.edge_gradient.unwrap_or(params.edge_gradient),
            min_extent: self.min_extent.unwrap_or(params.min_extent),
            cell: self.cell.unwrap_or(params.cell),
            margin: self.margin.unwrap_or(params.margin),
            min_confidence: self.min_confidence.unwrap_or(params.min_confidence),
            reach: self.reach.unwrap_or(params.reach),
            parts: self.parts.unwrap_or(params.parts),
            ground: params.ground,
        })
    }

    /// `params` with these put in, if a matcher of images of this size takes them.
    ///
    /// ```
    /// use linestereo::{Dims, Params};
    /// use linestereo_wire::ParamUpdate;
    /// let dims = Dims { width: 320, height: 240 };
    /// let update = ParamUpdate { max_disparity: Some(96), ..ParamUpdate::default() };
    /// assert_eq!(update.checked(Params::default(), dims).unwrap().max_disparity, 96);
    /// let refusal = ParamUpdate { cell: Some(7), ..update }.checked(Params::default(), dims);
    /// assert_eq!(refusal.unwrap_err().to_string(), "cell is 7 but must be 8 to 256");
    /// ```
    pub fn checked(&self, params: Params, dims: Dims) -> Result<Params, Refusal> {
        let params = self.apply(params)?;
        params.check(dims)?;
        Ok(params)
    }
}

/// Why a command was not done, in the core's own words where it has them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// [`ParamError::OutOfRange`].
    #[error("{name} is {value} but must be {low} to {high}")]
    OutOfRange {
        /// Name of the parameter.
        name: Name,
        /// Its value.
        value: i64,
        /// Least allowed value.
        low: i64,
        /// Largest allowed value.
        high: i64,
    },
    /// [`ParamError::MarginNeedsRig`].
    #[error("{}", ParamError::MarginNeedsRig)]
    MarginNeedsRig,
    /// The board's memory was made for smaller images.
    #[error("{name} of the board's memory holds {given}, these images need {needed}")]
    MemoryTooSmall {
        /// Name of the memory that is too small.
        name: Name,
        /// Size needed.
        needed: u32,
        /// Size there.
        given: u32,
    },
    /// [`RigError::Focal`].
    #[error("{}", RigError::Focal(*.0 as f32))]
    Focal(f64),
    /// [`RigError::Baseline`].
    #[error("{}", RigError::Baseline(*.0 as f32))]
    Baseline(f64),
    /// [`RigError::Offset`].
    #[error("{}", RigError::Offset(*.0 as f32))]
    Offset(f64),
    /// This board cannot do that.
    #[error("this board cannot do that")]
    Unsupported,
    /// The pixels end too early.
    #[error("the pair has {needed} bytes, {given} were given")]
    Truncated {
        /// Bytes of both images.
        needed: u32,
        /// Bytes there.
        given: u32,
    },
    /// The board has no rig: nothing can be rectified, and nothing has a depth.
    #[error("the board has no rig")]
    NoRig,
    /// The image is no rig that this board can use.
    #[error("the rig image is refused: {0}")]
    Rig(RigFault),
    /// The raw images are not of the size of the rig's.
    #[error(
        "the rig is for raw images of {}x{}, but these are {}x{}",
        .needed[0], .needed[1], .given[0], .given[1]
    )]
    RawSize {
        /// Width and height of the rig's raw images.
        needed: [u16; 2],
        /// Width and height of these.
        given: [u16; 2],
    },
    /// There is no flash, or it does not keep what is written.
    #[error("the board cannot keep it in flash")]
    NotKept,
    /// The box with this index of the list has no pixel in the board's largest image.
    #[error("box {0} has no pixel in the image")]
    Region(u8),
    /// The cameras delivered no whole pair.
    #[error("the cameras delivered no complete pair: check what each camera lost")]
    NoPair,
    /// The images of the pair were captured too far apart.
    #[error("{0}")]
    Skewed(Skewed),
    /// A [`Setting`] outside of its range.
    #[error(
        "{} is {value} but must be {}{least} to {largest}",
        Setting::words(*.number).0, Setting::words(*.number).1
    )]
    Setting {
        /// Its number.
        number: u8,
        /// The value.
        value: f32,
        /// Least allowed value.
        least: f32,
        /// Largest allowed value.
        largest: f32,
    },
}

impl From<Skewed> for Refusal {
    fn from(skewed: Skewed) -> Self {
        Self::Skewed(skewed)
    }
}

impl From<ParamError> for Refusal {
    fn from(error: ParamError) -> Self {
        match error {
            ParamError::OutOfRange { param, value, low, high } => {
                Self::OutOfRange { name: name(param.name()), value, low, high }
            }
            _ => Self::MarginNeedsRig,
        }
    }
}

impl From<RigError> for Refusal {
    fn from(error: RigError) -> Self {
        match error {
            RigError::Focal(value) => Self::Focal(value.into()),
            RigError::Baseline(value) => Self::Baseline(value.into()),
            // An update has no principal point.
            RigError::Offset(value) | RigError::PrincipalPoint(value) => Self::Offset(value.into()),
            _ => Self::NoRig,
        }
    }
}

/// A name, as much of it as there is room for.
#[must_use]
pub fn name(text: &str) -> Name {
    let mut name = Name::new();
    for character in text.chars() {
        if name.push(character).is_err() {
            break;
        }
    }
    name
}

impl Setting {
    /// Name and kind of the setting of this number in a refusal.
    fn words(number: u8) -> (&'static str, &'static str) {
        Self::get(number).map_or(("setting", ""), |of| {
            (of.name, if of.is_whole { "a whole number from " } else { "" })
        })
    }

    /// Refuses what is no value of the setting of this number.
    pub fn check(number: u8, value: f32) -> Result<(), Refusal> {
        match Self::get(number) {
            None => Err(Refusal::Unsupported),
            Some(setting) if setting.takes(value) => Ok(()),
            Some(&Self { least, largest, .. }) => {
                Err(Refusal::Setting { number, value, least, largest })
            }
        }
    }
}
