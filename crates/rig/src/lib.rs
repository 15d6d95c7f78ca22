//! Geometry of a stereo rig for linestereo: two calibrated cameras and the pose between them, and
//! raw frames -> rectified rows.
//!
//! In: cameras and pose, once, in floating point. Out: a [`Rig`](linestereo::Rig) for
//! [`Params`](linestereo::Params), and rectified rows, in integers. Not needed by firmware whose
//! frames are rectified already.
//!
//! ```text
//! once, f64, on a PC:    Calibration (two cameras, the pose between them)
//!                     -> Rectification (one virtual camera: directions, focal length, centre)
//!                     -> Remap (raw positions of rectified ones), also as the bytes of a RigImage
//! once, f32, on a board: Remap
//!                     -> Mesh, one per camera (raw positions of every 16th pixel, raw rows
//!                         needed by each row)
//! per raw row, integers: Band (the raw rows needed at once) -> rectified rows
//! ```
#![no_std]
#![deny(unsafe_code)]
#![deny(missing_debug_implementations)]
#![warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod calibration;
mod camera;
#[doc(hidden)] // used for packets too
pub mod checksum;
mod grid;
#[doc(hidden)] // compared with each other by tests and on boards; no version keeps them
pub mod kernel;
mod mesh;
mod nodes;
mod real;
mod rectification;
mod remap;
mod rig_image;
mod rows;
mod turn;

pub use calibration::{Calibration, CalibrationError, CameraSide};
pub use camera::{Camera, CameraError, Lens, MAX_TANGENT, check_raw_dims};
pub use mesh::{Mesh, MeshError};
pub use nodes::{fine_mesh_nodes, mesh_nodes};
pub use rectification::{Rectification, RectifyError, View};
pub use remap::{Remap, RemapCamera};
pub use rig_image::{RigImage, RigImageError, RigImageHead};
pub use rows::{Band, RowError};
pub use turn::rotation_matrix;

/// The example of the package's page.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
