//! Files of detectors -> regions of the left image as it is matched.
//!
//! In: boxes or masks in pixels of the left image as given. Out: [`Objects`], scaled to the image
//! as matched, with a label and a name each.
//!
//! | file | what is in it | label |
//! |---|---|---|
//! | `.png` | label image, 8 or 16 bit: value of its object, 0 none | the value |
//! | `.json` COCO | annotations or results: boxes, run lengths, polygons | position in the file |
//! | `.json` project | `objects` with `box` `[x0, y0, x1, y1)`, `name`, `label` | `label`, else position |
//! | `.txt` YOLO | a line per object: class, centre, size as shares of the image; or class and a polygon | position in the file |
//! | `.csv` | `x0,y0,x1,y1` and perhaps `label`, `name` below a line of names, or in this order | `label`, else position |
//!
//! Positions count from 0, and count objects that are skipped. What is wrong with the file as a
//! whole is an [`ObjectsError`]; what is wrong with one object skips it ([`Skipped`]): the others
//! are kept.
//!
//! # Bounds
//! At most [`MAX_OBJECTS`] objects, and for all of a file's masks and outlines together at most
//! [`MAX_RUNS`] runs or crossings of rows.

mod coco;
mod label_image;
mod polygon;
mod run_length;
mod table;
mod yolo;

use crate::error::{FrameError, listed};
use crate::untrusted::{self, OBJECTS_BYTES};
use core::fmt::Write;
use linestereo::objects::{RegionError, Run};
use linestereo::{Area, Dims, Region, image::Span};
use std::io;
use std::path::{Path, PathBuf};

/// Objects beyond so many are skipped: more than any detector reports, few enough for a page to
/// show.
pub const MAX_OBJECTS: usize = 4096;

/// Runs of all masks, and rows that edges of outlines cross, of one file: 4096 objects of a
/// thousand each. Objects beyond are skipped.
pub const MAX_RUNS: usize = 1 << 22;

/// Why a file gives no objects.
#[derive(Debug, thiserror::Error)]
pub enum ObjectsError {
    /// The file cannot be read.
    #[error("cannot read {0}: {1}; check the path")]
    Read(PathBuf, io::Error),
    /// Neither of the known kinds.
    #[error(
        "{0} is of no known kind; give COCO .json, YOLO .txt, .csv with x0,y0,x1,y1, or a label \
         image .png"
    )]
    Unknown(PathBuf),
    /// JSON that is broken, or not of COCO's form.
    #[error(
        "{0} holds no objects ({1}); give COCO annotations or results, or \"objects\" with boxes"
    )]
    Json(PathBuf, String),
    /// A table without the columns it needs, or broken.
    #[error(
        "{0} is no table of boxes ({1}); its first line has to name x0,y0,x1,y1 and perhaps \
         label,name"
    )]
    Table(PathBuf, String),
    /// A file of class names that is not text, or broken.
    #[error("{0} is no list of class names ({1}); give one name per line")]
    Classes(PathBuf, String),
    /// A label image that cannot be read, or coloured.
    #[error("{0}")]
    Image(FrameError),
    /// A label image of another size than the left image.
    #[error(
        "{path} is {mask}, the left image {image}; give a mask of the image as it is before \
         --width"
    )]
    MaskSize {
        /// The label image.
        path: PathBuf,
        /// Its size.
        mask: Dims,
        /// That of the left image as given.
        image: Dims,
    },
    /// A COCO file of an image of another size than the left image.
    #[error(
        "{path} is about an image of {}x{}, the left one is {image}; give objects of the image as \
         it is before --width",
        .size[0], .size[1]
    )]
    ImageSize {
        /// The COCO file.
        path: PathBuf,
        /// Width and height that it states.
        size: [u64; 2],
        /// That of the left image as given.
        image: Dims,
    },
    /// A COCO file of several images, none of which is called like the left one.
    #[error(
        "{path} holds objects of {images} images, none of them called {image}; correct its \
         \"file_name\""
    )]
    NoSuchImage {
        /// The COCO file.
        path: PathBuf,
        /// Path of the left image.
        image: String,
        /// Number of images in the file.
        images: usize,
    },
    /// A COCO file of several images that are called like the left one.
    #[error(
        "{path} holds several images whose \"file_name\" fits {image} alike: {}; write the folders \
         of the left image into it",
        listed(.candidates)
    )]
    SeveralImages {
        /// The COCO file.
        path: PathBuf,
        /// Path of the left image.
        image: String,
        /// Names of these images in the file.
        candidates: Vec<String>,
    },
}

