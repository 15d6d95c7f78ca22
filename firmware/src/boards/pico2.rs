//! Raspberry Pi Pico 2: RP2350A with two Cortex-M33, 520 KiB of RAM and 4 MiB of flash. Two HM01B0
//! with four data wires each.
//!
//! ```text
//! GP0, 1      UART 0, to and from an autopilot
//! GP2 .. 8    left camera: D0, D1, D2, D3, PCLKO, LVLD, FVLD          GP16, 17   SDA, SCL of the left camera (I2C 0)
//! GP9 .. 15   right camera, the same                                  GP18, 19   SDA, SCL of the right camera (I2C 1)
//! GP25        the board's light
//! GP20        TRIG of both                                            GP21       MCLK of both, 6 MHz
//! ```
//! Eight data wires each would take 28 of the 26 pins. `docs/boards/pico2.md` says more. Not yet
//! run on hardware.

use linestereo_boards::Board;

/// Its description.
pub const BOARD: Board = Board::PICO2;

/// Its memory.
pub type BoardMemory = board_memory!(BOARD);

#[cfg(all(target_os = "none", feature = "pico2"))]
mod wired {
    use super::BOARD;
    use crate::boards::cycles::CycleCounter;
    use crate::boards::rp235x::cameras::Block;
    use crate::boards::rp235x::clock::{Micros, Pause};
    use crate::boards::rp235x::keeper::{Kept, keeper};
    use crate::boards::rp235x::rows::{DIMS, FRAME_ROWS, ROW_BYTES};
    use crate::boards::rp235x::second_core::SecondCore;
    use crate::boards::rp235x::silicon::silicon;
    use crate::boards::rp235x::uart::Autopilot;
    use crate::boards::rp235x::watchdog::{FrameWatchdog, reset_cause};
    use crate::boards::rp235x::{host, i2c};
    use crate::boards::usb_port::UsbPort;
    use crate::camera::{
        Binning, Chip, Config, Hm01b0Nibbles, NoReset, PairExposure, StereoCamera, StereoConfig,
        Trigger,
    };
    use crate::capture::{CameraSource, Capture, Limits};
    use crate::ports::{BarePeripherals, FrameStart, Light, PairSource, Peripherals};
    use core::mem;
    use embassy_rp::clocks::{Gpout, GpoutSrc, clk_sys_freq};
    use embassy_rp::gpio::{Level, Output};
    use embassy_time::{Duration, block_for};
    use linestereo::Dims;
    use linestereo_wire::Reset;

    /// Bytes of the board's flash.
    const FLASH: usize = 4 << 20;
    /// MCLK is the crystal's 12 MHz by this; pixels come at half of it, two PCLKO each.
    const MCLK_DIVIDER: u16 = 2;
    /// A row of 376 pixels, nanoseconds.
    const ROW_NS: u32 = 125_333;
    /// The cameras' raw frames.
    const RAW: Dims = Dims { width: ROW_BYTES as u16, height: FRAME_ROWS as u16 };
    /// Two frames of the longest exposure.
    const PATIENCE_US: u32 = 150_000;

    const LIMITS: Limits = Limits {
        rows: DIMS.height,
        row_bytes: RAW.width,
        row_gap_us: 1000,
        readout_us: 60_000,
        silence_us: 100_000,
        pair_us: 2000,
    };

    const CAMERAS: StereoConfig = StereoConfig {
        config: Config::new(RAW, Binning::One, FrameStart::Triggered),
        exposure: PairExposure::LeftChooses,
        row_ns: ROW_NS,
        readout_us: RAW.height as u32 * (ROW_NS / 1000),
    };

    /// Clocks, for every program; and why the board was reset.
    fn start() -> (embassy_rp::Peripherals, Reset) {
        let board = embassy_rp::init(embassy_rp::config::Config::default()); // 150 MHz
        (board, reset_cause())
    }

