//! Cost of the depth of a pixel, and its bytes.
//!
//! In: a built-in pair that was matched. Out: for pixels on a grid, how many are answered, a digest
//! of all answers and reasons, the mean and the largest cost of one.

use crate::memory::{Memory, PairError};
use crate::ports::Clock;
use core::fmt;
use linestereo::results::{PixelDepth, PixelRejection};
use linestereo::{Matcher, Options, unstable::Fnv};
use linestereo_boards::built_in::Case;

/// Columns and rows of the grid.
const GRID: [u16; 2] = [13, 9];

/// Result of a case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Measured {
    /// Pixels queried.
    pub queried: u32,
    /// Those with a depth.
    pub answered: u32,
    /// Of all answers (FNV-1a).
    pub digest: u32,
    /// Mean cost of one, in the unit of the clock.
    pub mean: u64,
    /// Largest cost of one, in the unit of the clock.
    pub worst_case: u64,
}

/// Matches a case and queries the pixels of the grid.
pub fn measure(
    memory: &mut impl Memory,
    clock: &impl Clock,
    case: &Case,
) -> Result<Measured, PairError> {
    let [left, right] = memory.frames();
    case.scene.paint(case.dims, left, right);
    let matcher = Matcher::new(case.params(), case.dims);
    let mut matcher = matcher.map_err(|_| PairError::Size(case.dims))?;
    let mut matched = memory.run(None, &mut matcher, Options::default())?;
    let (mut measured, mut digest) = (Measured::default(), Fnv::EMPTY);
    let [columns, rows] = GRID;
    let mut costs = 0;
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        // From the first to the last column and row.
        let coordinate = |i: u16, of: u16, side: u16| {
            (u32::from(side - 1) * u32::from(i) / u32::from(of - 1)) as u16
        };
        let pixel =
            (coordinate(column, columns, case.dims.width), coordinate(row, rows, case.dims.height));
        let start = clock.now();
        let answer = matched.pixel(pixel);
        let cost = clock.elapsed(start, clock.now());
        costs += cost;
        measured.worst_case = measured.worst_case.max(cost);
        measured.queried += 1;
        measured.answered += u32::from(answer.is_ok());
        for part in parts(answer) {
            digest.write(&part.to_le_bytes());
        }
    }
    measured.digest = digest.value();
    measured.mean = costs / u64::from(measured.queried);
    Ok(measured)
}

/// An answer without a rig.
fn parts(answer: Result<PixelDepth, PixelRejection>) -> [u16; 3] {
    match answer {
        Ok(found) => [
            found.disparity.to_bits() as u16,
            found.sigma.to_bits() as u16,
            found.confidence.to_bits(),
        ],
        Err(reason) => [reason as u16, u16::MAX, 0],
    }
}

/// One line of the table that the PC reads: what, a name, numbers, the digest; separated by tabs.
pub fn line(out: &mut impl fmt::Write, case: &Case, measured: &Measured) {
    let Measured { queried, answered, digest, mean, worst_case } = measured;
    let _ =
        writeln!(out, "pixels\t{case}\t{queried}\t{answered}\t{mean}\t{worst_case}\t{digest:08x}");
}
