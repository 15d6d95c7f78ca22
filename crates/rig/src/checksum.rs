//! The checksum of packets and of rig images: CRC-32 as in ISO-HDLC (Ethernet, zip).

use crc::{CRC_32_ISO_HDLC, Crc};

/// Bytes of a checksum.
pub const CRC_BYTES: usize = size_of::<u32>();

/// With its table.
pub static CRC_32: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
