//! The confidence models of bars.

use super::sample::Sample;
use super::source::{constant, fields, head};
use super::{SIDES_PENALTY, fit_scenes};
use crate::thin::Told;
use linestereo::unstable::{BAR_EVIDENCE, BarKind, SigmaModel};
use std::collections::BTreeMap;

/// Fits the model on the pixels of bars in front, or of those level with what is around them; each
/// has the name of the scene that it is in.
pub(crate) fn fit_bars(bars: &[(String, Told)], is_in_front: bool) -> SigmaModel<BAR_EVIDENCE> {
    let mut scenes: BTreeMap<&str, Vec<Sample>> = BTreeMap::new();
    for (name, told) in bars.iter().filter(|(_, told)| told.bar.is_in_front() == is_in_front) {
        if let Some(evidence) = told.evidence
            && !told.errors.is_empty()
        {
            scenes.entry(name).or_default().push(Sample::new(&evidence.0, told.errors.clone()));
        }
    }
    fit_scenes(
        &scenes.values().map(|scene| scene.iter().collect()).collect::<Vec<_>>(),
        SIDES_PENALTY,
    )
}

/// The text of the core's file of constants, of bars in front and of level ones; `origin` names the
/// frames.
pub(crate) fn bar_source_text(
    [front, level]: &[SigmaModel<BAR_EVIDENCE>; 2],
    origin: &str,
) -> String {
    let uses = ["super::evidence::BAR_EVIDENCE", "crate::confidence::{Model, SigmaModel}"];
    let mut text = head("thin", origin, &uses);
    let models = [("FITTED_BAR", "in front of", front), ("FITTED_LEVEL_BAR", "level with", level)];
    for (name, place, model) in models {
        let documentation = format!("The model of bars {place} what is around them.");
        constant(&mut text, &documentation, name, "SigmaModel<BAR_EVIDENCE>", |text| {
            fields(text, "    ", model, &BarKind::NAMES);
        });
    }
    text
}
