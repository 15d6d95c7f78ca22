//! Fitting the confidence models of the core on frames with truth.
//!
//! ```text
//! samples: every claim of every candidate, with its evidence and how many of its pixels are right
//! line:    penalised logistic regression of "within 1 px" on the evidence                          (logistic)
//! tables:  probability and spread of the scores of scenes that the line has not seen               (calibration)
//! ```

mod calibration;
mod logistic;
mod pixels;
mod sample;
mod source;

pub use pixels::{fit_pixels, pixel_source_text};
pub use sample::{EvidenceLog, SceneSamples, scene_samples};
pub use source::source_text;

use linestereo::{EVIDENCE, Kind, Model, Models};
use logistic::Line;
use sample::{Sample, SampleKind};

/// Fits both models on these scenes. Tables are fitted on scores of each scene by a line fitted on the others.
#[must_use]
pub fn fit(scenes: &[&SceneSamples]) -> Models {
    Models {
        steep: fit_kind(scenes, SampleKind::SteepSide),
        near_horizontal: fit_kind(scenes, SampleKind::FlatSide),
        steep_edge: fit_kind(scenes, SampleKind::SteepEdge),
        near_horizontal_edge: fit_kind(scenes, SampleKind::FlatEdge),
    }
}

fn fit_kind(scenes: &[&SceneSamples], kind: SampleKind) -> Model {
    let all: Vec<Vec<&Sample>> = scenes.iter().map(|scene| scene.of_kind(kind).collect()).collect();
    fit_scenes(&all)
}

/// The model of these samples, those of each scene together.
fn fit_scenes<const N: usize>(scenes: &[Vec<&Sample>]) -> Model<N> {
    let of = |skip: Option<usize>| -> Vec<&Sample> {
        let kept = scenes.iter().enumerate().filter(|(i, _)| Some(*i) != skip);
        kept.flat_map(|(_, scene)| scene.iter().copied()).collect()
    };
    let line = Line::fit(&of(None), None);
    let mut held_out = Vec::new();
    for (i, scene) in scenes.iter().enumerate() {
        // With one scene there is nothing to hold out: its own scores are all there is.
        let other = if scenes.len() > 1 { Line::fit(&of(Some(i)), Some(&line)) } else { line.clone() };
        held_out.extend(scene.iter().map(|sample| (other.score(sample), *sample)));
    }
    let tables = calibration::tables(&held_out);
    let (bias, coefficients) = line.raw();
    let mut coefficients_q12 = [0; N];
    for (q12, coefficient) in coefficients_q12.iter_mut().zip(coefficients) {
        *q12 = q(coefficient);
    }
    Model { bias_q12: q(bias), coefficients_q12, probability_q16: tables.probability_q16, sigma_q6: tables.sigma_q6 }
}

/// Q12, within what the core's sums are proved for.
fn q(value: f64) -> i32 {
    (value.clamp(-127.0, 127.0) * 4096.0).round() as i32
}

/// What each kind of evidence says, for tables and for the head of the written constants.
#[must_use]
pub fn names() -> [&'static str; EVIDENCE] {
    Kind::NAMES
}
