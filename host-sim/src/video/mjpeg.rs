//! MJPEG: JPEG files one behind the other, each from its start marker to its end marker.
//!
//! Segments are passed over by their lengths, so that what is inside of them, a thumbnail for one, starts and ends nothing.

use super::{MOST_FRAMES, VideoFault};
use crate::mcap::RECORD_BYTES;
use linestereo_frames::untrusted;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

/// Markers.
const START: u8 = 0xd8;
const END: u8 = 0xd9;
const TEMPORARY: u8 = 0x01;

/// A file that was scanned.
pub(super) struct Stored {
    file: BufReader<File>,
    /// Where each JPEG begins, and its length.
    places: Vec<[u64; 2]>,
    /// Those without an end.
    cut: usize,
    /// Bytes between JPEGs.
    foreign: u64,
}

impl Stored {
    pub(super) fn open(path: &Path) -> Result<Self, VideoFault> {
        let mut file = untrusted::open(path, u64::MAX)?;
        if !file.fill_buf()?.starts_with(&[0xff, START]) {
            return Err(VideoFault::NoMjpeg);
        }
        let mut scan = Scan { file, at: 0 };
        let mut found = (Vec::new(), 0, 0);
        let (places, cut, foreign) = &mut found;
        let mut begins = None;
        loop {
            let from = scan.at;
            let start = match begins.take() {
                Some(start) => start,
                None => match scan.start()? {
                    Some(start) => start,
                    None => {
                        *foreign += scan.at - from;
                        break;
                    }
                },
            };
            *foreign += start.saturating_sub(from);
            match scan.end()? {
                Some(END) if places.len() == MOST_FRAMES => return Err(VideoFault::TooMany),
                Some(END) => places.push([start, scan.at - start]),
                Some(_) => {
                    *cut += 1;
                    begins = Some(scan.at - 2);
                }
                None => {
                    *cut += 1;
                    break;
                }
            }
        }
        let (places, cut, foreign) = found;
        if places.is_empty() { Err(VideoFault::Empty) } else { Ok(Self { file: scan.file, places, cut, foreign }) }
    }

    pub(super) fn frames(&self) -> usize {
        self.places.len()
    }

    pub(super) fn frame(&mut self, index: usize) -> Result<Vec<u8>, VideoFault> {
        let [at, length] =
            *self.places.get(index).ok_or_else(|| VideoFault::EndsEarly(self.places.len(), String::new()))?;
        if length > RECORD_BYTES {
            return Err(VideoFault::TooLarge(length));
        }
        self.file.seek(SeekFrom::Start(at))?;
        let mut bytes = vec![0; length as usize];
        self.file.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    pub(super) fn note(&self) -> Option<String> {
        let cut = (self.cut > 0).then(|| format!("{} frames cut off, which are left out", self.cut));
        let foreign = (self.foreign > 0).then(|| format!("{} bytes between frames passed over", self.foreign));
        let notes: Vec<String> = cut.into_iter().chain(foreign).collect();
        (!notes.is_empty()).then(|| notes.join(", "))
    }
}

/// A file with its place, from its beginning.
struct Scan {
    file: BufReader<File>,
    at: u64,
}

impl Scan {
    fn byte(&mut self) -> io::Result<Option<u8>> {
        let byte = self.file.fill_buf()?.first().copied();
        if byte.is_some() {
            self.file.consume(1);
            self.at += 1;
        }
        Ok(byte)
    }

    /// The byte behind the next 0xff; fill bytes are one.
    fn marker(&mut self) -> io::Result<Option<u8>> {
        loop {
            let buffer = self.file.fill_buf()?;
            if buffer.is_empty() {
                return Ok(None);
            }
            let found = buffer.iter().position(|&byte| byte == 0xff);
            let passed = found.map_or(buffer.len(), |at| at + 1);
            self.file.consume(passed);
            self.at += passed as u64;
            if found.is_none() {
                continue;
            }
            loop {
                match self.byte()? {
                    Some(0xff) => {}
                    other => return Ok(other),
                }
            }
        }
    }

    /// Where the next JPEG begins; what is before it is passed over.
    fn start(&mut self) -> io::Result<Option<u64>> {
        while let Some(marker) = self.marker()? {
            if marker == START {
                return Ok(Some(self.at - 2));
            }
        }
        Ok(None)
    }

    /// Passes over a JPEG behind its start: the marker that ended it, its own end or another start.
    fn end(&mut self) -> io::Result<Option<u8>> {
        while let Some(marker) = self.marker()? {
            match marker {
                END | START => return Ok(Some(marker)),
                // A stuffed byte, a restart: inside of coded values.
                0 | 0xd0..=0xd7 | TEMPORARY => {}
                _ => {
                    let (Some(high), Some(low)) = (self.byte()?, self.byte()?) else { return Ok(None) };
                    let rest = u16::from_be_bytes([high, low]).saturating_sub(2);
                    self.file.seek_relative(rest.into())?;
                    self.at += u64::from(rest);
                }
            }
        }
        Ok(None)
    }
}
