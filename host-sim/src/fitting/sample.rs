//! Claims with evidence and truth.

use crate::frames::Truth;
use linestereo::{Candidate, Dims, EVIDENCE, Kind};

/// Distances from the edge at which claims are sampled: those that the core makes by default.
const DISTANCES: core::ops::RangeInclusive<u16> = 1..=4;

/// The two models' kinds of segments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SegmentKind {
    Steep,
    NearHorizontal,
}

/// The pixels that one side of one candidate claims at one distance.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    kind: SegmentKind,
    pub(super) evidence: [f64; EVIDENCE],
    /// `|claimed - true|` of the pixels with truth, px.
    pub(super) errors: Vec<f32>,
}

impl Sample {
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
    pub(super) fn of_kind(&self, kind: SegmentKind) -> impl Iterator<Item = &Sample> {
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

/// Samples every claim of `candidates` that has truth.
#[must_use]
pub fn scene_samples(candidates: &[Candidate], truth: &Truth, dims: Dims) -> SceneSamples {
    let mut samples = Vec::new();
    for candidate in candidates {
        let kind = if candidate.segment.near_horizontal { SegmentKind::NearHorizontal } else { SegmentKind::Steep };
        for (index, side) in candidate.sides.iter().enumerate() {
            let Some(side) = side else { continue };
            for distance in DISTANCES {
                let mut errors = Vec::new();
                candidate.for_each_pixel(index, distance, dims, |x, y, d_q6| {
                    let truth = truth.disparity(x.into(), y.into());
                    errors.extend(truth.map(|truth| (truth - d_q6 as f32 / 64.0).abs()));
                });
                if errors.is_empty() {
                    continue;
                }
                let mut evidence = side.evidence.0.map(|value| f64::from(value) / 256.0);
                evidence[Kind::Distance as usize] = distance.into();
                samples.push(Sample { kind, evidence, errors });
            }
        }
    }
    SceneSamples(samples)
}
