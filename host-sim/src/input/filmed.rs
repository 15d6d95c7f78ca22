//! A video that was opened, or two, and a pair of it: frames by their numbers, read when the pair is loaded.

use crate::video::{Frame, Source, VideoFault};
use core::fmt;
use linestereo_frames::untrusted::printable;
use linestereo_frames::{FrameError, Views};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// A video with both views side by side, or a left and a right one; or a camera.
pub struct Video {
    pub(super) paths: Vec<PathBuf>,
    pub(super) sources: Mutex<Vec<Source>>,
    /// Number of pairs; of a camera there is none.
    pub(super) pairs: Option<usize>,
}

/// A pair of a video.
#[derive(Clone, Debug)]
pub struct VideoPair {
    pub(super) video: Arc<Video>,
    pub(super) index: usize,
}

impl fmt::Debug for Video {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Video").field("paths", &self.paths).field("pairs", &self.pairs).finish_non_exhaustive()
    }
}

impl Video {
    fn with<T>(&self, work: impl FnOnce(&mut [Source]) -> T) -> T {
        work(&mut self.sources.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// A camera: there is a next pair until somebody wants an end.
    #[must_use]
    pub fn is_live(&self) -> bool {
        self.pairs.is_none()
    }

    /// It ended before its last pair, or will give none any more: the number of pairs that there were.
    #[must_use]
    pub fn ended(&self) -> Option<usize> {
        let ended = self.with(|sources| sources.iter().filter_map(|source| source.ended()).min());
        ended.filter(|&frames| self.pairs.is_none_or(|pairs| frames < pairs))
    }

    /// Warnings for the summary, on one line; `None` where every frame was read without one.
    #[must_use]
    pub fn summary(&self) -> Option<String> {
        let mut notes = Vec::new();
        if let Some(frames) = self.ended() {
            let of = self.pairs.map_or(String::new(), |pairs| format!(" of {pairs}"));
            notes.push(format!("it ended behind {frames}{of} frames"));
        }
        self.with(|sources| {
            for (path, source) in self.paths.iter().zip(sources) {
                notes.extend(source.note().map(|note| format!("{}: {note}", path.display())));
            }
        });
        (!notes.is_empty()).then(|| printable(&notes.join("; ")).into_owned())
    }
}

impl VideoPair {
    /// The files, left first: of both views in one that one twice.
    pub(super) fn files(&self) -> [&Path; 2] {
        let paths = &self.video.paths;
        [&paths[0], &paths[paths.len() - 1]]
    }

    /// When it was captured: ns behind the first one; of a camera those of the clock, of the pair that was loaded last.
    pub(super) fn captured_ns(&self) -> Option<u64> {
        self.video.with(|sources| sources[0].time_ns(self.index))
    }

    /// The frames, as `read` makes values of them.
    pub(super) fn images<T>(&self, read: impl Fn(Frame) -> Result<T, String>) -> Result<Views<T>, FrameError> {
        let one = |eye: usize| {
            let path = || self.video.paths[eye].clone();
            let frame = self.video.with(|sources| sources[eye].frame(self.index));
            let frame = frame.map_err(|fault| FrameError::Source(path(), Box::new(fault)))?;
            read(frame).map_err(|what| FrameError::VideoFrame(path(), self.index, what))
        };
        Ok(if self.video.paths.len() == 1 { Views::Both(one(0)?) } else { Views::Two([one(0)?, one(1)?]) })
    }

    /// An error of both views in an image that has no middle.
    pub(super) fn odd(&self, width: u16) -> FrameError {
        FrameError::Source(self.video.paths[0].clone(), Box::new(VideoFault::OddWidth(width)))
    }
}
