//! Chain -> straight runs: incremental least squares over sub-pixel positions.
//!
//! In: one position across the edge per step of rows (or columns), in 1/32 px. Out: runs
//! `first..=last` of steps with their line.
//!
//! ```text
//! seed: SEED positions whose line leaves no residual above TOLERANCE, else move on by one
//! grow: while the next position lies within TOLERANCE of the line, add it and fit again; three
//!       misses in a row end the run
//! ```
//!
//! # Bounds
//! A run has at most 64 positions, relative to its first: t <= 63, |u| <= 64 * 2 px * 32 = 4096.
//! `n * sum(t*u)` <= 64 * 2016 * 4096 = 5.3e8 and `sum(t) * sum(u)` the same: all sums and products
//! fit `i32`.
//!
//! # Cost
//! Some 50 instructions a position of a run, 150 where no seed is straight; a position is seen at
//! most four times, by a run, by the three misses before it.
//!
//! # Source
//! Least squares line; EDLines (Akinlar, Topal 2011) for growing it along a chain.

use crate::units::quotient;

/// Number of positions of a seed.
const SEED: i32 = 4;
/// Most positions of a run: keeps the sums in 32 bits.
const MAX_RUN: i32 = 64;
/// Largest distance of a position from the line, 1/32 px.
const TOLERANCE_Q5: i32 = 22;

/// A straight run of a chain: positions `first..=last` and the line through them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) first: i32,
    pub(crate) last: i32,
    /// Position at `first`, 1/32 px.
    pub(crate) start_q5: i32,
    /// Positions (px) per step, Q12.
    pub(crate) slope_q12: i32,
}

impl Run {
    /// Position of the line at `t`, 1/32 px.
    pub(crate) fn at_q5(&self, t: i32) -> i32 {
        self.start_q5 + (((t - self.first) * self.slope_q12 + 64) >> 7)
    }
}

/// Sums of a least squares fit; t and u relative to the run's first position.
#[derive(Clone, Copy, Default)]
struct Sums {
    n: i32,
    t: i32,
    tt: i32,
    u: i32,
    tu: i32,
}

impl Sums {
    fn add(&mut self, t: i32, u: i32) {
        self.n += 1;
        self.t += t;
        self.tt += t * t;
        self.u += u;
        self.tu += t * u;
    }

    /// The line as `(u at t = 0 in Q5, slope in Q12 px per step)`; `None` for less than two
    /// positions, or more than a run has.
    #[inline(always)]
    fn line(&self) -> Option<(i32, i32)> {
        let n = self.n;
        let denominator = n * self.tt - self.t * self.t; // < 64 * 85344 = 5.5e6
        let numerator = n * self.tu - self.t * self.u;
        if denominator <= 0 || !(1..=MAX_RUN).contains(&n) {
            return None;
        }
        // Q5 -> Q12 is a shift by 7; shift the remainder as well to keep the precision in 32 bits.
        let whole = quotient(numerator, denominator);
        let part = quotient((numerator - whole * denominator) << 7, denominator);
        let slope_q12 = (whole << 7) + part;
        let mean = self.u - ((self.t * slope_q12) >> 7);
        Some(((mean + n / 2).checked_div_euclid(n)?, slope_q12))
    }
}

/// Calls `emit` for every straight run of at least `min_extent` steps.
pub(crate) fn for_each_run(positions: &[u16], min_extent: i32, mut emit: impl FnMut(Run)) {
    let count = i32::try_from(positions.len()).unwrap_or(0);
    let mut first = 0;
    while first + (SEED - 1).max(min_extent) < count {
        let Some(run) = grow(positions, first) else {
            first += 1;
            continue;
        };
        if run.last - run.first >= min_extent {
            emit(run);
        }
        first = run.last + 1;
    }
}

/// The longest run that starts at `first`, or `None` when not even the seed is straight.
fn grow(positions: &[u16], first: i32) -> Option<Run> {
    let tail = positions.get(usize::try_from(first).ok()?..)?;
    let origin = i32::from(*tail.first()?);
    let mut sums = Sums::default();
    for (t, &u) in (0..SEED).zip(tail) {
        sums.add(t, i32::from(u) - origin);
    }
    let mut line = sums.line()?;
    let off = |line: (i32, i32), t: i32, u: u16| {
        (i32::from(u) - origin - line.0 - ((t * line.1 + 64) >> 7)).abs()
    };
    if (0..SEED).zip(tail).any(|(t, &u)| off(line, t, u) > TOLERANCE_Q5) {
        return None;
    }
    let mut last = SEED - 1;
    for (t, &u) in (SEED..MAX_RUN).zip(tail.get(SEED as usize..)?) {
        if off(line, t, u) <= TOLERANCE_Q5 {
            sums.add(t, i32::from(u) - origin);
            line = sums.line()?;
            last = t;
        } else if t - last > 2 {
            break;
        }
    }
    Some(Run { first, last: first + last, start_q5: origin + line.0, slope_q12: line.1 })
}
