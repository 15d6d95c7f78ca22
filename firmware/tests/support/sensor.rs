//! A fake sensor on a bus.

use core::cell::RefCell;
use core::fmt::Write as _;
use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, Operation};
use embedded_hal_mock::eh1::i2c::Transaction;
use linestereo_firmware::camera::{Model, Wire};
use std::collections::BTreeMap;
use std::rc::Rc;

// Registers of the MT9V034.
pub(crate) const COARSE_SHUTTER_WIDTH_TOTAL: u16 = 0x0b;
pub(crate) const AEC_AGC_ENABLE: u16 = 0xaf;
pub(crate) const AGC_GAIN_OUTPUT: u16 = 0xba;
pub(crate) const AEC_EXPOSURE_OUTPUT: u16 = 0xbb;

/// A sensor that keeps what is written to it until it is reset by register, and writes down what
/// was said. Registers not written since the reset answer with what a reset leaves in them, as far
/// as drivers rely on it, or with 0.
#[derive(Clone)]
pub(crate) struct Fake(pub(crate) Rc<RefCell<Registers>>);

/// A transaction.
#[derive(Clone)]
pub(crate) struct Said {
    address: u8,
    pub(crate) written: Vec<u8>,
    read: Vec<u8>,
}

impl Said {
    /// For a bus that accepts nothing else.
    pub(crate) fn transaction(&self) -> Transaction {
        let Self { address, written, read } = self.clone();
        match (written.is_empty(), read.is_empty()) {
            (false, true) => Transaction::write(address, written),
            (false, false) => Transaction::write_read(address, written, read),
            (true, _) => Transaction::read(address, read),
        }
    }
}

/// One line each: `w` and what is written, `r` and what is written and then read, `s` and what is
/// read alone.
pub(crate) fn text(said: &[Said]) -> String {
    let mut text = String::new();
    for Said { written, read, .. } in said {
        let kind = match (written.is_empty(), read.is_empty()) {
            (false, true) => 'w',
            (false, false) => 'r',
            (true, _) => 's',
        };
        text.push(kind);
        written.iter().for_each(|byte| write!(text, " {byte:02x}").unwrap());
        text.push_str(if kind == 'r' { " ->" } else { "" });
        read.iter().for_each(|byte| write!(text, " {byte:02x}").unwrap());
        text.push('\n');
    }
    text
}

pub(crate) struct Registers {
    wire: Wire,
    values: BTreeMap<u16, u16>,
    /// Writing this register brings these values back.
    reset: Option<(u16, BTreeMap<u16, u16>)>,
    /// Registers that keep something else.
    pub(crate) stuck: BTreeMap<u16, u16>,
    pointer: u16,
    /// Transactions until one fails, once.
    pub(crate) fails_after: Option<usize>,
    said: Vec<Said>,
}

impl Fake {
    pub(crate) fn of<M: Model>() -> Self {
        let mut values = M::IDENTITY
            .iter()
            .map(|identity| (identity.register, identity.value))
            .collect::<BTreeMap<_, _>>();
        let mut reset = None;
        if M::NAME == "HM01B0" {
            // INTEGRATION 0x0108, DIGITAL_GAIN 0x0100, automatic exposure on: more rows than a
            // frame has here.
            values.extend([(0x0202, 0x01), (0x0203, 0x08), (0x020e, 0x01), (0x2100, 0x01)]);
            reset = Some((0x0103, values.clone()));
        }
        let (stuck, said) = (BTreeMap::new(), Vec::new());
        let (wire, pointer, fails_after) = (M::WIRE, 0, None);
        let registers = Registers { wire, values, reset, stuck, pointer, fails_after, said };
        Self(Rc::new(RefCell::new(registers)))
    }

    pub(crate) fn set(&self, register: u16, value: u16) {
        self.0.borrow_mut().values.insert(register, value);
    }

    pub(crate) fn get(&self, register: u16) -> u16 {
        self.0.borrow().values.get(&register).copied().unwrap_or(0)
    }

    pub(crate) fn said(&self) -> Vec<Said> {
        core::mem::take(&mut self.0.borrow_mut().said)
    }
}

impl ErrorType for Fake {
    type Error = ErrorKind;
}

impl I2c for Fake {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), ErrorKind> {
        let mut chip = self.0.borrow_mut();
        if chip.fails_after == Some(0) {
            chip.fails_after = None;
            return Err(ErrorKind::Bus);
        }
        chip.fails_after = chip.fails_after.map(|left| left - 1);
        let mut said = Said { address, written: Vec::new(), read: Vec::new() };
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    let (register, value) = match (chip.wire, &**bytes) {
                        (Wire::Long8, [high, low, rest @ ..]) => {
                            (u16::from_be_bytes([*high, *low]), rest)
                        }
                        (_, [low, rest @ ..]) => (u16::from(*low), rest),
                        _ => panic!("a write without a register"),
                    };
                    chip.pointer = register;
                    if !value.is_empty() {
                        let value =
                            value.iter().fold(0, |value, &byte| value << 8 | u16::from(byte));
                        if let Some((_, values)) =
                            chip.reset.clone().filter(|&(reset, _)| reset == register)
                        {
                            chip.values = values;
                            let stuck = chip.stuck.clone();
                            chip.values.extend(stuck);
                        } else {
                            let kept = chip.stuck.get(&register).copied().unwrap_or(value);
                            chip.values.insert(register, kept);
                        }
                    }
                    said.written = bytes.to_vec();
                }
                Operation::Read(bytes) => {
                    let value = chip.values.get(&chip.pointer).copied().unwrap_or(0).to_be_bytes();
                    let skipped = 2 - bytes.len();
                    bytes.copy_from_slice(&value[skipped..]);
                    said.read = bytes.to_vec();
                }
            }
        }
        chip.said.push(said);
        Ok(())
    }
}
