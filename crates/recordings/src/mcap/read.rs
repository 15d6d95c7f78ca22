//! Records of a file, from its first to the end of its data; indexes and what no message needs are
//! passed over.
//!
//! The crate `mcap` takes a record apart. Where records are, and how a chunk is unpacked, is
//! decided here: its `LinearReader` tells no places, reads whole attachments, and takes the size of
//! a chunk from those who made it.

use super::RECORD_BYTES;
use ::mcap::records::{ChunkHeader, Record, op};
use ::mcap::{MAGIC, parse_record};
use core::fmt;
use linestereo_frames::untrusted::{self, printable};
use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

/// Kind and length of a record.
const HEAD_BYTES: usize = 9;
/// Chunks that are kept: those of the left and the right image.
const KEPT: usize = 2;

/// A file that is read.
pub struct Reader {
    file: BufReader<File>,
    length: u64,
    /// Records by the place of what holds them, the last ones used at the end.
    kept: VecDeque<(u64, Arc<[u8]>)>,
}

/// Place of a message.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Of its chunk in the file, or of itself.
    record: u64,
    /// Of itself in the unpacked chunk.
    inside: u32,
}

/// Why a file cannot be read, with the place of the record.
#[derive(Debug, thiserror::Error)]
pub enum McapFault {
    /// The file system says so.
    #[error("it cannot be read ({0}); check the path")]
    Read(#[from] io::Error),
    /// It does not begin as it has to.
    #[error("it is no MCAP file; convert a ROS 1 or SQLite bag with `mcap convert`")]
    NoMcap,
    /// It has no end.
    #[error("it ends early, in or behind the record at byte {0}; {AGAIN}")]
    EndsEarly(u64),
    /// A chunk or message beyond [`RECORD_BYTES`].
    #[error(
        "the record at byte {0} has {1} bytes, more than {most} MiB; record with smaller chunks",
        most = RECORD_BYTES >> 20
    )]
    TooLarge(u64, u64),
    /// Fields of a record reach beyond it.
    #[error("the record at byte {0} is broken; {AGAIN}")]
    Record(u64),
    /// A chunk is packed by something else than lz4 or zstd.
    #[error(
        "the chunk at byte {0} is compressed with \"{name}\", not with lz4 or zstd; convert the \
         file with `mcap compress`",
        name = printable(.1)
    )]
    Compression(u64, String),
    /// A chunk is not what its checksum or its size says.
    #[error("the chunk at byte {0} is broken ({what}); {AGAIN}", what = printable(.1))]
    Chunk(u64, String),
}

const AGAIN: &str = "copy it again, or repair it with `mcap recover`";

impl Reader {
    /// Opens a file that begins as one.
    pub fn open(path: &Path) -> Result<Self, McapFault> {
        let mut file = untrusted::open(path, u64::MAX)?; // read record by record
        let length = file.get_ref().metadata()?.len();
        let mut magic = Vec::new();
        (&mut file).take(MAGIC.len() as u64).read_to_end(&mut magic)?;
        if magic == MAGIC {
            Ok(Self { file, length, kept: VecDeque::new() })
        } else {
            Err(McapFault::NoMcap)
        }
    }

