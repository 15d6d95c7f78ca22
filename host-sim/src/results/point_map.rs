//! The points as a map with a value, or none, for every pixel of the left image, as other programs
//! store disparities and depths.

use super::listing::finite_metres;
use crate::engine::FrameResult;
use crate::output::png_file;
use image::ExtendedColorType;
use linestereo::{Dims, Rig, units::Disparity};

/// KITTI: stored value = disparity * 256, 0 = none.
const KITTI_SCALE: f64 = 256.0;
/// First bytes of NumPy's file, version 1.0.
const NPY_PREFIX: &[u8] = b"\x93NUMPY\x01\x00";
const NPY_BLOCK: usize = 64;

/// Millimetres of a metre.
const DEPTH_SCALE: f64 = 1000.0;

/// A map of 16-bit values and what did not fit in.
#[derive(Clone, Debug)]
pub struct PngMap {
    pub png: Vec<u8>,
    /// Points whose value it cannot hold.
    pub left_out: usize,
}

/// Disparities as KITTI stores them: 16-bit grey, px * 256, 0 = none; a disparity of 0 becomes 1,
/// as in KITTI's own code. Left out are those below 0, and of 256 px and more.
pub fn kitti_png(dims: Dims, result: &FrameResult) -> image::ImageResult<PngMap> {
    sixteen_bit(dims, result, |disparity| Some(disparity.to_num::<f64>() * KITTI_SCALE))
}

/// Depths as RealSense, ROS and Open3D store them: 16-bit grey, mm along the optical axis, 0 =
/// none. Left out is what is 65.536 m away and more.
pub fn depth_png(dims: Dims, result: &FrameResult, rig: &Rig) -> image::ImageResult<PngMap> {
    sixteen_bit(dims, result, |disparity| Some(metres(rig, disparity)? * DEPTH_SCALE))
}

/// Depths in metres as NumPy's array of 32-bit floats, (height, width); not a number = none.
pub fn depth_npy(dims: Dims, result: &FrameResult, rig: &Rig) -> Vec<u8> {
    let map = map(dims, result, f32::NAN, |disparity| {
        metres(rig, disparity).map_or(f32::NAN, |z| z as f32)
    });
    let shape = format!("({}, {})", dims.height, dims.width);
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    // With its end of line it fills whole blocks, so that values are aligned.
    let length = (NPY_PREFIX.len() + 2 + header.len() + 1).next_multiple_of(NPY_BLOCK)
        - NPY_PREFIX.len()
        - 2;
    let mut bytes = NPY_PREFIX.to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{header:width$}\n", width = length - 1).into_bytes());
    bytes.extend(map.into_iter().flat_map(f32::to_le_bytes));
    bytes
}

fn metres(rig: &Rig, disparity: Disparity) -> Option<f64> {
    finite_metres(rig.depth(disparity))
}

/// Values rounded to 16 bits; 0 = none, so that what rounds to 0 becomes 1. What has no value is
/// infinitely far.
fn sixteen_bit(
    dims: Dims,
    result: &FrameResult,
    value: impl Fn(Disparity) -> Option<f64>,
) -> image::ImageResult<PngMap> {
    let mut left_out = 0;
    let map = map(dims, result, 0_u16, |disparity| {
        let stored = value(disparity).map_or(f64::INFINITY, f64::round);
        let fits = (0.0..=f64::from(u16::MAX)).contains(&stored);
        left_out += usize::from(!fits);
        if fits { (stored as u16).max(1) } else { 0 }
    });
    let bytes: Vec<u8> = map.into_iter().flat_map(u16::to_ne_bytes).collect();
    let png = png_file(&bytes, [dims.width.into(), dims.height.into()], ExtendedColorType::L16)?;
    Ok(PngMap { png, left_out })
}

/// Disparities in px as Middlebury stores them: 32-bit floats, little endian (a scale of -1), the
/// lowest row first, infinity = none.
pub fn pfm(dims: Dims, result: &FrameResult) -> Vec<u8> {
    let map = map(dims, result, f32::INFINITY, Disparity::to_num);
    let mut bytes = format!("Pf\n{} {}\n-1.0\n", dims.width, dims.height).into_bytes();
    for row in map.chunks_exact(dims.width.into()).rev() {
        bytes.extend(row.iter().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

/// A value for every pixel, `none` where there is no point.
pub(super) fn map<T: Copy>(
    dims: Dims,
    result: &FrameResult,
    none: T,
    mut value: impl FnMut(Disparity) -> T,
) -> Vec<T> {
    let width = usize::from(dims.width);
    let mut map = vec![none; width * usize::from(dims.height)];
    for point in &result.points {
        if let Some(pixel) = map.get_mut(usize::from(point.y) * width + usize::from(point.x)) {
            *pixel = value(point.disparity);
        }
    }
    map
}
