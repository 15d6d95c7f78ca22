//! Results of a pair: as JSON, CSV and text, as files of other programs, as directions, as outlines of objects.

pub mod directions;
pub mod health;
pub mod listing;
pub mod outline;
mod point_map;

pub use point_map::{PngMap, depth_npy, depth_png, kitti_png, pfm};
