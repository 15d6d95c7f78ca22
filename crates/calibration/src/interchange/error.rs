//! Errors of a calibration file, with the line they stand on.

use crate::rig_file::RigFileError;
use core::fmt;
use linestereo::Dims;
use linestereo_rig::{CalibrationError, CameraError, CameraSide, RectifyError};
use std::io;
use std::path::PathBuf;

/// Why files give no rig.
#[derive(Debug)]
pub struct InterchangeError {
    /// The file at fault; the first one where the fault is between several.
    pub path: PathBuf,
    /// Line in it, from 1, where one line is at fault.
    pub line: Option<usize>,
    /// The error.
    pub problem: Problem,
}

impl fmt::Display for InterchangeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Problem::RigFile(error) = &self.problem {
            return error.fmt(f); // names its file and line itself
        }
        match self.line {
            Some(line) => write!(f, "{}, line {line}: {}", self.path.display(), self.problem),
            None => write!(f, "{}: {}", self.path.display(), self.problem),
        }
    }
}

impl core::error::Error for InterchangeError {}

/// The error, without its line.
#[derive(Debug)]
pub enum Problem {
    /// The file cannot be read.
    Read(io::Error),
    /// Larger than 1 MiB.
    TooLarge,
    /// Not UTF-8.
    NoText,
    /// Neither YAML nor XML: what the parser says.
    Syntax(String),
    /// Nested deeper than any calibration is.
    TooDeep,
    /// More values than any calibration has, or aliases that multiply.
    TooManyValues,
    /// A name stands twice.
    Duplicate(String),
    /// No format that is known.
    UnknownFormat,
    /// Not as many files as the format consists of.
    FileCount {
        /// Of this format.
        format: &'static str,
        /// Their number.
        needed: &'static str,
    },
    /// Something is not there.
    Missing(String),
    /// Several values that differ could be meant.
    Ambiguous(String),
    /// A value is no number.
    NotANumber {
        /// Name of the value.
        name: String,
        /// The text that stands there.
        text: String,
    },
    /// A value is infinite or "not a number".
    NotFinite(String),
    /// A matrix has other sides than it must have, or not as many values as its sides say.
    Shape {
        /// Name of the matrix.
        name: String,
        /// The sides that it must have.
        expected: String,
        /// The sides that it has.
        found: String,
    },
    /// A matrix is no rotation (rows that are not perpendicular unit vectors within 0.001, or a mirror image).
    NoRotation(String),
    /// The camera matrix has no form `fx s cx, 0 fy cy, 0 0 1`.
    NoCameraMatrix(String),
    /// Lens coefficients that this program does not model are not zero.
    Coefficients {
        /// Their names.
        names: String,
    },
    /// A model of camera or lens that this program does not have.
    Model(String),
    /// The projections do not put the cameras side by side.
    Projection(&'static str),
    /// No size of the images, neither in the file nor as an option.
    NoSize {
        /// About the size that the optical centre suggests.
        guess: [f64; 2],
    },
    /// The size given as an option is not the one in the file.
    SizeDiffers {
        /// In the file.
        file: Dims,
        /// As an option.
        given: Dims,
    },
    /// The size of the images is none.
    Size(String),
    /// A camera is none.
    Camera(CameraSide, CameraError),
    /// The cameras are no pair.
    Pair(CalibrationError),
    /// The first camera is the right one.
    Swapped,
    /// `rig.toml` itself is wrong.
    RigFile(RigFileError),
    /// The rig cannot be written in a format.
    NotRepresentable {
        /// The format.
        format: &'static str,
        /// Name of what the format has no place for.
        what: &'static str,
    },
    /// The rig cannot be rectified, which a format needs.
    Rectify(RectifyError),
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read(error) => write!(f, "cannot be read: {}; check the name and its permissions", error.kind()),
            Self::TooLarge => write!(f, "is larger than 1 MiB: no calibration; give the file with the results alone"),
            Self::NoText => write!(f, "is no UTF-8 text; give a YAML, XML or rig.toml file"),
            Self::Syntax(what) => write!(f, "{what}; repair the file or write it anew"),
            Self::TooDeep => write!(f, "is nested too deep for a calibration"),
            Self::TooManyValues => write!(f, "holds too many values for a calibration"),
            Self::Duplicate(name) => write!(f, "\"{name}\" stands twice; remove one of them"),
            Self::UnknownFormat => write!(
                f,
                "is no calibration that is known (OpenCV, Kalibr, ROS, EuRoC, rig.toml); name its format with --from"
            ),
            Self::FileCount { format, needed } => write!(f, "{format} takes {needed}"),
            Self::Missing(what) => write!(f, "{what}"),
            Self::Ambiguous(what) => write!(f, "{what}; remove what is not meant"),
            Self::NotANumber { name, text } => write!(f, "{name} is \"{text}\", no number"),
            Self::NotFinite(name) => write!(f, "{name} is not finite; calibrate anew"),
            Self::Shape { name, expected, found } => write!(f, "{name} is {found}, it must be {expected}"),
            Self::NoRotation(name) => write!(f, "{name} is no rotation"),
            Self::NoCameraMatrix(name) => write!(f, "{name} has no form [fx s cx; 0 fy cy; 0 0 1]"),
            Self::Coefficients { names } => write!(
                f,
                "lens coefficients {names} are not zero and not modelled; calibrate with k1 k2 p1 p2 k3 or as fisheye"
            ),
            Self::Model(what) => write!(f, "{what}; calibrate as pinhole with radial-tangential or equidistant lens"),
            Self::Projection(what) => write!(f, "{what}"),
            Self::NoSize { guess: [width, height] } => write!(
                f,
                "does not say the size of the images; give --size WxH (the optical centre suggests about \
                 {width:.0}x{height:.0})"
            ),
            Self::SizeDiffers { file, given } => {
                write!(f, "was made for images of {file}, not {given}; leave --size out or calibrate at that size")
            }
            Self::Size(what) => write!(f, "the size of the images is {what}"),
            Self::Camera(CameraSide::Left, error) => write!(f, "left camera: {error}"),
            Self::Camera(CameraSide::Right, error) => write!(f, "right camera: {error}"),
            Self::Pair(error) => write!(f, "{error}"),
            Self::Swapped => write!(
                f,
                "the second camera lies to the left of the first: convert-rig --swap makes it the left one, and so have its images to be"
            ),
            Self::RigFile(error) => write!(f, "{error}"),
            Self::NotRepresentable { format, what } => {
                write!(f, "{format} has no place for {what}; write rig-toml, or opencv-yaml")?;
                if what.ends_with("k3") {
                    write!(f, ", or leave it out from the start: linestereo calibrate --fix-k3")?;
                }
                Ok(())
            }
            Self::Rectify(error) => write!(f, "{error}"),
        }
    }
}

/// Where a value stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// Which of the files.
    pub(super) file: usize,
    /// Line, from 1; 0 is the file as a whole.
    pub(super) line: usize,
}

/// A problem before its file has a name.
#[derive(Debug)]
pub(super) struct Fault {
    /// `None`: what is missing has no place.
    pub(super) place: Option<Place>,
    pub(super) problem: Problem,
}

impl Problem {
    /// At this place.
    pub(super) fn at(self, place: Place) -> Fault {
        Fault { place: Some(place), problem: self }
    }

    /// Of the files as a whole.
    pub(super) fn anywhere(self) -> Fault {
        Fault { place: None, problem: self }
    }
}
