//! Cost of a pair, by stage.

use crate::autopilot::Autopilot;
use crate::memory::{Memory, PairError};
use crate::ports::{ByteSink, Clock};
use crate::vehicle::Vehicle;
use linestereo::results::Counts;
use linestereo::unstable::{Observer, Stage, StageEvent};
use linestereo::{Matched, Matcher, Options, obstacles::ObstaclePlan};

/// Cost of the stages of one pair, in the unit of the clock.
pub type Costs = [u64; Stage::ALL.len()];

/// Runs the pair that lies in the frames and gives the cost of each stage.
pub fn measure<'m>(
    memory: &'m mut impl Memory,
    clock: &impl Clock,
    matcher: &mut Matcher,
    options: Options<'_>,
) -> Result<(Costs, Matched<'m>), PairError> {
    let mut observer = StageClock { clock, last: clock.now(), costs: [0; Stage::ALL.len()] };
    let options = Options { observer: Some(&mut observer), ..options };
    let matched = memory.run(None, matcher, options)?;
    Ok((observer.costs, matched))
}

/// Adds what passes between the ends of steps to their stages; what it costs itself (a few
/// instructions per step) is left out.
struct StageClock<'a, C> {
    clock: &'a C,
    last: u32,
    costs: Costs,
}

impl<C: Clock> Observer for StageClock<'_, C> {
    fn on_event(&mut self, step: StageEvent<'_>) {
        let now = self.clock.now();
        if let Some(cost) = self.costs.get_mut(step.stage() as usize) {
            *cost += self.clock.elapsed(self.last, now);
        }
        self.last = self.clock.now();
    }
}

/// Instructions of the obstacles of the last pair and of sending them to an autopilot; and the
/// bytes sent.
pub fn measure_autopilot(
    matched: &Matched<'_>,
    clock: &impl Clock,
    view: &ObstaclePlan,
) -> [u64; 3] {
    let mut autopilot = Autopilot::new(Vehicle::DEFAULT);
    autopilot.set_view(Some(*view));
    let mut count = Count(0);
    let start = clock.now();
    autopilot.see(matched, 0);
    let seen = clock.now();
    autopilot.turn(0, &mut count);
    let sent = clock.now();
    [clock.elapsed(start, seen), clock.elapsed(seen, sent), count.0]
}

/// Counts what is written.
struct Count(u64);

impl ByteSink for Count {
    fn write(&mut self, bytes: &[u8]) {
        self.0 += bytes.len() as u64;
    }
}

/// One line of the table that the PC reads: what, a name, numbers; separated by tabs.
pub fn line(
    out: &mut impl core::fmt::Write,
    name: impl core::fmt::Display,
    costs: &Costs,
    counts: &Counts,
) {
    let _ = write!(out, "pair\t{name}\t{}", counts.segments_left);
    for cost in costs {
        let _ = write!(out, "\t{cost}");
    }
    let _ = writeln!(out);
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::boards::mps2_an386::{BOARD, BoardMemory};
    use core::cell::Cell;
    use linestereo::{Dims, Params};
    use linestereo_boards::built_in::Scene;

    /// Counts how often it was asked.
    #[derive(Default)]
    pub(in crate::programs) struct Asked(Cell<u32>);

    impl Clock for Asked {
        const UNIT: &'static str = "questions";

        fn now(&self) -> u32 {
            self.0.set(self.0.get().wrapping_add(1));
            self.0.get()
        }
    }

    #[test]
    fn a_stage_costs_what_passes_before_its_steps_end() {
        let mut memory = Box::new(BoardMemory::CLEARED);
        let [left, right] = memory.frames();
        Scene::Blocks.paint(BOARD.largest, left, right);
        let clock = Asked(Cell::new(u32::MAX - 5)); // wraps on the way
        let mut matcher = Matcher::new(Params::DEFAULT, BOARD.largest).unwrap();
        let (costs, _) = measure(&mut *memory, &clock, &mut matcher, Options::default()).unwrap();
        assert_eq!(costs[Stage::LinesLeft as usize], 1); // one question between two ends
        assert_eq!(costs[Stage::Health as usize], 2); // before and after matching
        assert_eq!(costs[Stage::Rows as usize], costs[Stage::Matching as usize]);
        assert!(costs[Stage::Matching as usize] > 20);
    }

    #[test]
    fn a_pair_that_does_not_fit_is_refused() {
        let mut memory = Box::new(BoardMemory::CLEARED);
        let dims = Dims { width: 320, height: 240 };
        let clock = Asked(Cell::new(0));
        let mut matcher = Matcher::new(Params::DEFAULT, dims).unwrap();
        let refused = measure(&mut *memory, &clock, &mut matcher, Options::default());
        assert_eq!(refused.map(|_| ()), Err(PairError::Size(dims)));
    }
}
