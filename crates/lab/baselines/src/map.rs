//! Result of every method: a disparity and a confidence per pixel, or none.

use linestereo::{Confidence, Dims, Disparity, Point};

/// Disparities of the left image's pixels.
#[derive(Clone, Debug)]
pub struct DisparityMap {
    dims: Dims,
    disparity: Vec<f32>,
    confidence: Vec<f32>,
}

impl DisparityMap {
    /// A map that knows nothing.
    #[must_use]
    pub fn empty(dims: Dims) -> Self {
        let count = usize::from(dims.width) * usize::from(dims.height);
        Self { dims, disparity: vec![f32::NAN; count], confidence: vec![0.0; count] }
    }

    /// A map of these disparities in px, row-major, NaN where there is none. All confidences are 0.
    #[must_use]
    pub fn of_values(dims: Dims, values: impl IntoIterator<Item = f32>) -> Self {
        let mut map = Self::empty(dims);
        for (value, given) in map.disparity.iter_mut().zip(values) {
            *value = given;
        }
        map
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

    /// Disparity of a pixel in px; `None` where there is none.
    #[must_use]
    pub fn at(&self, x: usize, y: usize) -> Option<f32> {
        let value = *self.disparity.get(self.index(x, y))?;
        (x < usize::from(self.dims.width) && value.is_finite()).then_some(value)
    }

    /// Confidence of a pixel's disparity, 0 ..= 1. Not a probability.
    #[must_use]
    pub fn confidence(&self, x: usize, y: usize) -> f32 {
        self.confidence[self.index(x, y)]
    }

    /// Pixels with a disparity.
    #[must_use]
    pub fn count(&self) -> usize {
        self.disparity.iter().filter(|d| d.is_finite()).count()
    }

    pub(crate) fn set(&mut self, x: usize, y: usize, disparity: f32, confidence: f32) {
        let index = self.index(x, y);
        self.disparity[index] = disparity;
        self.confidence[index] = confidence;
    }

    /// The map as points of the core, one per known pixel. Disparities are rounded to 1/64 px.
    #[must_use]
    pub fn points(&self) -> Vec<Point> {
        let width = usize::from(self.dims.width);
        let known = self.disparity.iter().enumerate().filter(|(_, d)| d.is_finite());
        let points = known.map(|(index, &disparity)| Point {
            x: (index % width) as u16,
            y: (index / width) as u16,
            disparity: Disparity::saturating_from_num(disparity),
            confidence: Confidence::saturating_from_num(self.confidence[index]),
            source: linestereo::Source::Side,
        });
        points.collect()
    }

    fn index(&self, x: usize, y: usize) -> usize {
        y * usize::from(self.dims.width) + x
    }
}
