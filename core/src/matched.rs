//! Matched pair: access to its results, and evaluation on demand.
//!
//! In: the pair, the memory of its run. Out: segments, points, the depth of objects and pixels.
//!
//! It borrows the pair and the memory: while it lives, no other pair can be matched there.
//!
//! A pair that is not [fit](Matched::is_fit) to be used has no segments, no points and no ground,
//! and no object and no pixel has a depth. [`Matched::findings`] and [`Matched::support`] keep what
//! was matched, to explain it.

use crate::bars::{self, Bar, MaskMatcher};
use crate::ground::GroundPlane;
use crate::health::{Findings, HealthFlags, PairHealth};
use crate::image::{Dims, Gray};
use crate::list::List;
use crate::matching::MatchContext;
use crate::memory::{Buffers, Scratch};
use crate::objects::{NoDepth, ObjectDepth, ObjectQuery, Reason, Region};
use crate::obstacles::{self, DOUBTFUL_GROUND, LEAST_CONFIDENCE, ObstaclePlan, Obstacles};
use crate::params::Parts;
use crate::plan::Plan;
use crate::query::{self, PixelDepth, PixelRejection, Query};
use crate::report::Report;
use crate::result::{Counts, Match, Point};
use crate::side_pixels::ValidPixels;
use crate::support::{Likeness, Noise, RangeCheck, Support, SupportPoint};
#[cfg(feature = "unstable")]
use crate::{
    matching::Candidate,
    query::PixelEvidence,
    support::context::{ContextEvidence, Listing},
};

/// Least row offset by which rows are moved, 1/32 px: that by edges is known within some 0.2 px,
/// and most pairs are rectified to less than half a pixel.
const LEAST_OFFSET_Q5: i32 = 22;

/// Counts, row offset and health of a run.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Summary {
    pub(crate) counts: Counts,
    /// Rows to add to a left row for the matching right one, 1/32 px; `None` when they were neither
    /// measured nor given.
    pub(crate) row_offset_q5: Option<i16>,
    /// Detail of the left image, `SupportKind::Detail`, Q8.
    pub(crate) detail_q8: i16,
    pub(crate) range: RangeCheck,
    /// Noise of both images.
    pub(crate) noise: [Noise; 2],
    pub(crate) plane: Option<GroundPlane>,
    pub(crate) health: PairHealth,
    /// All of the pair was matched, not areas of it.
    pub(crate) is_whole: bool,
}

impl Summary {
    /// Row of the right image that matches row 0 of the left one, px.
    pub(crate) fn row_offset(&self) -> i32 {
        let offset_q5 = i32::from(self.row_offset_q5.unwrap_or(0));
        offset_q5.signum() * ((offset_q5.abs() + 32 - LEAST_OFFSET_Q5) >> 5)
    }

    /// The grid of support points of the run.
    pub(crate) fn support<'p>(&self, plan: &Plan, points: &'p [SupportPoint]) -> Support<'p> {
        Support::new(&plan.params, plan.dims, points, self.detail_q8).with_plane(self.plane)
    }
}

/// A matched pair; without results if it is not fit to be used.
#[derive(Debug)]
pub struct Matched<'a> {
    pub(crate) plan: Plan,
    pub(crate) images: [Gray<'a>; 2],
    pub(crate) buffers: Buffers<'a>,
    pub(crate) summary: Summary,
}

impl<'a> Matched<'a> {
    /// The ground plane that was found in a pair that is fit to be used, or that the camera's pose
    /// says.
    #[must_use]
    pub const fn ground(&self) -> Option<GroundPlane> {
        if self.is_fit() { self.summary.plane } else { None }
    }

    /// Size of both images.
    #[must_use]
    pub fn dims(&self) -> Dims {
        self.plan.dims
    }

    /// Health of the pair.
    #[must_use]
    pub fn health(&self) -> &PairHealth {
        &self.summary.health
    }

    /// True when the pair is [fit](HealthFlags::is_fit) to be used: only then segments, points,
    /// objects and pixels are answered.
    #[must_use]
    pub const fn is_fit(&self) -> bool {
        self.summary.health.flags.is_fit()
    }

    /// Rows to add to a left row for the matching right one, 1/32 px: by near-horizontal segments
    /// of both images, or that of the last whole pair; 0 when neither says them.
    #[must_use]
    pub fn row_offset_q5(&self) -> i16 {
        self.summary.row_offset_q5.unwrap_or(0)
    }

    /// Adds faults of the pair that the caller knows of. The pairs after it do not inherit them.
    pub fn add_faults(&mut self, faults: HealthFlags) {
        let health = &mut self.summary.health;
        health.now |= faults;
        health.flags |= faults;
    }

    /// Leaves the support points alone.
    pub(crate) fn drop_segments(&mut self) {
        self.buffers.candidates.clear();
        self.buffers.matches.clear();
        self.summary.counts = Counts::default();
    }

    /// Numbers of segments found, dropped, matched and rejected.
    #[must_use]
    pub fn counts(&self) -> &Counts {
        &self.summary.counts
    }

