//! A recording of ROS 2 or Foxglove (`.mcap`): which of its images are pairs, what their calibration says, and the images themselves.
//!
//! ```text
//! topics    every topic with images or a calibration -> the left and the right one
//! pairing   times of both -> pairs; the rest is counted
//! rig       CameraInfo of both -> focal length, baseline, principal points; of raw images the rig that rectifies them
//! images    a message -> grey values
//! ```
//!
//! A recording is scanned once for the places of its images; their bytes are read when the pair is loaded.
//!
//! # Bounds
//! At most 524 288 images are known, some 300 bytes each, and 4096 topics. See `mcap` for what is read at once.

mod images;
mod pairing;
mod rig;
mod topics;

use super::fault::RecordingFault;
use super::recorded::{RecordedPair, Stored};
use crate::mcap::{Item, Place, Reader};
use crate::ros::kind::{Content, Kind};
use crate::ros::received::CameraInfo;
use core::fmt;
use linestereo_frames::untrusted::printable;
use linestereo_frames::{FrameError, PairFiles, StoredPair, StoredRig};
use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, Mutex};

pub use super::recorded::Recording;
pub use topics::{Choice, DEFAULT_WINDOW_MS};

/// Most images of a recording: two hours and a half of a pair thirty times a second.
const MOST_IMAGES: usize = 1 << 19;
/// Most topics, and bytes of a name.
const MOST_TOPICS: usize = 4096;
const MOST_NAME_BYTES: usize = 1024;

/// A topic with what was found of it.
#[derive(Debug, Default)]
struct Topic {
    name: String,
    images: Vec<Stored>,
    /// The first one.
    info: Option<CameraInfo>,
    info_changes: bool,
    frame_id: String,
    has_images: bool,
    is_compressed: bool,
    has_info: bool,
}

impl fmt::Debug for Recording {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Recording").field("path", &self.path).field("pairs", &self.pairs.len()).finish_non_exhaustive()
    }
}

/// Is this a recording, by its name?
#[must_use]
pub fn is_recording(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("mcap"))
}

/// Pairs of a recording in the order of their times, and the number of images without a partner.
pub(super) fn pairs(path: &Path, choice: &Choice) -> Result<(Vec<StoredPair>, usize, Arc<Recording>), FrameError> {
    let fault = |fault| FrameError::Source(path.to_path_buf(), Box::new(fault));
    let mut reader = Reader::open(path).map_err(|error| fault(error.into()))?;
    let all = scanned(&mut reader).map_err(fault)?;
    let chosen = choice.topics(&all).map_err(fault)?;
    let counts = chosen.map(|topic| topic.images.len());
    let (pairs, alone) = pairing::pairs(chosen.map(|topic| topic.images.clone()), choice.window_ns());
    if pairs.is_empty() {
        return Err(fault(RecordingFault::NoPair(counts, choice.window_ms)));
    }
    let infos = choice.infos(&all, chosen);
    let (rig, told, files) = rig::of(path, chosen.map(|topic| topic.name.as_str()), infos).map_err(fault)?;
    let recording = Arc::new(Recording {
        path: path.to_path_buf(),
        reader: Mutex::new(reader),
        pairs,
        topics: chosen.map(|topic| topic.name.clone()),
        frame_id: chosen[0].frame_id.clone(),
        window_ms: choice.window_ms,
        rig: told,
        _files: files,
    });
    let pairs = (0..recording.pairs.len()).map(|index| {
        let pair = RecordedPair { recording: Arc::clone(&recording), index };
        let stamp = recording.pairs[index][0].stamp_ns;
        let name = format!("{}.{:09}", stamp.div_euclid(1_000_000_000), stamp.rem_euclid(1_000_000_000));
        stored(name, pair, &rig)
    });
    Ok((pairs.collect(), alone, recording))
}

fn stored(name: String, pair: RecordedPair, rig: &StoredRig) -> StoredPair {
    let mut stored = StoredPair::alone(name, PairFiles::Source(Arc::new(pair)));
    stored.rig = rig.clone();
    stored
}

