//! The monitor of a board's pairs, around each run.

use crate::memory::{Memory, RunError};
use linestereo::{Area, Focus, HealthLimits, HealthMonitor, Observer, PairHealth, Plan, Step};

/// Limits and what pairs so far have left behind.
#[derive(Clone, Debug)]
pub struct Watch {
    /// What a pair may be like.
    pub limits: HealthLimits,
    monitor: HealthMonitor,
    /// Of the last pair that was matched as a whole.
    row_offset_q5: Option<i16>,
}

impl Watch {
    /// With the default limits, nothing seen yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { limits: HealthLimits::DEFAULT, monitor: HealthMonitor::new(), row_offset_q5: None }
    }

    /// Looks at the pair that lies in the frames and was captured at these times (left, right, microseconds), matches it, and looks at its
    /// matches. A pair that is refused ([`PairHealth::is_refused`]) is not matched: the results are those of the pair before.
    ///
    /// With `areas`, only these are matched, once a whole pair has said how far the rows are apart.
    pub fn run(
        &mut self,
        memory: &mut impl Memory,
        plan: &Plan,
        areas: Option<&[Area]>,
        times_us: Option<[u64; 2]>,
        observer: &mut impl Observer,
    ) -> Result<PairHealth, RunError> {
        let [left, right] = memory.views(plan.dims())?;
        let mut health = self.monitor.look(&self.limits, left, right, times_us);
        observer.ended(Step::Health(&health));
        if health.is_refused() {
            return Ok(health);
        }
        let areas = areas.filter(|_| self.row_offset_q5.is_some());
        let focus = areas.map_or(Focus::WHOLE, |areas| Focus { areas: Some(areas), row_offset_q5: self.row_offset_q5 });
        memory.run(plan, &focus, observer)?;
        self.row_offset_q5 = Some(memory.results().row_offset_q5);
        let ([left, right], results) = (memory.views(plan.dims())?, memory.results());
        let found = (results.matches, results.counts);
        self.monitor.look_at_matches(&self.limits, (left, right), found, &mut health);
        observer.ended(Step::Health(&health));
        Ok(health)
    }
}

impl Default for Watch {
    fn default() -> Self {
        Self::new()
    }
}
