//! Messages in chunks, then what players look for first: schemas, channels, counts, and where each chunk is.

use super::{MAGIC, kind};
use std::io::{self, Write};

/// Bytes of records behind which a chunk is closed.
const CHUNK_BYTES: usize = 1 << 20;

/// A file that is written, from its first byte to its last: it goes to pipes too.
#[derive(Debug)]
pub struct Writer<W> {
    out: W,
    /// Bytes that were written.
    at: u64,
    schemas: Vec<Vec<u8>>,
    channels: Vec<Channel>,
    /// The open chunk.
    chunk: Chunk,
    /// Fields of the indexes of those that are closed.
    chunks: Vec<Vec<u8>>,
    /// First and last time of a message, ns.
    times: Option<[u64; 2]>,
}

#[derive(Debug)]
struct Channel {
    fields: Vec<u8>,
    messages: u64,
    /// Times of its messages in the open chunk, and their places in it.
    index: Vec<[u64; 2]>,
}

#[derive(Debug, Default)]
struct Chunk {
    records: Vec<u8>,
    times: Option<[u64; 2]>,
}

impl<W: Write> Writer<W> {
    /// A file for ROS 2.
    pub fn new(mut out: W, library: &str) -> io::Result<Self> {
        out.write_all(&MAGIC)?;
        let mut writer = Self {
            out,
            at: MAGIC.len() as u64,
            schemas: Vec::new(),
            channels: Vec::new(),
            chunk: Chunk::default(),
            chunks: Vec::new(),
            times: None,
        };
        writer.record(kind::HEADER, &[text("ros2"), text(library)].concat())?;
        Ok(writer)
    }

    /// The number of a message's definition, a text of `ros2msg`.
    pub fn schema(&mut self, name: &str, definition: &str) -> io::Result<u16> {
        let id = self.schemas.len() as u16 + 1; // 0 is none
        let fields = [&id.to_le_bytes()[..], &text(name), &text("ros2msg"), &text(definition)].concat();
        self.record(kind::SCHEMA, &fields)?;
        self.schemas.push(fields);
        Ok(id)
    }

    /// The number of a topic.
    pub fn channel(&mut self, schema: u16, topic: &str) -> io::Result<u16> {
        let id = self.channels.len() as u16;
        let no_metadata = 0_u32.to_le_bytes();
        let fields = [&id.to_le_bytes()[..], &schema.to_le_bytes(), &text(topic), &text("cdr"), &no_metadata].concat();
        self.record(kind::CHANNEL, &fields)?;
        self.channels.push(Channel { fields, messages: 0, index: Vec::new() });
        Ok(id)
    }

    /// A message of a topic, recorded when it was made, ns.
    pub fn message(&mut self, channel: u16, time: u64, data: &[u8]) -> io::Result<()> {
        let Some(of) = self.channels.get_mut(usize::from(channel)) else { return Err(io::ErrorKind::NotFound.into()) };
        let sequence = of.messages as u32; // it may begin anew
        of.index.push([time, self.chunk.records.len() as u64]);
        of.messages += 1;
        let fields = [&channel.to_le_bytes()[..], &sequence.to_le_bytes(), &time.to_le_bytes(), &time.to_le_bytes()];
        let length: usize = fields.iter().map(|field| field.len()).sum();
        self.chunk.records.extend(head(kind::MESSAGE, length + data.len()));
        fields.into_iter().chain([data]).for_each(|field| self.chunk.records.extend(field));
        for times in [&mut self.times, &mut self.chunk.times] {
            let [first, last] = times.unwrap_or([time; 2]);
            *times = Some([first.min(time), last.max(time)]);
        }
        if self.chunk.records.len() < CHUNK_BYTES { Ok(()) } else { self.close_chunk() }
    }

