//! The confidence models of bars.

use super::sample::Sample;
use super::source::{fields, written_by};
use super::{SIDES_PENALTY, fit_scenes};
use crate::thin::Told;
use core::fmt::Write;
use linestereo::unstable::{BAR_EVIDENCE, BarKind, SigmaModel};
use std::collections::BTreeMap;

/// Fits the model on the pixels of bars in front, or of those level with what is around them; each
/// has the name of the scene that it is in.
#[must_use]
pub fn fit_bars(bars: &[(String, Told)], is_in_front: bool) -> SigmaModel<BAR_EVIDENCE> {
    let mut scenes: BTreeMap<&str, Vec<Sample>> = BTreeMap::new();
    for (name, told) in bars.iter().filter(|(_, told)| told.bar.is_in_front() == is_in_front) {
        if let Some(evidence) = told.evidence
            && !told.errors.is_empty()
        {
            scenes.entry(name).or_default().push(Sample::bar(&evidence, told.errors.clone()));
        }
    }
    fit_scenes(
        &scenes.values().map(|scene| scene.iter().collect()).collect::<Vec<_>>(),
        SIDES_PENALTY,
    )
}

/// The text of the core's file of constants, of bars in front and of level ones; `origin` names the
/// frames.
#[must_use]
pub fn bar_source_text([front, level]: &[SigmaModel<BAR_EVIDENCE>; 2], origin: &str) -> String {
    let mut text = written_by("thin", origin);
    text.push_str(
        "use super::evidence::BAR_EVIDENCE;\nuse crate::confidence::{Model, SigmaModel};\n",
    );
    let models = [("FITTED_BAR", "in front of", front), ("FITTED_LEVEL_BAR", "level with", level)];
    for (name, place, model) in models {
        let _ = write!(
            text,
            "\n/// The model of bars {place} what is around them.\n#[rustfmt::skip]\n\
             pub const {name}: SigmaModel<BAR_EVIDENCE> = SigmaModel {{\n"
        );
        fields(&mut text, "    ", model, &BarKind::NAMES);
        text.push_str("};\n");
    }
    text
}
