//! A pair that things are pasted into.

use anyhow::{Context, Result};
use core::iter;
use linestereo::Dims;
use linestereo_frames::{GrayImage, Scene, SplitMix64};

/// Noise of both images, grey levels.
const NOISE: f64 = 2.0;
/// Largest difference of their gains.
const GAIN: f64 = 0.03;
/// Largest difference of their brightness, grey levels.
const BIAS: f64 = 3.0;

/// Pattern on a pole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pattern {
    Plain,
    Striped,
    Textured,
}

/// A pole as it was pasted.
#[derive(Clone, Debug)]
pub(crate) struct Pole {
    /// Across it, px.
    pub(crate) width: f64,
    /// Grey levels before what is behind it.
    pub(crate) contrast: f64,
    pub(crate) top: usize,
    /// Left edge of each row, px.
    pub(crate) starts: Vec<f64>,
    /// Along a row, px.
    pub(crate) wide: f64,
    /// Disparity of each row, px.
    pub(crate) disparities: Vec<f64>,
    /// Disparity behind it in each row, px.
    pub(crate) behind: Vec<f64>,
    pub(super) grey: f64,
    pub(super) middle: f64,
    pub(super) half: f64,
    pub(super) pattern: Pattern,
}

/// Subject of the pair that was pasted into.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Background {
    Photograph,
    /// A drawn wall with shading alone.
    Blank,
    /// A drawn wall with random texture.
    Textured,
    /// A drawn wall with vertical stripes.
    Striped,
    /// A drawn wall whose texture repeats.
    Wallpaper,
}

/// Both images as numbers, their truth, and what was pasted.
#[derive(Clone, Debug)]
pub(crate) struct PastedPair {
    pub(super) dims: Dims,
    /// Left and right, grey levels.
    pub(super) images: [Vec<f64>; 2],
    /// Disparities, px; not a number where unknown.
    pub(super) truth: Vec<f64>,
    /// Number of the thing that covers a pixel, from 1 on.
    pub(super) mask: Vec<u16>,
    /// End of the disparities searched, px.
    pub(crate) max_disparity: u16,
    pub(crate) background: Background,
    /// Name of the scene, or of the kind of wall.
    pub(crate) name: String,
    /// Poles, in the order of the numbers in the mask.
    pub(crate) poles: Vec<Pole>,
}

impl PastedPair {
    /// A pair of a scene with truth.
    pub(crate) fn of_scene(scene: &Scene) -> Result<Self> {
        let truth = scene.truth.as_ref().with_context(|| format!("{} has no truth", scene.name))?;
        let dims = scene.left.dims;
        let (width, height) = (i32::from(dims.width), i32::from(dims.height));
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let truth =
            places.map(|(x, y)| truth.disparity(x, y).map_or(f64::NAN, f64::from)).collect();
        let images = [&scene.left, &scene.right]
            .map(|image| image.pixels.iter().map(|&v| f64::from(v)).collect());
        Ok(Self::new(
            dims,
            images,
            truth,
            scene.max_disparity,
            (Background::Photograph, &scene.name),
        ))
    }

    pub(super) fn new(
        dims: Dims,
        images: [Vec<f64>; 2],
        truth: Vec<f64>,
        max_disparity: u16,
        (background, name): (Background, &str),
    ) -> Self {
        let mask = vec![0; truth.len()];
        Self {
            dims,
            images,
            truth,
            mask,
            max_disparity,
            background,
            name: name.to_owned(),
            poles: Vec::new(),
        }
    }
    pub(crate) fn width(&self) -> usize {
        self.dims.width.into()
    }

    pub(super) fn height(&self) -> usize {
        self.dims.height.into()
    }

    /// Truth of the columns `from .. to` of a row that have one.
    pub(super) fn truths(&self, y: usize, from: f64, to: f64) -> impl Iterator<Item = f64> + '_ {
        let width = self.width();
        let [from, to] = [from, to].map(|x| x.clamp(0.0, width as f64) as usize);
        self.truth[y * width + from..y * width + to.max(from)]
            .iter()
            .copied()
            .filter(|d| d.is_finite())
    }

    /// Both images as they are.
    pub(crate) fn stored(&self) -> [GrayImage; 2] {
        let dims = self.dims;
        self.images.each_ref().map(|values| GrayImage {
            dims,
            pixels: values.iter().map(|v| v.round() as u8).collect(),
        })
    }

    /// Both images with noise and another gain on the right, as cameras give them.
    pub(crate) fn captured(&self, random: &mut SplitMix64) -> [GrayImage; 2] {
        let gain = 1.0 + GAIN * (2.0 * random.uniform() - 1.0);
        let bias = BIAS * (2.0 * random.uniform() - 1.0);
        let [left, right] = &self.images;
        let right: Vec<f64> = right.iter().map(|v| v * gain + bias).collect();
        [left, &right].map(|values| {
            let normals = iter::repeat_with(|| random.normal_pair()).flatten();
            let noisy = values.iter().zip(normals).map(|(v, n)| (v + NOISE * n).round() as u8);
            GrayImage { dims: self.dims, pixels: noisy.collect() }
        })
    }
}

/// The value at this share of a list.
pub(super) fn percentile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    values.get((last as f64 * share).round() as usize).copied().unwrap_or(f64::NAN)
}

/// One of these.
pub(super) fn choose<T: Copy>(random: &mut SplitMix64, of: &[T]) -> T {
    of[((random.uniform() * of.len() as f64) as usize).min(of.len() - 1)]
}

pub(super) fn between(random: &mut SplitMix64, from: f64, to: f64) -> f64 {
    from + (to - from) * random.uniform()
}
