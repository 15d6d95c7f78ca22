//! Pixels and depths -> points in space: x right, y down, z forward, in metres, from the left camera of a rectified pair.

use linestereo::Dims;

/// What turns pixels into directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinhole {
    /// Focal length, px.
    pub focal: f64,
    /// Principal point, px; whole numbers are pixel centres.
    pub centre: [f64; 2],
}

impl Pinhole {
    /// The middle of an image: where the principal point lies as long as nobody knows better.
    #[must_use]
    pub fn middle(dims: Dims) -> [f64; 2] {
        [dims.width, dims.height].map(|side| 0.5 * (f64::from(side) - 1.0))
    }

    /// A position of an image in that image reduced by `scale`.
    #[must_use]
    pub fn scaled(position: [f64; 2], scale: f64) -> [f64; 2] {
        position.map(|value| (value + 0.5) * scale - 0.5)
    }

    /// The point at this depth, in metres, that is seen at this position, in px.
    #[must_use]
    pub fn point(&self, [x, y]: [f64; 2], depth: f64) -> [f64; 3] {
        [(x - self.centre[0]) * depth / self.focal, (y - self.centre[1]) * depth / self.focal, depth]
    }
}
