//! What a program needs from its surroundings. Implemented by the boards, by the PC, and by fakes in tests.

use linestereo::{Counts, Dims, Match, Params, PointClaim};

/// A clock that counts up and wraps.
pub trait Clock {
    /// What [`Clock::elapsed`] counts.
    const UNIT: &'static str;

    /// The count now.
    fn now(&self) -> u32;

    /// What passed between two counts, in [`Clock::UNIT`].
    fn elapsed(&self, from: u32, to: u32) -> u64;
}

/// A pair that lies in the frame memory, and how to match it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Size of both images; they lie at the start of their memories, without padding.
    pub dims: Dims,
    /// Parameters of the method.
    pub params: Params,
    /// When it was taken, microseconds of the source's clock.
    pub capture_time_us: u64,
}

/// What a pair gave.
#[derive(Clone, Copy, Debug)]
pub struct Results<'a> {
    /// Matched segments, most confident first.
    pub matches: &'a [Match],
    /// Points, in the order of their matches.
    pub points: &'a [PointClaim],
    /// What was found and lost.
    pub counts: &'a Counts,
}

/// Where pairs come from.
pub trait PairSource {
    /// Why a pair cannot be used; the next one may be good.
    type Error;

    /// Puts the next pair into the memories of the left and the right frame. `None` when there will be no other.
    fn next_pair(&mut self, frames: [&mut [u8]; 2]) -> Option<Result<Pair, Self::Error>>;
}

/// Where results go.
pub trait ResultSink<Problem> {
    /// A pair was matched.
    fn result(&mut self, pair: &Pair, results: Results<'_>);

    /// A pair could not be used.
    fn problem(&mut self, problem: Problem);
}
