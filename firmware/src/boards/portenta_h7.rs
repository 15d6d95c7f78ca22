//! Arduino Portenta H7 (STM32H747XI, its Cortex-M7) with two MT9V034 whose rows come as one: left,
//! then right. `docs/boards/portenta-h7.md`.

use linestereo_boards::Board;

/// Its description.
pub const BOARD: Board = Board::PORTENTA_H7;

/// Its memory.
pub type BoardMemory = board_memory!(BOARD);

#[cfg(all(target_os = "none", feature = "portenta-h7"))]
pub(super) use on_board::ROW;
#[cfg(all(target_os = "none", feature = "portenta-h7"))]
pub use on_board::{bare, peripherals};

#[cfg(all(target_os = "none", feature = "portenta-h7"))]
mod on_board {
    use crate::boards::stm32h7::bootloader;
    use crate::boards::stm32h7::camera::{DIMS, PATIENCE_US, Row, sensors};
    use crate::boards::stm32h7::clocks::{self, FrameClock, MicrosecondClock};
    use crate::boards::stm32h7::dcmi::DcmiStream;
    use crate::boards::stm32h7::kept::KeptFlash;
    use crate::boards::stm32h7::light::Light;
    use crate::boards::stm32h7::memory;
    use crate::boards::stm32h7::ports::{self, HostPort};
    use crate::boards::stm32h7::reset::{self, IndependentDog};
    use crate::boards::stm32h7::silicon;
    use crate::boards::{stm32h7, usb_port};
    use crate::camera::{NoReset, ResetPin, Trigger};
    use crate::capture::{CameraSource, Capture, SideBySide};
    use crate::ports::{FrameStart, PairSource};
    use core::mem::MaybeUninit;
    use embassy_executor::SendSpawner;
    use embassy_stm32::gpio::{AnyPin, Level, Output, OutputType, Speed};
    use embassy_stm32::pac::{self, interrupt};
    use embassy_stm32::peripherals::{
        IWDG1, PA3, PA5, PA9, PA10, PB0, PB1, PB5, PB10, PB11, PB12, PB13, PC0, PH1, PH4, PI11,
        PJ4, USART1, USART6, USB_OTG_HS,
    };
    use embassy_stm32::time::Hertz;
    use embassy_stm32::timer::low_level::CountingMode;
    use embassy_stm32::timer::simple_pwm::{PwmPin, SimplePwm};
    use embassy_stm32::usart;
    use embassy_stm32::{Peri, Peripherals, SharedData, bind_interrupts, usb};
    use embassy_time::{Duration, block_for};
    use linestereo_wire::Reset;
    use static_cell::StaticCell;

    /// Contents of a row of its camera interface.
    pub(in crate::boards) const ROW: Row = Row::Both;

    bind_interrupts!(struct Interrupts {
        OTG_HS => usb::InterruptHandler<USB_OTG_HS>;
        USART1 => usart::BufferedInterruptHandler<USART1>;
        USART6 => usart::BufferedInterruptHandler<USART6>;
    });

    /// Of the sensors: an eighth of the timer's 200 MHz.
    const SENSOR_HZ: u32 = 25_000_000;

    /// For the other core, which is not started.
    static SHARED: MaybeUninit<SharedData> = MaybeUninit::uninit();

    /// Pins of the board's USB3320, a high-speed PHY.
    struct Ulpi {
        clock: Peri<'static, PA5>,
        direction: Peri<'static, PI11>,
        next: Peri<'static, PH4>,
        stop: Peri<'static, PC0>,
        data: UlpiData,
    }

    /// Data lines 0 to 7.
    type UlpiData = (
        Peri<'static, PA3>,
        Peri<'static, PB0>,
        Peri<'static, PB1>,
        Peri<'static, PB10>,
        Peri<'static, PB11>,
        Peri<'static, PB12>,
        Peri<'static, PB13>,
        Peri<'static, PB5>,
    );

    #[embassy_executor::task]
    async fn serve_usb(port: Peri<'static, USB_OTG_HS>, pins: Ulpi) {
        static PACKETS: StaticCell<[u8; 1024]> = StaticCell::new();
        let mut config = usb::Config::default();
        config.vbus_detection = false;
        let Ulpi { clock, direction, next, stop, data: (d0, d1, d2, d3, d4, d5, d6, d7) } = pins;
        let packets = PACKETS.init([0; 1024]);
        let driver = usb::Driver::new_hs_ulpi(
            port, Interrupts, clock, direction, next, stop, d0, d1, d2, d3, d4, d5, d6, d7,
            packets, config,
        );
        usb_port::run::<512, _>(driver, super::BOARD.name, embassy_stm32::uid::uid_hex()).await
    }

    /// The PHY's oscillator on, and the PHY out of its reset (16 ms, far more than its datasheet's
    /// 1 us, let the oscillator start).
    fn start_phy(oscillator: Peri<'static, PH1>, reset: Peri<'static, PJ4>) {
        let oscillator = Output::new(oscillator, Level::High, Speed::Low);
        let mut reset = Output::new(reset, Level::Low, Speed::Low);
        block_for(Duration::from_millis(16));
        reset.set_high();
        block_for(Duration::from_millis(16));
        core::mem::forget((oscillator, reset));
    }

