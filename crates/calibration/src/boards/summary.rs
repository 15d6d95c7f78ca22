//! A calibration in words, and as JSON.

use super::estimate::{Estimate, Parameter};
use super::quality::{Assessment, Finding, Rectified, Verdict};
use core::fmt::Write;
use linestereo_rig::CameraSide;
use serde_json::{Value, json};

/// Numbers that decide about trust in it.
pub fn summary(estimate: &Estimate, assessment: &Assessment, max_disparity: u16) -> String {
    let used = estimate.views.iter().filter(|view| view.dropped.is_none()).count();
    let baseline = estimate.calibration.baseline();
    let mut text = format!(
        "stereo RMS {:.3} px\nleft RMS {:.3} px, right RMS {:.3} px, {used} of {} views used\n\
         baseline {:.2} +- {:.2} mm\n",
        estimate.rms,
        estimate.camera_rms[0],
        estimate.camera_rms[1],
        estimate.views.len(),
        1e3 * baseline,
        1e3 * estimate.baseline_sigma,
    );
    if let Some(rectified) = &assessment.rectified {
        rectified_text(&mut text, rectified, max_disparity);
    }
    for (coverage, side) in assessment.coverage.iter().zip(["left", "right"]) {
        let _ = write!(
            text,
            "coverage {side}: corners in {:.0} % of the image's cells, up to {:.0} % of the way to its corners",
            100.0 * coverage.share,
            100.0 * coverage.reach
        );
        let _ = match coverage.unseen.as_slice() {
            [] => writeln!(text),
            unseen => writeln!(text, "; none in the {}", unseen.join(", ")),
        };
    }
    parameter_table(&mut text, &estimate.parameters);
    view_table(&mut text, estimate, assessment.rectified.as_ref());
    let _ = writeln!(text, "verdict: {}", assessment.verdict);
    for Finding { verdict, reason, remedy } in &assessment.findings {
        let _ = writeln!(text, "  {verdict}: {reason}; {remedy}");
    }
    if assessment.verdict == Verdict::Good {
        text.push_str("  calibrate again when the cameras were moved, dropped or focused\n");
    }
    text
}

fn rectified_text(text: &mut String, rectified: &Rectified, max_disparity: u16) {
    let Rectified { rectification, field, kept, near, far, vertical, .. } = rectified;
    let _ = writeln!(
        text,
        "vertical residual {vertical:.3} px (mean difference of rows of the same corner, rectified)"
    );
    let _ = writeln!(
        text,
        "rectified {}: focal length {:.1} px, field of view {:.1} x {:.1} degrees, {:.0} % of the left and {:.0} % of the right image left",
        rectification.dims(),
        rectification.focal(),
        field[0],
        field[1],
        100.0 * kept[0],
        100.0 * kept[1],
    );
    let _ = writeln!(
        text,
        "range at this size: from {near:.2} m (--max-disparity {max_disparity}); an error of 0.25 px costs 10 % at {far:.2} m"
    );
}

/// Both cameras side by side, then the pose.
fn parameter_table(text: &mut String, parameters: &[Parameter]) {
    let value = |parameter: &Parameter| match parameter.sigma {
        0.0 => format!("{:12.5} held      ", parameter.value),
        sigma => format!("{:12.5} +-{sigma:8.5}", parameter.value),
    };
    text.push_str("             left                    right\n");
    for left in parameters.iter().filter(|parameter| parameter.name.starts_with("left.")) {
        let name = left.name.trim_start_matches("left.");
        let Some(right) = parameters.iter().find(|other| other.name == format!("right.{name}"))
        else {
            continue;
        };
        let _ = writeln!(text, "  {name:4} {} {}", value(left), value(right));
    }
    for (title, first, unit, scale) in [
        ("rotation", "r", "degrees", 180.0 / core::f64::consts::PI),
        ("translation", "t", "mm", 1e3),
    ] {
        let of = |axis: &str| {
            parameters.iter().find(|parameter| parameter.name == format!("pose.{first}{axis}"))
        };
        let shown = ["x", "y", "z"].into_iter().filter_map(of);
        let shown: Vec<String> =
            shown.map(|p| format!("{:.3} +- {:.3}", scale * p.value, scale * p.sigma)).collect();
        let _ = writeln!(text, "  {title} {} {unit}", shown.join(", "));
    }
}

fn view_table(text: &mut String, estimate: &Estimate, rectified: Option<&Rectified>) {
    text.push_str("  view          left px  right px  rows px  tilt\n");
    for (index, view) in estimate.views.iter().enumerate() {
        let _ = write!(text, "  {:12} ", view.name);
        if let Some(why) = &view.dropped {
            let _ = writeln!(text, " dropped: {why}");
            continue;
        }
        let vertical =
            rectified.and_then(|rectified| rectified.view_vertical[index]).unwrap_or(0.0);
        let _ = write!(
            text,
            "{:8.3} {:9.3} {vertical:8.3} {:5.0}",
            view.rms[0], view.rms[1], view.tilt
        );
        let _ = match view.bad_corners {
            0 => writeln!(text),
            bad => writeln!(text, "  {bad} corners left out"),
        };
    }
}

/// The same and all parameters for programs.
pub fn json(estimate: &Estimate, assessment: &Assessment) -> Value {
    let vertical = |index: usize| {
        assessment.rectified.as_ref().and_then(|rectified| rectified.view_vertical[index])
    };
    let views = estimate.views.iter().enumerate().map(|(index, view)| {
        json!({
            "name": view.name, "rms_px": view.rms, "vertical_px": vertical(index), "tilt_deg": view.tilt,
            "bad_corners": view.bad_corners, "dropped": view.dropped.map(|why| why.to_string()),
        })
    });
    let parameters = estimate
        .parameters
        .iter()
        .map(|p| (p.name.clone(), json!({"value": p.value, "sigma": p.sigma})));
    let coverage = |eye: CameraSide| {
        let coverage = &assessment.coverage[usize::from(eye == CameraSide::Right)];
        json!({"share": coverage.share, "reach": coverage.reach, "unseen": coverage.unseen})
    };
    let rectified = assessment.rectified.as_ref().map(|rectified| {
        let dims = rectified.rectification.dims();
        json!({
            "size": [dims.width, dims.height], "focal_px": rectified.rectification.focal(), "field_deg": rectified.field,
            "kept": rectified.kept, "near_m": rectified.near, "far_m": rectified.far,
        })
    });
    let finding = |finding: &Finding| json!({"verdict": finding.verdict.to_string(), "reason": finding.reason, "remedy": finding.remedy});
    json!({
        "stereo_rms_px": estimate.rms,
        "camera_rms_px": estimate.camera_rms,
        "corner_sigma_px": estimate.sigma,
        "baseline_m": {"value": estimate.calibration.baseline(), "sigma": estimate.baseline_sigma},
        "vertical_residual_px": assessment.rectified.as_ref().map(|rectified| rectified.vertical),
        "coverage": {"left": coverage(CameraSide::Left), "right": coverage(CameraSide::Right)},
        "rectified": rectified,
        "parameters": parameters.collect::<serde_json::Map<_, _>>(),
        "views": views.collect::<Vec<_>>(),
        "verdict": assessment.verdict.to_string(),
        "findings": assessment.findings.iter().map(finding).collect::<Vec<_>>(),
    })
}
