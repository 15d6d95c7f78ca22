//! Checksum of packets and of rig images: CRC-32 as in ISO-HDLC (Ethernet, zip).
//!
//! # Cost
//! 64 bytes of table, two steps of four bits a byte: a table of whole bytes takes 1 KB of a board's flash.

/// Size of a checksum, bytes.
pub const CRC_BYTES: usize = size_of::<u32>();

/// The polynomial, its bits mirrored.
const POLYNOMIAL: u32 = 0xedb8_8320;

/// Remainders of four bits.
static REMAINDERS: [u32; 16] = {
    let mut table = [0; 16];
    let mut bits = 0;
    while bits < 16 {
        let mut remainder = bits;
        let mut step = 0;
        while step < 4 {
            remainder = remainder >> 1 ^ if remainder & 1 == 0 { 0 } else { POLYNOMIAL };
            step += 1;
        }
        table[bits as usize] = remainder;
        bits += 1;
    }
    table
};

/// A checksum in the making.
#[derive(Clone, Copy, Debug)]
pub struct Checksum(u32);

impl Checksum {
    /// Of no bytes.
    #[must_use]
    pub const fn new() -> Self {
        Self(u32::MAX)
    }

    /// The checksum of these bytes.
    #[must_use]
    pub fn of(bytes: &[u8]) -> u32 {
        let mut checksum = Self::new();
        checksum.update(bytes);
        checksum.value()
    }

    /// Goes on with these bytes.
    pub fn update(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 ^= u32::from(byte);
            for _ in 0..2 {
                self.0 = self.0 >> 4 ^ REMAINDERS[(self.0 & 15) as usize];
            }
        }
    }

    /// The checksum of the bytes so far.
    #[must_use]
    pub const fn value(self) -> u32 {
        !self.0
    }
}

impl Default for Checksum {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_check_value_of_the_catalogue_of_checksums() {
        assert_eq!(Checksum::of(b"123456789"), 0xcbf4_3926);
        assert_eq!(Checksum::of(&[]), 0);
    }
}
