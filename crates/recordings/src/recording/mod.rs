//! A recording of ROS 2 or Foxglove (`.mcap`, or a folder of them): which of its images are pairs,
//! what their calibration says, and the images themselves.
//!
//! ```text
//! files     the MCAP files of a recording, in their order
//! topics    every topic with images or a calibration -> the left and the right one
//! pairing   times of both -> pairs; the rest is counted
//! rig       CameraInfo of both -> focal length, baseline, principal points; of raw images the rig
//!           that rectifies them
//! images    a message -> grey values
//! detections   what a detector found, by time
//! ```
//!
//! A recording is scanned once for the places of its images; their bytes are read when the pair is
//! loaded.
//!
//! # Bounds
//! At most 524 288 images are known, some 300 bytes each, and 4096 topics. See `mcap` for what is
//! read at once.

mod detections;
mod fault;
mod files;
mod images;
mod pairing;
mod rig;
mod topics;

use crate::mcap::{Place, Reader, Record};
use crate::ros::kind::{Content, Kind};
use crate::ros::messages::CameraInfo;
use core::fmt;
use linestereo_frames::grey::StoredGray;
use linestereo_frames::rectified::Dims;
use linestereo_frames::untrusted::printable;
use linestereo_frames::{FrameError, Layout, PairFiles, PairSource, StoredPair, StoredRig, Views};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub use detections::{Detection, Detections};
pub use fault::RecordingFault;
use files::Files;
pub use files::{is_mcap, is_recording};
pub use topics::{Choice, DEFAULT_WINDOW_MS};

/// Most images of a recording: two hours and a half of a pair thirty times a second.
const MOST_IMAGES: usize = 1 << 19;
/// Most topics, and bytes of a name.
const MOST_TOPICS: usize = 4096;
const MOST_NAME_BYTES: usize = 1024;

/// Images that are tried for their size, by which the calibration is checked.
const MOST_UNREAD: usize = 16;

/// An image of a topic.
#[derive(Clone, Copy, Debug)]
struct Stored {
    /// Number of the file.
    file: u16,
    place: Place,
    stamp_ns: i64,
    kind: Kind,
}

/// A topic with what was found of it.
#[derive(Debug)]
struct Topic {
    name: String,
    content: Content,
    /// A message of it cannot be read, which matters where the topic is used.
    is_broken: bool,
    images: Vec<Stored>,
    /// The first one that says anything.
    info: Option<CameraInfo>,
    info_changes: bool,
    frame_id: String,
}

/// The calibration of a camera.
#[derive(Clone, Copy, Debug)]
struct Calibration<'a> {
    topic: &'a str,
    info: &'a CameraInfo,
    /// Later messages differ from it.
    changes: bool,
}

/// A recording that was scanned.
pub struct Recording {
    path: PathBuf,
    files: Files,
    pairs: Vec<[Stored; 2]>,
    topics: [String; 2],
    frame_id: String,
    window_ms: f64,
    rig: String,
}

/// A pair of a recording: places of messages, read when it is loaded.
#[derive(Clone, Debug)]
struct RecordedPair {
    recording: Arc<Recording>,
    index: usize,
}

impl fmt::Debug for Recording {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Recording")
            .field("path", &self.path)
            .field("pairs", &self.pairs.len())
            .finish_non_exhaustive()
    }
}

/// Pairs of a recording in the order of their times, and the number of images without a partner.
pub(crate) fn pairs(
    path: &Path,
    choice: &Choice,
) -> Result<(Vec<StoredPair>, usize, Arc<Recording>), FrameError> {
    let fault = |fault| FrameError::Source(path.to_path_buf(), Box::new(fault));
    let mut scan = Scan::default();
    let files = Files::open(path, |reader, file| scan.file(reader, file))?;
    let all = scan.topics().map_err(fault)?;
    let chosen = choice.topics(&all).map_err(fault)?;
    let infos = choice.infos(&all, chosen);
    for topic in chosen.into_iter().chain(infos.into_iter().flatten()) {
        topic.check().map_err(fault)?;
    }
    let counts = chosen.map(|topic| topic.images.len());
    let (pairs, alone) =
        pairing::pairs(chosen.map(|topic| topic.images.clone()), choice.window_ns());
    if pairs.is_empty() {
        return Err(fault(RecordingFault::NoPair(counts, choice.window_ms)));
    }
    let infos = infos.map(|topic| topic?.calibration());
    let (rig, told) = match pairs.iter().take(MOST_UNREAD).find_map(|[left, _]| size(&files, left))
    {
        Some(images) => {
            rig::of(path, chosen.map(|topic| topic.name.as_str()), infos, images).map_err(fault)?
        }
        None => {
            (StoredRig::Unknown, "no rig in the recording: its images cannot be read".to_owned())
        }
    };
    let recording = Arc::new(Recording {
        path: path.to_path_buf(),
        files,
        pairs,
        topics: chosen.map(|topic| topic.name.clone()),
        frame_id: chosen[0].frame_id.clone(),
        window_ms: choice.window_ms,
        rig: told,
    });
    let pairs = (0..recording.pairs.len()).map(|index| {
        let stamp = recording.pairs[index][0].stamp_ns;
        let name =
            format!("{}.{:09}", stamp.div_euclid(1_000_000_000), stamp.rem_euclid(1_000_000_000));
        let pair = RecordedPair { recording: Arc::clone(&recording), index };
        let mut stored = StoredPair::alone(name, PairFiles::Source(Arc::new(pair)));
        stored.rig = rig.clone();
        stored
    });
    Ok((pairs.collect(), alone, recording))
}

