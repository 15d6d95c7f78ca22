//! Boxes of a detector, as `vision_msgs/msg/Detection2DArray`, in the recording of the images or in
//! one of its own.

use super::files::Files;
use super::{MOST_IMAGES, MOST_NAME_BYTES, RecordingFault};
use crate::mcap::{Place, Record};
use crate::ros::cdr;
use crate::ros::messages::{Detection2DArray, Header, ObjectHypothesisWithPose};
use core::cmp::Ordering;
use core::fmt;
use linestereo_frames::FrameError;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

const SCHEMA: &str = "vision_msgs/msg/Detection2DArray";

/// The messages of one topic, by their stamps.
pub struct Detections {
    root: PathBuf,
    topic: String,
    files: Files,
    /// Stamp, file and place, by stamp.
    list: Vec<(i64, u16, Place)>,
    window_ns: u64,
}

/// Something that a detector found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Detection {
    /// Left, top, right, bottom border, px: whole numbers are borders of pixels. Of a box that is
    /// turned those of the upright one around it.
    pub borders: [f64; 4],
    /// The most probable class; empty where there is none.
    pub class: String,
    /// Its score.
    pub score: f64,
    /// Name of the track.
    pub id: String,
}

impl fmt::Debug for Detections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Detections")
            .field("root", &self.root)
            .field("topic", &self.topic)
            .finish_non_exhaustive()
    }
}

impl Detections {
    /// Those of a topic, or of the only one that there is. Images and messages belong together
    /// whose stamps differ by up to `window_ms`.
    ///
    /// # Errors
    /// No recording; no such topic, with the names of those that there are; or more than one where
    /// none is named.
    pub fn open(root: &Path, topic: Option<&str>, window_ms: f64) -> Result<Self, FrameError> {
        let mut found = BTreeMap::<String, Vec<(i64, u16, Place)>>::new();
        let mut count = 0;
        let files = Files::open(root, |reader, file| {
            let (mut schemas, mut channels) = (HashMap::new(), HashMap::new());
            reader.scan(|record, place| -> Result<(), RecordingFault> {
                match record {
                    Record::Schema { header, .. } => {
                        _ = schemas.insert(header.id, header.name == SCHEMA)
                    }
                    Record::Channel(channel) => {
                        let is_ours = schemas.get(&channel.schema_id) == Some(&true)
                            && channel.message_encoding == "cdr";
                        if is_ours && channel.topic.len() <= MOST_NAME_BYTES {
                            found.entry(channel.topic.clone()).or_default();
                            channels.insert(channel.id, channel.topic);
                        } else {
                            channels.remove(&channel.id);
                        }
                    }
                    Record::Message { header, data } => {
                        let Some(topic) = channels.get(&header.channel_id) else { return Ok(()) };
                        count += 1;
                        if count > MOST_IMAGES {
                            return Err(RecordingFault::TooMany("detections"));
                        }
                        let Some(stamp) = cdr::read::<Header>(&data) else {
                            return Err(early(topic));
                        };
                        if let Some(list) = found.get_mut(topic) {
                            list.push((stamp.stamp_ns(), file, place));
                        }
                    }
                    _ => {}
                }
                Ok(())
            })
        })?;
        let fault = |what: String| {
            FrameError::Source(root.to_path_buf(), Box::new(RecordingFault::Topics(what)))
        };
        let names = found.keys().cloned().collect::<Vec<_>>().join(", ");
        let (topic, mut list) = match topic {
            _ if names.is_empty() => {
                return Err(fault(format!(
                    "it has no topic of {SCHEMA}; record what the detector sends"
                )));
            }
            Some(name) => found
                .remove_entry(name)
                .ok_or_else(|| fault(format!("no {SCHEMA} is in {name}, but in {names}")))?,
            None if found.len() > 1 => {
                return Err(fault(format!("{SCHEMA} is in {names}; name one by --objects")));
            }
            None => found.pop_first().ok_or_else(|| fault("it has no detections".to_owned()))?,
        };
        list.sort_by_key(|(stamp, ..)| *stamp);
        Ok(Self {
            root: root.to_path_buf(),
            topic,
            files,
            list,
            window_ns: (window_ms * 1e6) as u64,
        })
    }

