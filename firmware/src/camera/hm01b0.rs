//! HM01B0: 324x324, of which 324x244 are read here; a few milliwatts; rolling shutter.
//!
//! In: a mode. Out: its registers.
//!
//! ```text
//! 324x244  every pixel, QVGA window        162x122  two by two made one
//! row      376 pixel clocks; MCLK is divided by 2: 125 us and 30 frames a second at 6 MHz, the
//!          double at 12 MHz
//! run      MODE_SELECT: streaming (1), or frames while TRIG is high (5)
//! ```
//! The two pixels at each side and the two rows above and below 320x240 are real pixels. Rows
//! follow each other: at 30 frames a second the last row is exposed 30 ms after the first one. With
//! one trigger both sensors are skewed alike, row by row (`docs/cameras.md` has what that costs).
//!
//! Address 0x24; two of them need two buses, or a board that gives one another address.
//!
//! # Source
//! Himax's register names and addresses, formats of gain, modes and the vendor's analogue settings
//! as OpenMV's `hm01b0_regs.h` and `hm01b0.c` and Zephyr's `drivers/video/hm01b0.c` have them; the
//! data sheet (HM01B0-MNA) itself was not at hand. Addresses from 0x3044 to 0x3058 have no public
//! names. Bits of BIT_CONTROL (6: 4 bits, 5: serial) and OSC_CLK_DIV (5: gated PCLKO, 4: most
//! significant bits first, 1:0: MCLK / 8, 4, 2, 1): Himax's own comments in public register lists;
//! four wires, two PCLKO a pixel and the lower half first with bit 4 off: Arm's
//! `hm01b0-library-for-pico`, `src/hm01b0.c`. PCLK_POLARITY, bit 0: OpenMV sets it and takes pixels
//! at falling edges (`pixck_pol = 0`); Arm's library leaves it off and takes them at rising ones.
//!
//! Trigger: Himax's comment at MODE_SELECT has "wait for HW trigger (level), then continuous video
//! out til HW TRIG goes off" for 4 and nothing for 5; Synaptics' `hm01b0.c` ends in 5 with 0x3064 =
//! 4 (`[2]: Trigger En`; 0 is `Trigger SYNC mode disable`, hence the name here), Ambiq's driver
//! holds TRIG high while it streams. ANA_REGISTER_17, bit 1 (the trigger is taken at the falling
//! edge of MCLK): the same file sets it; here it is off, as in OpenMV. Walking ones (0x11):
//! `hm01b0-esp-idf-driver`.

use super::{Binning, Config, Exposure, Identity, Model, Shutter, Step, TriggerInput, Wire};
use crate::ports::FrameStart;
use core::ops::RangeInclusive;
use linestereo::Dims;

/// The sensor, with so many data wires: 8 or 4.
#[derive(Clone, Copy, Debug)]
pub enum Hm01b0Over<const WIRES: u8> {}

/// A pixel at once, on D7 .. D0.
pub type Hm01b0 = Hm01b0Over<8>;
/// A pixel in two halves, the lower one first, on D3 .. D0: PCLKO is twice as fast.
pub type Hm01b0Nibbles = Hm01b0Over<4>;

impl<const WIRES: u8> Hm01b0Over<WIRES> {
    /// Its 7-bit address.
    pub const ADDRESS: u8 = 0x24;

    /// The register of the wires (bit 6: four of them), and the step of any other register as it
    /// is.
    fn on_wires(step: Step) -> Step {
        const { assert!(WIRES == 8 || WIRES == 4) };
        if step.register == BIT_CONTROL && WIRES == 4 {
            Step { value: step.value | 0x40, ..step }
        } else {
            step
        }
    }
}

