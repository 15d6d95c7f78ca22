//! Cost over disparity: minimum, rival, sub-pixel position.
//!
//! # Source
//! Rival outside +-2 px and the best/rival ratio: uniqueness as in block matching. Sub-pixel by the equiangular fit (Shimizu, Okutomi
//! 2001): two lines of equal and opposite slope, the right shape for absolute differences.

use crate::kernel::LANES;
use crate::units::quotient;

/// Most disparities of a search.
pub(crate) const MAX_DISPARITIES: usize = 256;
/// Disparities on both sides of a minimum that are not its rivals.
const NEIGHBOURHOOD: i32 = 2;

/// Cost at disparities `first .. first + len`.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    costs: [u16; MAX_DISPARITIES],
    first: i32,
    len: usize,
}

/// A curve's minimum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Minimum {
    /// Whole disparity.
    pub(crate) at: i32,
    /// Its cost.
    pub(crate) cost: u16,
}

impl Curve {
    /// No disparities.
    pub(crate) const EMPTY: Self = Self { costs: [0; MAX_DISPARITIES], first: 0, len: 0 };

    /// Starts again from zero over `len` disparities from `first` on, in place.
    pub(crate) fn clear(&mut self, (first, len): (i32, i32)) {
        self.first = first;
        self.len = usize::try_from(len).unwrap_or(0).min(MAX_DISPARITIES);
        self.blocks().fill(0);
    }

    /// The first disparity.
    pub(crate) fn first(&self) -> i32 {
        self.first
    }

    /// Room for the kernels: whole blocks, of which the last may reach beyond `len`.
    pub(crate) fn blocks(&mut self) -> &mut [u16] {
        let end = self.len.next_multiple_of(LANES);
        self.costs.get_mut(..end).unwrap_or(&mut [])
    }

    pub(crate) fn costs(&self) -> &[u16] {
        self.costs.get(..self.len).unwrap_or(&[])
    }

    pub(crate) fn at(&self, d: i32) -> Option<u16> {
        self.costs().get(usize::try_from(d - self.first).ok()?).copied()
    }

    /// Sum of this curve moved by `shift` and the other moved by `shift_other`; entries from outside count as the largest cost.
    pub(crate) fn shifted_sum(&self, shift: i32, other: &Self, shift_other: i32) -> Self {
        let mut sum = Self { first: self.first, len: self.len, ..Self::EMPTY };
        for (cost, d) in sum.costs.iter_mut().zip(self.first..).take(self.len) {
            *cost = match (self.at(d + shift), other.at(d + shift_other)) {
                (Some(a), Some(b)) => a.saturating_add(b),
                _ => u16::MAX,
            };
        }
        sum
    }

    /// Entry by entry sum.
    pub(crate) fn sum(&self, other: &Self) -> Self {
        self.combine(other, u16::saturating_add)
    }

    /// Entry by entry minimum.
    pub(crate) fn lower(&self, other: &Self) -> Self {
        self.combine(other, u16::min)
    }

    fn combine(&self, other: &Self, operation: impl Fn(u16, u16) -> u16) -> Self {
        let mut result = Self { first: self.first, len: self.len.min(other.len), ..Self::EMPTY };
        for ((cost, &a), &b) in result.costs.iter_mut().zip(self.costs()).zip(other.costs()) {
            *cost = operation(a, b);
        }
        result
    }

    /// The first lowest entry within `centre +- reach`.
    pub(crate) fn minimum_near(&self, centre: i32, reach: i32) -> Minimum {
        let mut best = Minimum { at: centre, cost: u16::MAX };
        for d in centre - reach..=centre + reach {
            if let Some(cost) = self.at(d)
                && cost < best.cost
            {
                best = Minimum { at: d, cost };
            }
        }
        best
    }

    /// The first lowest entry.
    pub(crate) fn minimum(&self) -> Minimum {
        let mut best = Minimum { at: self.first, cost: u16::MAX };
        for (&cost, at) in self.costs().iter().zip(self.first..) {
            if cost < best.cost {
                best = Minimum { at, cost };
            }
        }
        best
    }

    /// Lowest cost outside the neighbourhood of `at`: the rival.
    pub(crate) fn rival(&self, at: i32) -> u16 {
        let outside = |(_, d): &(&u16, i32)| (d - at).abs() > NEIGHBOURHOOD;
        self.costs().iter().zip(self.first..).filter(outside).map(|(&cost, _)| cost).min().unwrap_or(u16::MAX)
    }

    /// Sub-pixel position of the minimum at `at`, 1/64 px.
    pub(crate) fn subpixel_q6(&self, at: i32) -> i32 {
        let (Some(before), Some(here), Some(after)) = (self.at(at - 1), self.at(at), self.at(at + 1)) else {
            return at << 6;
        };
        let (before, here, after) = (i32::from(before), i32::from(here), i32::from(after));
        let depth = before.max(after) - here;
        if depth <= 0 {
            return at << 6;
        }
        (at << 6) + quotient((before - after) << 5, depth).clamp(-32, 32)
    }
}

/// `256 * (cost + 1) / (rival + 1)`, at most 3 * 256: below 256 the minimum is better than its rival. The ones make two perfect matches a tie.
pub(crate) fn ratio_q8(cost: u16, rival: u16) -> i32 {
    quotient((i32::from(cost) + 1) << 8, i32::from(rival) + 1).min(768)
}
