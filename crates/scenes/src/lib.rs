//! Synthetic rectified stereo scenes with exact ground truth.
//!
//! In: flat surfaces in metres with procedural textures, a pinhole pair, a sensor. Out: the two
//! images, and for every pixel centre of the left one its disparity, its surface and whether the
//! right camera sees the same point: all by casting rays at the geometry, nothing is resampled, so
//! edges have a sub-pixel truth.
//!
//! The same scene and seed give the same bytes on every machine: only `+ - * /`, `sqrt` and `floor`
//! on f64 and integer hashes are used, never sines or other functions whose last bit belongs to a
//! platform's library.

#![forbid(unsafe_code)]

mod builtin;
mod edges;
mod geometry;
mod render;
mod texture;

pub use builtin::{Kind, build};
pub use edges::{DisparityPlane, EdgeCase};
pub use geometry::{Pair, Surface, Vector};
pub use render::{Rendering, Sensor, render};
pub use texture::{Pattern, Texture};

/// Surfaces in front of a pair of cameras.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The cameras.
    pub pair: Pair,
    /// Surfaces that they see; where nothing is hit the image is black and has no truth.
    pub surfaces: Vec<Surface>,
    /// Names of the objects: label `n` is entry `n - 1`.
    pub objects: Vec<&'static str>,
}
