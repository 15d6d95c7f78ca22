//! Results of a sequence: lines, or a recording of ROS 2.

use super::input::Setup;
use super::objects::Asked;
use crate::engine::FrameResult;
use crate::output::{LineFile, OutputPath, cannot_write, is_terminal, print};
use crate::results::directions::Direction;
use crate::results::listing;
use crate::results::ros::{Content, Frame, RosFile, placed};
use anyhow::{Result, bail};
use linestereo_frames::regions::Object;
use linestereo_frames::{GrayImage, StoredPair};
use linestereo_recordings::ros::sent::{Label, Stamp};
use linestereo_recordings::{Recording, is_mcap};
use std::io::Write;
use std::path::PathBuf;

/// Frame of what is not from a recording.
const FRAME_ID: &str = "left_camera_optical_frame";
/// Time between two pairs that have none, ns.
const STEP_NS: u64 = 100_000_000;

pub(super) struct Played {
    pub(super) images: [GrayImage; 2],
    pub(super) result: FrameResult,
    /// Why nothing of it is to be used.
    pub(super) refusal: Option<String>,
    pub(super) objects: Option<Asked>,
    pub(super) ground: Option<crate::results::ground::Ground>,
    /// Every direction of the turn, where they are asked for.
    pub(super) sectors: Option<Vec<Direction>>,
}

/// Where results go.
pub(super) struct Sink {
    path: PathBuf,
    to: To,
    frame_id: String,
    /// Time of the next pair that has none.
    first_ns: u64,
}

enum To {
    Stdout,
    Lines(LineFile),
    Messages(Box<RosFile<LineFile>>),
}

impl Sink {
    /// Lines on stdout, lines in a file, or messages with these too where its name ends in .mcap.
    pub(super) fn new(
        out: Option<&OutputPath>,
        content: Content<'_>,
        recording: Option<&Recording>,
    ) -> Result<Self> {
        let path = out.filter(|path| !path.is_stdout()).map(|path| path.to_path_buf());
        if !content.extras.is_empty() && !path.as_deref().is_some_and(is_mcap) {
            bail!("--with writes messages; give --out FILE.mcap");
        }
        let to = match &path {
            None => To::Stdout,
            Some(path) if is_mcap(path) => {
                let file = RosFile::new(LineFile::new(path)?, content);
                To::Messages(Box::new(file.map_err(|error| cannot_write(path, &error))?))
            }
            Some(path) => To::Lines(LineFile::new(path)?),
        };
        let frame_id =
            recording.map(Recording::frame_id).filter(|name| !name.is_empty()).unwrap_or(FRAME_ID);
        let path = path.unwrap_or_default();
        Ok(Self { path, to, frame_id: frame_id.to_owned(), first_ns: 0 })
    }

    /// People read the lines.
    pub(super) fn is_terminal(&self) -> bool {
        matches!(self.to, To::Stdout) && is_terminal()
    }

    /// Messages are written, not lines.
    pub(super) fn is_ros(&self) -> bool {
        matches!(self.to, To::Messages(_))
    }

    pub(super) fn path(&self) -> Option<String> {
        (!matches!(self.to, To::Stdout)).then(|| self.path.display().to_string())
    }

    pub(super) fn line(&mut self, line: &str) -> Result<()> {
        match &mut self.to {
            To::Lines(file) => {
                file.write_all(line.as_bytes()).map_err(|error| cannot_write(&self.path, &error))
            }
            _ => print(line),
        }
    }

    /// The messages of one more pair.
    pub(super) fn messages(
        &mut self,
        number: u64,
        pair: &StoredPair,
        setup: Option<&Setup<'_>>,
        played: &Result<Played, String>,
    ) -> Result<()> {
        let To::Messages(file) = &mut self.to else { return Ok(()) };
        let stamp_ns = pair.images.time_ns();
        self.first_ns += STEP_NS;
        let stamp = Stamp { ns: stamp_ns.unwrap_or(self.first_ns), frame_id: &self.frame_id };
        let named = (number, &*pair.name);
        let sent = match (played, setup) {
            (Ok(played), Some(setup)) => {
                let objects = played.objects.as_ref().map(|_| labels(setup, played));
                let Played { images, result, .. } = played;
                let (params, rig_numbers) = (&setup.params, setup.rig_numbers);
                file.frame(stamp, named, &Frame { images, result, params, rig_numbers, objects })
            }
            (Ok(_), None) => Ok(()),
            (Err(error), _) => file.failure(stamp, named, error),
        };
        sent.map_err(|error| cannot_write(&self.path, &error))
    }

    /// Puts the file in its place, where there is anything in it; what is to be said of it.
    pub(super) fn commit(self, is_wanted: bool) -> Result<String> {
        if !is_wanted {
            return Ok(String::new());
        }
        match self.to {
            To::Stdout => Ok(String::new()),
            To::Lines(file) => file.commit().map(|()| String::new()),
            To::Messages(file) => {
                let has_places = file.has_places();
                file.finish().map_err(|error| cannot_write(&self.path, &error))?.commit()?;
                let none = "no points or segments are written: without focal length and baseline they have no place in space\n";
                Ok(if has_places { String::new() } else { none.to_owned() })
            }
        }
    }
}

/// Objects with a depth, in the middle of what the detector found.
fn labels(setup: &Setup<'_>, played: &Played) -> Vec<Label> {
    let (Some(rig), Some(asked)) = (setup.geometry(), &played.objects) else { return Vec::new() };
    let label = |(object, found): &(Object, listing::Object)| {
        let area = object.region(setup.dims()).ok()?.area();
        let told = asked.told.get(usize::from(object.label)).cloned().unwrap_or_default();
        let name = object.name.as_deref().unwrap_or("object");
        let (text, is_told) = (format!("{name} {:.2} m", found.depth_m?), !asked.told.is_empty());
        let said = Label {
            text,
            confidence: found.confidence as f32,
            class: name.to_owned(),
            score: if is_told { told.score } else { 1.0 },
            id: told.id,
            sigma_m: found.sigma_m.unwrap_or(f64::INFINITY),
            ..Label::default()
        };
        placed(rig, area, found.disparity_px?, said)
    };
    asked.list.iter().filter_map(label).collect()
}
