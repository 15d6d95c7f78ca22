//! Fitting the confidence models of the core on frames with truth.
//!
//! ```text
//! samples: every answer of every candidate, with its evidence and how many of its pixels are right
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
pub use source::{source_text, support_source_text};

use linestereo::diagnostics::{Model, Models, SEGMENT_EVIDENCE, SegmentKind};
use linestereo_sim::engine::FittedModels;
use logistic::Line;
use rayon::prelude::*;
use sample::{Sample, SampleKind};
use std::collections::BTreeMap;

/// Penalty on the coefficients of segments' answers. Neighbouring pixels and distances of one side are no independent samples: a hundred of
/// them weigh about as much as one answer.
const SIDES_PENALTY: f64 = 100.0;
/// Support points are one pixel each.
const SUPPORT_PENALTY: f64 = 3.0;

/// Fits the models on these pairs. Tables are fitted on scores of each scene by a line fitted on the others.
#[must_use]
pub fn fit(pairs: &[&SceneSamples]) -> FittedModels {
    FittedModels {
        segments: Models {
            near_vertical: fit_kind(pairs, SampleKind::NearVerticalSide),
            near_horizontal: fit_kind(pairs, SampleKind::NearHorizontalSide),
            near_vertical_edge: fit_kind(pairs, SampleKind::NearVerticalEdge),
            near_horizontal_edge: fit_kind(pairs, SampleKind::NearHorizontalEdge),
        },
        support: fit_kind(pairs, SampleKind::Support),
    }
}

fn fit_kind<const N: usize>(pairs: &[&SceneSamples], kind: SampleKind) -> Model<N> {
    let mut scenes: BTreeMap<&str, Vec<&Sample>> = BTreeMap::new();
    for pair in pairs {
        scenes.entry(&pair.scene).or_default().extend(pair.of_kind(kind));
    }
    let penalty = if kind == SampleKind::Support { SUPPORT_PENALTY } else { SIDES_PENALTY };
    fit_scenes(&scenes.into_values().collect::<Vec<_>>(), penalty)
}

/// The model of these samples, those of each scene together.
fn fit_scenes<const N: usize>(scenes: &[Vec<&Sample>], penalty: f64) -> Model<N> {
    let of = |skip: Option<usize>| -> Vec<&Sample> {
        let kept = scenes.iter().enumerate().filter(|(i, _)| Some(*i) != skip);
        kept.flat_map(|(_, scene)| scene.iter().copied()).collect()
    };
    let line = Line::fit(&of(None), penalty, None);
    // With one scene there is nothing to hold out: its own scores are all there is.
    let scores: Vec<Vec<(f64, &Sample)>> = scenes
        .par_iter()
        .enumerate()
        .map(|(i, scene)| {
            let other = if scenes.len() > 1 { Line::fit(&of(Some(i)), penalty, Some(&line)) } else { line.clone() };
            scene.iter().map(|sample| (other.score(sample), *sample)).collect()
        })
        .collect();
    let tables = calibration::tables(&scores.concat());
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

/// Meaning of each kind of evidence, for tables and for the head of the written constants.
#[must_use]
pub fn names() -> [&'static str; SEGMENT_EVIDENCE] {
    SegmentKind::NAMES
}
