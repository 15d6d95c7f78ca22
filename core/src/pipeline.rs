//! One rectified pair -> matches and points: the method, stage by stage.

use crate::claims::Views;
use crate::confidence::{FITTED, Model, Models};
use crate::focus::{Focus, Sought};
use crate::image::{Dims, Gray};
use crate::lines::{self, LineParams, LineScratch, Segment};
use crate::matching::band::{BAND_ROWS, Band, PLANES, row_bytes};
use crate::matching::consistency::{self, Place};
use crate::matching::{self, Candidate, MatchContext, Workspace, row_offset};
use crate::objects::{NoDepth, ObjectDepth, Region, Witnessed};
use crate::observe::{Observer, Step};
use crate::params::{ParamError, Params};
use crate::query::{FITTED_PIXEL, NotKnown, PIXEL_EVIDENCE, PixelDepth, PixelEvidence, Query};
use crate::report::{Ranked, Report};
use crate::result::{Counts, Match, PointClaim, Rejection};
use core::fmt;
use heapless::Vec;
use heapless::vec::VecView;

/// The only way a planned frame can fail: another size than planned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizeMismatch {
    /// Size planned for.
    pub planned: Dims,
    /// Size given.
    pub given: Dims,
}

impl fmt::Display for SizeMismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "planned for {}, the frame is {}", self.planned, self.given)
    }
}

impl core::error::Error for SizeMismatch {}

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
/// `CANDIDATES` the left ones that are matched: [`most_candidates`] is always enough.
#[derive(Debug)]
pub struct Scratch<const ROW: usize, const MARKS: usize, const SEGMENTS: usize, const CANDIDATES: usize> {
    marks: [u32; MARKS],
    chain: [u16; lines::MAX_POSITIONS],
    strengths: [u8; lines::MAX_POSITIONS],
    rows: [[[u8; ROW]; BAND_ROWS]; PLANES],
    left: Vec<Segment, SEGMENTS>,
    right: Vec<Segment, SEGMENTS>,
    candidates: Vec<Candidate, CANDIDATES>,
    places: [Place; CANDIDATES],
    order: Vec<Ranked, CANDIDATES>,
    work: Workspace,
    /// Row of the right image that matched row 0 of the left one in the last run.
    row_offset: i32,
}

impl<const ROW: usize, const MARKS: usize, const SEGMENTS: usize, const CANDIDATES: usize>
    Scratch<ROW, MARKS, SEGMENTS, CANDIDATES>
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
            rows: [[[0; ROW]; BAND_ROWS]; PLANES],
            left: Vec::new(),
            right: Vec::new(),
            candidates: Vec::new(),
            places: [Place::EMPTY; CANDIDATES],
            order: Vec::new(),
            work: Workspace::EMPTY,
            row_offset: 0,
        }
    }

    /// Everything that passed the hard tests of the last run, with its evidence: what a confidence model is fitted on.
    pub fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }
}

impl<const ROW: usize, const MARKS: usize, const SEGMENTS: usize, const CANDIDATES: usize> Default
    for Scratch<ROW, MARKS, SEGMENTS, CANDIDATES>
{
    fn default() -> Self {
        Self::new()
    }
}

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
}

