//! Two MT9V034 on one bus: their mode, and what their frames have to be like.
//!
//! 320x240 px, of 640x480 pixels of the sensor two by two, each frame triggered. A row takes
//! `(640 + 94)` clocks of the sensor, its exposure counts in rows: 27.5 us at 26.67 MHz, 29.4 us at
//! 25 MHz. Frames of 240 rows of that are 6.6 and 7.0 ms; should a sensor take twice as long for
//! binned rows, all limits below still hold.

use crate::camera::{
    Binning, Chip, Config, Mt9v034, PairExposure, ResetLine, StereoCamera, StereoConfig, Trigger,
};
use crate::capture::{Limits, RingLayout};
use crate::ports::FrameStart;
use core::cell::RefCell;
use embassy_stm32::i2c::{self, I2c, Instance, SclPin, SdaPin};
use embassy_stm32::mode::Blocking;
use embassy_stm32::time::Hertz;
use embassy_stm32::{Peri, gpio::Output, pac};
use embassy_time::{Delay, Duration};
use embedded_hal::i2c::{ErrorType, Operation};
use embedded_hal_bus::i2c::RefCellDevice;
use linestereo::Dims;
use static_cell::StaticCell;

/// Size of each sensor's images.
pub const DIMS: Dims = Dims { width: 320, height: 240 };
/// No pair for so long is a pair that is missing, microseconds: two exposures of 480 rows and two
/// readouts, and as much again.
pub const PATIENCE_US: u32 = 150_000;
/// Clocks of the sensor for a row.
const ROW_CLOCKS: u32 = 640 + 94;

/// Contents of a row of the camera interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Row {
    /// A row of the left sensor, then one of the right.
    Both,
    /// A row of the sensor that is connected.
    One,
}

impl Row {
    const fn bytes(self) -> u16 {
        match self {
            Self::Both => 2 * DIMS.width,
            Self::One => DIMS.width,
        }
    }

    /// 128 rows: as many as the program may be behind, 3.5 ms. Rectifying takes longer than reading
    /// out when both sensors send at once; with one, up to the strongest lenses it does not fall
    /// behind by half of a frame.
    #[must_use]
    pub const fn layout(self) -> RingLayout {
        RingLayout { rows: 128, row_bytes: self.bytes() as u32, band: 8 }
    }

    /// Limits that every frame has to meet.
    #[must_use]
    pub const fn limits(self) -> Limits {
        // Both at once, or the second one after the first is read out: an exposure and a readout
        // later.
        let pair_us = match self {
            Self::Both => 1000,
            Self::One => 60_000,
        };
        Limits {
            rows: DIMS.height,
            row_bytes: self.bytes(),
            row_gap_us: 2000,
            readout_us: 15_000,
            silence_us: 100_000,
            pair_us,
        }
    }
}

/// The bus of both sensors.
///
/// The HAL leaves its block in the middle of a transaction that has taken too long: it holds SCL,
/// and whatever comes next waits for that in vain. Here it is off for a moment then, which frees
/// the bus. A sensor that holds SDA low lets go when it is reset.
#[expect(missing_debug_implementations, reason = "the HAL's driver has none")]
pub struct Bus {
    i2c: I2c<'static, Blocking, i2c::Master>,
    block: pac::i2c::I2c,
}

impl Bus {
    fn run(
        &mut self,
        transaction: impl FnOnce(&mut I2c<'static, Blocking, i2c::Master>) -> Result<(), i2c::Error>,
    ) -> Result<(), i2c::Error> {
        let done = transaction(&mut self.i2c);
        if done == Err(i2c::Error::Timeout) {
            self.block.cr1().modify(|w| w.set_pe(false));
            // It is off after three clocks of its bus: RM0433, 52.4.6.
            let _ = (0..100).find(|_| !self.block.cr1().read().pe());
            self.block.cr1().modify(|w| w.set_pe(true));
        }
        done
    }
}

impl ErrorType for Bus {
    type Error = i2c::Error;
}

impl embedded_hal::i2c::I2c for Bus {
    fn write(&mut self, address: u8, bytes: &[u8]) -> Result<(), i2c::Error> {
        self.run(|i2c| i2c.blocking_write(address, bytes))
    }

    fn write_read(&mut self, address: u8, bytes: &[u8], into: &mut [u8]) -> Result<(), i2c::Error> {
        self.run(|i2c| i2c.blocking_write_read(address, bytes, into))
    }

    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), i2c::Error> {
        self.run(|i2c| i2c.blocking_transaction(address, operations))
    }
}
/// Two sensors with their reset lines.
pub type Sensors<RL, RR> = StereoCamera<
    Mt9v034,
    RefCellDevice<'static, Bus>,
    RL,
    RefCellDevice<'static, Bus>,
    RR,
    Output<'static>,
    Delay,
>;

/// Two sensors at the first two addresses of a bus, the left one at the first. `block` is the bus's
/// registers, `clock_hz` the sensors' own clock.
pub fn sensors<T: Instance, RL: ResetLine, RR: ResetLine>(
    bus: Peri<'static, T>,
    block: pac::i2c::I2c,
    (clock, data): (Peri<'static, impl SclPin<T>>, Peri<'static, impl SdaPin<T>>),
    (left_reset, right_reset): (RL, RR),
    trigger: Option<Trigger<Output<'static>>>,
    clock_hz: u32,
) -> Sensors<RL, RR> {
    static BUS: StaticCell<RefCell<Bus>> = StaticCell::new();
    let mut config = i2c::Config::default();
    config.frequency = Hertz::khz(400);
    config.timeout = Duration::from_millis(20); // longer than any transaction: what hangs is an error, not a reset
    let i2c = I2c::new_blocking(bus, clock, data, config);
    let bus = &*BUS.init(RefCell::new(Bus { i2c, block }));
    let [left, right, ..] = Mt9v034::ADDRESSES;
    let chips = (
        Chip::new(RefCellDevice::new(bus), left, left_reset),
        Chip::new(RefCellDevice::new(bus), right, right_reset),
    );
    let row_ns = (u64::from(ROW_CLOCKS) * 1_000_000_000 / u64::from(clock_hz)) as u32;
    let config = StereoConfig {
        config: Config::new(DIMS, Binning::Two, FrameStart::Triggered),
        exposure: PairExposure::LeftChooses,
        row_ns,
        readout_us: row_ns / 1000 * u32::from(DIMS.height),
    };
    StereoCamera::new(chips, trigger, Delay, config)
}
