//! Matching of consecutive pairs of one rig: health before and after, the run between.
//!
//! In: parameters, pairs. Out: a [`Matched`] each. State: the health monitor, the row offset of the
//! last whole pair that was fit, and the ground plane of the last pair.
//!
//! ```text
//! check the images; a pair that is refused is not matched: it has no matches, and objects and
//!     pixels have no depth
//! match the whole frame, or parts of it with the row offset of the last whole pair; look for the
//! ground near that of the pair before, or, while there is none, in every fourth pair
//! check the matches
//! support points alone: match the first pair, one in 64 after it, one in 8 while the row offset is
//!     not known or the pair is not fit, and the next one where points disagree about the rows and
//!     did not in the last check, with segments as well, which are not answered: for the row offset, and to see whether
//!     most of the pair matches
//! ```

use crate::area::Area;
use crate::cores::{Cores, lend};
use crate::focus::{self, SearchRegions};
use crate::ground::{GroundPlane, GroundSearch};
use crate::health::{Findings, HealthLimits, HealthMonitor, Measured, PairHealth};
use crate::image::{Dims, Gray};
use crate::matched::{Matched, Summary};
use crate::memory::{MemorySlice, RunError};
use crate::observe::{Observer, StageEvent};
use crate::params::{ParamError, Params, Parts};
use crate::pipeline::Run;
use crate::plan::Plan;
#[cfg(feature = "unstable")]
use crate::{confidence::Models, support::SupportModels};
use core::fmt;

/// Rare options of [`Matcher::run_with`].
///
/// ```
/// use linestereo::Options;
/// let options = Options { times_us: Some([1000, 1010]), ..Options::default() };
/// ```
#[derive(Default)]
pub struct Options<'o> {
    /// Areas of the left image that are matched, with their surroundings, with the row offset of
    /// the last whole pair, or, before the first, one estimated in them. Those that meet are joined
    /// where that costs less, and of more than [`Options::MAX_AREAS`] the last ones. `None` is the
    /// whole image; without a pixel in any of them nothing is matched. Obstacles are not taken from
    /// areas ([`Matched::update_obstacles`]).
    pub areas: Option<&'o [Area]>,
    /// Times of capture, left and right, us of one clock, if known.
    pub times_us: Option<[u64; 2]>,
    /// Is called at the end of each stage. The trait is in `unstable`.
    pub observer: Option<&'o mut dyn Observer>,
}

impl Options<'_> {
    /// Largest number of separate areas.
    pub const MAX_AREAS: usize = focus::MAX_AREAS;
}

impl fmt::Debug for Options<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { areas, times_us, observer } = self;
        let mut out = f.debug_struct("Options");
        out.field("areas", areas).field("times_us", times_us);
        out.field("is_observed", &observer.is_some()).finish()
    }
}

/// Pairs from one search of the ground to the next, while none is found.
const SEARCH_PERIOD: u8 = 4;
/// Pairs of support points alone from one that is matched with segments to the next.
const CHECK_PERIOD: u8 = 64;
/// The same while the row offset is not known, or the pair was not fit.
const SHORT_CHECK_PERIOD: u8 = 8;

/// Checked parameters for one size of images, the health monitor, the row offset of the last whole
/// pair and the ground plane of the last pair.
#[derive(Clone, Debug)]
pub struct Matcher {
    /// Limits of health, in the units of each field.
    pub limits: HealthLimits,
    plan: Plan,
    monitor: HealthMonitor,
    /// Row offset of the last fit pair that was matched as a whole and measured it, 1/32 px; 0 if
    /// none of them did.
    row_offset_q5: Option<i16>,
    /// Ground plane of the last pair.
    ground: Option<GroundPlane>,
    /// Pairs until the ground is searched again, while none is known.
    unsearched: u8,
    /// Where the camera's pose says that the ground is.
    expected: Option<GroundPlane>,
    /// Pairs of support points alone until one is matched with segments.
    unchecked: u8,
    /// In the last one with segments points agreed about the rows.
    agreed: bool,
}

impl Matcher {
    /// A matcher before the first pair, for images of this size, with default limits of health for
    /// the rig. All floating-point work is done here.
    ///
    /// # Errors
    /// The parameter that cannot be used.
    pub fn new(params: Params, dims: Dims) -> Result<Self, ParamError> {
        Ok(Self {
            limits: HealthLimits::DEFAULT.of_rig(params.rig.as_ref()),
            plan: Plan::new(params, dims)?,
            monitor: HealthMonitor::new(),
            row_offset_q5: None,
            ground: None,
            unsearched: 0,
            expected: None,
            unchecked: 0,
            agreed: false,
        })
    }

