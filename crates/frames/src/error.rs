//! Errors of frames on disk, each as one line that says what is wrong and what to do.

use super::layout::Layout;
use crate::resample::WidthError;
use crate::untrusted::printable;
use crate::untrusted::{IMAGE_BYTES, PIXELS};
use core::fmt;
use linestereo::image::{MAX_WIDTH, ViewError};
use linestereo::{Dims, RigError};
use std::io;
use std::path::PathBuf;

/// Names of arrays that a message lists.
const LISTED: usize = 8;

/// Why frames cannot be used: one line that says what is wrong and what to do.
#[derive(Debug)]
pub enum FrameError {
    /// The file cannot be read.
    Read(PathBuf, io::Error),
    /// The file is no image of a format that is read, or it is damaged.
    Decode(PathBuf, String),
    /// A file of disparities or a mask is not grey.
    ColouredTruth(PathBuf),
    /// The image is smaller or larger than the core accepts.
    Size(PathBuf, ViewError),
    /// The image has more pixels, or bytes of pixels, than are read.
    TooLarge(PathBuf),
    /// Two images that belong together differ in size.
    SizesDiffer {
        /// One file.
        first: (PathBuf, Dims),
        /// The other.
        second: (PathBuf, Dims),
    },
    /// Every pixel has the same value.
    Uniform(PathBuf, u8),
    /// Nearly every pixel is at one end of the scale.
    Saturated {
        /// The image.
        path: PathBuf,
        /// Share of its pixels at that end, in percent.
        percent: f64,
        /// Value of that end.
        value: u8,
    },
    /// The asked width is not smaller than the image, or 0.
    Width(WidthError),
    /// `scene.json` is not what it should be.
    SceneFile(PathBuf, String),
    /// The rig in `scene.json` is unusable.
    Rig(PathBuf, RigError),
    /// A folder holds no image of this name.
    NoImage(PathBuf, &'static str),
    /// A file of disparities is damaged or something else.
    Disparities(PathBuf, DisparityFault),
    /// A folder is in no known layout, or something in it is missing.
    Layout(PathBuf, LayoutFault),
    /// A recording or a video, or an image in it, is not taken.
    Source(PathBuf, Box<dyn core::error::Error + Send + Sync>),
    /// A frame of a video that cannot be decoded: its number, and why.
    VideoFrame(PathBuf, usize, String),
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read(path, error) => write!(f, "cannot read {}: {error}; check the path", path.display()),
            Self::Decode(path, what) => {
                write!(
                    f,
                    "{} is not a readable image ({what}); give a PNG, JPEG, PGM, PPM, TIFF, BMP or WebP file",
                    path.display()
                )
            }
            Self::ColouredTruth(path) => {
                write!(f, "{} is coloured; ground truth and masks are 8 or 16-bit grey", path.display())
            }
            Self::Size(path, error) => {
                let too_large = matches!(error, ViewError::Dims(dims) if dims.width.max(dims.height) > MAX_WIDTH);
                let what = if too_large { "reduce it with --width" } else { "give a larger one" };
                write!(f, "{}: {error}; {what}", path.display())
            }
            Self::TooLarge(path) => write!(
                f,
                "{}: an image of more than {} million pixels or {} MiB of them is not read; give a smaller one",
                path.display(),
                PIXELS / 1_000_000,
                IMAGE_BYTES >> 20
            ),
            Self::SizesDiffer { first, second } => write!(
                f,
                "{} is {} but {} is {}; give two images of one size",
                first.0.display(),
                first.1,
                second.0.display(),
                second.1
            ),
            Self::Uniform(path, value) => write!(
                f,
                "every pixel of {} is {value}, there is nothing to match; check the lens cap, the exposure and the file",
                path.display()
            ),
            Self::Saturated { path, percent, value } => write!(
                f,
                "{percent:.1} % of the pixels of {} are {value}; {} the exposure",
                path.display(),
                if *value == 0 { "raise" } else { "lower" }
            ),
            Self::Width(error) => error.fmt(f),
            Self::SceneFile(path, what) => write!(f, "{} is not a scene file ({what}); correct it", path.display()),
            Self::Rig(path, error) => write!(f, "{}: {error}; correct \"rectified\"", path.display()),
            Self::NoImage(folder, name) => {
                write!(f, "{} holds no {name}.png, .jpg, .pgm or .ppm; add the image", folder.display())
            }
            Self::Disparities(path, fault) => write!(f, "{}: {fault}", path.display()),
            Self::Layout(path, fault) => write!(f, "{}: {fault}", path.display()),
            Self::Source(path, fault) => write!(f, "{}: {fault}", path.display()),
            Self::VideoFrame(path, index, what) => {
                write!(f, "frame {index} of {}: {}", path.display(), printable(what))
            }
        }
    }
}

