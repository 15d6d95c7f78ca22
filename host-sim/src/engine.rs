//! The core with memory for any image up to 1280 x 1280, as one call from PC code.

use crate::fitting::FittedModels;
use linestereo::{
    Area, Candidate, Dims, Focus, Gray, HealthLimits, HealthMonitor, Match, NotKnown, ObjectDepth, Observer, Output,
    ParamError, Params, PixelDepth, PixelEvidence, Plan, PointClaim, Region, RunError, Scratch, Support, mark_words,
    most_support_points, row_bytes,
};
pub use linestereo_baselines::GrayImage;
use linestereo_wire::{Counts, Health, PairReport};

/// Most segments listed per frame on a PC.
pub const MAX_MATCHES: usize = 4096;
/// Most points listed per frame on a PC.
pub const MAX_POINTS: usize = 131_072;

const LARGEST: Dims = Dims { width: 1280, height: 1280 };

type PcScratch = Scratch<
    { row_bytes(LARGEST.width) },
    { mark_words(LARGEST) },
    MAX_MATCHES,
    MAX_MATCHES,
    { most_support_points(LARGEST) },
>;

/// Result of one pair, owned.
#[derive(Clone, Debug)]
pub struct FrameResult {
    /// Matched segments, most confident first.
    pub matches: Vec<Match>,
    /// Claimed points, most confident first, one per pixel at most.
    pub points: Vec<PointClaim>,
    /// What was found, rejected and dropped.
    pub counts: Counts,
    /// What is wrong with the pair.
    pub health: Health,
    /// The numbers behind it; `None` when nobody looked.
    pub pair: Option<PairReport>,
}

impl FrameResult {
    /// Points of another method, without segments: what the scores of the core are computed from.
    #[must_use]
    pub fn of_points(points: Vec<PointClaim>) -> Self {
        Self { matches: Vec::new(), points, counts: Counts::default(), health: Health::GOOD, pair: None }
    }

    /// The same; without its points if asked. The counts stay.
    #[must_use]
    pub fn without_points(&self, without: bool) -> Self {
        let points = if without { Vec::new() } else { self.points.clone() };
        Self { matches: self.matches.clone(), points, ..*self }
    }
}

/// A planned core with its memory: make one per image size and thread, call [`Engine::run`] per pair.
pub struct Engine {
    plan: Plan,
    scratch: Box<PcScratch>,
    output: Box<Output<MAX_MATCHES, MAX_POINTS>>,
    /// Where pairs are matched; everywhere without.
    areas: Option<Vec<Area>>,
    /// Of the last pair that was matched as a whole.
    row_offset_q5: Option<i16>,
}

impl Engine {
    /// Checks the parameters for images of this size and allocates the memory, once.
    pub fn new(params: &Params, dims: Dims) -> Result<Self, ParamError> {
        let plan = params.plan(dims)?;
        let (scratch, output) = (Box::new(PcScratch::new()), Box::new(Output::new()));
        Ok(Self { plan, scratch, output, areas: None, row_offset_q5: None })
    }

    /// The same engine with other confidence models, which stay in memory: plans refer to constants on a board.
    #[must_use]
    pub fn with_models(self, FittedModels { segments, support }: FittedModels) -> Self {
        let plan = self.plan.with_models(Box::leak(Box::new(segments)));
        Self { plan: plan.with_support_model(Box::leak(Box::new(support))), ..self }
    }

    /// Size of the pairs.
    #[must_use]
    pub fn dims(&self) -> Dims {
        self.plan.dims()
    }