    /// Matched segments, most confident first.
    #[must_use]
    pub fn segments(&self) -> &[Match] {
        if self.is_fit() { &self.buffers.matches } else { &[] }
    }

    /// Matches, counts and support points by which the health of the pair is judged.
    #[must_use]
    pub fn findings(&self) -> Findings<'_> {
        Findings {
            matches: &self.buffers.matches,
            counts: self.counts(),
            support: self.support(),
            range: self.summary.range,
            noise: self.summary.noise,
            row_offset: self.summary.row_offset(),
            has_segments: self.plan.params.parts != Parts::Support,
            is_whole: self.summary.is_whole,
        }
    }

    /// The grid of support points.
    #[must_use]
    pub fn support(&self) -> Support<'_> {
        self.summary.support(&self.plan, &self.buffers.support)
    }

    fn likeness(&self) -> Likeness<'a> {
        let [left, right] = self.summary.health.cameras.map(|camera| i32::from(camera.level));
        let (images, row_offset) = (self.images, self.summary.row_offset());
        Likeness { images, row_offset, brighter: left - right }
    }

    /// The support points with at least [`Params::min_confidence`](crate::Params::min_confidence);
    /// [`Matched::points`] lists each pixel once.
    pub fn support_points(&self) -> impl Iterator<Item = Point> + use<'_> {
        let is_fit = self.is_fit();
        self.support().credible(self.plan.params.min_confidence).filter(move |_| is_fit)
    }

    /// Points for [`Obstacles`](crate::obstacles::Obstacles) beside the matches: three of each bar
    /// and of each credible side of a segment that is not among the matches, then the support
    /// points, whatever [`Params::min_confidence`](crate::Params::min_confidence) is: many of
    /// little confidence that agree are an obstacle too. A point that its neighbours alone put
    /// beside the ground plane has at most [`DOUBTFUL_GROUND`](crate::obstacles::DOUBTFUL_GROUND):
    /// it may be the blank side of a box, and proves nothing free. One up to 2 px before the plane
    /// has at most 0.6 where points on the plane outnumber it: it may be ground.
    pub fn obstacle_points(&self) -> impl Iterator<Item = Point> + use<'_> {
        let is_fit = self.is_fit();
        let least_q16 = self.plan.params.min_confidence.to_bits();
        let bars = self.buffers.bars.iter().flat_map(Bar::three_points);
        let unlisted = self.buffers.candidates.iter();
        let unlisted = unlisted.filter(|candidate| candidate.listed.is_none());
        let sides = unlisted.flat_map(move |candidate| {
            let credible = candidate.sides.iter().flatten();
            let credible =
                credible.filter(move |side| !side.rejected && side.probability_q16 >= least_q16);
            credible.flat_map(|side| side.three_points(&candidate.segment))
        });
        let support = self.support();
        let points = support.credible_by(LEAST_CONFIDENCE, DOUBTFUL_GROUND);
        let points = points.map(move |point| {
            let confidence = obstacles::beside_ground(&point, &support);
            Point { confidence, ..point }
        });
        bars.chain(sides).chain(points).filter(move |_| is_fit)
    }

    /// Updates the state of each direction by this pair: its segments, its
    /// [obstacle points](Matched::obstacle_points), its ground plane and its health, as
    /// [`Obstacles::update`] does. `time_us` is its time of capture, us of a monotonic clock.
    ///
    /// A pair that was matched in [areas](crate::Options::areas) alone counts as one that is not
    /// fit to be used: what stands outside of the areas is not seen.
    pub fn update_obstacles(&self, plan: &ObstaclePlan, obstacles: &mut Obstacles, time_us: u64) {
        if !self.summary.is_whole {
            return obstacles.mark_missing();
        }
        let (plan, health) = (plan.on_ground(self.ground()), self.summary.health.flags);
        obstacles.update(&plan, self.segments(), self.obstacle_points(), health, time_us);
    }

    /// Bars, thin things in front of what is around them. Those level with it are among the points
    /// alone.
    #[must_use]
    pub fn bars(&self) -> &[Bar] {
        if self.is_fit() { bars::in_front(&self.buffers.bars) } else { &[] }
    }

    /// Every point, at most one per pixel: support points, then those of bars, then those of
    /// segments, most probable sides first.
    ///
    /// # Cost
    /// Some 240 instructions a point; 4200 a support point.
    pub fn points(&mut self) -> impl Iterator<Item = Point> + use<'_> {
        let (is_fit, likeness) = (self.is_fit(), self.likeness());
        let (report, _) = Report::new(&self.plan, self.images, &mut self.buffers, &self.summary);
        report.points(is_fit, likeness, &self.plan.support_models.context)
    }

    /// The depth of an object that fills this region.
    ///
    /// # Errors
    /// The reason why there is none; [`Reason::UnhealthyPair`] for a pair that is not fit to be
    /// used.
    ///
    /// # Cost
    /// On a Cortex-M7 some 92 000 instructions for a box of a fifteenth of a QVGA image; several
    /// times as many for a thin mask on which no bar was found.
    pub fn object(&mut self, region: &Region<'_>) -> Result<ObjectDepth, NoDepth> {
        if !self.is_fit() {
            return Err(NoDepth { reason: Reason::UnhealthyPair, support: 0 });
        }
        let Buffers { candidates, support, neighbours, order, scratch, bars, .. } =
            &mut self.buffers;
        let Scratch { marks, rows, work, .. } = scratch;
        let Plan { params, dims, models, .. } = &self.plan;
        let support = self.summary.support(&self.plan, support);
        let query = ObjectQuery {
            candidates,
            support,
            models,
            dims: *dims,
            rig: params.rig,
            neighbours,
            order: order.lent(),
            marks,
            bars,
            masks: Some(MaskMatcher {
                images: self.images,
                row_offset: self.summary.row_offset(),
                context: MatchContext::new(params, models, *dims, support),
                rows,
                work,
            }),
        };
        query.depth_of(region)
    }

    /// The depth of one pixel, on a segment or not.
    ///
    /// # Errors
    /// The reason why there is none; [`PixelRejection::UnhealthyPair`] for a pair that is not fit
    /// to be used.
    ///
    /// # Cost
    /// At 64 disparities 40 000 to 53 000 instructions on a Cortex-M7 (means of the built-in
    /// pairs), at most 70 000 where segments are dense.
    pub fn pixel(&mut self, pixel: (u16, u16)) -> Result<PixelDepth, PixelRejection> {
        self.pixel_answer(pixel, None)
    }

    /// [`Matched::pixel`] of an object that fills this region: what lies outside of it is no
    /// evidence.
    ///
    /// # Errors
    /// As [`Matched::pixel`].
    pub fn pixel_of(
        &mut self,
        pixel: (u16, u16),
        region: &Region<'_>,
    ) -> Result<PixelDepth, PixelRejection> {
        self.pixel_answer(pixel, Some(region))
    }

    fn pixel_answer(
        &mut self,
        pixel: (u16, u16),
        region: Option<&Region<'_>>,
    ) -> Result<PixelDepth, PixelRejection> {
        if !self.is_fit() {
            return Err(PixelRejection::UnhealthyPair);
        }
        let answer = self.query().answer(pixel, region);
        query::on_bars(&self.buffers.bars, pixel, answer, self.plan.params.rig)
    }

    fn query(&mut self) -> Query<'_> {
        let Buffers { candidates, support, scratch: Scratch { rows, work, .. }, .. } =
            &mut self.buffers;
        let Plan { params, dims, .. } = &self.plan;
        Query {
            params,
            images: self.images,
            dims: *dims,
            candidates,
            support: self.summary.support(&self.plan, support),
            row_offset: self.summary.row_offset(),
            rows,
            work,
        }
    }
}

