//! One pulse that starts a frame of both sensors.

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;

/// A pin that is wired to the trigger inputs of both sensors; they act on its rising edge.
#[derive(Clone, Debug)]
pub struct Trigger<P> {
    pin: P,
    pulse_us: u32,
}

impl<P: OutputPin> Trigger<P> {
    /// Pulses of so many microseconds; the pin is low from now on.
    pub fn new(mut pin: P, pulse_us: u32) -> Result<Self, P::Error> {
        pin.set_low()?;
        Ok(Self { pin, pulse_us })
    }

    /// Starts a frame of both. After an error the pin may be high; the next call lowers it before it raises it, so an edge is never missed.
    pub fn fire(&mut self, delay: &mut impl DelayNs) -> Result<(), P::Error> {
        self.pin.set_low()?;
        self.pin.set_high()?;
        delay.delay_us(self.pulse_us);
        self.pin.set_low()
    }

    /// The pin.
    pub fn release(self) -> P {
        self.pin
    }
}
