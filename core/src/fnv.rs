//! FNV-1a, 32 bits (Fowler, Noll, Vo): for telling results apart, not for protecting them.

use core::hash::Hasher;

/// A digest of what was written so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fnv(pub(crate) u32);

impl Fnv {
    /// Of nothing.
    pub const EMPTY: Self = Self(0x811c_9dc5);

    /// The digest.
    #[must_use]
    pub const fn value(self) -> u32 {
        self.0
    }

    /// Adds bytes.
    #[inline]
    pub fn write(&mut self, bytes: &[u8]) {
        *self = bytes.iter().fold(*self, |digest, &byte| digest.mixed(byte.into()));
    }

    /// With one more value, which FNV takes byte by byte.
    #[inline]
    pub(crate) const fn mixed(self, value: u32) -> Self {
        Self((self.0 ^ value).wrapping_mul(0x0100_0193))
    }
}

impl Hasher for Fnv {
    fn write(&mut self, bytes: &[u8]) {
        self.write(bytes);
    }

    /// The same whatever the machine's byte order.
    fn write_i32(&mut self, i: i32) {
        self.write(&i.to_le_bytes());
    }

    fn write_u32(&mut self, i: u32) {
        self.write(&i.to_le_bytes());
    }

    fn write_u16(&mut self, i: u16) {
        self.write(&i.to_le_bytes());
    }

    fn write_i16(&mut self, i: i16) {
        self.write(&i.to_le_bytes());
    }

    /// Enum variants are hashed as `isize`, whose width depends on the machine.
    fn write_isize(&mut self, i: isize) {
        self.write_i32(i as i32);
    }

    fn write_usize(&mut self, i: usize) {
        self.write_u32(i as u32);
    }

    fn finish(&self) -> u64 {
        self.0.into()
    }
}
