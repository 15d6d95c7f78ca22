//! MT9V034: 752x480, global shutter, 10 bits parallel, monochrome; the sensor of stereo boards.
//!
//! In: a mode. Out: its registers, all of context A.
//!
//! ```text
//! window   (columns x rows) x binning, in the middle of the array
//! row      window width + HORIZONTAL_BLANKING, at least 690 master clocks (26.67 MHz: 26 us)
//! run      CHIP_CONTROL: master with simultaneous readout, or snapshot: a pulse on EXPOSURE starts
//!          exposure, readout follows
//! ```
//! Two of them share a bus: the pins S_CTRL_ADR1 and S_CTRL_ADR0 choose one of four addresses
//! ([`Mt9v034::ADDRESSES`]).
//!
//! # Source
//! onsemi MT9V034/D and MT9V024/D, which has the same interface (addresses, serial interface, least
//! row and blanking); Linux `drivers/media/i2c/mt9v032.c` (names, addresses, chip version 0x1324,
//! ranges, CHIP_CONTROL to start and stop); OpenMV `mt9v0xx.c` (snapshot mode, linear companding,
//! row noise correction off for the test pattern, outputs of AEC and AGC, pixel clock inverted
//! without binning).

use super::{Binning, Config, Exposure, Identity, Model, Shutter, Step, TriggerInput, Wire};
use crate::ports::FrameStart;
use core::ops::RangeInclusive;
use linestereo::Dims;

/// The sensor.
#[derive(Clone, Copy, Debug)]
pub enum Mt9v034 {}

impl Mt9v034 {
    /// 7-bit addresses for S_CTRL_ADR1, S_CTRL_ADR0 = 00, 01, 10, 11.
    pub const ADDRESSES: [u8; 4] = [0x48, 0x4c, 0x58, 0x5c];
    /// Pixels of the array.
    const ARRAY: (u16, u16) = (752, 480);
    /// Master clocks of the shortest row.
    const LEAST_ROW: u16 = 690;
}

const CHIP_VERSION: u16 = 0x00;
const COLUMN_START: u16 = 0x01;
const ROW_START: u16 = 0x02;
const WINDOW_HEIGHT: u16 = 0x03;
const WINDOW_WIDTH: u16 = 0x04;
const HORIZONTAL_BLANKING: u16 = 0x05;
const VERTICAL_BLANKING: u16 = 0x06;
const CHIP_CONTROL: u16 = 0x07;
const COARSE_SHUTTER_WIDTH_TOTAL: u16 = 0x0b;
const RESET: u16 = 0x0c;
const READ_MODE: u16 = 0x0d;
const SENSOR_TYPE_HDR: u16 = 0x0f;
const ADC_COMPANDING: u16 = 0x1c;
const ANALOG_GAIN: u16 = 0x35;
const ROW_NOISE_CORRECTION: u16 = 0x70;
const PIXEL_CLOCK: u16 = 0x72;
const TEST_PATTERN: u16 = 0x7f;
const AEC_AGC_ENABLE: u16 = 0xaf;
const AGC_AEC_PIXEL_COUNT: u16 = 0xb0;
const AGC_GAIN_OUTPUT: u16 = 0xba;
const AEC_EXPOSURE_OUTPUT: u16 = 0xbb;
const FINE_SHUTTER_WIDTH_TOTAL: u16 = 0xd5;

/// CHIP_CONTROL: mode in bits 4:3 (1 master, 3 snapshot), parallel outputs on (7), readout while
/// the next frame is exposed (8).
const MASTER: u16 = 1 << 8 | 1 << 7 | 1 << 3;
const SNAPSHOT: u16 = 1 << 8 | 1 << 7 | 3 << 3;
/// READ_MODE after a reset: reserved bits that stay.
const READ_MODE_RESERVED: u16 = 0x0300;
/// PIXEL_CLOCK: PIXCLK is inverted (4).
const INVERTED: u16 = 1 << 4;
/// TEST_PATTERN: on (13), grey levels that change from column to column (12:11).
const VERTICAL_SHADES: u16 = 1 << 13 | 1 << 11;
/// The gain's bits of ANALOG_GAIN and AGC_GAIN_OUTPUT: 16 is 1, 64 is 4.
const GAIN: u16 = 0x7f;

