//! Objects of a detector, given by options, and their depths: the same for every command that
//! matches pairs.

use super::input::Setup;
use crate::engine::Engine;
use crate::output::place;
use crate::results::listing::{self, Answers};
use anyhow::{Result, bail};
use core::fmt::Write;
use linestereo::Area;
use linestereo_frames::StoredPair;
use linestereo_frames::regions::{self, Frame, Object, ObjectsError, Skipped};
use linestereo_recordings::{Detection, Detections, Footage, is_recording};
use std::path::{Path, PathBuf};

/// Extensions of files of one frame, in the order in which they are looked for.
const EXTENSIONS: [&str; 5] = ["json", "txt", "csv", "png", "pgm"];
/// Objects that a summary lists.
const MOST_LISTED: usize = 20;

#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "Objects")]
pub(super) struct ObjectArgs {
    /// Depth of each object: boxes or masks as COCO JSON, YOLO .txt, CSV
    /// (x0,y0,x1,y1[,label[,name]], or in any order below a line of names) or a label image .png,
    /// in pixels of the rectified left image before --width. For a sequence also a folder with a
    /// file per frame; for a recording a topic of it, or another recording, with
    /// vision_msgs/msg/Detection2DArray, taken by their stamps.
    #[arg(long, value_name = "FILE|TOPIC")]
    objects: Option<PathBuf>,
    /// Names of the classes of a YOLO file, one per line [default: classes.txt or obj.names beside
    /// it].
    #[arg(long, value_name = "FILE", requires = "objects")]
    classes: Option<PathBuf>,
    /// Match only around the objects: nearly the same depths for less work. In a sequence the first
    /// pair is matched as a whole, to measure the row offset.
    #[arg(long, requires = "objects")]
    only_objects: bool,
}

#[derive(Debug, Default)]
pub(super) struct Asked {
    /// In the order of the file.
    pub(super) list: Vec<(Object, listing::Object)>,
    pub(super) skipped: Skipped,
    /// Which of them is the first, and why.
    pub(super) first_skipped: Option<String>,
    /// The same as a recording's messages tell them: that of label 3 is the fourth.
    pub(super) told: Vec<Detection>,
    /// The folder holds no file of this frame, or the recording no message.
    pub(super) is_missing: bool,
    /// Why there is no list.
    pub(super) error: Option<String>,
}

impl ObjectArgs {
    /// Is a depth per object asked for?
    pub(super) fn is_given(&self) -> bool {
        self.objects.is_some()
    }

    /// Nothing but the objects is matched.
    pub(super) fn is_only(&self) -> bool {
        self.only_objects
    }

    /// The objects of these pairs, which are at `root`. What holds none of any of them is refused,
    /// before the first of them is matched: files by their names, messages by their topic.
    pub(super) fn open(&self, root: &Path, found: &Footage) -> Result<Objects<'_>> {
        let mut objects = Objects { args: self, detections: None };
        let Some(path) = &self.objects else { return Ok(objects) };
        if found.of_video().is_some() {
            bail!(
                "--objects needs image names or the time stamps of a recording, and a video has \
                 neither; give a folder or a recording"
            );
        }
        if let Some(recording) = found.of_recording() {
            objects.detections = Some(detections(path, root, recording.window_ms())?);
        } else if !path.is_dir() {
            std::fs::metadata(path).map_err(|error| ObjectsError::Read(path.clone(), error))?;
            if found.pairs.iter().any(|pair| is_image_of(path, pair)) {
                bail!(
                    "--objects {} is an image of the pair itself; give a detector's file, or a \
                     label image",
                    path.display()
                );
            }
        } else if !found.pairs.iter().any(|pair| file_of(path, pair).is_some()) {
            bail!(
                "{} holds no file that is called like a left image, such as left.json beside left.png; add or rename them",
                path.display()
            );
        }
        Ok(objects)
    }
}

/// Messages of a topic of this recording, or of a recording of its own.
fn detections(path: &Path, root: &Path, window_ms: f64) -> Result<Detections> {
    if is_recording(path) {
        return Ok(Detections::open(path, None, window_ms)?);
    }
    let topic = path.to_str().filter(|name| name.starts_with('/') && !path.exists());
    let Some(topic) = topic else {
        bail!(
            "objects of a recording are messages of vision_msgs/msg/Detection2DArray; give their topic, as in --objects /detections, or a recording of them, in place of {}",
            path.display()
        );
    };
    Ok(Detections::open(root, Some(topic), window_ms)?)
}

/// Objects of every pair that is matched, wherever they are from.
pub(super) struct Objects<'a> {
    args: &'a ObjectArgs,
    /// Of a recording.
    detections: Option<Detections>,
}

struct OfPair {
    objects: regions::Objects,
    /// As the messages of a recording tell them.
    told: Vec<Detection>,
    /// There is no file, or no message.
    is_missing: bool,
}

