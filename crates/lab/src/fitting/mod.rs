//! Fitting the confidence models of the core on frames with truth.
//!
//! ```text
//! samples: every answer of every candidate, with its evidence and how many of its pixels are right
//! line:    penalised logistic regression of "within 1 px" on the evidence                          (logistic)
//! tables:  probability and spread of the scores of scenes that the line has not seen               (calibration)
//! ```

mod calibration;
mod logistic;
mod network;
mod sample;
mod source;

pub(crate) use sample::add_ground_samples;
pub use sample::{EvidenceLog, SceneSamples, scene_samples, without_gloss};
pub use source::pixel_source_text;
pub(crate) use source::{bar_source_text, source_text, support_source_text};

use crate::evaluate::QueriedPixel;
use crate::thin::Told;
use linestereo::unstable::{
    BAR_EVIDENCE, Model, Models, Network, PIXEL_EVIDENCE, SigmaModel, SupportModels,
};
use linestereo_sim::engine::FittedModels;
use logistic::Line;
use network::Layers;
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
pub fn fit(pairs: &[&SceneSamples]) -> FittedModels {
    FittedModels {
        segments: Models {
            near_vertical: fit_kind(pairs, SampleKind::NearVerticalSide).model,
            near_horizontal: fit_kind(pairs, SampleKind::NearHorizontalSide).model,
            near_vertical_edge: fit_kind(pairs, SampleKind::NearVerticalEdge),
            near_horizontal_edge: fit_kind(pairs, SampleKind::NearHorizontalEdge),
        },
        support: SupportModels {
            upright: fit_kind(pairs, SampleKind::Support).model,
            ground: fit_kind(pairs, SampleKind::SupportOfGround).model,
            fine: fit_kind(pairs, SampleKind::FineSupport).model,
            context: fit_network(pairs),
        },
    }
}

/// Fits the model on the pixels that were asked for in each scene. Tables are fitted on scores of
/// each scene by a line fitted on the others.
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

/// The samples of one kind, those of each scene together.
fn by_scene<'a>(pairs: &[&'a SceneSamples], kind: SampleKind) -> Vec<Vec<&'a Sample>> {
    let mut scenes: BTreeMap<&str, Vec<&Sample>> = BTreeMap::new();
    for pair in pairs {
        scenes.entry(&pair.scene).or_default().extend(pair.of_kind(kind));
    }
    scenes.into_values().collect()
}

/// The network of support points among their neighbours.
fn fit_network<const N: usize>(pairs: &[&SceneSamples]) -> Network<N> {
    let scenes = by_scene(pairs, SampleKind::Context);
    let folds = FOLDS.min(scenes.len());
    let all = of_scenes(&scenes, &|_| true);
    let start = network::best_start(&all);
    let without = |fold: usize| match of_scenes(&scenes, &|i| i % folds != fold) {
        others if others.is_empty() => Layers::fit(&all, start),
        others => Layers::fit(&others, start),
    };
    let (layers, parts): (Layers, Vec<Layers>) = rayon::join(
        || Layers::fit(&all, start),
        || (0..folds).into_par_iter().map(without).collect(),
    );
    let held_out = held_out(&scenes, |i, sample| parts[i % folds].score(sample));
    layers.raw(calibration::tables(&held_out, &calibration::OF_NETWORKS).probability_q16)
}

/// Samples of each scene with scores of models that have not seen it.
fn held_out<'a>(
    scenes: &[Vec<&'a Sample>],
    score: impl Fn(usize, &Sample) -> f64,
) -> Vec<Vec<(f64, &'a Sample)>> {
    let of = |(i, scene): (usize, &Vec<&'a Sample>)| {
        scene.iter().map(|&sample| (score(i, sample), sample)).collect()
    };
    scenes.iter().enumerate().map(of).collect()
}

/// The samples of some of the scenes.
fn of_scenes<'a>(scenes: &[Vec<&'a Sample>], is_kept: &dyn Fn(usize) -> bool) -> Vec<&'a Sample> {
    let kept = scenes.iter().enumerate().filter(|(i, _)| is_kept(*i));
    kept.flat_map(|(_, scene)| scene.iter().copied()).collect()
}

fn fit_kind<const N: usize>(pairs: &[&SceneSamples], kind: SampleKind) -> SigmaModel<N> {
    let is_support =
        matches!(kind, SampleKind::Support | SampleKind::SupportOfGround | SampleKind::FineSupport);
    let penalty = if is_support { SUPPORT_PENALTY } else { SIDES_PENALTY };
    fit_scenes(&by_scene(pairs, kind), penalty)
}

/// The model of these samples, those of each scene together.
fn fit_scenes<const N: usize>(scenes: &[Vec<&Sample>], penalty: f64) -> SigmaModel<N> {
    let line = Line::fit(&of_scenes(scenes, &|_| true), penalty, None);
    let folds = FOLDS.min(scenes.len());
    let without = |fold: usize| match of_scenes(scenes, &|i| i % folds != fold) {
        // With one scene there is nothing to hold out: its own scores are all there is.
        others if others.is_empty() => line.clone(),
        others => Line::fit(&others, penalty, Some(&line)),
    };
    let lines: Vec<Line> = (0..folds).into_par_iter().map(without).collect();
    let held_out = held_out(scenes, |i, sample| lines[i % folds].score(sample));
    let tables = calibration::tables(&held_out, &calibration::OF_LINES);
    let (bias, coefficients) = line.raw();
    let mut coefficients_q12 = [0; N];
    for (q12, coefficient) in coefficients_q12.iter_mut().zip(coefficients) {
        *q12 = q(coefficient);
    }
    let probability_q16 = tables.probability_q16;
    let model = Model { bias_q12: q(bias), coefficients_q12, probability_q16 };
    SigmaModel { model, sigma_q6: tables.sigma_q6 }
}

/// Q12, within what the core's sums are proved for.
fn q(value: f64) -> i32 {
    (value.clamp(-127.0, 127.0) * 4096.0).round() as i32
}
