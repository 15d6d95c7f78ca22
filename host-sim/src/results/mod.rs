//! Results of a pair: as JSON, CSV and text, as files of other programs, as directions, as outlines of objects.

pub mod directions;
mod disparity_map;
pub mod health;
pub mod listing;
pub mod outline;

pub use disparity_map::{KittiMap, kitti_png, pfm};
