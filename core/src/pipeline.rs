//! One rectified pair -> matches and points: the method, stage by stage.

use crate::claims::Views;
use crate::confidence::{FITTED, Model, Models};
use crate::focus::{Focus, Sought};
use crate::image::{Dims, Gray};
use crate::lines::{self, LineParams, LineScratch, Segment};
use crate::matching::band::{BAND_ROWS, Band, PLANES, row_bytes};
use crate::matching::consistency::{self, Place};
use crate::matching::{self, Candidate, MatchContext, Workspace, row_offset, surroundings};
use crate::objects::{NoDepth, ObjectDepth, Region, Witnessed};
use crate::observe::{Observer, Step};
use crate::params::{ParamError, Params, Parts};
use crate::query::{FITTED_PIXEL, NotKnown, PIXEL_EVIDENCE, PixelDepth, PixelEvidence, Query};
use crate::report::{Ranked, Report};
use crate::result::{Counts, Match, PointClaim, Rejection};
use crate::support::evidence::SUPPORT_EVIDENCE;
use crate::support::{self, FITTED_SUPPORT, Grid, Support, SupportPoint, most_support_points};
use core::fmt;
use heapless::Vec;
use heapless::vec::VecView;

/// A pair that cannot be matched as planned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunError {
    /// An image has another size than planned.
    SizeMismatch {
        /// Size planned for.
        planned: Dims,
        /// Size given.
        given: Dims,
    },
    /// The working memory was made for smaller images.
    ScratchTooSmall {
        /// Capacity of [`Scratch`] that is too small.
        name: &'static str,
        /// Capacity needed.
        needed: usize,
        /// Capacity there.
        given: usize,
    },
}

impl fmt::Display for RunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SizeMismatch { planned, given } => write!(f, "planned for {planned}, the frame is {given}"),
            Self::ScratchTooSmall { name, needed, given } => {
                write!(f, "{name} of the scratch memory holds {given}, these images need {needed}")
            }
        }
    }
}

impl core::error::Error for RunError {}

/// Words of marks for images of this size: a bit per pixel.
#[must_use]
pub const fn mark_words(dims: Dims) -> usize {
    (dims.width as usize * dims.height as usize).div_ceil(32)
}

/// Segments that are matched at most in images of this size: one per square of `cell` px.
#[must_use]
pub const fn most_candidates(dims: Dims, cell: u16) -> usize {
    (dims.width as usize).div_ceil(cell as usize) * (dims.height as usize).div_ceil(cell as usize)
}

/// Working memory of a run, made by the caller, in a static or on the heap. What it holds before a run never influences a result.
///
/// `ROW` is [`row_bytes`] of the widest image, `MARKS` is [`mark_words`] of the largest, `SEGMENTS` bounds each list of segments as detected,
/// `CANDIDATES` the left ones that are matched: [`most_candidates`] is always enough. `SUPPORT` is [`most_support_points`] of the largest.
#[derive(Debug)]
pub struct Scratch<
    const ROW: usize,
    const MARKS: usize,
    const SEGMENTS: usize,
    const CANDIDATES: usize,
    const SUPPORT: usize,
> {
    marks: [u32; MARKS],
    chain: [u16; lines::MAX_POSITIONS],
    strengths: [u8; lines::MAX_POSITIONS],
    rows: Words<[[[u8; ROW]; BAND_ROWS]; PLANES]>,
    left: Vec<Segment, SEGMENTS>,
    right: Vec<Segment, SEGMENTS>,
    candidates: Vec<Candidate, CANDIDATES>,
    places: [Place; CANDIDATES],
    order: Vec<Ranked, CANDIDATES>,
    support: Vec<SupportPoint, SUPPORT>,
    work: Workspace,
    /// Row of the right image that matched row 0 of the left one in the last run.
    row_offset: i32,
    /// Detail of the left image in the last run, [`SupportKind::Detail`](crate::SupportKind::Detail).
    detail_q8: i16,
}

/// Bytes that begin at a whole word, which kernels load several of at a time.
#[derive(Debug)]
#[repr(align(4))]
struct Words<T>(T);