/// Every topic with images or a calibration.
fn scanned(reader: &mut Reader) -> Result<Vec<Topic>, RecordingFault> {
    let (mut schemas, mut channels) = (HashMap::new(), HashMap::new());
    let (mut topics, mut names) = (Vec::<Topic>::new(), HashMap::new());
    let (mut images, mut foreign) = (0, None);
    reader.scan(|item| -> Result<(), RecordingFault> {
        match item {
            Item::Schema { id, name } => {
                _ = schemas.insert(id, name.chars().take(MOST_NAME_BYTES).collect::<String>());
            }
            Item::Channel { id, schema, topic, encoding } => {
                let schema = schemas.get(&schema).map_or("", String::as_str);
                let Some(kind) = Kind::of(schema, encoding) else {
                    if schema.ends_with("Image") && foreign.is_none() {
                        foreign = Some(format!("{schema} in {encoding}"));
                    }
                    channels.remove(&id);
                    return Ok(());
                };
                if topic.len() > MOST_NAME_BYTES {
                    return Err(RecordingFault::TooMany("bytes in the name of a topic"));
                }
                let at = names.get(topic).copied().unwrap_or(topics.len());
                if at == MOST_TOPICS {
                    return Err(RecordingFault::TooMany("topics"));
                }
                if at == topics.len() {
                    let name = topic.to_owned();
                    names.insert(name.clone(), at);
                    let (has_info, is_compressed) =
                        (kind.content == Content::Calibration, kind.content == Content::CompressedImage);
                    topics.push(Topic { name, has_images: !has_info, is_compressed, has_info, ..Topic::default() });
                }
                channels.insert(id, (at, kind));
            }
            Item::Message { channel, log_time, place, data } => {
                let Some(&(at, kind)) = channels.get(&channel) else { return Ok(()) };
                let topic = &mut topics[at];
                if kind.content == Content::Calibration {
                    topic.calibrated(data, kind)?;
                    return Ok(());
                }
                images += 1;
                if images > MOST_IMAGES {
                    return Err(RecordingFault::TooMany("images"));
                }
                topic.take(data, log_time, place, kind)?;
            }
        }
        Ok(())
    })?;
    if !topics.iter().any(|topic| topic.has_images) {
        let found = foreign.map_or("no images".to_owned(), |foreign| format!("images as {foreign}"));
        return Err(RecordingFault::Topics(format!(
            "it holds {found}; sensor_msgs/msg/Image and CompressedImage in CDR are read, as ROS 2 records them, and foxglove.RawImage and CompressedImage in protobuf"
        )));
    }
    Ok(topics)
}

impl Topic {
    fn broken(&self) -> RecordingFault {
        RecordingFault::Image(
            self.name.clone(),
            "the message ends early, or is none of its kind; record it again".to_owned(),
        )
    }

    fn take(&mut self, data: &[u8], log_time: u64, place: Place, kind: Kind) -> Result<(), RecordingFault> {
        let header = kind.header(data).ok_or_else(|| self.broken())?;
        if self.images.is_empty() {
            self.frame_id = header.frame_id.chars().take(MOST_NAME_BYTES).collect();
        }
        // Nobody set it: the time of the recorder.
        let unset = header.stamp_ns == 0;
        let stamp_ns = if unset { i64::try_from(log_time).unwrap_or(i64::MAX) } else { header.stamp_ns };
        self.images.push(Stored { place, stamp_ns, kind });
        Ok(())
    }

    fn calibrated(&mut self, data: &[u8], kind: Kind) -> Result<(), RecordingFault> {
        let info = kind.calibration(data).ok_or_else(|| self.broken())?;
        match &self.info {
            None => self.info = Some(info),
            Some(first) => self.info_changes |= *first != info,
        }
        Ok(())
    }
}

impl Recording {
    /// Topics, window and rig, in words.
    #[must_use]
    pub fn summary(&self) -> String {
        let [left, right] = &self.topics;
        let text = format!("{left} and {right}, paired within {} ms; {}", self.window_ms, self.rig);
        printable(&text).into_owned()
    }

    /// Name of the left camera's frame.
    #[must_use]
    pub fn frame_id(&self) -> &str {
        &self.frame_id
    }
}
