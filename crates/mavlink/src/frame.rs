//! A message -> the bytes of its frame.

use crc::{CRC_16_MCRF4XX, Crc, Table};

/// Bytes of the longest payload here, OBSTACLE_DISTANCE.
const MAX_PAYLOAD: usize = 167;
/// Bytes before a payload.
pub(crate) const HEAD: usize = 10;
/// Bytes of the longest frame here.
pub const MAX_FRAME: usize = HEAD + MAX_PAYLOAD + 2;
/// A frame of version 2 begins.
pub(crate) const MAGIC: u8 = 0xfd;
const CRC: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_MCRF4XX);

/// Checksum of a frame behind its first byte, with the byte of its message.
#[inline(never)]
pub(crate) fn checksum(bytes: &[u8], extra: u8) -> u16 {
    let mut digest = CRC.digest();
    digest.update(bytes);
    digest.update(&[extra]);
    digest.finalize()
}

/// A message that can be sent.
pub trait Mavlink {
    /// Its id.
    const ID: u32;
    /// The byte that stands for its definition in the checksum.
    const CRC_EXTRA: u8;

    /// Puts its fields, in the order of the wire.
    fn put(&self, fields: &mut Fields);
}

/// Bytes of a frame in the making.
#[derive(Clone, Debug)]
pub struct Fields(heapless::Vec<u8, MAX_FRAME>);

impl Fields {
    /// Little endian bytes of a number. What is longer than [`MAX_FRAME`] is cut off: no message
    /// here is.
    #[inline(never)]
    pub fn put(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            let _ = self.0.push(byte);
        }
    }

    /// Ends a frame: no zeros at the end of its payload, its length, its checksum.
    #[inline(never)]
    fn finish(&mut self, extra: u8) {
        let frame = &mut self.0;
        while frame.len() > HEAD + 1 && frame.last() == Some(&0) {
            frame.pop();
        }
        let length = frame.len().saturating_sub(HEAD) as u8;
        if let Some(byte) = frame.get_mut(1) {
            *byte = length;
        }
        let crc = checksum(frame.get(1..).unwrap_or_default(), extra);
        self.put(&crc.to_le_bytes());
    }
}

/// System and component of the sender, and the number of the next frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sender {
    /// The vehicle: the system id of its autopilot.
    pub system: u8,
    /// This component of it.
    pub component: u8,
    /// Of the next frame; wraps.
    pub sequence: u8,
}

impl Sender {
    /// Hands a message's frame to `write`.
    #[inline(never)] // its frame is on the stack only while it sends
    pub fn send<M: Mavlink, E>(
        &mut self,
        message: &M,
        write: &mut impl FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut fields = Fields(heapless::Vec::new());
        let [id0, id1, id2, _] = M::ID.to_le_bytes();
        fields.put(&[MAGIC, 0, 0, 0, self.sequence, self.system, self.component, id0, id1, id2]);
        message.put(&mut fields);
        fields.finish(M::CRC_EXTRA);
        self.sequence = self.sequence.wrapping_add(1);
        write(&fields.0)
    }
}
