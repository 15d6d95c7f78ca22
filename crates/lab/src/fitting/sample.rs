//! Answers with evidence and truth.

use crate::bench::GLOSSY;
use anyhow::{Context, Result};
use linestereo::unstable::{
    Observer, SegmentEvidence, SegmentKind, StageEvent, SupportEvidence, ValidPixels,
};
use linestereo::{Matched, Params};
use linestereo_frames::{Scene, Truth, load_values};
use linestereo_sim::engine::Engine;

/// Pixels from the edge up to which answers are sampled: those that the core makes by default.
const REACH: u16 = Params::DEFAULT.reach;

/// The scene without the truth of what shines, in rendered rooms: a mirror shows another place.
pub fn without_gloss(scene: Scene) -> Result<Scene> {
    let labels = scene.folder.join("labels.png");
    if !labels.is_file() {
        return Ok(scene);
    }
    let (_, labels) =
        load_values(&labels).with_context(|| format!("cannot read {}", labels.display()))?;
    let truth = scene
        .truth
        .map(|truth| truth.without(|index| labels.get(index).copied() == Some(GLOSSY.into())));
    Ok(Scene { truth, ..scene })
}

/// Subject of each of the models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SampleKind {
    NearVerticalSide,
    NearHorizontalSide,
    NearVerticalEdge,
    NearHorizontalEdge,
    Support,
    /// Where the ground plane is looked for.
    SupportOfGround,
    /// Of images that are matched at half of their size first.
    FineSupport,
    /// Among neighbours that have log-odds.
    Context,
}

/// The pixels that one side of one candidate reports at one distance, or one pixel that was asked
/// for.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    pub(super) evidence: Vec<f64>,
    /// `|reported - true|` of the pixels with truth, px.
    pub(super) errors: Vec<f32>,
}

impl Sample {
    pub(super) fn new(evidence_q8: &[i16], errors: Vec<f32>) -> Self {
        let evidence = evidence_q8.iter().map(|&value| f64::from(value) / 256.0).collect();
        Self { evidence, errors }
    }

    /// Pixels within 1 px, and the others.
    pub(super) fn outcome(&self) -> (f64, f64) {
        let right = self.errors.iter().filter(|&&error| error <= 1.0).count();
        (right as f64, (self.errors.len() - right) as f64)
    }
}

/// All samples of one pair.
#[derive(Clone, Debug)]
pub struct SceneSamples {
    /// Name of the scene: samples of the same one are never scored by a model that has seen one of
    /// them.
    pub(super) scene: String,
    samples: Vec<(SampleKind, Sample)>,
}

impl SceneSamples {
    /// Both are of the same scene.
    pub fn shows(&self, name: &str) -> bool {
        self.scene == what_it_shows(name)
    }

    pub(super) fn of_kind(&self, kind: SampleKind) -> impl Iterator<Item = &Sample> {
        self.samples.iter().filter(move |(of, _)| *of == kind).map(|(_, sample)| sample)
    }
}

/// The evidence of a run, which the core itself does not keep.
#[derive(Clone, Debug, Default)]
pub struct EvidenceLog {
    sides: Vec<[SegmentEvidence; 2]>,
    /// Of support points, with their places.
    support: Vec<(usize, SupportEvidence)>,
}

impl Observer for EvidenceLog {
    fn on_event(&mut self, step: StageEvent<'_>) {
        if let StageEvent::Segment(Ok((_, &evidence))) = step {
            self.sides.push(evidence);
        }
    }

    fn support_point(&mut self, place: usize, &evidence: &SupportEvidence) {
        self.support.push((place, evidence));
    }
}

/// Adds the support points of the last run, with the ground plane, that have truth; `log` watched
/// it.
pub(crate) fn add_ground_samples(
    samples: &mut SceneSamples,
    engine: &mut Engine,
    log: &EvidenceLog,
    truth: &Truth,
) {
    let matched = engine.matched();
    let support = matched.support();
    let kind =
        if support.is_fine() { SampleKind::FineSupport } else { SampleKind::SupportOfGround };
    samples.samples.extend(support_samples(kind, matched, log, truth));
    if support.plane().is_some() && !support.is_fine() {
        samples.samples.extend(support_samples(SampleKind::Context, matched, log, truth));
    }
}

