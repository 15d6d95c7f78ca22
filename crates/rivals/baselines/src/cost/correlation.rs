//! Costs that normalise a window by its mean and its norm.
//!
//! ```text
//! NCC = (n sum LR - sum L sum R) / (norm L * norm R),   norm I = sqrt(n sum I^2 - (sum I)^2)
//! ```
//! # Bounds
//! `n sum LR` stays below 2^53 for windows of less than 2^37 / 2^16 pixels: it is exact in double precision.

use super::{Cost, mirrored};
use crate::search::Search;
use crate::window::{Part, Window};
use linestereo_frames::GrayImage;

/// Cost of `1 - NCC = 1`.
const ONE: f64 = 32_768.0;
/// Steps of a normalised grey level.
const NORMALISED_ONE: f32 = 4096.0;

/// Sums and norms of the windows around every pixel; zero where a window leaves the image.
struct Statistics {
    sum: Vec<f64>,
    /// 1 / norm; 0 for a window of one grey level.
    inverse_norm: Vec<f64>,
}

impl Statistics {
    fn new(image: &GrayImage, window: &Window) -> Self {
        let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
        let squares: Vec<u64> = image.pixels.iter().map(|&grey| u64::from(grey).pow(2)).collect();
        let greys: Vec<u64> = image.pixels.iter().map(|&grey| grey.into()).collect();
        let (sums, squares) =
            (window_sums(&greys, width, height, window), window_sums(&squares, width, height, window));
        let area = window.area() as f64;
        let inverse = |(&sum, &square): (&f64, &f64)| {
            let squared_norm = area * square - sum * sum;
            if squared_norm > 0.0 { squared_norm.sqrt().recip() } else { 0.0 }
        };
        let inverse_norm = sums.iter().zip(&squares).map(inverse).collect();
        Self { sum: sums, inverse_norm }
    }
}

/// Sum over the window around every pixel, by an integral image.
fn window_sums(values: &[u64], width: usize, height: usize, window: &Window) -> Vec<f64> {
    let stride = width + 1;
    let mut integral = vec![0_u64; stride * (height + 1)];
    for y in 0..height {
        let mut row = 0;
        for x in 0..width {
            row += values[y * width + x];
            integral[(y + 1) * stride + x + 1] = integral[y * stride + x + 1] + row;
        }
    }
    let mut sums = vec![0.0; width * height];
    let (half_x, half_y, parts) = (window.half_columns(), window.half_rows(), window.parts());
    for y in half_y..height.saturating_sub(half_y) {
        for x in half_x..width.saturating_sub(half_x) {
            let part = |part: &Part| {
                let (top, bottom) = (y - part.half_rows, y + part.half_rows + 1);
                let (left, right) = (x - part.half_columns, x + part.half_columns + 1);
                let sum = integral[bottom * stride + right] + integral[top * stride + left]
                    - integral[bottom * stride + left]
                    - integral[top * stride + right];
                if part.added { sum as f64 } else { -(sum as f64) }
            };
            sums[y * width + x] = parts.iter().map(part).sum();
        }
    }
    sums
}

/// `scale * (1 - NCC)`.
pub(super) struct Correlation {
    search: Search,
    left: Vec<u8>,
    mirrored: Vec<u8>,
    left_statistics: Statistics,
    /// From right to left.
    right_statistics: Statistics,
    area: f64,
    scale: f64,
}

impl Correlation {
    pub(super) fn new(left: &GrayImage, right: &GrayImage, window: &Window, search: Search, scale: f64) -> Self {
        let width = search.width();
        let Statistics { sum, inverse_norm } = Statistics::new(right, window);
        Self {
            search,
            left: left.pixels.clone(),
            mirrored: mirrored(&right.pixels, width),
            left_statistics: Statistics::new(left, window),
            right_statistics: Statistics { sum: mirrored(&sum, width), inverse_norm: mirrored(&inverse_norm, width) },
            area: window.area() as f64,
            scale: scale * ONE,
        }
    }
}

impl Cost for Correlation {
    fn terms(&self, y: usize, out: &mut [u16]) {
        let (width, count) = (self.search.width(), self.search.count);
        let row = y * width..(y + 1) * width;
        let (left, mirrored) = (&self.left[row.clone()], &self.mirrored[row]);
        for (x, curve) in (self.search.first()..).zip(out.chunks_exact_mut(count)) {
            let (value, others) = (u16::from(left[x]), &mirrored[width - 1 - x..][..count]);
            for (term, &other) in curve.iter_mut().zip(others) {
                *term = value * u16::from(other);
            }
        }
    }