impl Model for Mt9v034 {
    const NAME: &'static str = "MT9V034";
    const WIRE: Wire = Wire::Short16;
    const SHUTTER: Shutter = Shutter::Global;
    const TRIGGER: TriggerInput = TriggerInput::Pulse { us: 10 };
    const ROWS: RangeInclusive<u16> = 1..=32765;
    const IDENTITY: &'static [Identity] = &[Identity { register: CHIP_VERSION, value: 0x1324 }];
    const RESET: &'static [Step] =
        &[Step::command(RESET, 1).then_wait(100), Step::command(RESET, 0).then_wait(100)];
    const STANDBY: &'static [Step] = &[Step::set(CHIP_CONTROL, 0)];
    const AUTO: &'static [Step] = &[Step::set(AEC_AGC_ENABLE, 0b11)];

    fn has_size(dims: Dims, binning: Binning) -> bool {
        let (width, height) = binning.window(dims);
        let (columns, rows) = Self::ARRAY;
        // Whole words for a DMA, and a window that has a middle.
        let is_even = dims.width.is_multiple_of(4) && dims.height.is_multiple_of(2);
        is_even && (64..=columns).contains(&width) && (32..=rows).contains(&height)
    }

    fn mode(config: &Config) -> impl Iterator<Item = Step> {
        let (width, height) = config.binning.window(config.dims);
        let (columns, rows) = Self::ARRAY;
        // At the full rate pixels are valid around the rising edge of PIXCLK only; inverted it is
        // the falling one, as it is with binning.
        let (bits, pixel_clock) = match config.binning {
            Binning::One => (0, INVERTED),
            Binning::Two => (0b0101, 0),
            Binning::Four => (0b1010, 0),
        };
        let pixels = u32::from(config.dims.width) * u32::from(config.dims.height);
        // Noise is corrected by the mean of a row's dark pixels, which a pattern does not have.
        let (pattern, correction) =
            if config.test_pattern { (VERTICAL_SHADES, 0) } else { (0, 0x0101) };
        [
            Step::set(CHIP_CONTROL, 0),
            Step::set(COLUMN_START, 1 + columns.saturating_sub(width) / 2),
            Step::set(ROW_START, 4 + rows.saturating_sub(height) / 2),
            Step::set(WINDOW_WIDTH, width),
            Step::set(WINDOW_HEIGHT, height),
            // 94 is the value after a reset; 61, 71 and 91 are needed without and with binning.
            Step::set(HORIZONTAL_BLANKING, Self::LEAST_ROW.saturating_sub(width).max(94)),
            Step::set(VERTICAL_BLANKING, 45),
            Step::set(READ_MODE, READ_MODE_RESERVED | bits).keeping(0x3f),
            Step::set(SENSOR_TYPE_HDR, 0),
            Step::set(ADC_COMPANDING, 0x0202),
            Step::set(AGC_AEC_PIXEL_COUNT, u16::try_from(pixels / 8).unwrap_or(u16::MAX)),
            Step::set(ROW_NOISE_CORRECTION, correction),
            Step::set(PIXEL_CLOCK, pixel_clock),
            Step::set(TEST_PATTERN, pattern),
        ]
        .into_iter()
    }

    fn run(config: &Config) -> impl Iterator<Item = Step> {
        let control = match config.start {
            FrameStart::Free => MASTER,
            FrameStart::Triggered => SNAPSHOT,
        };
        [Step::set(CHIP_CONTROL, control)].into_iter()
    }

    fn has_gain(gain_code: u16) -> bool {
        (16..=64).contains(&gain_code)
    }

    fn exposure(exposure: Exposure) -> impl Iterator<Item = Step> {
        [
            Step::set(AEC_AGC_ENABLE, 0),
            Step::set(FINE_SHUTTER_WIDTH_TOTAL, 0),
            Step::set(COARSE_SHUTTER_WIDTH_TOTAL, exposure.rows),
            Step::set(ANALOG_GAIN, exposure.gain_code).keeping(GAIN),
        ]
        .into_iter()
    }

    fn read_exposure<E>(mut read: impl FnMut(u16) -> Result<u16, E>) -> Result<Exposure, E> {
        let is_auto = read(AEC_AGC_ENABLE)? & 0b11 != 0;
        let (rows, gain) = if is_auto {
            (AEC_EXPOSURE_OUTPUT, AGC_GAIN_OUTPUT)
        } else {
            (COARSE_SHUTTER_WIDTH_TOTAL, ANALOG_GAIN)
        };
        Ok(Exposure { rows: read(rows)?, gain_code: read(gain)? & GAIN })
    }

    fn gain_code(gain_q6: u16) -> Option<u16> {
        Some(gain_q6 / 4).filter(|&code| Self::has_gain(code))
    }

    fn gain_q6(gain_code: u16) -> u16 {
        (gain_code & GAIN) * 4
    }
}
