//! A pair on one core, and on two: instructions of the busier one, without a second core.
//!
//! ```text
//! each pair   matched on one core; then both halves of each step one after the other: of all
//!             instructions those of the smaller halves are saved
//! ```

use crate::memory::{Memory, PairError};
use crate::ports::Clock;
use linestereo::{Cores, Matcher, Options};

/// Costs of a pair, in the unit of the clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoreCosts {
    /// On one core.
    pub one: u64,
    /// Of the busier one of two.
    pub busier: u64,
    /// How often these meet.
    pub joins: u32,
}

/// One core that measures what a second one would save.
struct Halves<'c, C> {
    clock: &'c C,
    saved: u64,
    joins: u32,
}

impl<C: Clock> Cores for Halves<'_, C> {
    fn join(&mut self, here: &mut (dyn FnMut() + Send), there: &mut (dyn FnMut() + Send)) {
        let from = self.clock.now();
        here();
        let middle = self.clock.now();
        there();
        let end = self.clock.now();
        let halves = [(from, middle), (middle, end)].map(|(a, b)| self.clock.elapsed(a, b));
        self.saved += halves[0].min(halves[1]);
        self.joins += 1;
    }
}

/// Costs of the pair that lies in the frames, as the next one of this matcher, whose state stays.
/// The memory is one for two cores.
pub fn compare(
    memory: &mut impl Memory,
    clock: &impl Clock,
    matcher: &Matcher,
) -> Result<CoreCosts, PairError> {
    let from = clock.now();
    memory.run(None, &mut matcher.clone(), Options::default())?;
    let one = clock.elapsed(from, clock.now());
    let mut halves = Halves { clock, saved: 0, joins: 0 };
    let from = clock.now();
    memory.run(Some(&mut halves), &mut matcher.clone(), Options::default())?;
    let both = clock.elapsed(from, clock.now());
    let Halves { saved, joins, .. } = halves;
    Ok(CoreCosts { one, busier: both.saturating_sub(saved), joins })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boards::mps2_an386::{BOARD, BoardMemory};
    use crate::programs::bench::tests::Asked;
    use linestereo::Params;
    use linestereo_boards::built_in::Scene;

    #[test]
    fn the_smaller_half_of_each_step_is_saved() {
        let (mut memory, clock) = (Box::new(BoardMemory::CLEARED), Asked::default());
        let [left, right] = memory.frames();
        Scene::Blocks.paint(BOARD.largest, left, right);
        let matcher = Matcher::new(Params::DEFAULT, BOARD.largest).unwrap();
        // Of each step three looks at the clock, and one of two halves that cost one each.
        let CoreCosts { one, busier, joins } = compare(&mut *memory, &clock, &matcher).unwrap();
        assert!(one == 1 && joins > 30, "{joins}");
        assert_eq!(busier, 1 + 2 * u64::from(joins));
    }
}
