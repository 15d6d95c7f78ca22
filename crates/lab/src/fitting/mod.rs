//! Fitting the confidence models of the core on frames with truth.
//!
//! ```text
//! samples: every answer of every candidate, with its evidence and how many of its pixels are right
//! line:    penalised logistic regression of "within 1 px" on the evidence                          (logistic)
//! tables:  probability and spread of the scores of scenes that the line has not seen               (calibration)
//! ```

mod bars;
mod calibration;
mod logistic;
mod pixels;
mod sample;
mod source;

pub use bars::{bar_source_text, fit_bars};
pub use pixels::{fit_pixels, pixel_source_text};
pub use sample::{EvidenceLog, SceneSamples, add_ground_samples, scene_samples};
pub use source::{source_text, support_source_text};

use linestereo::unstable::{Model, Models, SEGMENT_EVIDENCE, SegmentKind, SupportModels};
use linestereo_sim::engine::FittedModels;
use logistic::Line;
use rayon::prelude::*;
use sample::{Sample, SampleKind};
use std::collections::BTreeMap;

/// Penalty on the coefficients of segments' answers. Neighbouring pixels and distances of one side
/// are no independent samples: a hundred of them weigh about as much as one answer.
const SIDES_PENALTY: f64 = 100.0;
/// Tables are fitted on scores of scenes that the line has not seen: so many lines, each without
/// its share of the scenes.
const FOLDS: usize = 8;
/// Support points are one pixel each.
const SUPPORT_PENALTY: f64 = 3.0;

/// Fits the models on these pairs. Tables are fitted on scores of each scene by a line fitted on
/// the others.
#[must_use]
pub fn fit(pairs: &[&SceneSamples]) -> FittedModels {
    FittedModels {
        segments: Models {
            near_vertical: fit_kind(pairs, SampleKind::NearVerticalSide),
            near_horizontal: fit_kind(pairs, SampleKind::NearHorizontalSide),
            near_vertical_edge: fit_kind(pairs, SampleKind::NearVerticalEdge),
            near_horizontal_edge: fit_kind(pairs, SampleKind::NearHorizontalEdge),
        },
        support: SupportModels {
            upright: fit_kind(pairs, SampleKind::Support),
            ground: fit_kind(pairs, SampleKind::SupportOfGround),
            fine: fit_kind(pairs, SampleKind::FineSupport),
        },
    }
}

fn fit_kind<const N: usize>(pairs: &[&SceneSamples], kind: SampleKind) -> Model<N> {
    let mut scenes: BTreeMap<&str, Vec<&Sample>> = BTreeMap::new();
    for pair in pairs {
        scenes.entry(&pair.scene).or_default().extend(pair.of_kind(kind));
    }
    let is_support =
        matches!(kind, SampleKind::Support | SampleKind::SupportOfGround | SampleKind::FineSupport);
    let penalty = if is_support { SUPPORT_PENALTY } else { SIDES_PENALTY };
    fit_scenes(&scenes.into_values().collect::<Vec<_>>(), penalty)
}

/// The model of these samples, those of each scene together.
fn fit_scenes<const N: usize>(scenes: &[Vec<&Sample>], penalty: f64) -> Model<N> {
    let of = |is_kept: &dyn Fn(usize) -> bool| -> Vec<&Sample> {
        let kept = scenes.iter().enumerate().filter(|(i, _)| is_kept(*i));
        kept.flat_map(|(_, scene)| scene.iter().copied()).collect()
    };
    let line = Line::fit(&of(&|_| true), penalty, None);
    let folds = FOLDS.min(scenes.len());
    let without = |fold: usize| match of(&|i| i % folds != fold) {
        // With one scene there is nothing to hold out: its own scores are all there is.
        others if others.is_empty() => line.clone(),
        others => Line::fit(&others, penalty, Some(&line)),
    };
    let lines: Vec<Line> = (0..folds).into_par_iter().map(without).collect();
    let held_out: Vec<Vec<(f64, &Sample)>> = scenes
        .iter()
        .enumerate()
        .map(|(i, scene)| {
            scene.iter().map(|sample| (lines[i % folds].score(sample), *sample)).collect()
        })
        .collect();
    let tables = calibration::tables(&held_out);
    let (bias, coefficients) = line.raw();
    let mut coefficients_q12 = [0; N];
    for (q12, coefficient) in coefficients_q12.iter_mut().zip(coefficients) {
        *q12 = q(coefficient);
    }
    Model {
        bias_q12: q(bias),
        coefficients_q12,
        probability_q16: tables.probability_q16,
        sigma_q6: tables.sigma_q6,
    }
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
