//! Claims with evidence and truth.

use crate::frames::Truth;
use linestereo::{Candidate, Dims, Evidence, Kind, Observer, Params, PixelEvidence, Step, Views};

/// Pixels from the edge up to which claims are sampled: those that the core makes by default.
const REACH: u16 = Params::DEFAULT.reach;

/// What each of the models is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SampleKind {
    SteepSide,
    FlatSide,
    SteepEdge,
    FlatEdge,
    Pixel,
}

/// The pixels that one side of one candidate claims at one distance, or one pixel that was asked for.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    kind: SampleKind,
    pub(super) evidence: Vec<f64>,
    /// `|claimed - true|` of the pixels with truth, px.
    pub(super) errors: Vec<f32>,
}

impl Sample {
    /// A pixel that was asked for; `error` is `|answer - true|`, px.
    pub(super) fn pixel(evidence: &PixelEvidence, error: f32) -> Self {
        let evidence = evidence.0.iter().map(|&value| f64::from(value) / 256.0).collect();
        Self { kind: SampleKind::Pixel, evidence, errors: vec![error] }
    }

    /// Pixels within 1 px, and the others.
    pub(super) fn outcome(&self) -> (f64, f64) {
        let right = self.errors.iter().filter(|&&error| error <= 1.0).count();
        (right as f64, (self.errors.len() - right) as f64)
    }
}

/// All samples of one scene.
#[derive(Clone, Debug)]
pub struct SceneSamples(Vec<Sample>);

impl SceneSamples {
    pub(super) fn of_kind(&self, kind: SampleKind) -> impl Iterator<Item = &Sample> {
        self.0.iter().filter(move |sample| sample.kind == kind)
    }

    /// Claims sampled.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Nothing was sampled.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// The evidence of every candidate of a run, which the core itself does not keep.
#[derive(Clone, Debug, Default)]
pub struct EvidenceLog(Vec<[Evidence; 2]>);

impl Observer for EvidenceLog {
    fn ended(&mut self, step: Step<'_>) {
        if let Step::Segment(Ok((_, &evidence))) = step {
            self.0.push(evidence);
        }
    }
}

/// Samples every claim of `candidates` that has truth; `log` watched the run that they come from.
#[must_use]
pub fn scene_samples(candidates: &[Candidate], log: &EvidenceLog, truth: &Truth, dims: Dims) -> SceneSamples {
    let mut samples = Vec::new();
    for (candidate, logged) in candidates.iter().zip(&log.0) {
        let flat = candidate.segment.near_horizontal;
        let (side_kind, edge_kind) = if flat {
            (SampleKind::FlatSide, SampleKind::FlatEdge)
        } else {
            (SampleKind::SteepSide, SampleKind::SteepEdge)
        };
        // The nearest truth within 1 px across the edge, as segments are scored.
        let at_edge = |x: i32, y: i32, d: f32| {
            let near =
                (-1..=1).filter_map(|k| if flat { truth.disparity(x, y + k) } else { truth.disparity(x + k, y) });
            near.map(|truth| (truth - d).abs()).reduce(f32::min)
        };
        let at_pixel = |x: i32, y: i32, d: f32| truth.disparity(x, y).map(|truth| (truth - d).abs());
        for (index, (side, logged)) in candidate.sides.iter().zip(logged).enumerate() {
            let Some(side) = side else { continue };
            let mut known = *logged;
            known.0[Kind::Support as usize] = side.support_q8;
            known.0[Kind::Conflict as usize] = side.conflict_q8;
            for distance in 0..=REACH {
                let mut errors: Vec<f32> = Vec::new();
                candidate.for_each_pixel(index, distance, Views::whole(dims), |x, y, d_q6| {
                    let (x, y, d) = (i32::from(x), i32::from(y), d_q6 as f32 / 64.0);
                    errors.extend(if distance == 0 { at_edge(x, y, d) } else { at_pixel(x, y, d) });
                });
                if errors.is_empty() {
                    continue;
                }
                let mut evidence = known.0.map(|value| f64::from(value) / 256.0).to_vec();
                evidence[Kind::Distance as usize] = distance.into();
                let kind = if distance == 0 { edge_kind } else { side_kind };
                samples.push(Sample { kind, evidence, errors });
            }
        }
    }
    SceneSamples(samples)
}
