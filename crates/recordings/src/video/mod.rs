//! Videos: frames by their numbers, as grey values, and the pairs that they make.
//!
//! ```text
//! pairs    one video with both views side by side, or two
//! y4m      raw frames with a header, the luma plane of each; of a file by their places, of a pipe
//!          one after the other
//! ffmpeg   all others, and cameras: the system's program decodes to Y4M, which is read from a pipe
//! ```
//!
//! No codec is linked. A Y4M file is scanned once for the places of its frames; one of ffmpeg's is
//! counted once without being decoded.
//!
//! # Bounds
//! At most 524 288 frames are known, 8 bytes each. A line of a header has at most 1 KiB, a frame
//! 33 554 432 px. Three frames of a pipe are held at most.

mod ffmpeg;
mod pairs;
mod y4m;

use linestereo_frames::untrusted::{PIXELS, printable};
use std::io;
use std::path::Path;

pub use ffmpeg::{Camera, Stop};
pub use pairs::Video;
pub(crate) use pairs::{camera, pair, pairs};

/// Most frames of a video: four hours and a half, thirty times a second.
const MOST_FRAMES: usize = 1 << 19;
/// Endings of the names of videos: the one that is read here, and those that ffmpeg reads.
const OWN: &str = "y4m";
const FFMPEG: [&str; 8] = ["mp4", "m4v", "mkv", "avi", "mov", "webm", "mjpeg", "mjpg"];

/// Grey values, row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Luma {
    /// Width and height, px.
    sides: [u32; 2],
    /// Bits of a value: of more than 8 it takes two bytes, the lower one first.
    bits: u32,
    bytes: Vec<u8>,
}

/// A video, or a camera.
trait Source: Send {
    /// Number of frames; of a camera none is known.
    fn frames(&self) -> Option<usize>;

    /// Time of a frame behind the first one, ns; of a camera that of the clock when the frame
    /// arrived, of the last one alone.
    fn time_ns(&self, index: usize) -> Option<u64>;

    /// The frame of this number. What ffmpeg decodes is decoded anew for one before the last.
    fn frame(&mut self, index: usize) -> Result<Luma, VideoFault>;

    /// No frame comes any more: the number of those that did.
    fn ended(&self) -> Option<usize> {
        None
    }

    /// A warning for the summary; `None` where every frame was read without one.
    fn note(&self) -> Option<String>;
}

/// Is this a video, by its name?
pub fn is_video(path: &Path) -> bool {
    ending(path).is_some_and(|ending| ending == OWN || FFMPEG.contains(&&*ending))
}

fn ending(path: &Path) -> Option<String> {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase())
}

/// Finds the frames of a file.
fn open(path: &Path, stop: Stop) -> Result<Box<dyn Source>, VideoFault> {
    if ending(path).is_some_and(|ending| ending == OWN) {
        Ok(Box::new(y4m::Stored::open(path)?))
    } else {
        Ok(Box::new(ffmpeg::Decoder::open(path, stop)?))
    }
}

/// Why a video, or a frame of it, cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VideoFault {
    /// The file system says so.
    #[error("it cannot be read ({0}); check the path")]
    Read(#[from] io::Error),
    /// The first line is none of Y4M.
    #[error("it is no Y4M video ({0}); it starts with YUV4MPEG2, W and H; make it anew")]
    Header(&'static str),
    /// Samples of a kind that is not read.
    #[error(
        "its samples are \"{}\"; mono, 411, 420, 422 and 444 of 8 to 16 bits are read: ffmpeg \
         -pix_fmt gray makes mono",
        printable(.0)
    )]
    Samples(String),
    /// Frames of this size are not read.
    #[error(
        "frames of {}x{} px are not read; give 1 to 65535 px a side and at most {} million of them",
        .0[0], .0[1], PIXELS / 1_000_000
    )]
    Size([u64; 2]),
    /// It holds no whole frame.
    #[error("it holds no whole frame; copy or record it again")]
    Empty,
    /// More frames than are counted.
    #[error("it has more than {MOST_FRAMES} frames; split it")]
    TooMany,
    /// A frame does not begin as it has to.
    #[error("frame {0} does not begin with FRAME; copy or record it again")]
    Frame(usize),
    /// Both views in an image of this odd width.
    #[error(
        "its width {0} is odd, so it is not two views side by side; give such a video, or one for \
         each camera"
    )]
    OddWidth(u16),
    /// It ends behind so many frames, and what ffmpeg said.
    #[error("it ends behind {0} frames{said}", said = in_brackets(.1))]
    EndsEarly(usize, String),
    /// There is no ffmpeg.
    #[error(
        "ffmpeg, which is needed for it, cannot be started ({0}); install it (apt install ffmpeg, \
         brew install ffmpeg), or give Y4M"
    )]
    NoFfmpeg(io::Error),
    /// ffmpeg failed, and what it said.
    #[error("ffmpeg cannot read it{}; look at it with ffprobe", in_brackets(.0))]
    Ffmpeg(String),
    /// ffmpeg wrote something else than it was asked for.
    #[error("the output of ffmpeg is not as requested ({0}); install another version")]
    Output(&'static str),
    /// ffmpeg wrote nothing for so long, s.
    #[error("ffmpeg wrote nothing for {0} s and was stopped; check that ffmpeg alone can read it")]
    Silent(u64),
    /// Somebody wants the program to end.
    #[error("interrupted")]
    Interrupted,
    /// There is no such camera, or none on this system.
    #[error("{}", printable(.0))]
    Camera(String),
}

/// Message of ffmpeg, if there is one.
fn in_brackets(said: &str) -> String {
    if said.is_empty() { String::new() } else { format!(" ({})", printable(said)) }
}
