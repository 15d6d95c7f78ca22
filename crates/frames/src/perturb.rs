//! Perturbations of a pair: what a real rig does to it, one at a time and reproducible.
//!
//! Applied in the order in which light meets them: optics (blur), rig (rows off), exposure (gain,
//! bias), sensor (noise), cabling (swap).

use crate::grey::GrayImage;

/// Damage of a pair; the default does nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perturbation {
    /// Standard deviation of a Gaussian blur of both images, in px.
    pub blur: f64,
    /// Rows by which the right image is moved down, in px.
    pub row_offset: f64,
    /// Factor on the right image.
    pub gain: f64,
    /// Added to the right image after the factor.
    pub bias: f64,
    /// Standard deviation of Gaussian noise on both images, in grey levels.
    pub noise: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// Left and right image change places.
    pub swap: bool,
}

impl Default for Perturbation {
    fn default() -> Self {
        Self::NONE
    }
}

impl Perturbation {
    /// Nothing is done.
    pub const NONE: Self =
        Self { blur: 0.0, row_offset: 0.0, gain: 1.0, bias: 0.0, noise: 0.0, seed: 1, swap: false };

    /// Damages that models are fitted on and scored under, by name; the unspoilt pair first.
    pub const DAMAGES: [(&str, Self); 7] = [
        ("clean", Self::NONE),
        ("noise 2", Self { noise: 2.0, ..Self::NONE }),
        ("noise 5", Self { noise: 5.0, ..Self::NONE }),
        ("blur 1 px", Self { blur: 1.0, ..Self::NONE }),
        ("gain 0.8", Self { gain: 0.8, bias: 8.0, ..Self::NONE }),
        ("rows off by 0.5", Self { row_offset: 0.5, ..Self::NONE }),
        ("rows off by 1", Self { row_offset: 1.0, ..Self::NONE }),
    ];

    /// The perturbed pair.
    pub fn apply(&self, left: &GrayImage, right: &GrayImage) -> (GrayImage, GrayImage) {
        let (mut left, mut right) = (left.clone(), right.clone());
        if self.blur > 0.0 {
            left = blur(&left, self.blur);
            right = blur(&right, self.blur);
        }
        if self.row_offset != 0.0 {
            right = move_down(&right, self.row_offset);
        }
        if self.gain != 1.0 || self.bias != 0.0 {
            right
                .pixels
                .iter_mut()
                .for_each(|value| *value = grey(self.gain * f64::from(*value) + self.bias));
        }
        if self.noise > 0.0 {
            add_noise(&mut left, self.noise, self.seed.wrapping_mul(2));
            add_noise(&mut right, self.noise, self.seed.wrapping_mul(2).wrapping_add(1));
        }
        if self.swap { (right, left) } else { (left, right) }
    }
}

fn grey(value: f64) -> u8 {
    value.round() as u8 // saturates
}

/// Moves an image down by `offset` px, interpolating linearly; the border row is repeated.
fn move_down(image: &GrayImage, offset: f64) -> GrayImage {
    let (width, height) = (usize::from(image.dims.width), f64::from(image.dims.height));
    let row_at = |y: f64| {
        let start = y.clamp(0.0, height - 1.0) as usize * width;
        &image.pixels[start..start + width]
    };
    let mut pixels = Vec::with_capacity(image.pixels.len());
    for y in 0..image.dims.height {
        let source = f64::from(y) - offset;
        let fraction = source - source.floor();
        let (upper, lower) = (row_at(source.floor()), row_at(source.floor() + 1.0));
        let mixed = upper
            .iter()
            .zip(lower)
            .map(|(&a, &b)| f64::from(a) * (1.0 - fraction) + f64::from(b) * fraction);
        pixels.extend(mixed.map(grey));
    }
    GrayImage { dims: image.dims, pixels }
}

