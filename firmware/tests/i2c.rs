//! The RP2350's I2C on a fake of its block: what goes over the bus, what fails, and that everything
//! ends; and clearing a bus that a device holds.

use core::cell::{Cell, RefCell};
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use embedded_hal::i2c::{Error as _, ErrorKind, I2c, NoAcknowledgeSource, Operation};
use embedded_hal_mock::eh1::delay::NoopDelay;
use linestereo_firmware::boards::rp235x::bus::{
    Block, BusError, LIMIT_US, LimitedI2c, Order, State, clear,
};
use std::collections::VecDeque;

/// Time of a byte at 400 kHz.
const BYTE_US: u64 = 23;
const ROOM: usize = 16;

/// Event on the wires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wire {
    /// A start, or one again.
    Start(u8),
    Byte(u8),
    Stop,
}

/// The block, as its datasheet has it, and a device that counts up when it is read. Panics when it
/// is not used as it has to be.
#[derive(Default)]
struct Fake {
    now_us: Cell<u64>,
    /// Clocked by each look at it.
    inner: RefCell<Inner>,
}

#[derive(Default)]
struct Inner {
    is_enabled: bool,
    address: u8,
    /// Orders that were not begun; of the last one that was, whether it was a read, and until when
    /// it takes.
    orders: VecDeque<(Order, bool)>,
    is_read: Option<bool>,
    busy_until_us: u64,
    received: VecDeque<u8>,
    has_stopped: bool,
    abort: u32,
    wires: Vec<Wire>,
    /// Bytes on the wires, addresses among them, until nobody acknowledges one, the block gives up
    /// (with these bits), or nothing happens any more.
    refused_after: Option<usize>,
    given_up_after: Option<(usize, u32)>,
    stuck_after: Option<usize>,
    set_up: u32,
    sent: u8,
}

impl Inner {
    fn bytes(&self) -> usize {
        self.wires.iter().filter(|wire| **wire != Wire::Stop).count()
    }

    fn give_up(&mut self, bits: u32) {
        self.abort = bits;
        self.orders.clear();
        // The stop takes its time.
        self.busy_until_us += BYTE_US;
        self.stop();
    }

    fn stop(&mut self) {
        self.wires.push(Wire::Stop);
        self.is_read = None;
    }

    /// Events until now.
    fn run(&mut self, now_us: u64) {
        if self.wires.last() == Some(&Wire::Stop) && now_us >= self.busy_until_us {
            self.has_stopped = true;
        }
        while self.abort == 0 && now_us >= self.busy_until_us {
            let Some(&(order, is_last)) = self.orders.front() else { return };
            if self.stuck_after.is_some_and(|after| self.bytes() >= after) {
                return;
            }
            let is_read = order == Order::Read;
            self.busy_until_us = now_us + BYTE_US;
            if self.is_read != Some(is_read) {
                self.is_read = Some(is_read);
                self.wires.push(Wire::Start(self.address << 1 | u8::from(is_read)));
            } else {
                self.orders.pop_front();
                match order {
                    Order::Write(byte) => self.wires.push(Wire::Byte(byte)),
                    Order::Read => {
                        self.sent += 1;
                        self.wires.push(Wire::Byte(self.sent));
                        self.received.push_back(self.sent);
                    }
                }
                if is_last {
                    assert!(self.orders.is_empty(), "an order after the last one");
                }
            }
            let is_address = matches!(self.wires.last(), Some(Wire::Start(_)));
            if self.refused_after == Some(self.bytes()) {
                self.give_up(if is_address { 1 << 0 } else { 1 << 3 });
            } else if let Some((_, bits)) =
                self.given_up_after.filter(|&(after, _)| after == self.bytes())
            {
                self.give_up(bits);
            } else if !is_address && is_last {
                self.stop();
            }
        }
    }
}

impl Block for &Fake {
    fn set_up(&mut self) {
        let mut inner = self.inner.borrow_mut();
        let (wires, set_up, sent) =
            (core::mem::take(&mut inner.wires), inner.set_up + 1, inner.sent);
        *inner = Inner { wires, set_up, sent, ..Inner::default() };
    }

    fn switch_off(&mut self) {
        let mut inner = self.inner.borrow_mut();
        inner.is_enabled = false;
        inner.received.clear();
    }

