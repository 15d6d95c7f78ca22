//! Objects of a detector, given by options, and their depths: the same for every command that matches pairs.

use super::input::Setup;
use crate::engine::Engine;
use crate::results::listing::{self, Answers};
use anyhow::{Result, bail};
use core::fmt::Write;
use linestereo::objects::Shape;
use linestereo::{Area, ObjectDepth};
use linestereo_frames::regions::{self, Frame, Object, ObjectsError, Skipped};
use linestereo_wire::{MAX_REGIONS, RegionBox};
use std::path::{Path, PathBuf};

/// Extensions of files of one frame, in the order in which they are looked for.
const EXTENSIONS: [&str; 5] = ["png", "json", "txt", "csv", "pgm"];
/// Objects that a summary lists.
const MOST_LISTED: usize = 20;

#[derive(Debug, Default, clap::Args)]
#[command(next_help_heading = "Objects")]
pub(super) struct ObjectArgs {
    /// Depth of each object: boxes or masks as COCO JSON, YOLO .txt, CSV (x0,y0,x1,y1[,label[,name]], or in any order below a line of names) or a label image .png, in pixels of the
    /// rectified left image before --width. For a sequence also a folder with a file per frame.
    #[arg(long, value_name = "FILE")]
    objects: Option<PathBuf>,
    /// Names of the classes of a YOLO file, one per line [default: classes.txt or obj.names beside it].
    #[arg(long, value_name = "FILE", requires = "objects")]
    classes: Option<PathBuf>,
    /// Match in and just around the objects alone: their depths are those of the whole frame, the rest costs nothing. In a sequence the first
    /// pair is matched as a whole, to see how far the rows are apart.
    #[arg(long, requires = "objects")]
    only_objects: bool,
}

/// Depths of a frame's objects.
#[derive(Debug, Default)]
pub(super) struct Asked {
    /// In the order of the file.
    pub(super) list: Vec<(Object, listing::Object)>,
    pub(super) skipped: Skipped,
    /// The folder holds no file of this frame.
    pub(super) no_file: bool,
    /// Why there is no list.
    pub(super) error: Option<String>,
}

impl ObjectArgs {
    /// Is a depth per object asked for?
    pub(super) fn is_given(&self) -> bool {
        self.objects.is_some()
    }

    /// Refuses what holds no objects of any of these images, by names alone: before the first of them is matched.
    pub(super) fn check<'a>(&self, mut images: impl Iterator<Item = &'a Path>) -> Result<()> {
        let Some(path) = &self.objects else { return Ok(()) };
        let folder = path.display();
        if !path.is_dir() {
            std::fs::metadata(path).map_err(|error| ObjectsError::Read(path.clone(), error))?;
        } else if !images.any(|image| file_of(path, image).is_some()) {
            bail!(
                "{folder} holds no file that is called like a left image, such as left.json beside left.png; add or rename them"
            );
        }
        Ok(())
    }

    /// The depths of the objects of the pair that was matched last; `None` when nobody asked.
    pub(super) fn depths(&self, setup: &Setup<'_>, image: &Path, engine: &mut Engine) -> Option<Asked> {
        let path = self.objects.as_deref()?;
        let no_file = path.is_dir() && file_of(path, image).is_none();
        let objects = match self.read(path, setup, image) {
            Ok(objects) => objects,
            Err(error) => return Some(Asked { error: Some(error.to_string()), ..Asked::default() }),
        };
        let dims = setup.dims();
        let regions: Vec<_> = objects.list.iter().filter_map(|object| object.region(dims).ok()).collect();
        let depths = engine.objects(&regions);
        // A file gives regions that lie in the image: there is one for every object.
        let list = objects.list.iter().zip(&depths);
        let list = list.map(|(object, depth)| (object.clone(), listing::Object::new(depth, object.name.as_deref())));
        Some(Asked { list: list.collect(), skipped: objects.skipped, no_file, ..Asked::default() })
    }

    /// Where the next pair is to be matched; `None` is everywhere.
    pub(super) fn areas(&self, setup: &Setup<'_>, image: &Path) -> Option<Vec<Area>> {
        let path = self.objects.as_deref().filter(|_| self.only_objects)?;
        let objects = self.read(path, setup, image).ok()?; // what is wrong is said with the depths
        let dims = setup.dims();
        Some(objects.list.iter().filter_map(|object| Some(object.region(dims).ok()?.area())).collect())
    }

    /// The same as a board is asked for them.
    pub(super) fn boxes(&self, setup: &Setup<'_>, image: &Path) -> Result<Option<Vec<(Object, RegionBox)>>> {
        let Some(path) = &self.objects else { return Ok(None) };
        let (objects, dims) = (self.read(path, setup, image)?, setup.dims());
        let mut boxes = Vec::new();
        for (object, label) in objects.list.into_iter().zip(0..) {
            let region = object.region(dims)?;
            if region.shape() != Shape::Box || boxes.len() == MAX_REGIONS {
                bail!("a board is asked for up to {MAX_REGIONS} boxes, {} has others; leave out --on", path.display());
            }
            let asked = RegionBox::from((label, region.area()));
            boxes.push((object, asked));
        }
        Ok(Some(boxes))
    }

    fn read(&self, path: &Path, setup: &Setup<'_>, image: &Path) -> Result<regions::Objects, ObjectsError> {
        let name = image.file_name().map(|name| name.to_string_lossy());
        let frame = Frame { given: setup.given, matched: setup.dims(), image_name: name.as_deref() };
        if !path.is_dir() {
            return regions::load(path, self.classes.as_deref(), frame);
        }
        match file_of(path, image) {
            Some(file) => regions::load(&file, self.classes.as_deref(), frame),
            None => Ok(regions::Objects::default()),
        }
    }
}

/// The file of a frame in a folder: called like its left image. A dot in that name ends nothing.
fn file_of(folder: &Path, image: &Path) -> Option<PathBuf> {
    let stem = folder.join(image.file_stem().unwrap_or_default());
    EXTENSIONS.map(|extension| stem.with_added_extension(extension)).into_iter().find(|file| file.is_file())
}

impl Asked {
    /// Their depths by a board.
    pub(super) fn by_board(boxes: Vec<(Object, RegionBox)>, depths: &[ObjectDepth]) -> Self {
        let list = boxes.into_iter().zip(depths).map(|((object, _), depth)| {
            let label = object.label;
            let depth = listing::Object::new(&ObjectDepth { label, ..*depth }, object.name.as_deref());
            (object, depth)
        });
        Self { list: list.collect(), ..Self::default() }
    }

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
                (_, Some(z), _) => write!(
                    text,
                    "{z:.3} m, sigma {:.3} m, nearest {:.3} m",
                    object.sigma_m,
                    object.nearest_m.unwrap_or(z)
                ),
                (Some(d), None, _) => write!(text, "{d:.2} px, sigma {:.2} px", object.sigma_px),
                (None, None, reason) => write!(text, "{}", reason.unwrap_or("unknown")),
            };
            let _ = writeln!(text, ", {} segments, p = {:.2}", object.support, object.confidence);
        }
        if self.list.len() > MOST_LISTED {
            let _ = writeln!(text, "and {} more objects", self.list.len() - MOST_LISTED);
        }
        text + &self.skipped.summary()
    }
}
