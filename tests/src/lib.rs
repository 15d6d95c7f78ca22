//! Test support: naive oracles, drawn images, captured frames, boards.

pub mod board;
pub mod captured;
pub mod drawn;
pub mod fuzz;
pub mod reference;

use linestereo::{Gray, Matched, Matcher, MemorySlice, Options, Params, RunError};
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