/// Objects that were left out, by reason; and classes that have no name, whose objects are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// No pixel of it lies in the image.
    pub outside: usize,
    /// Without area.
    pub empty: usize,
    /// Numbers that are missing, or no numbers.
    pub unreadable: usize,
    /// Run lengths that are broken.
    pub broken_mask: usize,
    /// Run lengths of another size than the left image.
    pub mask_size: usize,
    /// Boxes within the first pixel, by fractions: shares of the image where pixels are asked for.
    pub shares: usize,
    /// Beyond [`MAX_OBJECTS`] or [`MAX_RUNS`].
    pub too_many: usize,
    /// Kept, without a name: its class is not in the list of names.
    pub unknown_class: usize,
}

impl Skipped {
    fn reasons(&self) -> [(usize, &'static str); 7] {
        [
            (self.outside, "outside of the image"),
            (self.empty, "without area"),
            (self.unreadable, "unreadable"),
            (self.broken_mask, "with broken run lengths"),
            (self.mask_size, "with a mask of another size"),
            (self.shares, "with shares of the image in place of pixels"),
            (self.too_many, "beyond 4096 objects or 4 million runs"),
        ]
    }

    /// Number of objects that were left out.
    pub fn objects(&self) -> usize {
        self.reasons().iter().map(|(count, _)| count).sum()
    }

    /// One line that says what was left out and why; empty when nothing was.
    pub fn summary(&self) -> String {
        let reasons = self.reasons().into_iter().filter(|(count, _)| *count > 0);
        let list: Vec<String> = reasons.map(|(count, why)| format!("{count} {why}")).collect();
        let mut text = String::new();
        if !list.is_empty() {
            let _ = writeln!(text, "objects skipped: {}", list.join(", "));
        }
        let unknown = self.unknown_class;
        if unknown > 0 {
            let _ = writeln!(text, "objects of unknown classes, without a name: {unknown}");
        }
        text
    }

    fn count(&mut self, why: Why) {
        *match why {
            Why::Outside => &mut self.outside,
            Why::Empty => &mut self.empty,
            Why::Unreadable => &mut self.unreadable,
            Why::BrokenMask => &mut self.broken_mask,
            Why::MaskSize => &mut self.mask_size,
            Why::Shares => &mut self.shares,
            Why::TooMuch => &mut self.too_many,
        } += 1;
    }
}

/// Why one object is skipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Why {
    Outside,
    Empty,
    Unreadable,
    BrokenMask,
    MaskSize,
    Shares,
    TooMuch,
}

impl Why {
    /// The fault and its cure; `unit` is that of numbers of the file.
    fn text(self, frame: &Frame<'_>, unit: &str) -> String {
        let given = frame.given;
        match self {
            Self::Outside => {
                format!("it lies outside of the left image, which is {given}; give {unit}")
            }
            Self::Empty => "it has no area; give left, top, right, bottom in this order".to_owned(),
            Self::Unreadable => "a number is missing or is none; correct it".to_owned(),
            Self::BrokenMask => "its run lengths are broken; write them again".to_owned(),
            Self::MaskSize => format!("its mask has another size; give one of {given}"),
            Self::Shares => format!("its numbers are shares of the image; give {unit}"),
            Self::TooMuch => "there are too many; give fewer".to_owned(),
        }
    }
}

/// Regions of one pair.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Objects {
    /// In the order of the file; those of a label image by value.
    pub list: Vec<Object>,
    /// Objects left out, with the reason.
    pub skipped: Skipped,
    /// The first of them: its line or position (from 0), what is wrong and what to do.
    pub first_skipped: Option<String>,
}

/// Something that a detector found.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Value in the mask, or position in the file.
    pub label: u16,
    /// Label of the detector.
    pub name: Option<String>,
    /// Its pixels.
    pub pixels: Pixels,
}

/// Pixels of an object in the image as matched.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// All of an area.
    Box(Area),
    /// Runs by row, then by column.
    Mask(Vec<Run>),
}

