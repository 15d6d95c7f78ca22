//! Matching of consecutive pairs of one rig: health before and after, the run between.
//!
//! In: a plan, pairs. Out: a [`Matched`] each. State: the health monitor and the row offset of the last whole pair that measured it.
//!
//! ```text
//! check the images; a pair that is refused is not matched: it has no matches, and objects and pixels have no depth
//! match the whole frame, or parts of it or support points alone with the row offset of the last whole pair
//! check the matches
//! support points alone: they say nothing about rows, and little about whether most of the pair matches. The first pair, one in 64 after it, and one in
//!     8 while the row offset is not known or the last check found a fault, is matched with segments before, for its health and row offset
//! ```

use crate::area::Area;
use crate::focus::Focus;
use crate::health::{HealthLimits, HealthMonitor, PairHealth};
use crate::image::{Dims, Gray};
use crate::matched::{Matched, Summary};
use crate::observe::{Observer, StageEvent};
use crate::params::{ParamError, Params, Parts};
use crate::plan::Plan;
use crate::scratch::{RunError, ScratchView};

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

/// Pairs of support points alone from one check with segments to the next; and while the row offset is not known, or a fault was found.
const CHECK_EVERY: (u8, u8) = (64, 8);

/// A plan, the health monitor and the row offset of the last whole pair.
#[derive(Clone, Debug)]
pub struct Matcher {
    /// Limits of health, in the units of each field.
    pub limits: HealthLimits,
    plan: Plan,
    monitor: HealthMonitor,
    /// Row offset of the last fit pair that was matched as a whole and measured it, 1/32 px; 0 if none of them did.
    row_offset_q5: Option<i16>,
    /// Pairs of support points alone until the next one is checked with segments.
    until_check: u8,
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
        Self { limits, plan, monitor: HealthMonitor::new(), row_offset_q5: None, until_check: 0 }
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

    /// True when a whole pair that was fit has been matched.
    #[must_use]
    pub fn knows_rows(&self) -> bool {
        self.row_offset_q5.is_some()
    }

    /// Matches the next pair; with `areas` these parts of the left image alone, with the row offset of the last whole pair, or, before the first,
    /// one estimated in them.
    ///
    /// # Errors
    /// As [`Plan::run`]; such a pair does not change the state.
    pub fn run<'a>(
        &mut self,
        pair: Pair<'a>,
        areas: Option<&[Area]>,
        scratch: ScratchView<'a>,
        observer: &mut impl Observer,
    ) -> Result<Matched<'a>, RunError> {
        self.run_observed(pair, areas, scratch, observer)
    }

    #[inline(never)]
    fn run_observed<'a>(
        &mut self,
        pair: Pair<'a>,
        areas: Option<&[Area]>,
        scratch: ScratchView<'a>,
        observer: &mut dyn Observer,
    ) -> Result<Matched<'a>, RunError> {
        let Pair { left, right, times_us } = pair;
        let mut scratch = self.plan.checked([left, right], scratch)?;
        let mut health = self.monitor.check_images(&self.limits, left, right, times_us);
        observer.on_event(StageEvent::Health(&health));
        if health.is_refused() {
            scratch.clear();
            return Ok(Matched {
                plan: self.plan,
                images: [left, right],
                scratch,
                summary: Summary { health, ..Summary::default() },
            });
        }
        let are_points_alone = self.plan.params.parts == Parts::Support;
        if are_points_alone {
            scratch = self.check_with_segments([left, right], scratch, &mut health);
        }
        let is_whole = areas.is_none() && !are_points_alone;
        let focus = Focus { areas, row_offset_q5: self.row_offset_q5.filter(|_| !is_whole) };
        let mut matched = self.plan.run_stages([left, right], &focus, scratch, observer);
        self.monitor.check_matches(&self.limits, [left, right], &matched.findings(), &mut health);
        if is_whole {
            self.learn_rows(matched.summary.row_offset_q5, &health);
        }
        observer.on_event(StageEvent::Health(&health));
        matched.summary.health = health;
        Ok(matched)
    }

    /// Where a check is due, matches a pair with segments, for its health and its row offset.
    #[inline(never)] // most pairs do without
    fn check_with_segments<'a>(
        &mut self,
        images: [Gray<'a>; 2],
        scratch: ScratchView<'a>,
        health: &mut PairHealth,
    ) -> ScratchView<'a> {
        self.until_check = self.until_check.saturating_sub(1);
        if self.until_check > 0 {
            return scratch;
        }
        let mut plan = self.plan;
        plan.params.parts = Parts::Both;
        let matched = plan.run_stages(images, &Focus::WHOLE, scratch, &mut ());
        self.monitor.check_matches(&self.limits, images, &matched.findings(), health);
        self.learn_rows(matched.summary.row_offset_q5, health);
        let (seldom, often) = CHECK_EVERY;
        let is_well = self.row_offset_q5.is_some() && health.flags.is_fit();
        self.until_check = if is_well { seldom } else { often };
        matched.into_scratch()
    }

    /// Keeps the row offset of a whole pair that is fit, 1/32 px: measured, else as before, else the 0 at which it has matched.
    fn learn_rows(&mut self, measured_q5: Option<i16>, health: &PairHealth) {
        if health.flags.is_fit() {
            self.row_offset_q5 = measured_q5.or(self.row_offset_q5).or(Some(0));
        }
    }

    /// Resets the state of health; the row offset stays.
    pub fn forget_health(&mut self) {
        self.monitor = HealthMonitor::new();
        self.until_check = 0;
    }
}
