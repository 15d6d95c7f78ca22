//! Y4M: a line with size, rate and samples, then each frame behind a line of its own: luma, and
//! chroma, which is passed over.
//!
//! # Source
//! `yuv4mpeg(5)` of MJPEG Tools; names of samples beyond 8 bits as ffmpeg writes them (`C420p10`,
//! `Cmono12`).

use super::{Luma, MOST_FRAMES, Source, VideoFault};
use linestereo_frames::untrusted::{self, PIXELS};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

const MAGIC: &[u8] = b"YUV4MPEG2";
const FRAME: &[u8] = b"FRAME";
/// Most bytes of a line: remarks of a writer may stand in it.
const LINE_BYTES: u64 = 1024;
/// Most px of a side.
const MOST_SIDE: u64 = 65_535;

/// Size, rate and sample format, from the first line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Header {
    sides: [u32; 2],
    bits: u32,
    /// Frames in so many seconds.
    rate: Option<[u32; 2]>,
    /// Of the luma of a frame, and of what is behind it.
    luma_bytes: u64,
    other_bytes: u64,
}

/// A line with its end; empty at the end of the data, cut off where it is longer than a line may
/// be.
fn line(from: &mut impl BufRead) -> io::Result<Vec<u8>> {
    let mut line = Vec::new();
    from.take(LINE_BYTES).read_until(b'\n', &mut line)?;
    Ok(line)
}

fn is_frame(line: &[u8]) -> bool {
    let rest = line.strip_suffix(b"\n").and_then(|line| line.strip_prefix(FRAME));
    rest.is_some_and(|rest| rest.is_empty() || rest[0] == b' ')
}

impl Header {
    pub(super) fn read(from: &mut impl BufRead) -> Result<Self, VideoFault> {
        let line = line(from)?;
        match line.strip_suffix(b"\n") {
            Some(line) => Self::of(line),
            None if line.is_empty() => Err(VideoFault::Header("it is empty")),
            None => Err(VideoFault::Header("its first line has no end")),
        }
    }

    fn of(line: &[u8]) -> Result<Self, VideoFault> {
        let mut fields = line.split(|&byte| byte == b' ');
        if fields.next() != Some(MAGIC) {
            return Err(VideoFault::Header("it starts with something else"));
        }
        let (mut width, mut height, mut rate, mut samples) = (None, None, None, "420jpeg");
        for field in fields.filter_map(|field| core::str::from_utf8(field).ok()) {
            let Some((letter, value)) = field.split_at_checked(1) else { continue };
            match letter {
                "W" => width = value.parse::<u64>().ok(),
                "H" => height = value.parse::<u64>().ok(),
                "F" => {
                    rate = value
                        .split_once(':')
                        .and_then(|(n, d)| Some([n.parse().ok()?, d.parse().ok()?]))
                }
                "C" => samples = value,
                _ => {} // interlacing, shape of a pixel, remarks
            }
        }
        let (Some(width), Some(height)) = (width, height) else {
            return Err(VideoFault::Header("its width or height is missing, or no number"));
        };
        let is_side = |side: u64| (1..=MOST_SIDE).contains(&side);
        if !is_side(width) || !is_side(height) || width * height > PIXELS {
            return Err(VideoFault::Size([width, height]));
        }
        let (bits, chroma) = sampled(samples, [width, height])
            .ok_or_else(|| VideoFault::Samples(samples.chars().take(24).collect()))?;
        let bytes = if bits > 8 { 2 } else { 1 };
        Ok(Self {
            sides: [width as u32, height as u32],
            bits,
            rate: rate.filter(|rate| !rate.contains(&0)),
            luma_bytes: width * height * bytes,
            other_bytes: chroma * bytes,
        })
    }

    /// The next frame: nothing at the end of the data, an error where that is inside the frame.
    pub(super) fn frame(
        &self,
        from: &mut impl BufRead,
        index: usize,
    ) -> Result<Option<Luma>, VideoFault> {
        match line(from)? {
            line if line.is_empty() => return Ok(None),
            line if !is_frame(&line) => return Err(VideoFault::Frame(index)),
            _ => {}
        }
        let luma = self.luma(from)?;
        let passed = io::copy(&mut from.take(self.other_bytes), &mut io::sink())?;
        if passed < self.other_bytes {
            return Err(VideoFault::Read(io::ErrorKind::UnexpectedEof.into()));
        }
        Ok(Some(luma))
    }

