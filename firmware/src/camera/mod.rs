//! Image sensors: from a bus and two pins to a running pair.
//!
//! In: an I2C bus, a reset pin if there is one, a [`Config`]. Out: a sensor that delivers frames in
//! that mode, or a [`CameraError`] that says what failed and in which [`Condition`] the sensor was
//! left.
//!
//! ```text
//! Chip::start     refuse what the model cannot do                    no transaction yet
//!                 hold and release the reset pin
//!                 read the identity                                  nothing is written to a chip that is not the one expected
//!                 soft reset, mode, exposure: write, read back       a register that is not kept is an error
//!                 run: free, or a frame per trigger
//! any failure  -> reset pin held, else standby written, else HalfConfigured; nothing but `start`
//!              is taken after it
//! CameraPair      both in one mode; exposure and gain of the left one given to both; one missing:
//!                 the other is put to standby
//! Trigger         one pulse for both, or a level that is held until both frames have started
//! StereoCamera    all of it at work: started again after a failure, a pulse per pair, exposed
//!                 alike
//! ```
//! A model ([`Mt9v034`], [`Hm01b0`]) is tables of registers; what is done with them, and what
//! happens when it fails, is written once, in [`Chip`].
//!
//! None of this has run on hardware yet: tests replay register traces (`firmware/tests/camera.rs`).

mod chip;
mod hm01b0;
mod mt9v034;
mod pair;
mod registers;
mod stereo;
mod trigger;

pub use chip::Chip;
pub use hm01b0::{Hm01b0, Hm01b0Nibbles, Hm01b0Over};
pub use mt9v034::Mt9v034;
pub use pair::{CameraPair, PairError, PairExposure};
pub use registers::{Identity, Step, Wire};
pub use stereo::{StereoCamera, StereoConfig};
pub use trigger::{Trigger, TriggerInput};

use crate::ports::FrameStart;
use core::fmt;
use core::ops::RangeInclusive;
use embedded_hal::digital::OutputPin;
use linestereo::Dims;

/// Task of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Pixels that come out.
    pub dims: Dims,
    /// Pixels of the sensor, in each direction, that become one.
    pub binning: Binning,
    /// Start of a frame: free or triggered.
    pub start: FrameStart,
    /// Owner of exposure and gain: the sensor or the program.
    pub exposure: ExposureControl,
    /// Send a built-in picture, so that wiring and capture can be tested.
    pub test_pattern: bool,
}

impl Config {
    /// A mode in which the sensor chooses its exposure, and no test pattern.
    pub const fn new(dims: Dims, binning: Binning, start: FrameStart) -> Self {
        Self { dims, binning, start, exposure: ExposureControl::Auto, test_pattern: false }
    }
}

/// Pixels of the sensor, in each direction, that become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binning {
    /// Every pixel.
    One,
    /// Two by two.
    Two,
    /// Four by four.
    Four,
}

impl Binning {
    /// Pixels in each direction.
    #[must_use]
    pub const fn pixels(self) -> u16 {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Four => 4,
        }
    }

    /// Columns and rows of the sensor that become images of this size.
    const fn window(self, Dims { width, height }: Dims) -> (u16, u16) {
        (width.saturating_mul(self.pixels()), height.saturating_mul(self.pixels()))
    }
}

/// Owner of exposure and gain: the sensor or the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExposureControl {
    /// The sensor.
    Auto,
    /// Nobody: they stay.
    Fixed(Exposure),
}

/// Exposure and gain as a sensor's registers have them: two sensors of a model that have the same
/// are exposed alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exposure {
    /// Rows of time that a pixel collects light.
    pub rows: u16,
    /// The register of the gain: see [`Model::gain_code`].
    pub gain_code: u16,
}

/// How the rows of a frame are exposed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shutter {
    /// All at once.
    Global,
    /// One after the other, as they are read out: whatever moves is skewed.
    Rolling,
}

impl Shutter {
    /// From the start of a frame's readout to the middle of its exposure (of the middle row, if
    /// they differ), microseconds; mostly negative.
    #[must_use]
    pub fn middle_us(self, exposure_us: u32, readout_us: u32) -> i32 {
        let before = i32::try_from(exposure_us / 2).unwrap_or(i32::MAX);
        match self {
            Self::Global => -before,
            Self::Rolling => {
                i32::try_from(readout_us / 2).unwrap_or(i32::MAX).saturating_sub(before)
            }
        }
    }
}

/// Data of a kind of sensor. Every number is of its datasheet or of public drivers, which its file
/// names.
pub trait Model {
    /// Its name.
    const NAME: &'static str;
    /// How registers go over the bus.
    const WIRE: Wire;
    /// How it exposes.
    const SHUTTER: Shutter;
    /// Effect of its trigger pin.
    const TRIGGER: TriggerInput;
    /// Rows that it can be exposed for.
    const ROWS: RangeInclusive<u16>;
    /// Its identity register and value.
    const IDENTITY: &'static [Identity];
    /// From any state to that after a reset.
    const RESET: &'static [Step];
    /// From any state to one that sends nothing; no step has a pause.
    const STANDBY: &'static [Step];
    /// Exposure and gain choose themselves.
    const AUTO: &'static [Step];