impl<const ROW: usize, const MARKS: usize, const SEGMENTS: usize, const CANDIDATES: usize, const SUPPORT: usize>
    Scratch<ROW, MARKS, SEGMENTS, CANDIDATES, SUPPORT>
{
    /// Bytes of one.
    pub const BYTES: usize = size_of::<Self>();

    /// Cleared memory.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(SEGMENTS <= lines::MAX_SEGMENTS, "a scratch memory lists at most 4096 segments") };
        Self {
            marks: [0; MARKS],
            chain: [0; lines::MAX_POSITIONS],
            strengths: [0; lines::MAX_POSITIONS],
            rows: Words([[[0; ROW]; BAND_ROWS]; PLANES]),
            left: Vec::new(),
            right: Vec::new(),
            candidates: Vec::new(),
            places: [Place::EMPTY; CANDIDATES],
            order: Vec::new(),
            support: Vec::new(),
            work: Workspace::EMPTY,
            row_offset: 0,
            detail_q8: 0, // as all of it: what is not zero would lie in flash
        }
    }

    /// Everything that passed the hard tests of the last run, with its evidence: what a confidence model is fitted on.
    pub fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }
}

impl<const ROW: usize, const MARKS: usize, const SEGMENTS: usize, const CANDIDATES: usize, const SUPPORT: usize> Default
    for Scratch<ROW, MARKS, SEGMENTS, CANDIDATES, SUPPORT>
{
    fn default() -> Self {
        Self::new()
    }
}

/// Columns between two scans for the near-horizontal edges of the right image, which are not needed one by one.
const RIGHT_SCAN_STEP: i32 = 3 * lines::SCAN_STEP;

/// What a run gives.
#[derive(Debug)]
pub struct Output<const SEGMENTS: usize, const POINTS: usize> {
    /// Matched segments, most confident first.
    pub matches: Vec<Match, SEGMENTS>,
    /// Points, most probable sides first; at most one per pixel. None are made for a capacity of 0: see [`Plan::for_each_point`].
    pub points: Vec<PointClaim, POINTS>,
    /// What was found and lost.
    pub counts: Counts,
    /// Rows to add to a left row for the matching right one, 1/32 px: by near-horizontal segments of both images, or as [`Focus`] told it.
    pub row_offset_q5: i16,
}

impl<const SEGMENTS: usize, const POINTS: usize> Output<SEGMENTS, POINTS> {
    /// An empty output.
    #[must_use]
    pub const fn new() -> Self {
        Self { matches: Vec::new(), points: Vec::new(), counts: Counts::ZERO, row_offset_q5: 0 }
    }
}

impl<const SEGMENTS: usize, const POINTS: usize> Default for Output<SEGMENTS, POINTS> {
    fn default() -> Self {
        Self::new()
    }
}

/// Checked parameters for one image size: all that a frame does not change.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    dims: Dims,
    params: Params,
    models: &'static Models,
    pixel_model: &'static Model<PIXEL_EVIDENCE>,
    support_model: &'static Model<SUPPORT_EVIDENCE>,
}

impl Params {
    /// Checks everything once, for images of this size.
    pub fn plan(self, dims: Dims) -> Result<Plan, ParamError> {
        self.check(dims)?;
        Ok(Plan { dims, params: self, models: &FITTED, pixel_model: &FITTED_PIXEL, support_model: &FITTED_SUPPORT })
    }
}

/// The scratch memory without its capacities.
struct Memory<'a> {
    marks: &'a mut [u32],
    chain: &'a mut [u16],
    strengths: &'a mut [u8],
    rows: &'a mut [u8],
    left: &'a mut VecView<Segment>,
    right: &'a mut VecView<Segment>,
    candidates: &'a mut VecView<Candidate>,
    places: &'a mut [Place],
    order: &'a mut VecView<Ranked>,
    support: &'a mut VecView<SupportPoint>,
    work: &'a mut Workspace,
    row_offset: &'a mut i32,
    detail_q8: &'a mut i16,
}

