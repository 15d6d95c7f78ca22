//! Pairs of a folder, a recording, a video or a camera, in their order, matched one after the
//! other.

use super::arguments::{both, number_in};
use super::input::{InputArgs, LoadedPair, PairMatcher, Setup, TimedResult};
use super::known::Known;
use super::objects::{Asked, Objects};
use super::recording::Played;
use crate::interruption;
use crate::results::ground::Ground;
use crate::results::listing::{self, Answers};
use anyhow::{Result, bail};
use linestereo_frames::{SceneInfo, StoredPair};
use linestereo_recordings::{Camera, Choice, DEFAULT_WINDOW_MS, Footage, is_recording, is_video};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Options of where pairs are from, beside the path itself.
#[derive(Debug, clap::Args)]
pub(super) struct SourceArgs {
    /// Video of the right camera, frame by frame with the left one.
    right: Option<PathBuf>,
    /// Both images of a pair stand side by side in one file: left | right.
    #[arg(long)]
    side_by_side: bool,
    /// Only frames whose number is in this range (the position, where names have no number).
    #[arg(long, value_name = "FIRST..LAST", value_parser = parse_range)]
    frames: Option<[u64; 2]>,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    recording: RecordingArgs,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Recordings of ROS 2 (.mcap)")]
struct RecordingArgs {
    /// Topic with the left images [default: by its name].
    #[arg(long, value_name = "TOPIC", requires = "right_topic")]
    left_topic: Option<String>,
    /// Topic with the right images.
    #[arg(long, value_name = "TOPIC", requires = "left_topic")]
    right_topic: Option<String>,
    /// Largest time between the two images of a pair [default: 10].
    #[arg(long, value_name = "MS",
          value_parser = number_in(0.0..=10_000.0, "give milliseconds, 0 to 10000"))]
    pair_window_ms: Option<f64>,
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "A stereo camera at this PC")]
struct CameraArgs {
    /// Match the pairs of a camera that sends both views side by side, until Ctrl-C or the end of
    /// --frames; needs Linux and ffmpeg.
    #[arg(long, value_name = "/dev/video0")]
    camera: Option<PathBuf>,
    /// Size of its images, both views together [default: the camera's].
    #[arg(long, value_name = "WxH", requires = "camera", value_parser = size)]
    camera_size: Option<[u16; 2]>,
    /// Its frames a second [default: the camera's].
    #[arg(long, value_name = "N", requires = "camera", value_parser = clap::value_parser!(u16).range(1..=1000))]
    camera_fps: Option<u16>,
    /// Format of its images: mjpeg if raw images are too large for USB [default: ffmpeg's choice].
    #[arg(long, value_name = "NAME", requires = "camera", value_parser = name)]
    camera_format: Option<String>,
}

fn size(text: &str) -> Result<[u16; 2], &'static str> {
    let sides = text.split_once(['x', 'X']).and_then(both);
    sides
        .filter(|sides| !sides.contains(&0))
        .ok_or("give width and height of both views together, such as 2560x720")
}

fn name(text: &str) -> Result<String, &'static str> {
    let is_name =
        !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    is_name
        .then(|| text.to_owned())
        .ok_or("give a name that v4l2-ctl and ffmpeg know, such as mjpeg")
}

impl CameraArgs {
    /// Refuses what is said of a camera where there is none.
    fn refuse_options(&self) -> Result<()> {
        if self.camera_size.is_some() || self.camera_fps.is_some() || self.camera_format.is_some() {
            bail!(
                "--camera-size, --camera-fps and --camera-format are for --camera; leave them out"
            );
        }
        Ok(())
    }

    /// Starts the camera.
    fn open(&self) -> Result<Footage> {
        let Some(device) = self.camera.clone() else {
            bail!("give a folder, an .mcap file, a video or --camera")
        };
        let (size, rate, format) = (self.camera_size, self.camera_fps, self.camera_format.clone());
        Ok(Footage::camera(&Camera { device, size, rate, format }, interruption::requested)?)
    }
}