    /// The support points of the last run.
    #[must_use]
    pub fn support(&self) -> Support<'_> {
        self.plan.support(&self.scratch)
    }

    /// From now on pairs are matched in and just around these areas alone; `None` is the whole frame.
    pub fn focus(&mut self, areas: Option<Vec<Area>>) {
        self.areas = areas;
    }

    /// Has a whole pair said how far the rows of both images are apart?
    #[must_use]
    pub fn knows_rows(&self) -> bool {
        self.row_offset_q5.is_some()
    }

    /// What passed the hard tests of the last run, with its evidence.
    #[must_use]
    pub fn candidates(&self) -> &[Candidate] {
        self.scratch.candidates()
    }

    /// The depth of each region, by the last run; `fit` says whether its pair is healthy enough to be believed.
    #[must_use]
    pub fn objects(&mut self, regions: &[Region<'_>], fit: bool) -> Vec<ObjectDepth> {
        let mut found = Vec::with_capacity(regions.len());
        self.plan.for_each_object(&mut self.scratch, regions, fit, |object| found.push(object));
        found
    }

    /// The depth of one pixel of the pair that was matched last.
    pub fn depth_at(
        &mut self,
        left: Gray<'_>,
        right: Gray<'_>,
        pixel: (u16, u16),
        region: Option<&Region<'_>>,
    ) -> Result<PixelDepth, NotKnown> {
        self.plan.depth_at(left, right, &mut self.scratch, pixel, region)
    }

    /// Disparity of one pixel (1/64 px) and its evidence, whatever its probability.
    pub fn evidence_at(
        &mut self,
        left: Gray<'_>,
        right: Gray<'_>,
        pixel: (u16, u16),
    ) -> Result<(i32, PixelEvidence), NotKnown> {
        self.plan.evidence_at(left, right, &mut self.scratch, pixel, None)
    }

    /// Runs the core without copying the result out: for benchmarks and for loops that read it in place.
    pub fn run_in_place(
        &mut self,
        left: Gray<'_>,
        right: Gray<'_>,
    ) -> Result<&Output<MAX_MATCHES, MAX_POINTS>, RunError> {
        self.run_observed(left, right, &mut ())
    }

    /// Runs the core, telling `observer` of every step.
    pub fn run_observed(
        &mut self,
        left: Gray<'_>,
        right: Gray<'_>,
        observer: &mut impl Observer,
    ) -> Result<&Output<MAX_MATCHES, MAX_POINTS>, RunError> {
        let areas = self.areas.as_deref();
        let focus = Focus { areas, row_offset_q5: self.row_offset_q5.filter(|_| areas.is_some()) };
        self.plan.run_on(left, right, &focus, &mut self.scratch, &mut self.output, observer)?;
        if areas.is_none() {
            self.row_offset_q5 = Some(self.output.row_offset_q5);
        }
        Ok(&self.output)
    }

    /// Runs the core on one rectified pair that stands alone: its health knows of no other.
    pub fn run(&mut self, left: Gray<'_>, right: Gray<'_>) -> Result<FrameResult, RunError> {
        self.run_watched(left, right, &mut HealthMonitor::new(), &HealthLimits::DEFAULT, None)
    }

    /// Runs the core on the next pair of a rig. A pair that is refused has an empty result.
    pub fn run_watched(
        &mut self,
        left: Gray<'_>,
        right: Gray<'_>,
        monitor: &mut HealthMonitor,
        limits: &HealthLimits,
        times_us: Option<[u64; 2]>,
    ) -> Result<FrameResult, RunError> {
        self.run_watched_observed((left, right), monitor, limits, times_us, &mut ())
    }

    /// [`Engine::run_watched`], telling `observer` of every step.
    pub fn run_watched_observed(
        &mut self,
        (left, right): (Gray<'_>, Gray<'_>),
        monitor: &mut HealthMonitor,
        limits: &HealthLimits,
        times_us: Option<[u64; 2]>,
        observer: &mut impl Observer,
    ) -> Result<FrameResult, RunError> {
        let mut health = monitor.look(limits, left, right, times_us);
        let empty = FrameResult {
            matches: Vec::new(),
            points: Vec::new(),
            counts: Counts::default(),
            health: health.flags.into(),
            pair: Some((&health).into()),
        };
        if health.is_refused() {
            return Ok(empty);
        }
        let output = self.run_observed(left, right, observer)?;
        monitor.look_at_matches(limits, (left, right), (&output.matches, &output.counts), &mut health);
        Ok(FrameResult {
            matches: output.matches.to_vec(),
            points: output.points.to_vec(),
            counts: (&output.counts).into(),
            health: Health::of(&output.counts) | health.flags.into(),
            pair: Some((&health).into()),
        })
    }
}