impl Params {
    /// Checks everything once, for images of this size.
    pub fn plan(self, dims: Dims) -> Result<Plan, ParamError> {
        self.check(dims)?;
        Ok(Plan { dims, params: self, models: &FITTED, pixel_model: &FITTED_PIXEL })
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
    work: &'a mut Workspace,
    row_offset: &'a mut i32,
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

    /// Matches one rectified pair.
    ///
    /// The memory must be large enough for the planned size: see [`Scratch`]. A smaller one is refused by [`Plan::check_scratch`]; run with it
    /// all the same, it gives an empty result.
    pub fn run<const R: usize, const M: usize, const S: usize, const C: usize, const OS: usize, const OP: usize>(
        &self,
        left: Gray<'_>,
        right: Gray<'_>,
        scratch: &mut Scratch<R, M, S, C>,
        out: &mut Output<OS, OP>,
    ) -> Result<(), SizeMismatch> {
        self.run_observed(left, right, scratch, out, &mut ())
    }

    /// [`Plan::run`], telling `observer` of every step.
    pub fn run_observed<
        const R: usize,
        const M: usize,
        const S: usize,
        const C: usize,
        const OS: usize,
        const OP: usize,
    >(
        &self,
        left: Gray<'_>,
        right: Gray<'_>,
        scratch: &mut Scratch<R, M, S, C>,
        out: &mut Output<OS, OP>,
        observer: &mut impl Observer,
    ) -> Result<(), SizeMismatch> {
        self.run_on(left, right, &Focus::WHOLE, scratch, out, observer)
    }

    /// [`Plan::run_observed`] in and just around some areas of the left image.
    ///
    /// The candidates there are those of a run over the whole frame, given its row offset; what is made of their neighbours (the confidence of
    /// matches and points) knows no neighbours elsewhere, so those near the border of an area may be listed with another confidence.
    ///
    /// # Cost
    /// About in proportion to the areas, each grown by some 20 px, and in the right image by the disparity range as well.
    pub fn run_on<const R: usize, const M: usize, const S: usize, const C: usize, const OS: usize, const OP: usize>(
        &self,
        left: Gray<'_>,
        right: Gray<'_>,
        focus: &Focus<'_>,
        scratch: &mut Scratch<R, M, S, C>,
        out: &mut Output<OS, OP>,
        observer: &mut impl Observer,
    ) -> Result<(), SizeMismatch> {
        let memory = Memory {
            marks: scratch.marks.get_mut(..mark_words(self.dims)).unwrap_or(&mut []),
            chain: &mut scratch.chain,
            strengths: &mut scratch.strengths,
            rows: scratch.rows.as_flattened_mut().as_flattened_mut(),
            left: &mut scratch.left,
            right: &mut scratch.right,
            candidates: &mut scratch.candidates,
            places: &mut scratch.places,
            order: &mut scratch.order,
            work: &mut scratch.work,
            row_offset: &mut scratch.row_offset,
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
    pub fn for_each_point<const R: usize, const M: usize, const S: usize, const C: usize>(
        &self,
        views: Views<'_>,
        scratch: &mut Scratch<R, M, S, C>,
        mut claim: impl FnMut(PointClaim),
    ) {
        let mut report = Report {
            params: &self.params,
            models: self.models,
            views,
            candidates: &mut scratch.candidates,
            places: &scratch.places,
            order: &mut scratch.order,
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
    pub fn for_each_object<const R: usize, const M: usize, const S: usize, const C: usize>(
        &self,
        scratch: &mut Scratch<R, M, S, C>,
        regions: &[Region<'_>],
        fit: bool,
        mut each: impl FnMut(ObjectDepth),
    ) {
        let mut witnessed = Witnessed {
            candidates: &scratch.candidates,
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
    /// At 64 disparities 40 000 to 53 000 instructions on a Cortex-M7 (means of the built-in pairs), at most 65 000 where segments are dense.
    pub fn depth_at<const R: usize, const M: usize, const S: usize, const C: usize>(
        &self,
        left: Gray<'_>,
        right: Gray<'_>,
        scratch: &mut Scratch<R, M, S, C>,
        (x, y): (u16, u16),
        region: Option<&Region<'_>>,
    ) -> Result<PixelDepth, NotKnown> {
        self.query([left, right], scratch).answer(x, y, region)
    }

    /// The disparity that [`Plan::depth_at`] would answer (1/64 px) and its evidence, whatever its probability: what a model is fitted on.
    pub fn evidence_at<const R: usize, const M: usize, const S: usize, const C: usize>(
        &self,
        left: Gray<'_>,
        right: Gray<'_>,
        scratch: &mut Scratch<R, M, S, C>,
        (x, y): (u16, u16),
        region: Option<&Region<'_>>,
    ) -> Result<(i32, PixelEvidence), NotKnown> {
        self.query([left, right], scratch).weigh_up(x, y, region)
    }

    fn query<'a, const R: usize, const M: usize, const S: usize, const C: usize>(
        &'a self,
        images: [Gray<'a>; 2],
        scratch: &'a mut Scratch<R, M, S, C>,
    ) -> Query<'a> {
        Query {
            params: &self.params,
            model: self.pixel_model,
            images,
            dims: self.dims,
            candidates: &scratch.candidates,
            row_offset: scratch.row_offset,
            rows: scratch.rows.as_flattened_mut().as_flattened_mut(),
            work: &mut scratch.work,
        }
    }

    /// Says whether this scratch memory is large enough for the planned size.
    pub fn check_scratch<const R: usize, const M: usize, const S: usize, const C: usize>(
        &self,
        _: &Scratch<R, M, S, C>,
    ) -> Result<(), ParamError> {
        let (row, marks) = (row_bytes(self.dims.width), mark_words(self.dims));
        if R < row {
            return Err(ParamError::ScratchTooSmall { name: "ROW", needed: row, given: R });
        }
        if M < marks {
            return Err(ParamError::ScratchTooSmall { name: "MARKS", needed: marks, given: M });
        }
        Ok(())
    }

    #[inline(never)]
    fn run_stages(
        &self,
        [left, right]: [Gray<'_>; 2],
        focus: &Focus<'_>,
        m: Memory<'_>,
        out: Lists<'_>,
        observer: &mut impl Observer,
    ) -> Result<(), SizeMismatch> {
        for image in [left, right] {
            if image.dims() != self.dims {
                return Err(SizeMismatch { planned: self.dims, given: image.dims() });
            }
        }
        out.matches.clear();
        out.points.clear();
        *out.counts = Counts::ZERO;

        // Segments of both images; of the left ones, the prominent.
        let sought = Sought::new(focus, self.dims);
        let lines = LineParams {
            anchor: self.params.anchor_gradient.into(),
            edge: self.params.edge_gradient.into(),
            min_extent: self.params.min_extent.into(),
            column_scan: Some(lines::SCAN_STEP),
        };
        // Near-horizontal segments of the right image only tell the row offset.
        let right_lines =
            LineParams { column_scan: focus.row_offset_q5.is_none().then_some(3 * lines::SCAN_STEP), ..lines };
        let scratch = LineScratch { marks: m.marks, chain: m.chain, strengths: m.strengths };
        out.counts.segments_left_dropped =
            lines::detect(left, sought.left(self.params.cell).as_deref(), &lines, scratch, m.left);
        observer.ended(Step::LinesLeft(m.left));
        let scratch = LineScratch { marks: m.marks, chain: m.chain, strengths: m.strengths };
        out.counts.segments_right_dropped =
            lines::detect(right, sought.right(m.left, &self.params).as_deref(), &right_lines, scratch, m.right);
        lines::sort_by_top(m.right);
        observer.ended(Step::LinesRight(m.right));
        out.counts.segments_right = u16::try_from(m.right.len()).unwrap_or(u16::MAX);
        let disparities = (self.params.min_disparity.into(), self.params.max_disparity.into());
        let row_offset_q5 = match focus.row_offset_q5 {
            Some(known) => known.clamp(-row_offset::LIMIT_Q5, row_offset::LIMIT_Q5),
            None => row_offset::estimate(m.left, m.right, disparities),
        };
        *out.row_offset_q5 = row_offset_q5;
        let row_offset_q5 = i32::from(row_offset_q5);
        // The line of a near-horizontal segment says nothing about disparity: no votes.
        m.right.retain(|segment| !segment.near_horizontal);
        let lost = lines::keep_prominent(
            m.left,
            (self.params.cell.into(), m.candidates.capacity()),
            self.dims.width.into(),
            m.marks,
        );
        m.left.retain(|segment| sought.is_wanted(segment));
        lines::sort_by_top(m.left);
        out.counts.segments_left = u16::try_from(m.left.len()).unwrap_or(u16::MAX).saturating_add(lost);
        out.counts.reject_many(Rejection::LessProminent, lost);
        observer.ended(Step::Selection(row_offset_q5, m.left));

        // Three matchings of each, aggregation, ownership.
        m.candidates.clear();
        let context = MatchContext::new(&self.params, self.models, self.dims, m.right, row_offset_q5);
        *m.row_offset = (row_offset_q5 + 16) >> 5;
        let reached = sought.reached(m.left, disparities);
        let Some(mut band) = Band::new([left, right], *m.row_offset, reached.as_deref(), m.rows) else { return Ok(()) };
        for segment in m.left.iter() {
            band.advance_for(segment);
            observer.ended(Step::Rows);
            match matching::match_segment(segment, &context, &band, m.work) {
                Ok(candidate) => {
                    observer.ended(Step::Segment(Ok((&candidate, &m.work.evidence))));
                    let _ = m.candidates.push(candidate); // as many places as segments were kept
                }
                Err(reason) => {
                    observer.ended(Step::Segment(Err(reason)));
                    out.counts.reject(reason);
                }
            }
        }

        // What the claims say of each other, probability, lists.
        consistency::weigh_neighbours(m.candidates, m.places);
        observer.ended(Step::Consistency(m.candidates));
        let report = Report {
            params: &self.params,
            models: self.models,
            views: Views::of(left, right),
            candidates: m.candidates,
            places: m.places,
            order: m.order,
            marks: m.marks,
        };
        report.run(out.matches, out.points, out.counts);
        observer.ended(Step::Report(out.matches, out.points));
        Ok(())
    }
}