    fn costs(&self, y: usize, first: usize, sums: &mut [u32]) {
        let (width, count) = (self.search.width(), self.search.count);
        for (x, curve) in (first..).zip(sums.chunks_exact_mut(count)) {
            let (sum, inverse) =
                (self.left_statistics.sum[y * width + x], self.left_statistics.inverse_norm[y * width + x]);
            let mirrored = (y + 1) * width - 1 - x;
            let right = self.right_statistics.sum[mirrored..][..count]
                .iter()
                .zip(&self.right_statistics.inverse_norm[mirrored..][..count]);
            for (cost, (other, other_inverse)) in curve.iter_mut().zip(right) {
                let covariance = self.area * f64::from(*cost) - sum * other;
                let correlation = covariance * inverse * other_inverse;
                *cost = (self.scale * (1.0 - correlation) + 0.5) as u32;
            }
        }
    }
}

/// Absolute differences of normalised patches, every window by itself.
pub(super) struct NormalisedAbsolute {
    search: Search,
    left: Vec<f32>,
    right: Vec<f32>,
    left_statistics: Statistics,
    right_statistics: Statistics,
    offsets: Vec<isize>,
    area: f64,
}

impl NormalisedAbsolute {
    pub(super) fn new(left: &GrayImage, right: &GrayImage, window: &Window, search: Search) -> Self {
        let width = search.width() as isize;
        let grey = |image: &GrayImage| image.pixels.iter().map(|&grey| f32::from(grey)).collect();
        Self {
            search,
            left: grey(left),
            right: grey(right),
            left_statistics: Statistics::new(left, window),
            right_statistics: Statistics::new(right, window),
            offsets: window.offsets().map(|(dx, dy)| dy * width + dx).collect(),
            area: window.area() as f64,
        }
    }

    /// The patch `(I - mean) / norm`.
    fn patch(&self, image: &[f32], statistics: &Statistics, index: usize, out: &mut [f32]) {
        let mean = (statistics.sum[index] / self.area) as f32;
        // The norm of the statistics is sqrt(n) times that of a patch.
        let inverse = (statistics.inverse_norm[index] * self.area.sqrt()) as f32;
        for (value, &offset) in out.iter_mut().zip(&self.offsets) {
            *value = (image[index.wrapping_add_signed(offset)] - mean) * inverse;
        }
    }
}

impl Cost for NormalisedAbsolute {
    fn terms(&self, _y: usize, _out: &mut [u16]) {}

    fn costs(&self, y: usize, first: usize, sums: &mut [u32]) {
        let (width, count, size) = (self.search.width(), self.search.count, self.offsets.len());
        let columns = sums.len() / count;
        // The right patches of a row serve every disparity.
        let start = first + 1 - count;
        let mut right = vec![0.0; (columns + count - 1) * size];
        for (x, patch) in (start..).zip(right.chunks_exact_mut(size)) {
            self.patch(&self.right, &self.right_statistics, y * width + x, patch);
        }
        let mut left = vec![0.0; size];
        for (x, curve) in (first..).zip(sums.chunks_exact_mut(count)) {
            self.patch(&self.left, &self.left_statistics, y * width + x, &mut left);
            for (d, cost) in curve.iter_mut().enumerate() {
                let other = &right[(x - d - start) * size..][..size];
                *cost = (NORMALISED_ONE * distance(&left, other) + 0.5) as u32;
            }
        }
    }
}

/// Sum of absolute differences; eight sums, so that the compiler may use vectors.
fn distance(left: &[f32], right: &[f32]) -> f32 {
    let mut sums = [0.0_f32; 8];
    let (left, right) = (left.chunks_exact(8), right.chunks_exact(8));
    let rest: f32 = left.remainder().iter().zip(right.remainder()).map(|(l, r)| (l - r).abs()).sum();
    for (left, right) in left.zip(right) {
        for ((sum, l), r) in sums.iter_mut().zip(left).zip(right) {
            *sum += (l - r).abs();
        }
    }
    rest + sums.iter().sum::<f32>()
}
