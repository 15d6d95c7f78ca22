//! Two sensors of a model, in one mode, exposed alike.
//!
//! ```text
//! start    both stopped; left, then right, with the left one's first choice, or with its own where
//!          that is none that anybody may fix; if one fails the other is put to standby
//! shared   left chooses; follow: what it has chosen is written to the right one, which shows it
//!          one or two frames later
//! ```
//! A pair with one camera does not run: there is no depth to be had.

use super::{CameraError, Chip, Condition, Config, Exposure, ExposureControl, Model, ResetLine};
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::I2c;
use linestereo_rig::CameraSide;

/// The left and the right sensor. Two at one bus: give each a share of it
/// (`embedded_hal_bus::i2c::RefCellDevice`).
#[derive(Debug)]
pub struct CameraPair<M, BL, RL, BR, RR> {
    left: Chip<M, BL, RL>,
    right: Chip<M, BR, RR>,
    is_shared: bool,
    /// Exposure and gain of both, as far as they are known.
    exposure: Option<Exposure>,
}

/// Owner of exposure and gain of both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairExposure {
    /// Nobody: they stay.
    Fixed(Exposure),
    /// The left sensor.
    LeftChooses,
}

/// Why a pair does not do what it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{eye} camera: {error}; the {} one is {other}",
    if *.eye == CameraSide::Left { "right" } else { "left" }
)]
pub struct PairError<E> {
    /// The camera that failed.
    pub eye: CameraSide,
    /// Why, and how it was left.
    pub error: CameraError<E>,
    /// How the other one was left.
    pub other: Condition,
}

impl<M, BL, RL, BR, RR> CameraPair<M, BL, RL, BR, RR>
where
    M: Model,
    BL: I2c,
    RL: ResetLine,
    BR: I2c<Error = BL::Error>,
    RR: ResetLine,
{
    /// Two sensors. Nothing is sent yet.
    pub const fn new(left: Chip<M, BL, RL>, right: Chip<M, BR, RR>) -> Self {
        Self { left, right, is_shared: false, exposure: None }
    }

    /// Starts both in one mode; of `config`, the exposure is replaced. When one fails neither runs.
    ///
    /// Before its first frame a sensor may say that it has chosen what nobody can fix (MT9V034: 0
    /// rows). The right one chooses for itself then, until [`CameraPair::follow`] finds a choice.
    pub fn start(
        &mut self,
        config: &Config,
        exposure: PairExposure,
        delay: &mut impl DelayNs,
    ) -> Result<(), PairError<BL::Error>> {
        (self.is_shared, self.exposure) = (exposure == PairExposure::LeftChooses, None);
        let left = match exposure {
            PairExposure::Fixed(fixed) => ExposureControl::Fixed(fixed),
            PairExposure::LeftChooses => ExposureControl::Auto,
        };
        self.left
            .start(&Config { exposure: left, ..*config }, delay)
            .map_err(|error| self.fail(CameraSide::Left, error, delay))?;
        let known = match exposure {
            PairExposure::Fixed(fixed) => Some(fixed),
            PairExposure::LeftChooses => {
                let chosen = self
                    .left
                    .exposure()
                    .map_err(|error| self.fail(CameraSide::Left, error, delay))?;
                Some(chosen).filter(|&chosen| M::check_exposure(chosen).is_ok())
            }
        };
        let right = Config {
            exposure: known.map_or(ExposureControl::Auto, ExposureControl::Fixed),
            ..*config
        };
        self.right
            .start(&right, delay)
            .map_err(|error| self.fail(CameraSide::Right, error, delay))?;
        self.exposure = known;
        Ok(())
    }

    /// Stops both, the right one even if the left one fails.
    pub fn stop(&mut self, delay: &mut impl DelayNs) -> Result<(), PairError<BL::Error>> {
        let left = self.left.stop(delay);
        let right = self.right.stop(delay);
        left.map_err(|error| self.error(CameraSide::Left, error))?;
        right.map_err(|error| self.error(CameraSide::Right, error))
    }

    /// Between two frames, when the left one chooses: gives its choice to the right one. Says what
    /// both have now.
    ///
    /// A choice that the model does not let anybody fix (0 rows, in the dark) leaves the right one
    /// as it was. If the choice cannot be read, both run on as they did; if it cannot be written,
    /// neither runs.
    pub fn follow(
        &mut self,
        delay: &mut impl DelayNs,
    ) -> Result<Option<Exposure>, PairError<BL::Error>> {
        if !self.is_shared {
            return Ok(self.exposure);
        }
        let chosen = self.left.exposure();
        let chosen = chosen.map_err(|error| self.error(CameraSide::Left, error))?;
        if self.exposure != Some(chosen) && M::check_exposure(chosen).is_ok() {
            self.exposure = None; // of neither, if it fails
            self.right
                .set_exposure(chosen, delay)
                .map_err(|error| self.fail(CameraSide::Right, error, delay))?;
            self.exposure = Some(chosen);
        }
        Ok(self.exposure)
    }

    /// The state of the left and the right one.
    pub const fn conditions(&self) -> [Condition; 2] {
        [self.left.condition(), self.right.condition()]
    }

    /// The two sensors.
    pub fn release(self) -> (Chip<M, BL, RL>, Chip<M, BR, RR>) {
        (self.left, self.right)
    }

    /// One has failed: whatever still runs is stopped. One to which nothing has been sent is left
    /// alone.
    fn fail(
        &mut self,
        eye: CameraSide,
        error: CameraError<BL::Error>,
        delay: &mut impl DelayNs,
    ) -> PairError<BL::Error> {
        self.exposure = None;
        // Their conditions say what becomes of them.
        if self.left.condition() == Condition::Running {
            let _ = self.left.stop(delay);
        }
        if self.right.condition() == Condition::Running {
            let _ = self.right.stop(delay);
        }
        self.error(eye, error)
    }

    /// The error of this sensor, as both are now.
    fn error(&self, eye: CameraSide, error: CameraError<BL::Error>) -> PairError<BL::Error> {
        let [left, right] = self.conditions();
        let (own, other) = if eye == CameraSide::Left { (left, right) } else { (right, left) };
        PairError { eye, error: CameraError { left: own, ..error }, other }
    }
}
