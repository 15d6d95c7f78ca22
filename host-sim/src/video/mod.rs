//! Videos: frames by their numbers, as grey values or JPEG.
//!
//! ```text
//! y4m      raw frames with a header, the luma plane of each; of a file by their places, of a pipe one after the other
//! mjpeg    JPEG files one behind the other, by their places
//! ffmpeg   all others, and cameras: the system's program decodes to Y4M, which is read from a pipe
//! ```
//!
//! No codec is linked. A file of ours is scanned once for the places of its frames; one of ffmpeg's is counted once without being decoded.
//!
//! # Bounds
//! At most 524 288 frames are known, 16 bytes each. A line of a header has at most 1 KiB, a frame 33 554 432 px; a JPEG
//! 32 MiB. Three frames of a pipe are held at most.

mod ffmpeg;
mod mjpeg;
mod y4m;

use crate::mcap::RECORD_BYTES;
use core::fmt;
use linestereo_frames::untrusted::{PIXELS, printable};
use std::io;
use std::path::Path;

pub use ffmpeg::Camera;

/// Most frames of a video: four hours and a half, thirty times a second.
const MOST_FRAMES: usize = 1 << 19;
/// Endings of the names of videos: those that are read here, and those that ffmpeg reads.
const OWN: [&str; 3] = ["y4m", "mjpeg", "mjpg"];
const FFMPEG: [&str; 6] = ["mp4", "m4v", "mkv", "avi", "mov", "webm"];

/// A frame as it is stored.
#[derive(Clone, Debug)]
pub enum Frame {
    /// Grey values.
    Luma(Luma),
    /// A JPEG file.
    Jpeg(Vec<u8>),
}

/// Grey values, row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Luma {
    /// Width and height, px.
    pub sides: [u32; 2],
    /// Bits of a value: of more than 8 it takes two bytes, the lower one first.
    pub bits: u32,
    /// The values.
    pub bytes: Vec<u8>,
}

/// A video, or a camera.
pub struct Source(Kind);

enum Kind {
    Y4m(y4m::Stored),
    Mjpeg(mjpeg::Stored),
    Decoded(ffmpeg::Decoder),
}

/// Is this a video, by its name?
#[must_use]
pub fn is_video(path: &Path) -> bool {
    ending(path).is_some_and(|ending| OWN.contains(&&*ending) || FFMPEG.contains(&&*ending))
}

fn ending(path: &Path) -> Option<String> {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase())
}

impl Source {
    /// Finds the frames of a file.
    pub fn open(path: &Path) -> Result<Self, VideoFault> {
        let ending = ending(path);
        Ok(Self(match ending.as_deref() {
            Some("y4m") => Kind::Y4m(y4m::Stored::open(path)?),
            Some("mjpeg" | "mjpg") => Kind::Mjpeg(mjpeg::Stored::open(path)?),
            _ => Kind::Decoded(ffmpeg::Decoder::open(path)?),
        }))
    }

    /// Starts a camera, which has no last frame.
    pub fn camera(camera: &Camera) -> Result<Self, VideoFault> {
        ffmpeg::Decoder::camera(camera).map(|decoder| Self(Kind::Decoded(decoder)))
    }

    /// Number of frames; of a camera none is known.
    #[must_use]
    pub fn frames(&self) -> Option<usize> {
        match &self.0 {
            Kind::Y4m(stored) => Some(stored.frames()),
            Kind::Mjpeg(stored) => Some(stored.frames()),
            Kind::Decoded(decoder) => decoder.frames(),
        }
    }

    /// Time of a frame behind the first one, ns; of a camera that of the clock when the frame arrived, of the last one alone.
    #[must_use]
    pub fn time_ns(&self, index: usize) -> Option<u64> {
        match &self.0 {
            Kind::Y4m(stored) => stored.time_ns(index),
            Kind::Mjpeg(_) => None,
            Kind::Decoded(decoder) => decoder.time_ns(index),
        }
    }

    /// The frame of this number. What ffmpeg decodes is decoded anew for one before the last.
    pub fn frame(&mut self, index: usize) -> Result<Frame, VideoFault> {
        match &mut self.0 {
            Kind::Y4m(stored) => stored.frame(index).map(Frame::Luma),
            Kind::Mjpeg(stored) => stored.frame(index).map(Frame::Jpeg),
            Kind::Decoded(decoder) => decoder.frame(index).map(Frame::Luma),
        }
    }