    /// Boxes in the image of this time, ns; `None` where no message is near it.
    ///
    /// # Errors
    /// A message that cannot be read.
    pub fn at(&self, time_ns: u64) -> Result<Option<Vec<Detection>>, FrameError> {
        let time = i64::try_from(time_ns).unwrap_or(i64::MAX);
        let next = self.list.partition_point(|(stamp, ..)| *stamp < time);
        let around =
            self.list.get(next.saturating_sub(1)..(next + 1).min(self.list.len())).unwrap_or(&[]);
        let nearest = around.iter().min_by_key(|(stamp, ..)| stamp.abs_diff(time));
        let Some(&(_, file, place)) =
            nearest.filter(|(stamp, ..)| stamp.abs_diff(time) <= self.window_ns)
        else {
            return Ok(None);
        };
        let fault = |fault| FrameError::Source(self.root.clone(), Box::new(fault));
        let message = self.files.message(file, place).map_err(|error| fault(error.into()))?;
        let array: Detection2DArray =
            cdr::read(&message).ok_or_else(|| fault(early(&self.topic)))?;
        Ok(Some(array.detections.iter().map(Detection::of).collect()))
    }
}

fn early(topic: &str) -> RecordingFault {
    RecordingFault::Image(
        topic.to_owned(),
        format!("no {SCHEMA} as ROS 2 Humble and later define it; record it with one of these"),
    )
}

impl Detection {
    fn of(found: &crate::ros::messages::Detection2D) -> Self {
        let [x, y, turned] = found.center;
        let [width, height] = [found.size_x, found.size_y];
        let (sin, cos) = (turned.sin().abs(), turned.cos().abs());
        let half = [(width * cos + height * sin) / 2.0, (width * sin + height * cos) / 2.0];
        let by_score = |a: &&ObjectHypothesisWithPose, b: &&ObjectHypothesisWithPose| {
            a.score.partial_cmp(&b.score).unwrap_or(Ordering::Equal)
        };
        let best = found.results.iter().max_by(by_score);
        Self {
            borders: [x - half[0], y - half[1], x + half[0], y + half[1]],
            class: best.map_or(String::new(), |best| best.class_id.clone()),
            score: best.map_or(0.0, |best| best.score),
            id: found.id.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mcap::Writer;
    use crate::ros::messages::{Detection2D, PoseWithCovariance, Time};

    fn found(x: f64, turned: f64, classes: &[(&str, f64)]) -> Detection2D {
        let result = |&(class, score): &(&str, f64)| {
            let pose = PoseWithCovariance::default();
            ObjectHypothesisWithPose { class_id: class.to_owned(), score, pose }
        };
        let results = classes.iter().map(result).collect();
        let (header, center, id) = (Header::default(), [x, 50.0, turned], "7".to_owned());
        Detection2D { header, results, center, size_x: 20.0, size_y: 10.0, id }
    }

    fn recording(topics: &[&str]) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        let mut writer = Writer::new(std::fs::File::create(&path).unwrap(), "test").unwrap();
        for topic in topics {
            let channel = writer.channel(topic, SCHEMA, "").unwrap();
            for (sec, x) in [(3, 30.0), (1, 10.0)] {
                let stamp = Time { sec, nanosec: 500 };
                let header = Header { stamp, frame_id: "left".to_owned() };
                let upright = found(x, 0.0, &[("cup", 0.4), ("person", 0.9)]);
                let detections = vec![upright, found(x, core::f64::consts::FRAC_PI_2, &[])];
                let bytes = cdr::write(&Detection2DArray { header, detections }).unwrap();
                writer.message(channel, 0, &bytes).unwrap();
            }
        }
        writer.finish().unwrap();
        (folder, path)
    }

    #[test]
    fn messages_are_found_by_their_stamps() {
        let (_folder, path) = recording(&["/boxes"]);
        let detections = Detections::open(&path, None, 1.0).unwrap();
        let at = |ns| detections.at(ns).unwrap();
        let [upright, turned] = &at(1_000_000_500).unwrap()[..] else { panic!("two boxes") };
        assert_eq!(upright.borders, [0.0, 45.0, 20.0, 55.0]);
        assert_eq!((&*upright.class, upright.score, &*upright.id), ("person", 0.9, "7"));
        let expected = [5.0, 40.0, 15.0, 60.0];
        let near = turned.borders.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(near, "{turned:?}");
        assert_eq!(at(3_001_000_500).unwrap()[0].borders[0], 20.0, "the last one, 1 ms later");
        for ns in [3_001_000_501, 0, 2_000_000_000, u64::MAX] {
            assert!(at(ns).is_none(), "{ns}");
        }
    }

    #[test]
    fn topics_are_named_and_not_guessed() {
        let (_folder, path) = recording(&["/a", "/b"]);
        let (_empty, none) = recording(&[]);
        for (path, topic, words) in [
            (&path, None, "is in /a, /b; name one"),
            (&path, Some("/c"), "is in /c, but in /a, /b"),
            (&none, None, "it has no topic of vision_msgs"),
        ] {
            let error = Detections::open(path, topic, 1.0).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        assert!(Detections::open(&path, Some("/b"), 1.0).is_ok());
    }
}