impl Object {
    /// The core's view of it.
    pub fn region(&self, dims: Dims) -> Result<Region<'_>, RegionError> {
        match &self.pixels {
            Pixels::Box(area) => Region::boxed(self.label, *area, dims),
            Pixels::Mask(runs) => Region::masked(self.label, runs, dims),
        }
    }
}

/// From which image to which.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Of the left image as given.
    pub given: Dims,
    /// Of the left image as matched.
    pub matched: Dims,
    /// Path of the left image, for files about several.
    pub image: Option<&'a Path>,
}

impl Frame<'_> {
    /// Of each column and row of the image as matched that of the image as given which lies in its
    /// middle.
    fn sources(&self) -> [Vec<u16>; 2] {
        let source = |index: u16, matched: u16, given: u16| {
            (((f64::from(index) + 0.5) * f64::from(given) / f64::from(matched)) as u16)
                .min(given - 1)
        };
        let all =
            |matched, given| (0..matched).map(|index| source(index, matched, given)).collect();
        [all(self.matched.width, self.given.width), all(self.matched.height, self.given.height)]
    }

    /// Matched over given.
    fn scale(&self) -> f64 {
        f64::from(self.matched.width) / f64::from(self.given.width)
    }
}

/// Reads objects. `classes` names the classes of a YOLO file; without it `classes.txt` or
/// `obj.names` beside the file does, if there is one.
pub fn load(
    path: &Path,
    classes: Option<&Path>,
    frame: Frame<'_>,
) -> Result<Objects, ObjectsError> {
    let extension =
        path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("png" | "pgm") => label_image::load(path, frame),
        Some("json") => coco::load(path, frame),
        Some("txt") => yolo::load(path, classes, frame),
        Some("csv") => table::load(path, frame),
        _ => Err(ObjectsError::Unknown(path.to_path_buf())),
    }
}

/// Boxes of a detector that are in no file: left, top, right and bottom border in pixels of the
/// image as given, and a name.
pub fn of_boxes(
    boxes: impl IntoIterator<Item = ([f64; 4], Option<String>)>,
    frame: Frame<'_>,
) -> Objects {
    let mut collector = Collector::new(frame);
    boxes
        .into_iter()
        .for_each(|(borders, name)| collector.put(Ok((Shape::Box(borders), name, None))));
    collector.objects
}

/// Collects objects in pixels of the image as given.
struct Collector<'a> {
    frame: Frame<'a>,
    objects: Objects,
    position: usize,
    /// Line of the next object, in files of lines.
    line: Option<u64>,
    /// Unit of its numbers.
    unit: &'static str,
    /// Runs that may still be made.
    runs_left: usize,
}

impl<'a> Collector<'a> {
    fn new(frame: Frame<'a>) -> Self {
        Self {
            frame,
            objects: Objects::default(),
            position: 0,
            line: None,
            unit: "pixels of that image, before --width",
            runs_left: MAX_RUNS,
        }
    }

    /// The next object of the file, or why it is none. A label that is given comes before its
    /// position.
    fn put(&mut self, found: Result<(Shape, Option<String>, Option<u16>), Why>) {
        let position = self.position;
        self.position += 1;
        let is_full = self.objects.list.len() >= MAX_OBJECTS;
        let found = found.and_then(|found| if is_full { Err(Why::TooMuch) } else { Ok(found) });
        let kept = found.and_then(|(shape, name, label)| {
            let pixels = shape.scaled(&self.frame, &mut self.runs_left)?;
            // Names go to terminals, tables and pages.
            Ok((pixels, name.map(|name| untrusted::printable(&name).into_owned()), label))
        });
        match kept {
            Err(why) => self.skip(position, why),
            Ok((pixels, name, label)) => match label.or(u16::try_from(position).ok()) {
                Some(label) => {
                    self.objects.list.push(Object { label, name, pixels: pixels.labelled(label) })
                }
                None => self.skip(position, Why::TooMuch),
            },
        }
    }

    fn skip(&mut self, position: usize, why: Why) {
        self.objects.skipped.count(why);
        let place = || {
            self.line.map_or_else(|| format!("object {position}"), |line| format!("line {line}"))
        };
        let said = || format!("{}: {}", place(), why.text(&self.frame, self.unit));
        self.objects.first_skipped = self.objects.first_skipped.take().or_else(|| Some(said()));
    }
}

impl Pixels {
    fn labelled(mut self, label: u16) -> Self {
        if let Self::Mask(runs) = &mut self {
            runs.iter_mut().for_each(|run| run.label = label);
        }
        self
    }
}

