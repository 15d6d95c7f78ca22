//! A pair of sensors at work: started when it has to be, triggered, exposed alike.
//!
//! ```text
//! shoot    not running: start both; then a pulse for both, if they are triggered, or a level,
//!          which is lowered when both frames have started
//! follow   the left one's choice to the right one; middle of the exposure = rows * time of a row,
//!          by the model's shutter
//! failure  counted for the sensor that failed; unless both still run they are started again by the
//!          next `shoot`
//! ```

use super::{
    CameraPair, Chip, Condition, Config, Exposure, Model, PairError, PairExposure, ResetLine,
    Trigger, TriggerInput,
};
use crate::ports::{Cameras, FrameStart};
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
use embedded_hal::i2c::I2c;
use linestereo_rig::CameraSide;

/// How a pair works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StereoConfig {
    /// The mode of both; its exposure is replaced.
    pub config: Config,
    /// Owner of the exposure of both.
    pub exposure: PairExposure,
    /// Time of a row, nanoseconds: what the sensors' exposure is counted in.
    pub row_ns: u32,
    /// From the first to the last row of a frame, microseconds.
    pub readout_us: u32,
}

/// Two sensors and their trigger.
#[derive(Debug)]
pub struct StereoCamera<M, BL, RL, BR, RR, P, D>
where
    BL: I2c,
{
    pair: CameraPair<M, BL, RL, BR, RR>,
    trigger: Option<Trigger<P>>,
    delay: D,
    config: StereoConfig,
    is_running: bool,
    failures: [u32; 2],
    last: Option<PairError<BL::Error>>,
}

impl<M, BL, RL, BR, RR, P, D> StereoCamera<M, BL, RL, BR, RR, P, D>
where
    M: Model,
    BL: I2c,
    RL: ResetLine,
    BR: I2c<Error = BL::Error>,
    RR: ResetLine,
    P: OutputPin,
    D: DelayNs,
{
    /// Two sensors, the trigger of both if it is wired, and how they work. Nothing is sent yet.
    pub fn new(
        chips: (Chip<M, BL, RL>, Chip<M, BR, RR>),
        trigger: Option<Trigger<P>>,
        delay: D,
        config: StereoConfig,
    ) -> Self {
        let pair = CameraPair::new(chips.0, chips.1);
        Self { pair, trigger, delay, config, is_running: false, failures: [0; 2], last: None }
    }

    /// The last fault, for a log.
    pub const fn last_error(&self) -> Option<&PairError<BL::Error>> {
        self.last.as_ref()
    }

    fn start(&mut self) -> bool {
        let started = self.pair.start(&self.config.config, self.config.exposure, &mut self.delay);
        self.is_running = self.note(started).is_some();
        self.is_running
    }

    /// Counts a failure. What does not run any more has to be started again.
    fn note<T>(&mut self, done: Result<T, PairError<BL::Error>>) -> Option<T> {
        match done {
            Ok(done) => Some(done),
            Err(error) => {
                let [left, right] = &mut self.failures;
                let count = if error.eye == CameraSide::Left { left } else { right };
                *count = count.saturating_add(1);
                self.last = Some(error);
                self.is_running = self.pair.conditions() == [Condition::Running; 2];
                None
            }
        }
    }
}

impl<M, BL, RL, BR, RR, P, D> Cameras for StereoCamera<M, BL, RL, BR, RR, P, D>
where
    M: Model,
    BL: I2c,
    RL: ResetLine,
    BR: I2c<Error = BL::Error>,
    RR: ResetLine,
    P: OutputPin,
    D: DelayNs,
{
    fn shoot(&mut self) -> bool {
        if !self.is_running && !self.start() {
            return false;
        }
        let Some(trigger) =
            self.trigger.as_mut().filter(|_| self.config.config.start == FrameStart::Triggered)
        else {
            return true;
        };
        let done = match M::TRIGGER {
            TriggerInput::Pulse { us } => trigger.fire(us, &mut self.delay),
            TriggerInput::Level => trigger.raise(),
        };
        done.is_ok()
    }

    fn let_go(&mut self) {
        if let Some(trigger) = &mut self.trigger {
            let _ = trigger.lower(); // if the pin stays high, the next shot lowers it first
        }
    }

    fn follow(&mut self) -> Option<[i32; 2]> {
        if !self.is_running {
            return None; // started again before the next frame, with a choice of its own
        }
        let followed = self.pair.follow(&mut self.delay);
        let Exposure { rows, .. } = self.note(followed)??;
        let exposure_us = u64::from(rows) * u64::from(self.config.row_ns) / 1000;
        let exposure_us = u32::try_from(exposure_us).unwrap_or(u32::MAX);
        Some([M::SHUTTER.middle_us(exposure_us, self.config.readout_us); 2])
    }

    fn stopped(&mut self) {
        self.is_running = false;
    }

    fn failures(&self) -> [u32; 2] {
        self.failures
    }
}
