//! Trigger of both sensors.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;

/// Effect of a sensor's trigger pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TriggerInput {
    /// The rising edge of a pulse: one frame.
    Pulse {
        /// How long it is, microseconds.
        us: u32,
    },
    /// A level: one frame after the other as long as it is high. Lowered in the middle of a frame,
    /// this frame is the last one.
    Level,
}

/// A pin that is wired to the trigger inputs of both sensors.
#[derive(Clone, Debug)]
pub struct Trigger<P> {
    pin: P,
    is_held: bool,
}

impl<P: OutputPin> Trigger<P> {
    /// The pin is low from now on.
    pub fn new(mut pin: P) -> Result<Self, P::Error> {
        pin.set_low()?;
        Ok(Self { pin, is_held: false })
    }

    /// Starts a frame of both by a pulse of so many microseconds. After an error the pin may be
    /// high; the next call lowers it before it raises it, so an edge is never missed.
    pub fn fire(&mut self, pulse_us: u32, delay: &mut impl DelayNs) -> Result<(), P::Error> {
        self.raise()?;
        delay.delay_us(pulse_us);
        self.lower()
    }

    /// Starts frames of both, until it is lowered. From low: an input that wants an edge gets one.
    pub fn raise(&mut self) -> Result<(), P::Error> {
        self.pin.set_low()?;
        self.is_held = true; // even if the pin fails now
        self.pin.set_high()
    }

    /// Lowers the pin, unless it is.
    pub fn lower(&mut self) -> Result<(), P::Error> {
        if self.is_held {
            self.pin.set_low()?;
            self.is_held = false;
        }
        Ok(())
    }

    /// The pin.
    pub fn release(self) -> P {
        self.pin
    }
}
