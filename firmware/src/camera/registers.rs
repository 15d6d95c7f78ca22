//! Registers on the bus: what a step writes, and how addresses and values become bytes.

use embedded_hal::i2c::I2c;

/// How registers go over the bus. All of it is high byte first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire {
    /// Addresses of 8 bits, values of 16.
    Short16,
    /// Addresses of 16 bits, values of 8.
    Long8,
}

impl Wire {
    pub(super) fn write<B: I2c>(
        self,
        bus: &mut B,
        device: u8,
        register: u16,
        value: u16,
    ) -> Result<(), B::Error> {
        let ([high, low], [value_high, value_low]) = (register.to_be_bytes(), value.to_be_bytes());
        match self {
            Self::Short16 => bus.write(device, &[low, value_high, value_low]),
            Self::Long8 => bus.write(device, &[high, low, value_low]),
        }
    }

    pub(super) fn read<B: I2c>(
        self,
        bus: &mut B,
        device: u8,
        register: u16,
    ) -> Result<u16, B::Error> {
        let [high, low] = register.to_be_bytes();
        let (mut word, mut byte) = ([0; 2], [0; 1]);
        match self {
            Self::Short16 => {
                bus.write_read(device, &[low], &mut word).map(|()| u16::from_be_bytes(word))
            }
            Self::Long8 => bus.write_read(device, &[high, low], &mut byte).map(|()| byte[0].into()),
        }
    }
}

/// Contents of a register in the chip that is expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Its address.
    pub register: u16,
    /// Its contents.
    pub value: u16,
}

/// A register written, a look at what it then holds, a pause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Its address.
    pub register: u16,
    /// Value written.
    pub value: u16,
    /// Bits that must be read afterwards as written; none: the register is not read.
    pub kept: u16,
    /// Is it written at all, or only read?
    pub is_written: bool,
    /// Microseconds between the write and whatever follows it.
    pub pause_us: u32,
}

impl Step {
    /// Writes, and expects to read the same.
    pub const fn set(register: u16, value: u16) -> Self {
        Self { register, value, kept: u16::MAX, is_written: true, pause_us: 0 }
    }

    /// Writes what does not stay: a command, or a value that the chip changes.
    pub const fn command(register: u16, value: u16) -> Self {
        Self { kept: 0, ..Self::set(register, value) }
    }

    /// Only reads.
    pub const fn expect(register: u16, value: u16) -> Self {
        Self { is_written: false, ..Self::set(register, value) }
    }

    /// Only these bits are compared.
    #[must_use]
    pub const fn keeping(self, kept: u16) -> Self {
        Self { kept, ..self }
    }

    /// With a pause afterwards.
    #[must_use]
    pub const fn then_wait(self, pause_us: u32) -> Self {
        Self { pause_us, ..self }
    }
}
