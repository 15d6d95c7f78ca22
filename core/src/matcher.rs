//! Matching of consecutive pairs of one rig: health before and after, the run between.
//!
//! In: a plan, pairs. Out: a [`Matched`] each. State: the health monitor and the row offset of the last whole pair.
//!
//! ```text
//! check the images; a pair that is refused is not matched: it has no matches, and objects and pixels have no depth
//! match the whole frame, or parts of it with the row offset of the last whole pair; look for the
//! ground near that of the pair before, or, while there is none, in every fourth pair
//! check the matches
//! ```

use crate::area::Area;
use crate::focus::Focus;
use crate::ground::{GroundPlane, GroundSearch};
use crate::health::{HealthLimits, HealthMonitor};
use crate::image::{Dims, Gray};
use crate::matched::{Matched, Summary};
use crate::observe::{Observer, StageEvent};
use crate::params::{ParamError, Params};
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

/// Pairs from one search of the ground to the next, while none is found.
const SEARCH_PERIOD: u8 = 4;

/// A plan, the health monitor, the row offset of the last whole pair and the ground plane of the
/// last pair.
#[derive(Clone, Debug)]
pub struct Matcher {
    /// Limits of health, in the units of each field.
    pub limits: HealthLimits,
    plan: Plan,
    monitor: HealthMonitor,
    /// Row offset of the last pair that was matched as a whole, 1/32 px.
    row_offset_q5: Option<i16>,
    /// Ground plane of the last pair.
    ground: Option<GroundPlane>,
    /// Pairs until the ground is searched again, while none is known.
    unsearched: u8,
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
        Self { limits, plan, monitor: HealthMonitor::new(), row_offset_q5: None, ground: None, unsearched: 0 }
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

    /// True when the row offset of a whole pair is known.
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
        let row_offset_q5 = self.row_offset_q5.filter(|_| areas.is_some());
        let ground = match (self.ground, self.unsearched) {
            (Some(plane), _) => GroundSearch::Near(plane),
            (None, 0) => GroundSearch::Everywhere,
            (None, _) => GroundSearch::Off,
        };
        let focus = Focus { areas, row_offset_q5, ground };
        let mut matched = self.plan.run_stages([left, right], &focus, scratch, observer);
        if areas.is_none() {
            self.row_offset_q5 = Some(matched.summary.row_offset_q5);
        }
        self.ground = matched.summary.plane;
        self.unsearched = match ground {
            GroundSearch::Off => self.unsearched.saturating_sub(1),
            _ => SEARCH_PERIOD - 1,
        };
        self.monitor.check_matches(&self.limits, [left, right], &matched.findings(), &mut health);
        observer.on_event(StageEvent::Health(&health));
        matched.summary.health = health;
        Ok(matched)
    }

    /// Resets the state of health, and forgets the ground plane; the row offset stays.
    pub fn forget_health(&mut self) {
        self.monitor = HealthMonitor::new();
        (self.ground, self.unsearched) = (None, 0);
    }
}
