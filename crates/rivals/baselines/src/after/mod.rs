//! Post-processing of a disparity map, after the chapter's list.
//!
//! Fractions by a parabola and by the equiangular fit, the uniqueness test and the left-right check read the curves of costs and so
//! stand with them, in [`super::Acceptance`]; here is what needs the map alone, or the map and both images.

mod fill;
mod gradient_descent;
mod median;
mod speckle;

pub use fill::{fill_from_neighbours, fill_surfaces};
pub use gradient_descent::descend;
pub use median::median;
pub use speckle::remove_speckles;

use super::map::DisparityMap;
use linestereo_frames::GrayImage;

/// A step with its usual parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AfterStep {
    /// Fractions by gradient descent on the squared differences of windows of 9x9 px.
    GradientDescent,
    /// The median of 5x5 px.
    Median,
    /// Patches of at most 100 px whose disparities differ by at most 1 px from pixel to pixel go.
    Speckle,
    /// Gaps take the farther of the nearest disparities to both sides.
    FillNeighbours,
    /// Gaps take a plane fitted to what surrounds them.
    FillSurface,
}

impl AfterStep {
    /// Every one, in the order in which they make sense together.
    pub const ALL: [Self; 5] =
        [Self::GradientDescent, Self::Speckle, Self::Median, Self::FillSurface, Self::FillNeighbours];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::GradientDescent => "gradient-descent",
            Self::Median => "median",
            Self::Speckle => "speckle",
            Self::FillNeighbours => "fill-neighbours",
            Self::FillSurface => "fill-surface",
        }
    }

    /// Does it.
    pub fn apply(self, map: &mut DisparityMap, left: &GrayImage, right: &GrayImage) {
        match self {
            Self::GradientDescent => descend(map, left, right, 4),
            Self::Median => median(map, 2),
            Self::Speckle => remove_speckles(map, 100, 1.0),
            Self::FillNeighbours => fill_from_neighbours(map),
            Self::FillSurface => fill_surfaces(map, 2),
        }
    }
}
