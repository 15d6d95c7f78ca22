//! Checksum of packets and of rig images: CRC-32 as in ISO-HDLC (Ethernet, zip).

use crc::{CRC_32_ISO_HDLC, Crc};

/// Size of a checksum, bytes.
pub const CRC_BYTES: usize = size_of::<u32>();

/// CRC-32 with its table.
pub static CRC_32: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
