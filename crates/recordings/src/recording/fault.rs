//! Why no pair is taken of a recording.

use crate::mcap::McapFault;
use linestereo_frames::untrusted::printable;

/// Why no pair, or not this one, is taken of a recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingFault {
    /// The file is damaged, or another one.
    #[error(transparent)]
    File(#[from] McapFault),
    /// A folder, or a file that is packed, which is not read as it is.
    #[error("{}", printable(.0))]
    Folder(String),
    /// More than is counted.
    #[error("it has more {0} than are read; split it with `mcap filter`")]
    TooMany(&'static str),
    /// No topic has images of the left, or of the right camera, or more than one has.
    #[error("{}", printable(.0))]
    Topics(String),
    /// No two images are of one time; images, and window in ms.
    #[error(
        "none of {left} left and {right} right images are within {1} ms; give --pair-window-ms, or \
         other topics",
        left = .0[0], right = .0[1]
    )]
    NoPair([usize; 2], f64),
    /// The calibration makes no rig.
    #[error(
        "its CameraInfo makes no rig ({}); give --scene or --rig, or --focal-px and --baseline-m \
         for rectified images",
        printable(.0)
    )]
    Calibration(String),
    /// An image that is not taken: its topic, and why.
    #[error("an image of {}: {}", printable(.0), printable(.1))]
    Image(String, String),
}
