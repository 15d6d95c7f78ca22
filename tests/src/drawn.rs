//! Images drawn in the test, and random numbers.

use linestereo::Dims;
use linestereo_frames::{GrayImage, Scene, Truth};
use linestereo_sim::scene::{self, Kind, Rendering, Sensor};
use std::path::PathBuf;

/// The image whose pixel `x, y` is `grey(x, y)`.
pub fn painted(width: u16, height: u16, mut grey: impl FnMut(u16, u16) -> u8) -> GrayImage {
    let pixels = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| grey(x, y))
        .collect();
    GrayImage { dims: Dims { width, height }, pixels }
}

/// A built-in scene as both cameras see it: the seed is that of places, textures and of noise with
/// this standard deviation.
pub fn rendered(kind: Kind, dims: Dims, noise: f64, seed: u64) -> Rendering {
    rendered_by(kind, dims, seed, &Sensor { noise, seed, ..Sensor::default() })
}

/// The same by this sensor: the seed is that of places and textures.
pub fn rendered_by(kind: Kind, dims: Dims, seed: u64, sensor: &Sensor) -> Rendering {
    scene::render(&scene::build(kind, dims, seed), dims, sensor)
}

/// Scenes of three kinds, with noise.
pub fn scenes(dims: Dims) -> impl Iterator<Item = Rendering> {
    [Kind::Demo, Kind::Boxes, Kind::Corridor]
        .into_iter()
        .map(move |kind| rendered(kind, dims, 1.5, 7))
}

/// A rendered pair as one with truth, without a rig, whose range is 64 px.
pub fn with_truth(pair: Rendering) -> Scene {
    Scene {
        name: "drawn".to_owned(),
        folder: PathBuf::new(),
        truth: Some(Truth::new(pair.left.dims, pair.disparity, pair.visible)),
        left: pair.left,
        right: pair.right,
        max_disparity: 64,
        rig: None,
        rig_numbers: None,
    }
}

/// Random grey levels at the corners of cells of 3 px, smooth between them.
#[derive(Debug)]
pub struct Texture(Vec<f64>);

impl Texture {
    /// Cells along each side before the texture repeats.
    const SIDE: usize = 256;

    /// Of the generator with this seed.
    pub fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        Self((0..Self::SIDE * Self::SIDE).map(|_| f64::from(random.grey())).collect())
    }

    /// The grey level at a position, px.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let (u, v) = (x / 3.0 + 40.0, y / 3.0 + 40.0);
        let (i, j) = (u.floor(), v.floor());
        // The cubic whose slope is zero at the corners.
        let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
        let (fu, fv) = (smooth(u - i), smooth(v - j));
        let corner =
            |i: f64, j: f64| self.0[j as usize % Self::SIDE * Self::SIDE + i as usize % Self::SIDE];
        let row = |j: f64| corner(i, j) * (1.0 - fu) + corner(i + 1.0, j) * fu;
        row(j) * (1.0 - fv) + row(j + 1.0) * fv
    }
}

/// Both images of a surface, exactly: its disparity in column 0 of each row, and by how much it
/// grows from column to column.
pub fn surface(
    dims: Dims,
    seed: u64,
    in_column_0: impl Fn(f64) -> f64,
    across: f64,
) -> [GrayImage; 2] {
    let texture = Texture::new(seed);
    [false, true].map(|is_right| {
        painted(dims.width, dims.height, |x, y| {
            let (x, y) = (f64::from(x), f64::from(y));
            let column = if is_right { (x + in_column_0(y)) / (1.0 - across) } else { x };
            texture.at(column, y).round() as u8
        })
    })
}

/// Names and images of what is hard on a matcher: noise, checkerboards, columns and rows of these
/// widths, diagonals, no texture at all.
pub fn hard_images(dims: Dims, widths: &[u16]) -> Vec<(String, GrayImage)> {
    let Dims { width, height } = dims;
    let mut random = Random(6);
    let mut images = vec![("noise".to_owned(), painted(width, height, |_, _| random.grey()))];
    for &of in widths {
        type Place = fn(u16, u16) -> u16;
        let patterns: [(&str, Place); 3] =
            [("checkerboard", |x, y| x + y), ("columns", |x, _| x), ("rows", |_, y| y)];
        for (name, place) in patterns {
            let is_dark = |x: u16, y: u16| place(x / of, y / of).is_multiple_of(2);
            let image = painted(width, height, |x, y| if is_dark(x, y) { 0 } else { 255 });
            images.push((format!("{name} {of}"), image));
        }
    }
    images.push(("diagonals".to_owned(), painted(width, height, |x, y| ((x + y) * 9) as u8)));
    let plain = [("grey", 128), ("white", 255)];
    images.extend(plain.map(|(name, grey)| (name.to_owned(), painted(width, height, |_, _| grey))));
    images
}

/// The pixels with `padding` bytes after every row, filled with `fill`, and the distance between
/// rows.
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