    /// The open chunk with an index of each of its topics.
    fn close_chunk(&mut self) -> io::Result<()> {
        let Chunk { records, times: Some([first, last]) } = core::mem::take(&mut self.chunk) else { return Ok(()) };
        let (size, start) = ((records.len() as u64).to_le_bytes(), self.at);
        let times = [first.to_le_bytes(), last.to_le_bytes()].concat();
        let checksum = crc32fast::hash(&records).to_le_bytes();
        self.record(kind::CHUNK, &[&times[..], &size, &checksum, &text(""), &size, &records].concat())?;
        let (length, mut places) = (self.at - start, Vec::new());
        let indexes = self.at;
        for id in 0..self.channels.len() {
            let index = core::mem::take(&mut self.channels[id].index);
            if index.is_empty() {
                continue;
            }
            let id = (id as u16).to_le_bytes();
            places.extend([&id[..], &self.at.to_le_bytes()].concat());
            let entries: Vec<u8> = index.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
            self.record(kind::MESSAGE_INDEX, &[&id[..], &counted(&entries)].concat())?;
        }
        let [start, length, indexes] = [start, length, self.at - indexes].map(u64::to_le_bytes);
        self.chunks.push([&times[..], &start, &length, &counted(&places), &indexes, &text(""), &size, &size].concat());
        Ok(())
    }

    /// Closes the file.
    pub fn finish(mut self) -> io::Result<W> {
        self.close_chunk()?;
        self.record(kind::DATA_END, &0_u32.to_le_bytes())?; // no checksum
        let summary = self.at;
        let channels: Vec<Vec<u8>> = self.channels.iter().map(|channel| channel.fields.clone()).collect();
        let statistics = self.statistics();
        let groups = [
            (kind::SCHEMA, core::mem::take(&mut self.schemas)),
            (kind::CHANNEL, channels),
            (kind::STATISTICS, vec![statistics]),
            (kind::CHUNK_INDEX, core::mem::take(&mut self.chunks)),
        ];
        let mut offsets = Vec::new();
        for (kind, records) in groups {
            let start = self.at;
            for fields in &records {
                self.record(kind, fields)?;
            }
            if !records.is_empty() {
                offsets.push([&[kind][..], &start.to_le_bytes(), &(self.at - start).to_le_bytes()].concat());
            }
        }
        let place = self.at;
        for fields in &offsets {
            self.record(kind::SUMMARY_OFFSET, fields)?;
        }
        let no_checksum = 0_u32.to_le_bytes();
        self.record(kind::FOOTER, &[&summary.to_le_bytes()[..], &place.to_le_bytes(), &no_checksum].concat())?;
        self.out.write_all(&MAGIC)?;
        Ok(self.out)
    }

    fn statistics(&self) -> Vec<u8> {
        let messages: u64 = self.channels.iter().map(|channel| channel.messages).sum();
        let counts = self.channels.iter().zip(0_u16..);
        let counts = counts.flat_map(|(channel, id)| [&id.to_le_bytes()[..], &channel.messages.to_le_bytes()].concat());
        let [first, last] = self.times.unwrap_or_default().map(u64::to_le_bytes);
        let schemas = (self.schemas.len() as u16).to_le_bytes();
        let [channels, chunks] = [self.channels.len(), self.chunks.len()].map(|count| (count as u32).to_le_bytes());
        let none = [0; 8]; // attachments and metadata
        let counts = counted(&counts.collect::<Vec<u8>>());
        [&messages.to_le_bytes()[..], &schemas, &channels, &none, &chunks, &first, &last, &counts].concat()
    }

    fn record(&mut self, kind: u8, fields: &[u8]) -> io::Result<()> {
        let head = head(kind, fields.len());
        self.out.write_all(&head)?;
        self.out.write_all(fields)?;
        self.at += (head.len() + fields.len()) as u64;
        Ok(())
    }
}

fn head(kind: u8, length: usize) -> [u8; 9] {
    let mut head = [kind; 9];
    head[1..].copy_from_slice(&(length as u64).to_le_bytes());
    head
}

/// Bytes behind their number.
fn counted(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}

fn text(text: &str) -> Vec<u8> {
    counted(text.as_bytes())
}
