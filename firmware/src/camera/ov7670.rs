//! OV7670: 640x480, colour, rolling shutter, no trigger; what hobbyists own.
//!
//! In: a mode. Out: its registers. It sends YUYV: two bytes a pixel, of which the first is the grey
//! level.
//!
//! ```text
//! 640x480 every pixel      320x240 two by two      160x120 four by four
//! row     784 pixels of 2 clocks: 65 us at XCLK 24 MHz, 510 rows, 30 frames a second (binned rows
//!         come at the same pace, one in 2 or 4)
//! ```
//! Exposure against flicker, the night mode and white balance are off: they change pictures or the
//! frame rate without being asked.
//!
//! # Cost of the rolling shutter
//! Row `y` is exposed `65 us * y` after row 0, 31 ms from the first to the last. Turning at `w`
//! radians a second, a picture with focal length `f` px moves by `f * w` px a second:
//!
//! ```text
//! skew of a vertical edge   f * w * 31 ms         QVGA with 60 degrees of view (f = 277 px) at 90 degrees a second: 13.6 px
//! error of a disparity      f * w * skew          both cameras read the same row at the same time: 0, if they start together
//! ```
//! So the skew bends the world, the same way in both images; it is the *start* that breaks stereo.
//! And this sensor has no trigger: two of them with one XCLK keep the difference that they happen
//! to start with, up to half a frame: 17 ms, 7.3 px at that speed; with two oscillators it drifts.
//! Driven at 1 m/s past something 1 m away, 17 ms are 4.6 px. The health check refuses such pairs
//! ([`skew_us`](linestereo::health::HealthLimits::skew_us)). Use it standing still, or another
//! sensor.
//!
//! Address 0x21, always: two of them need two buses.
//!
//! # Source
//! Names, addresses, identity, window of VGA, exposure and gain: Linux
//! `drivers/media/i2c/ov7670.c`, which has them from OmniVision. Scaling, columns of QVGA and
//! QQVGA: OmniVision's implementation guide 1.0 as public drivers quote it (Adafruit, Arduino); 784
//! x 510 and the order of YUYV are the guide's. The columns of the smaller sizes are by trial, not
//! of the data sheet.

use super::{Binning, Config, Exposure, Identity, Model, Shutter, Step, TriggerInput, Wire};
use core::ops::RangeInclusive;
use linestereo::Dims;

/// The sensor.
#[derive(Clone, Copy, Debug)]
pub enum Ov7670 {}

impl Ov7670 {
    /// Its 7-bit address.
    pub const ADDRESS: u8 = 0x21;
}

const GAIN: u16 = 0x00;
const VREF: u16 = 0x03;
const COM1: u16 = 0x04;
const AECHH: u16 = 0x07;
const COM2: u16 = 0x09;
const PID: u16 = 0x0a;
const VER: u16 = 0x0b;
const COM3: u16 = 0x0c;
const AECH: u16 = 0x10;
const CLKRC: u16 = 0x11;
const COM7: u16 = 0x12;
const COM8: u16 = 0x13;
const COM9: u16 = 0x14;
const COM10: u16 = 0x15;
const HSTART: u16 = 0x17;
const HSTOP: u16 = 0x18;
const VSTART: u16 = 0x19;
const VSTOP: u16 = 0x1a;
const HREF: u16 = 0x32;
const TSLB: u16 = 0x3a;
const COM11: u16 = 0x3b;
const COM13: u16 = 0x3d;
const COM14: u16 = 0x3e;
const COM15: u16 = 0x40;
const DBLV: u16 = 0x6b;
const SCALING_XSC: u16 = 0x70;
const SCALING_YSC: u16 = 0x71;
const SCALING_DCWCTR: u16 = 0x72;
const SCALING_PCLK_DIV: u16 = 0x73;
const RGB444: u16 = 0x8c;
const SCALING_PCLK_DELAY: u16 = 0xa2;

/// COM2: soft sleep (4), outputs drive two loads (1:0 = 1).
const ASLEEP: u16 = 0x11;
const AWAKE: u16 = 0x01;
/// COM8: fast (7), any step (6), and automatic gain (2) and exposure (0); no flicker filter (5), no
/// white balance (1).
const FIXED_EXPOSURE: u16 = 0xc0;
const AUTO_EXPOSURE: u16 = 0xc5;
/// VREF 3:0: the low bits of VSTOP and VSTART, next to those of the gain.
const ROWS_LOW: u16 = 0x0a;

