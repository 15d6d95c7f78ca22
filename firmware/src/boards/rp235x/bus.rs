//! I2C that ends, without the registers: every transaction has a time limit, and a device that
//! holds SDA low is clocked until it lets go.
//!
//! In: a [`Block`], what a DW_apb_i2c is and does. Out: [`LimitedI2c`], of `embedded-hal`.
//!
//! ```text
//! transaction   off, until what was before has ended; on, with an address; a byte after the other;
//!               until the stop
//! at each wait  aborted by the block (nobody answers): an error; it has sent the stop itself. Too
//!               late: an error, and everything set up again
//! clear         SDA low: SCL up to nine times, until it is high; then a stop
//! ```
//! An abort is looked for until the stop has been seen, so that a last byte that nobody takes is
//! noticed, whatever TX_EMPTY_CTRL says.
//!
//! # Source
//! RP2350 datasheet: 12.2 (I2C; IC_TX_ABRT_SOURCE, IC_DATA_CMD). I2C specification UM10204, 3.1.16
//! (bus clear).

use core::convert::Infallible;
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{InputPin, OutputPin};
use embedded_hal::i2c::{self, ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};

/// Longest transaction, microseconds: the cameras' take 150.
pub const LIMIT_US: u64 = 10_000;
/// Half a period of SCL while the bus is cleared: 100 kHz.
const HALF_US: u32 = 5;

/// Next item of the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// This byte.
    Write(u8),
    /// A byte to be fetched with [`Block::take`].
    Read,
}

/// State of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct State {
    /// It is on, or something still goes on after it was switched off.
    pub is_on: bool,
    /// It takes one more order.
    pub has_room: bool,
    /// A byte can be fetched.
    pub has_byte: bool,
    /// A stop was sent since it was switched on.
    pub has_stopped: bool,
    /// Bits of IC_TX_ABRT_SOURCE; none: it has not given up.
    pub abort: u32,
}

/// A DW_apb_i2c with its pins.
pub trait Block {
    /// Frees the bus, and makes pins and block as after a reset: off.
    fn set_up(&mut self);

    /// Off as soon as what goes on has ended.
    fn switch_off(&mut self);

    /// On, for this address; nothing is left of what was before.
    fn switch_on(&mut self, address: u8);

    /// State now.
    fn state(&self) -> State;

    /// Takes an order; after the last one it sends a stop. A start, and one again where the
    /// direction changes, it sends by itself.
    fn order(&mut self, order: Order, is_last: bool);

    /// The oldest byte that was read.
    fn take(&mut self) -> u8;

    /// The clock, microseconds.
    fn now_us(&self) -> u64;
}

/// Fault of the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusError {
    /// Nobody took the address, or a byte.
    NoAcknowledge(NoAcknowledgeSource),
    /// Somebody else pulled SDA low.
    ArbitrationLoss,
    /// Another reason of the block to give up: its bits.
    Aborted(u32),
    /// Nothing happens: SDA or SCL is held low.
    Late,
    /// A transaction of no bytes, which the block cannot make.
    Empty,
}

impl i2c::Error for BusError {
    fn kind(&self) -> ErrorKind {
        match *self {
            Self::NoAcknowledge(source) => ErrorKind::NoAcknowledge(source),
            Self::ArbitrationLoss => ErrorKind::ArbitrationLoss,
            Self::Aborted(_) | Self::Late => ErrorKind::Bus,
            Self::Empty => ErrorKind::Other,
        }
    }
}

impl BusError {
    const fn of(abort: u32) -> Self {
        const ADDRESS: u32 = 1 << 0;
        const DATA: u32 = 1 << 3;
        const LOST: u32 = 1 << 12;
        if abort & ADDRESS != 0 {
            Self::NoAcknowledge(NoAcknowledgeSource::Address)
        } else if abort & DATA != 0 {
            Self::NoAcknowledge(NoAcknowledgeSource::Data)
        } else if abort & LOST != 0 {
            Self::ArbitrationLoss
        } else {
            Self::Aborted(abort)
        }
    }
}

/// A bus on which every transaction ends.
#[derive(Debug)]
pub struct LimitedI2c<B>(B);

impl<B: Block> LimitedI2c<B> {
    /// The bus of a block, set up.
    pub fn new(mut block: B) -> Self {
        block.set_up();
        Self(block)
    }

    fn transfer(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        let length = |operation: &Operation<'_>| match operation {
            Operation::Write(bytes) => bytes.len(),
            Operation::Read(bytes) => bytes.len(),
        };
        let mut left = operations.iter().map(length).sum::<usize>();
        if left == 0 {
            return Err(BusError::Empty);
        }
        let until_us = self.0.now_us() + LIMIT_US;
        self.0.switch_off();
        while self.0.state().is_on {
            self.check_time(until_us)?;
        }
        self.0.switch_on(address);
        let mut order = |bus: &mut Self, order| {
            left -= 1;
            bus.wait(until_us, |state| state.has_room)?;
            bus.0.order(order, left == 0);
            Ok(())
        };
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    bytes.iter().try_for_each(|&byte| order(self, Order::Write(byte)))?
                }
                Operation::Read(bytes) => {
                    for byte in bytes.iter_mut() {
                        order(self, Order::Read)?;
                        self.wait(until_us, |state| state.has_byte)?;
                        *byte = self.0.take();
                    }
                }
            }
        }
        self.wait(until_us, |state| state.has_stopped)
    }

    fn wait(&self, until_us: u64, is_so: fn(&State) -> bool) -> Result<(), BusError> {
        loop {
            let state = self.0.state();
            if state.abort != 0 {
                return Err(BusError::of(state.abort));
            }
            if is_so(&state) {
                return Ok(());
            }
            self.check_time(until_us)?;
        }
    }

    fn check_time(&self, until_us: u64) -> Result<(), BusError> {
        if self.0.now_us() > until_us { Err(BusError::Late) } else { Ok(()) }
    }
}

impl<B> ErrorType for LimitedI2c<B> {
    type Error = BusError;
}

impl<B: Block> I2c for LimitedI2c<B> {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), BusError> {
        let done = self.transfer(address, operations);
        if done == Err(BusError::Late) {
            self.0.set_up();
        }
        done
    }
}

/// Clocks SCL until whoever holds SDA low has sent its byte, nine times at most; then a stop. Both
/// pins are open drains, released. Says whether SDA is free.
pub fn clear<C, D>(clock: &mut C, data: &mut D, delay: &mut impl DelayNs) -> bool
where
    C: OutputPin<Error = Infallible>,
    D: OutputPin<Error = Infallible> + InputPin,
{
    let mut set_clock = |is_high: bool| {
        let Ok(()) = clock.set_state(is_high.into());
        delay.delay_us(HALF_US);
    };
    let is_free = |data: &mut D| data.is_high() == Ok(true);
    set_clock(true);
    for _ in 0..9 {
        if is_free(data) {
            break;
        }
        set_clock(false);
        set_clock(true);
    }
    if !is_free(data) {
        return false;
    }
    set_clock(false);
    let Ok(()) = data.set_low();
    set_clock(true);
    let Ok(()) = data.set_high();
    set_clock(true); // as long as a bus is free before a start
    true
}