impl SourceArgs {
    /// The pairs of this path, or of the camera where there is none.
    pub(super) fn find(&self, path: Option<&Path>) -> Result<Footage> {
        let RecordingArgs { left_topic, right_topic, pair_window_ms } = &self.recording;
        if path.is_some() {
            self.camera.refuse_options()?;
        }
        let is_recorded = self.right.is_none() && path.is_some_and(is_recording);
        if !is_recorded && (left_topic.is_some() || pair_window_ms.is_some()) {
            bail!(
                "--left-topic, --right-topic and --pair-window-ms are for an .mcap file; give one, or leave them out"
            );
        }
        let Some(path) = path else { return self.camera.open() };
        if self.right.is_some() || (is_video(path) && !path.is_dir()) {
            return videos(path, self.right.as_deref(), self.side_by_side);
        }
        if !is_recorded && path.is_file() {
            bail!(
                "{} is neither a folder, nor a recording (.mcap), nor a video that is read; linestereo run matches two images",
                path.display()
            );
        }
        if !is_recorded {
            return Ok(Footage::open(path, self.side_by_side, interruption::requested)?);
        }
        if self.side_by_side {
            bail!(
                "--side-by-side is for folders; images of a recording have a topic for each camera"
            );
        }
        let topics = [left_topic.clone(), right_topic.clone()];
        let choice = Choice { topics, window_ms: pair_window_ms.unwrap_or(DEFAULT_WINDOW_MS) };
        Ok(Footage::recorded(path, &choice)?)
    }

    /// Those of them that are asked for.
    pub(super) fn chosen<'a>(&self, path: &Path, found: &'a Footage) -> Result<Chosen<'a>> {
        let chosen = Chosen::new(found, self.frames);
        if chosen.count() == Some(0) {
            let (all, path) = (found.pairs.len(), path.display());
            bail!("none of the {all} pairs in {path} has a number in --frames");
        }
        Ok(chosen)
    }
}

/// Pairs of a video with both views side by side, or of a left and a right one.
pub(super) fn videos(left: &Path, right: Option<&Path>, side_by_side: bool) -> Result<Footage> {
    let Some(right) = right else { return Ok(Footage::video(&[left], interruption::requested)?) };
    if let Some(other) = [left, right].into_iter().find(|path| !is_video(path) || path.is_dir()) {
        bail!(
            "{} is no video; of two paths both are videos, a left and a right one: of images give the folder above both",
            other.display()
        );
    }
    if side_by_side {
        bail!(
            "--side-by-side is for one video with both views; leave it out, or give that one alone"
        );
    }
    Ok(Footage::video(&[left, right], interruption::requested)?)
}

/// Pairs in the range, each with its number.
pub(super) struct Chosen<'a> {
    pub(super) listed: Vec<(u64, &'a StoredPair)>,
    /// First and last number of pairs of a camera, which are not there yet.
    live: Option<[u64; 2]>,
}

impl<'a> Chosen<'a> {
    fn new(found: &'a Footage, range: Option<[u64; 2]>) -> Self {
        let live = found.of_video().filter(|video| video.is_live());
        let numbered = found
            .pairs
            .iter()
            .zip(0..)
            .map(|(pair, position)| (pair.number.unwrap_or(position), pair));
        let is_in =
            |number: &u64| range.is_none_or(|[first, last]| (first..=last).contains(number));
        Self {
            listed: numbered.filter(|(number, _)| is_in(number)).collect(),
            live: live.map(|_| range.unwrap_or([0, u64::MAX])),
        }
    }

    /// Number of pairs; without a range a camera has no end.
    pub(super) fn count(&self) -> Option<usize> {
        match self.live {
            Some([_, u64::MAX]) => None,
            Some([first, last]) => {
                Some(usize::try_from(last - first).unwrap_or(usize::MAX).saturating_add(1))
            }
            None => Some(self.listed.len()),
        }
    }

    pub(super) fn pairs(
        &self,
        found: &'a Footage,
    ) -> impl Iterator<Item = (u64, Cow<'a, StoredPair>)> {
        let live = self.live.into_iter().flat_map(|[first, last]| first..=last);
        let live = live.map_while(|number| {
            Some((number, Cow::Owned(found.filmed(usize::try_from(number).ok()?)?)))
        });
        self.listed.iter().map(|&(number, pair)| (number, Cow::Borrowed(pair))).chain(live)
    }
}

