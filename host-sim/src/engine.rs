//! The core with the memory of its last pair, as one call from PC code.

use core::mem::MaybeUninit;
use linestereo::ground::GroundPlane;
use linestereo::health::{HealthFlags, HealthLimits};
use linestereo::params::ParamError;
use linestereo::results::{Bar, Match, PixelDepth, PixelRejection, Point, Rejection};
use linestereo::unstable::{Models, Observer, SupportModels};
use linestereo::{
    Area, Dims, Gray, Matched, Matcher, NoDepth, ObjectDepth, Options, Params, Region, RunError,
};
use linestereo_frames::{MatchError, MatchedPair, memory};
use linestereo_wire::{Counts, Health, PairReport};

/// Least share of the compared segments that are matched for the exchanged pair not to be tried,
/// how many times as many it has to match to be the right one, and how many at least.
const EXCHANGE: (f64, u16, u16) = (0.25, 2, 20);

/// Result of one pair, owned.
#[derive(Clone, Debug, Default)]
pub struct FrameResult {
    /// Matched segments, most confident first.
    pub matches: Vec<Match>,
    /// Points in the order of [`Matched::points`], one per pixel at most.
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
    pub ground: Option<GroundPlane>,
    /// Segments of the exchanged pair: matched, and all of them. `None` unless it matches far more
    /// of them.
    pub exchanged: Option<[u16; 2]>,
}

impl FrameResult {
    /// Points of another method, without segments: what the scores of the core are computed from.
    pub fn of_points(points: Vec<Point>) -> Self {
        Self { points, ..Self::default() }
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

/// A matcher with the memory of its last pair: make one per image size and thread, call
/// [`Engine::run`] per pair.
pub struct Engine {
    /// Health, row offset and ground of the pairs so far.
    pub matcher: Matcher,
    /// The last pair, for questions that come later.
    last: Option<MatchedPair>,
    /// Memory of pairs that are not kept.
    words: Vec<MaybeUninit<u64>>,
    /// Pairs that are not fit to be used are answered.
    answers_unfit: bool,
    /// Where pairs are matched; everywhere without.
    pub areas: Option<Vec<Area>>,
}

impl Engine {
    /// Checks the parameters for images of this size, once.
    pub fn new(params: &Params, dims: Dims) -> Result<Self, ParamError> {
        let matcher = Matcher::new(*params, dims)?;
        Ok(Self { matcher, last: None, words: Vec::new(), answers_unfit: false, areas: None })
    }

    /// The same engine, which answers pairs that are not fit to be used as well: for scores of the
    /// method, beside those of its health.
    pub fn answering_unfit(mut self) -> Self {
        self.answers_unfit = true;
        self
    }

    /// The same engine with other confidence models, which stay in memory: a matcher refers to
    /// constants on a board.
    pub fn with_models(mut self, FittedModels { segments, support }: FittedModels) -> Self {
        self.matcher.set_models(Box::leak(Box::new(segments)), Box::leak(Box::new(support)));
        self
    }

    /// Health takes this disparity, px, for that of what is infinitely far; with a rig it is known.
    pub fn expect_infinity_at(&mut self, zero_px: f64) {
        let least_q6 = f64::from(HealthLimits::DEFAULT.least_disparity_q6) + 64.0 * zero_px;
        self.matcher.limits.least_disparity_q6 = least_q6 as i16;
    }

    /// The pair that was matched last.
    ///
    /// # Panics
    /// Before the first pair.
    pub fn matched(&self) -> &Matched<'_> {
        self.last.as_ref().expect("a pair was matched").get()
    }

    /// Asks the pair that was matched last what needs its memory.
    ///
    /// # Panics
    /// Before the first pair.
    pub fn ask<T>(&mut self, ask: impl FnOnce(&mut Matched<'_>) -> T) -> T {
        self.last.as_mut().expect("a pair was matched").ask(ask)
    }

    /// The depth of a region in the pair that was matched last.
    pub fn object(&mut self, region: &Region<'_>) -> Result<ObjectDepth, NoDepth> {
        self.ask(|matched| matched.object(region))
    }

    /// The depth of one pixel of the pair that was matched last.
    pub fn depth_at(&mut self, pixel: (u16, u16)) -> Result<PixelDepth, PixelRejection> {
        self.ask(|matched| matched.pixel(pixel))
    }

    /// Runs the core without keeping the pair or listing points, and answers whatever its health
    /// is: for benchmarks and for loops that read it in place.
    pub fn run_in_place<'a>(
        &'a mut self,
        left: Gray<'a>,
        right: Gray<'a>,
    ) -> Result<Matched<'a>, RunError> {
        // As before its first pair, wherever the ground is.
        let mut matcher = self.matcher.clone();
        matcher.forget_health();
        matcher.expect_ground(None);
        let mut matched = matcher.run(memory(&mut self.words, matcher.dims()), left, right)?;
        matched.ignore_health();
        Ok(matched)
    }