/// Samples every answer of the last run that has truth; `log` watched it.
#[must_use]
pub fn scene_samples(
    scene: &str,
    engine: &mut Engine,
    log: &EvidenceLog,
    truth: &Truth,
) -> SceneSamples {
    let matched = engine.matched();
    let (candidates, dims) = (matched.candidates(), matched.dims());
    let support = matched.support();
    let mut samples = Vec::new();
    if !support.is_fine() {
        for kind in [SampleKind::Support, SampleKind::Context] {
            samples.extend(support_samples(kind, matched, log, truth));
        }
    }
    for (candidate, logged) in candidates.iter().zip(&log.sides) {
        let flat = candidate.segment.near_horizontal;
        let (side_kind, edge_kind) = if flat {
            (SampleKind::NearHorizontalSide, SampleKind::NearHorizontalEdge)
        } else {
            (SampleKind::NearVerticalSide, SampleKind::NearVerticalEdge)
        };
        // The nearest truth within 1 px across the edge, as segments are scored.
        let at_edge = |x: i32, y: i32, d: f32| {
            let near = (-1..=1).filter_map(|k| {
                if flat { truth.disparity(x, y + k) } else { truth.disparity(x + k, y) }
            });
            near.map(|truth| (truth - d).abs()).reduce(f32::min)
        };
        let at_pixel =
            |x: i32, y: i32, d: f32| truth.disparity(x, y).map(|truth| (truth - d).abs());
        for (index, (side, logged)) in candidate.sides.iter().zip(logged).enumerate() {
            let Some(side) = side else { continue };
            let known = logged.with_nearby(side.nearby);
            for distance in 0..=REACH {
                let pixels = candidate.pixels(index, distance, ValidPixels::whole(dims));
                let errors = pixels.filter_map(|(x, y, d_q6)| {
                    let (x, y, d) = (i32::from(x), i32::from(y), d_q6 as f32 / 64.0);
                    if distance == 0 { at_edge(x, y, d) } else { at_pixel(x, y, d) }
                });
                let errors: Vec<f32> = errors.collect();
                if errors.is_empty() {
                    continue;
                }
                let mut evidence = known.0.map(|value| f64::from(value) / 256.0).to_vec();
                evidence[SegmentKind::Distance as usize] = distance.into();
                let next_to_edge = distance == 1 && !candidate.is_one_surface();
                evidence[SegmentKind::NextToEdge as usize] = f64::from(u8::from(next_to_edge));
                let kind = if distance == 0 { edge_kind } else { side_kind };
                samples.push((kind, Sample { evidence, errors }));
            }
        }
    }
    SceneSamples { scene: what_it_shows(scene), samples }
}

/// The same scene at another size has the same name, in capitals or not, or with more behind a `_`.
fn what_it_shows(name: &str) -> String {
    name.split('_').next().unwrap_or_default().to_lowercase()
}

/// Support points by their own evidence or, as a context, by the log-odds that the models of this
/// run give their neighbours.
fn support_samples(
    kind: SampleKind,
    matched: &Matched<'_>,
    log: &EvidenceLog,
    truth: &Truth,
) -> impl Iterator<Item = (SampleKind, Sample)> {
    let support = matched.support();
    log.support.iter().filter_map(move |&(place, evidence)| {
        let ((x, y), point) = support.listed(place)?;
        let errors =
            vec![(truth.disparity(x.into(), y.into())? - point.disparity().to_num::<f32>()).abs()];
        let sample = match kind {
            SampleKind::Context if point.is_of_bar() => return None,
            SampleKind::Context => Sample::new(&matched.context(place)?.0, errors),
            _ => Sample::new(&support.with_nearby(place, evidence).0, errors),
        };
        Some((kind, sample))
    })
}