    /// Parameters of the matching.
    #[must_use]
    pub const fn params(&self) -> &Params {
        &self.plan.params
    }

    /// Size of both images.
    #[must_use]
    pub const fn dims(&self) -> Dims {
        self.plan.dims
    }

    /// Changes the parameters for further pairs of the same cameras. The state of health, the row
    /// offset and the ground plane stay, unless the images have another size. With another rig its
    /// limit of disparities ([`HealthLimits::of_rig`]) is set.
    ///
    /// # Errors
    /// As [`Matcher::new`]; then nothing is changed.
    pub fn set_params(&mut self, params: Params, dims: Dims) -> Result<(), ParamError> {
        params.check(dims)?;
        if params.rig != self.plan.params.rig {
            self.limits = self.limits.of_rig(params.rig.as_ref());
        }
        if dims != self.plan.dims {
            self.row_offset_q5 = None;
            self.forget_health();
        }
        self.plan = Plan { dims, params, ..self.plan };
        Ok(())
    }

    /// Says where the ground is in pairs from now on, by the camera's pose
    /// ([`GroundPlane::of_pose`]): measured by an IMU before each pair, or once, as it is mounted.
    /// It is looked for there alone, and taken as said where it is not seen. `None`, as at first,
    /// looks for it in the images.
    pub fn expect_ground(&mut self, plane: Option<GroundPlane>) {
        self.expected = plane;
    }

    /// True when the row offset is known of a pair that was fit: of a whole one, or, with support
    /// points alone, by the edges in its areas.
    #[must_use]
    pub fn knows_rows(&self) -> bool {
        self.row_offset_q5.is_some()
    }

