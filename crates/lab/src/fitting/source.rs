//! The fitted constants as Rust source.

use core::fmt::Write;
use linestereo::unstable::{
    BAR_EVIDENCE, Model, Models, PIXEL_EVIDENCE, SigmaModel, SupportModels,
};

/// The text of the core's file of constants; `origin` names the frames.
pub(crate) fn source_text(models: &Models, origin: &str) -> String {
    let mut text = head("fit-confidence", origin, &["super::{Model, Models, SigmaModel}"]);
    constant(&mut text, OF_PLANS, "FITTED", "Models", |text| {
        let Models { near_vertical, near_horizontal, .. } = models;
        model(text, "    ", "near_vertical", near_vertical);
        model(text, "    ", "near_horizontal", near_horizontal);
        for (name, model) in [
            ("near_vertical_edge", &models.near_vertical_edge),
            ("near_horizontal_edge", &models.near_horizontal_edge),
        ] {
            let _ = writeln!(text, "    {name}: SigmaModel {{");
            fields(text, "        ", model);
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
            self::model(text, "    ", name, model);
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
pub fn pixel_source_text(model: &SigmaModel<PIXEL_EVIDENCE>, origin: &str) -> String {
    let uses = ["super::PIXEL_EVIDENCE", "crate::confidence::{Model, SigmaModel}"];
    let mut text = head("fit-confidence", origin, &uses);
    let documentation = "The model that plans use unless they are given another.";
    constant(&mut text, documentation, "FITTED_PIXEL", "SigmaModel<PIXEL_EVIDENCE>", |text| {
        fields(text, "    ", model);
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
            fields(text, "    ", model);
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
fn fields<const N: usize>(text: &mut String, indent: &str, model: &SigmaModel<N>) {
    self::model(text, indent, "model", &model.model);
    table(text, indent, "sigma_q6", &model.sigma_q6);
}

fn model<const N: usize>(text: &mut String, indent: &str, name: &str, model: &Model<N>) {
    let _ = writeln!(text, "{indent}{name}: Model {{");
    let inner = &format!("{indent}    ");
    let _ = writeln!(text, "{inner}bias_q12: {},", model.bias_q12);
    table(text, inner, "coefficients_q12", &model.coefficients_q12);
    table(text, inner, "probability_q16", &model.probability_q16);
    let _ = writeln!(text, "{indent}}},");
}

/// Numbers in lines of equal length, eleven a line at most.
fn table(text: &mut String, indent: &str, name: &str, table: &[impl ToString]) {
    let _ = writeln!(text, "{indent}{name}: [");
    for row in table.chunks(table.len().div_ceil(table.len().div_ceil(11))) {
        let row: Vec<String> = row.iter().map(ToString::to_string).collect();
        let _ = writeln!(text, "{indent}    {},", row.join(", "));
    }
    let _ = writeln!(text, "{indent}],");
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::unstable::{
        FITTED, FITTED_BAR, FITTED_LEVEL_BAR, FITTED_PIXEL, FITTED_SUPPORT,
    };

    /// Is the core's file of these constants what is written of the origin that it names?
    #[track_caller]
    fn check(folder: &str, written: impl Fn(&str) -> String) {
        let path = format!("{}/../../core/src/{folder}/fitted.rs", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(path).unwrap();
        let said = text.replace("\n//! ", " ");
        let (said, _) = said.split_once(": do not edit.").unwrap();
        let (_, origin) = said.split_once(" from ").unwrap();
        assert_eq!(written(origin), text);
    }

    #[test]
    fn the_constants_of_the_core_are_written_as_they_stand() {
        check("confidence", |origin| source_text(&FITTED, origin));
        check("support", |origin| support_source_text(&FITTED_SUPPORT, origin));
        check("query", |origin| pixel_source_text(&FITTED_PIXEL, origin));
        check("bars", |origin| bar_source_text(&[FITTED_BAR, FITTED_LEVEL_BAR], origin));
    }
}