const MODEL_ID_H: u16 = 0x0000;
const MODEL_ID_L: u16 = 0x0001;
const MODE_SELECT: u16 = 0x0100;
const IMG_ORIENTATION: u16 = 0x0101;
const SW_RESET: u16 = 0x0103;
const GRP_PARAM_HOLD: u16 = 0x0104;
const INTEGRATION_H: u16 = 0x0202;
const INTEGRATION_L: u16 = 0x0203;
const ANALOG_GAIN: u16 = 0x0205;
const DIGITAL_GAIN_H: u16 = 0x020e;
const DIGITAL_GAIN_L: u16 = 0x020f;
const FRAME_LEN_LINES_H: u16 = 0x0340;
const FRAME_LEN_LINES_L: u16 = 0x0341;
const LINE_LEN_PCK_H: u16 = 0x0342;
const LINE_LEN_PCK_L: u16 = 0x0343;
const DGAIN_CONTROL: u16 = 0x0350;
const READOUT_X: u16 = 0x0383;
const READOUT_Y: u16 = 0x0387;
const BINNING_MODE: u16 = 0x0390;
const TEST_PATTERN_MODE: u16 = 0x0601;
const BLC_CFG: u16 = 0x1000;
const BLC_DITHER: u16 = 0x1001;
const BLC_DARKPIXEL: u16 = 0x1002;
const BLC_TGT: u16 = 0x1003;
const BLI_EN: u16 = 0x1006;
const BLC2_TGT: u16 = 0x1007;
const DPC_CTRL: u16 = 0x1008;
const CLUSTER_THR_HOT: u16 = 0x1009;
const CLUSTER_THR_COLD: u16 = 0x100a;
const SINGLE_THR_HOT: u16 = 0x100b;
const SINGLE_THR_COLD: u16 = 0x100c;
const VSYNC_HSYNC_PIXEL_SHIFT_EN: u16 = 0x1012;
const STATISTIC_CTRL: u16 = 0x2000;
const AE_CTRL: u16 = 0x2100;
const AE_TARGET_MEAN: u16 = 0x2101;
const MAX_INTG_H: u16 = 0x2105;
const MAX_INTG_L: u16 = 0x2106;
const MAX_AGAIN_FULL: u16 = 0x2108;
const MAX_AGAIN_BIN2: u16 = 0x2109;
const MAX_DGAIN: u16 = 0x210b;
const FS_CTRL: u16 = 0x210e;
const MD_CTRL: u16 = 0x2150;
const QVGA_WIN_EN: u16 = 0x3010;
const BIT_CONTROL: u16 = 0x3059;
const OSC_CLK_DIV: u16 = 0x3060;
const TRIGGER_SYNC: u16 = 0x3064;
const ANA_REGISTER_17: u16 = 0x3067;
const PCLK_POLARITY: u16 = 0x3068;

/// Pixel clocks of a row.
const ROW: u16 = 376;
/// Rows of time that a frame takes: 324x244, and two by two.
const ROWS: u16 = 260;
const ROWS_BINNED: u16 = 132;
/// Takes over what was written since the last time.
const TAKE_OVER: Step = Step::command(GRP_PARAM_HOLD, 1);