fn parse_range(text: &str) -> Result<[u64; 2], &'static str> {
    let range = text.split_once("..").and_then(both);
    range.filter(|[first, last]| first <= last).ok_or("give two numbers: 10..200")
}

/// Pairs matched one after the other.
pub(super) struct Player<'a> {
    args: &'a InputArgs,
    /// The folder's scene.json, for pairs that have none of their own.
    scene: Known,
    /// Knowledge of the pairs at hand, with their set-up and matcher.
    at_hand: Option<(Known, Setup<'a>, PairMatcher)>,
}

impl<'a> Player<'a> {
    pub(super) fn new(args: &'a InputArgs, folder: &Path) -> Result<Self> {
        let path = folder.join("scene.json");
        let scene = if path.is_file() {
            Known::Scene(path.clone(), SceneInfo::load(&path)?)
        } else {
            Known::Nothing
        };
        Ok(Self { args, scene, at_hand: None })
    }

    pub(super) fn setup(&self) -> Option<&Setup<'a>> {
        self.at_hand.as_ref().map(|(_, setup, _)| setup)
    }

    pub(super) fn at_hand(&mut self) -> Option<(&Setup<'a>, &mut PairMatcher)> {
        self.at_hand.as_mut().map(|(_, setup, matcher)| (&*setup, matcher))
    }

    /// Loads a pair and, where it is the first one or of another rig than the one before, sets up
    /// what it is matched with.
    pub(super) fn load(
        &mut self,
        pair: &StoredPair,
    ) -> Result<(LoadedPair, &Setup<'a>, &mut PairMatcher)> {
        let mut known = self.args.known_of(pair)?;
        if matches!(known, Known::Nothing) {
            known = self.scene.clone();
        }
        let loaded = self.args.load_as(&pair.images, &known)?;
        let is_set_up =
            self.at_hand.as_ref().is_some_and(|(at_hand, ..)| at_hand.matches_like(&known));
        if !is_set_up {
            let setup = self.args.setup_as(&loaded, &known)?;
            let matcher = PairMatcher::new(&setup)?;
            self.at_hand = Some((known, setup, matcher));
        }
        let Some((_, setup, matcher)) = &mut self.at_hand else { bail!("nothing is set up") };
        Ok((loaded, setup, matcher))
    }

    /// Matches a pair, with the depths of its objects.
    pub(super) fn next(&mut self, pair: &StoredPair, asked: &Objects<'_>) -> Result<Played> {
        let (loaded, setup, matcher) = self.load(pair)?;
        if matcher.engine.matcher.knows_rows() {
            matcher.engine.areas = asked.areas(setup, pair);
        }
        let TimedResult { images, result, .. } =
            matcher.run(setup, &loaded, pair.images.times_us())?;
        let objects = asked.depths(setup, pair, &mut matcher.engine);
        let ground =
            result.ground.map(|plane| Ground::new(plane, setup.geometry(), images[0].dims));
        let refusal = setup.refusal(&result);
        Ok(Played { images, result, refusal, objects, ground, sectors: None })
    }
}

/// The line of a frame.
pub(super) fn line(
    number: u64,
    pair: &StoredPair,
    played: &Result<Played, String>,
    no_points: bool,
) -> Result<String> {
    match played {
        Ok(Played { images, result, objects, ground, sectors, .. }) => {
            let (ground, sectors) = (*ground, sectors.clone());
            let answers = Answers { ground, sectors, ..Asked::answers(objects.as_ref()) };
            let mut result = result.clone();
            if no_points {
                result.points.clear();
            }
            let line = listing::json(images[0].dims, &result, &answers)?;
            Ok(with_name(number, &pair.name, &line))
        }
        Err(error) => {
            Ok(format!("{}\n", json!({"frame": number, "name": pair.name, "error": error})))
        }
    }
}

/// The object of a line with the frame's number and name before its own fields.
fn with_name(number: u64, name: &str, line: &str) -> String {
    let name = Value::from(name);
    format!("{{\"frame\":{number},\"name\":{name},{}", line.trim_start_matches('{'))
}