    fn switch_on(&mut self, address: u8) {
        assert!(!self.state().is_on, "the address of a block that is on stays");
        let mut inner = self.inner.borrow_mut();
        (inner.is_enabled, inner.address) = (true, address);
        (inner.has_stopped, inner.abort) = (false, 0);
        inner.wires.clear();
    }

    fn state(&self) -> State {
        self.now_us.set(self.now_us.get() + 1);
        let now_us = self.now_us.get();
        let mut inner = self.inner.borrow_mut();
        inner.run(now_us);
        State {
            is_on: inner.is_enabled || inner.is_read.is_some() || now_us < inner.busy_until_us,
            has_room: inner.orders.len() < ROOM,
            has_byte: !inner.received.is_empty(),
            has_stopped: inner.has_stopped,
            abort: inner.abort,
        }
    }

    fn order(&mut self, order: Order, is_last: bool) {
        let mut inner = self.inner.borrow_mut();
        assert!(inner.is_enabled && inner.orders.len() < ROOM, "an order that is lost");
        assert!(
            inner.orders.back().is_none_or(|&(_, is_last)| !is_last),
            "an order after the last one"
        );
        inner.orders.push_back((order, is_last));
    }

    fn take(&mut self) -> u8 {
        self.inner.borrow_mut().received.pop_front().expect("there is no byte")
    }

    fn now_us(&self) -> u64 {
        self.now_us.get()
    }
}

fn wires(fake: &Fake) -> Vec<Wire> {
    fake.inner.borrow().wires.clone()
}

#[test]
fn bytes_go_over_the_bus_with_starts_where_the_direction_changes_and_one_stop() {
    let fake = Fake::default();
    let mut bus = LimitedI2c::new(&fake);
    let mut byte = [0];
    bus.write_read(0x24, &[0x01, 0x00], &mut byte).unwrap();
    let (start, again) = (Wire::Start(0x48), Wire::Start(0x49));
    let register = [Wire::Byte(0x01), Wire::Byte(0x00)];
    assert_eq!(
        wires(&fake),
        [&[start], &register[..], &[again, Wire::Byte(1), Wire::Stop]].concat()
    );
    assert_eq!(byte, [1]);
    // More than there is room for.
    let many = (0..40).collect::<Vec<u8>>();
    bus.write(0x24, &many).unwrap();
    let sent = many.iter().map(|&byte| Wire::Byte(byte)).collect::<Vec<_>>();
    assert_eq!(wires(&fake), [&[start], &sent[..], &[Wire::Stop]].concat());
    let mut read = [0; 20];
    bus.read(0x24, &mut read).unwrap();
    assert_eq!(read.to_vec(), (2..22).collect::<Vec<_>>());
    // Two writes are one, and an empty one is none.
    bus.transaction(
        0x24,
        &mut [Operation::Write(&[1]), Operation::Write(&[]), Operation::Write(&[2])],
    )
    .unwrap();
    assert_eq!(wires(&fake), [start, Wire::Byte(1), Wire::Byte(2), Wire::Stop]);
    assert_eq!(bus.write(0x24, &[]), Err(BusError::Empty));
    assert_eq!(fake.inner.borrow().set_up, 1);
}

#[test]
fn a_byte_that_nobody_takes_is_told_also_the_last_one() {
    let fake = Fake::default();
    let mut bus = LimitedI2c::new(&fake);
    for (after, source) in [
        (1, NoAcknowledgeSource::Address),
        (2, NoAcknowledgeSource::Data),
        (3, NoAcknowledgeSource::Data),
        (4, NoAcknowledgeSource::Data),
    ] {
        fake.inner.borrow_mut().refused_after = Some(after);
        let error = bus.write(0x24, &[1, 2, 3]).unwrap_err();
        assert_eq!(
            (error, error.kind()),
            (BusError::NoAcknowledge(source), ErrorKind::NoAcknowledge(source)),
            "{after}"
        );
        // The block sends the stop of what it has given up before it takes another address.
        fake.inner.borrow_mut().refused_after = None;
        bus.write(0x24, &[1, 2, 3]).unwrap();
    }
    // The address of the read that follows a write.
    fake.inner.borrow_mut().refused_after = Some(4);
    let address = BusError::NoAcknowledge(NoAcknowledgeSource::Address);
    assert_eq!(bus.write_read(0x24, &[1, 2], &mut [0]), Err(address));
    for (bits, error, kind) in [
        (1 << 12, BusError::ArbitrationLoss, ErrorKind::ArbitrationLoss),
        (1 << 16, BusError::Aborted(1 << 16), ErrorKind::Bus),
    ] {
        let mut inner = fake.inner.borrow_mut();
        (inner.refused_after, inner.given_up_after) = (None, Some((2, bits)));
        drop(inner);
        let found = bus.write(0x24, &[1, 2]).unwrap_err();
        assert_eq!((found, found.kind()), (error, kind));
    }
    assert_eq!(fake.inner.borrow().set_up, 1, "the bus itself is as it should be");
}

