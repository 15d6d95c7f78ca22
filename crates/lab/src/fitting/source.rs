//! The fitted constants as Rust source.

use core::fmt::Write;
use linestereo::unstable::{
    BAR_EVIDENCE, BarKind, Model, Models, PIXEL_EVIDENCE, PixelKind, SegmentKind, SigmaModel,
    SupportKind, SupportModels,
};

/// The text of the core's file of constants; `origin` names the frames.
pub(crate) fn source_text(models: &Models, origin: &str) -> String {
    let mut text = head("fit-confidence", origin, &["super::{Model, Models, SigmaModel}"]);
    constant(&mut text, OF_PLANS, "FITTED", "Models", |text| {
        let Models { near_vertical, near_horizontal, .. } = models;
        model(text, "    ", "near_vertical", near_vertical, &SegmentKind::NAMES);
        model(text, "    ", "near_horizontal", near_horizontal, &SegmentKind::NAMES);
        for (name, model) in [
            ("near_vertical_edge", &models.near_vertical_edge),
            ("near_horizontal_edge", &models.near_horizontal_edge),
        ] {
            let _ = writeln!(text, "    {name}: SigmaModel {{");
            fields(text, "        ", model, &SegmentKind::NAMES);
            text.push_str("    },\n");
        }
    });
    text
}

/// The text of the core's file of constants for support points.
pub(crate) fn support_source_text(models: &SupportModels, origin: &str) -> String {
    let uses = ["super::SupportModels", "crate::confidence::{Model, Network, Unit}"];
    let mut text = head("fit-confidence", origin, &uses);
    constant(&mut text, OF_PLANS, "FITTED_SUPPORT", "SupportModels", |text| {
        let SupportModels { upright, ground, fine, context } = models;
        for (name, model) in [("upright", upright), ("ground", ground), ("fine", fine)] {
            self::model(text, "    ", name, model, &SupportKind::NAMES);
        }
        text.push_str("    context: Network {\n        units: [\n");
        for unit in &context.units {
            let _ = writeln!(
                text,
                "            Unit {{ bias_q18: {}, output_q10: {}, weights_q10: {:?} }},",
                unit.bias_q18, unit.output_q10, unit.weights_q10
            );
        }
        let _ = writeln!(text, "        ],\n        bias_q10: {},", context.bias_q10);
        table(text, "        ", "probability_q16", &context.probability_q16);
        text.push_str("    },\n");
    });
    text
}

/// The text of the core's file of constants for the depth of pixels.
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

/// Documentation of a constant that plans use unless they are given another.
const OF_PLANS: &str = "The models that plans use unless they are given others.";

/// The start of a file of constants, in lines of at most 100 columns.
fn head(command: &str, origin: &str, uses: &[&str]) -> String {
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
    let uses: String = uses.iter().map(|path| format!("use {path};\n")).collect();
    format!("{}\n\n{uses}", lines.join("\n"))
}

/// A constant of a struct, whose fields `fields` writes.
fn constant(
    text: &mut String,
    documentation: &str,
    name: &str,
    of: &str,
    fields: impl FnOnce(&mut String),
) {
    let of_struct = of.split('<').next().unwrap_or(of);
    let _ = write!(
        text,
        "\n/// {documentation}\n#[rustfmt::skip]\npub const {name}: {of} = {of_struct} {{\n"
    );
    fields(text);
    text.push_str("};\n");
}

/// The fields of a model with a standard deviation, each line indented.
fn fields<const N: usize>(
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
