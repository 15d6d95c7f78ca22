//! Captured frames: image files, folders of pairs in every common layout, ground truth, area resampling, perturbations.

mod decode;
mod disparity_file;
mod layouts;
mod numpy;
mod perturb;
pub mod registry;
mod resample;
mod scene;
mod sequence;
mod stored;
mod truth;

pub(crate) use decode::load_values;
pub use decode::{check_size, check_usable, load_gray};
pub use disparity_file::{DisparityFault, load_disparities};
pub use layouts::{Dataset, Layout, LayoutFault};
pub use perturb::Perturbation;
pub(crate) use perturb::SplitMix64;
pub use resample::{area_average, resampled_height};
pub use scene::{Scene, SceneInfo, find_pairs, find_scenes, has_truth, load_scene, scaled_max_disparity};
pub use sequence::{PairFiles, Sequence, SequencePair};
pub use stored::{StoredPair, halves};
pub use truth::Truth;

use core::fmt;
use linestereo::image::MAX_WIDTH;
use linestereo::image::ViewError;
use linestereo::{Dims, RigError};
use std::io;
use std::path::{Path, PathBuf};

/// Why frames cannot be used: one line that says what is wrong and what to do.
#[derive(Debug)]
pub enum FrameError {
    /// The file cannot be read.
    Read(PathBuf, io::Error),
    /// The file is not a PNG, JPEG or PNM image, or it is damaged.
    Decode(PathBuf, String),
    /// A file of disparities or a mask is not grey.
    ColouredTruth(PathBuf),
    /// The image is smaller or larger than the core accepts.
    Size(PathBuf, ViewError),
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
    Width {
        /// Width of the image.
        have: u16,
        /// Width asked for.
        asked: u16,
    },
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
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Read(path, error) => write!(f, "cannot read {}: {error}; check the path", path.display()),
            Self::Decode(path, what) => {
                write!(f, "{} is not a readable image ({what}); give a PNG, JPEG, PGM or PPM file", path.display())
            }
            Self::ColouredTruth(path) => {
                write!(f, "{} is coloured; ground truth and masks are 8 or 16-bit grey", path.display())
            }
            Self::Size(path, error) => {
                let too_large = matches!(error, ViewError::Dims(dims) if dims.width.max(dims.height) > MAX_WIDTH);
                let what = if too_large { "reduce it with --width" } else { "give a larger one" };
                write!(f, "{}: {error}; {what}", path.display())
            }
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
            Self::Width { have, asked } => {
                write!(f, "--width {asked} is not between 1 and the image's {have}; images are only ever reduced")
            }
            Self::SceneFile(path, what) => write!(f, "{} is not a scene file ({what}); correct it", path.display()),
            Self::Rig(path, error) => write!(f, "{}: {error}; correct \"rectified\"", path.display()),
            Self::NoImage(folder, name) => {
                write!(f, "{} holds no {name}.png, .jpg, .pgm or .ppm; add the image", folder.display())
            }
            Self::Disparities(path, fault) => write!(f, "{}: {fault}", path.display()),
            Self::Layout(path, fault) => write!(f, "{}: {fault}", path.display()),
        }
    }
}

impl core::error::Error for FrameError {}

/// Both images have the same size.
pub fn check_same_size(first: (&Path, Dims), second: (&Path, Dims)) -> Result<(), FrameError> {
    if first.1 == second.1 {
        return Ok(());
    }
    Err(FrameError::SizesDiffer { first: (first.0.to_path_buf(), first.1), second: (second.0.to_path_buf(), second.1) })
}
