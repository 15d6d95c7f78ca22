//! The confidence model of the depth of pixels.

use super::sample::Sample;
use super::source::{constant, fields, head};
use super::{SIDES_PENALTY, fit_scenes};
use crate::evaluate::QueriedPixel;
use linestereo::unstable::{PIXEL_EVIDENCE, PixelKind, SigmaModel};

/// Fits the model on the pixels that were asked for in each scene. Tables are fitted on scores of
/// each scene by a line fitted on the others.
#[must_use]
pub fn fit_pixels(scenes: &[&[QueriedPixel]]) -> SigmaModel<PIXEL_EVIDENCE> {
    let sample = |pixel: &QueriedPixel| {
        let (disparity, evidence) = pixel.found.as_ref().ok()?;
        Some(Sample::new(&evidence.0, vec![(disparity - pixel.truth).abs()]))
    };
    let samples: Vec<Vec<Sample>> =
        scenes.iter().map(|scene| scene.iter().filter_map(sample).collect()).collect();
    fit_scenes(
        &samples.iter().map(|scene| scene.iter().collect()).collect::<Vec<_>>(),
        SIDES_PENALTY,
    )
}

/// The text of the core's file of constants; `origin` names the frames.
#[must_use]
pub fn pixel_source_text(model: &SigmaModel<PIXEL_EVIDENCE>, origin: &str) -> String {
    let uses = ["super::PIXEL_EVIDENCE", "crate::confidence::{Model, SigmaModel}"];
    let mut text = head("fit-confidence", origin, &uses);
    let documentation = "The model that plans use unless they are given another.";
    constant(&mut text, documentation, "FITTED_PIXEL", "SigmaModel<PIXEL_EVIDENCE>", |text| {
        fields(text, "    ", model, &PixelKind::NAMES);
    });
    text
}
