//! Input: images, folders of pairs in every common layout with their truth, rigs of every format, what detectors found.
//!
//! ```text
//! folder, sequence, datasets   which pairs are there, by names and small text files alone: `StoredPair`; the same for every command
//! decode, grey, disparity_file image files as grey; files of disparities
//! rig_file, interchange        calibrated rigs: our own file, and those of OpenCV, Kalibr, ROS, EuRoC
//! recording, video             pairs in a file of ROS 2; in videos, and of a camera
//! stored                       a pair loaded: rectified, reduced, with truth and rig of one size: `Scene`
//! perturb                      the same pair with a known fault
//! regions                      boxes and masks of objects
//! registry                     pairs that package registries carry
//! ```

mod datasets;
mod decode;
mod disparity_file;
mod error;
mod filmed;
mod folder;
mod grey;
pub mod interchange;
mod layout;
mod numpy;
mod perturb;
mod recorded;
pub mod recording;
pub mod rectify;
pub mod regions;
pub mod registry;
mod resample;
pub mod rig_file;
mod scene_file;
mod scene_info;
mod sequence;
mod stored;
mod truth;
pub mod video;

pub use datasets::Dataset;
pub use decode::{check_same_size, check_size, check_usable, load_gray, load_images, load_values};
pub use disparity_file::load_disparities;
pub use error::{DisparityFault, FrameError, LayoutFault};
pub use folder::find_scenes;
pub use layout::Layout;
pub use perturb::Perturbation;
pub(crate) use perturb::{SplitMix64, blur};
pub use resample::{area_average, halves, resampled_height};
pub use scene_file::{has_truth, load_scene};
pub use scene_info::SceneInfo;
pub(crate) use scene_info::check_baseline;
pub use sequence::PairFiles;
pub(crate) use sequence::{SIDES, without_side};
pub use stored::{Scene, StoredPair, scaled_max_disparity};
pub use truth::Truth;
