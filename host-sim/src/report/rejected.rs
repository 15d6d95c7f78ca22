//! Segments without a match, with the reason of each: what an observer of a run sees, and what the candidates say afterwards.

use linestereo::diagnostics::{Candidate, Observer, Segment, StageEvent};
use linestereo::{ImagePosition, Rejection};
use std::collections::HashSet;

/// A left segment that is not in the list of matches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rejected {
    pub ends: [ImagePosition; 2],
    /// Why.
    pub reason: Rejection,
}

/// Watches a run.
#[derive(Clone, Debug, Default)]
pub struct RejectionLog {
    found: Vec<Segment>,
    prominent: Vec<Segment>,
    outcomes: Vec<Result<(), Rejection>>,
}

impl Observer for RejectionLog {
    fn on_event(&mut self, step: StageEvent<'_>) {
        match step {
            StageEvent::LinesLeft(segments) => *self = Self { found: segments.to_vec(), ..Self::default() },
            StageEvent::Selection(_, segments) => self.prominent = segments.to_vec(),
            StageEvent::Segment(outcome) => self.outcomes.push(outcome.map(|_| ())),
            _ => {}
        }
    }
}

impl RejectionLog {
    /// Everything that was rejected: as many of each reason as the run counted.
    pub fn rejected(&self, candidates: &[Candidate]) -> Vec<Rejected> {
        let prominent: HashSet<&Segment> = self.prominent.iter().collect();
        let less = self.found.iter().filter(|segment| !prominent.contains(segment));
        let less = less.map(|segment| Rejected { ends: segment.ends, reason: Rejection::LessProminent });
        let tested = self.prominent.iter().zip(&self.outcomes);
        let tested =
            tested.filter_map(|(segment, outcome)| Some(Rejected { ends: segment.ends, reason: outcome.err()? }));
        // A pair that was refused leaves the candidates of the one before.
        let matched = self.outcomes.iter().filter(|outcome| outcome.is_ok()).count();
        let candidates = if matched == candidates.len() { candidates } else { &[] };
        let weighed = candidates
            .iter()
            .filter_map(|candidate| Some(Rejected { ends: candidate.segment.ends, reason: candidate.rejection()? }));
        less.chain(tested).chain(weighed).collect()
    }
}
