//! The core with memory for any image up to 1280 x 1280, as one call from PC code.

use linestereo::diagnostics::{Models, Observer, SupportModels};
use linestereo::image::ViewError;
use linestereo::{
    Area, Bar, Capacity, Dims, Gray, GroundPlane, HealthFlags, HealthLimits, Match, Matched,
    Matcher, Memory, ObjectDepth, Pair, ParamError, Params, PixelDepth, PixelRejection, Plan,
    Point, Region, Rejection, RunError, Span, Summary,
};
use linestereo_wire::{Counts, Health, PairReport};

/// Most segments listed per frame on a PC: as many as the core can number, whose indices have
/// twelve bits. Captured pairs of up to 752x480 have 1600.
pub const MAX_MATCHES: usize = 4096;

const LARGEST: Dims = Dims { width: 1280, height: 1280 };

/// Room for the finest squares as well.
const CAPACITY: Capacity = Capacity { dims: LARGEST, segments: MAX_MATCHES as u16, cell: 8 };

type PcMemory = Memory<{ CAPACITY.words() }, MAX_MATCHES>;

/// Least share of the compared segments that are matched for the exchanged pair not to be tried,
/// how many times as many it has to match to be the right one, and how many at least.
const EXCHANGE: (f64, u16, u16) = (0.25, 2, 20);

/// Result of one pair, owned.
#[derive(Clone, Debug)]
pub struct FrameResult {
    /// Matched segments, most confident first.
    pub matches: Vec<Match>,
    /// Points, most confident first, one per pixel at most.
    pub points: Vec<Point>,
    /// Thin things in front of what is around them.
    pub bars: Vec<Bar>,
    /// Support points that sectors take, less probable ones too.
    pub obstacle_points: Vec<Point>,
    /// Counts of segments found, rejected and dropped.
    pub counts: Counts,
    /// Faults of the pair.
    pub health: Health,
    /// The numbers behind it; `None` when nobody looked.
    pub pair: Option<PairReport>,
    /// The ground plane, if one was found.
    pub ground: Option<GroundPlane>,
    /// Segments of the exchanged pair: matched, and all of them. `None` unless it matches far more
    /// of them.
    pub exchanged: Option<[u16; 2]>,
}

impl FrameResult {
    /// Points of another method, without segments: what the scores of the core are computed from.
    pub fn of_points(points: Vec<Point>) -> Self {
        Self {
            matches: Vec::new(),
            points,
            obstacle_points: Vec::new(),
            bars: Vec::new(),
            counts: Counts::default(),
            health: Health::GOOD,
            pair: None,
            ground: None,
            exchanged: None,
        }
    }

    /// The same; without its points if asked. The counts stay.
    pub fn without_points(&self, without: bool) -> Self {
        let points = if without { Vec::new() } else { self.points.clone() };
        Self {
            matches: self.matches.clone(),
            points,
            obstacle_points: self.obstacle_points.clone(),
            bars: self.bars.clone(),
            ..*self
        }
    }
}

/// Every model of the core that is fitted on answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FittedModels {
    /// Of the sides of segments.
    pub segments: Models,
    /// Of support points.
    pub support: SupportModels,
}

/// A planned core with its memory: make one per image size and thread, call [`Engine::run`] per
/// pair.
pub struct Engine {
    matcher: Matcher,
    memory: Box<PcMemory>,
    /// Memory of pairs that are tried; none before the first.
    trial: Option<Box<PcMemory>>,
    /// Pairs that are not fit to be used are answered.
    answers_unfit: bool,
    /// Where pairs are matched; everywhere without.
    areas: Option<Vec<Area>>,
    /// The last pair, for questions that come later.
    last: (Summary, [KeptImage; 2]),
}

/// A copy of an image that was matched.
#[derive(Default)]
struct KeptImage {
    pixels: Vec<u8>,
    usable: Vec<Span>,
}

