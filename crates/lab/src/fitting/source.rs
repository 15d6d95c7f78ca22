//! The fitted constants as Rust source.

use super::names;
use core::fmt::Write;
use linestereo::unstable::{Model, Models, SigmaModel, SupportKind, SupportModels};

/// The text of the core's file of constants; `origin` names the frames.
#[must_use]
pub fn source_text(models: &Models, origin: &str) -> String {
    let mut text = written_by("fit-confidence", origin);
    text.push_str(
        "use super::{Model, Models, SigmaModel};\n\n\
         /// The models that plans use unless they are given others.\n\
         #[rustfmt::skip]\n\
         pub const FITTED: Models = Models {\n",
    );
    model(&mut text, "    ", "near_vertical", &models.near_vertical, &names());
    model(&mut text, "    ", "near_horizontal", &models.near_horizontal, &names());
    for (name, model) in [
        ("near_vertical_edge", &models.near_vertical_edge),
        ("near_horizontal_edge", &models.near_horizontal_edge),
    ] {
        let _ = writeln!(text, "    {name}: SigmaModel {{");
        fields(&mut text, "        ", model, &names());
        text.push_str("    },\n");
    }
    text.push_str("};\n");
    text
}

/// The text of the core's file of constants for support points.
#[must_use]
pub fn support_source_text(models: &SupportModels, origin: &str) -> String {
    let mut text = written_by("fit-confidence", origin);
    text.push_str(
        "use super::SupportModels;\n\
         use crate::confidence::{Model, Network, Unit};\n\n\
         /// The models that plans use unless they are given others.\n\
         #[rustfmt::skip]\n\
         pub const FITTED_SUPPORT: SupportModels = SupportModels {\n",
    );
    for (name, model) in
        [("upright", &models.upright), ("ground", &models.ground), ("fine", &models.fine)]
    {
        self::model(&mut text, "    ", name, model, &SupportKind::NAMES);
    }
    let network = &models.context;
    text.push_str("    context: Network {\n        units: [\n");
    for unit in &network.units {
        let _ = writeln!(
            text,
            "            Unit {{ bias_q18: {}, output_q10: {}, weights_q10: {:?} }},",
            unit.bias_q18, unit.output_q10, unit.weights_q10
        );
    }
    let _ = writeln!(text, "        ],\n        bias_q10: {},", network.bias_q10);
    table(&mut text, "        ", "probability_q16", &network.probability_q16);
    text.push_str("    },\n");
    text.push_str("};\n");
    text
}

/// The first lines of a file of constants, of at most 100 columns.
pub(super) fn written_by(command: &str, origin: &str) -> String {
    let said = format!("Written by `linestereo-lab {command}` from {origin}: do not edit.");
    let mut lines = vec![String::from("//!")];
    for word in said.split(' ') {
        let line = lines.last_mut().expect("starts with one line");
        if line.len() + 1 + word.len() <= 100 {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(format!("//! {word}"));
        }
    }
    lines.join("\n") + "\n\n"
}

/// The fields of a model with a standard deviation, each line indented.
pub(super) fn fields<const N: usize>(
    text: &mut String,
    indent: &str,
    model: &SigmaModel<N>,
    names: &[&str; N],
) {
    self::model(text, indent, "model", &model.model, names);
    table(text, indent, "sigma_q6", &model.sigma_q6);
}

fn model<const N: usize>(
    text: &mut String,
    indent: &str,
    name: &str,
    model: &Model<N>,
    names: &[&str; N],
) {
    let _ = writeln!(text, "{indent}{name}: Model {{");
    let inner = &format!("{indent}    ");
    let _ = writeln!(text, "{inner}bias_q12: {},\n{inner}coefficients_q12: [", model.bias_q12);
    for (coefficient, name) in model.coefficients_q12.iter().zip(names) {
        let _ = writeln!(text, "{inner}    {coefficient}, // {name}");
    }
    let _ = writeln!(text, "{inner}],");
    table(text, inner, "probability_q16", &model.probability_q16);
    let _ = writeln!(text, "{indent}}},");
}

fn table(text: &mut String, indent: &str, name: &str, table: &[u16]) {
    let _ = writeln!(text, "{indent}{name}: [");
    for row in table.chunks(11) {
        let row: Vec<String> = row.iter().map(u16::to_string).collect();
        let _ = writeln!(text, "{indent}    {},", row.join(", "));
    }
    let _ = writeln!(text, "{indent}],");
}
