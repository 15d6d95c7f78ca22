//! One sensor: its steps taken over the bus, and what becomes of it when one fails.

use super::{
    CameraError, Cause, Condition, Config, Exposure, ExposureControl, Model, PinFault, ResetLine,
    Step, Unsupported,
};
use core::marker::PhantomData;
use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::{Error as _, ErrorKind, I2c};

/// How long a reset pin is held, and what a sensor needs afterwards until it answers: more than any
/// of the models needs.
const RESET_US: u32 = 2000;

/// The steps to standby have no pauses.
struct NoDelay;

impl DelayNs for NoDelay {
    fn delay_ns(&mut self, _: u32) {}
}

/// A sensor of a model, at an address of a bus.
#[derive(Debug)]
pub struct Chip<M, B, R> {
    bus: B,
    address: u8,
    reset: R,
    condition: Condition,
    model: PhantomData<M>,
}

impl<M: Model, B: I2c, R: ResetLine> Chip<M, B, R> {
    /// A sensor at this 7-bit address. Nothing is sent yet.
    pub const fn new(bus: B, address: u8, reset: R) -> Self {
        Self { bus, address, reset, condition: Condition::Unknown, model: PhantomData }
    }

    /// The state in which the sensor is known to be.
    pub const fn condition(&self) -> Condition {
        self.condition
    }

    /// The bus and the reset line.
    pub fn release(self) -> (B, R) {
        (self.bus, self.reset)
    }

    /// From any state to a running sensor. What the model cannot do is refused before anything is
    /// sent.
    pub fn start(
        &mut self,
        config: &Config,
        delay: &mut impl DelayNs,
    ) -> Result<(), CameraError<B::Error>> {
        self.check(config).map_err(|what| self.unchanged(Cause::Unsupported(what)))?;
        self.boot(delay)?;
        let fixed = match config.exposure {
            ExposureControl::Fixed(exposure) => Some(exposure),
            ExposureControl::Auto => None,
        };
        let auto = if fixed.is_none() { M::AUTO } else { &[] };
        self.take(M::RESET.iter().copied(), delay)
            .and_then(|()| self.take(M::mode(config), delay))
            .and_then(|()| self.take(auto.iter().copied(), delay))
            .and_then(|()| self.take(fixed.into_iter().flat_map(M::exposure), delay))
            .and_then(|()| self.take(M::run(config), delay))
            .map_err(|cause| self.abandon(cause))?;
        self.condition = Condition::Running;
        Ok(())
    }

    /// From any state to one that sends nothing.
    pub fn stop(&mut self, delay: &mut impl DelayNs) -> Result<(), CameraError<B::Error>> {
        if self.condition == Condition::InReset {
            return Ok(());
        }
        self.take(M::STANDBY.iter().copied(), delay).map_err(|cause| self.abandon(cause))?;
        self.condition = Condition::Standby;
        Ok(())
    }

    /// Exposure and gain that are in use now, of a running sensor.
    pub fn exposure(&mut self) -> Result<Exposure, CameraError<B::Error>> {
        self.check_running()?;
        let Self { bus, address, .. } = self;
        let read = |register| {
            M::WIRE.read(bus, *address, register).map_err(|error| Cause::Bus { register, error })
        };
        M::read_exposure(read).map_err(|cause| self.unchanged(cause)) // nothing was written: it runs as before
    }

    /// Exposes a running sensor like this from now on.
    pub fn set_exposure(
        &mut self,
        exposure: Exposure,
        delay: &mut impl DelayNs,
    ) -> Result<(), CameraError<B::Error>> {
        self.check_running()?;
        M::check_exposure(exposure).map_err(|what| self.unchanged(Cause::Unsupported(what)))?;
        self.take(M::exposure(exposure), delay).map_err(|cause| self.abandon(cause))
    }

    fn check(&self, config: &Config) -> Result<(), Unsupported> {
        if !M::has_size(config.dims, config.binning) {
            return Err(Unsupported::Size(config.dims, config.binning));
        }
        match config.exposure {
            ExposureControl::Fixed(exposure) => M::check_exposure(exposure),
            ExposureControl::Auto => Ok(()),
        }
    }

    fn check_running(&self) -> Result<(), CameraError<B::Error>> {
        if self.condition == Condition::Running {
            Ok(())
        } else {
            Err(self.unchanged(Cause::NotRunning))
        }
    }

    /// Out of reset, and the chip that is expected. Nothing is written to it.
    fn boot(&mut self, delay: &mut impl DelayNs) -> Result<(), CameraError<B::Error>> {
        let pulse = self.reset.hold().and_then(|is_held| {
            if is_held {
                delay.delay_us(RESET_US);
            }
            self.reset.release()?;
            if is_held {
                delay.delay_us(RESET_US);
                self.condition = Condition::Unknown;
            }
            Ok(())
        });
        pulse.map_err(|PinFault| self.unchanged(Cause::Pin))?;
        for identity in M::IDENTITY {
            let register = identity.register;
            let cause = match M::WIRE.read(&mut self.bus, self.address, register) {
                Ok(found) if found == identity.value => continue,
                Ok(found) => Cause::Identity { register, found },
                Err(error) if matches!(error.kind(), ErrorKind::NoAcknowledge(_)) => Cause::Missing,
                Err(error) => Cause::Bus { register, error },
            };
            if self.reset.hold() == Ok(true) {
                self.condition = Condition::InReset;
            }
            return Err(self.unchanged(cause));
        }
        Ok(())
    }

    fn take(
        &mut self,
        steps: impl IntoIterator<Item = Step>,
        delay: &mut impl DelayNs,
    ) -> Result<(), Cause<B::Error>> {
        let Self { bus, address, .. } = self;
        for Step { register, value, kept, is_written, pause_us } in steps {
            let failed = |error| Cause::Bus { register, error };
            if is_written {
                M::WIRE.write(bus, *address, register, value).map_err(failed)?;
            }
            if pause_us > 0 {
                delay.delay_us(pause_us);
            }
            if kept != 0 {
                let read = M::WIRE.read(bus, *address, register).map_err(failed)? & kept;
                let written = value & kept;
                if read != written {
                    return Err(Cause::NotKept { register, written, read });
                }
            }
        }
        Ok(())
    }

    /// After a failure: stops the sensor by whatever still works.
    fn abandon(&mut self, cause: Cause<B::Error>) -> CameraError<B::Error> {
        self.condition = if self.reset.hold() == Ok(true) {
            Condition::InReset
        } else {
            let stopped = self.take(M::STANDBY.iter().copied(), &mut NoDelay);
            if stopped.is_ok() { Condition::Standby } else { Condition::HalfConfigured }
        };
        self.unchanged(cause)
    }

    const fn unchanged(&self, cause: Cause<B::Error>) -> CameraError<B::Error> {
        CameraError { cause, left: self.condition }
    }
}