/// Analogue settings for every mode. What has no public name is only written, and of the others the
/// bits are compared whose meaning is known: nobody promises that reserved bits read as written.
const VENDOR: &[Step] = &[
    Step::command(0x3044, 0x0a), // correlated double sampling: time to settle
    Step::command(0x3045, 0x00),
    Step::command(0x3047, 0x0a),
    Step::command(0x3050, 0xc0), // negative offset
    Step::command(0x3051, 0x42),
    Step::command(0x3052, 0x50),
    Step::command(0x3053, 0x00),
    Step::command(0x3054, 0x03), // clamp
    Step::command(0x3055, 0xf7),
    Step::command(0x3056, 0xf8),
    Step::command(0x3057, 0x29), // converter
    Step::command(0x3058, 0x1f), // dark sun
    Step::command(0x3065, 0x04),
    Step::set(ANA_REGISTER_17, 0x00).keeping(0x03), // MCLK instead of the oscillator: both sensors have one clock
    Step::set(BLC_CFG, 0x43),
    Step::set(BLC_DITHER, 0x43),
    Step::set(BLC_DARKPIXEL, 0x43),
    Step::set(BLC_TGT, 0x00),
    Step::set(BLC2_TGT, 0x08),
    Step::set(BLI_EN, 0x01),
    Step::set(DGAIN_CONTROL, 0x7f),
    Step::set(DPC_CTRL, 0x01), // hot and cold pixels of a monochrome sensor
    Step::set(CLUSTER_THR_HOT, 0xa0),
    Step::set(CLUSTER_THR_COLD, 0x60),
    Step::set(SINGLE_THR_HOT, 0x90),
    Step::set(SINGLE_THR_COLD, 0x40),
    Step::set(VSYNC_HSYNC_PIXEL_SHIFT_EN, 0x00),
    Step::set(STATISTIC_CTRL, 0x07),
    Step::set(AE_TARGET_MEAN, 0x64),
    Step::set(MAX_AGAIN_FULL, 0x04),
    Step::set(MAX_AGAIN_BIN2, 0x04),
    Step::set(MAX_DGAIN, 0xc0),
    Step::set(FS_CTRL, 0x00), // no steps of exposure against flicker: they differ between sensors
    Step::set(MD_CTRL, 0x00), // no motion detection
    Step::set(BIT_CONTROL, 0x02).keeping(0xe0), // 8 bits at once; `on_wires`
    Step::set(OSC_CLK_DIV, 0x0a).keeping(0x3f), // MCLK / 2
    Step::set(PCLK_POLARITY, 0x21).keeping(0x01), // data are valid at the falling edge
    Step::set(IMG_ORIENTATION, 0x00),
];

/// The last steps before frames with the test pattern. Whatever reckons with what each sensor sees
/// is off: the same bytes from both.
const PATTERN: &[Step] = &[
    Step::set(AE_CTRL, 0),
    Step::set(BLC_CFG, 0),
    Step::set(DPC_CTRL, 0),
    Step::set(ANALOG_GAIN, 0),
    Step::set(DIGITAL_GAIN_H, 0x01), // 1
    Step::set(DIGITAL_GAIN_L, 0x00),
    Step::set(TEST_PATTERN_MODE, 0x11), // walking ones: a swapped wire or half shows
    TAKE_OVER,
];

