//! Matched pair: access to its results, and evaluation on demand.
//!
//! In: a plan, the pair, the memory of its run. Out: segments, points, the depth of objects and pixels.
//!
//! It borrows the pair and the memory: while it lives, no other pair can be matched there.

use crate::ground::GroundPlane;
use crate::health::{Findings, PairHealth};
use crate::image::{Dims, Gray};
use crate::matching::Candidate;
use crate::objects::{NoDepth, ObjectDepth, ObjectQuery, Region};
use crate::plan::Plan;
use crate::query::{PixelDepth, PixelEvidence, PixelRejection, Query};
use crate::report::Report;
use crate::result::{Counts, Match, Point};
use crate::scratch::ScratchView;
use crate::side_pixels::ValidPixels;
use crate::support::{RangeCheck, Support};
use heapless::vec::VecView;

/// Counts, row offset and health of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Summary {
    pub(crate) counts: Counts,
    /// Rows to add to a left row for the matching right one, 1/32 px.
    pub(crate) row_offset_q5: i16,
    /// Detail of the left image, [`SupportKind::Detail`](crate::diagnostics::SupportKind::Detail), Q8.
    pub(crate) detail_q8: i16,
    pub(crate) range: RangeCheck,
    pub(crate) plane: Option<GroundPlane>,
    pub(crate) health: PairHealth,
}

impl Summary {
    /// The ground plane, if one was found.
    #[must_use]
    pub const fn ground(&self) -> Option<GroundPlane> {
        self.plane
    }

    /// Numbers of segments found, dropped, matched and rejected.
    #[must_use]
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// Health of the pair; good when it was not checked.
    #[must_use]
    pub fn health(&self) -> &PairHealth {
        &self.health
    }

    /// Windows that match beyond the disparity range.
    #[must_use]
    pub fn range(&self) -> RangeCheck {
        self.range
    }

    /// Row of the right image that matches row 0 of the left one, px.
    pub(crate) fn row_offset(&self) -> i32 {
        (i32::from(self.row_offset_q5) + 16) >> 5
    }

    /// Rows to add to a left row for the matching right one, 1/32 px: by near-horizontal segments of both images, or as given by
    /// [`Focus`](crate::Focus).
    #[must_use]
    pub fn row_offset_q5(&self) -> i16 {
        self.row_offset_q5
    }
}

/// A matched pair; without results if the pair was refused.
#[derive(Debug)]
pub struct Matched<'a> {
    pub(crate) plan: Plan,
    pub(crate) images: [Gray<'a>; 2],
    pub(crate) scratch: ScratchView<'a>,
    pub(crate) summary: Summary,
}

impl<'a> Matched<'a> {
    /// The ground plane, if one was found.
    #[must_use]
    pub const fn ground(&self) -> Option<GroundPlane> {
        self.summary.plane
    }

    /// Size of both images.
    #[must_use]
    pub fn dims(&self) -> Dims {
        self.plan.dims
    }