    /// No frame comes any more: the number of those that did.
    #[must_use]
    pub fn ended(&self) -> Option<usize> {
        if let Kind::Decoded(decoder) = &self.0 { decoder.ended() } else { None }
    }

    /// A warning for the summary; `None` where every frame was read without one.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        match &self.0 {
            Kind::Y4m(stored) => stored.note(),
            Kind::Mjpeg(stored) => stored.note(),
            Kind::Decoded(decoder) => decoder.note(),
        }
    }
}

/// Why a video, or a frame of it, cannot be used.
#[derive(Debug)]
pub enum VideoFault {
    /// The file system says so.
    Read(io::Error),
    /// The first line is none of Y4M.
    Header(&'static str),
    /// Samples of a kind that is not read.
    Samples(String),
    /// Frames of this size are not read.
    Size([u64; 2]),
    /// It does not begin with a JPEG.
    NoMjpeg,
    /// It holds no whole frame.
    Empty,
    /// More frames than are counted.
    TooMany,
    /// A frame does not begin as it has to.
    Frame(usize),
    /// A JPEG of so many bytes.
    TooLarge(u64),
    /// Both views in an image of this odd width.
    OddWidth(u16),
    /// It ends behind so many frames, and what ffmpeg said.
    EndsEarly(usize, String),
    /// There is no ffmpeg.
    NoFfmpeg(io::Error),
    /// ffmpeg failed, and what it said.
    Ffmpeg(String),
    /// ffmpeg wrote something else than it was asked for.
    Output(&'static str),
    /// ffmpeg wrote nothing for so long, s.
    Silent(u64),
    /// Somebody wants the program to end.
    Interrupted,
    /// There is no such camera, or none on this system.
    Camera(String),
}

impl fmt::Display for VideoFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read(error) => write!(f, "it cannot be read ({error}); check the path"),
            Self::Header(what) => {
                write!(f, "it is no Y4M video ({what}); it starts with YUV4MPEG2, W and H; make it anew")
            }
            Self::Samples(name) => write!(
                f,
                "its samples are \"{}\"; mono, 411, 420, 422 and 444 of 8 to 16 bits are read: ffmpeg -pix_fmt gray makes mono",
                printable(name)
            ),
            Self::Size([width, height]) => write!(
                f,
                "frames of {width}x{height} px are not read; give 1 to 65535 px a side and at most {} million of them",
                PIXELS / 1_000_000
            ),
            Self::NoMjpeg => f.write_str("it does not begin with a JPEG, so it is no MJPEG video; make it anew"),
            Self::Empty => f.write_str("it holds no whole frame; copy or record it again"),
            Self::TooMany => write!(f, "it has more than {MOST_FRAMES} frames; split it"),
            Self::Frame(index) => write!(f, "frame {index} does not begin with FRAME; copy or record it again"),
            Self::TooLarge(bytes) => {
                write!(f, "a JPEG of {bytes} bytes, more than {} MiB; record smaller ones", RECORD_BYTES >> 20)
            }
            Self::OddWidth(width) => write!(
                f,
                "its width {width} is odd, so it is not two views side by side; give such a video, or one for each camera"
            ),
            Self::EndsEarly(frames, said) if said.is_empty() => write!(f, "it ends behind {frames} frames"),
            Self::EndsEarly(frames, said) => write!(f, "it ends behind {frames} frames ({})", printable(said)),
            Self::NoFfmpeg(error) => write!(
                f,
                "ffmpeg, which is needed for it, cannot be started ({error}); install it (apt install ffmpeg, brew install ffmpeg), \
                 or give Y4M or MJPEG"
            ),
            Self::Ffmpeg(said) if said.is_empty() => f.write_str("ffmpeg cannot read it; look at it with ffprobe"),
            Self::Ffmpeg(said) => write!(f, "ffmpeg cannot read it ({}); look at it with ffprobe", printable(said)),
            Self::Output(what) => {
                write!(f, "ffmpeg does not write what it was asked for ({what}); install another one")
            }
            Self::Silent(seconds) => {
                write!(f, "ffmpeg gave nothing for {seconds} s and was ended; see if it reads it alone")
            }
            Self::Interrupted => f.write_str("interrupted"),
            Self::Camera(what) => f.write_str(&printable(what)),
        }
    }
}

impl core::error::Error for VideoFault {}

impl From<io::Error> for VideoFault {
    fn from(error: io::Error) -> Self {
        Self::Read(error)
    }
}
