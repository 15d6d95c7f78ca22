//! Does this machine compute what the PC computed? Built-in frames, one digest per stage and one of
//! what an autopilot gets, against those of [`digests`](linestereo_boards::built_in::digests).

use crate::autopilot::Autopilot;
use crate::memory::Memory;
use crate::ports::ByteSink;
use crate::vehicle::Vehicle;
use linestereo::obstacles::{ObstacleParams, ObstaclePlan};
use linestereo::unstable::{Fnv, Stage, StageDigests};
use linestereo::{Matched, Matcher, Options, Params, Rig};
use linestereo_boards::Board;
use linestereo_boards::built_in::digests::Digests;
use linestereo_boards::built_in::{Case, first_difference};

/// Result of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The case.
    pub case: Case,
    /// Its digests; `None` when it could not run.
    pub found: Option<Digests>,
    /// Digest of the PC; `None` without one.
    pub expected: Option<Digests>,
}

impl Outcome {
    /// The name of the first stage that differs, or
    /// [`AUTOPILOT`](linestereo_boards::built_in::AUTOPILOT).
    pub fn differs_in(&self) -> Option<&'static str> {
        match (&self.found, &self.expected) {
            (Some(found), Some(expected)) => first_difference(found, expected),
            _ => Some(Stage::LinesLeft.name()),
        }
    }
}

/// Runs every case of a board, and says whether all digests are the expected ones.
pub fn run(
    memory: &mut impl Memory,
    board: &Board,
    expected: &[Digests],
    mut report: impl FnMut(&Outcome),
) -> bool {
    let mut all_equal = true;
    for (number, case) in Case::all(board).enumerate() {
        let outcome = Outcome {
            case,
            found: digests(memory, &case),
            expected: expected.get(number).copied(),
        };
        all_equal &= outcome.differs_in().is_none();
        report(&outcome);
    }
    all_equal
}

/// The digests of one case on this machine.
pub fn digests(memory: &mut impl Memory, case: &Case) -> Option<Digests> {
    let [left, right] = memory.frames();
    case.scene.paint(case.dims, left, right);
    let mut digests = StageDigests::new();
    let mut matcher = Matcher::new(case.params(), case.dims).ok()?;
    let options = Options { observer: Some(&mut digests), ..Options::default() };
    let mut matched = memory.run(None, &mut matcher, options).ok()?;
    matched.points().for_each(|point| digests.add_point(&point));
    let mut all = [0; Stage::ALL.len() + 1];
    for (slot, stage) in all.iter_mut().zip(Stage::ALL) {
        *slot = digests.of(stage);
    }
    *all.last_mut()? = autopilot(&view(case)?, &matched);
    Some(all)
}

/// As if a camera of 300 px had seen the case.
pub fn view(case: &Case) -> Option<ObstaclePlan> {
    let params = Params { rig: Rig::new(300.0, 0.1, 0.0).ok(), ..case.params() };
    ObstacleParams::DEFAULT.plan(&params, case.dims).ok()
}

/// Digest of the bytes that an autopilot gets: of the pair, and after a pair that is missing.
fn autopilot(view: &ObstaclePlan, matched: &Matched<'_>) -> u32 {
    let mut autopilot = Autopilot::new(Vehicle::DEFAULT);
    autopilot.set_view(Some(*view));
    let mut digest = Digest(Fnv::EMPTY);
    autopilot.see(matched, 0);
    autopilot.turn(0, &mut digest);
    autopilot.miss();
    autopilot.turn(100_000, &mut digest);
    digest.0.value()
}

/// A digest as a port.
struct Digest(Fnv);

impl ByteSink for Digest {
    fn write(&mut self, bytes: &[u8]) {
        self.0.write(bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boards::{mps2_an386, mps2_an500};
    use linestereo_boards::built_in::{Scene, digests as expected};

    #[test]
    fn this_machine_computes_what_is_expected_of_the_boards() {
        let hint = "when the output was meant to change: cargo xtask bless";
        let report =
            |outcome: &Outcome| assert_eq!(outcome.differs_in(), None, "{}; {hint}", outcome.case);
        let mut large = Box::new(mps2_an500::BoardMemory::CLEARED);
        assert!(run(&mut *large, &mps2_an500::BOARD, &expected::QVGA, report));
        let mut small = Box::new(mps2_an386::BoardMemory::CLEARED);
        assert!(run(&mut *small, &mps2_an386::BOARD, &expected::QQVGA, report));
    }

    /// A stage that hashes nothing proves nothing: rows once did, and reports without a list of
    /// points.
    #[test]
    fn every_stage_of_a_pair_with_matches_is_hashed() {
        let nothing = StageDigests::new();
        for digests in [&expected::QVGA[0], &expected::QQVGA[0]] {
            for (stage, digest) in Stage::ALL.into_iter().zip(digests) {
                assert_ne!(*digest, nothing.of(stage), "{}", stage.name());
            }
        }
        let mut memory = Box::new(mps2_an386::BoardMemory::CLEARED);
        let case = Case::all(&mps2_an386::BOARD).next().unwrap();
        let mut of = |flipped: Option<usize>| {
            let [left, right] = memory.frames();
            case.scene.paint(case.dims, left, right);
            if let Some(pixel) = flipped {
                right[pixel] ^= 0xff;
            }
            let mut digests = StageDigests::new();
            let mut matcher = Matcher::new(case.params(), case.dims).unwrap();
            let options = Options { observer: Some(&mut digests), ..Options::default() };
            memory.run(None, &mut matcher, options).unwrap();
            digests.of(Stage::Rows)
        };
        // A pixel of a row that segments look at.
        let middle = usize::from(case.dims.width) * usize::from(case.dims.height / 2)
            + usize::from(case.dims.width / 2);
        assert_ne!(of(None), of(Some(middle)));
    }

    #[test]
    fn a_wrong_digest_names_its_stage() {
        let mut memory = Box::new(mps2_an386::BoardMemory::CLEARED);
        let mut expected = expected::QQVGA;
        expected[3][Stage::Matching as usize] ^= 1;
        let mut wrong = Vec::new();
        let report = |outcome: &Outcome| {
            wrong.extend(outcome.differs_in().map(|stage| (outcome.case.scene, stage)))
        };
        assert!(!run(&mut *memory, &mps2_an386::BOARD, &expected, report));
        assert_eq!(wrong, [(Scene::ALL[3], Stage::Matching.name())]);
    }
}
