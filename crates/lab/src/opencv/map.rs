//! Result of a dense method: a disparity for each pixel, or none.

use linestereo::units::{Confidence, Disparity};
use linestereo::{Dims, results::Point};

/// Disparities of the left image's pixels.
#[derive(Clone, Debug)]
pub struct DisparityMap {
    dims: Dims,
    disparity: Vec<f32>,
}

impl DisparityMap {
    /// A map of these disparities in px, row-major, NaN where there is none.
    #[must_use]
    pub fn new(dims: Dims, disparity: Vec<f32>) -> Self {
        Self { dims, disparity }
    }

    /// Width and height.
    #[must_use]
    pub fn dims(&self) -> Dims {
        self.dims
    }

    /// Disparity of each pixel in px, row-major; NaN where there is none.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.disparity
    }

    /// The map as points of the core, one per known pixel, of confidence 0. Disparities are rounded
    /// to 1/64 px.
    #[must_use]
    pub fn points(&self) -> Vec<Point> {
        let width = usize::from(self.dims.width);
        let known = self.disparity.iter().enumerate().filter(|(_, d)| d.is_finite());
        let points = known.map(|(index, &disparity)| Point {
            x: (index % width) as u16,
            y: (index / width) as u16,
            disparity: Disparity::saturating_from_num(disparity),
            confidence: Confidence::ZERO,
            source: linestereo::results::Source::Side,
        });
        points.collect()
    }
}