impl KeptImage {
    fn keep(&mut self, image: Gray<'_>) {
        self.pixels.clear();
        for y in 0..usize::from(image.dims().height) {
            self.pixels.extend_from_slice(image.row(y).unwrap_or(&[]));
        }
        self.usable.clear();
        self.usable.extend_from_slice(image.valid());
    }

    fn view(&self, dims: Dims) -> Result<Gray<'_>, ViewError> {
        let view = Gray::new(&self.pixels, dims, dims.width.into())?;
        if self.usable.is_empty() { Ok(view) } else { view.with_valid(&self.usable) }
    }
}

impl Engine {
    /// Checks the parameters for images of this size and allocates the memory, once.
    pub fn new(params: &Params, dims: Dims) -> Result<Self, ParamError> {
        let matcher = params.matcher(dims)?;
        let blank = || KeptImage {
            pixels: vec![0; usize::from(dims.width) * usize::from(dims.height)],
            usable: Vec::new(),
        };
        Ok(Self {
            matcher,
            memory: Box::new(PcMemory::new()),
            trial: None,
            answers_unfit: false,
            areas: None,
            last: (Summary::default(), [blank(), blank()]),
        })
    }

    /// The same engine, which answers pairs that are not fit to be used as well: for scores of the
    /// method, beside those of its health.
    pub fn answering_unfit(mut self) -> Self {
        self.answers_unfit = true;
        self
    }

    /// The same engine with other confidence models, which stay in memory: plans refer to constants
    /// on a board.
    pub fn with_models(mut self, FittedModels { segments, support }: FittedModels) -> Self {
        let plan = self.matcher.plan().with_models(Box::leak(Box::new(segments)));
        self.matcher.set_plan(plan.with_support_models(Box::leak(Box::new(support))));
        self
    }

    /// The same engine without bars, for comparisons.
    pub fn without_bars(mut self) -> Self {
        let plan = self.matcher.plan().without_bars();
        self.matcher.set_plan(plan);
        self
    }

    /// From now on pairs whose images were captured up to so far apart are matched.
    pub fn allow_skew(&mut self, skew_us: u32) {
        self.matcher.limits.skew_us = skew_us;
    }

    /// Health takes this disparity, px, for that of what is infinitely far; of a plan with a rig it
    /// is known.
    pub fn expect_infinity_at(&mut self, zero_px: f64) {
        let least_q6 = f64::from(HealthLimits::DEFAULT.least_disparity_q6) + 64.0 * zero_px;
        self.matcher.limits.least_disparity_q6 = least_q6 as i16;
    }

    pub fn dims(&self) -> Dims {
        self.matcher.plan().dims()
    }

    /// From now on the ground is where the camera's pose says that it is.
    pub fn expect_ground(&mut self, plane: Option<GroundPlane>) {
        self.matcher.expect_ground(plane);
    }

    /// From now on pairs are matched in and just around these areas alone; `None` is the whole
    /// frame.
    pub fn focus(&mut self, areas: Option<Vec<Area>>) {
        self.areas = areas;
    }

    /// Has a whole pair said how far the rows of both images are apart?
    pub fn knows_rows(&self) -> bool {
        self.matcher.knows_rows()
    }

