//! Several methods on the same frames: the core and, where it is installed, OpenCV's dense ones.
//!
//! In: a scene. Out: for each method its [`FrameScore`], the depths of the scene's objects, and its
//! time on one thread.
//!
//! OpenCV says nothing about confidence. The depth of an object by a dense method is the median of
//! at least `LEAST_DISPARITIES` disparities inside it.

mod table;

pub(crate) use table::{cell_comparison, comparison_table, object_comparison};

use crate::evaluate::{
    FrameScore, ObjectCase, ObjectScore, ObjectSummary, Outline, Summary, object_cases,
    score_objects,
};
use crate::opencv::{OpenCv, OpenCvMap};
use anyhow::Result;
use core::time::Duration;
use linestereo::results::{Point, Source};
use linestereo::units::{Confidence, Disparity};
use linestereo::{Dims, NoDepth, ObjectDepth, RunError, objects::Reason};
use linestereo_frames::statistics::upper_median;
use linestereo_frames::{Scene, Truth};
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_sim::results::mask::Mask;
use std::time::Instant;

/// Timing of a pair stops after this long, or after this many runs.
const TIMING_BUDGET: Duration = Duration::from_millis(100);
const TIMING_RUNS: usize = 9;
/// Fewer disparities make no depth of an object.
const LEAST_DISPARITIES: usize = 5;

/// Name of the core in tables.
const CORE: &str = "linestereo";

/// Result of one method on one frame.
#[derive(Clone, Debug)]
pub(crate) struct MethodScore {
    pub(crate) method: String,
    /// Its scores; of a scene without truth only yield and time.
    pub(crate) score: FrameScore,
    /// Its answers for the scene's objects.
    pub(crate) objects: Vec<ObjectScore>,
}

/// One method on all frames.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub(crate) struct MethodSummary {
    pub(crate) method: String,
    /// Its scores, pooled.
    #[serde(flatten)]
    pub(crate) summary: Summary,
    /// Depths of objects by what the core was given of them; empty where no scene has objects.
    pub(crate) objects: Vec<ObjectSummary>,
}

/// The scores of each method, in the order of the first frame.
pub(crate) fn summarise<'a>(
    frames: impl IntoIterator<Item = &'a [MethodScore]>,
) -> Vec<MethodSummary> {
    let frames: Vec<&[MethodScore]> = frames.into_iter().collect();
    let Some(first) = frames.first() else { return Vec::new() };
    let of = |(i, first): (usize, &MethodScore)| {
        let scores: Vec<&MethodScore> = frames.iter().map(|frame| &frame[i]).collect();
        let objects: Vec<ObjectScore> =
            scores.iter().flat_map(|score| score.objects.iter().cloned()).collect();
        MethodSummary {
            method: first.method.clone(),
            summary: Summary::pool(scores.iter().map(|score| &score.score)),
            objects: Outline::ALL
                .map(|outline| ObjectSummary::pool(outline, &objects))
                .into_iter()
                .filter(|summary| summary.objects > 0)
                .collect(),
        }
    };
    first.iter().enumerate().map(of).collect()
}

/// Matches a scene by the core and by OpenCV; takes no times. `core` makes the core's engine for a
/// scene.
pub(crate) fn compare_scene(
    scene: &Scene,
    opencv: Option<&OpenCv>,
    core: impl Fn(&Scene) -> Result<Engine>,
) -> Result<Vec<MethodScore>> {
    let truth = scene.truth.clone().unwrap_or_else(|| unknown(scene));
    let cases = if scene.truth.is_some() { object_cases(scene)? } else { Vec::new() };
    let score = |method: &str, result: &FrameResult, objects: Vec<ObjectScore>| MethodScore {
        method: method.to_owned(),
        score: FrameScore::new(&truth, result),
        objects,
    };
    let mut engine = core(scene)?;
    let result = engine.run(scene.left.view()?, scene.right.view()?)?;
    let mut scores = vec![score(CORE, &result, score_objects(&mut engine, &cases))];
    if let Some(opencv) = opencv {
        for OpenCvMap { name, disparities, .. } in matched_by(opencv, scene, 1)? {
            let points = FrameResult::of_points(points_of(&disparities, scene.left.dims));
            scores.push(score(name, &points, objects_of(&disparities, scene.left.dims, &cases)));
        }
    }
    Ok(scores)
}

