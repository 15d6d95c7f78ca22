//! The points as a map with a value, or none, for every pixel of the left image.

use crate::engine::FrameResult;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use linestereo::{Dims, Disparity};

/// KITTI: stored value = disparity * 256, 0 = none.
const KITTI_SCALE: f64 = 256.0;

/// A map and what did not fit in.
#[derive(Clone, Debug)]
pub struct KittiMap {
    /// The file.
    pub png: Vec<u8>,
    /// Points whose disparity a KITTI map cannot hold: below 0, or 256 px and more.
    pub left_out: usize,
}

/// Disparities as KITTI stores them: 16-bit grey, px * 256, 0 = none; a disparity of 0 becomes 1, as in KITTI's own code.
pub fn kitti_png(dims: Dims, result: &FrameResult) -> image::ImageResult<KittiMap> {
    let mut left_out = 0;
    let map = map(dims, result, 0_u16, |disparity| {
        let stored = (disparity.to_num::<f64>() * KITTI_SCALE).round();
        let fits = disparity >= Disparity::ZERO && stored <= f64::from(u16::MAX);
        left_out += usize::from(!fits);
        if fits { (stored as u16).max(1) } else { 0 }
    });
    let bytes: Vec<u8> = map.into_iter().flat_map(u16::to_ne_bytes).collect();
    let mut png = Vec::new();
    let encoder = PngEncoder::new(&mut png);
    encoder.write_image(&bytes, dims.width.into(), dims.height.into(), ExtendedColorType::L16)?;
    Ok(KittiMap { png, left_out })
}

/// Disparities in px as Middlebury stores them: 32-bit floats, little endian (a scale of -1), the lowest row first, infinity = none.
#[must_use]
pub fn pfm(dims: Dims, result: &FrameResult) -> Vec<u8> {
    let map = map(dims, result, f32::INFINITY, Disparity::to_num);
    let mut bytes = format!("Pf\n{} {}\n-1.0\n", dims.width, dims.height).into_bytes();
    for row in map.chunks_exact(dims.width.into()).rev() {
        bytes.extend(row.iter().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

fn map<T: Copy>(dims: Dims, result: &FrameResult, none: T, mut value: impl FnMut(Disparity) -> T) -> Vec<T> {
    let width = usize::from(dims.width);
    let mut map = vec![none; width * usize::from(dims.height)];
    for point in &result.points {
        map[usize::from(point.y) * width + usize::from(point.x)] = value(point.disparity);
    }
    map
}