    /// Matches the next pair. `left` is the reference of all results.
    ///
    /// # Errors
    /// Images of another size, and a memory that is too small for them (see
    /// [`Capacity`](crate::Capacity)); such a pair does not change the state.
    pub fn run<'a>(
        &mut self,
        memory: &'a mut MemorySlice,
        left: Gray<'a>,
        right: Gray<'a>,
    ) -> Result<Matched<'a>, RunError> {
        self.run_with(memory, left, right, Options::default())
    }

    /// [`Matcher::run`] with options.
    ///
    /// # Errors
    /// As [`Matcher::run`].
    pub fn run_with<'a>(
        &mut self,
        memory: &'a mut MemorySlice,
        left: Gray<'a>,
        right: Gray<'a>,
        options: Options<'_>,
    ) -> Result<Matched<'a>, RunError> {
        self.run_by(None, memory, [left, right], options)
    }

    /// [`Matcher::run_with`] on two cores, with the same result bit for bit. They match segments
    /// together where the memory was made for both ([`Capacity::two_cores`]). An observer sees
    /// everything in order: with one the run is on this core alone.
    ///
    /// [`Capacity::two_cores`]: crate::Capacity::two_cores
    ///
    /// # Errors
    /// As [`Matcher::run`].
    pub fn run_on<'a>(
        &mut self,
        cores: &mut impl Cores, // compiled where it is called: without that no program has it
        memory: &'a mut MemorySlice,
        left: Gray<'a>,
        right: Gray<'a>,
        options: Options<'_>,
    ) -> Result<Matched<'a>, RunError> {
        self.run_by(Some(cores), memory, [left, right], options)
    }

    #[inline(never)]
    fn run_by<'a>(
        &mut self,
        cores: Option<&mut dyn Cores>, // `None` in all calls of most programs
        memory: &'a mut MemorySlice,
        [left, right]: [Gray<'a>; 2],
        options: Options<'_>,
    ) -> Result<Matched<'a>, RunError> {
        let Options { areas, times_us, observer } = options;
        let mut cores = cores.filter(|_| observer.is_none());
        let mut nobody = ();
        let observer = observer.unwrap_or(&mut nobody);
        let Plan { params, dims, .. } = self.plan;
        if let Some(image) = [left, right].iter().find(|image| image.dims() != dims) {
            return Err(RunError::SizeMismatch { planned: dims, given: image.dims() });
        }
        let buffers = memory.cut(dims, params.cell)?;
        let mut health =
            self.monitor.check_images_on(lend(&mut cores), &self.limits, [left, right], times_us);
        observer.on_event(StageEvent::Health(&health));
        if health.is_refused() {
            return Ok(Matched {
                plan: self.plan,
                images: [left, right],
                buffers,
                summary: Summary { health, ..Summary::default() },
            });
        }
        // Support points alone say too little about rows, and about whether most of the pair
        // matches.
        let are_points_alone = params.parts == Parts::Support;
        let has_segments = !are_points_alone || self.unchecked == 0;
        let parts = if has_segments { Parts::Both } else { Parts::Support };
        let is_whole = areas.is_none();
        let ground = match (self.expected, self.ground, self.unsearched) {
            (Some(plane), ..) => GroundSearch::Given(plane),
            (None, Some(plane), _) => GroundSearch::Near(plane),
            (None, None, 0) => GroundSearch::Everywhere,
            (None, None, _) => GroundSearch::Off,
        };
        let run = Run {
            plan: &self.plan,
            images: [left, right],
            regions: SearchRegions::new(areas, dims),
            known_rows_q5: self.row_offset_q5,
            // In areas segments may be too few; a check looks for what has changed.
            estimates_rows: self.row_offset_q5.is_none()
                || has_segments && (is_whole || are_points_alone),
            ground,
            parts,
            // Points alone are the same with a check as without.
            has_bars: self.plan.has_bars && is_whole && !are_points_alone,
        };
        let (mut matched, measured) = run.stages(cores, buffers, observer);
        self.ground = matched.summary.plane;
        self.unsearched = match ground {
            GroundSearch::Off => self.unsearched.saturating_sub(1),
            _ => SEARCH_PERIOD - 1,
        };
        let findings = Findings { has_segments, ..matched.findings() };
        let measured = measured.unwrap_or_else(|| Measured::new([left, right], &findings));
        let agree = measured.of_points.agree_on_rows();
        self.monitor.judge(&self.limits, left, &findings, measured, &mut health);
        if has_segments && (is_whole || are_points_alone) {
            self.learn_rows(matched.summary.row_offset_q5, is_whole, &health);
        }
        if are_points_alone {
            self.schedule_check(has_segments, agree, &health);
            matched.drop_segments();
        }
        observer.on_event(StageEvent::Health(&health));
        matched.summary.health = health;
        Ok(matched)
    }

    /// Keeps the row offset of a pair that is fit, 1/32 px: as measured or before, else the 0 at
    /// which a whole pair has matched.
    fn learn_rows(&mut self, found_q5: Option<i16>, is_whole: bool, health: &PairHealth) {
        if health.flags.is_fit() {
            self.row_offset_q5 = found_q5.or(is_whole.then_some(0));
        }
    }

    /// Counts the pairs of support points alone until one with segments, a check: the next one, if
    /// points did `agree` about the rows in the last check, and do not in this pair.
    fn schedule_check(&mut self, has_segments: bool, agree: bool, health: &PairHealth) {
        let is_well = self.row_offset_q5.is_some() && health.flags.is_fit();
        let period = if is_well { CHECK_PERIOD } else { SHORT_CHECK_PERIOD };
        let left = if has_segments {
            self.agreed = agree;
            period
        } else if self.agreed && !agree {
            0
        } else {
            self.unchecked.min(period)
        };
        self.unchecked = left.saturating_sub(1);
    }

    /// Resets the state of health, and forgets the ground plane; the row offset stays.
    pub fn forget_health(&mut self) {
        self.monitor = HealthMonitor::new();
        (self.ground, self.unsearched, self.unchecked) = (None, 0, 0);
    }
}

/// Other models, for fits and comparisons.
#[cfg(feature = "unstable")]
impl Matcher {
    /// Rates segments and support points by other models.
    pub fn set_models(&mut self, segments: &'static Models, support: &'static SupportModels) {
        self.plan = Plan { models: segments, support_models: support, ..self.plan };
    }

    /// Takes this row offset, 1/32 px, for that of the last whole pair.
    pub fn set_row_offset_q5(&mut self, row_offset_q5: i16) {
        self.row_offset_q5 = Some(row_offset_q5);
    }

    /// Looks for no bars.
    pub fn leave_out_bars(&mut self) {
        self.plan.has_bars = false;
    }
}
