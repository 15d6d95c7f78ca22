//! Images drawn in the test, and repeatable random numbers.

use linestereo::Dims;
use linestereo_frames::GrayImage;
use linestereo_sim::scene::{self, Kind, Rendering, Sensor};

/// The image whose pixel `x, y` is `grey(x, y)`.
pub fn painted(width: u16, height: u16, mut grey: impl FnMut(u16, u16) -> u8) -> GrayImage {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| grey(x, y)).collect();
    GrayImage { dims: Dims { width, height }, pixels }
}

/// A built-in scene as both cameras see it: the seed is that of places, textures and of noise with this standard deviation.
#[must_use]
pub fn rendered(kind: Kind, dims: Dims, noise: f64, seed: u64) -> Rendering {
    scene::render(&scene::build(kind, dims, seed), dims, &Sensor { noise, seed, ..Sensor::default() })
}

/// The pixels with `padding` bytes after every row, filled with `fill`, and the distance between rows.
#[must_use]
pub fn with_padding(image: &GrayImage, padding: usize, fill: u8) -> (Vec<u8>, usize) {
    let width = usize::from(image.dims.width);
    let rows = image.pixels.chunks(width.max(1));
    (rows.flat_map(|row| [row.to_vec(), vec![fill; padding]]).flatten().collect(), width + padding)
}

/// A small generator of repeatable random numbers (SplitMix64).
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number from 0 to `limit - 1`.
    pub fn below(&mut self, limit: u64) -> u64 {
        self.bits() % limit.max(1)
    }

    /// A position in a list of this length; 0 for an empty list.
    pub fn index(&mut self, length: usize) -> usize {
        self.below(length as u64) as usize
    }

    /// From `low` to `high`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.bits() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// Of mean 0 and standard deviation 1 (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform(1e-12, 1.0), self.uniform(0.0, 1.0));
        (-2.0 * u.ln()).sqrt() * (core::f64::consts::TAU * v).cos()
    }

    /// A random grey.
    pub fn grey(&mut self) -> u8 {
        self.below(256) as u8
    }
}
