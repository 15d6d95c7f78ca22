//! Bytes of an autopilot's line -> the few messages that are taken from it.
//!
//! In: one byte at a time. Out: requests of parameters and of time, addressed to this component or
//! to all; everything else is skipped. Frames of MAVLink 2 alone, signed ones with their signature
//! unread.
//!
//! # Bounds
//! A few steps a byte, one pass over a frame. What is damaged costs the frame, and at most the 280
//! bytes that a damaged length announces.

use crate::frame::{Fields, HEAD, MAGIC, Mavlink, checksum};

/// Bytes behind a payload, and of a signature.
const CHECKSUM: usize = 2;
const SIGNATURE: usize = 13;
/// A signature follows.
const SIGNED: u8 = 1;
const MAX: usize = HEAD + 255 + CHECKSUM + SIGNATURE;

/// Name of a parameter, filled up with zeros.
pub type ParamId = [u8; 16];

/// A message that was received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Received {
    /// PARAM_REQUEST_LIST: all parameters are wanted.
    ParamList,
    /// PARAM_REQUEST_READ: one is, by its number, or by its name when that is negative.
    ParamRead {
        /// Its number.
        index: i16,
        /// Its name.
        id: ParamId,
    },
    /// PARAM_SET.
    ParamSet {
        /// Its name.
        id: ParamId,
        /// Its new value.
        value: f32,
    },
    /// TIMESYNC: a question of anybody, an answer of the autopilot.
    Timesync(Timesync),
}

/// TIMESYNC, ns. A request has `tc1` 0; its answer repeats its `ts1` and gives the time of whoever
/// answers in `tc1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timesync {
    /// Time of whoever answers, 0 in a request.
    pub tc1: i64,
    /// Time of whoever asked.
    pub ts1: i64,
}

impl Mavlink for Timesync {
    const ID: u32 = 111;
    const CRC_EXTRA: u8 = 34;

    fn put(&self, fields: &mut Fields) {
        fields.put(&self.tc1.to_le_bytes());
        fields.put(&self.ts1.to_le_bytes());
    }
}

/// PARAM_VALUE: one parameter of several, a number of 32 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParamValue {
    /// Its name.
    pub id: ParamId,
    /// Its value.
    pub value: f32,
    /// Its number.
    pub index: u16,
    /// Parameters in all.
    pub count: u16,
}

impl Mavlink for ParamValue {
    const ID: u32 = 22;
    const CRC_EXTRA: u8 = 220;

    fn put(&self, fields: &mut Fields) {
        /// MAV_PARAM_TYPE_REAL32, of all parameters: autopilots do not agree how whole numbers are
        /// sent.
        const REAL32: u8 = 9;
        fields.put(&self.value.to_le_bytes());
        fields.put(&self.count.to_le_bytes());
        fields.put(&self.index.to_le_bytes());
        fields.put(&self.id);
        fields.put(&[REAL32]);
    }
}

/// The receiving end of a line.
#[derive(Clone, Debug)]
pub struct Receiver {
    frame: heapless::Vec<u8, MAX>,
}

impl Receiver {
    /// At the start of a frame.
    #[must_use]
    pub const fn new() -> Self {
        Self { frame: heapless::Vec::new() }
    }

    /// Takes one byte; gives a message to this system and component when it ends one.
    pub fn push(&mut self, byte: u8, system: u8, component: u8) -> Option<Received> {
        if self.frame.is_empty() && byte != MAGIC {
            return None;
        }
        let _ = self.frame.push(byte); // a frame fits
        let &[_, length, flags, ..] = self.frame.as_slice() else { return None };
        let signature = if flags & SIGNED == 0 { 0 } else { SIGNATURE };
        let end = HEAD + usize::from(length);
        if self.frame.len() < end + CHECKSUM + signature {
            return None;
        }
        let received = self.message(end, [system, component]);
        self.frame.clear();
        received
    }

    /// The message whose payload ends here.
    fn message(&self, end: usize, own: [u8; 2]) -> Option<Received> {
        let (head, payload) = self.frame.get(..end)?.split_first_chunk::<HEAD>()?;
        // Other incompatibility flags announce what this does not know how to read.
        if head[2] & !SIGNED != 0 {
            return None;
        }
        let crc = u16::from_le_bytes(*self.frame.get(end..)?.first_chunk()?);
        let [.., id0, id1, id2] = *head;
        let id = u32::from_le_bytes([id0, id1, id2, 0]);
        let extra = match id {
            PARAM_REQUEST_READ => 214,
            PARAM_REQUEST_LIST => 159,
            PARAM_SET => 168,
            Timesync::ID => Timesync::CRC_EXTRA,
            _ => return None,
        };
        if checksum(self.frame.get(1..end)?, extra) != crc {
            return None;
        }
        // Zeros at the end are not sent.
        let mut bytes = [0; 32];
        for (slot, byte) in bytes.iter_mut().zip(payload) {
            *slot = *byte;
        }
        let is_own = |to: [u8; 2]| to.iter().zip(own).all(|(&to, own)| to == 0 || to == own);
        let [b0, b1, b2, b3, b4, b5, b6, b7, rest @ ..] = bytes;
        match id {
            PARAM_REQUEST_LIST => is_own([b0, b1]).then_some(Received::ParamList),
            PARAM_REQUEST_READ => {
                let id = *bytes.get(4..)?.first_chunk()?;
                is_own([b2, b3])
                    .then_some(Received::ParamRead { index: i16::from_le_bytes([b0, b1]), id })
            }
            PARAM_SET => {
                let id = *bytes.get(6..)?.first_chunk()?;
                is_own([b4, b5]).then_some(Received::ParamSet {
                    id,
                    value: f32::from_le_bytes([b0, b1, b2, b3]),
                })
            }
            _ => {
                let tc1 = [b0, b1, b2, b3, b4, b5, b6, b7];
                let (ts1, to) = rest.split_first_chunk()?;
                let times =
                    Timesync { tc1: i64::from_le_bytes(tc1), ts1: i64::from_le_bytes(*ts1) };
                // The question went to all: other computers on the line answer it as well.
                let is_taken = times.tc1 == 0 || head[5..7] == [own[0], AUTOPILOT];
                (is_taken && is_own(*to.first_chunk()?)).then_some(Received::Timesync(times))
            }
        }
    }
}

impl Default for Receiver {
    fn default() -> Self {
        Self::new()
    }
}

/// MAV_COMP_ID_AUTOPILOT1.
const AUTOPILOT: u8 = 1;
const PARAM_REQUEST_READ: u32 = 20;
const PARAM_REQUEST_LIST: u32 = 21;
const PARAM_SET: u32 = 23;
