//! Observer of a run that keeps costs and outcome of every segment, bar and support point.

use super::curve::Curve;
use linestereo::results::{Bar, ImagePosition, Rejection};
use linestereo::unstable::kernel::JUMP_PENALTY;
use linestereo::unstable::{
    BarEvidence, Candidate, CurveKind, Observer, Segment, SegmentCurves, SegmentEvidence,
    StageEvent, SupportCurves,
};
use std::collections::HashMap;

/// A left segment that was matched, with its costs as far as they were computed.
#[derive(Clone, Debug)]
pub(super) struct TestedSegment {
    pub(super) segment: Segment,
    /// Of each side, of each half.
    pub(super) windows: [[Option<Curve>; 2]; 2],
    /// The edge's own, of each half.
    pub(super) edges: [Option<Curve>; 2],
    /// Of each side.
    pub(super) census: [Option<Curve>; 2],
    /// Position in the list of candidates with the evidence of the sides, or the test that it
    /// failed; nothing when it was not matched.
    pub(super) outcome: Result<(usize, [SegmentEvidence; 2]), Rejection>,
}

/// Costs of a support point, by rising disparity.
#[derive(Clone, Debug)]
pub(super) struct SupportCosts {
    pub(super) window: Curve,
    pub(super) paths: Curve,
}

/// A bar that does not lie behind what is around it, at any probability.
#[derive(Clone, Copy, Debug)]
pub(super) struct RatedBar {
    pub(super) bar: Bar,
    pub(super) evidence: BarEvidence,
}

/// Watches a run.
#[derive(Clone, Debug, Default)]
pub struct CurveLog {
    /// Prominent segments in the order in which they are matched, then the less prominent ones.
    pub(super) segments: Vec<TestedSegment>,
    /// By index in the grid.
    pub(super) support: HashMap<usize, SupportCosts>,
    pub(super) bars: Vec<RatedBar>,
    /// Of matched bars, by index, without support points.
    bar_evidence: HashMap<usize, BarEvidence>,
    outcomes_only: bool,
    found: Vec<Segment>,
    prominent: usize,
    matched: usize,
    candidates: usize,
}

/// A left segment that is not in the list of matches, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rejected {
    pub ends: [ImagePosition; 2],
    pub reason: Rejection,
}

impl CurveLog {
    /// Keeps outcomes, and no costs.
    pub fn outcomes_only() -> Self {
        Self { outcomes_only: true, ..Self::default() }
    }

    /// Everything that was rejected: as many of each reason as the run counted.
    pub fn rejected(&self, candidates: &[Candidate]) -> Vec<Rejected> {
        let of = |segment: &Segment, reason| Rejected { ends: segment.ends, reason };
        let (prominent, less) = self.segments.split_at(self.prominent);
        let tested = prominent.iter().take(self.matched);
        let tested = tested.filter_map(|tested| {
            Some(of(&tested.segment, tested.outcome.as_ref().err().copied()?))
        });
        // A pair that was refused leaves the candidates of the one before.
        let candidates = if self.candidates == candidates.len() { candidates } else { &[] };
        let weighed =
            candidates.iter().filter_map(|found| Some(of(&found.segment, found.rejection()?)));
        less.iter()
            .map(|less| of(&less.segment, Rejection::LessProminent))
            .chain(tested)
            .chain(weighed)
            .collect()
    }
}

fn untested(segment: &Segment) -> TestedSegment {
    TestedSegment {
        segment: *segment,
        windows: Default::default(),
        edges: Default::default(),
        census: Default::default(),
        outcome: Err(Rejection::LessProminent),
    }
}

impl Observer for CurveLog {
    fn on_event(&mut self, step: StageEvent<'_>) {
        match step {
            StageEvent::LinesLeft(found) => {
                *self = Self {
                    found: found.to_vec(),
                    outcomes_only: self.outcomes_only,
                    ..Self::default()
                };
            }
            StageEvent::Selection(_, prominent) => {
                let less = self.found.iter().filter(|segment| !prominent.contains(segment));
                self.segments = prominent.iter().chain(less).map(untested).collect();
                self.prominent = prominent.len();
            }
            StageEvent::Segment(outcome) => {
                if let Some(tested) = self.segments.get_mut(self.matched) {
                    tested.outcome = outcome.map(|(_, evidence)| (self.candidates, *evidence));
                }
                self.candidates += usize::from(outcome.is_ok());
                self.matched += 1;
            }
            _ => {}
        }
    }

    fn bar_evidence(&mut self, index: usize, evidence: &BarEvidence) {
        self.bar_evidence.insert(index, *evidence);
    }

    fn bar(&mut self, index: usize, bar: &Bar, nearby_q8: [i16; 4]) {
        if let Some(evidence) = self.bar_evidence.get(&index) {
            self.bars.push(RatedBar { bar: *bar, evidence: evidence.with_nearby(nearby_q8) });
        }
    }

    fn wants_curves(&self) -> bool {
        !self.outcomes_only
    }

    fn segment_curves(&mut self, curves: &SegmentCurves<'_>) {
        let Some(tested) = self.segments.get_mut(self.matched) else { return };
        let of = |kind| curves.of(kind).map(Curve::new);
        tested.windows = [0, 1].map(|side| [0, 1].map(|half| of(CurveKind::Window { side, half })));
        tested.edges = [0, 1].map(|half| of(CurveKind::Edge { half }));
        tested.census = [0, 1].map(|side| of(CurveKind::Census { side }));
    }

    fn support_curves(&mut self, index: usize, curves: &SupportCurves<'_>) {
        let rising = |costs: &[u8], penalty: u8| Curve {
            first: curves.largest + 1 - costs.len() as i32,
            costs: costs.iter().rev().map(|&cost| cost.saturating_sub(penalty).into()).collect(),
        };
        let costs = SupportCosts {
            window: rising(curves.window, JUMP_PENALTY),
            paths: rising(curves.paths, 0),
        };
        self.support.insert(index, costs);
    }
}
