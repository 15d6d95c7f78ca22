//! The same thing at the same pixel of both images, and what a sensor does to single pixels.

use core::iter;
use linestereo_frames::{GrayImage, SplitMix64};

/// Adds to a pixel, in grey levels.
fn add(value: &mut u8, change: f64) {
    *value = (f64::from(*value) + change).round() as u8; // saturates
}

/// Noise that is the same in both images.
pub(super) fn fixed_pattern(pair: [GrayImage; 2], sigma: f64, seed: u64) -> [GrayImage; 2] {
    pair.map(|mut image| {
        let mut random = SplitMix64(seed);
        let normals = iter::repeat_with(|| random.normal_pair()).flatten();
        for (value, normal) in image.pixels.iter_mut().zip(normals) {
            add(value, sigma * normal);
        }
        image
    })
}

/// An offset of every column, or of every row, that is the same in both images.
pub(super) fn line_noise(
    pair: [GrayImage; 2],
    sigma: f64,
    seed: u64,
    columns: bool,
) -> [GrayImage; 2] {
    pair.map(|mut image| {
        let mut random = SplitMix64(seed);
        let width = usize::from(image.dims.width);
        let lines = if columns { width } else { usize::from(image.dims.height) };
        let offsets: Vec<f64> = (0..lines.div_ceil(2)).flat_map(|_| random.normal_pair()).collect();
        for (i, value) in image.pixels.iter_mut().enumerate() {
            add(value, sigma * offsets[if columns { i % width } else { i / width }]);
        }
        image
    })
}

/// Lines of white text on a dark ground: cells of 6 x 8 px with random strokes.
pub(super) fn text(pair: [GrayImage; 2], lines: usize, seed: u64) -> [GrayImage; 2] {
    /// Strokes of a letter, 5 x 7 px.
    const LETTERS: [[u8; 7]; 8] = [
        [0x0e, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11],
        [0x1e, 0x11, 0x1e, 0x11, 0x11, 0x11, 0x1e],
        [0x1f, 0x10, 0x1e, 0x10, 0x10, 0x10, 0x1f],
        [0x11, 0x19, 0x15, 0x13, 0x11, 0x11, 0x11],
        [0x0e, 0x11, 0x10, 0x0e, 0x01, 0x11, 0x0e],
        [0x1f, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04],
        [0x0e, 0x13, 0x15, 0x15, 0x19, 0x11, 0x0e],
        [0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e],
    ];
    pair.map(|mut image| {
        let mut random = SplitMix64(seed);
        let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
        for line in 0..lines {
            let middle = height * (2 * line + 1) / (2 * lines);
            for letter in 0..width / 6 {
                let strokes = LETTERS[(random.bits() % 8) as usize];
                for (down, strokes) in strokes.iter().enumerate() {
                    let y = (middle + down).checked_sub(4).filter(|&y| y < height);
                    let Some(y) = y else { continue }; // lines of small images reach beyond them
                    for x in (0..5).filter(|x| strokes >> (4 - x) & 1 == 1) {
                        image.pixels[y * width + 6 * letter + x] = 250;
                    }
                }
            }
        }
        image
    })
}

/// Centres of blobs, px.
fn centres(image: &GrayImage, count: usize, seed: u64) -> Vec<(f64, f64)> {
    let mut random = SplitMix64(seed);
    let (width, height) = (f64::from(image.dims.width), f64::from(image.dims.height));
    (0..count).map(|_| (width * random.uniform(), height * random.uniform())).collect()
}

/// Share of each pixel that blobs of this radius with soft rims cover.
fn cover(image: &GrayImage, count: usize, radius: f64, seed: u64) -> Vec<f64> {
    let centres = centres(image, count, seed);
    let width = usize::from(image.dims.width);
    let covered = |i: usize| {
        let (x, y) = ((i % width) as f64, (i / width) as f64);
        let near = centres.iter().map(|(cx, cy)| (x - cx).hypot(y - cy)).fold(f64::MAX, f64::min);
        (radius + 0.5 - near).clamp(0.0, 1.0)
    };
    (0..image.pixels.len()).map(covered).collect()
}

/// Blobs of one grey level.
pub(super) fn blobs(
    mut image: GrayImage,
    count: usize,
    radius: f64,
    level: u8,
    seed: u64,
) -> GrayImage {
    let cover = cover(&image, count, radius, seed);
    for (value, share) in image.pixels.iter_mut().zip(cover) {
        add(value, share * (f64::from(level) - f64::from(*value)));
    }
    image
}

/// Discs behind which the image is blurred and a little brighter.
pub(super) fn drops(image: &GrayImage, count: usize, radius: f64, seed: u64) -> GrayImage {
    let blurred = linestereo_frames::blur(image, radius / 3.0);
    let mut seen = image.clone();
    let behind = cover(image, count, radius, seed).into_iter().zip(blurred.pixels);
    for (value, (share, blurred)) in seen.pixels.iter_mut().zip(behind) {
        add(value, share * (f64::from(blurred) + 12.0 - f64::from(*value)));
    }
    seen
}

/// Every `step`-th column at one level.
pub(super) fn columns(mut image: GrayImage, step: usize, level: u8) -> GrayImage {
    for row in image.pixels.chunks_mut(image.dims.width.into()) {
        row.iter_mut().skip(step / 2).step_by(step).for_each(|value| *value = level);
    }
    image
}

/// Single pixels black or white.
pub(super) fn salt_and_pepper(pair: [GrayImage; 2], percent: f64, seed: u64) -> [GrayImage; 2] {
    let mut random = SplitMix64(seed);
    pair.map(|mut image| {
        for value in &mut image.pixels {
            if 100.0 * random.uniform() < percent {
                *value = if random.uniform() < 0.5 { 0 } else { 255 };
            }
        }
        image
    })
}

/// Something dark and plain before the left part of the image.
pub(super) fn covered(mut image: GrayImage, percent: f64) -> GrayImage {
    let width = usize::from(image.dims.width);
    let edge = width as f64 * percent / 100.0;
    for (i, value) in image.pixels.iter_mut().enumerate() {
        if ((i % width) as f64) < edge {
            *value = 35 + (i % 3) as u8;
        }
    }
    image
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::Dims;

    #[test]
    fn lines_of_text_end_with_the_image() {
        for (height, lines) in [(240, 12), (86, 12), (20, 12), (6, 1)] {
            let dims = Dims { width: 64, height };
            let dark = GrayImage { dims, pixels: vec![0; 64 * usize::from(height)] };
            let [left, right] = text([dark.clone(), dark], lines, 1);
            assert_eq!(left.pixels, right.pixels);
            let drawn = left.pixels.iter().filter(|&&grey| grey == 250).count();
            assert!(drawn > 20 && drawn < left.pixels.len(), "{height}: {drawn}");
        }
    }
}