/// The output without its capacities.
struct Lists<'a> {
    matches: &'a mut VecView<Match>,
    points: &'a mut VecView<PointClaim>,
    counts: &'a mut Counts,
    row_offset_q5: &'a mut i16,
}

impl Plan {
    /// Size of both images.
    #[must_use]
    pub fn dims(&self) -> Dims {
        self.dims
    }

    /// The same plan with other confidence models.
    #[must_use]
    pub fn with_models(self, models: &'static Models) -> Self {
        Self { models, ..self }
    }

    /// The same plan with another confidence model for the depth of pixels.
    #[must_use]
    pub fn with_pixel_model(self, pixel_model: &'static Model<PIXEL_EVIDENCE>) -> Self {
        Self { pixel_model, ..self }
    }

    /// The same plan with another confidence model for support points.
    #[must_use]
    pub fn with_support_model(self, support_model: &'static Model<SUPPORT_EVIDENCE>) -> Self {
        Self { support_model, ..self }
    }

    /// Matches one rectified pair.
    ///
    /// # Errors
    /// Images of another size than planned, and a memory that is too small for it ([`Scratch`] says what is enough): nothing is matched, and the
    /// output stays as it was.
    pub fn run<
        const R: usize,
        const M: usize,
        const S: usize,
        const C: usize,
        const N: usize,
        const OS: usize,
        const OP: usize,
    >(
        &self,
        left: Gray<'_>,
        right: Gray<'_>,
        scratch: &mut Scratch<R, M, S, C, N>,
        out: &mut Output<OS, OP>,
    ) -> Result<(), RunError> {
        self.run_observed(left, right, scratch, out, &mut ())
    }

    /// [`Plan::run`], telling `observer` of every step.
    pub fn run_observed<
        const R: usize,
        const M: usize,
        const S: usize,
        const C: usize,
        const N: usize,
        const OS: usize,
        const OP: usize,
    >(
        &self,
        left: Gray<'_>,
        right: Gray<'_>,
        scratch: &mut Scratch<R, M, S, C, N>,
        out: &mut Output<OS, OP>,
        observer: &mut impl Observer,
    ) -> Result<(), RunError> {
        self.run_on(left, right, &Focus::WHOLE, scratch, out, observer)
    }

    /// [`Plan::run_observed`] in and just around some areas of the left image.
    ///
    /// The candidates there are those of a run over the whole frame, given its row offset; what is made of their neighbours (the confidence of
    /// matches and points) knows no neighbours elsewhere, so those near the border of an area may be listed with another confidence.
    ///
    /// # Cost
    /// About in proportion to the areas, each grown by some 20 px, and in the right image by the disparity range as well.
    pub fn run_on<
        const R: usize,
        const M: usize,
        const S: usize,
        const C: usize,
        const N: usize,
        const OS: usize,
        const OP: usize,
    >(
        &self,
        left: Gray<'_>,
        right: Gray<'_>,
        focus: &Focus<'_>,
        scratch: &mut Scratch<R, M, S, C, N>,
        out: &mut Output<OS, OP>,
        observer: &mut impl Observer,
    ) -> Result<(), RunError> {
        self.check_memory(R, M, N)?;
        let memory = Memory {
            marks: scratch.marks.get_mut(..mark_words(self.dims)).unwrap_or(&mut []),
            chain: &mut scratch.chain,
            strengths: &mut scratch.strengths,
            rows: scratch.rows.0.as_flattened_mut().as_flattened_mut(),
            left: &mut scratch.left,
            right: &mut scratch.right,
            candidates: &mut scratch.candidates,
            places: &mut scratch.places,
            order: &mut scratch.order,
            support: &mut scratch.support,
            work: &mut scratch.work,
            row_offset: &mut scratch.row_offset,
            detail_q8: &mut scratch.detail_q8,
        };
        let lists = Lists {
            matches: &mut out.matches,
            points: &mut out.points,
            counts: &mut out.counts,
            row_offset_q5: &mut out.row_offset_q5,
        };
        self.run_stages([left, right], focus, memory, lists, observer)
    }