/// Data that models are fitted on.
#[cfg(feature = "unstable")]
impl Matched<'_> {
    /// Answers although the pair is not fit to be used: for scores of the method, beside those of
    /// its health.
    pub fn ignore_health(&mut self) {
        let cameras = self.summary.health.cameras;
        self.summary.health = PairHealth { cameras, ..PairHealth::default() };
    }

    /// Evidence of the support point at `index` as it is listed; `None` without a disparity.
    #[must_use]
    pub fn context(&self, index: usize) -> Option<ContextEvidence> {
        let (support, likeness) = (self.support(), self.likeness());
        let (at, _) = support.listed(index)?;
        Listing { support, likeness, network: &self.plan.support_models.context }
            .evidence(index, at)
    }

    /// Segments that passed the hard tests, with their hypotheses.
    #[must_use]
    pub fn candidates(&self) -> &[Candidate] {
        &self.buffers.candidates
    }

    /// Disparity of [`Matched::pixel`], 1/64 px, and its evidence, at any probability and of any
    /// pair that was matched.
    ///
    /// # Errors
    /// As [`Matched::pixel`].
    pub fn pixel_evidence(
        &mut self,
        pixel: (u16, u16),
    ) -> Result<(i32, PixelEvidence), PixelRejection> {
        if self.summary.health.is_refused() {
            return Err(PixelRejection::UnhealthyPair);
        }
        self.query().evidence_of(pixel, None)
    }
}

impl<'r> Report<'r> {
    /// The report of a run, and the list that it fills.
    pub(crate) fn new<'m>(
        plan: &'r Plan,
        [left, right]: [Gray<'r>; 2],
        buffers: &'r mut Buffers<'m>,
        summary: &Summary,
    ) -> (Self, &'r mut List<'m, Match>) {
        let Buffers { candidates, neighbours, order, support, scratch, matches, bars, .. } =
            buffers;
        let Scratch { marks, .. } = scratch;
        let report = Self {
            params: &plan.params,
            models: plan.models,
            views: ValidPixels::of(left, right),
            candidates,
            neighbours,
            order: order.lent(),
            support: summary.support(plan, support),
            marks,
            bars,
        };
        (report, matches)
    }
}
