//! Errors of frames on disk, each as one line that says what is wrong and what to do.

use super::layout::Layout;
use crate::rectified::Unfit;
use crate::resample::WidthError;
use crate::untrusted::printable;
use crate::untrusted::{IMAGE_BYTES, PIXELS};
use linestereo::image::{MAX_WIDTH, ViewError};
use linestereo::{Dims, params::RigError};
use std::io;
use std::path::PathBuf;

/// Remedy for images that EXIF turns.
pub const EXIF_REMEDY: &str = "all images of a rig need the same orientation: remove the EXIF \
     orientation from all (exiftool -Orientation= FILES), or turn the pixels of all (mogrify \
     -auto-orient FILES)";
/// Names that a message lists.
const LISTED: usize = 8;

/// Why frames cannot be used: one line that says what is wrong and what to do.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// The file cannot be read.
    #[error("cannot read {0}: {1}; check the path")]
    Read(PathBuf, io::Error),
    /// The file is no image of a format that is read, or it is damaged.
    #[error(
        "{0} is not a readable image ({1}); give a PNG, JPEG, PGM, PPM, TIFF, BMP or WebP file"
    )]
    Decode(PathBuf, String),
    /// A file of disparities or a mask is no grey image of 8 or 16 bits.
    #[error(
        "{0} is coloured or holds floats; store ground truth and masks as 8 or 16-bit grey, float \
         disparities as PFM or NPY"
    )]
    NoTruth(PathBuf),
    /// The image is smaller or larger than the core accepts.
    #[error("{0}: {1}; {remedy}", remedy = remedy_of_size(.1))]
    Size(PathBuf, ViewError),
    /// The image has more pixels, or bytes of pixels, than are read.
    #[error(
        "{0}: the image has more than {pixels} million pixels or {mib} MiB of pixels; give a \
         smaller one",
        pixels = PIXELS / 1_000_000, mib = IMAGE_BYTES >> 20
    )]
    TooLarge(PathBuf),
    /// Two images that belong together differ in size.
    #[error(
        "{} is {} but {} is {}; give two images of one size",
        .first.0.display(), .first.1, .second.0.display(), .second.1
    )]
    SizesDiffer {
        /// One file.
        first: (PathBuf, Dims),
        /// The other.
        second: (PathBuf, Dims),
    },
    /// Every pixel has the same value.
    #[error(
        "every pixel of {0} is {1}, there is nothing to match; check the lens cap, the exposure \
         and the file"
    )]
    Uniform(PathBuf, u8),
    /// Nearly every pixel is at one end of the scale.
    #[error(
        "{percent:.1} % of the pixels of {path} are {value}; {change} the exposure",
        change = if *.value == 0 { "raise" } else { "lower" }
    )]
    Saturated {
        /// The image.
        path: PathBuf,
        /// Share of its pixels at that end, in percent.
        percent: f64,
        /// Value of that end.
        value: u8,
    },
    /// Values of 16 bits that the stated bits do not hold.
    #[error("values of {path} reach {largest}, which needs --bits {needed}, not {given}")]
    Bits {
        /// The image.
        path: PathBuf,
        /// Its largest value.
        largest: u16,
        /// Bits that hold it.
        needed: u32,
        /// Bits that were stated.
        given: u32,
    },
    /// The asked width is not smaller than the image, or 0.
    #[error(transparent)]
    Width(#[from] WidthError),
    /// `scene.json` is not what it should be.
    #[error("{0} is not a scene file ({1}); correct it")]
    SceneFile(PathBuf, String),
    /// The rig in `scene.json` is unusable.
    #[error("{0}: {1}; correct \"rectified\"")]
    Rig(PathBuf, RigError),
    /// A calibration that is not of rectified images, or not of these.
    #[error("{0}: {1}")]
    Unfit(PathBuf, Unfit),
    /// EXIF turns one image of a pair otherwise than the other one.
    #[error("EXIF turns {0} {1}, and {2} {3}; {EXIF_REMEDY}")]
    Turned(PathBuf, &'static str, PathBuf, &'static str),
    /// A folder holds no image of this name.
    #[error("{0} holds no {1}.png, .jpg, .pgm or .ppm; add the image")]
    NoImage(PathBuf, &'static str),
    /// A file of disparities is damaged or something else.
    #[error("{0}: {1}")]
    Disparities(PathBuf, DisparityFault),
    /// A folder is in no known layout, or something in it is missing.
    #[error("{0}: {1}")]
    Layout(PathBuf, LayoutFault),
    /// A recording or a video, or an image in it, is not taken.
    #[error("{0}: {1}")]
    Source(PathBuf, Box<dyn core::error::Error + Send + Sync>),
    /// A frame of a video that cannot be decoded: its number, and why.
    #[error("frame {1} of {0}: {what}", what = printable(.2))]
    VideoFrame(PathBuf, usize, String),
}

fn remedy_of_size(error: &ViewError) -> &'static str {
    let too_large =
        matches!(error, ViewError::Dims(dims) if dims.width.max(dims.height) > MAX_WIDTH);
    if too_large { "reduce it with --width" } else { "give a larger one" }
}