/// Median times of a scene in milliseconds, on this thread, in the order of [`compare_scene`].
pub(crate) fn time_scene(
    scene: &Scene,
    opencv: Option<&OpenCv>,
    core: impl Fn(&Scene) -> Result<Engine>,
) -> Result<Vec<f64>> {
    let mut engine = core(scene)?;
    let (left, right) = (scene.left.view()?, scene.right.view()?);
    let mut times = vec![median_time(|| {
        let mut matched = engine.run_in_place(left, right)?;
        matched.points().for_each(|point| _ = core::hint::black_box(point));
        Ok::<_, RunError>(())
    })?];
    if let Some(opencv) = opencv {
        times.extend(matched_by(opencv, scene, TIMING_RUNS)?.iter().map(|map| map.milliseconds));
    }
    Ok(times)
}

/// Disparities up to the scene's range, in whole groups of 16, as OpenCV counts them.
fn matched_by(opencv: &OpenCv, scene: &Scene, runs: usize) -> Result<Vec<OpenCvMap>> {
    let disparities = usize::from(scene.max_disparity.max(1)).next_multiple_of(16);
    opencv.run(&scene.left, &scene.right, disparities, runs)
}

fn median_time<E>(mut run: impl FnMut() -> Result<(), E>) -> Result<f64, E> {
    let begin = Instant::now();
    let mut times = Vec::new();
    while times.is_empty() || (times.len() < TIMING_RUNS && begin.elapsed() < TIMING_BUDGET) {
        let start = Instant::now();
        run()?;
        times.push(start.elapsed());
    }
    let median = upper_median(times, Ord::cmp).unwrap_or_default();
    Ok(1e3 * median.as_secs_f64())
}

/// Truth that knows nothing: yields can be counted against it.
fn unknown(scene: &Scene) -> Truth {
    let count = scene.left.pixels.len();
    Truth::new(scene.left.dims, vec![f32::NAN; count], vec![false; count])
}

/// A map as points of the core, one per known pixel, of confidence 0. Disparities are rounded to
/// 1/64 px.
fn points_of(disparities: &[f32], dims: Dims) -> Vec<Point> {
    let width = usize::from(dims.width);
    let known = disparities.iter().enumerate().filter(|(_, disparity)| disparity.is_finite());
    let points = known.map(|(index, &disparity)| Point {
        x: (index % width) as u16,
        y: (index / width) as u16,
        disparity: Disparity::saturating_from_num(disparity),
        confidence: Confidence::ZERO,
        source: Source::Side,
    });
    points.collect()
}

fn objects_of(disparities: &[f32], dims: Dims, cases: &[ObjectCase]) -> Vec<ObjectScore> {
    let answer = |case: &ObjectCase| {
        let inside: Vec<f32> = case.region().map_or(Vec::new(), |region| {
            let mask = Mask::of(&region, dims);
            let values = mask.pixels().iter().zip(disparities);
            values
                .filter(|(inside, value)| **inside && value.is_finite())
                .map(|(_, &value)| value)
                .collect()
        });
        case.score(&median_depth(inside))
    };
    cases.iter().map(answer).collect()
}

/// A median and how many values it has; nothing is known of its confidence.
fn median_depth(values: Vec<f32>) -> Result<ObjectDepth, NoDepth> {
    let support = u16::try_from(values.len()).unwrap_or(u16::MAX);
    match upper_median(values, f32::total_cmp) {
        Some(median) if usize::from(support) >= LEAST_DISPARITIES => Ok(ObjectDepth {
            disparity: Disparity::saturating_from_num(median),
            sigma: Disparity::ZERO,
            slope_q10: [0; 2],
            spread: Disparity::ZERO,
            metres: None,
            support,
            confidence: Confidence::ZERO,
        }),
        _ => Err(NoDepth { reason: Reason::LittleSupport, support }),
    }
}
