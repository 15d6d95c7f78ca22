//! Windows that match beyond the disparity range: what is nearer than the range finds a wrong match
//! in it.
//!
//! In: the costs of support points in the range, the codes of their rows. Out: a [`RangeCheck`].
//!
//! ```text
//! every fourth row of points, two adjacent points of every four, their costs summed:
//!     lowest cost in the range small: the window has its match there
//!     lowest cost at as many disparities beyond it, at most 64, below 11/16 of that: its match
//!         lies beyond
//! ```
//! Of the windows of 14 captured scenes whose range holds everything none falls below 0.79 (noise
//! of 5 grey levels: 0.73), of those with half of the range 5 to 66 of some 70 fall below 0.7.
//!
//! # Bounds
//! A cost is at most 127 + P2: the sum of two saturates.
//!
//! # Cost
//! Some 70 windows of a QVGA pair, a third of which is compared beyond the range.

use super::codes::{BORDER, CodeRows};
use super::{Grid, MIN_RANGE};
use crate::curve::MAX_DISPARITIES;
use crate::kernel::{JUMP_PENALTY, lowest_byte, place_of_byte};

/// Rows and columns of points from one sample to the next.
const STEP: usize = 4;
/// First row of points with samples.
const FIRST_ROW: usize = 2;
/// First column of points of a sample.
const FIRST_COLUMN: usize = 1;
/// Most disparities compared beyond the range.
const MOST_BEYOND: usize = 64;
/// Lowest cost in the range, of two windows without P2, below which they have their match there.
const EXPLAINED: u8 = 40;

/// Windows of the left image compared with disparities beyond the range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RangeCheck {
    /// Number of windows.
    pub windows: u16,
    /// Number of those that match better beyond the range.
    pub beyond: u16,
    /// The second largest disparity at which these match, px; 0 with less than two.
    pub disparity: u16,
    /// The largest.
    largest: u16,
}

impl RangeCheck {
    /// The same of images of twice the size.
    pub(super) const fn doubled(self) -> Self {
        Self { disparity: 2 * self.disparity, largest: 2 * self.largest, ..self }
    }

    /// Adds the counts of other windows.
    pub(super) fn merge(&mut self, other: &Self) {
        self.windows += other.windows;
        self.beyond += other.beyond;
        let smaller = self.largest.min(other.largest);
        self.disparity = self.disparity.max(other.disparity).max(smaller);
        self.largest = self.largest.max(other.largest);
    }

    fn add_match(&mut self, disparity: u16) {
        self.beyond += 1;
        self.disparity = self.disparity.max(self.largest.min(disparity));
        self.largest = self.largest.max(disparity);
    }
}

/// The column, or the next one where a sample would begin before it and end behind it.
pub(super) fn beside_sample(column: usize) -> usize {
    column + usize::from(column % STEP == FIRST_COLUMN + 1)
}

/// Costs of the first point of a sample, and the counts so far.
pub(super) struct NearerSearch {
    grid: Grid,
    first: [u8; MAX_DISPARITIES],
    /// Row and sample whose first point is known.
    sample: Option<(usize, usize)>,
    pub(super) check: RangeCheck,
}

impl NearerSearch {
    pub(super) fn new(grid: Grid) -> Self {
        Self { grid, first: [0; MAX_DISPARITIES], sample: None, check: RangeCheck::default() }
    }

    pub(super) const fn grid(&self) -> Grid {
        self.grid
    }

    /// Continues with the costs of the next point of a row, at all disparities of the range.
    pub(super) fn add(
        &mut self,
        (row, column): (usize, usize),
        costs: &[u8],
        codes: &CodeRows<'_>,
        right_start: i32,
    ) {
        if row % STEP != FIRST_ROW {
            return;
        }
        let (sample, place) = ((row, column / STEP), column % STEP);
        if place == FIRST_COLUMN {
            self.sample = Some(sample);
            let length = costs.len().min(MAX_DISPARITIES);
            if let (Some(kept), Some(costs)) = (self.first.get_mut(..length), costs.get(..length)) {
                kept.copy_from_slice(costs);
            }
        } else if place == FIRST_COLUMN + 1 && self.sample.take() == Some(sample) {
            self.compare([column - 1, column], costs, codes, right_start);
        }
    }

    /// Compares the lowest cost of a sample in the range with that beyond it.
    fn compare(
        &mut self,
        columns: [usize; 2],
        costs: &[u8],
        codes: &CodeRows<'_>,
        right_start: i32,
    ) {
        let windows = columns.map(|column| self.grid.window(column));
        let (last, [x, _]) = (self.grid.last(), windows);
        // The disparities end where the window leaves the right image; costs are stored from the
        // largest one down.
        let most = (x - right_start.max(BORDER) - last)
            .min(MOST_BEYOND as i32)
            .min(self.grid.disparities as i32);
        let Some(length) = usize::try_from(most).ok().filter(|&length| length >= MIN_RANGE) else {
            return;
        };
        self.check.windows += 1;
        let in_range = self
            .first
            .iter()
            .zip(costs)
            .fold(u8::MAX, |low, (&a, &b)| low.min(a.saturating_add(b)));
        let in_range = in_range.saturating_sub(2 * JUMP_PENALTY);
        if in_range < EXPLAINED {
            return;
        }
        let mut beyond = [[u8::MAX; MOST_BEYOND]; 2];
        for (costs, x) in beyond.iter_mut().zip(windows) {
            let Some(costs) = costs.get_mut(..length) else { return };
            if codes.costs(x, x - last - most, costs).is_none() {
                return;
            }
        }
        let [sums, others] = &mut beyond;
        sums.iter_mut().zip(others).for_each(|(sum, other)| *sum = sum.saturating_add(*other));
        let lowest = lowest_byte(sums);
        let outside = u16::from(lowest.saturating_sub(2 * JUMP_PENALTY)) + 1;
        if 16 * outside < 11 * (u16::from(in_range) + 1)
            && let Some(place) = place_of_byte(sums, lowest)
        {
            self.check.add_match(u16::try_from(last + most - place as i32).unwrap_or(0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_largest_disparity_is_told() {
        let mut check = RangeCheck::default();
        let mut seen = [0; 4];
        for (seen, disparity) in seen.iter_mut().zip([70, 90, 80, 75]) {
            check.add_match(disparity);
            *seen = check.disparity;
        }
        assert_eq!((seen, check.beyond), ([0, 70, 80, 80], 4));
    }

    #[test]
    fn counts_of_two_halves_are_those_of_the_whole() {
        let all = [70, 90, 80, 75];
        let of = |disparities: &[u16]| {
            let mut check = RangeCheck::default();
            disparities.iter().for_each(|&disparity| check.add_match(disparity));
            check
        };
        for middle in 0..=all.len() {
            let (left, right) = all.split_at(middle);
            let mut check = of(left);
            check.merge(&of(right));
            assert_eq!(check, of(&all), "{middle}");
        }
    }
}
