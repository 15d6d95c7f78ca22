//! Less detail than there was.

use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageFormat};
use linestereo_frames::{GrayImage, Perturbation};

/// Compressed and decoded again.
///
/// # Panics
/// Never: the encoder's own output is decoded.
pub(super) fn jpeg(image: &GrayImage, quality: u8) -> GrayImage {
    let mut bytes = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut bytes, quality);
    let (width, height) = (u32::from(image.dims.width), u32::from(image.dims.height));
    encoder
        .write_image(&image.pixels, width, height, ExtendedColorType::L8)
        .expect("written to memory");
    let decoded = image::load_from_memory_with_format(&bytes, ImageFormat::Jpeg)
        .expect("just encoded")
        .into_luma8();
    GrayImage { dims: image.dims, pixels: decoded.into_raw() }
}

/// Quantises an image to `bits` bits, spread over all grey levels.
pub(super) fn bits(mut image: GrayImage, bits: u32) -> GrayImage {
    let steps = f64::from((1_u32 << bits) - 1);
    for value in &mut image.pixels {
        *value = ((f64::from(*value) / 255.0 * steps).round() * 255.0 / steps).round() as u8;
    }
    image
}

/// The mean of so many pixels of a row.
pub(super) fn motion(image: &GrayImage, length: usize) -> GrayImage {
    let width = usize::from(image.dims.width);
    let mut pixels = Vec::with_capacity(image.pixels.len());
    for row in image.pixels.chunks(width) {
        for x in 0..width {
            let part = &row[x.saturating_sub(length / 2)..(x + length.div_ceil(2)).min(width)];
            let sum: usize = part.iter().map(|&value| usize::from(value)).sum();
            pixels.push(((sum + part.len() / 2) / part.len()) as u8);
        }
    }
    GrayImage { dims: image.dims, pixels }
}

/// Contrast reduced towards light grey, and a sensor's noise on it.
pub(super) fn fog(pair: [GrayImage; 2], contrast: f64, seed: u64) -> [GrayImage; 2] {
    const LIGHT: f64 = 190.0;
    let pair = pair.map(|mut image| {
        for value in &mut image.pixels {
            *value = (LIGHT + contrast * (f64::from(*value) - LIGHT)).round() as u8;
        }
        image
    });
    let [left, right] = &pair;
    Perturbation { noise: 1.0, seed, ..Perturbation::NONE }.apply(left, right).into()
}
