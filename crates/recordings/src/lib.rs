//! Stereo pairs in recordings of ROS 2 and Foxglove, in videos and from cameras.
//!
//! ```text
//! mcap        the container of recordings, read by the places of its messages and written
//! ros         messages of ROS 2 and of Foxglove
//! recording   which topics are the left and the right camera, and which of their images are pairs
//! video       frames of videos and cameras, of both views or two of one each
//! footage     the pairs of whatever lies at a path
//! ```
//!
//! A pair is a [`StoredPair`](linestereo_frames::StoredPair) whose images are read when it is
//! loaded.

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests read what they wrote"))]

mod footage;
pub mod mcap;
mod recording;
pub mod ros;
mod video;

pub use footage::Footage;
pub use recording::{
    Choice, DEFAULT_WINDOW_MS, Detection, Detections, Recording, RecordingFault, is_mcap,
    is_recording,
};
pub use video::{Camera, Stop, Video, VideoFault, is_video};

/// The example of the package's page.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
