//! Rigs from and for other programs: OpenCV, Kalibr, ROS, EuRoC, and our own `rig.toml` by the same
//! door.
//!
//! In: unchecked files. Out: a [`RigFile`], what had to be assumed, and errors with lines. The
//! convention of each format stands at the head of its module; all become `X_right = R X_left + t`
//! in metres.
//!
//! # Bounds
//! A file has at most 1 MiB, 16 levels and 100 000 values, those behind YAML aliases counted; XML
//! has no document type, so no entities of its own. A matrix has at most 16 values.

mod camera;
mod error;
mod euroc;
mod kalibr;
mod names;
mod node;
mod opencv;
mod pose;
mod ros;
mod xml;
mod yaml;

pub use camera::LensModel;
pub use error::{InterchangeError, Problem};

use crate::rig_file::RigFile;
use core::fmt;
use error::{Fault, Place};
use linestereo::Dims;
use linestereo_frames::RigText;
use linestereo_frames::rectified::{check_baseline, check_centre_of, check_focal};
use linestereo_frames::untrusted::{self, SETTINGS_BYTES};
use linestereo_rig::{Calibration, CameraSide};
use node::Node;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A format of rigs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Format {
    /// Our own.
    RigToml,
    /// `cv::FileStorage` as YAML: one file, or intrinsics and extrinsics, or one for each camera
    /// and one for the pose.
    OpencvYaml,
    /// The same as XML.
    OpencvXml,
    /// `camchain.yaml`.
    Kalibr,
    /// Two `camera_info` files.
    Ros,
    /// Two `sensor.yaml` files.
    Euroc,
}

impl Format {
    /// Number of files that are written.
    #[must_use]
    pub fn files(self) -> usize {
        if matches!(self, Self::Ros | Self::Euroc) { 2 } else { 1 }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::RigToml => "rig.toml",
            Self::OpencvYaml => "OpenCV YAML",
            Self::OpencvXml => "OpenCV XML",
            Self::Kalibr => "Kalibr camchain",
            Self::Ros => "ROS camera_info",
            Self::Euroc => "EuRoC sensor.yaml",
        })
    }
}

/// Unit of lengths in an OpenCV file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TranslationUnit {
    /// 1 m.
    Metres,
    /// 1 mm.
    Millimetres,
    /// A square of the board the cameras were calibrated with.
    Squares {
        /// Its side.
        millimetres: f64,
    },
}

/// Numbers that a file may leave open.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// The format, where it is not told from the content.
    pub from: Option<Format>,
    /// Size of the raw images; needed where the file lacks it, an error where it differs.
    pub size: Option<Dims>,
    /// Size of the images at hand: taken where neither the file nor `size` says it.
    pub images: Option<Dims>,
    /// Unit of OpenCV's `T`; else that of `square_size` in the file, else metres below 5,
    /// millimetres above. An error for other formats, which have a unit.
    pub translation_unit: Option<TranslationUnit>,
    /// Meaning of OpenCV's coefficients where the file lacks it, else radial-tangential; an error
    /// where it differs, and for other formats, which say it.
    pub lens: Option<LensModel>,
    /// The second camera of foreign files is the left one.
    pub swap: bool,
}

/// A rectification that an OpenCV file carries, for [`Calibration::rectify_as`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoredRectification {
    /// From left and right camera coordinates to rectified ones (`R1`, `R2`), by rows.
    pub rotations: [[[f64; 3]; 3]; 2],
    /// Focal length of both rectified images, px.
    pub focal: f64,
    /// Centre of both rectified images, px.
    pub centre: [f64; 2],
}

/// A rig from files, and what is to be said about it.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The rig.
    pub rig: RigFile,
    /// Format of the files.
    pub format: Format,
    /// The rectification in them, if there is one that fits.
    pub stored: Option<StoredRectification>,
    /// Assumptions and omissions, a sentence each.
    pub notes: Vec<String>,
}

/// A rig as the files of a format.
#[derive(Clone, Debug)]
pub struct Exported {
    /// One text for each file, the left camera's first.
    pub texts: Vec<String>,
    /// Properties that the format has no place for, a sentence each.
    pub notes: Vec<String>,
}