#[test]
fn a_bus_that_is_held_ends_every_transaction_in_time_and_is_set_up_again() {
    for after in 0..5 {
        let fake = Fake::default();
        let mut bus = LimitedI2c::new(&fake);
        let (mut byte, from_us) = ([0], fake.now_us.get());
        fake.inner.borrow_mut().stuck_after = Some(after);
        let error = bus.write_read(0x24, &[0x01, 0x00], &mut byte).unwrap_err();
        assert_eq!((error, error.kind()), (BusError::Late, ErrorKind::Bus), "{after}");
        assert!(fake.now_us.get() - from_us <= LIMIT_US + 2, "{after}");
        assert_eq!(fake.inner.borrow().set_up, 2, "{after}");
        assert_eq!(bus.write_read(0x24, &[0x01, 0x00], &mut byte), Ok(()), "{after}");
    }
    // A device that holds SCL low from a moment on at which nothing is asked of it: the block does
    // not go off.
    let fake = Fake::default();
    let mut bus = LimitedI2c::new(&fake);
    fake.inner.borrow_mut().busy_until_us = u64::MAX;
    assert_eq!(bus.write(0x24, &[1]), Err(BusError::Late));
    assert_eq!(bus.write(0x24, &[1]), Ok(()));
}

/// Two open drains, and a device that was reading out a byte when its master was reset.
struct Bus {
    clock: Cell<bool>,
    data: Cell<bool>,
    /// Bits that the device has not sent, the next one first; after eight it looks whether there is
    /// more to send.
    bits: RefCell<VecDeque<bool>>,
    /// A device that never lets go.
    is_short: bool,
    pulses: Cell<u32>,
    stops: Cell<u32>,
}

impl Bus {
    fn sda(&self) -> bool {
        self.data.get() && self.bits.borrow().front().copied().unwrap_or(true) && !self.is_short
    }
}

struct Clock<'a>(&'a Bus);
struct Data<'a>(&'a Bus);

impl ErrorType for Clock<'_> {
    type Error = Infallible;
}

impl ErrorType for Data<'_> {
    type Error = Infallible;
}

impl OutputPin for Clock<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        if self.0.clock.replace(false) {
            self.0.bits.borrow_mut().pop_front();
        }
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        if !self.0.clock.replace(true) {
            self.0.pulses.set(self.0.pulses.get() + 1);
        }
        Ok(())
    }
}

impl OutputPin for Data<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        assert!(!self.0.clock.get() || !self.0.data.get(), "a start");
        self.0.data.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        let before = self.0.sda();
        self.0.data.set(true);
        if !before && self.0.sda() && self.0.clock.get() {
            self.0.stops.set(self.0.stops.get() + 1);
        }
        Ok(())
    }
}

impl InputPin for Data<'_> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.sda())
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.sda())
    }
}

#[test]
fn a_device_in_the_middle_of_a_byte_is_clocked_until_it_lets_go() {
    let play = |bits: &[bool], is_short| {
        let (clock, data, bits) =
            (Cell::new(true), Cell::new(true), RefCell::new(bits.iter().copied().collect()));
        let bus = Bus { clock, data, bits, is_short, pulses: Cell::new(0), stops: Cell::new(0) };
        let is_free = clear(&mut Clock(&bus), &mut Data(&bus), &mut NoopDelay);
        (is_free, bus.pulses.get(), bus.stops.get(), bus.sda() && bus.clock.get())
    };
    for zeros in 0..=8 {
        // And one for the stop.
        assert_eq!(play(&vec![false; zeros], false), (true, zeros as u32 + 1, 1, true), "{zeros}");
    }
    // A one on the way is enough: what comes next is a start.
    assert!(play(&[false, true, false], false).0);
    assert_eq!(play(&[], true), (false, 9, 0, false));
}
