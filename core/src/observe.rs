//! Observers of a run: callbacks at the end of each stage, for timing, digests and pictures. The
//! observer `()` costs nothing.
//!
//! In: the result of each stage when it ends. Out: nothing; the result of the run does not depend
//! on its observer.

use crate::bars::Bar;
use crate::bars::evidence::BarEvidence;
use crate::evidence::SegmentEvidence;
use crate::fnv::Fnv;
use crate::health::PairHealth;
use crate::lines::Segment;
use crate::matching::{Candidate, SegmentCurves};
use crate::named::named_enum;
use crate::result::{Match, Point, Rejection};
use crate::support::evidence::SupportEvidence;
use crate::support::{SupportCurves, SupportPoint};
use core::hash::{Hash, Hasher};

/// The end of a stage, with its result. [`StageEvent::Rows`] and [`StageEvent::Segment`] occur
/// alternately, once per left segment; [`StageEvent::Health`] before and after matching; the others
/// once per pair.
#[derive(Clone, Copy, Debug)]
pub enum StageEvent<'a> {
    /// Segments of the left image.
    LinesLeft(&'a [Segment]),
    /// Segments of the right image.
    LinesRight(&'a [Segment]),
    /// Row offset of the pair, 1/32 px, and the prominent left segments.
    Selection(i32, &'a [Segment]),
    /// All support points, without evidence by neighbours.
    Support(&'a [SupportPoint]),
    /// Gradients and census of the rows that the next segment needs; [`Observer::row`] was called
    /// with each.
    Rows,
    /// One matched segment with the evidence of its sides, neighbours left out, or the test that it
    /// failed.
    Segment(Result<(&'a Candidate, &'a [SegmentEvidence; 2]), Rejection>),
    /// All candidates and all support points, with the evidence between them.
    Consistency(&'a [Candidate], &'a [SupportPoint]),
    /// The list of matches.
    Report(&'a [Match]),
    /// Health of the pair.
    Health(&'a PairHealth),
}

named_enum! {
    /// The stages in the order of their first steps.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    #[repr(usize)]
    pub enum Stage {
        /// Segments of the left image.
        LinesLeft = "lines_left",
        /// Segments of the right image.
        LinesRight = "lines_right",
        /// Row offset and the most prominent left segments.
        Selection = "selection",
        /// Support points.
        Support = "support",
        /// Gradients and census of both images.
        Rows = "rows",
        /// Three matchings of each segment, ownership.
        Matching = "matching",
        /// Evidence between hypotheses and support points.
        Consistency = "consistency",
        /// Probability, uniqueness, lists.
        Report = "report",
        /// Checks of the images before the run, and of its matches after it.
        Health = "health",
    }

    /// Every stage.
    const ALL;

    /// Name in snake case, as in tables.
    fn name;
}

impl StageEvent<'_> {
    /// Stage of the event.
    #[must_use]
    pub const fn stage(&self) -> Stage {
        match self {
            Self::LinesLeft(_) => Stage::LinesLeft,
            Self::LinesRight(_) => Stage::LinesRight,
            Self::Selection(..) => Stage::Selection,
            Self::Support(_) => Stage::Support,
            Self::Rows => Stage::Rows,
            Self::Segment(_) => Stage::Matching,
            Self::Consistency(..) => Stage::Consistency,
            Self::Report(_) => Stage::Report,
            Self::Health(_) => Stage::Health,
        }
    }
}

/// Callbacks of a run.
pub trait Observer {
    /// Called when a step has ended.
    fn on_event(&mut self, step: StageEvent<'_>);

    /// Called with each computed row of gradients and census codes: left gradients, right
    /// gradients, right census codes, the right ones mirrored.
    #[inline]
    fn row(&mut self, _planes: [&[u8]; 3]) {}

    /// Called with the index in the grid and the evidence, neighbours left out, of each support
    /// point that has a disparity.
    #[inline]
    fn support_point(&mut self, _index: usize, _evidence: &SupportEvidence) {}

    /// Called with the index in the grid and the costs of each support point that is compared,
    /// before [`Observer::support_point`].
    #[inline]
    fn support_curves(&mut self, _index: usize, _curves: &SupportCurves<'_>) {}

    /// Called with the index and the evidence of each bar that has a disparity, support points left
    /// out.
    #[inline]
    fn bar_evidence(&mut self, _index: usize, _evidence: &BarEvidence) {}

    /// Called with the index of each of these that is not behind the support points around it, with
    /// its probability, and the evidence by them, Q8.
    #[inline]
    fn bar(&mut self, _index: usize, _bar: &Bar, _nearby_q8: [i16; 4]) {}

    /// True where [`Observer::support_curves`] and [`Observer::segment_curves`] are to be called.
    #[inline]
    fn wants_curves(&self) -> bool {
        false
    }

    /// Called with the costs of each left segment, as far as they were computed, before its
    /// [`StageEvent::Segment`].
    #[inline]
    fn segment_curves(&mut self, _curves: &SegmentCurves<'_>) {}
}

/// No observer.
impl Observer for () {
    #[inline]
    fn on_event(&mut self, _: StageEvent<'_>) {}
}

/// One digest per stage, to find the stage in which the results of two machines differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StageDigests([u32; Stage::ALL.len()]);

impl StageDigests {
    /// Digests before the first event.
    #[must_use]
    pub const fn new() -> Self {
        Self([Fnv::EMPTY.value(); Stage::ALL.len()])
    }

    fn add(&mut self, stage: Stage, write: impl FnOnce(&mut Fnv)) {
        if let Some(slot) = self.0.get_mut(stage as usize) {
            let mut hash = Fnv(*slot);
            write(&mut hash);
            *slot = hash.0;
        }
    }

    /// Adds a point to the digest of [`Stage::Report`], which no event contains.
    pub fn add_point(&mut self, point: &Point) {
        self.add(Stage::Report, |hash| point.hash(hash));
    }

    /// The digest of one stage.
    #[must_use]
    pub fn of(&self, stage: Stage) -> u32 {
        self.0.get(stage as usize).copied().unwrap_or(0)
    }
}

impl Default for StageDigests {
    fn default() -> Self {
        Self::new()
    }
}

impl Observer for StageDigests {
    fn on_event(&mut self, step: StageEvent<'_>) {
        self.add(step.stage(), |hash| match step {
            StageEvent::LinesLeft(segments) | StageEvent::LinesRight(segments) => {
                each(segments, hash)
            }
            StageEvent::Selection(offset, segments) => {
                hash.write_i32(offset);
                each(segments, hash);
            }
            StageEvent::Rows => {} // by `row`
            StageEvent::Support(points) => each(points, hash),
            StageEvent::Segment(Ok((candidate, evidence))) => {
                candidate.hash(hash);
                each(evidence, hash);
            }
            StageEvent::Segment(Err(reason)) => hash.write_u8(reason as u8),
            StageEvent::Consistency(candidates, points) => {
                each(candidates, hash);
                each(points, hash);
            }
            StageEvent::Report(matches) => each(matches, hash),
            StageEvent::Health(health) => health.hash(hash),
        });
    }

    fn row(&mut self, planes: [&[u8]; 3]) {
        self.add(Stage::Rows, |hash| planes.iter().for_each(|plane| hash.write(plane)));
    }

    fn bar_evidence(&mut self, _: usize, evidence: &BarEvidence) {
        self.add(Stage::Matching, |hash| evidence.hash(hash));
    }

    fn bar(&mut self, _: usize, bar: &Bar, _: [i16; 4]) {
        self.add(Stage::Report, |hash| bar.hash(hash));
    }

    fn support_point(&mut self, _: usize, evidence: &SupportEvidence) {
        self.add(Stage::Support, |hash| evidence.hash(hash));
    }
}

/// Hashes items without their number, whose width depends on the machine.
fn each<T: Hash>(items: &[T], hash: &mut Fnv) {
    for item in items {
        item.hash(hash);
    }
}
