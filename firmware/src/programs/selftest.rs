//! Does this machine compute what the PC computed? Built-in frames, one digest per stage, against those of [`super::expected`].

use super::expected::Digests;
use crate::boards::Board;
use crate::cases::Case;
use crate::memory::Memory;
use crate::watch::Watch;
use linestereo::{Stage, StageDigests};

/// What a case gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The case.
    pub case: Case,
    /// Its digests; `None` when it could not run.
    pub found: Option<Digests>,
    /// What the PC says; `None` when it says nothing.
    pub expected: Option<Digests>,
}

impl Outcome {
    /// The first stage that differs.
    #[must_use]
    pub fn differs_in(&self) -> Option<Stage> {
        let (Some(found), Some(expected)) = (self.found, self.expected) else { return Some(Stage::LinesLeft) };
        let mut pairs = Stage::ALL.into_iter().zip(found.iter().zip(&expected));
        pairs.find(|(_, (found, expected))| found != expected).map(|(stage, _)| stage)
    }
}

/// Runs every case of a board, and says whether all digests are the expected ones.
pub fn run(memory: &mut impl Memory, board: &Board, expected: &[Digests], mut tell: impl FnMut(&Outcome)) -> bool {
    let mut all_equal = true;
    for (number, case) in Case::all(board).enumerate() {
        let outcome = Outcome { case, found: digests(memory, &case), expected: expected.get(number).copied() };
        all_equal &= outcome.differs_in().is_none();
        tell(&outcome);
    }
    all_equal
}

/// The digests of one case on this machine.
pub fn digests(memory: &mut impl Memory, case: &Case) -> Option<Digests> {
    let [left, right] = memory.frames();
    case.scene.paint(case.dims, left, right);
    let mut digests = StageDigests::new();
    let plan = case.params().plan(case.dims).ok()?;
    Watch::new().run(memory, &plan, None, &mut digests).ok()?;
    Some(Stage::ALL.map(|stage| digests.of(stage)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boards::{mps2_an386, mps2_an500};
    use crate::programs::expected;

    #[test]
    fn this_machine_computes_what_is_expected_of_the_boards() {
        let hint = "when the output was meant to change: cargo xtask bless";
        let tell = |outcome: &Outcome| assert_eq!(outcome.differs_in(), None, "{}; {hint}", outcome.case);
        let mut large = Box::new(mps2_an500::Workspace::new());
        assert!(run(&mut *large, &mps2_an500::BOARD, &expected::MPS2_AN500, tell));
        let mut small = Box::new(mps2_an386::Workspace::new());
        assert!(run(&mut *small, &mps2_an386::BOARD, &expected::MPS2_AN386, tell));
    }

    #[test]
    fn a_wrong_digest_names_its_stage() {
        let mut memory = Box::new(mps2_an386::Workspace::new());
        let mut expected = expected::MPS2_AN386;
        expected[3][4] ^= 1;
        let mut wrong = Vec::new();
        let tell = |outcome: &Outcome| wrong.extend(outcome.differs_in().map(|stage| (outcome.case.scene, stage)));
        assert!(!run(&mut *memory, &mps2_an386::BOARD, &expected, tell));
        assert_eq!(wrong, [(crate::painter::Scene::ALL[3], Stage::Matching)]);
    }
}