/// Reads a rig from one or more files of one format, which is told from what they hold.
pub fn load_rig(paths: &[PathBuf], options: &Options) -> Result<Imported, InterchangeError> {
    let is_toml = |path: &PathBuf| {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
    };
    let texts = paths.iter().enumerate().map(|(file, path)| read_text(path, file));
    let texts = texts.collect::<Result<Vec<_>, _>>().map_err(|fault| named(paths, fault))?;
    let is_own = paths.first().is_some_and(is_toml)
        || texts.first().is_some_and(|text| looks_like_toml(text));
    let read = if options.from == Some(Format::RigToml) || (options.from.is_none() && is_own) {
        own(paths, options)
    } else {
        foreign(&texts, options)
    };
    read.map_err(|fault| named(paths, fault))
}

fn named(paths: &[PathBuf], Fault { place, problem }: Fault) -> InterchangeError {
    let path = place.and_then(|place| paths.get(place.file)).or(paths.first());
    let line = place.map(|place| place.line).filter(|&line| line > 0);
    InterchangeError { path: path.cloned().unwrap_or_default(), line, problem }
}

/// The same, of texts that are no files of their own too.
pub fn load_rig_texts(rig: &[RigText], options: &Options) -> Result<Imported, InterchangeError> {
    let paths: Vec<PathBuf> = rig.iter().map(|rig| rig.path.clone()).collect();
    let Some(texts) = rig.iter().map(|rig| rig.text.clone()).collect::<Option<Vec<String>>>()
    else {
        return load_rig(&paths, options);
    };
    // Its lines are in no file.
    let unlined = |fault| InterchangeError { line: None, ..named(&paths, fault) };
    foreign(&texts, options).map_err(unlined)
}

/// Refuses cameras whose numbers are not of their images, or not in px. The images of ROS may be
/// part of those that the principal point is of.
fn check_cameras(calibration: &Calibration, format: Format) -> Result<(), Fault> {
    for eye in CameraSide::BOTH {
        let camera = calibration.camera(eye);
        let ([fx, fy], dims) = (camera.focal(), camera.dims());
        let unfit = |unfit| Problem::Unfit(eye, unfit).anywhere();
        check_focal(fx, dims.width).map_err(unfit)?;
        if format != Format::Ros {
            check_centre_of(camera.centre(), dims).map_err(unfit)?;
        }
        if !(0.5..=2.0).contains(&(fx / fy)) {
            return Err(Problem::PixelShape(eye, fx, fy).anywhere());
        }
    }
    check_baseline(calibration.baseline()).map_err(|unfit| Problem::Window(unfit).anywhere())
}

/// A rig as the texts of the files of a format.
pub fn export(rig: &RigFile, to: Format) -> Result<Exported, Problem> {
    let calibration = &rig.calibration;
    let texts = match to {
        Format::RigToml => vec![rig.text()],
        Format::OpencvYaml => vec![opencv::yaml(calibration)?],
        Format::OpencvXml => vec![opencv::xml(calibration)?],
        Format::Kalibr => vec![kalibr::text(calibration)?],
        Format::Ros => ros::text(calibration)?.to_vec(),
        Format::Euroc => euroc::text(calibration)?.to_vec(),
    };
    let mut notes = Vec::new();
    if to != Format::RigToml && rig.quality.is_some() {
        notes
            .push("how well the calibration fits its photos is not written: the format has no place for it".to_owned());
    }
    let skewed = CameraSide::BOTH.iter().any(|&eye| calibration.camera(eye).skew() != 0.0);
    if skewed && matches!(to, Format::OpencvYaml | Format::OpencvXml | Format::Ros) {
        notes.push("the skew is written, but most programs take no notice of it".to_owned());
    }
    Ok(Exported { texts, notes })
}

fn own(paths: &[PathBuf], options: &Options) -> Result<Imported, Fault> {
    let [path] = paths else { return Err(file_count(Format::RigToml, "one file")) };
    let rig = RigFile::load(path).map_err(|error| Problem::RigFile(error).anywhere())?;
    check_options(&rig.calibration, Format::RigToml, options)?;
    check_cameras(&rig.calibration, Format::RigToml)?;
    let notes = if options.swap {
        vec!["a rig.toml says which camera is the left one: they are not exchanged".to_owned()]
    } else {
        Vec::new()
    };
    Ok(Imported { rig, format: Format::RigToml, stored: None, notes })
}