impl Model for Ov7670 {
    const NAME: &'static str = "OV7670";
    const WIRE: Wire = Wire::Sccb;
    const SHUTTER: Shutter = Shutter::Rolling;
    const TRIGGER: TriggerInput = TriggerInput::None;
    const PIXEL_BYTES: u16 = 2;
    /// Those of a frame: a longer exposure slows it down.
    const ROWS: RangeInclusive<u16> = 1..=510;
    const IDENTITY: &'static [Identity] =
        &[Identity { register: PID, value: 0x76 }, Identity { register: VER, value: 0x73 }];
    const RESET: &'static [Step] =
        &[Step::command(COM7, 0x80).then_wait(2000), Step::set(COM2, ASLEEP)];
    const STANDBY: &'static [Step] = &[Step::set(COM2, ASLEEP)];
    const AUTO: &'static [Step] = &[Step::set(COM8, AUTO_EXPOSURE)];

    fn has_size(dims: Dims, binning: Binning) -> bool {
        binning.window(dims) == (640, 480)
    }

    fn mode(config: &Config) -> impl Iterator<Item = Step> {
        let [com3, com14, dcw, divider] = match config.binning {
            Binning::One => [0x00, 0x00, 0x11, 0xf0],
            Binning::Two => [0x04, 0x19, 0x11, 0xf1],
            Binning::Four => [0x04, 0x1a, 0x22, 0xf2],
        };
        let [start, stop, low] = match config.binning {
            Binning::One => [0x13, 0x01, 0xb6],
            Binning::Two => [0x16, 0x04, 0x24],
            Binning::Four => [0x16, 0x04, 0xa4],
        };
        let bars = if config.test_pattern { 0x80 } else { 0 };
        [
            Step::set(CLKRC, 0x40).keeping(0x7f), // XCLK as it is
            Step::set(DBLV, 0x0a).keeping(0xc0),  // no PLL
            Step::set(COM7, 0x00),                // YUV
            Step::set(RGB444, 0x00),
            Step::set(TSLB, 0x04),  // with COM13: Y U Y V
            Step::set(COM13, 0xc0), // gamma; U and V are not used
            Step::set(COM15, 0xc0), // 0 ..= 255
            Step::set(COM9, 0x48),  // gain up to 32
            Step::set(COM10, 0x00), // HREF; VSYNC is high between frames
            Step::set(COM11, 0x00), // no night mode
            Step::set(COM3, com3),
            Step::set(COM14, com14),
            Step::set(SCALING_XSC, 0x3a | bars),
            Step::set(SCALING_YSC, 0x35),
            Step::set(SCALING_DCWCTR, dcw),
            Step::set(SCALING_PCLK_DIV, divider),
            Step::set(SCALING_PCLK_DELAY, 0x02),
            Step::set(HSTART, start),
            Step::set(HSTOP, stop),
            Step::set(HREF, low),
            Step::set(VSTART, 0x02),
            Step::set(VSTOP, 0x7a),
            Step::set(VREF, ROWS_LOW).keeping(0x0f),
        ]
        .into_iter()
    }

    fn run(_: &Config) -> impl Iterator<Item = Step> {
        [Step::set(COM2, AWAKE)].into_iter()
    }

    fn has_gain(gain_code: u16) -> bool {
        gain_code < 1 << 10
    }

    fn exposure(exposure: Exposure) -> impl Iterator<Item = Step> {
        let Exposure { rows, gain_code } = exposure;
        [
            Step::set(COM8, FIXED_EXPOSURE),
            Step::set(AECHH, rows >> 10 & 0x3f).keeping(0x3f),
            Step::set(AECH, rows >> 2 & 0xff),
            Step::set(COM1, rows & 0x03).keeping(0x03),
            Step::set(VREF, (gain_code >> 8 & 0x03) << 6 | ROWS_LOW),
            Step::set(GAIN, gain_code & 0xff),
        ]
        .into_iter()
    }

    fn read_exposure<E>(mut read: impl FnMut(u16) -> Result<u16, E>) -> Result<Exposure, E> {
        let rows = (read(AECHH)? & 0x3f) << 10 | read(AECH)? << 2 | read(COM1)? & 0x03;
        Ok(Exposure { rows, gain_code: (read(VREF)? & 0xc0) << 2 | read(GAIN)? })
    }

    /// Each of bits 9:4 doubles, bits 3:0 add sixteenths.
    fn gain_code(gain_q6: u16) -> Option<u16> {
        let doublings = (0..=6).find(|&n| gain_q6 >> n < 128)?;
        let sixteenths = (gain_q6 >> doublings >> 2).checked_sub(16)?;
        Some(((1 << doublings) - 1) << 4 | sixteenths)
    }

    fn gain_q6(gain_code: u16) -> u16 {
        (((gain_code & 0x0f) + 16) * 4) << (gain_code >> 4 & 0x3f).count_ones()
    }
}