impl Objects<'_> {
    /// Nothing but the objects is matched.
    pub(super) fn is_only(&self) -> bool {
        self.args.only_objects
    }

    /// The depths of the objects of the pair that was matched last; `None` when nobody asked.
    pub(super) fn depths(
        &self,
        setup: &Setup<'_>,
        pair: &StoredPair,
        engine: &mut Engine,
    ) -> Option<Asked> {
        let path = self.args.objects.as_deref()?;
        let OfPair { objects, told, is_missing } = match self.read(path, setup, pair) {
            Ok(of_pair) => of_pair,
            Err(error) => return Some(Asked { error: Some(error), ..Asked::default() }),
        };
        let dims = setup.dims();
        let list = objects.list.iter().filter_map(|object| {
            let region = object.region(dims).ok()?; // a file gives regions that lie in the image
            let (found, name) = (engine.object(&region), object.name.as_deref());
            Some((object.clone(), listing::Object::new(region.label(), &found, name)))
        });
        let (list, skipped, first_skipped) =
            (list.collect(), objects.skipped, objects.first_skipped);
        Some(Asked { list, skipped, first_skipped, told, is_missing, error: None })
    }

    /// Where the next pair is to be matched; `None` is everywhere.
    pub(super) fn areas(&self, setup: &Setup<'_>, pair: &StoredPair) -> Option<Vec<Area>> {
        let path = self.args.objects.as_deref().filter(|_| self.args.only_objects)?;
        let OfPair { objects, .. } = self.read(path, setup, pair).ok()?; // what is wrong is said with the depths
        let dims = setup.dims();
        let area = |object: &Object| Some(object.region(dims).ok()?.area());
        Some(objects.list.iter().filter_map(area).collect())
    }

    fn read(&self, path: &Path, setup: &Setup<'_>, pair: &StoredPair) -> Result<OfPair, String> {
        let image = pair.left();
        let frame = Frame { given: setup.given, matched: setup.dims(), image: Some(image) };
        if let Some(detections) = &self.detections {
            let told = pair
                .images
                .time_ns()
                .map(|time| detections.at(time))
                .transpose()
                .map_err(|error| error.to_string())?;
            let told = told.flatten();
            let is_missing = told.is_none();
            let told = told.unwrap_or_default();
            let name =
                |found: &Detection| Some(found.class.clone()).filter(|class| !class.is_empty());
            let objects =
                regions::of_boxes(told.iter().map(|found| (found.borders, name(found))), frame);
            return Ok(OfPair { objects, told, is_missing });
        }
        let file = if path.is_dir() { file_of(path, pair) } else { Some(path.to_path_buf()) };
        let load = |file: &PathBuf| regions::load(file, self.args.classes.as_deref(), frame);
        let objects = file.as_ref().map(load).transpose().map_err(|error| error.to_string())?;
        let is_missing = objects.is_none();
        Ok(OfPair { objects: objects.unwrap_or_default(), told: Vec::new(), is_missing })
    }
}

/// The file of a frame in a folder: called like its left image, and not that image itself. A dot in
/// that name ends nothing.
fn file_of(folder: &Path, pair: &StoredPair) -> Option<PathBuf> {
    let stem = folder.join(pair.left().file_stem().unwrap_or_default());
    EXTENSIONS
        .map(|extension| stem.with_added_extension(extension))
        .into_iter()
        .find(|file| file.is_file() && !is_image_of(file, pair))
}

fn is_image_of(file: &Path, pair: &StoredPair) -> bool {
    pair.images.paths().into_iter().any(|image| place(image) == place(file))
}

impl Asked {
    /// As it stands in JSON.
    pub(super) fn answers(asked: Option<&Self>) -> Answers {
        Answers {
            objects: asked.map(|asked| asked.list.iter().map(|(_, depth)| depth.clone()).collect()),
            objects_error: asked.and_then(|asked| asked.error.clone()),
            ..Answers::default()
        }
    }

    /// A line per object, and what was skipped.
    pub(super) fn summary(&self) -> String {
        let mut text = String::new();
        for (_, object) in self.list.iter().take(MOST_LISTED) {
            let name = object.name.as_deref().unwrap_or("object");
            let _ = write!(text, "{name} ({}): ", object.label);
            let _ = match (object.disparity_px, object.depth_m, object.reason) {
                (_, Some(z), _) => {
                    let sigma = object.sigma_m.map(|sigma| format!("{sigma:.3} m"));
                    write!(
                        text,
                        "{z:.3} m, sigma {}, nearest {:.3} m",
                        sigma.as_deref().unwrap_or("infinite"),
                        object.nearest_m.unwrap_or(z)
                    )
                }
                (Some(d), None, _) => write!(text, "{d:.2} px, sigma {:.2} px", object.sigma_px),
                (None, None, reason) => write!(text, "{}", reason.unwrap_or("unknown")),
            };
            let _ = writeln!(text, ", support {}, p = {:.2}", object.support, object.confidence);
        }
        if self.list.len() > MOST_LISTED {
            let _ = writeln!(text, "and {} more objects", self.list.len() - MOST_LISTED);
        }
        text.push_str(&self.skipped.summary());
        text.extend(self.first_skipped.iter().map(|first| format!("  the first: {first}\n")));
        text
    }
}

/// Counts of objects over many pairs.
#[derive(Debug, Default)]
pub(super) struct ObjectTally {
    skipped: usize,
    unread: usize,
    missing: usize,
    /// The first object that is skipped, and why.
    first: Option<String>,
}

impl ObjectTally {
    pub(super) fn count(&mut self, pair: &str, asked: &Asked) {
        self.skipped += asked.skipped.objects();
        self.unread += usize::from(asked.error.is_some());
        self.missing += usize::from(asked.is_missing);
        let first = asked.first_skipped.as_ref().filter(|_| self.first.is_none());
        self.first = first.map(|first| format!("{pair}: {first}")).or(self.first.take());
    }

    pub(super) fn summary(&self) -> String {
        let mut text = format!(
            "{} objects skipped, {} frames whose objects cannot be read",
            self.skipped, self.unread
        );
        if self.missing > 0 {
            let _ =
                write!(text, ", {} frames without a file or a message of objects", self.missing);
        }
        text.extend(self.first.iter().map(|first| format!("\n  the first: {first}")));
        text + "\n"
    }
}
