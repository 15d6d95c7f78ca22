//! Calibrated stereo rigs on a PC.
//!
//! ```text
//! boards        photos of a board -> corners -> cameras, pose and their spread -> what they are
//!               worth
//! rig_file      `rig.toml`, which keeps a rig
//! interchange   rigs of OpenCV, Kalibr, ROS and EuRoC, read and written
//! rectify       raw pairs -> rectified ones, to the bytes of a board
//! ```

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests read what they wrote"))]

#[cfg(feature = "boards")]
pub mod boards;
pub mod interchange;
pub mod rectify;
pub mod rig_file;

pub use rectify::{PairRectifier, rectify_raw};

/// The example of the package's page.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
