//! STM32H743 with two MT9V034 on one camera interface, in turn: NUCLEO-H743ZI2, WeAct MiniSTM32H7
//! and others. `docs/boards/stm32h743.md`.
//!
//! The pins are those of the 100-pin package, and those of WeAct's camera connector.

use linestereo_boards::Board;

/// Its description.
pub const BOARD: Board = Board::STM32H743;

/// Its memory.
pub type BoardMemory = board_memory!(BOARD);

#[cfg(all(target_os = "none", feature = "stm32h743"))]
pub(super) use on_board::ROW;
#[cfg(all(target_os = "none", feature = "stm32h743"))]
pub use on_board::{bare, peripherals};

#[cfg(all(target_os = "none", feature = "stm32h743"))]
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
    use crate::camera::ResetPin;
    use crate::capture::{CameraSource, Capture, InTurn, Switch};
    use crate::ports::{FrameStart, PairSource};
    use embassy_executor::SendSpawner;
    use embassy_stm32::gpio::{AnyPin, Level, Output, Speed};
    use embassy_stm32::pac::{self, interrupt};
    use embassy_stm32::peripherals::{IWDG1, PA11, PA12, PD8, PD9, USART2, USART3, USB_OTG_FS};
    use embassy_stm32::rcc::{Mco, Mco1Source, McoConfig};
    use embassy_stm32::usart;
    use embassy_stm32::{Peri, Peripherals, bind_interrupts, usb};
    use embassy_time::{Duration, block_for};
    use linestereo_rig::CameraSide;
    use linestereo_wire::Reset;
    use static_cell::StaticCell;

    /// Contents of a row of its camera interface.
    pub(in crate::boards) const ROW: Row = Row::One;

    bind_interrupts!(struct Interrupts {
        OTG_FS => usb::InterruptHandler<USB_OTG_FS>;
        USART2 => usart::BufferedInterruptHandler<USART2>;
        USART3 => usart::BufferedInterruptHandler<USART3>;
    });

    /// Of the sensors: PLL1 Q.
    const SENSOR_HZ: u32 = 26_666_667;

    /// A bus switch between the sensors and the camera interface, and the trigger of both.
    struct BusSwitch {
        /// Low connects the left one.
        select: Output<'static>,
        trigger: Output<'static>,
    }

    impl Switch for BusSwitch {
        /// Both are triggered, the one that is not connected reads out for nobody.
        fn shoot(&mut self, eye: CameraSide) -> bool {
            // The other camera ends its frame later than the one that was connected, by as much as
            // its exposure is longer: a step of automatic exposure.
            block_for(Duration::from_micros(2000));
            self.select.set_level(if eye == CameraSide::Left { Level::Low } else { Level::High });
            block_for(Duration::from_micros(2)); // the switch takes nanoseconds
            self.trigger.set_high();
            block_for(Duration::from_micros(10));
            self.trigger.set_low();
            true
        }
    }

    #[embassy_executor::task]
    async fn serve_usb(
        port: Peri<'static, USB_OTG_FS>,
        plus: Peri<'static, PA12>,
        minus: Peri<'static, PA11>,
    ) {
        static PACKETS: StaticCell<[u8; 256]> = StaticCell::new();
        let mut config = usb::Config::default();
        config.vbus_detection = false; // PA9 is not wired to it on every board
        let driver =
            usb::Driver::new_fs(port, Interrupts, plus, minus, PACKETS.init([0; 256]), config);
        usb_port::run::<64, _>(driver, super::BOARD.name, embassy_stm32::uid::uid_hex()).await
    }

    fn output(pin: Peri<'static, AnyPin>) -> Output<'static> {
        Output::new(pin, Level::Low, Speed::Low)
    }

    /// Caches and clocks, for every program; and why the chip was reset.
    fn start() -> (Peripherals, Option<Reset>) {
        bootloader::follow_word();
        memory::prepare();
        let reset = reset::cause();
        clocks::take_over();
        let p = embassy_stm32::init(clocks::config());
        clocks::follow_usb_frames(FrameClock::Usb2);
        (p, reset)
    }

    /// The watchdog, the host's port, and what runs the tasks of ports, for every program.
    fn start_host(
        watchdog: Peri<'static, IWDG1>,
        (usb, plus, minus): (Peri<'static, USB_OTG_FS>, Peri<'static, PA12>, Peri<'static, PA11>),
        (uart, receive, transmit): (Peri<'static, USART3>, Peri<'static, PD9>, Peri<'static, PD8>),
    ) -> Option<(IndependentDog, HostPort, SendSpawner)> {
        // Before the ports: a USB that does not answer would keep them waiting for ever.
        let watchdog = IndependentDog::start(watchdog);
        let spawner = ports::executor([interrupt::USART2, interrupt::USART3], interrupt::OTG_FS)?;
        spawner.spawn(serve_usb(usb, plus, minus).ok()?);
        let host = ports::host_port(spawner, uart, (receive, transmit), Interrupts)?;
        Some((watchdog, host, spawner))
    }

    /// Peripherals of `selftest`.
    pub fn bare() -> Option<silicon::Bare> {
        let (p, reset) = start();
        let (watchdog, host, _) =
            start_host(p.IWDG1, (p.USB_OTG_FS, p.PA12, p.PA11), (p.USART3, p.PD9, p.PD8))?;
        Some(silicon::bare(p.RCC, host, watchdog, reset))
    }

    /// Peripherals of `live`.
    pub fn peripherals() -> Option<stm32h7::Board<impl PairSource>> {
        static EYES: StaticCell<InTurn<DcmiStream, BusSwitch>> = StaticCell::new();

        let (p, reset) = start();
        let (watchdog, host, spawner) =
            start_host(p.IWDG1, (p.USB_OTG_FS, p.PA12, p.PA11), (p.USART3, p.PD9, p.PD8))?;
        let autopilot = ports::autopilot_port(spawner, p.USART2, (p.PD6, p.PD5), Interrupts)?;

        let _runs_on = Mco::new(p.MCO1, p.PA8, Mco1Source::PLL1_Q, McoConfig::default());
        let data = (p.PC6, p.PC7, p.PE0, p.PE1, p.PE4, p.PD3, p.PE5, p.PE6);
        let stream = DcmiStream::start((p.DCMI, p.DMA1_CH0), data, (p.PB7, p.PA4, p.PA6))?;
        let switch = BusSwitch { select: output(p.PD15.into()), trigger: output(p.PD14.into()) };
        let eyes = &*EYES.init(InTurn::new(stream, switch, DIMS.height));
        let resets = (ResetPin(output(p.PD0.into())), ResetPin(output(p.PD1.into())));
        let sensors = sensors(p.I2C1, pac::I2C1, (p.PB8, p.PB9), resets, None, SENSOR_HZ);
        let capture = Capture::new(ROW.limits(), FrameStart::Triggered);
        let pairs =
            CameraSource::new(eyes.eyes(), eyes.cameras(sensors), capture, DIMS, PATIENCE_US);
        let pairs =
            if cfg!(feature = "still-scene") { pairs.still(2 * PATIENCE_US) } else { pairs };
        let light = Light([output(p.PE3.into()), output(p.PB0.into())]);
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
