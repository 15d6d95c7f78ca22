//! A pair on one core, and on two: instructions of the busier one, without a second core.
//!
//! ```text
//! each pair   matched on one core; then both halves of each step one after the other: of all
//!             instructions those of the smaller halves are saved; then as always
//! ```

use crate::memory::{Memory, NoRoom, PairError};
use crate::ports::{ByteSink, Clock};
use linestereo::{Cores, Dims, Gray, Matched, Matcher, Options};
use linestereo_rig::{CameraSide, Remap, RowError};

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

/// Takes results that nobody asks for.
#[derive(Debug)]
pub struct Nowhere;

impl ByteSink for Nowhere {
    fn write(&mut self, _: &[u8]) {}
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

/// A memory that matches each pair on one core and on two before it is matched.
#[derive(Debug)]
pub struct Compared<'m, M, C, R> {
    /// Frames, and the core's memory for two cores.
    pub memory: &'m mut M,
    /// Its clock.
    pub clock: &'m C,
    /// Takes the costs of each pair.
    pub report: R,
}

impl<M: Memory, C: Clock, R: FnMut(CoreCosts)> Memory for Compared<'_, M, C, R> {
    fn run(
        &mut self,
        matcher: &mut Matcher,
        options: Options<'_>,
    ) -> Result<Matched<'_>, PairError> {
        let (areas, times_us) = (options.areas, options.times_us);
        let unobserved = || Options { areas, times_us, ..Options::default() };
        let from = self.clock.now();
        self.memory.run(&mut matcher.clone(), unobserved())?;
        let one = self.clock.elapsed(from, self.clock.now());
        let mut halves = Halves { clock: self.clock, saved: 0, joins: 0 };
        let from = self.clock.now();
        self.memory.run_on(&mut halves, &mut matcher.clone(), unobserved())?;
        let both = self.clock.elapsed(from, self.clock.now());
        let Halves { saved, joins, .. } = halves;
        (self.report)(CoreCosts { one, busier: both.saturating_sub(saved), joins });
        self.memory.run(matcher, options)
    }

    fn run_on(
        &mut self,
        cores: &mut dyn Cores,
        matcher: &mut Matcher,
        options: Options<'_>,
    ) -> Result<Matched<'_>, PairError> {
        self.memory.run_on(cores, matcher, options)
    }

    fn fits(&self, dims: Dims) -> bool {
        self.memory.fits(dims)
    }

    fn frames(&mut self) -> [&mut [u8]; 2] {
        self.memory.frames()
    }

    fn views(&self, dims: Dims) -> Result<[Gray<'_>; 2], PairError> {
        self.memory.views(dims)
    }

    fn set_rig(&mut self, remap: &Remap) -> Result<(), NoRoom> {
        self.memory.set_rig(remap)
    }

    fn restart(&mut self) {
        self.memory.restart();
    }

    fn restart_camera(&mut self, eye: CameraSide) {
        self.memory.restart_camera(eye);
    }

    fn raw_row(&mut self) -> &mut [u8] {
        self.memory.raw_row()
    }

    fn push_row(&mut self, eye: CameraSide) -> Result<(), RowError> {
        self.memory.push_row(eye)
    }

    fn is_rectified(&self) -> bool {
        self.memory.is_rectified()
    }
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
        let mut costs = None;
        let report = |found| costs = Some(found);
        let mut compared = Compared { memory: &mut *memory, clock: &clock, report };
        let [left, right] = compared.frames();
        Scene::Blocks.paint(BOARD.largest, left, right);
        let mut matcher = Matcher::new(Params::DEFAULT, BOARD.largest).unwrap();
        let matched = compared.run(&mut matcher, Options::default()).unwrap();
        assert!(matched.segments().len() > 10);
        // Of each step three looks at the clock, and one of two halves that cost one each.
        let CoreCosts { one, busier, joins } = costs.unwrap();
        assert!(one == 1 && joins > 30, "{joins}");
        assert_eq!(busier, 1 + 2 * u64::from(joins));
    }
}