    fn output(pin: Peri<'static, AnyPin>) -> Output<'static> {
        Output::new(pin, Level::Low, Speed::Low)
    }

    /// USB with its PHY.
    struct Usb {
        port: Peri<'static, USB_OTG_HS>,
        pins: Ulpi,
        oscillator: Peri<'static, PH1>,
        reset: Peri<'static, PJ4>,
    }

    /// Caches and clocks, for every program; and why the chip was reset.
    fn start() -> (Peripherals, Option<Reset>) {
        bootloader::follow_word();
        memory::prepare();
        let reset = reset::cause();
        clocks::take_over();
        let p = embassy_stm32::init_primary(clocks::config(), &SHARED);
        clocks::follow_usb_frames(FrameClock::Usb1);
        (p, reset)
    }

    /// The watchdog, the host's port, and what runs the tasks of ports, for every program.
    fn start_host(
        watchdog: Peri<'static, IWDG1>,
        usb: Usb,
        (uart, receive, transmit): (Peri<'static, USART1>, Peri<'static, PA10>, Peri<'static, PA9>),
    ) -> Option<(IndependentDog, HostPort, SendSpawner)> {
        // Before the ports: a USB that does not answer would keep them waiting for ever.
        let watchdog = IndependentDog::start(watchdog);
        let spawner = ports::executor([interrupt::USART1, interrupt::USART6], interrupt::OTG_HS)?;
        start_phy(usb.oscillator, usb.reset);
        spawner.spawn(serve_usb(usb.port, usb.pins).ok()?);
        let host = ports::host_port(spawner, uart, (receive, transmit), Interrupts)?;
        Some((watchdog, host, spawner))
    }

    /// Peripherals of `selftest`.
    pub fn bare() -> Option<silicon::Bare> {
        let (p, reset) = start();
        let data = (p.PA3, p.PB0, p.PB1, p.PB10, p.PB11, p.PB12, p.PB13, p.PB5);
        let pins = Ulpi { clock: p.PA5, direction: p.PI11, next: p.PH4, stop: p.PC0, data };
        let usb = Usb { port: p.USB_OTG_HS, pins, oscillator: p.PH1, reset: p.PJ4 };
        let (watchdog, host, _) = start_host(p.IWDG1, usb, (p.USART1, p.PA10, p.PA9))?;
        Some(silicon::bare(p.RCC, host, watchdog, reset))
    }

    /// Peripherals of `live`.
    pub fn peripherals() -> Option<stm32h7::Board<impl PairSource>> {
        static EYES: StaticCell<SideBySide<DcmiStream>> = StaticCell::new();

        let (p, reset) = start();
        let data = (p.PA3, p.PB0, p.PB1, p.PB10, p.PB11, p.PB12, p.PB13, p.PB5);
        let pins = Ulpi { clock: p.PA5, direction: p.PI11, next: p.PH4, stop: p.PC0, data };
        let usb = Usb { port: p.USB_OTG_HS, pins, oscillator: p.PH1, reset: p.PJ4 };
        let (watchdog, host, spawner) = start_host(p.IWDG1, usb, (p.USART1, p.PA10, p.PA9))?;
        let autopilot = ports::autopilot_port(spawner, p.USART6, (p.PC7, p.PC6), Interrupts)?;

        let clock = PwmPin::new(p.PK1, OutputType::PushPull);
        let frequency = Hertz::hz(SENSOR_HZ);
        let mut clock = SimplePwm::new(
            p.TIM1,
            Some(clock),
            None,
            None,
            None,
            frequency,
            CountingMode::EdgeAlignedUp,
        );
        clock.ch1().set_duty_cycle_fraction(1, 2);
        clock.ch1().enable();
        core::mem::forget(clock);
        let data = (p.PH9, p.PH10, p.PH11, p.PH12, p.PH14, p.PI4, p.PI6, p.PI7);
        let stream = DcmiStream::start((p.DCMI, p.DMA1_CH0), data, (p.PI5, p.PA4, p.PA6))?;
        let eyes = &*EYES.init(SideBySide::new(stream));
        let trigger = Trigger::new(output(p.PG7.into())).ok();
        // One pin resets both.
        let resets = (ResetPin(output(p.PC13.into())), NoReset);
        let sensors = sensors(p.I2C3, pac::I2C3, (p.PH7, p.PH8), resets, trigger, SENSOR_HZ);
        let capture = Capture::new(ROW.limits(), FrameStart::Triggered);
        let pairs = CameraSource::new(eyes.eyes(DIMS.width), sensors, capture, DIMS, PATIENCE_US);
        let light = Light([Output::new(p.PK6, Level::High, Speed::Low)]);
        Some(crate::ports::Peripherals {
            clock: MicrosecondClock,
            host,
            autopilot,
            pairs,
            flash: KeptFlash::slots(p.FLASH),
            watchdog,
            rest: cortex_m::asm::wfe as fn(),
            reset,
            bootloader: Some(bootloader::enter as fn() -> !),
            light,
            second_core: None,
        })
    }
}
