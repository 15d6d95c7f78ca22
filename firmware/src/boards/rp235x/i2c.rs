//! The registers and pins of an I2C block: [`bus`](super::bus) says what is done with them. Not yet
//! run on hardware.
//!
//! embassy-rp's own driver waits for ever when SDA is held low, as it is after a reset in the
//! middle of a read; here it only sets pins and speed.
//!
//! # Source
//! RP2350 datasheet: 12.2 (disabling it, aborts, its registers). IC_CON as a reset leaves it:
//! master, fast mode, starts again where the direction changes.

use super::bus::{Block, LimitedI2c, Order, State, clear};
use super::clock::{Pause, time_us};
use embassy_rp::gpio::{Level, OutputOpenDrain};
use embassy_rp::i2c::{Config, I2c, Instance, SclPin, SdaPin};
use embassy_rp::{Peri, pac, peripherals};

/// Where a block's registers are.
pub trait Registers: Instance + 'static {
    /// There.
    const REGISTERS: pac::i2c::I2c;
}

impl Registers for peripherals::I2C0 {
    const REGISTERS: pac::i2c::I2c = pac::I2C0;
}

impl Registers for peripherals::I2C1 {
    const REGISTERS: pac::i2c::I2c = pac::I2C1;
}

/// An I2C block with its pins, at 400 kHz.
#[expect(missing_debug_implementations, reason = "the HAL's peripherals have none")]
pub struct BoardBlock<T: Registers, C: SclPin<T>, D: SdaPin<T>> {
    block: Peri<'static, T>,
    clock: Peri<'static, C>,
    data: Peri<'static, D>,
}

/// The bus of this block on SCL and SDA, which have pull-ups outside.
pub fn bus<T: Registers, C: SclPin<T>, D: SdaPin<T>>(
    block: Peri<'static, T>,
    (clock, data): (Peri<'static, C>, Peri<'static, D>),
) -> LimitedI2c<BoardBlock<T, C, D>> {
    LimitedI2c::new(BoardBlock { block, clock, data })
}

impl<T: Registers, C: SclPin<T>, D: SdaPin<T>> Block for BoardBlock<T, C, D> {
    fn set_up(&mut self) {
        let mut clock = OutputOpenDrain::new(self.clock.reborrow(), Level::High);
        let mut data = OutputOpenDrain::new(self.data.reborrow(), Level::High);
        clear(&mut clock, &mut data, &mut Pause); // if it cannot be, each transaction says so
        drop((clock, data));
        let mut config = Config::default();
        config.frequency = 400_000;
        (config.sda_pullup, config.scl_pullup) = (false, false);
        I2c::new_blocking(
            self.block.reborrow(),
            self.clock.reborrow(),
            self.data.reborrow(),
            config,
        );
        self.switch_off();
    }

    fn switch_off(&mut self) {
        T::REGISTERS.ic_enable().write(|w| w.set_enable(false));
    }

    fn switch_on(&mut self, address: u8) {
        T::REGISTERS.ic_tar().write(|w| w.set_ic_tar(address.into()));
        T::REGISTERS.ic_clr_intr().read(); // reading clears stop and abort
        T::REGISTERS.ic_enable().write(|w| w.set_enable(true));
    }

    fn state(&self) -> State {
        let (status, interrupts) =
            (T::REGISTERS.ic_status().read(), T::REGISTERS.ic_raw_intr_stat().read());
        // Looked at after the interrupts: whoever sees the stop of an abort sees the abort too.
        let abort = T::REGISTERS.ic_tx_abrt_source().read().0 & 0x1_ffff;
        State {
            is_on: T::REGISTERS.ic_enable_status().read().ic_en(),
            has_room: status.tfnf(),
            has_byte: status.rfne(),
            has_stopped: interrupts.stop_det(),
            abort,
        }
    }

    fn order(&mut self, order: Order, is_last: bool) {
        T::REGISTERS.ic_data_cmd().write(|w| {
            w.set_stop(is_last);
            match order {
                Order::Write(byte) => w.set_dat(byte),
                Order::Read => w.set_cmd(true),
            }
        });
    }

    fn take(&mut self) -> u8 {
        T::REGISTERS.ic_data_cmd().read().dat()
    }

    fn now_us(&self) -> u64 {
        time_us()
    }
}
