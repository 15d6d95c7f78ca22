//! Cost over disparity: minimum, second-best, sub-pixel position.
//!
//! Curves are stored in a `matching::Workspace` of the caller and written in place: none is copied,
//! none is on the stack.
//!
//! # Cost
//! A pass over the disparities for every operation but those at one disparity: 1 to 2 instructions
//! a disparity (Armv7E-M), at most [`MAX_DISPARITIES`]. What several windows call is not inlined: a
//! call takes some ten instructions, a copy some 100 bytes of flash.
//!
//! # Source
//! Second-best outside +-2 px and its ratio to the best: uniqueness as in block matching. Sub-pixel
//! by the equiangular fit (Shimizu, Okutomi 2001): two lines of equal and opposite slope, the right
//! shape for absolute differences.

use crate::kernel::{LANES, lower_curve, lower_sum_curve, lowest, sum_curve};
use crate::units::quotient;

/// Largest number of disparities compared.
pub(crate) const MAX_DISPARITIES: usize = 256;
/// Disparities on both sides of a minimum that the second-best leaves out.
const NEIGHBOURHOOD: i32 = 2;
/// Number of curves of a workspace: those of one segment.
pub(crate) const CURVES: usize = 12;

/// Cost at disparities `first .. first + len`. Whole blocks are computed; entries beyond `len` are
/// the largest cost.
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    costs: [u16; MAX_DISPARITIES],
    first: i32,
    len: usize,
}

/// Minimum of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Minimum {
    /// Whole disparity, px.
    pub(crate) at: i32,
    /// Its cost.
    pub(crate) cost: u16,
}

impl Curve {
    /// No disparities.
    #[cfg(test)]
    pub(crate) const EMPTY: Self = Self { costs: [0; MAX_DISPARITIES], first: 0, len: 0 };

    /// Sums costs over `len` disparities from `first` on; `add` is given whole blocks.
    pub(crate) fn fill(&mut self, (first, len): (i32, i32), add: impl FnOnce(&mut [u16])) {
        add(self.cleared((first, len)));
        self.close();
    }

    /// Sums costs upon those of another curve, over the same disparities; `add` is given whole
    /// blocks.
    pub(crate) fn fill_upon(&mut self, base: &Self, add: impl FnOnce(&mut [u16])) {
        (self.first, self.len) = (base.first, base.len);
        for (cost, &below) in self.blocks().iter_mut().zip(base.whole()) {
            *cost = below;
        }
        add(self.blocks());
        self.close();
    }

    /// Becomes a curve of zeros; returns its whole blocks.
    #[inline(never)]
    fn cleared(&mut self, (first, len): (i32, i32)) -> &mut [u16] {
        self.first = first;
        self.len = usize::try_from(len).unwrap_or(0).min(MAX_DISPARITIES);
        let blocks = self.blocks();
        blocks.fill(0);
        blocks
    }

    /// The largest cost beyond the disparities.
    #[inline(never)]
    fn close(&mut self) {
        let len = self.len;
        if let Some(beyond) = self.blocks().get_mut(len..).filter(|beyond| !beyond.is_empty()) {
            beyond.fill(u16::MAX);
        }
    }

    fn blocks(&mut self) -> &mut [u16] {
        let end = self.len.next_multiple_of(LANES);
        self.costs.get_mut(..end).unwrap_or(&mut [])
    }

    fn whole(&self) -> &[u16] {
        self.costs.get(..self.len.next_multiple_of(LANES)).unwrap_or(&[])
    }

    /// Number of disparities.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// First disparity, px, and the costs from there on; none where nothing was computed.
    pub(crate) fn listed(&self) -> Option<(i32, &[u16])> {
        self.costs
            .get(..self.len)
            .filter(|costs| !costs.is_empty())
            .map(|costs| (self.first, costs))
    }

    /// Becomes a curve without disparities.
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    pub(crate) fn at(&self, d: i32) -> Option<u16> {
        let index = usize::try_from(d - self.first).ok()?;
        if index < self.len { self.costs.get(index).copied() } else { None }
    }

    /// Becomes the entry by entry sum of two curves over the same disparities.
    pub(crate) fn set_sum(&mut self, a: &Self, b: &Self) {
        (self.first, self.len) = (a.first, a.len);
        sum_curve(a.whole(), b.whole(), self.blocks());
    }

    /// Adds another curve over the same disparities, entry by entry.
    #[inline(never)]
    pub(crate) fn add(&mut self, other: &Self) {
        for (cost, &other) in self.blocks().iter_mut().zip(other.whole()) {
            *cost = cost.saturating_add(other);
        }
    }

    /// Adds to every entry.
    pub(crate) fn raise(&mut self, by: u16) {
        self.blocks().iter_mut().for_each(|cost| *cost = cost.saturating_add(by));
    }

    /// Becomes the entry by entry sum of `a` and `weight` times `b`.
    pub(crate) fn set_weighted_sum(&mut self, a: &Self, b: &Self, weight: u16) {
        (self.first, self.len) = (a.first, a.len);
        for ((cost, &a), &b) in self.blocks().iter_mut().zip(a.whole()).zip(b.whole()) {
            *cost = a.saturating_add(b.saturating_mul(weight));
        }
    }

