//! Records to packets, and bytes to records.
//!
//! In: a record and a buffer; one byte at a time. Out: a packet; records and named errors.
//!
//! ```text
//! encode: version byte, record -> postcard -> (each byte) CRC-32, COBS -> buffer; CRC; 0x00
//! decode: byte -> COBS -> payload memory; at 0x00: length, framing, checksum, version, record,
//!     in this order
//! ```
//!
//! # Bounds
//! A payload is counted in a `usize` up to the decoder's `N`; counters saturate.

use cobs::{CobsEncoder, DecodeResult, DecoderState};
use core::marker::PhantomData;
use crc::Digest;
use linestereo_rig::checksum::{CRC_32, CRC_BYTES};
use postcard::ser_flavors::Flavor;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Version of the records' layout.
pub const VERSION: u8 = 8;

/// Ends every packet, and stands nowhere else.
pub const DELIMITER: u8 = 0;

/// Bytes on the wire of a record of so many.
pub(crate) const fn packet_bytes(record: usize) -> usize {
    cobs::max_encoding_length(1 + record + CRC_BYTES) + 1
}

/// Content of a packet: a message or a command.
pub trait Record: Serialize + DeserializeOwned + Sealed {
    /// First byte of the payload: the version, and which way the record goes, so that an echo is
    /// not taken for an answer.
    const TAG: u8;
}

/// Of this crate's records alone.
pub trait Sealed {}

/// Why a record is not a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EncodeError {
    /// The buffer is smaller than the packet; `MAX_PACKET` and `MAX_COMMAND` always suffice.
    #[error("the buffer is too small for the packet")]
    BufferTooSmall,
}

/// One record as a packet, delimiter included, at the start of `buffer`.
pub fn encode<'a, T: Record>(record: &T, buffer: &'a mut [u8]) -> Result<&'a [u8], EncodeError> {
    // A full buffer is the only error there is: every length is known, and nothing here serializes
    // by hand.
    let full = |_| EncodeError::BufferTooSmall;
    let mut payload = Payload { cobs: CobsEncoder::new(buffer), digest: CRC_32.digest() };
    payload.try_push(T::TAG).map_err(full)?;
    let end = postcard::serialize_with_flavor(record, payload).map_err(full)?;
    *buffer.get_mut(end).ok_or(EncodeError::BufferTooSmall)? = DELIMITER;
    buffer.get(..=end).ok_or(EncodeError::BufferTooSmall)
}

/// Where postcard puts its bytes, so that one buffer is enough.
struct Payload<'a> {
    cobs: CobsEncoder<'a>,
    digest: Digest<'static, u32>,
}

impl Flavor for Payload<'_> {
    type Output = usize;

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.try_extend(&[byte])
    }

    #[inline(never)] // of every number of every record
    fn try_extend(&mut self, bytes: &[u8]) -> postcard::Result<()> {
        self.digest.update(bytes);
        self.cobs.push(bytes).map_err(|_| postcard::Error::SerializeBufferFull)
    }

    fn finalize(mut self) -> postcard::Result<usize> {
        let crc = self.digest.finalize().to_le_bytes();
        self.cobs.push(&crc).map_err(|_| postcard::Error::SerializeBufferFull)?;
        Ok(self.cobs.finalize())
    }
}

/// Why the bytes between two delimiters are not a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// Longer than any packet.
    #[error("the packet is too long")]
    TooLong,
    /// The byte stuffing ends in the middle of a run: bytes are missing or changed.
    #[error("the packet's framing is damaged")]
    Cobs,
    /// The checksum is another.
    #[error("the packet's checksum is wrong")]
    Checksum,
    /// A whole packet of another version, or one that goes the other way.
    #[error(
        "the packet goes {way} and has version {}, this program has version {VERSION}",
        .found & 0x7f,
        way = if .found & 0x80 == 0 { "from a board" } else { "to a board" }
    )]
    Version {
        /// Its first byte; [`Record::TAG`] is the expected one.
        found: u8,
    },
    /// A whole packet of this version that holds no record.
    #[error("the packet holds no record of this version")]
    Malformed,
}

/// Packets received, by outcome.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Records.
    pub good: u32,
    /// [`DecodeError::TooLong`].
    pub too_long: u32,
    /// [`DecodeError::Cobs`].
    pub cobs: u32,
    /// [`DecodeError::Checksum`].
    pub checksum: u32,
    /// [`DecodeError::Version`].
    pub other_version: u32,
    /// [`DecodeError::Malformed`].
    pub malformed: u32,
    /// Bytes of all packets that are no record, delimiters included.
    pub skipped_bytes: u64,
}

