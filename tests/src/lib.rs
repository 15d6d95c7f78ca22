//! Test support: naive oracles, drawn images, captured frames, boards.

pub mod board;
pub mod browser;
pub mod captured;
pub mod drawn;
pub mod fuzz;
pub mod reference;

use linestereo::results::{Match, Point};
use linestereo::{Gray, Matched, Matcher, MemorySlice, Options, Params, RunError};
use linestereo_frames::GrayImage;
use linestereo_sim::engine::{Engine, FrameResult};

/// The core after a pair that stands alone, and what it has found there.
///
/// # Panics
/// If the parameters or the images are refused.
pub fn matched(params: &Params, pair: [&GrayImage; 2]) -> (Engine, FrameResult) {
    let mut engine = Engine::new(params, pair[0].dims).unwrap();
    let result = run(&mut engine, pair);
    (engine, result)
}

/// The core's result for a pair that stands alone.
///
/// # Panics
/// If the images are refused.
pub fn run(engine: &mut Engine, [left, right]: [&GrayImage; 2]) -> FrameResult {
    engine.run(left.view().unwrap(), right.view().unwrap()).unwrap()
}

/// Segments and points of a pair.
pub fn answers(matched: &mut Matched<'_>) -> (Vec<Match>, Vec<Point>) {
    let points = matched.points().collect();
    (matched.segments().to_vec(), points)
}

/// Matches a pair that stands alone, and answers whatever its health is.
///
/// # Errors
/// As [`Matcher::run`].
///
/// # Panics
/// Where the parameters are refused.
pub fn run_alone<'a>(
    params: &Params,
    memory: &'a mut MemorySlice,
    [left, right]: [Gray<'a>; 2],
    options: Options<'_>,
) -> Result<Matched<'a>, RunError> {
    let mut matcher = Matcher::new(*params, left.dims()).unwrap();
    let mut matched = matcher.run_with(memory, left, right, options)?;
    matched.ignore_health();
    Ok(matched)
}