    /// Becomes the entry by entry minimum.
    pub(crate) fn set_lower(&mut self, a: &Self, b: &Self) {
        (self.first, self.len) = (a.first, a.len);
        lower_curve(a.whole(), b.whole(), self.blocks());
    }

    /// Becomes the entry by entry minimum of `a` and `b`, plus `c`.
    pub(crate) fn set_lower_sum(&mut self, a: &Self, b: &Self, c: &Self) {
        (self.first, self.len) = (a.first, a.len);
        lower_sum_curve(a.whole(), b.whole(), c.whole(), self.blocks());
    }

    /// Becomes the sum of `a` moved by `shift_a` and `b` moved by `shift_b`; entries outside of
    /// either are the largest cost.
    pub(crate) fn set_shifted_sum(&mut self, a: &Self, shift_a: i32, b: &Self, shift_b: i32) {
        (self.first, self.len) = (a.first, a.len);
        self.blocks().fill(u16::MAX);
        let before = shift_a.min(shift_b).min(0).unsigned_abs() as usize;
        let from =
            |shift: i32| usize::try_from(i32::try_from(before).unwrap_or(0) + shift).unwrap_or(0);
        let tail = |curve: &Self, shift: i32| from(shift)..curve.len;
        let (ra, rb) = (tail(a, shift_a), tail(b, shift_b));
        let (Some(a), Some(b)) = (a.costs.get(ra), b.costs.get(rb)) else { return };
        let count = a.len().min(b.len()).min(self.len.saturating_sub(before));
        if let (Some(a), Some(b), Some(costs)) =
            (a.get(..count), b.get(..count), self.costs.get_mut(before..before + count))
        {
            sum_curve(a, b, costs);
        }
    }

    /// The first lowest entry within `centre +- reach`.
    #[inline(never)]
    pub(crate) fn minimum_near(&self, centre: i32, reach: i32) -> Minimum {
        let mut best = Minimum { at: centre, cost: u16::MAX };
        let index = |d: i32| usize::try_from(d - self.first).unwrap_or(0).min(self.len);
        let from = index(centre - reach);
        let near = self.costs.get(from..index(centre + reach + 1)).unwrap_or(&[]);
        for (d, &cost) in (self.first + from as i32..).zip(near) {
            if cost < best.cost {
                best = Minimum { at: d, cost };
            }
        }
        best
    }

    /// The first lowest entry.
    #[inline(never)]
    pub(crate) fn minimum(&self) -> Minimum {
        let cost = lowest(self.whole());
        let index = self.whole().iter().position(|&c| c == cost).unwrap_or(0);
        Minimum { at: self.first + i32::try_from(index).unwrap_or(0), cost }
    }

    /// Lowest cost outside the neighbourhood of `at`: the second-best.
    #[inline(never)]
    pub(crate) fn second_best(&self, at: i32) -> u16 {
        let costs = self.whole();
        let index = |d: i32| usize::try_from(d - self.first).unwrap_or(0).min(costs.len());
        let before = costs.get(..index(at - NEIGHBOURHOOD)).unwrap_or(&[]);
        let after = costs.get(index(at + NEIGHBOURHOOD + 1)..).unwrap_or(&[]);
        lowest(before).min(lowest(after))
    }

    /// Sub-pixel position of the minimum at `at`, 1/64 px.
    pub(crate) fn subpixel_q6(&self, at: i32) -> i32 {
        subpixel_q6(at, |d| self.at(d))
    }
}

/// The first lowest of `cost(centre - reach ..= centre + reach)`.
pub(crate) fn minimum_near(centre: i32, reach: i32, cost: impl Fn(i32) -> Option<u16>) -> Minimum {
    let mut best = Minimum { at: centre, cost: u16::MAX };
    for d in centre - reach..centre + reach + 1 {
        if let Some(cost) = cost(d)
            && cost < best.cost
        {
            best = Minimum { at: d, cost };
        }
    }
    best
}

/// Sub-pixel position of the minimum at `at`, 1/64 px.
pub(crate) fn subpixel_q6(at: i32, cost: impl Fn(i32) -> Option<u16>) -> i32 {
    let (Some(before), Some(here), Some(after)) = (cost(at - 1), cost(at), cost(at + 1)) else {
        return at << 6;
    };
    let (before, here, after) = (i32::from(before), i32::from(here), i32::from(after));
    let depth = before.max(after) - here;
    if depth <= 0 {
        return at << 6;
    }
    (at << 6) + quotient((before - after) << 5, depth).clamp(-32, 32)
}

/// The middle one of three costs; where it is the lowest, the minimum of the V through all three,
/// which lies between whole disparities.
#[inline]
pub(crate) fn low_of(&[before, here, after]: &[u16; 3]) -> u32 {
    let is_low = here <= before.min(after) && before.max(after) < u16::MAX;
    u32::from(here.saturating_sub(if is_low { before.abs_diff(after) / 2 } else { 0 }))
}

/// Uniqueness ratio `256 * (cost + 1) / (second_best + 1)`, Q8, at most 768: below 256 the minimum
/// is better than the second-best. The ones make two perfect matches a tie.
pub(crate) fn ratio_q8(cost: u16, second_best: u16) -> i32 {
    quotient((i32::from(cost) + 1) << 8, i32::from(second_best) + 1).min(768)
}