impl Counters {
    /// No packet received.
    pub const ZERO: Self = Self {
        good: 0,
        too_long: 0,
        cobs: 0,
        checksum: 0,
        other_version: 0,
        malformed: 0,
        skipped_bytes: 0,
    };

    /// Packets that are no record.
    #[must_use]
    pub fn bad(&self) -> u32 {
        [self.too_long, self.cobs, self.checksum, self.other_version, self.malformed]
            .into_iter()
            .fold(0, u32::saturating_add)
    }

    fn count(&mut self, error: DecodeError, bytes: u32) {
        let count = match error {
            DecodeError::TooLong => &mut self.too_long,
            DecodeError::Cobs => &mut self.cobs,
            DecodeError::Checksum => &mut self.checksum,
            DecodeError::Version { .. } => &mut self.other_version,
            DecodeError::Malformed => &mut self.malformed,
        };
        *count = count.saturating_add(1);
        self.skipped_bytes = self.skipped_bytes.saturating_add(bytes.into());
    }
}

/// Finds the records in a stream of bytes. `N` bytes of memory: `MAX_PACKET` for messages,
/// `MAX_COMMAND` for commands.
#[derive(Debug)]
pub struct Decoder<T, const N: usize> {
    payload: [u8; N],
    length: usize,
    /// Bytes since the last delimiter.
    received: u32,
    too_long: bool,
    cobs: DecoderState,
    counters: Counters,
    record: PhantomData<fn() -> T>,
}

impl<T: Record, const N: usize> Decoder<T, N> {
    /// A decoder at the start of a packet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            payload: [0; N],
            length: 0,
            received: 0,
            too_long: false,
            cobs: DecoderState::Idle,
            counters: Counters::ZERO,
            record: PhantomData,
        }
    }

    /// Takes one byte; gives a record or an error when it ends a packet.
    pub fn push(&mut self, byte: u8) -> Option<Result<T, DecodeError>> {
        self.received = self.received.saturating_add(1);
        let framing = match self.cobs.feed(byte) {
            Ok(DecodeResult::DataContinue(data)) => {
                match self.payload.get_mut(self.length) {
                    Some(slot) => {
                        *slot = data;
                        self.length = self.length.saturating_add(1);
                    }
                    None => self.too_long = true,
                }
                return None;
            }
            Ok(DecodeResult::NoData | DecodeResult::DataStart) if byte != DELIMITER => return None,
            Ok(DecodeResult::NoData | DecodeResult::DataStart) => {
                self.received = 0; // an empty packet
                return None;
            }
            Ok(DecodeResult::DataComplete) => Ok(()),
            Err(_) => Err(DecodeError::Cobs),
        };
        let result = if self.too_long {
            Err(DecodeError::TooLong)
        } else {
            framing.and_then(|()| self.record())
        };
        Some(self.end_packet(result))
    }

    /// Says that no more bytes come: what was received of a packet counts as [`DecodeError::Cobs`],
    /// or as too long. The decoder is at the start of a packet again.
    pub fn finish(&mut self) -> Option<DecodeError> {
        self.cobs = DecoderState::Idle;
        if self.received == 0 {
            return None;
        }
        let error = if self.too_long { DecodeError::TooLong } else { DecodeError::Cobs };
        self.end_packet(Err(error)).err()
    }

    /// Counts of the records and errors so far.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.counters
    }

    fn end_packet(&mut self, result: Result<T, DecodeError>) -> Result<T, DecodeError> {
        match &result {
            Ok(_) => self.counters.good = self.counters.good.saturating_add(1),
            Err(error) => self.counters.count(*error, self.received),
        }
        (self.length, self.received, self.too_long) = (0, 0, false);
        result
    }

    fn record(&self) -> Result<T, DecodeError> {
        let received = self.payload.get(..self.length).unwrap_or(&[]);
        let (payload, crc) =
            received.split_last_chunk::<CRC_BYTES>().ok_or(DecodeError::Checksum)?;
        if CRC_32.checksum(payload) != u32::from_le_bytes(*crc) {
            return Err(DecodeError::Checksum);
        }
        match payload.split_first() {
            None => Err(DecodeError::Malformed),
            Some((&tag, record)) if tag == T::TAG => match postcard::take_from_bytes(record) {
                Ok((record, [])) => Ok(record),
                _ => Err(DecodeError::Malformed),
            },
            Some((&found, _)) => Err(DecodeError::Version { found }),
        }
    }
}

impl<T: Record, const N: usize> Default for Decoder<T, N> {
    fn default() -> Self {
        Self::new()
    }
}