    /// Has it images of that size, with that binning?
    fn has_size(dims: Dims, binning: Binning) -> bool;

    /// From the state after a reset to a mode that it has, still sending nothing.
    fn mode(config: &Config) -> impl Iterator<Item = Step>;

    /// After mode and exposure: whatever a test pattern needs, and frames from now on.
    fn run(config: &Config) -> impl Iterator<Item = Step>;

    /// Has it a gain of this register value?
    fn has_gain(gain_code: u16) -> bool;

    /// Can it be exposed like that?
    fn check_exposure(exposure: Exposure) -> Result<(), Unsupported> {
        let Exposure { rows, gain_code } = exposure;
        if !Self::ROWS.contains(&rows) {
            Err(Unsupported::Rows(rows))
        } else if !Self::has_gain(gain_code) {
            Err(Unsupported::Gain(gain_code))
        } else {
            Ok(())
        }
    }

    /// Exposure and gain that stay.
    fn exposure(exposure: Exposure) -> impl Iterator<Item = Step>;

    /// Exposure and gain that are in use now, whoever chose them.
    fn read_exposure<E>(read: impl FnMut(u16) -> Result<u16, E>) -> Result<Exposure, E>;

    /// The register value whose gain is nearest to one in 1/64 from below; `None` when it has no
    /// such gain.
    fn gain_code(gain_q6: u16) -> Option<u16>;

    /// The gain of a register value, 1/64.
    fn gain_q6(gain_code: u16) -> u16;
}

/// The state in which a sensor is known to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// As it was when its driver was made.
    Unknown,
    /// Its reset pin is held.
    InReset,
    /// It takes commands and sends nothing.
    Standby,
    /// It sends frames as configured.
    Running,
    /// Some registers are written and some are not, and it could not be stopped: it may send frames
    /// of any size at any time. Start it again, or take its power away.
    HalfConfigured,
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unknown => "as it was",
            Self::InReset => "held in reset",
            Self::Standby => "in standby",
            Self::Running => "running",
            Self::HalfConfigured => "half configured: start it again or take its power away",
        })
    }
}

/// Why a sensor does not do what it should, and how it was left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{cause} (the camera is {left})")]
pub struct CameraError<E> {
    /// The fault.
    pub cause: Cause<E>,
    /// The state of the sensor now.
    pub left: Condition,
}

/// The fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Cause<E> {
    /// Nothing answers at the sensor's address.
    #[error("no camera answers: check power, clock and wires")]
    Missing,
    /// Another chip answers.
    #[error("another chip answers: register {register:#06x} holds {found:#06x}")]
    Identity {
        /// Register of the identity.
        register: u16,
        /// Its contents.
        found: u16,
    },
    /// The bus failed.
    #[error("the bus failed at register {register:#06x}: {error:?}")]
    Bus {
        /// The register that was read or written.
        register: u16,
        /// The bus's own error.
        error: E,
    },
    /// A register does not hold what was written.
    #[error("register {register:#06x} holds {read:#06x} after {written:#06x} was written")]
    NotKept {
        /// Its address.
        register: u16,
        /// Value written, of the bits that are compared.
        written: u16,
        /// Value read, of the same bits.
        read: u16,
    },
    /// The reset pin failed.
    #[error("the reset pin cannot be set")]
    Pin,
    /// The model has no such mode.
    #[error("{0}")]
    Unsupported(Unsupported),
    /// The sensor does not run: start it first.
    #[error("the camera does not run: start it first")]
    NotRunning,
}

/// Function that a model does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unsupported {
    /// Images of this size with this binning.
    #[error(
        "the sensor has no images of {0} with {pixels}x{pixels} pixels made one",
        pixels = .1.pixels()
    )]
    Size(Dims, Binning),
    /// An exposure of so many rows.
    #[error("the sensor cannot be exposed for {0} rows")]
    Rows(u16),
    /// A gain of this register value.
    #[error("the sensor has no gain {0:#x}")]
    Gain(u16),
}

/// The wire to a sensor's reset input, which resets while it is low; or none.
pub trait ResetLine {
    /// Resets until released. Says whether the sensor is held now.
    fn hold(&mut self) -> Result<bool, PinFault>;

    /// Lets the sensor run.
    fn release(&mut self) -> Result<(), PinFault>;
}

/// A pin cannot be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PinFault;

/// The sensor's reset input is not wired to a pin.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoReset;

impl ResetLine for NoReset {
    fn hold(&mut self) -> Result<bool, PinFault> {
        Ok(false)
    }

    fn release(&mut self) -> Result<(), PinFault> {
        Ok(())
    }
}

/// A pin at the sensor's reset input.
#[derive(Clone, Debug)]
pub struct ResetPin<P>(pub P);

impl<P: OutputPin> ResetLine for ResetPin<P> {
    fn hold(&mut self) -> Result<bool, PinFault> {
        self.0.set_low().map(|()| true).map_err(|_| PinFault)
    }

    fn release(&mut self) -> Result<(), PinFault> {
        self.0.set_high().map_err(|_| PinFault)
    }
}