/// Why a folder of a known layout cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LayoutFault {
    /// No layout fits.
    #[error(
        "no pair was found in any known layout; give Middlebury, KITTI, ETH3D or EuRoC folders as \
         downloaded, left/ and right/, 0001_left.png and 0001_right.png, or, with --side-by-side, \
         images that hold both views"
    )]
    NotRecognised,
    /// A layout that has a calibration lacks its file.
    #[error(
        "the calibration is missing, which {0} has; add the file from the data set's download, or \
         rename the images to left.png and right.png to match them without depths"
    )]
    MissingCalibration(Layout),
    /// A calibration file lacks this, or it is no number.
    #[error("{0} is missing or no number; take the file from the download again")]
    Calibration(&'static str),
    /// A raw pair cannot be rectified.
    #[error("the raw pair cannot be rectified by this calibration ({0}); correct it")]
    RawRig(String),
    /// The values of a truth image of this size mean nothing known.
    #[error(
        "the disparity scale of this ground truth of {0} is unknown; store it as 16 bit (value / \
         256), PFM or NPZ, or add a scene.json with disparity_scale"
    )]
    TruthScale(Dims),
}

/// Error of a file of disparities.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DisparityFault {
    /// Its first lines are not those of a PFM file.
    #[error("it is no PFM file ({0}); it starts with Pf, width and height, scale")]
    Header(&'static str),
    /// It has three channels.
    #[error("it is a PFM file with three channels (PF); store one (Pf)")]
    Coloured,
    /// The line that tells the byte order holds 0 or no number.
    #[error(
        "its third line is \"{0}\" and gives no byte order; write -1 (little endian) or 1 (big)"
    )]
    NoByteOrder(String),
    /// The values are absurd in the byte order that the file states, and plausible in the other
    /// one.
    #[error(
        "its third line says {} endian, its values are {} endian; make the scale {}",
        if *.says_big { "big" } else { "little" },
        if *.says_big { "little" } else { "big" },
        if *.says_big { "negative" } else { "positive" }
    )]
    ByteOrder {
        /// It says big endian.
        says_big: bool,
    },
    /// It ends too early.
    #[error("it ends after {found} of {needed} bytes of values; copy or download it again")]
    Truncated {
        /// Bytes of values that its size asks for.
        needed: u64,
        /// Those that are there.
        found: u64,
    },
    /// No pixel has a finite value.
    #[error("no pixel has a finite disparity; give another file, or remove it")]
    NothingKnown,
    /// An array of other than two dimensions, or too large.
    #[error(
        "an array of shape {0:?} is not an image; store shape (height, width), with at most {most} \
         million values",
        most = PIXELS / 1_000_000
    )]
    Shape(Vec<u64>),
    /// An array of something else than numbers.
    #[error("an array of {0} holds no disparities; store floats or integers")]
    ElementType(String),
    /// The array or its archive cannot be read.
    #[error("it cannot be read as NumPy's ({0}); store it again with numpy.save")]
    Array(String),
    /// An archive holds several arrays and none by a known name, or none at all.
    #[error("{}", text_of_arrays(.0))]
    Arrays(Vec<String>),
}

fn text_of_arrays(names: &[String]) -> String {
    if names.is_empty() {
        return "it holds no array; store one with numpy.savez".to_owned();
    }
    format!("it holds the arrays {}; call the one with disparities disp", listed(names))
}

/// The first names of a list.
pub(crate) fn listed(names: &[String]) -> String {
    let more = if names.len() > LISTED { ", ..." } else { "" };
    names[..names.len().min(LISTED)].join(", ") + more
}