    /// The pair that was matched last; a blank one before.
    ///
    /// # Panics
    /// Never: the images were of the planned size.
    pub fn matched(&mut self) -> Matched<'_> {
        let plan = *self.matcher.plan();
        let (summary, images) = &self.last;
        let [left, right] =
            images.each_ref().map(|image| image.view(plan.dims()).expect("as it was matched"));
        plan.resume(summary, [left, right], &mut self.memory).expect("as it was matched")
    }

    /// The depth of each region in the pair that was matched last.
    pub fn objects(&mut self, regions: &[Region<'_>]) -> Vec<ObjectDepth> {
        let mut found = Vec::with_capacity(regions.len());
        self.matched().objects(regions, |object| found.push(object));
        found
    }

    /// The depth of one pixel of the pair that was matched last.
    pub fn depth_at(
        &mut self,
        pixel: (u16, u16),
        region: Option<&Region<'_>>,
    ) -> Result<PixelDepth, PixelRejection> {
        self.matched().pixel(pixel, region)
    }

    /// Runs the core without keeping the pair or listing points: for benchmarks and for loops that
    /// read it in place.
    pub fn run_in_place<'a>(
        &'a mut self,
        left: Gray<'a>,
        right: Gray<'a>,
    ) -> Result<Matched<'a>, RunError> {
        self.matcher.plan().run([left, right], &mut self.memory)
    }

    /// Runs the core on one rectified pair that stands alone: its health knows of no other.
    pub fn run(&mut self, left: Gray<'_>, right: Gray<'_>) -> Result<FrameResult, RunError> {
        self.run_observed(left, right, &mut ())
    }

    /// [`Engine::run`], telling `observer` of every step.
    pub fn run_observed(
        &mut self,
        left: Gray<'_>,
        right: Gray<'_>,
        observer: &mut impl Observer,
    ) -> Result<FrameResult, RunError> {
        self.matcher.forget_health();
        self.run_next((left, right), None, observer)
    }

    /// Runs the core on the next pair of a rig. A pair that is not fit to be used has an empty
    /// result, as has one whose images match far better when they are exchanged.
    pub fn run_next(
        &mut self,
        (left, right): (Gray<'_>, Gray<'_>),
        times_us: Option<[u64; 2]>,
        observer: &mut impl Observer,
    ) -> Result<FrameResult, RunError> {
        let pair = Pair { left, right, times_us };
        let mut matched =
            self.matcher.run_with(pair, &mut self.memory, self.areas.as_deref(), observer)?;
        let exchanged =
            try_exchanged(&matched, [right, left], *self.matcher.plan(), &mut self.trial);
        if exchanged.is_some() {
            matched.add_faults(HealthFlags::FEW_MATCHES);
        }
        let health = *matched.health();
        if self.answers_unfit && !matched.summary().is_fit() {
            // A plan that runs alone knows no health.
            matched = self.matcher.plan().run([left, right], &mut self.memory)?;
        }
        let mut points = Vec::new();
        matched.points(|point| points.push(point));
        let obstacle_points = matched.obstacle_points().collect();
        let mut counts: Counts = matched.counts().into();
        counts.points = u32::try_from(points.len()).unwrap_or(u32::MAX);
        let result = FrameResult {
            matches: matched.segments().to_vec(),
            points,
            obstacle_points,
            bars: matched.bars().to_vec(),
            counts,
            health: Health::of(matched.counts()) | health.flags.into(),
            pair: Some((&health).into()),
            ground: matched.ground(),
            exchanged,
        };
        let summary = *matched.summary();
        let (last, images) = &mut self.last;
        *last = summary;
        for (kept, image) in images.iter_mut().zip([left, right]) {
            kept.keep(image);
        }
        Ok(result)
    }
}

/// Matches the exchanged pair where few segments match: the matched ones and all of its segments,
/// if they are far more. The same holds for images that are both mirrored or upside down.
fn try_exchanged(
    matched: &Matched<'_>,
    exchanged: [Gray<'_>; 2],
    plan: Plan,
    trial: &mut Option<Box<PcMemory>>,
) -> Option<[u16; 2]> {
    let (enough, times, least) = EXCHANGE;
    let compared = |counts: &linestereo::Counts| {
        counts.segments_left - counts.rejected(Rejection::LessProminent)
    };
    let counts = matched.counts();
    if f64::from(counts.matched) >= enough * f64::from(compared(counts))
        || matched.health().is_refused()
    {
        return None;
    }
    let trial = trial.get_or_insert_with(|| Box::new(PcMemory::new()));
    let other = plan.run(exchanged, trial).ok()?;
    let found = other.counts();
    (found.matched >= least.max(times * counts.matched)).then(|| [found.matched, compared(found)])
}