/// Size of a stored image; `None` where it cannot be read.
fn size(files: &Files, image: &Stored) -> Option<Dims> {
    let message = files.message(image.file, image.place).ok()?;
    images::grey(&message, image.kind).ok().map(|image| image.dims)
}

/// Every topic with images or a calibration, of all files.
#[derive(Default)]
struct Scan {
    topics: Vec<Topic>,
    names: HashMap<String, usize>,
    images: usize,
    /// Images of a kind that is not read.
    foreign: Option<String>,
}

impl Scan {
    fn file(&mut self, reader: &mut Reader, file: u16) -> Result<(), RecordingFault> {
        let Self { topics, names, images, foreign } = self;
        let (mut schemas, mut channels) = (HashMap::new(), HashMap::new());
        reader.scan(|record, place| -> Result<(), RecordingFault> {
            match record {
                Record::Schema { header, .. } => {
                    _ = schemas.insert(
                        header.id,
                        header.name.chars().take(MOST_NAME_BYTES).collect::<String>(),
                    );
                }
                Record::Channel(channel) => {
                    let (schema, encoding) = (
                        schemas.get(&channel.schema_id).map_or("", String::as_str),
                        channel.message_encoding,
                    );
                    let name = channel.topic;
                    let kind = Kind::of(schema, &encoding);
                    let Some(kind) = kind.filter(|_| name.len() <= MOST_NAME_BYTES) else {
                        if schema.ends_with("Image") && foreign.is_none() {
                            *foreign = Some(format!("{schema} in {encoding}"));
                        }
                        channels.remove(&channel.id);
                        return Ok(());
                    };
                    let at = names.get(&name).copied().unwrap_or(topics.len());
                    if at == MOST_TOPICS {
                        return Err(RecordingFault::TooMany("topics"));
                    }
                    if at == topics.len() {
                        names.insert(name.clone(), at);
                        topics.push(Topic::new(name, kind.content));
                    }
                    channels.insert(channel.id, (at, kind));
                }
                Record::Message { header, data } => {
                    let Some(&(at, kind)) = channels.get(&header.channel_id) else { return Ok(()) };
                    let topic = &mut topics[at];
                    let is_calibration = kind.content == Content::Calibration;
                    *images += usize::from(!is_calibration);
                    if *images > MOST_IMAGES {
                        return Err(RecordingFault::TooMany("images"));
                    }
                    let taken = if is_calibration {
                        topic.calibrated(&data, kind)
                    } else {
                        topic.take(&data, header.log_time, (file, place), kind)
                    };
                    topic.is_broken |= taken.is_none();
                }
                _ => {}
            }
            Ok(())
        })
    }

    /// All of them; an error where none has images.
    fn topics(self) -> Result<Vec<Topic>, RecordingFault> {
        if self.topics.iter().any(Topic::has_images) {
            return Ok(self.topics);
        }
        let found =
            self.foreign.map_or("no images".to_owned(), |foreign| format!("images as {foreign}"));
        Err(RecordingFault::Topics(format!(
            "it holds {found}; sensor_msgs/msg/Image and CompressedImage in CDR are read, as ROS 2 records them, and foxglove.RawImage and CompressedImage in protobuf"
        )))
    }
}

impl Topic {
    fn new(name: String, content: Content) -> Self {
        let (frame_id, images) = (String::new(), Vec::new());
        Self { name, content, is_broken: false, images, info: None, info_changes: false, frame_id }
    }

    fn has_images(&self) -> bool {
        self.content != Content::Calibration
    }

    /// An error where a message of it cannot be read.
    fn check(&self) -> Result<(), RecordingFault> {
        let what = "the message ends early, or is of another type; record it again";
        let broken = || RecordingFault::Image(self.name.clone(), what.to_owned());
        if self.is_broken { Err(broken()) } else { Ok(()) }
    }