    /// Every schema, channel and message, in the order of the file.
    pub fn scan<E: From<McapFault>>(
        &mut self,
        mut visit: impl FnMut(Record<'_>, Place) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut at = MAGIC.len() as u64;
        loop {
            let (kind, length) = self.head(at)?;
            match kind {
                op::DATA_END | op::FOOTER => return Ok(()),
                op::SCHEMA | op::CHANNEL | op::MESSAGE | op::CHUNK => {
                    let records = self.records(at)?;
                    let mut left = &records[..];
                    while !left.is_empty() {
                        let inside = (records.len() - left.len()) as u32; // at most `RECORD_BYTES`
                        let (kind, fields, rest) = split(left).ok_or(McapFault::Record(at))?;
                        if matches!(kind, op::SCHEMA | op::CHANNEL | op::MESSAGE) {
                            let record =
                                parse_record(kind, fields).map_err(|_| McapFault::Record(at))?;
                            visit(record, Place { record: at, inside })?;
                        }
                        left = rest;
                    }
                }
                _ => {}
            }
            at += HEAD_BYTES as u64 + length;
        }
    }

    /// The bytes of a message.
    pub fn message(&mut self, Place { record, inside }: Place) -> Result<Vec<u8>, McapFault> {
        let records = self.kept(record)?;
        // Another file may be there than the one that was scanned.
        let found = records.get(inside as usize..).and_then(split);
        match found.map(|(kind, fields, _)| parse_record(kind, fields)) {
            Some(Ok(Record::Message { data, .. })) => Ok(data.into_owned()),
            _ => Err(McapFault::Record(record)),
        }
    }

    /// Kind and length of the record at a place, which lies in the file as a whole.
    fn head(&mut self, at: u64) -> Result<(u8, u64), McapFault> {
        let Some(left) = self.length.checked_sub(at.saturating_add(HEAD_BYTES as u64)) else {
            return Err(McapFault::EndsEarly(at));
        };
        // Within what is buffered nothing is read again.
        let now = self.file.stream_position()?;
        match at.checked_signed_diff(now) {
            Some(difference) => self.file.seek_relative(difference)?,
            None => drop(self.file.seek(SeekFrom::Start(at))?),
        }
        let mut head = [0; HEAD_BYTES];
        self.file.read_exact(&mut head)?;
        let [kind, length @ ..] = head;
        let length = u64::from_le_bytes(length);
        if length > left { Err(McapFault::EndsEarly(at)) } else { Ok((kind, length)) }
    }

    /// The records of the chunk at a place, or the one that is there.
    fn records(&mut self, at: u64) -> Result<Vec<u8>, McapFault> {
        let (kind, length) = self.head(at)?;
        if length > RECORD_BYTES {
            return Err(McapFault::TooLarge(at, length));
        }
        if kind != op::CHUNK {
            let mut record = Vec::with_capacity(HEAD_BYTES + length as usize);
            record.push(kind);
            record.extend(length.to_le_bytes());
            (&mut self.file).take(length).read_to_end(&mut record)?;
            return Ok(record);
        }
        let mut fields = vec![0; length as usize];
        self.file.read_exact(&mut fields)?;
        match parse_record(kind, &fields) {
            Ok(Record::Chunk { header, data }) => unpacked(&header, &data, at),
            _ => Err(McapFault::Record(at)),
        }
    }

    /// The same, kept for the next message of them.
    fn kept(&mut self, at: u64) -> Result<Arc<[u8]>, McapFault> {
        let found = self
            .kept
            .iter()
            .position(|(of, _)| *of == at)
            .and_then(|index| self.kept.remove(index));
        let records = match found {
            Some((_, records)) => records,
            None => {
                // Two large ones are too many.
                self.kept.retain(|(_, records)| records.len() as u64 <= RECORD_BYTES / 2);
                self.kept.drain(..self.kept.len().saturating_sub(KEPT - 1));
                self.records(at)?.into()
            }
        };
        self.kept.push_back((at, Arc::clone(&records)));
        Ok(records)
    }
}

/// Exactly as many bytes as the chunk says: what else is packed stays so.
fn unpacked(header: &ChunkHeader, stored: &[u8], at: u64) -> Result<Vec<u8>, McapFault> {
    let size = header.uncompressed_size;
    if size > RECORD_BYTES {
        return Err(McapFault::TooLarge(at, size));
    }
    let broken = |what: &dyn fmt::Display| McapFault::Chunk(at, what.to_string());
    let mut records = vec![0; size as usize];
    let filled = untrusted::guarded(|| match &*header.compression {
        "" => { stored }.read_exact(&mut records),
        "lz4" => lz4_flex::frame::FrameDecoder::new(stored).read_exact(&mut records),
        "zstd" => ruzstd::decoding::StreamingDecoder::new(stored)
            .map_err(|error| io::Error::other(error.to_string()))?
            .read_exact(&mut records),
        _ => Err(ErrorKind::Unsupported.into()),
    });
    match filled {
        None => Err(broken(&"its decoder failed")),
        Some(Err(error)) if error.kind() == ErrorKind::Unsupported => {
            Err(McapFault::Compression(at, header.compression.chars().take(24).collect()))
        }
        Some(Err(error)) => Err(broken(&error)),
        Some(Ok(())) if ![0, crc32fast::hash(&records)].contains(&header.uncompressed_crc) => {
            Err(broken(&"its checksum does not match"))
        }
        Some(Ok(())) => Ok(records),
    }
}

/// Kind and fields of the first record, and the bytes behind it.
fn split(records: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let ([kind, length @ ..], rest) = records.split_first_chunk::<HEAD_BYTES>()?;
    let (fields, rest) =
        rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
    Some((*kind, fields, rest))
}
