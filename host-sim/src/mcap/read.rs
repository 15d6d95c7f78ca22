//! Records of a file, from its first to the end of its data; indexes and what no message needs are passed over.

use super::{MAGIC, RECORD_BYTES, kind};
use core::fmt;
use linestereo_frames::untrusted::{self, printable};
use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

/// Kind and length of a record.
const HEAD_BYTES: u64 = 9;
/// Channel, sequence number, two times.
const MESSAGE_HEAD_BYTES: usize = 2 + 4 + 8 + 8;
/// Chunks that are kept: those of the left and the right image.
const KEPT: usize = 2;

/// A file that is read.
pub struct Reader {
    file: BufReader<File>,
    length: u64,
    /// Unpacked chunks by the places of their records, the last one used at the end.
    kept: VecDeque<(u64, Arc<[u8]>)>,
}

/// Place of a message's bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Of the bytes, or of the fields of their chunk.
    record: u64,
    /// Length of these fields, and where the bytes begin in the unpacked chunk.
    chunk: Option<(u32, u32)>,
    length: u32,
}

/// A record.
#[derive(Debug)]
pub enum Item<'a> {
    /// Definition of a message.
    Schema {
        /// Its number.
        id: u16,
        /// Name of the type.
        name: &'a str,
    },
    /// A topic.
    Channel {
        /// Its number.
        id: u16,
        /// Number of its schema; 0 is none.
        schema: u16,
        /// Its name.
        topic: &'a str,
        /// Encoding of its messages.
        encoding: &'a str,
    },
    /// A message.
    Message {
        /// Number of its channel.
        channel: u16,
        /// When it was recorded, ns.
        log_time: u64,
        /// Where it is found again.
        place: Place,
        /// Its bytes.
        data: &'a [u8],
    },
}

/// Why a file cannot be read, with the place of the record.
#[derive(Debug)]
pub enum McapFault {
    /// The file system says so.
    Read(io::Error),
    /// It does not begin as it has to.
    NoMcap,
    /// It has no end.
    EndsEarly(u64),
    /// A chunk or message beyond [`RECORD_BYTES`].
    TooLarge(u64, u64),
    /// Fields of a record reach beyond it.
    Record(u64),
    /// A chunk is packed by something else than lz4 or zstd.
    Compression(u64, String),
    /// A chunk is not what its checksum or its size says.
    Chunk(u64, String),
}

impl fmt::Display for McapFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let again = "copy it again, or repair it with `mcap recover`";
        match self {
            Self::Read(error) => write!(f, "it cannot be read ({error}); check the path"),
            Self::NoMcap => f.write_str("it is no MCAP file; convert a ROS 1 or SQLite bag with `mcap convert`"),
            Self::EndsEarly(at) => write!(f, "it ends early, in or behind the record at byte {at}; {again}"),
            Self::TooLarge(at, bytes) => write!(
                f,
                "the record at byte {at} has {bytes} bytes, more than {} MiB; record with smaller chunks",
                RECORD_BYTES >> 20
            ),
            Self::Record(at) => write!(f, "the record at byte {at} is broken; {again}"),
            Self::Compression(at, name) => write!(
                f,
                "the chunk at byte {at} is packed by \"{}\"; lz4, zstd and none are read: `mcap compress` changes it",
                printable(name)
            ),
            Self::Chunk(at, what) => write!(f, "the chunk at byte {at} is broken ({}); {again}", printable(what)),
        }
    }
}

impl core::error::Error for McapFault {}

impl From<io::Error> for McapFault {
    fn from(error: io::Error) -> Self {
        Self::Read(error)
    }
}

impl fmt::Debug for Reader {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reader").field("length", &self.length).finish_non_exhaustive()
    }
}

impl Reader {
    /// Opens a file that begins as one.
    pub fn open(path: &Path) -> Result<Self, McapFault> {
        let mut file = untrusted::open(path, u64::MAX)?; // read record by record
        let length = file.get_ref().metadata()?.len();
        let mut magic = [0; MAGIC.len()];
        match file.read_exact(&mut magic) {
            Err(error) if error.kind() != ErrorKind::UnexpectedEof => Err(error.into()),
            _ if magic != MAGIC => Err(McapFault::NoMcap),
            _ => Ok(Self { file, length, kept: VecDeque::new() }),
        }
    }