    /// Its calibration, if it has one.
    fn calibration(&self) -> Option<Calibration<'_>> {
        let info = self.info.as_ref()?;
        Some(Calibration { topic: &self.name, info, changes: self.info_changes })
    }

    /// Keeps the place of an image; `None` where the message cannot be read.
    fn take(
        &mut self,
        data: &[u8],
        log_time: u64,
        (file, place): (u16, Place),
        kind: Kind,
    ) -> Option<()> {
        let header = kind.header(data)?;
        if self.images.is_empty() {
            self.frame_id = header.frame_id.chars().take(MOST_NAME_BYTES).collect();
        }
        // Nobody set it: the time of the recorder.
        let stamp_ns = header.stamp_ns();
        let stamp_ns =
            if stamp_ns == 0 { i64::try_from(log_time).unwrap_or(i64::MAX) } else { stamp_ns };
        self.images.push(Stored { file, place, stamp_ns, kind });
        Some(())
    }

    /// Keeps a calibration; `None` where the message cannot be read.
    fn calibrated(&mut self, data: &[u8], kind: Kind) -> Option<()> {
        let info = kind.calibration(data)?;
        // A driver that is not ready sends zeros.
        let is_blank = |info: &CameraInfo| info.k[0] == 0.0 && info.p[0] == 0.0;
        match &self.info {
            Some(first) if !is_blank(first) => {
                self.info_changes |= *first != info && !is_blank(&info)
            }
            _ => self.info = Some(info),
        }
        Some(())
    }
}

impl PairSource for RecordedPair {
    fn layout(&self) -> Layout {
        Layout::Recording
    }

    fn paths(&self) -> [&Path; 2] {
        self.recording.pairs[self.index].map(|image| self.recording.files.path(image.file))
    }

    fn times_us(&self) -> Option<[u64; 2]> {
        self.stamps_ns().map(|stamps| stamps.map(|stamp| stamp / 1000))
    }

    fn time_ns(&self) -> Option<u64> {
        self.stamps_ns().map(|[left, _]| left)
    }

    fn grey(&self) -> Result<Views<StoredGray>, FrameError> {
        Ok(Views::Two([self.image(0)?, self.image(1)?]))
    }
}

impl RecordedPair {
    /// When the images were captured, ns; `None` before 1970.
    fn stamps_ns(&self) -> Option<[u64; 2]> {
        let [left, right] =
            self.recording.pairs[self.index].map(|image| u64::try_from(image.stamp_ns).ok());
        Some([left?, right?])
    }

    fn image(&self, eye: usize) -> Result<StoredGray, FrameError> {
        let recording = &self.recording;
        let Stored { file, place, kind, .. } = recording.pairs[self.index][eye];
        let fault =
            |fault| FrameError::Source(recording.files.path(file).to_path_buf(), Box::new(fault));
        let message = recording.files.message(file, place).map_err(|error| fault(error.into()))?;
        images::grey(&message, kind)
            .map_err(|what| fault(RecordingFault::Image(recording.topics[eye].clone(), what)))
    }
}

impl Recording {
    /// Topics, window and rig, in words.
    pub fn summary(&self) -> String {
        let [left, right] = &self.topics;
        let text = format!("{left} and {right}, paired within {} ms; {}", self.window_ms, self.rig);
        printable(&text).into_owned()
    }

    /// Longest time between two messages of one pair, ms.
    pub fn window_ms(&self) -> f64 {
        self.window_ms
    }

    /// Name of the left camera's frame.
    pub fn frame_id(&self) -> &str {
        &self.frame_id
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mcap::Writer;
    use crate::ros::{cdr, sent};

    /// Pairs of a recording that holds a message without fields in this topic.
    fn pairs_beside(broken: &str) -> Result<usize, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.mcap");
        let mut writer = Writer::new(Vec::new(), "test").unwrap();
        let message =
            cdr::write(&sent::image(sent::Stamp { ns: 5, frame_id: "" }, [2, 2], &[9; 4]));
        let message = message.unwrap();
        for topic in ["/left/image", "/right/image", "/rear/image", "/rear/camera_info"] {
            let kind = if topic.ends_with("image") { "Image" } else { "CameraInfo" };
            let channel = writer.channel(topic, &format!("sensor_msgs/msg/{kind}"), "").unwrap();
            if kind == "Image" {
                writer.message(channel, 5, &message).unwrap();
            }
            if topic == broken {
                writer.message(channel, 6, &[]).unwrap();
            }
        }
        std::fs::write(&path, writer.finish().unwrap()).unwrap();
        let found = pairs(&path, &Choice::default());
        found.map(|(pairs, ..)| pairs.len()).map_err(|error| error.to_string())
    }

    #[test]
    fn what_is_wrong_in_topics_that_are_not_used_does_not_matter() {
        assert_eq!(pairs_beside("/rear/image"), Ok(1));
        assert_eq!(pairs_beside("/rear/camera_info"), Ok(1));
        let error = pairs_beside("/left/image").unwrap_err();
        assert!(error.contains("an image of /left/image: the message ends early"), "{error}");
    }
}