    /// Runs the core on one rectified pair that stands alone: its health knows of no other.
    pub fn run(&mut self, left: Gray<'_>, right: Gray<'_>) -> Result<FrameResult, MatchError> {
        self.run_observed(left, right, &mut ())
    }

    /// [`Engine::run`], telling `observer` of every step.
    pub fn run_observed(
        &mut self,
        left: Gray<'_>,
        right: Gray<'_>,
        observer: &mut dyn Observer,
    ) -> Result<FrameResult, MatchError> {
        self.matcher.forget_health();
        self.run_next((left, right), None, observer)
    }

    /// Runs the core on the next pair of a rig. A pair that is not fit to be used has an empty
    /// result, as has one whose images match far better when they are exchanged.
    pub fn run_next(
        &mut self,
        (left, right): (Gray<'_>, Gray<'_>),
        times_us: Option<[u64; 2]>,
        observer: &mut dyn Observer,
    ) -> Result<FrameResult, MatchError> {
        let mut buffers = self.last.take().map(MatchedPair::into_buffers).unwrap_or_default();
        buffers.copy([left, right]);
        let options = Options { areas: self.areas.as_deref(), times_us, observer: Some(observer) };
        let mut last = MatchedPair::run(&mut self.matcher, buffers, options)?;
        let exchanged = self.try_exchanged(last.get(), right, left);
        let result = last.ask(|matched| {
            if exchanged.is_some() {
                matched.add_faults(HealthFlags::FEW_MATCHES);
            }
            let health = *matched.health();
            if self.answers_unfit && !matched.is_fit() {
                matched.ignore_health();
            }
            let points: Vec<Point> = matched.points().collect();
            let mut counts: Counts = matched.counts().into();
            counts.points = u32::try_from(points.len()).unwrap_or(u32::MAX);
            FrameResult {
                matches: matched.segments().to_vec(),
                points,
                obstacle_points: matched.obstacle_points().collect(),
                bars: matched.bars().to_vec(),
                counts,
                health: Health::of(matched.counts()) | health.flags.into(),
                pair: Some((&health).into()),
                ground: matched.ground(),
                exchanged,
            }
        });
        self.last = Some(last);
        Ok(result)
    }

    /// Matches the exchanged pair where few segments match: the matched ones and all of its
    /// segments, if they are far more. The same holds for images that are both mirrored or upside
    /// down.
    fn try_exchanged(
        &mut self,
        matched: &Matched<'_>,
        left: Gray<'_>,
        right: Gray<'_>,
    ) -> Option<[u16; 2]> {
        let (enough, times, least) = EXCHANGE;
        let compared = |counts: &linestereo::results::Counts| {
            counts.segments_left - counts.rejected(Rejection::LessProminent)
        };
        let counts = matched.counts();
        if f64::from(counts.matched) >= enough * f64::from(compared(counts))
            || matched.health().is_refused()
        {
            return None;
        }
        let other = self.run_in_place(left, right).ok()?;
        let found = other.counts();
        (found.matched >= least.max(times * counts.matched))
            .then(|| [found.matched, compared(found)])
    }
}
