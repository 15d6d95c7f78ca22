//! Videos and cameras: their pairs, and frames as grey values.
//!
//! One video has both views side by side, left | right; two are paired by the numbers of their frames, up to the end of the shorter one.

use crate::mcap::RECORD_BYTES;
use crate::video::{Camera, Frame, Luma, Source, VideoFault};
use linestereo_frames::grey::{StoredGray, Values};
use linestereo_frames::{FrameError, Layout, PairFiles, PairSource, PixelBytes, StoredPair, Views};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

pub use super::filmed::{Video, VideoPair};
pub use crate::video::is_video;

/// Pairs of a video, or of a left and a right one; the number of frames that are in none.
pub(super) fn pairs(paths: &[&Path]) -> Result<(Vec<StoredPair>, usize, Arc<Video>), FrameError> {
    let opened = paths.iter().map(|path| Source::open(path).map_err(|fault| fault_of(path, fault)));
    let sources: Vec<Source> = opened.collect::<Result<_, _>>()?;
    let counts: Vec<usize> = sources.iter().filter_map(Source::frames).collect();
    let count = counts.iter().copied().min().unwrap_or(0);
    let alone = counts.iter().map(|frames| frames - count).sum();
    let video = opened_as(paths.iter().map(|path| path.to_path_buf()).collect(), sources, Some(count))?;
    Ok(((0..count).map(|index| pair(&video, index)).collect(), alone, video))
}

/// A camera with both views side by side.
pub(super) fn camera(camera: &Camera) -> Result<Arc<Video>, FrameError> {
    let source = Source::camera(camera).map_err(|fault| fault_of(&camera.device, fault))?;
    opened_as(vec![camera.device.clone()], vec![source], None)
}

fn fault_of(path: &Path, fault: VideoFault) -> FrameError {
    FrameError::Source(path.to_path_buf(), Box::new(fault))
}

/// The same, unless the first frame has no middle; one that is broken ends its own pair.
fn opened_as(paths: Vec<PathBuf>, sources: Vec<Source>, pairs: Option<usize>) -> Result<Arc<Video>, FrameError> {
    let video = Arc::new(Video { paths, sources: Mutex::new(sources), pairs });
    let first = VideoPair { video: Arc::clone(&video), index: 0 };
    match first.grey() {
        Err(error @ FrameError::Source(..)) => Err(error),
        _ => Ok(video),
    }
}

/// A pair by its number, named by its time in s where that is known.
pub(super) fn pair(video: &Arc<Video>, index: usize) -> StoredPair {
    let pair = VideoPair { video: Arc::clone(video), index };
    let time = pair.captured_ns().filter(|_| !video.is_live());
    let name = time.map_or_else(|| index.to_string(), |ns| format!("{:.3}", ns as f64 / 1e9));
    StoredPair::alone(name, PairFiles::Source(Arc::new(pair)))
}

impl PairSource for VideoPair {
    fn layout(&self) -> Layout {
        Layout::Video
    }

    fn paths(&self) -> [&Path; 2] {
        self.files()
    }

    /// Nobody says whether two videos began at once.
    fn times_us(&self) -> Option<[u64; 2]> {
        None
    }

    fn time_ns(&self) -> Option<u64> {
        self.captured_ns()
    }

    fn grey(&self) -> Result<Views<StoredGray>, FrameError> {
        let views = self.images(|frame| match frame {
            Frame::Luma(luma) => of_luma(&luma),
            Frame::Jpeg(bytes) => StoredGray::of_file(&bytes, RECORD_BYTES),
        })?;
        match &views {
            Views::Both(both) if both.dims.width % 2 == 1 => Err(self.odd(both.dims.width)),
            _ => Ok(views),
        }
    }
}

fn of_luma(luma: &Luma) -> Result<StoredGray, String> {
    let layout = if luma.bits > 8 { PixelBytes::Grey16(u16::from_le_bytes) } else { PixelBytes::Grey };
    let rows = luma.bytes.chunks_exact(luma.sides[0] as usize * layout.bytes());
    let stored = StoredGray::of_rows(luma.sides, layout, rows)?;
    // 16 bits may hold the values of a sensor with fewer, as in image files; others say how many there are.
    if !(9..16).contains(&luma.bits) {
        return Ok(stored);
    }
    let image = stored.into_8_bit(luma.bits);
    Ok(StoredGray { dims: image.dims, values: Values::Eight(image.pixels) })
}