    /// The memory of the run, for the next one: for callers that keep the pair and no borrow of its memory, such as another language.
    #[must_use]
    pub fn into_scratch(self) -> ScratchView<'a> {
        self.scratch
    }

    /// Counts, row offset and health of the run.
    #[must_use]
    pub fn summary(&self) -> &Summary {
        &self.summary
    }

    /// Health of the pair; good when it was not checked.
    #[must_use]
    pub fn health(&self) -> &PairHealth {
        &self.summary.health
    }

    /// Numbers of segments found, dropped, matched and rejected.
    #[must_use]
    pub fn counts(&self) -> &Counts {
        &self.summary.counts
    }

    /// Matched segments, most confident first.
    #[must_use]
    pub fn segments(&self) -> &[Match] {
        self.scratch.matches
    }

    /// Matches, counts and support points by which the health of the pair is judged.
    #[must_use]
    pub fn findings(&self) -> Findings<'_> {
        let range = self.summary.range;
        Findings {
            matches: self.segments(),
            counts: self.counts(),
            support: self.support(),
            range,
            row_offset: self.summary.row_offset(),
        }
    }

    /// Segments that passed the hard tests, with their hypotheses: the data that confidence models are fitted on.
    #[must_use]
    pub fn candidates(&self) -> &[Candidate] {
        self.scratch.candidates
    }

    /// The grid of support points.
    #[must_use]
    pub fn support(&self) -> Support<'_> {
        Support::new(&self.plan.params, self.plan.dims, self.scratch.support, self.summary.detail_q8)
            .with_plane(self.summary.plane)
    }

    /// The support points with at least [`Params::min_confidence`](crate::Params::min_confidence); [`Matched::points`] lists each pixel once.
    pub fn support_points(&self) -> impl Iterator<Item = Point> + use<'_> {
        self.support().credible(self.plan.params.min_confidence)
    }

    /// Calls `each` with every point: those of segments, most probable sides first, then support points; at most one per pixel.
    ///
    /// # Cost
    /// Some 40 instructions a point.
    pub fn points(&mut self, mut each: impl FnMut(Point)) {
        let (mut report, _) = Report::new(&self.plan, self.images, &mut self.scratch, self.summary.detail_q8);
        report.list_points(&mut each);
    }

    /// Calls `each` with the depth of every region, in the order given. Without depth for a pair that is not [fit](crate::HealthFlags::is_fit).
    ///
    /// # Cost
    /// On a Cortex-M7 some 92 000 instructions for a box of a fifteenth of a QVGA image.
    pub fn objects(&mut self, regions: &[Region<'_>], mut each: impl FnMut(ObjectDepth)) {
        if !self.summary.health.flags.is_fit() {
            let refused = |region: &Region<'_>| ObjectDepth::refused(region.label(), NoDepth::UnhealthyPair, 0);
            return regions.iter().map(refused).for_each(each);
        }
        let ScratchView { candidates, support, neighbours, order, marks, .. } = &mut self.scratch;
        let Plan { params, dims, models, .. } = &self.plan;
        let mut query = ObjectQuery {
            candidates,
            support: Support::new(params, *dims, support, self.summary.detail_q8).with_plane(self.summary.plane),
            models,
            dims: *dims,
            rig: params.rig,
            neighbours,
            order,
            marks,
        };
        for region in regions {
            each(query.depth_of(region));
        }
    }

    /// The depth of one pixel, on a segment or not; `region` is the one that it belongs to, if known.
    ///
    /// # Errors
    /// The reason why there is none; [`PixelRejection::UnhealthyPair`] for a pair that was refused.
    ///
    /// # Cost
    /// At 64 disparities 40 000 to 53 000 instructions on a Cortex-M7 (means of the built-in pairs), at most 70 000 where segments are dense.
    pub fn pixel(&mut self, pixel: (u16, u16), region: Option<&Region<'_>>) -> Result<PixelDepth, PixelRejection> {
        self.query(|query| query.answer(pixel, region))
    }

    /// Disparity of [`Matched::pixel`], 1/64 px, and its evidence, at any probability: the data that models are fitted on.
    pub fn pixel_evidence(
        &mut self,
        pixel: (u16, u16),
        region: Option<&Region<'_>>,
    ) -> Result<(i32, PixelEvidence), PixelRejection> {
        self.query(|query| query.evidence_of(pixel, region))
    }

    fn query<T>(&mut self, evaluate: impl FnOnce(Query<'_>) -> Result<T, PixelRejection>) -> Result<T, PixelRejection> {
        if self.summary.health.is_refused() {
            return Err(PixelRejection::UnhealthyPair);
        }
        let ScratchView { candidates, support, rows, work, .. } = &mut self.scratch;
        let Plan { params, dims, pixel_model, .. } = &self.plan;
        evaluate(Query {
            params,
            model: pixel_model,
            images: self.images,
            dims: *dims,
            candidates,
            support: Support::new(params, *dims, support, self.summary.detail_q8).with_plane(self.summary.plane),
            row_offset: self.summary.row_offset(),
            rows,
            work,
        })
    }
}

impl<'r> Report<'r> {
    /// The report of a run, and the list that it fills.
    pub(crate) fn new(
        plan: &'r Plan,
        [left, right]: [Gray<'r>; 2],
        scratch: &'r mut ScratchView<'_>,
        detail_q8: i16,
    ) -> (Self, &'r mut VecView<Match>) {
        let ScratchView { candidates, neighbours, order, support, marks, matches, .. } = scratch;
        let report = Self {
            params: &plan.params,
            models: plan.models,
            views: ValidPixels::of(left, right),
            candidates,
            neighbours,
            order,
            support: Support::new(&plan.params, plan.dims, support, detail_q8),
            marks,
        };
        (report, matches)
    }
}
