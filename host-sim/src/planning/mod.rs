//! View and accuracy of two parallel cameras, before they are bought.
//!
//! In: focal length, image size, baseline, disparity range, how exact a disparity is. Out: near
//! limit, error and common view by distance, and the smallest baseline for a wanted range.
//!
//! ```text
//! disparity  d = f B / z                 f in px, B in m, z in m
//! near limit z = f B / d_max           d_max by Params::largest_disparity
//! error      z^2 / (f B) * sigma         first order; as a share of z: z sigma / (f B)
//! overlap    1 - d / width               share of each image's columns that the other camera sees too
//! ```
//!
//! With the baseline that just reaches the wanted error `e` at FAR, the disparity at NEAR is `FAR
//! sigma / (NEAR e)`: no lens and no resolution changes it, only the range, the error or `sigma`
//! do.
//!
//! # Source
//! Equations 5 and 12 of the chapter; Gallup et al., "Variable baseline/resolution stereo", CVPR
//! 2008, for the error.

mod advice;

pub use advice::{Suggestion, Wish, suggest};

use anyhow::{Result, anyhow, bail};
use core::ops::RangeInclusive;
use linestereo::image::{MAX_HEIGHT, MAX_WIDTH, MIN_SIDE};
use linestereo::{Dims, Params, Rig};

/// Usual standard deviation of a disparity, px.
pub const USUAL_SIGMA: f64 = 0.25;
/// Least and largest disparity range of the core.
pub const LEAST_RANGE: u16 = 8;
pub const MAX_RANGE: u16 = 256;
/// Standard deviations that make sense, px.
const SIGMAS: RangeInclusive<f64> = 0.001..=16.0;
/// Where the table has its rows within a power of ten.
const STEPS: [f64; 6] = [1.0, 1.5, 2.0, 3.0, 5.0, 7.0];
/// The table ends where the error is about this share of the distance.
const LAST_ERROR: f64 = 0.2;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Focal {
    Pixels(f64),
    /// As printed on a lens, with the side of a pixel of the images (that is, after binning).
    Millimetres {
        /// Of the lens, mm.
        focal: f64,
        /// µm.
        pixel: f64,
    },
    FieldOfView(f64),
}

impl Focal {
    /// px, for images of this width; anything where the field of view is none.
    pub fn pixels(self, dims: Dims) -> f64 {
        match self {
            Self::Pixels(focal) => focal,
            Self::Millimetres { focal, pixel } => 1000.0 * focal / pixel,
            Self::FieldOfView(degrees) => {
                0.5 * f64::from(dims.width) / (0.5 * degrees).to_radians().tan()
            }
        }
    }
}

/// A pair of parallel cameras that could be built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigPlan {
    /// Focal length, px.
    pub focal: f64,
    /// Size of the rectified images.
    pub dims: Dims,
    pub baseline: f64,
    /// End of the disparities that are searched, px.
    pub max_disparity: u16,
    /// Standard deviation of a disparity, px.
    pub sigma: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Row {
    pub distance_m: f64,
    pub disparity_px: f64,
    /// One standard deviation, m.
    pub error_m: f64,
    /// The same in percent of the distance.
    pub error_percent: f64,
    /// Percent of the width that both cameras see.
    pub overlap_percent: f64,
}

impl RigPlan {
    /// Checks focal length (px), baseline (m), disparity range and standard deviation of a
    /// disparity (px).
    pub fn new(
        focal: f64,
        dims: Dims,
        baseline: f64,
        max_disparity: u16,
        sigma: f64,
    ) -> Result<Self> {
        Rig::new(focal as f32, baseline as f32, 0.0)?;
        if !(MIN_SIDE..=MAX_WIDTH).contains(&dims.width)
            || !(MIN_SIDE..=MAX_HEIGHT).contains(&dims.height)
        {
            bail!("images of {dims} are outside {MIN_SIDE}x{MIN_SIDE} to {MAX_WIDTH}x{MAX_HEIGHT}");
        }
        Params { max_disparity, ..Params::DEFAULT }
            .check(dims)
            .map_err(|error| anyhow!("{error}; change --max-disparity"))?;
        if !SIGMAS.contains(&sigma) {
            bail!("a standard deviation of {sigma} px is outside 0.001 to 16");
        }
        Ok(Self { focal, dims, baseline, max_disparity, sigma })
    }

    /// Horizontal and vertical field of view of the rectified images, degrees.
    pub fn fields_of_view(&self) -> [f64; 2] {
        [self.dims.width, self.dims.height]
            .map(|side| 2.0 * (0.5 * f64::from(side) / self.focal).atan().to_degrees())
    }

    pub fn disparity(&self, distance: f64) -> f64 {
        self.focal * self.baseline / distance
    }

    /// Largest disparity that is found, px.
    fn largest_disparity(&self) -> f64 {
        Params::largest_disparity(self.max_disparity).to_num()
    }

    /// Nothing nearer than this is found, m.
    pub fn near_limit(&self) -> f64 {
        self.disparity(self.largest_disparity())
    }

    /// Nearer than this the cameras see nothing in common, m.
    pub fn meeting(&self) -> f64 {
        self.disparity(f64::from(self.dims.width))
    }

    /// One standard deviation of depth at a distance, m.
    pub fn error(&self, distance: f64) -> f64 {
        distance * distance / (self.focal * self.baseline) * self.sigma
    }

    /// Distance up to which the error stays below this share of it, m.
    pub fn reach(&self, share: f64) -> f64 {
        share * self.focal * self.baseline / self.sigma
    }

    /// Share of the width that both cameras see at a distance.
    pub fn overlap(&self, distance: f64) -> f64 {
        (1.0 - self.disparity(distance) / f64::from(self.dims.width)).max(0.0)
    }

    pub fn row(&self, distance: f64) -> Row {
        let error = self.error(distance);
        Row {
            distance_m: distance,
            disparity_px: self.disparity(distance),
            error_m: error,
            error_percent: 100.0 * error / distance,
            overlap_percent: 100.0 * self.overlap(distance),
        }
    }

    /// From the near limit in even steps to where the error is a fifth of the distance, or to the
    /// farthest distance wanted.
    pub fn table(&self, wish: Option<&Wish>) -> Vec<Row> {
        let near = self.near_limit();
        let far = self.reach(LAST_ERROR).max(near);
        let far = wish.map_or(far, |wish| far.min(2.0 * wish.far).max(wish.far));
        let wanted = wish.map(|wish| [wish.near, wish.far]);
        let mut distances = vec![near];
        distances.extend(wanted.iter().flatten().filter(|&&distance| distance > near));
        distances.extend(
            (-4..=6)
                .flat_map(|power| STEPS.map(|step| step * 10_f64.powi(power)))
                .filter(|&distance| distance > 1.05 * near && distance <= far)
                // Not beside a distance that is wanted.
                .filter(|distance| {
                    wanted.iter().flatten().all(|wanted| (distance / wanted - 1.0).abs() > 0.05)
                }),
        );
        distances.sort_by(f64::total_cmp);
        distances.into_iter().map(|distance| self.row(distance)).collect()
    }
}
