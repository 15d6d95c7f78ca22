//! Results of a pair: as JSON, CSV and text, as files of other programs, as directions, as as
//! messages of ROS 2.

pub mod directions;
pub mod ground;
pub mod health;
pub mod listing;
pub mod mask;
mod point_map;
pub mod ros;

pub use point_map::{PngMap, depth_npy, depth_png, kitti_png, pfm};
