//! A recording that was scanned, and a pair of it: places of messages, read when the pair is loaded.

use super::fault::RecordingFault;
use crate::mcap::{Place, Reader};
use crate::ros::kind::Kind;
use linestereo_frames::grey::StoredGray;
use linestereo_frames::{FrameError, Layout, PairSource, Views};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use tempfile::TempDir;

/// An image of a topic.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stored {
    pub(super) place: Place,
    pub(super) stamp_ns: i64,
    pub(super) kind: Kind,
}

/// A recording that was scanned.
pub struct Recording {
    pub(super) path: PathBuf,
    pub(super) reader: Mutex<Reader>,
    pub(super) pairs: Vec<[Stored; 2]>,
    pub(super) topics: [String; 2],
    pub(super) frame_id: String,
    pub(super) window_ms: f64,
    pub(super) rig: String,
    /// Files with the rig of raw images, for as long as somebody may read them.
    pub(super) _files: Option<TempDir>,
}

/// A pair of a recording.
#[derive(Clone, Debug)]
pub(super) struct RecordedPair {
    pub(super) recording: Arc<Recording>,
    pub(super) index: usize,
}

impl PairSource for RecordedPair {
    fn layout(&self) -> Layout {
        Layout::Recording
    }

    fn paths(&self) -> [&Path; 2] {
        [&self.recording.path; 2]
    }

    fn times_us(&self) -> Option<[u64; 2]> {
        self.stamps_ns().map(|stamps| stamps.map(|stamp| stamp / 1000))
    }

    fn time_ns(&self) -> Option<u64> {
        self.stamps_ns().map(|[left, _]| left)
    }

    fn grey(&self) -> Result<Views<StoredGray>, FrameError> {
        self.stored_grey().map(Views::Two)
    }
}

impl RecordedPair {
    /// When the images were captured, ns; `None` before 1970.
    fn stamps_ns(&self) -> Option<[u64; 2]> {
        let [left, right] = self.recording.pairs[self.index].map(|image| u64::try_from(image.stamp_ns).ok());
        Some([left?, right?])
    }

    /// The messages of both images, the left one first, as `read` makes values of them.
    pub(super) fn images<T>(&self, read: impl Fn(&[u8], Kind) -> Result<T, String>) -> Result<[T; 2], FrameError> {
        let recording = &self.recording;
        let one = |eye: usize| {
            let fault = |fault| FrameError::Source(recording.path.clone(), Box::new(fault));
            let stored = recording.pairs[self.index][eye];
            let mut reader = recording.reader.lock().unwrap_or_else(PoisonError::into_inner);
            let message = reader.message(stored.place).map_err(|error| fault(error.into()))?;
            drop(reader);
            let topic = &recording.topics[eye];
            read(&message, stored.kind).map_err(|what| fault(RecordingFault::Image(topic.clone(), what)))
        };
        Ok([one(0)?, one(1)?])
    }
}