/// One object of a file, in pixels of the image as given.
#[derive(Clone, Debug, PartialEq)]
enum Shape {
    /// Left, top, right, bottom border: whole numbers are borders of pixels.
    Box([f64; 4]),
    /// Run lengths of the image as given, column by column.
    RunLengths(Vec<u64>),
    /// Corners of the parts of an outline, in the same positions as a box.
    Polygons(Vec<Vec<[f64; 2]>>),
}

impl Shape {
    /// Takes its number of runs from `runs_left`.
    fn scaled(self, frame: &Frame<'_>, runs_left: &mut usize) -> Result<Pixels, Why> {
        match self {
            Self::Box(borders) => scaled_box(borders, frame),
            Self::RunLengths(counts) => {
                let runs = run_length::runs(&counts, frame.given, *runs_left)?;
                *runs_left -= runs.len();
                masked(reduced_runs(&runs, frame))
            }
            Self::Polygons(parts) => {
                let scale = frame.scale();
                let parts: Vec<Vec<[f64; 2]>> = parts
                    .into_iter()
                    .map(|part| part.into_iter().map(|p| p.map(|v| v * scale)).collect())
                    .collect();
                polygon::check(&parts, frame.matched)?;
                *runs_left = runs_left
                    .checked_sub(polygon::crossings(&parts, frame.matched))
                    .ok_or(Why::TooMuch)?;
                masked(polygon::runs(&parts, frame.matched))
            }
        }
    }
}

fn masked(runs: Vec<Run>) -> Result<Pixels, Why> {
    if runs.is_empty() { Err(Why::Empty) } else { Ok(Pixels::Mask(runs)) }
}

/// Borders go to the nearest border of a pixel; what has an area keeps a pixel.
fn scaled_box(borders: [f64; 4], frame: &Frame<'_>) -> Result<Pixels, Why> {
    if borders.iter().any(|border| !border.is_finite()) {
        return Err(Why::Unreadable);
    }
    let [left, top, right, bottom] = borders.map(|border| border * frame.scale());
    if left >= right || top >= bottom {
        return Err(Why::Empty);
    }
    let (width, height) = (f64::from(frame.matched.width), f64::from(frame.matched.height));
    if right <= 0.0 || bottom <= 0.0 || left >= width || top >= height {
        return Err(Why::Outside);
    }
    let side = |from: f64, to: f64, limit: f64| {
        let (from, to) = (from.clamp(0.0, limit), to.clamp(0.0, limit));
        let start = from.round().min(limit - 1.0);
        (start as u16, to.round().max(start + 1.0) as u16)
    };
    let ((left, right), (top, bottom)) = (side(left, right, width), side(top, bottom, height));
    Ok(Pixels::Box(Area { left, top, right, bottom }))
}

/// Values of the image as given at the pixels of the image as matched: those that lie in the middle
/// of the latter.
fn reduced<T: Copy>(values: &[T], frame: &Frame<'_>) -> Vec<T> {
    let [columns, rows] = frame.sources();
    let width = usize::from(frame.given.width);
    let places = rows.iter().flat_map(|&row| {
        columns.iter().map(move |&column| usize::from(row) * width + usize::from(column))
    });
    places.map(|index| values[index]).collect()
}

/// The same of runs by row.
fn reduced_runs(runs: &[Run], frame: &Frame<'_>) -> Vec<Run> {
    let [columns, rows] = frame.sources();
    let column = |x: u16| columns.partition_point(|&source| source < x) as u16;
    let mut reduced: Vec<Run> = Vec::new();
    for (&row, y) in rows.iter().zip(0..) {
        let first = runs.partition_point(|run| run.y < row);
        for run in runs[first..].iter().take_while(|run| run.y == row) {
            let span = Span { start: column(run.span.start), end: column(run.span.end) };
            match reduced.last_mut() {
                _ if span.start >= span.end => {}
                Some(last) if last.y == y && last.span.end == span.start => {
                    last.span.end = span.end
                }
                _ => reduced.push(Run { label: run.label, y, span }),
            }
        }
    }
    reduced
}

fn read(path: &Path) -> Result<Vec<u8>, ObjectsError> {
    untrusted::read(path, OBJECTS_BYTES)
        .map_err(|error| ObjectsError::Read(path.to_path_buf(), error))
}
