//! Stereo pairs on disk: images, folders of pairs in every common layout with their truth, and what
//! detectors found.
//!
//! ```text
//! untrusted          files of others: how much of one is read
//! grey               8-bit grey images; values as files store them
//! matched_pair       a pair with its images and memory, for questions that come later
//! resample, perturb  the same image smaller, or with a known fault
//! decode             image files as grey
//! disparity_file     files of disparities: PFM, NumPy, images of 16 bits
//! folder, sequence   which files of a folder are pairs, by their names
//! datasets           pairs in the layouts of data sets: a `StoredPair` each
//! stored             a pair loaded: rectified, reduced, with truth and rig of one size: a `Scene`
//! regions            boxes and masks of objects
//! ```
//!
//! Pairs that are in no files of their own, messages of a recording and frames of a video, come in
//! through [`PairSource`].

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests read what they wrote"))]

pub mod grey;
mod matched_pair;
mod resample;

#[cfg(feature = "files")]
mod datasets;
#[cfg(feature = "files")]
mod decode;
#[cfg(feature = "files")]
mod disparity_file;
#[cfg(feature = "files")]
mod error;
#[cfg(feature = "files")]
mod folder;
#[cfg(feature = "files")]
mod layout;
#[cfg(feature = "files")]
mod numpy;
#[cfg(feature = "files")]
mod perturb;
#[cfg(feature = "files")]
pub mod rectified;
#[cfg(feature = "files")]
pub mod regions;
#[cfg(feature = "files")]
mod scene_file;
#[cfg(feature = "files")]
mod scene_info;
#[cfg(feature = "files")]
mod sequence;
#[cfg(feature = "files")]
mod source;
pub mod statistics;
#[cfg(feature = "files")]
mod stored;
#[cfg(feature = "files")]
mod truth;
#[cfg(feature = "files")]
pub mod untrusted;

pub use grey::GrayImage;
pub use matched_pair::{MatchError, MatchedPair, PairBuffers, memory};
pub use resample::{WidthError, area_average, halves, resampled_height};

#[cfg(feature = "files")]
pub use self::{
    datasets::{Dataset, layouts},
    decode::{
        PixelBytes, UPRIGHT, check_same_size, check_size, check_usable, exif_turn, load_gray,
        load_images, load_values,
    },
    disparity_file::load_disparities,
    error::{DisparityFault, EXIF_REMEDY, FrameError, LayoutFault},
    folder::find_scenes,
    layout::Layout,
    perturb::{Perturbation, SplitMix64, blur},
    rectified::{RectifiedRig, SentWindow, Unfit},
    scene_file::{has_truth, load_scene},
    scene_info::SceneInfo,
    sequence::{PairFiles, SIDES, without_side},
    source::{PairSource, Views},
    stored::{
        RectifiedPair, RectifyRaw, RigText, Scene, StoredPair, StoredRig, scaled_max_disparity,
    },
    truth::Truth,
};

/// The example of the package's page.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
