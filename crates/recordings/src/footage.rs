//! The pairs of a folder, a recording, a video or a camera.

use crate::recording::{self, Choice, Recording, is_recording};
use crate::video::{self, Camera, Stop, Video, is_video};
use linestereo_frames::{Dataset, FrameError, StoredPair};
use std::path::Path;
use std::sync::Arc;

/// Pairs in their order, and where they are from.
#[derive(Clone, Debug, Default)]
pub struct Footage {
    /// By the time or the number of each; of a camera none, see [`Footage::filmed`].
    pub pairs: Vec<StoredPair>,
    /// Images without a partner.
    pub alone: usize,
    recording: Option<Arc<Recording>>,
    video: Option<Arc<Video>>,
}

impl Footage {
    /// Footage at this path: a recording, a video with both views, or a folder, whose images hold
    /// both views where that is said.
    pub fn open(root: &Path, side_by_side: bool, stop: Stop) -> Result<Self, FrameError> {
        if is_recording(root) {
            return Self::recorded(root, &Choice::default());
        }
        if is_video(root) && !root.is_dir() {
            return Self::video(&[root], stop);
        }
        let Dataset { pairs, alone, .. } = Dataset::sequence(root, side_by_side)?;
        Ok(Self { pairs, alone, ..Self::default() })
    }

    /// A pair that stands alone.
    pub fn of_pair(pair: StoredPair) -> Self {
        Self { pairs: vec![pair], ..Self::default() }
    }

    /// Pairs of a recording, in the order of their times.
    pub fn recorded(path: &Path, choice: &Choice) -> Result<Self, FrameError> {
        let (pairs, alone, recording) = recording::pairs(path, choice)?;
        Ok(Self { pairs, alone, recording: Some(recording), video: None })
    }

    /// Pairs of a video with both views side by side, or of a left and a right one, by the numbers
    /// of their frames.
    pub fn video(paths: &[&Path], stop: Stop) -> Result<Self, FrameError> {
        let (pairs, alone, video) = video::pairs(paths, stop)?;
        Ok(Self { pairs, alone, recording: None, video: Some(video) })
    }

    /// A camera: there are as many pairs as are asked for, [`Footage::filmed`]. `stop`
    /// is asked while a frame is waited for.
    pub fn camera(camera: &Camera, stop: Stop) -> Result<Self, FrameError> {
        Ok(Self { video: Some(video::camera(camera, stop)?), ..Self::default() })
    }

    /// The video or camera that the pairs are from, if they are from one.
    pub fn of_video(&self) -> Option<&Video> {
        self.video.as_deref()
    }

    /// The pair of this number of a camera; nothing of others.
    pub fn filmed(&self, index: usize) -> Option<StoredPair> {
        self.video.as_ref().filter(|video| video.is_live()).map(|video| video::pair(video, index))
    }

    /// The recording that the pairs are from, if they are from one.
    pub fn of_recording(&self) -> Option<&Recording> {
        self.recording.as_deref()
    }
}
