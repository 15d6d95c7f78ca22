//! Results as files of other programs: coloured geometry (PLY), disparity maps (KITTI's PNG, PFM).

mod disparity_map;
mod ply;

pub use disparity_map::{KittiMap, kitti_png, pfm};
pub use ply::ply;
