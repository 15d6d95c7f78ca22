//! Several methods on the same frames: the core, the baselines and, where it is installed, OpenCV.
//!
//! In: a scene. Out: for each method its [`FrameScore`], the depths of the scene's objects, and its
//! time on one thread.
//!
//! A baseline's confidence is the uniqueness of its match (`1 - best cost / second`), so that its
//! curve of error against yield can be read like that of the core. OpenCV gives none. The depth of
//! an object by a baseline is the median of at least `LEAST_DISPARITIES` disparities inside it.

mod opencv;
mod table;

pub use opencv::{OPENCV_METHODS, OpenCv, OpenCvError, OpenCvMap, PYTHON_VARIABLE};
pub use table::{cell_comparison, comparison_table, object_comparison};

use crate::evaluate::{
    FrameScore, ObjectCase, ObjectScore, ObjectSummary, Outline, Summary, object_cases,
    score_objects,
};
use anyhow::Result;
use core::time::Duration;
use linestereo::{Disparity, NoDepth, ObjectDepth};
use linestereo_baselines::{DisparityMap, Method, Search};
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

/// A method that takes part in a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contender {
    /// The core.
    Core,
    /// A baseline.
    Baseline(Method),
}

impl Contender {
    /// The core and every baseline, in the order of tables.
    pub const ALL: [Self; 6] = [
        Self::Core,
        Self::Baseline(Method::Bm),
        Self::Baseline(Method::BmStrict),
        Self::Baseline(Method::Census),
        Self::Baseline(Method::Sgm8),
        Self::Baseline(Method::Sgm8Strict),
    ];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Core => "linestereo",
            Self::Baseline(method) => method.name(),
        }
    }

    /// The one of this name; the error lists all names.
    pub fn named(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|contender| contender.name() == name).ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("there is no method {name}; give {names}")
        })
    }
}

/// Result of one method on one frame.
#[derive(Clone, Debug)]
pub struct MethodScore {
    /// Name of the method.
    pub method: String,
    /// Its scores; of a scene without truth only yield and time.
    pub score: FrameScore,
    /// Its answers for the scene's objects.
    pub objects: Vec<ObjectScore>,
    /// Its map, for a picture.
    pub result: Option<FrameResult>,
}

/// One method on all frames.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct MethodSummary {
    /// Name of the method.
    pub method: String,
    /// Its scores, pooled.
    #[serde(flatten)]
    pub summary: Summary,
    /// Does it say how sure it is? Without, its curve of error against yield means nothing.
    pub has_confidence: bool,
    /// Depths of objects by what the core was given of them; empty where no scene has objects.
    pub objects: Vec<ObjectSummary>,
}

/// The scores of each method, in the order of the first frame.
#[must_use]
pub fn summarise<'a>(frames: impl IntoIterator<Item = &'a [MethodScore]>) -> Vec<MethodSummary> {
    let frames: Vec<&[MethodScore]> = frames.into_iter().collect();
    let Some(first) = frames.first() else { return Vec::new() };
    let of = |(i, first): (usize, &MethodScore)| {
        let scores: Vec<&MethodScore> = frames.iter().map(|frame| &frame[i]).collect();
        let objects: Vec<ObjectScore> =
            scores.iter().flat_map(|score| score.objects.iter().cloned()).collect();
        let mut confidences = scores.iter().flat_map(|score| score.score.confidences.iter());
        let any = confidences.next();
        MethodSummary {
            method: first.method.clone(),
            summary: Summary::pool(scores.iter().map(|score| &score.score)),
            has_confidence: confidences.any(|confidence| Some(confidence) != any),
            objects: Outline::ALL
                .map(|outline| ObjectSummary::pool(outline, &objects))
                .into_iter()
                .filter(|summary| summary.objects > 0)
                .collect(),
        }
    };
    first.iter().enumerate().map(of).collect()
}

/// Matches a scene by every contender and by OpenCV; takes no times. `core` makes the core's engine
/// for a scene.
pub fn compare_scene(
    scene: &Scene,
    contenders: &[Contender],
    opencv: Option<&OpenCv>,
    core: impl Fn(&Scene) -> Result<Engine>,
) -> Result<Vec<MethodScore>> {
    let truth = scene.truth.clone().unwrap_or_else(|| unknown(scene));
    let cases = if scene.truth.is_some() { object_cases(scene)? } else { Vec::new() };
    let score = |method: &str, result: FrameResult, objects: Vec<ObjectScore>| {
        let score = FrameScore::new(&scene.name, &truth, &result);
        MethodScore { method: method.to_owned(), score, objects, result: Some(result) }
    };
    let of_map = |name: &str, map: &DisparityMap| {
        score(name, FrameResult::of_points(map.points()), objects_of(map, &cases))
    };
    let mut scores = Vec::new();
    for contender in contenders {
        scores.push(match contender {
            Contender::Core => {
                let mut engine = core(scene)?;
                let result = engine.run(scene.left.view()?, scene.right.view()?)?;
                let objects = score_objects(&mut engine, &cases);
                score(contender.name(), result, objects)
            }
            Contender::Baseline(method) => {
                of_map(method.name(), &method.run(&scene.left, &scene.right, scene.max_disparity))
            }
        });
    }
    if let Some(opencv) = opencv {
        let search = Search::up_to(scene.left.dims, scene.max_disparity);
        let found = opencv.run(&scene.left, &scene.right, search, 1)?;
        scores.extend(found.iter().map(|found| of_map(found.name, &found.map)));
    }
    Ok(scores)
}

/// Median times of a scene in milliseconds, on this thread, in the order of [`compare_scene`].
pub fn time_scene(
    scene: &Scene,
    contenders: &[Contender],
    opencv: Option<&OpenCv>,
    core: impl Fn(&Scene) -> Result<Engine>,
) -> Result<Vec<f64>> {
    let mut times = Vec::new();
    for contender in contenders {
        times.push(match contender {
            Contender::Core => {
                let mut engine = core(scene)?;
                let (left, right) = (scene.left.view()?, scene.right.view()?);
                median_time(|| {
                    let points = |point| _ = core::hint::black_box(point);
                    engine.run_in_place(left, right).map(|mut matched| matched.points(points))
                })?
            }
            Contender::Baseline(method) => median_time(|| {
                core::hint::black_box(method.run(&scene.left, &scene.right, scene.max_disparity));
                Ok::<_, anyhow::Error>(())
            })?,
        });
    }
    if let Some(opencv) = opencv {
        let search = Search::up_to(scene.left.dims, scene.max_disparity);
        let found = opencv.run(&scene.left, &scene.right, search, TIMING_RUNS)?;
        times.extend(found.iter().map(|found| found.milliseconds));
    }
    Ok(times)
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

fn objects_of(map: &DisparityMap, cases: &[ObjectCase]) -> Vec<ObjectScore> {
    let answer = |case: &ObjectCase| {
        let inside: Vec<f32> = case.region().map_or(Vec::new(), |region| {
            let mask = Mask::of(&region, map.dims());
            let values = mask.pixels().iter().zip(map.values());
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
fn median_depth(values: Vec<f32>) -> ObjectDepth {
    let support = u16::try_from(values.len()).unwrap_or(u16::MAX);
    let nothing = ObjectDepth::refused(0, NoDepth::LittleSupport, support);
    match upper_median(values, f32::total_cmp) {
        Some(median) if usize::from(support) >= LEAST_DISPARITIES => {
            ObjectDepth { disparity: Ok(Disparity::saturating_from_num(median)), ..nothing }
        }
        _ => nothing,
    }
}
