//! Matching of consecutive pairs of one rig: health before and after, the run between.
//!
//! In: a plan, pairs. Out: a [`Matched`] each. State: the health monitor, the row offset of the
//! last whole pair that was fit, and the ground plane of the last pair.
//!
//! ```text
//! check the images; a pair that is refused is not matched: it has no matches, and objects and
//!     pixels have no depth
//! match the whole frame, or parts of it with the row offset of the last whole pair; look for the
//! ground near that of the pair before, or, while there is none, in every fourth pair
//! check the matches
//! support points alone: match the first pair, one in 64 after it, and one in 8 while the row
//!     offset is not known or the pair is not fit, with segments as well, which are not answered:
//!     for the row offset, and to see whether most of the pair matches
//! ```

use crate::area::Area;
use crate::focus::Focus;
use crate::ground::{GroundPlane, GroundSearch};
use crate::health::{Findings, HealthLimits, HealthMonitor, PairHealth};
use crate::image::{Dims, Gray};
use crate::matched::{Matched, Summary};
use crate::memory::{MemorySlice, RunError};
use crate::observe::{Observer, StageEvent};
use crate::params::{ParamError, Params, Parts};
use crate::plan::Plan;

/// A rectified pair.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    /// The left image, the reference of all results.
    pub left: Gray<'a>,
    /// The right image.
    pub right: Gray<'a>,
    /// Times of capture, left and right, us of one clock, if known.
    pub times_us: Option<[u64; 2]>,
}

/// Pairs from one search of the ground to the next, while none is found.
const SEARCH_PERIOD: u8 = 4;
/// Pairs of support points alone from one that is matched with segments to the next.
const CHECK_PERIOD: u8 = 64;
/// The same while the row offset is not known, or the pair was not fit.
const SHORT_CHECK_PERIOD: u8 = 8;

/// A plan, the health monitor, the row offset of the last whole pair and the ground plane of the
/// last pair.
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
}

impl Params {
    /// [`Params::plan`], with default limits of health for its rig.
    pub fn matcher(self, dims: Dims) -> Result<Matcher, ParamError> {
        self.plan(dims).map(Matcher::new)
    }
}

impl Matcher {
    /// A matcher before the first pair.
    #[must_use]
    pub const fn new(plan: Plan) -> Self {
        let limits = HealthLimits::DEFAULT.of_rig(plan.rig().as_ref());
        Self {
            limits,
            plan,
            monitor: HealthMonitor::new(),
            row_offset_q5: None,
            ground: None,
            unsearched: 0,
            expected: None,
            unchecked: 0,
        }
    }

    /// Plan of the matching.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Changes the plan for further pairs of the same cameras; the state of health stays.
    pub fn set_plan(&mut self, plan: Plan) {
        self.plan = plan;
    }

    /// Says where the ground is in pairs from now on, by the camera's pose
    /// ([`GroundPlane::of_pose`]): measured by an IMU before each pair, or once, as it is mounted.
    /// It is looked for there alone, and taken as said where it is not seen. `None`, as at first,
    /// looks for it in the images.
    pub fn expect_ground(&mut self, plane: Option<GroundPlane>) {
        self.expected = plane;
    }

    /// True when a whole pair that was fit has been matched.
    #[must_use]
    pub fn knows_rows(&self) -> bool {
        self.row_offset_q5.is_some()
    }

    /// Matches the next pair.
    ///
    /// # Errors
    /// As [`Plan::run`]; such a pair does not change the state.
    pub fn run<'a>(
        &mut self,
        pair: Pair<'a>,
        memory: &'a mut MemorySlice,
    ) -> Result<Matched<'a>, RunError> {
        self.run_observed(pair, memory, None, &mut ())
    }

    /// [`Matcher::run`]; with `areas` in these parts of the left image alone, with the row offset
    /// of the last whole pair, or, before the first, one estimated in them. Calls `observer` at
    /// every step.
    pub fn run_with<'a>(
        &mut self,
        pair: Pair<'a>,
        memory: &'a mut MemorySlice,
        areas: Option<&[Area]>,
        observer: &mut impl Observer,
    ) -> Result<Matched<'a>, RunError> {
        self.run_observed(pair, memory, areas, observer)
    }

    #[inline(never)]
    fn run_observed<'a>(
        &mut self,
        pair: Pair<'a>,
        memory: &'a mut MemorySlice,
        areas: Option<&[Area]>,
        observer: &mut dyn Observer,
    ) -> Result<Matched<'a>, RunError> {
        let Pair { left, right, times_us } = pair;
        let mut buffers = self.plan.buffers([left, right], memory)?;
        let mut health = self.monitor.check_images(&self.limits, left, right, times_us);
        observer.on_event(StageEvent::Health(&health));
        if health.is_refused() {
            buffers.clear();
            return Ok(Matched {
                plan: self.plan,
                images: [left, right],
                buffers,
                summary: Summary { health, ..Summary::default() },
            });
        }
        // Support points alone say too little about rows, and about whether most of the pair
        // matches.
        let are_points_alone = self.plan.params.parts == Parts::Support;
        let has_segments = !are_points_alone || self.unchecked == 0;
        let parts = if has_segments { Parts::Both } else { Parts::Support };
        let row_offset_q5 = self.row_offset_q5.filter(|_| areas.is_some() || !has_segments);
        let ground = match (self.expected, self.ground, self.unsearched) {
            (Some(plane), ..) => GroundSearch::Given(plane),
            (None, Some(plane), _) => GroundSearch::Near(plane),
            (None, None, 0) => GroundSearch::Everywhere,
            (None, None, _) => GroundSearch::Off,
        };
        let focus = Focus { areas, row_offset_q5, ground };
        let mut matched = self.plan.run_stages([left, right], (&focus, parts), buffers, observer);
        self.ground = matched.summary.plane;
        self.unsearched = match ground {
            GroundSearch::Off => self.unsearched.saturating_sub(1),
            _ => SEARCH_PERIOD - 1,
        };
        let findings = Findings { has_segments, ..matched.findings() };
        self.monitor.check_matches(&self.limits, [left, right], &findings, &mut health);
        if has_segments && (areas.is_none() || are_points_alone) {
            self.learn_rows(matched.summary.row_offset_q5, &health);
        }
        if are_points_alone {
            self.schedule_check(has_segments, &health);
            matched.drop_segments();
        }
        observer.on_event(StageEvent::Health(&health));
        matched.summary.health = health;
        Ok(matched)
    }

    /// Keeps the row offset of a pair that is fit, 1/32 px: as measured, else as before, else the 0
    /// at which it has matched.
    fn learn_rows(&mut self, measured_q5: Option<i16>, health: &PairHealth) {
        if health.flags.is_fit() {
            self.row_offset_q5 = measured_q5.or(self.row_offset_q5).or(Some(0));
        }
    }

    /// Counts the pairs of support points alone until the next one with segments.
    fn schedule_check(&mut self, has_segments: bool, health: &PairHealth) {
        let is_well = self.row_offset_q5.is_some() && health.flags.is_fit();
        let period = if is_well { CHECK_PERIOD } else { SHORT_CHECK_PERIOD };
        let left = if has_segments { period } else { self.unchecked };
        self.unchecked = left.saturating_sub(1);
    }

    /// Resets the state of health, and forgets the ground plane; the row offset stays.
    pub fn forget_health(&mut self) {
        self.monitor = HealthMonitor::new();
        (self.ground, self.unsearched, self.unchecked) = (None, 0, 0);
    }
}