    /// Hands every point of the last run with this plan, pair and memory to `claim`, in the order and with the values of the list of points: for
    /// who has no memory for a list, and gave [`Output`] a capacity of 0.
    ///
    /// # Cost
    /// As the list: some 40 instructions a point.
    pub fn for_each_point<const R: usize, const M: usize, const S: usize, const C: usize, const N: usize>(
        &self,
        views: Views<'_>,
        scratch: &mut Scratch<R, M, S, C, N>,
        mut claim: impl FnMut(PointClaim),
    ) {
        let mut report = Report {
            params: &self.params,
            models: self.models,
            views,
            candidates: &mut scratch.candidates,
            places: &scratch.places,
            order: &mut scratch.order,
            support: Support::new(&self.params, self.dims, &scratch.support, scratch.detail_q8),
            marks: scratch.marks.get_mut(..mark_words(self.dims)).unwrap_or(&mut []),
        };
        report.claim_points(|point| {
            claim(point);
            true
        });
    }

    /// Hands the depth of every region to `each`, by the last run with this plan and memory, in the order given. `fit` says whether the pair
    /// is healthy enough to be believed; the answers of one that is not are refusals.
    ///
    /// # Cost
    /// On a Cortex-M7 some 27 000 instructions for a box of a fifteenth of a QVGA image.
    pub fn for_each_object<const R: usize, const M: usize, const S: usize, const C: usize, const N: usize>(
        &self,
        scratch: &mut Scratch<R, M, S, C, N>,
        regions: &[Region<'_>],
        fit: bool,
        mut each: impl FnMut(ObjectDepth),
    ) {
        let mut witnessed = Witnessed {
            candidates: &scratch.candidates,
            support: Support::new(&self.params, self.dims, &scratch.support, scratch.detail_q8),
            models: self.models,
            dims: self.dims,
            rig: self.params.rig,
            places: &mut scratch.places,
            order: &mut scratch.order,
            marks: scratch.marks.get_mut(..mark_words(self.dims)).unwrap_or(&mut []),
        };
        for region in regions {
            each(if fit {
                witnessed.depth_of(region)
            } else {
                ObjectDepth::refused(region.label(), NoDepth::UnhealthyPair, 0)
            });
        }
    }

    /// The depth of one pixel, on a segment or not, after a run with this plan, pair and memory; `region` is what it belongs to, if that is
    /// known. What the run found is not changed.
    ///
    /// # Cost
    /// At 64 disparities 40 000 to 53 000 instructions on a Cortex-M7 (means of the built-in pairs), at most 70 000 where segments are dense.
    pub fn depth_at<const R: usize, const M: usize, const S: usize, const C: usize, const N: usize>(
        &self,
        left: Gray<'_>,
        right: Gray<'_>,
        scratch: &mut Scratch<R, M, S, C, N>,
        (x, y): (u16, u16),
        region: Option<&Region<'_>>,
    ) -> Result<PixelDepth, NotKnown> {
        self.query([left, right], scratch).answer(x, y, region)
    }

    /// The disparity that [`Plan::depth_at`] would answer (1/64 px) and its evidence, whatever its probability: what a model is fitted on.
    pub fn evidence_at<const R: usize, const M: usize, const S: usize, const C: usize, const N: usize>(
        &self,
        left: Gray<'_>,
        right: Gray<'_>,
        scratch: &mut Scratch<R, M, S, C, N>,
        (x, y): (u16, u16),
        region: Option<&Region<'_>>,
    ) -> Result<(i32, PixelEvidence), NotKnown> {
        self.query([left, right], scratch).weigh_up(x, y, region)
    }

    fn query<'a, const R: usize, const M: usize, const S: usize, const C: usize, const N: usize>(
        &'a self,
        images: [Gray<'a>; 2],
        scratch: &'a mut Scratch<R, M, S, C, N>,
    ) -> Query<'a> {
        Query {
            params: &self.params,
            model: self.pixel_model,
            images,
            dims: self.dims,
            candidates: &scratch.candidates,
            support: Support::new(&self.params, self.dims, &scratch.support, scratch.detail_q8),
            row_offset: scratch.row_offset,
            rows: scratch.rows.0.as_flattened_mut().as_flattened_mut(),
            work: &mut scratch.work,
        }
    }

