//! Errors of a calibration file, with the line they stand on.

use crate::rig_file::RigFileError;
use core::fmt;
use linestereo::Dims;
use linestereo_frames::Unfit;
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
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The file cannot be read.
    #[error("cannot be read: {}; check the name and its permissions", .0.kind())]
    Read(io::Error),
    /// Larger than 1 MiB.
    #[error(
        "is larger than 1 MiB, too large for a calibration; give the file that holds only the \
         results"
    )]
    TooLarge,
    /// Not UTF-8.
    #[error("is no UTF-8 text; give a YAML, XML or rig.toml file")]
    NoText,
    /// Neither YAML nor XML: what the parser says.
    #[error("{0}; repair the file or write it anew")]
    Syntax(String),
    /// Nested deeper than any calibration is.
    #[error("is nested too deep for a calibration")]
    TooDeep,
    /// More values than any calibration has, or aliases that multiply.
    #[error("holds too many values for a calibration")]
    TooManyValues,
    /// A name stands twice.
    #[error("\"{0}\" appears twice; remove one of them")]
    Duplicate(String),
    /// No format that is known.
    #[error(
        "is in no known calibration format (OpenCV, Kalibr, ROS, EuRoC, rig.toml); name its format \
         with --from"
    )]
    UnknownFormat,
    /// Not as many files as the format consists of.
    #[error("{format} takes {needed}")]
    FileCount {
        /// Of this format.
        format: &'static str,
        /// Their number.
        needed: &'static str,
    },
    /// Something is not there.
    #[error("{0}")]
    Missing(String),
    /// Several values that differ could be meant.
    #[error("{0}; remove the wrong one")]
    Ambiguous(String),
    /// A value is no number.
    #[error("{name} is \"{text}\", no number")]
    NotANumber {
        /// Name of the value.
        name: String,
        /// The text that stands there.
        text: String,
    },
    /// A value is infinite or "not a number".
    #[error("{0} is not finite; calibrate anew")]
    NotFinite(String),
    /// A matrix has other sides than it must have, or not as many values as its sides say.
    #[error("{name} is {found}, it must be {expected}")]
    Shape {
        /// Name of the matrix.
        name: String,
        /// The sides that it must have.
        expected: String,
        /// The sides that it has.
        found: String,
    },
    /// A matrix is no rotation (rows that are not perpendicular unit vectors within 0.001, or a
    /// mirror image).
    #[error("{0} is no rotation")]
    NoRotation(String),
    /// The camera matrix has no form `fx s cx, 0 fy cy, 0 0 1`.
    #[error("{0} must have the form [fx s cx; 0 fy cy; 0 0 1]; correct it")]
    NoCameraMatrix(String),
    /// Lens coefficients that this program does not model are not zero.
    #[error(
        "lens coefficients {names} are not zero and not modelled; calibrate with k1 k2 p1 p2 k3, \
         with k4 k5 k6 too, or as fisheye"
    )]
    Coefficients {
        /// Their names.
        names: String,
    },
    /// A model of camera or lens that this program does not have.
    #[error("{0}; calibrate as pinhole with radial-tangential or equidistant lens")]
    Model(String),
    /// The projections do not put the cameras side by side.
    #[error("{0}")]
    Projection(String),
    /// No size of the images, neither in the file nor as an option.
    #[error(
        "does not say the size of the images; make a rig that says it: linestereo convert-rig FILES \
         --size WxH --out rig.toml (the size of your photos, about {0:.0}x{1:.0} by the optical \
         centre)",
        .guess[0], .guess[1]
    )]
    NoSize {
        /// About the size that the optical centre suggests.
        guess: [f64; 2],
    },
    /// The size given as an option is not the one in the file.
    #[error(
        "was made for images of {file}, not {given}; leave --size out or calibrate at that size"
    )]
    SizeDiffers {
        /// In the file.
        file: Dims,
        /// As an option.
        given: Dims,
    },
    /// An option for what the files say themselves.
    #[error("{0} is for files that do not say it, and this one does; leave {0} out")]
    Stated(&'static str),
    /// The size of the images is none.
    #[error("the size of the images is {0}")]
    Size(String),
    /// A camera is none.
    #[error("{0} camera: {1}")]
    Camera(CameraSide, CameraError),
    /// A camera's numbers are not those of its images.
    #[error("{0} camera: {1}")]
    Unfit(CameraSide, Unfit),
    /// Binning, region, or their images do not fit.
    #[error("{0}")]
    Window(Unfit),
    /// Focal lengths across and down of which one is more than twice the other.
    #[error(
        "{0} camera: focal lengths of {1} and {2} px cannot be of one lens; correct the wrong one"
    )]
    PixelShape(CameraSide, f64, f64),
    /// The cameras are no pair.
    #[error("{0}")]
    Pair(CalibrationError),
    /// The first camera is the right one.
    #[error(
        "the second camera lies to the left of the first: if it is the left camera, give its file \
         first where it has one, or use convert-rig --swap, and swap the images too; otherwise the \
         pose is inverted, or its sign is wrong"
    )]
    Swapped,
    /// The first camera is the left one, though it is said not to be.
    #[error(
        "the second camera lies to the right of the first, so the first is the left one; leave \
         --swap out"
    )]
    NotSwapped,
    /// `rig.toml` itself is wrong.
    #[error("{0}")]
    RigFile(RigFileError),
    /// The rig cannot be written in a format.
    #[error(
        "{format} has no place for {what}; write rig-toml{others}{more}",
        others = if *.format == "OpenCV" { "" } else { ", or opencv-yaml" },
        more = if .what.ends_with("coefficient k3") { LEAVE_OUT_K3 } else { "" }
    )]
    NotRepresentable {
        /// The format.
        format: &'static str,
        /// Name of what the format has no place for.
        what: &'static str,
    },
    /// The rig cannot be rectified, which a format needs.
    #[error("{0}")]
    Rectify(RectifyError),
}

const LEAVE_OUT_K3: &str = ", or leave it out from the start: linestereo calibrate --fix-k3";

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