fn foreign(texts: &[String], options: &Options) -> Result<Imported, Fault> {
    let is_xml = |text: &String| text.trim_start().starts_with('<');
    let parse = |(file, text): (usize, &String)| {
        if is_xml(text) { xml::parse(text, file) } else { yaml::parse(text, file) }
    };
    let nodes = texts.iter().enumerate().map(parse).collect::<Result<Vec<_>, _>>()?;
    let Some(first) = nodes.first() else {
        return Err(file_count(Format::OpencvYaml, "at least one file"));
    };
    let format = match options.from {
        Some(format) => format,
        None if texts.first().is_some_and(is_xml) => Format::OpencvXml,
        None => detect(first),
    };
    let mut notes = Vec::new();
    let mut stored = None;
    let calibration = match (format, nodes.as_slice()) {
        (Format::Kalibr, [chain]) => kalibr::read(chain, options.swap, &mut notes)?,
        (Format::Kalibr, _) => return Err(file_count(format, "one file")),
        (Format::Ros, [left, right]) => ros::read([left, right], options.swap)?,
        (Format::Euroc, [left, right]) => euroc::read([left, right], options.swap)?,
        (Format::Ros | Format::Euroc, _) => {
            return Err(file_count(
                format,
                "two files, the left camera's and then the right one's",
            ));
        }
        (Format::RigToml | Format::OpencvYaml | Format::OpencvXml, _) => {
            let read = opencv::read(&nodes, options)?;
            (stored, notes) = (read.stored, read.notes);
            read.calibration
        }
    };
    check_options(&calibration, format, options)?;
    check_cameras(&calibration, format)?;
    Ok(Imported { rig: RigFile { calibration, quality: None }, format, stored, notes })
}

fn file_count(format: Format, needed: &'static str) -> Fault {
    let format = match format {
        Format::RigToml => "a rig.toml",
        Format::Kalibr => "a Kalibr camchain",
        Format::Ros => "ROS camera_info",
        Format::Euroc => "EuRoC",
        Format::OpencvYaml | Format::OpencvXml => "OpenCV",
    };
    Problem::FileCount { format, needed }.anywhere()
}

/// Refuses options that contradict the files, or that only files of OpenCV need.
fn check_options(
    calibration: &Calibration,
    format: Format,
    options: &Options,
) -> Result<(), Fault> {
    let file = calibration.camera(CameraSide::Left).dims();
    let is_opencv = matches!(format, Format::OpencvYaml | Format::OpencvXml);
    match *options {
        Options { size: Some(given), .. } if given != file => {
            Err(Problem::SizeDiffers { file, given }.anywhere())
        }
        Options { lens: Some(_), .. } if !is_opencv => Err(Problem::Stated("--lens").anywhere()),
        Options { translation_unit: Some(_), .. } if !is_opencv => {
            Err(Problem::Stated("--translation-unit").anywhere())
        }
        _ => Ok(()),
    }
}

/// By the names that only one format has.
fn detect(node: &Node) -> Format {
    if node.get("cam0").is_some_and(|camera| camera.get("camera_model").is_some()) {
        Format::Kalibr
    } else if node.get("T_BS").is_some() {
        Format::Euroc
    } else if ros::is_camera_info(node) {
        Format::Ros
    } else {
        Format::OpencvYaml
    }
}

/// `rig.toml` under another name: its first line of meaning is a table or `name = value`.
fn looks_like_toml(text: &str) -> bool {
    let mut lines =
        text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.next().is_some_and(|line| {
        ["[left]", "[right]", "[pose]"].contains(&line)
            || line.split_once('=').is_some_and(|(name, _)| name.trim() == "version")
    })
}

fn read_text(path: &Path, file: usize) -> Result<String, Fault> {
    let place = |problem: Problem| Fault { place: Some(Place { file, line: 0 }), problem };
    let bytes = untrusted::read(path, SETTINGS_BYTES).map_err(|error| {
        place(if error.kind() == ErrorKind::FileTooLarge {
            Problem::TooLarge
        } else {
            Problem::Read(error)
        })
    })?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..valid].iter().filter(|byte| **byte == b'\n').count();
        Problem::NoText.at(Place { file, line })
    })?;
    Ok(text.strip_prefix('\u{feff}').map_or_else(|| text.clone(), str::to_owned))
}
