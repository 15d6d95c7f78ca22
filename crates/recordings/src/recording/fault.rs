//! Why no pair is taken of a recording.

use crate::mcap::McapFault;
use core::fmt;
use linestereo_frames::untrusted::printable;

/// Why no pair, or not this one, is taken of a recording.
#[derive(Debug)]
#[non_exhaustive]
pub enum RecordingFault {
    /// The file is damaged, or another one.
    File(McapFault),
    /// More than is counted.
    TooMany(&'static str),
    /// No topic has images of the left, or of the right camera, or more than one has.
    Topics(String),
    /// No two images are of one time; images, and window in ms.
    NoPair([usize; 2], f64),
    /// The calibration makes no rig.
    Calibration(String),
    /// An image that is not taken: its topic, and why.
    Image(String, String),
}

impl fmt::Display for RecordingFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(fault) => fault.fmt(f),
            Self::TooMany(what) => write!(f, "it has more {what} than are read; split it with `mcap filter`"),
            Self::Topics(what) => f.write_str(&printable(what)),
            Self::NoPair([left, right], window) => write!(
                f,
                "none of {left} left and {right} right images are within {window} ms; give --pair-window-ms, or other topics"
            ),
            Self::Calibration(what) => write!(
                f,
                "its CameraInfo makes no rig ({}); give --scene or --rig, or --focal-px and --baseline-m for rectified images",
                printable(what)
            ),
            Self::Image(topic, what) => write!(f, "an image of {}: {}", printable(topic), printable(what)),
        }
    }
}

impl core::error::Error for RecordingFault {}

impl From<McapFault> for RecordingFault {
    fn from(fault: McapFault) -> Self {
        Self::File(fault)
    }
}