    /// Peripherals of `selftest`, once.
    pub fn bare() -> Option<BarePeripherals<CycleCounter, Micros, UsbPort, FrameWatchdog>> {
        let (board, reset) = start();
        let watchdog = FrameWatchdog::start(board.WATCHDOG);
        let clock = Micros::start(cortex_m::Peripherals::take()?.SYST, clk_sys_freq());
        Some(BarePeripherals {
            counter: CycleCounter::start(clk_sys_freq()),
            clock,
            host: host::start(board.USB, BOARD.name),
            watchdog,
            rest: cortex_m::asm::wfe,
            reset: Some(reset),
            silicon: Some(silicon()),
        })
    }

    /// The green light of the board.
    #[expect(missing_debug_implementations, reason = "the HAL's pin has none")]
    pub struct OnboardLight(Output<'static>);

    impl Light for OnboardLight {
        fn set(&mut self, is_on: bool) {
            self.0.set_level(if is_on { Level::High } else { Level::Low });
        }
    }

    /// Time in which bytes that wait for the host are sent.
    const FAREWELL: Duration = Duration::from_millis(200);

    /// Ends the program for the boot ROM's, which shows the board as a drive (RP2350 datasheet,
    /// 5.4.8.24).
    fn enter_bootloader() -> ! {
        block_for(FAREWELL);
        embassy_rp::rom_data::reset_to_usb_boot(0, 0);
        loop {
            cortex_m::asm::nop(); // it takes 10 ms
        }
    }

    /// Peripherals for `live`; once after a reset.
    pub fn peripherals() -> Option<
        Peripherals<
            Micros,
            UsbPort,
            Autopilot,
            impl PairSource,
            Kept<FLASH>,
            FrameWatchdog,
            OnboardLight,
            SecondCore,
        >,
    > {
        let (board, reset) = start();
        let watchdog = FrameWatchdog::start(board.WATCHDOG); // what hangs from here on is reset
        let clock = Micros::start(cortex_m::Peripherals::take()?.SYST, clk_sys_freq());

        let second_core = SecondCore::start(board.CORE1);
        if second_core.is_none() {
            crate::error!("core 1 does not answer: pairs are matched on one core");
        }

        let mclk = Gpout::new(board.PIN_21);
        mclk.set_src(GpoutSrc::Xosc);
        mclk.set_div(MCLK_DIVIDER, 0);
        mclk.enable();
        mem::forget(mclk); // dropped it would stop

        let mut block = Block::new(board.PIO0);
        let common = block.common();
        macro_rules! pins {
            ($($pin:ident)*) => { [$(common.make_pio_pin(board.$pin)),*] };
        }
        let left = pins!(PIN_2 PIN_3 PIN_4 PIN_5 PIN_6 PIN_7 PIN_8);
        let right = pins!(PIN_9 PIN_10 PIN_11 PIN_12 PIN_13 PIN_14 PIN_15);
        let rings = block.start([left, right]);

        let left = i2c::bus(board.I2C0, (board.PIN_17, board.PIN_16));
        let right = i2c::bus(board.I2C1, (board.PIN_19, board.PIN_18));
        let chips = (
            Chip::<Hm01b0Nibbles, _, _>::new(left, Hm01b0Nibbles::ADDRESS, NoReset),
            Chip::<Hm01b0Nibbles, _, _>::new(right, Hm01b0Nibbles::ADDRESS, NoReset),
        );
        let trigger = Trigger::new(Output::new(board.PIN_20, Level::Low)).ok()?;
        let cameras = StereoCamera::new(chips, Some(trigger), Pause, CAMERAS);
        let capture = Capture::new(LIMITS, CAMERAS.config.start);

        Some(Peripherals {
            clock,
            host: host::start(board.USB, BOARD.name),
            autopilot: Autopilot::start(board.UART0, board.PIN_0, board.PIN_1),
            pairs: CameraSource::new(rings, cameras, capture, DIMS, PATIENCE_US),
            flash: keeper(board.FLASH),
            watchdog,
            rest: cortex_m::asm::wfe,
            reset: Some(reset),
            bootloader: Some(enter_bootloader),
            light: OnboardLight(Output::new(board.PIN_25, Level::Low)),
            second_core,
        })
    }
}

#[cfg(all(target_os = "none", feature = "pico2"))]
pub use wired::{bare, peripherals};