    /// The support points of the last run with this plan and memory.
    #[must_use]
    pub fn support<'s, const R: usize, const M: usize, const S: usize, const C: usize, const N: usize>(
        &self,
        scratch: &'s Scratch<R, M, S, C, N>,
    ) -> Support<'s> {
        Support::new(&self.params, self.dims, &scratch.support, scratch.detail_q8)
    }

    /// The support points of the last run with this plan and memory that reach the least confidence, as they stand in the list of points.
    pub fn support_points<'s, const R: usize, const M: usize, const S: usize, const C: usize, const N: usize>(
        &self,
        scratch: &'s Scratch<R, M, S, C, N>,
    ) -> impl Iterator<Item = PointClaim> + use<'s, R, M, S, C, N> {
        self.support(scratch).claims(self.params.min_confidence)
    }

    /// Are these capacities of a scratch memory large enough for the planned size?
    fn check_memory(&self, row: usize, marks: usize, support: usize) -> Result<(), RunError> {
        let needed = [row_bytes(self.dims.width), mark_words(self.dims), most_support_points(self.dims)];
        let there = [("ROW", row), ("MARKS", marks), ("SUPPORT", support)];
        match there.into_iter().zip(needed).find(|((_, given), needed)| given < needed) {
            Some(((name, given), needed)) => Err(RunError::ScratchTooSmall { name, needed, given }),
            None => Ok(()),
        }
    }

    #[inline(never)]
    fn run_stages(
        &self,
        [left, right]: [Gray<'_>; 2],
        focus: &Focus<'_>,
        m: Memory<'_>,
        out: Lists<'_>,
        observer: &mut impl Observer,
    ) -> Result<(), RunError> {
        for image in [left, right] {
            if image.dims() != self.dims {
                return Err(RunError::SizeMismatch { planned: self.dims, given: image.dims() });
            }
        }
        out.matches.clear();
        out.points.clear();
        *out.counts = Counts::ZERO;

        let sought = Sought::new(focus, self.dims);
        m.left.clear();
        m.right.clear();
        m.support.clear();
        m.candidates.clear();
        let mut m = m;
        let row_offset_q5 = if self.params.parts == Parts::Support {
            focus.row_offset_q5.unwrap_or(0).clamp(-row_offset::LIMIT_Q5, row_offset::LIMIT_Q5)
        } else {
            self.find_segments([left, right], (focus, &sought), &mut m, out.counts, observer)
        };
        *out.row_offset_q5 = row_offset_q5;
        *m.row_offset = (i32::from(row_offset_q5) + 16) >> 5;
        self.match_support([left, right], &sought, &mut m, observer);
        if self.params.parts != Parts::Support {
            self.match_segments([left, right], &sought, &mut m, out.counts, observer);
        }

        support::believe(m.support, Grid::new(&self.params, self.dims), *m.detail_q8, self.support_model);
        observer.ended(Step::Consistency(m.candidates, m.support));
        let report = Report {
            params: &self.params,
            models: self.models,
            views: Views::of(left, right),
            candidates: m.candidates,
            places: m.places,
            order: m.order,
            support: Support::new(&self.params, self.dims, m.support, *m.detail_q8),
            marks: m.marks,
        };
        report.run(out.matches, out.points, out.counts);
        observer.ended(Step::Report(out.matches, out.points));
        Ok(())
    }

    /// Segments of both images; of the left ones, the prominent. Gives the row offset, 1/32 px.
    fn find_segments(
        &self,
        [left, right]: [Gray<'_>; 2],
        (focus, sought): (&Focus<'_>, &Sought),
        m: &mut Memory<'_>,
        counts: &mut Counts,
        observer: &mut impl Observer,
    ) -> i16 {
        let lines = LineParams {
            anchor: self.params.anchor_gradient.into(),
            edge: self.params.edge_gradient.into(),
            min_extent: self.params.min_extent.into(),
            row_scan: Some(lines::SCAN_STEP),
            column_scan: Some(lines::SCAN_STEP),
        };
        // Near-horizontal segments of the right image tell the row offset; nothing else is asked of its segments.
        let right_lines = LineParams { row_scan: None, column_scan: Some(RIGHT_SCAN_STEP), ..lines };
        let scratch = LineScratch { marks: m.marks, chain: m.chain, strengths: m.strengths };
        counts.segments_left_dropped =
            lines::detect(left, sought.left(self.params.cell).as_deref(), &lines, scratch, m.left);
        observer.ended(Step::LinesLeft(m.left));
        let scratch = LineScratch { marks: m.marks, chain: m.chain, strengths: m.strengths };
        if focus.row_offset_q5.is_none() {
            let sought = sought.right(m.left, &self.params);
            counts.segments_right_dropped = lines::detect(right, sought.as_deref(), &right_lines, scratch, m.right);
            lines::sort_by_top(m.right);
        }
        observer.ended(Step::LinesRight(m.right));
        counts.segments_right = u16::try_from(m.right.len()).unwrap_or(u16::MAX);
        let row_offset_q5 = match focus.row_offset_q5 {
            Some(known) => known.clamp(-row_offset::LIMIT_Q5, row_offset::LIMIT_Q5),
            None => row_offset::estimate(m.left, m.right, self.disparities()),
        };
        let lost = lines::keep_prominent(
            m.left,
            (self.params.cell.into(), m.candidates.capacity()),
            self.dims.width.into(),
            m.marks,
        );
        m.left.retain(|segment| sought.is_wanted(segment));
        lines::sort_by_top(m.left);
        counts.segments_left = u16::try_from(m.left.len()).unwrap_or(u16::MAX).saturating_add(lost);
        counts.reject_many(Rejection::LessProminent, lost);
        observer.ended(Step::Selection(row_offset_q5.into(), m.left));
        row_offset_q5
    }

    /// The surfaces between edges.
    fn match_support(&self, images: [Gray<'_>; 2], sought: &Sought, m: &mut Memory<'_>, observer: &mut impl Observer) {
        let grid = Grid::new(&self.params, self.dims);
        let matching = support::Matching { images, grid, row_offset: *m.row_offset, model: self.support_model };
        *m.detail_q8 = matching.run(sought.areas(), m.rows, m.support, |place, evidence| {
            observer.support_point(place, evidence);
        });
        observer.ended(Step::Support(m.support));
    }

    /// Three matchings of each left segment, aggregation, ownership; then what the claims and the support points say of each other.
    fn match_segments(
        &self,
        images: [Gray<'_>; 2],
        sought: &Sought,
        m: &mut Memory<'_>,
        counts: &mut Counts,
        observer: &mut impl Observer,
    ) {
        let support = Support::new(&self.params, self.dims, m.support, *m.detail_q8);
        let context = MatchContext::new(&self.params, self.models, self.dims, support);
        let reached = sought.reached(m.left, self.disparities());
        let Some(mut band) = Band::new(images, *m.row_offset, reached.as_deref(), m.rows) else { return };
        for segment in m.left.iter() {
            band.advance_for(segment, |planes| observer.row(planes));
            observer.ended(Step::Rows);
            let matched = matching::match_segment(segment, &context, &band, m.work);
            counts.searched_fully += u16::from(!matched.directed);
            match matched.outcome {
                Ok(candidate) => {
                    observer.ended(Step::Segment(Ok((&candidate, &m.work.evidence))));
                    let _ = m.candidates.push(candidate); // as many places as segments were kept
                }
                Err(reason) => {
                    observer.ended(Step::Segment(Err(reason)));
                    counts.reject(reason);
                }
            }
        }
        consistency::weigh_neighbours(m.candidates, m.places);
        surroundings::ask(m.candidates, Grid::new(&self.params, self.dims), m.support);
    }

    /// First disparity, and the one after the last, px.
    fn disparities(&self) -> (i32, i32) {
        (self.params.min_disparity.into(), self.params.max_disparity.into())
    }
}
