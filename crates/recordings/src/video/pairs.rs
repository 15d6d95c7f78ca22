//! A video with both views side by side, left | right, or two that are paired by the numbers of
//! their frames, up to the end of the shorter one; or a camera.

use super::ffmpeg::Decoder;
use super::{Camera, Luma, Source, Stop, VideoFault, open};
use core::fmt;
use linestereo_frames::grey::{StoredGray, Values};
use linestereo_frames::untrusted::printable;
use linestereo_frames::{FrameError, Layout, PairFiles, PairSource, PixelBytes, StoredPair, Views};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// A video, two, or a camera.
pub struct Video {
    paths: Vec<PathBuf>,
    sources: Mutex<Vec<Box<dyn Source>>>,
    /// Number of pairs; of a camera there is none.
    pairs: Option<usize>,
}

/// A pair of a video: frames by their numbers, read when it is loaded.
#[derive(Clone, Debug)]
struct VideoPair {
    video: Arc<Video>,
    index: usize,
}

/// Pairs of a video, or of a left and a right one; the number of frames that are in none.
pub(crate) fn pairs(
    paths: &[&Path],
    stop: Stop,
) -> Result<(Vec<StoredPair>, usize, Arc<Video>), FrameError> {
    let opened = paths.iter().map(|path| open(path, stop).map_err(|fault| fault_of(path, fault)));
    let sources = opened.collect::<Result<Vec<_>, _>>()?;
    let counts: Vec<usize> = sources.iter().filter_map(|source| source.frames()).collect();
    let count = counts.iter().copied().min().unwrap_or(0);
    let alone = counts.iter().map(|frames| frames - count).sum();
    let video =
        opened_as(paths.iter().map(|path| path.to_path_buf()).collect(), sources, Some(count))?;
    Ok(((0..count).map(|index| pair(&video, index)).collect(), alone, video))
}

/// A camera with both views side by side.
pub(crate) fn camera(camera: &Camera, stop: Stop) -> Result<Arc<Video>, FrameError> {
    let source = Decoder::camera(camera, stop).map_err(|fault| fault_of(&camera.device, fault))?;
    opened_as(vec![camera.device.clone()], vec![Box::new(source)], None)
}

fn fault_of(path: &Path, fault: VideoFault) -> FrameError {
    FrameError::Source(path.to_path_buf(), Box::new(fault))
}

/// The same, unless the first frame has no middle; one that is broken ends its own pair.
fn opened_as(
    paths: Vec<PathBuf>,
    sources: Vec<Box<dyn Source>>,
    pairs: Option<usize>,
) -> Result<Arc<Video>, FrameError> {
    let video = Arc::new(Video { paths, sources: Mutex::new(sources), pairs });
    let first = VideoPair { video: Arc::clone(&video), index: 0 };
    match first.grey() {
        Err(error @ FrameError::Source(..)) => Err(error),
        _ => Ok(video),
    }
}

/// A pair by its number, named by its time in s where that is known.
pub(crate) fn pair(video: &Arc<Video>, index: usize) -> StoredPair {
    let pair = VideoPair { video: Arc::clone(video), index };
    let time = pair.time_ns().filter(|_| !video.is_live());
    let name = time.map_or_else(|| index.to_string(), |ns| format!("{:.3}", ns as f64 / 1e9));
    StoredPair::alone(name, PairFiles::Source(Arc::new(pair)))
}

impl fmt::Debug for Video {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Video")
            .field("paths", &self.paths)
            .field("pairs", &self.pairs)
            .finish_non_exhaustive()
    }
}

impl Video {
    fn with<T>(&self, work: impl FnOnce(&mut [Box<dyn Source>]) -> T) -> T {
        work(&mut self.sources.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// A camera: there is a next pair until somebody wants an end.
    pub fn is_live(&self) -> bool {
        self.pairs.is_none()
    }

    /// It ended before its last pair, or will give none any more: the number of pairs that there
    /// were.
    pub fn ended(&self) -> Option<usize> {
        let ended = self.with(|sources| sources.iter().filter_map(|source| source.ended()).min());
        ended.filter(|&frames| self.pairs.is_none_or(|pairs| frames < pairs))
    }

    /// Warnings for the summary, on one line; `None` where every frame was read without one.
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

impl PairSource for VideoPair {
    fn layout(&self) -> Layout {
        Layout::Video
    }

    fn paths(&self) -> [&Path; 2] {
        let paths = &self.video.paths;
        [&paths[0], &paths[paths.len() - 1]]
    }

    /// Nobody says whether two videos began at once.
    fn times_us(&self) -> Option<[u64; 2]> {
        None
    }

    /// Behind the first pair; of a camera by the clock, of the pair that was loaded last.
    fn time_ns(&self) -> Option<u64> {
        self.video.with(|sources| sources[0].time_ns(self.index))
    }

    fn grey(&self) -> Result<Views<StoredGray>, FrameError> {
        if self.video.paths.len() > 1 {
            return Ok(Views::Two([self.frame(0)?, self.frame(1)?]));
        }
        let both = self.frame(0)?;
        if both.dims.width % 2 == 1 {
            return Err(fault_of(&self.video.paths[0], VideoFault::OddWidth(both.dims.width)));
        }
        Ok(Views::Both(both))
    }
}

impl VideoPair {
    fn frame(&self, eye: usize) -> Result<StoredGray, FrameError> {
        let path = &self.video.paths[eye];
        let luma = self
            .video
            .with(|sources| sources[eye].frame(self.index))
            .map_err(|fault| fault_of(path, fault))?;
        grey(&luma).map_err(|what| FrameError::VideoFrame(path.clone(), self.index, what))
    }
}

fn grey(luma: &Luma) -> Result<StoredGray, String> {
    let layout =
        if luma.bits > 8 { PixelBytes::Grey16(u16::from_le_bytes) } else { PixelBytes::Grey };
    let rows = luma.bytes.chunks_exact(luma.sides[0] as usize * layout.bytes());
    let stored = StoredGray::of_rows(luma.sides, layout, rows)?;
    // 16 bits may hold the values of a sensor with fewer, as in image files; others say how many
    // there are.
    if !(9..16).contains(&luma.bits) {
        return Ok(stored);
    }
    let image = stored.into_8_bit(luma.bits);
    Ok(StoredGray { dims: image.dims, values: Values::Eight(image.pixels) })
}