impl<const WIRES: u8> Model for Hm01b0Over<WIRES> {
    const NAME: &'static str = "HM01B0";
    const WIRE: Wire = Wire::Long8;
    const SHUTTER: Shutter = Shutter::Rolling;
    const TRIGGER: TriggerInput = TriggerInput::Level;
    /// More rows than a frame of the smaller mode has would slow it down.
    const ROWS: RangeInclusive<u16> = 2..=ROWS - 2;
    const IDENTITY: &'static [Identity] = &[
        Identity { register: MODEL_ID_H, value: 0x01 },
        Identity { register: MODEL_ID_L, value: 0xb0 },
    ];
    /// One that runs may end its frame first: 33 ms at 6 MHz.
    const RESET: &'static [Step] = &[
        Step::command(MODE_SELECT, 0),
        Step::command(SW_RESET, 1).then_wait(40_000),
        Step::expect(MODE_SELECT, 0),
    ];
    const STANDBY: &'static [Step] = &[Step::set(MODE_SELECT, 0)];
    const AUTO: &'static [Step] = &[Step::set(AE_CTRL, 1), TAKE_OVER];

    fn has_size(dims: Dims, binning: Binning) -> bool {
        binning != Binning::Four && binning.window(dims) == (324, 244)
    }

    fn mode(config: &Config) -> impl Iterator<Item = Step> {
        let (readout, binning, rows) = match config.binning {
            Binning::One => (0x01, 0x00, ROWS),
            _ => (0x03, 0x03, ROWS_BINNED),
        };
        let trigger = match config.start {
            FrameStart::Free => 0x00,
            FrameStart::Triggered => 0x04,
        };
        let [[rows_high, rows_low], [row_high, row_low], [most_high, most_low]] =
            [rows, ROW, rows - 2].map(bytes);
        let sized = [
            Step::set(READOUT_X, readout),
            Step::set(READOUT_Y, readout),
            Step::set(BINNING_MODE, binning),
            Step::set(QVGA_WIN_EN, 0x01),
            Step::set(FRAME_LEN_LINES_H, rows_high),
            Step::set(FRAME_LEN_LINES_L, rows_low),
            Step::set(LINE_LEN_PCK_H, row_high),
            Step::set(LINE_LEN_PCK_L, row_low),
            Step::set(MAX_INTG_H, most_high),
            Step::set(MAX_INTG_L, most_low),
            // After a reset it is 264, which is more than a frame has: nobody could give it to the
            // other sensor.
            Step::set(INTEGRATION_H, most_high),
            Step::set(INTEGRATION_L, most_low),
            Step::set(TRIGGER_SYNC, trigger).keeping(0x04),
            Step::set(TEST_PATTERN_MODE, 0),
            TAKE_OVER,
        ];
        VENDOR.iter().copied().map(Self::on_wires).chain(sized)
    }

    fn run(config: &Config) -> impl Iterator<Item = Step> {
        let mode = match config.start {
            FrameStart::Free => 0x01,
            FrameStart::Triggered => 0x05,
        };
        let pattern = if config.test_pattern { PATTERN } else { &[] };
        pattern.iter().copied().chain([Step::set(MODE_SELECT, mode)])
    }

    fn has_gain(gain_code: u16) -> bool {
        let (analog, digital) = split(gain_code);
        analog <= 0x40 && (0x40..=0x3fc).contains(&digital) && gain_code < 1 << 13
    }

    fn exposure(exposure: Exposure) -> impl Iterator<Item = Step> {
        let (analog, digital) = split(exposure.gain_code);
        let ([rows_high, rows_low], [digital_high, digital_low]) =
            (bytes(exposure.rows), bytes(digital));
        [
            Step::set(AE_CTRL, 0),
            Step::set(INTEGRATION_H, rows_high),
            Step::set(INTEGRATION_L, rows_low),
            Step::set(ANALOG_GAIN, analog),
            Step::set(DIGITAL_GAIN_H, digital_high),
            Step::set(DIGITAL_GAIN_L, digital_low),
            TAKE_OVER,
        ]
        .into_iter()
    }

    fn read_exposure<E>(mut read: impl FnMut(u16) -> Result<u16, E>) -> Result<Exposure, E> {
        let rows = read(INTEGRATION_H)? << 8 | read(INTEGRATION_L)?;
        let analog = read(ANALOG_GAIN)? & 0x70;
        let digital = (read(DIGITAL_GAIN_H)? & 0x03) << 8 | read(DIGITAL_GAIN_L)? & 0xfc;
        Ok(Exposure { rows, gain_code: analog << 6 | digital })
    }

    /// Bits 12:10 are the doublings (ANALOG_GAIN), 9:0 the digital gain in 1/256, of which the last
    /// two are 0.
    fn gain_code(gain_q6: u16) -> Option<u16> {
        let doublings = (0..=4).rev().find(|&n| gain_q6 >> n >= 64)?;
        // The digital gain is 0.25 ..= 3.98 in steps of 1/64; here it is 1 ..= 2, so that the
        // analogue one does the most.
        let digital_q6 = gain_q6 >> doublings;
        (digital_q6 < 256).then_some(doublings << 10 | digital_q6 << 2)
    }

    fn gain_q6(gain_code: u16) -> u16 {
        let (analog, digital) = split(gain_code);
        (digital >> 2) << (analog >> 4)
    }
}

/// The registers of a gain.
const fn split(gain_code: u16) -> (u16, u16) {
    (gain_code >> 6 & 0x70, gain_code & 0x3ff)
}

fn bytes(value: u16) -> [u16; 2] {
    value.to_be_bytes().map(u16::from)
}
