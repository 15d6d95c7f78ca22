//! A rendering as the files of a scene folder, the layout that `linestereo eval` reads.

use super::{Pair, Rendering};
use image::{ExtendedColorType, ImageEncoder, ImageResult, codecs::png::PngEncoder};
use linestereo::Dims;
use serde_json::json;

/// Steps of the stored truth per pixel of disparity.
const SCALE: f32 = 256.0;

/// Name and contents of every file of the folder of a scene called `name`.
pub fn files(name: &str, pair: &Pair, rendering: &Rendering) -> ImageResult<Vec<(&'static str, Vec<u8>)>> {
    let dims = rendering.left.dims;
    let mask: Vec<u8> = rendering.visible.iter().map(|&visible| if visible { 255 } else { 0 }).collect();
    // The png encoder wants 16-bit samples in the machine's byte order.
    let truth: Vec<u8> = rendering.disparity.iter().flat_map(|&d| stored(d).to_ne_bytes()).collect();
    let note = "16-bit; disparity of the left image in px = value / 256; 0 = unknown";
    let description = json!({
        "set": "synthetic",
        "scene": name,
        "from": format!("linestereo scene, version {}", env!("CARGO_PKG_VERSION")),
        "size": [dims.width, dims.height],
        "max_disparity": search_range(rendering),
        "ground_truth": { "file": "gt.png", "disparity_scale": SCALE as u32, "note": note },
        "visible": "visible.png: 255 where the true match is visible in the right image",
        "objects": "objects.png: label of the object, 0 = none",
        "rectified": {
            "focal_px": pair.focal_px,
            "baseline_m": pair.baseline_m,
            "disparity_offset_px": pair.disparity_offset_px,
        },
    });
    Ok(vec![
        ("left.png", png(&rendering.left.pixels, dims, ExtendedColorType::L8)?),
        ("right.png", png(&rendering.right.pixels, dims, ExtendedColorType::L8)?),
        ("gt.png", png(&truth, dims, ExtendedColorType::L16)?),
        ("visible.png", png(&mask, dims, ExtendedColorType::L8)?),
        ("objects.png", png(&rendering.labels, dims, ExtendedColorType::L8)?),
        ("scene.json", format!("{description:#}\n").into_bytes()),
    ])
}

/// The disparity range a search needs: above everything in the scene, in steps of 16, within the core's limits.
pub fn search_range(rendering: &Rendering) -> u16 {
    let largest = rendering.disparity.iter().copied().fold(0.0_f32, f32::max); // NaN loses against any number
    let range = (largest as u16 + 2).next_multiple_of(16);
    range.min(256).min(rendering.left.dims.width - 1)
}

fn stored(disparity: f32) -> u16 {
    if disparity > 0.0 { (disparity * SCALE).round().clamp(1.0, 65535.0) as u16 } else { 0 }
}

fn png(bytes: &[u8], dims: Dims, color: ExtendedColorType) -> ImageResult<Vec<u8>> {
    let mut file = Vec::new();
    PngEncoder::new(&mut file).write_image(bytes, u32::from(dims.width), u32::from(dims.height), color)?;
    Ok(file)
}
