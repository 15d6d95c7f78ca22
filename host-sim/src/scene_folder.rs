//! A rendering as the files of a scene folder, the layout that `linestereo run` and the laboratory
//! read.

use crate::output::png_file;
use image::{ExtendedColorType, ImageResult};
use linestereo_scenes::{Pair, Rendering};
use serde_json::json;

/// Steps of the stored truth per pixel of disparity.
const SCALE: f32 = 256.0;

/// Name and contents of every file of the folder of a scene called `name`.
pub fn files(
    name: &str,
    pair: &Pair,
    rendering: &Rendering,
) -> ImageResult<Vec<(&'static str, Vec<u8>)>> {
    let dims = rendering.left.dims;
    let mask: Vec<u8> =
        rendering.visible.iter().map(|&visible| if visible { 255 } else { 0 }).collect();
    let truth: Vec<u8> =
        rendering.disparity.iter().flat_map(|&d| stored(d).to_ne_bytes()).collect();
    let note = "16-bit; disparity of the left image in px = value / 256; 0 = unknown";
    let description = json!({
        "set": "synthetic",
        "scene": name,
        "from": format!("linestereo scene, version {}", env!("CARGO_PKG_VERSION")),
        "size": [dims.width, dims.height],
        "max_disparity": rendering.search_range(),
        "ground_truth": { "file": "gt.png", "disparity_scale": SCALE as u32, "note": note },
        "visible": "visible.png: 255 where the true match is visible in the right image",
        "objects": "objects.png: label of the object, 0 = none",
        "rectified": {
            "focal_px": pair.focal_px,
            "baseline_m": pair.baseline_m,
            "disparity_offset_px": pair.disparity_offset_px,
        },
    });
    let png =
        |samples: &[u8], colour| png_file(samples, [dims.width.into(), dims.height.into()], colour);
    Ok(vec![
        ("left.png", png(&rendering.left.pixels, ExtendedColorType::L8)?),
        ("right.png", png(&rendering.right.pixels, ExtendedColorType::L8)?),
        ("gt.png", png(&truth, ExtendedColorType::L16)?),
        ("visible.png", png(&mask, ExtendedColorType::L8)?),
        ("objects.png", png(&rendering.labels, ExtendedColorType::L8)?),
        ("scene.json", format!("{description:#}\n").into_bytes()),
    ])
}

fn stored(disparity: f32) -> u16 {
    if disparity > 0.0 { (disparity * SCALE).round().clamp(1.0, 65535.0) as u16 } else { 0 }
}