/// Gaussian blur, cut off at 3 sigma, the border repeated.
pub fn blur(image: &GrayImage, sigma: f64) -> GrayImage {
    let radius = (3.0 * sigma).ceil() as i32;
    let weights: Vec<f64> =
        (-radius..=radius).map(|i| (-f64::from(i * i) / (2.0 * sigma * sigma)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let (width, height) = (i32::from(image.dims.width), i32::from(image.dims.height));
    let pass = |source: &[f64], dx: i32, dy: i32| -> Vec<f64> {
        let mut out = Vec::with_capacity(source.len());
        for y in 0..height {
            for x in 0..width {
                let sample = |i: i32| {
                    let (column, row) =
                        ((x + i * dx).clamp(0, width - 1), (y + i * dy).clamp(0, height - 1));
                    source[(row * width + column) as usize]
                };
                out.push(
                    (-radius..=radius)
                        .zip(&weights)
                        .map(|(i, weight)| weight * sample(i))
                        .sum::<f64>()
                        / total,
                );
            }
        }
        out
    };
    let source: Vec<f64> = image.pixels.iter().map(|&value| f64::from(value)).collect();
    let pixels = pass(&pass(&source, 1, 0), 0, 1).into_iter().map(grey).collect();
    GrayImage { dims: image.dims, pixels }
}

fn add_noise(image: &mut GrayImage, sigma: f64, seed: u64) {
    let mut random = SplitMix64(seed);
    for pair in image.pixels.chunks_mut(2) {
        for (value, normal) in pair.iter_mut().zip(random.normal_pair()) {
            *value = grey(f64::from(*value) + sigma * normal);
        }
    }
}

/// Sebastiano Vigna's SplitMix64: the same numbers on every machine and with every version of every
/// crate.
pub struct SplitMix64(pub u64);

impl SplitMix64 {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in 0 .. 1, never 0.
    pub fn uniform(&mut self) -> f64 {
        ((self.bits() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// Two independent standard normal numbers (Box and Muller).
    pub fn normal_pair(&mut self) -> [f64; 2] {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        let angle = core::f64::consts::TAU * self.uniform();
        [radius * angle.cos(), radius * angle.sin()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::Dims;

    fn column(values: &[u8]) -> GrayImage {
        GrayImage { dims: Dims { width: 1, height: values.len() as u16 }, pixels: values.to_vec() }
    }

    #[test]
    fn rows_move_down_and_interpolate() {
        let image = column(&[0, 10, 20, 30]);
        assert_eq!(move_down(&image, 1.0).pixels, [0, 0, 10, 20]);
        assert_eq!(move_down(&image, -1.0).pixels, [10, 20, 30, 30]);
        assert_eq!(move_down(&image, 0.4).pixels, [0, 6, 16, 26]);
    }

    #[test]
    fn gain_bias_and_swap_touch_what_they_should() {
        let both = column(&[0, 100, 250]);
        let change = Perturbation { gain: 1.2, bias: -10.0, swap: true, ..Perturbation::default() };
        let (left, right) = change.apply(&both, &both);
        assert_eq!((left.pixels, right.pixels), (vec![0, 110, 255], vec![0, 100, 250]));
    }

    #[test]
    fn noise_has_its_sigma_and_its_seed() {
        let flat = GrayImage { dims: Dims { width: 200, height: 100 }, pixels: vec![128; 20_000] };
        let change = Perturbation { noise: 5.0, seed: 7, ..Perturbation::default() };
        let (left, right) = change.apply(&flat, &flat);
        assert_ne!(left, right);
        assert_eq!(change.apply(&flat, &flat), (left.clone(), right));
        let deviation = |image: &GrayImage| {
            let sum: f64 = image.pixels.iter().map(|&v| (f64::from(v) - 128.0).powi(2)).sum();
            (sum / image.pixels.len() as f64).sqrt()
        };
        assert!((deviation(&left) - 5.0).abs() < 0.15, "{}", deviation(&left)); // four standard errors and rounding
    }

    #[test]
    fn blur_keeps_flat_areas_and_spreads_steps() {
        let step = column(&[0, 0, 0, 0, 0, 100, 100, 100, 100, 100]);
        let blurred = blur(&step, 1.0).pixels;
        assert_eq!((blurred[0], blurred[9]), (0, 100));
        assert_eq!((blurred[4], blurred[5]), (30, 70)); // (1 - 0.399) / 2 of the weight
    }
}