    /// Every schema, channel and message, in the order of the file.
    pub fn scan<E: From<McapFault>>(&mut self, mut visit: impl FnMut(Item<'_>) -> Result<(), E>) -> Result<(), E> {
        let mut at = MAGIC.len() as u64;
        loop {
            let (kind, length) = self.head(at)?;
            let record = at + HEAD_BYTES;
            match kind {
                kind::DATA_END | kind::FOOTER => return Ok(()),
                kind::CHUNK => {
                    let chunk = self.unpacked(record, length)?;
                    // At most `RECORD_BYTES`, as every place in it.
                    let place =
                        |inside, bytes| Place { record, chunk: Some((length as u32, inside as u32)), length: bytes };
                    visit_records(&chunk, at, &place, &mut visit)?;
                }
                kind::SCHEMA | kind::CHANNEL | kind::MESSAGE => {
                    let fields = self.bytes(record, length)?;
                    let place = |inside, bytes| Place { record: record + inside as u64, chunk: None, length: bytes };
                    visit_record(kind, &fields, 0, at, &place, &mut visit)?;
                }
                _ => {}
            }
            at = record + length;
        }
    }

    /// The bytes of a message.
    pub fn message(&mut self, place: Place) -> Result<Vec<u8>, McapFault> {
        let Some((length, inside)) = place.chunk else { return self.bytes(place.record, place.length.into()) };
        let chunk = self.chunk(place.record, length.into())?;
        let inside = inside as usize;
        // Another chunk is there than the one that was scanned.
        let bytes = chunk.get(inside..inside + place.length as usize).ok_or(McapFault::Record(place.record))?;
        Ok(bytes.to_vec())
    }

    /// Kind and length of the record at a place, which lies in the file as a whole.
    fn head(&mut self, at: u64) -> Result<(u8, u64), McapFault> {
        if at.saturating_add(HEAD_BYTES) > self.length {
            return Err(McapFault::EndsEarly(at));
        }
        let mut head = [0; HEAD_BYTES as usize];
        self.seek(at)?;
        self.file.read_exact(&mut head)?;
        let [kind, length @ ..] = head;
        let length = u64::from_le_bytes(length);
        if length > self.length - at - HEAD_BYTES {
            return Err(McapFault::EndsEarly(at));
        }
        Ok((kind, length))
    }

    /// Bytes at a place, after a look at how many.
    fn bytes(&mut self, at: u64, length: u64) -> Result<Vec<u8>, McapFault> {
        if length > RECORD_BYTES {
            return Err(McapFault::TooLarge(at.saturating_sub(HEAD_BYTES), length));
        }
        let mut bytes = vec![0; length as usize];
        self.seek(at)?;
        self.file.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    /// Within what is buffered nothing is read again.
    fn seek(&mut self, at: u64) -> io::Result<()> {
        let now = self.file.stream_position()?;
        match at.checked_signed_diff(now) {
            Some(0) => Ok(()),
            Some(difference) => self.file.seek_relative(difference),
            None => self.file.seek(SeekFrom::Start(at)).map(|_| ()),
        }
    }

    /// An unpacked chunk, kept for the next message in it.
    fn chunk(&mut self, record: u64, length: u64) -> Result<Arc<[u8]>, McapFault> {
        if let Some(found) = self.kept.iter().position(|(at, _)| *at == record) {
            let kept = self.kept.remove(found).ok_or(McapFault::Record(record))?;
            self.kept.push_back(kept);
        } else {
            // Two large ones are too many.
            self.kept.retain(|(_, chunk)| chunk.len() as u64 <= RECORD_BYTES / 2);
            if self.kept.len() == KEPT {
                self.kept.pop_front();
            }
            let chunk = self.unpacked(record, length)?;
            self.kept.push_back((record, chunk.into()));
        }
        let (_, chunk) = self.kept.back().ok_or(McapFault::Record(record))?;
        Ok(Arc::clone(chunk))
    }

    /// Records in a chunk, of which the fields are these.
    fn unpacked(&mut self, record: u64, length: u64) -> Result<Vec<u8>, McapFault> {
        let at = record.saturating_sub(HEAD_BYTES);
        let fields = self.bytes(record, length)?;
        let mut left = Fields(&fields);
        let mut head = || {
            let (_start, _end) = (left.u64()?, left.u64()?);
            let (size, checksum, packer, stored) = (left.u64()?, left.u32()?, left.text()?, left.u64()?);
            Some((size, checksum, packer, left.take(usize::try_from(stored).ok()?)?))
        };
        let (size, checksum, packer, stored) = head().ok_or(McapFault::Record(at))?;
        if size > RECORD_BYTES {
            return Err(McapFault::TooLarge(at, size));
        }
        let broken = |what: String| McapFault::Chunk(at, what);
        let mut records = vec![0; size as usize];
        // Exactly as many as the chunk says: what else is packed stays so.
        let filled = untrusted::guarded(|| match packer {
            "" => (&*stored).read_exact(&mut records),
            "lz4" => lz4_flex::frame::FrameDecoder::new(stored).read_exact(&mut records),
            "zstd" => ruzstd::decoding::StreamingDecoder::new(stored)
                .map_err(|error| io::Error::other(error.to_string()))?
                .read_exact(&mut records),
            _ => Err(ErrorKind::Unsupported.into()),
        });
        match filled.ok_or_else(|| broken("its decoder failed".to_owned()))? {
            Err(error) if error.kind() == ErrorKind::Unsupported => {
                return Err(McapFault::Compression(at, packer.chars().take(24).collect()));
            }
            filled => filled.map_err(|error| broken(error.to_string()))?,
        }
        if checksum != 0 && crc32fast::hash(&records) != checksum {
            return Err(broken("its checksum is another".to_owned()));
        }
        Ok(records)
    }
}

/// The records in an unpacked chunk that begins at `at` of the file.
fn visit_records<E: From<McapFault>>(
    chunk: &[u8],
    at: u64,
    place: &impl Fn(usize, u32) -> Place,
    visit: &mut impl FnMut(Item<'_>) -> Result<(), E>,
) -> Result<(), E> {
    let mut left = Fields(chunk);
    while !left.0.is_empty() {
        let mut head = || {
            let (kind, length) = (left.u8()?, usize::try_from(left.u64()?).ok()?);
            let before = chunk.len() - left.0.len();
            Some((kind, before, left.take(length)?))
        };
        let (kind, before, fields) = head().ok_or(McapFault::Record(at))?;
        visit_record(kind, fields, before, at, place, visit)?;
    }
    Ok(())
}

/// A record with `before` bytes before its fields.
fn visit_record<E: From<McapFault>>(
    kind: u8,
    fields: &[u8],
    before: usize,
    at: u64,
    place: &impl Fn(usize, u32) -> Place,
    visit: &mut impl FnMut(Item<'_>) -> Result<(), E>,
) -> Result<(), E> {
    let mut left = Fields(fields);
    let item = match kind {
        kind::SCHEMA => left.u16().zip(left.text()).map(|(id, name)| Item::Schema { id, name }),
        kind::CHANNEL => {
            let (ids, texts) = (left.u16().zip(left.u16()), left.text().zip(left.text()));
            ids.zip(texts).map(|((id, schema), (topic, encoding))| Item::Channel { id, schema, topic, encoding })
        }
        kind::MESSAGE => {
            let numbers = left.u16().zip(left.u32()).zip(left.u64().zip(left.u64()));
            let place = place(before + MESSAGE_HEAD_BYTES, left.0.len() as u32);
            numbers.map(|((channel, _), (log_time, _))| Item::Message { channel, log_time, place, data: left.0 })
        }
        _ => return Ok(()),
    };
    visit(item.ok_or(McapFault::Record(at))?)
}

/// Fields of a record that are not read yet.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, left) = self.0.split_at_checked(count)?;
        self.0 = left;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    fn u8(&mut self) -> Option<u8> {
        self.array().map(|[byte]| byte)
    }

    fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    fn text(&mut self) -> Option<&'a str> {
        let length = self.u32()?;
        core::str::from_utf8(self.take(length as usize)?).ok()
    }
}