impl core::error::Error for FrameError {}

impl From<WidthError> for FrameError {
    fn from(error: WidthError) -> Self {
        Self::Width(error)
    }
}

/// Why a folder of a known layout cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LayoutFault {
    /// No layout fits.
    NotRecognised,
    /// A layout that has a calibration lacks its file.
    MissingCalibration(Layout),
    /// A calibration file lacks this, or it is no number.
    Calibration(&'static str),
    /// A raw pair cannot be rectified.
    RawRig(String),
    /// The values of a truth image of this size mean nothing known.
    TruthScale(Dims),
}

impl fmt::Display for LayoutFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotRecognised => f.write_str(
                "no pair in a layout that is known; give Middlebury, KITTI, ETH3D or EuRoC folders as downloaded, left/ and right/, \
                 0001_left.png and 0001_right.png, or images side by side",
            ),
            Self::MissingCalibration(layout) => write!(
                f,
                "the calibration is missing, which {layout} has; add the file from the data set's download, or rename the images to \
                 left.png and right.png to match them without depths"
            ),
            Self::Calibration(what) => write!(f, "{what} is missing or no number; take the file from the download again"),
            Self::RawRig(what) => write!(f, "the raw pair cannot be rectified by this calibration ({what}); correct it"),
            Self::TruthScale(dims) => write!(
                f,
                "nothing says what a grey value of this ground truth of {dims} is in px; store 16 bit (value / 256), PFM or NPZ, \
                 or add a scene.json with disparity_scale"
            ),
        }
    }
}

/// Error of a file of disparities.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DisparityFault {
    /// Its first lines are not those of a PFM file.
    Header(&'static str),
    /// It has three channels.
    Coloured,
    /// The line that tells the byte order holds 0 or no number.
    NoByteOrder(String),
    /// The values are absurd in the byte order that the file states, and plausible in the other one.
    ByteOrder {
        /// It says big endian.
        says_big: bool,
    },
    /// It ends too early.
    Truncated {
        /// Bytes of values that its size asks for.
        needed: u64,
        /// Those that are there.
        found: u64,
    },
    /// No pixel has a finite value.
    NothingKnown,
    /// An array of other than two dimensions, or too large.
    Shape(Vec<u64>),
    /// An array of something else than numbers.
    ElementType(String),
    /// The array or its archive cannot be read.
    Array(String),
    /// An archive holds several arrays and none by a known name, or none at all.
    Arrays(Vec<String>),
}

impl fmt::Display for DisparityFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Header(what) => write!(f, "it is no PFM file ({what}); it starts with Pf, width and height, scale"),
            Self::Coloured => write!(f, "it is a PFM file with three channels (PF); store one (Pf)"),
            Self::NoByteOrder(text) => {
                write!(f, "its third line is \"{text}\" and tells no byte order; write -1 (little endian) or 1 (big)")
            }
            Self::ByteOrder { says_big } => {
                let [said, is] = if *says_big { ["big", "little"] } else { ["little", "big"] };
                let sign = if *says_big { "negative" } else { "positive" };
                write!(f, "its third line says {said} endian, its values are {is} endian; make the scale {sign}")
            }
            Self::Truncated { needed, found } => {
                write!(f, "it ends after {found} of {needed} bytes of values; copy or download it again")
            }
            Self::NothingKnown => write!(f, "no pixel has a finite disparity; give another file, or remove it"),
            Self::Shape(shape) => write!(
                f,
                "an array of {shape:?} is no image that is read; store (height, width), at most {} million of them",
                PIXELS / 1_000_000
            ),
            Self::ElementType(name) => write!(f, "an array of {name} holds no disparities; store floats or integers"),
            Self::Array(what) => write!(f, "it cannot be read as NumPy's ({what}); store it again with numpy.save"),
            Self::Arrays(names) if names.is_empty() => write!(f, "it holds no array; store one with numpy.savez"),
            Self::Arrays(names) => {
                let (more, listed) = (names.len() > LISTED, &names[..names.len().min(LISTED)]);
                let list = listed.join(", ") + if more { ", ..." } else { "" };
                write!(f, "it holds the arrays {list}; call the one with disparities disp")
            }
        }
    }
}

impl core::error::Error for DisparityFault {}