    fn luma(&self, from: &mut impl Read) -> Result<Luma, VideoFault> {
        let mut bytes = vec![0; self.luma_bytes as usize];
        from.read_exact(&mut bytes)?;
        Ok(Luma { sides: self.sides, bits: self.bits, bytes })
    }
}

/// Bits of a sample, and number of those that are not luma.
fn sampled(name: &str, [width, height]: [u64; 2]) -> Option<(u32, u64)> {
    let half = |side: u64| side.div_ceil(2);
    let (name, bits) = match name.strip_prefix("mono") {
        Some(bits) => ("mono", bits),
        None => name
            .split_once('p')
            .filter(|(_, bits)| bits.parse::<u32>().is_ok())
            .unwrap_or((name, "8")),
    };
    let chroma = match name {
        "mono" => 0,
        "420" | "420jpeg" | "420mpeg2" | "420paldv" => 2 * half(width) * half(height),
        "411" => 2 * width.div_ceil(4) * height,
        "422" => 2 * half(width) * height,
        "444" => 2 * width * height,
        "444alpha" => 3 * width * height,
        _ => return None,
    };
    let bits = if bits.is_empty() { 8 } else { bits.parse().ok()? };
    (8..=16).contains(&bits).then_some((bits, chroma))
}

/// A file that was scanned.
pub(super) struct Stored {
    file: BufReader<File>,
    header: Header,
    /// Where the values of each frame begin.
    places: Vec<u64>,
    is_cut: bool,
}

impl Stored {
    pub(super) fn open(path: &Path) -> Result<Self, VideoFault> {
        let mut file = untrusted::open(path, u64::MAX)?;
        let length = file.get_ref().metadata()?.len();
        let header = Header::read(&mut file)?;
        let bytes = header.luma_bytes + header.other_bytes;
        let (mut places, mut is_cut) = (Vec::new(), false);
        loop {
            let line = line(&mut file)?;
            let at = file.stream_position()?;
            if line.is_empty() {
                break;
            }
            // The file ends in this line, or in the frame behind it.
            is_cut = at == length && !line.ends_with(b"\n")
                || is_frame(&line) && length.saturating_sub(at) < bytes;
            if is_cut {
                break;
            }
            if !is_frame(&line) {
                return Err(VideoFault::Frame(places.len()));
            }
            if places.len() == MOST_FRAMES {
                return Err(VideoFault::TooMany);
            }
            places.push(at);
            file.seek_relative(bytes as i64)?;
        }
        if places.is_empty() {
            Err(VideoFault::Empty)
        } else {
            Ok(Self { file, header, places, is_cut })
        }
    }
}

impl Source for Stored {
    fn frames(&self) -> Option<usize> {
        Some(self.places.len())
    }

    fn time_ns(&self, index: usize) -> Option<u64> {
        let [frames, seconds] = self.header.rate?.map(u128::from);
        u64::try_from(index as u128 * seconds * 1_000_000_000 / frames).ok()
    }

    fn frame(&mut self, index: usize) -> Result<Luma, VideoFault> {
        let at = *self
            .places
            .get(index)
            .ok_or_else(|| VideoFault::EndsEarly(self.places.len(), String::new()))?;
        self.file.seek(SeekFrom::Start(at))?;
        self.header.luma(&mut self.file)
    }

    fn note(&self) -> Option<String> {
        self.is_cut
            .then(|| format!("cut off inside frame {}, which is left out", self.places.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_have_these_sizes() {
        for (name, bits, chroma) in [
            ("mono", 8, 0),
            ("mono10", 10, 0),
            ("mono16", 16, 0),
            ("420jpeg", 8, 12),
            ("420paldv", 8, 12),
            ("420p10", 10, 12),
            ("411", 8, 12),
            ("422", 8, 18),
            ("444", 8, 30),
            ("444alpha", 8, 45),
        ] {
            assert_eq!(sampled(name, [5, 3]), Some((bits, chroma)), "{name}");
        }
        for name in ["420p17", "mono7", "p10", "", "rgb", "420p"] {
            assert_eq!(sampled(name, [5, 3]), None, "{name}");
        }
    }
}
