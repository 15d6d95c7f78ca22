//! A fake sensor on a bus.

use core::cell::RefCell;
use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, Operation};
use embedded_hal_mock::eh1::i2c::Transaction;
use linestereo_firmware::camera::{Model, Wire};
use std::collections::BTreeMap;
use std::rc::Rc;

/// A sensor that keeps what is written to it, and writes down what was said. Registers not written since the reset answer with 0.
#[derive(Clone)]
pub(crate) struct Fake(pub(crate) Rc<RefCell<Registers>>);

pub(crate) struct Registers {
    wire: Wire,
    values: BTreeMap<u16, u16>,
    /// Registers that keep something else.
    pub(crate) stuck: BTreeMap<u16, u16>,
    pointer: u16,
    /// Transactions until one fails, once.
    pub(crate) fails_after: Option<usize>,
    said: Vec<Transaction>,
}

impl Fake {
    pub(crate) fn of<M: Model>() -> Self {
        let values = M::IDENTITY.iter().map(|identity| (identity.register, identity.value)).collect();
        let (stuck, said) = (BTreeMap::new(), Vec::new());
        Self(Rc::new(RefCell::new(Registers { wire: M::WIRE, values, stuck, pointer: 0, fails_after: None, said })))
    }

    pub(crate) fn set(&self, register: u16, value: u16) {
        self.0.borrow_mut().values.insert(register, value);
    }

    pub(crate) fn get(&self, register: u16) -> u16 {
        self.0.borrow().values.get(&register).copied().unwrap_or(0)
    }

    pub(crate) fn said(&self) -> Vec<Transaction> {
        core::mem::take(&mut self.0.borrow_mut().said)
    }
}

impl ErrorType for Fake {
    type Error = ErrorKind;
}

impl I2c for Fake {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
        let mut chip = self.0.borrow_mut();
        if chip.fails_after == Some(0) {
            chip.fails_after = None;
            return Err(ErrorKind::Bus);
        }
        chip.fails_after = chip.fails_after.map(|left| left - 1);
        let mut written = Vec::new();
        let mut read = None;
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    let (register, value) = match (chip.wire, &**bytes) {
                        (Wire::Long8, [high, low, rest @ ..]) => (u16::from_be_bytes([*high, *low]), rest),
                        (_, [low, rest @ ..]) => (u16::from(*low), rest),
                        _ => panic!("a write without a register"),
                    };
                    chip.pointer = register;
                    if !value.is_empty() {
                        let value = value.iter().fold(0, |value, &byte| value << 8 | u16::from(byte));
                        let kept = chip.stuck.get(&register).copied().unwrap_or(value);
                        chip.values.insert(register, kept);
                    }
                    written = bytes.to_vec();
                }
                Operation::Read(bytes) => {
                    let value = chip.values.get(&chip.pointer).copied().unwrap_or(0).to_be_bytes();
                    let skipped = 2 - bytes.len();
                    bytes.copy_from_slice(&value[skipped..]);
                    read = Some(bytes.to_vec());
                }
            }
        }
        let said = match (written.is_empty(), read) {
            (false, None) => Transaction::write(address, written),
            (false, Some(read)) => Transaction::write_read(address, written, read),
            (true, read) => Transaction::read(address, read.unwrap()),
        };
        chip.said.push(said);
        Ok(())
    }
}
