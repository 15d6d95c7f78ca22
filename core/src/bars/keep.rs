//! The bars that are found: the strongest ones, each once, at most two that cover each other.
//!
//! # Bounds
//! [`MOST_BARS`](super::MOST_BARS) bars.
//!
//! # Cost
//! A bar is compared with those kept, which most of them share no row with: 8 instructions each.

use super::{Bar, DROPPED, MOST_BARS};
use crate::list::List;
use crate::sort::sort_by_key;
use heapless::Vec;

/// Rows that two bars share at least where they are compared.
const SHARED: i32 = 4;
/// Largest distance between both edges of two bars that are one, 1/32 px.
const SAME_Q5: i32 = 48;

/// Where bars go that are found beside segments.
pub(super) trait Found {
    /// True where a bar of this strength may be kept.
    fn may_keep(&self, strength: u32) -> bool;

    /// Takes a bar.
    fn insert(&mut self, bar: Bar);
}

/// All bars, in the order in which they are found.
impl Found for List<'_, Bar> {
    fn may_keep(&self, _: u32) -> bool {
        true
    }

    fn insert(&mut self, bar: Bar) {
        let _ = self.push(bar); // the caller leaves room
    }
}

/// A list of bars while they are found.
pub(super) struct Kept<'a, 'b> {
    bars: &'a mut List<'b, Bar>,
    /// The strengths of the bars.
    strengths: Vec<u32, MOST_BARS>,
    /// Strength that a bar has to exceed: that of the weakest one of a full list.
    least: u32,
}

impl<'a, 'b> Kept<'a, 'b> {
    pub(super) fn new(bars: &'a mut List<'b, Bar>) -> Self {
        bars.clear();
        Self { bars, strengths: Vec::new(), least: 0 }
    }
}

impl Found for Kept<'_, '_> {
    #[inline]
    fn may_keep(&self, strength: u32) -> bool {
        strength > self.least
    }

    /// Keeps a bar, or the stronger one where it is another's double; in a full list it replaces
    /// the weakest.
    fn insert(&mut self, bar: Bar) {
        let strength = bar.strength();
        if !self.may_keep(strength) {
            return;
        }
        let index = match self.bars.iter().position(|kept| is_same(kept, &bar)) {
            Some(same) => same,
            None if !self.bars.is_full() => {
                let _ = (self.bars.push(bar), self.strengths.push(0)); // both have room
                self.bars.len() - 1
            }
            None => {
                let weakest = (0..).zip(&self.strengths).min_by_key(|(_, strength)| **strength);
                weakest.map_or(0, |(index, _)| index)
            }
        };
        if let (Some(kept), Some(known)) = (self.bars.get_mut(index), self.strengths.get_mut(index))
            && *known < strength
        {
            (*kept, *known) = (bar, strength);
        }
        if self.bars.is_full() {
            self.least = self.strengths.iter().copied().min().unwrap_or(0);
        }
    }
}

/// Leaves at most two bars that cover each other, the strongest ones; sorts by strength.
pub(super) fn leave_out_doubles(bars: &mut List<'_, Bar>) {
    sort_by_key(bars, |bar| (u32::MAX - bar.strength(), bar.rows[0], bar.x_q5, bar.width_q5));
    for index in 1..bars.len() {
        let Some((stronger, rest)) = bars.split_at_mut_checked(index) else { break };
        let Some(bar) = rest.first_mut() else { break };
        let is_there = |kept: &&Bar| !kept.is(DROPPED);
        let doubled = stronger.iter().filter(is_there).any(|kept| is_same(kept, bar));
        let covering = stronger.iter().filter(is_there).filter(|kept| covers(kept, bar)).count();
        if doubled || covering > 1 {
            bar.flags |= DROPPED;
        }
    }
    bars.retain(|bar| !bar.is(DROPPED));
}

/// Distances of the left and of the right edges of two bars at a row of both, 1/32 px, if there is
/// one. Most pairs share no row: no call for these.
#[inline(always)]
fn apart_q5(a: &Bar, b: &Bar) -> Option<[i32; 2]> {
    let ([a0, a1], [b0, b1]) = (a.first_and_last(), b.first_and_last());
    (a0 <= b1 - SHARED && a1 >= b0 + SHARED).then(|| apart_at_q5(a, b, (a0, a1)))
}

/// Those at the row nearest to the middle of the second bar of these of the first one.
#[inline(never)]
fn apart_at_q5(a: &Bar, b: &Bar, (first, last): (i32, i32)) -> [i32; 2] {
    let y = b.middle_row().max(first).min(last);
    let (left_a, left_b) = (a.x_at_q5(y), b.x_at_q5(y));
    let [width_a, width_b] = [a, b].map(|bar| i32::from(bar.width_q5));
    [left_a - left_b, left_a + width_a - left_b - width_b]
}

fn is_same(a: &Bar, b: &Bar) -> bool {
    apart_q5(a, b).is_some_and(|apart| apart.iter().all(|apart| apart.abs() < SAME_Q5))
}

/// True when one covers half of the narrower one.
fn covers(a: &Bar, b: &Bar) -> bool {
    let Some([left, right]) = apart_q5(a, b) else { return false };
    let [width_a, width_b] = [a, b].map(|bar| i32::from(bar.width_q5));
    // From the larger left edge to the smaller right one, from the left edge of `b`.
    let common = (width_b + right).min(width_b) - left.max(0);
    2 * common > width_a.min(width_b)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use core::mem::MaybeUninit;

    pub(in crate::bars) fn bar(x: u16, width: u16, rows: [u16; 2], strength: u8) -> Bar {
        Bar {
            x_q5: x << 5,
            rows,
            slope_q12: 0,
            width_q5: width << 5,
            disparity_q6: [0; 2],
            scores_q8: [0; 2],
            probability_q16: 0,
            strengths_q3: [strength; 2],
            coherence_q8: 255,
            flags: 0,
        }
    }

    #[test]
    fn of_doubles_the_stronger_one_stays() {
        let mut slots = [MaybeUninit::uninit(); 4];
        let mut list = List::new(&mut slots);
        let mut kept = Kept::new(&mut list);
        for strength in [9, 20, 12] {
            kept.insert(bar(40, 6, [10, 30], strength));
        }
        assert_eq!(*list, [bar(40, 6, [10, 30], 20)]);
    }

    #[test]
    fn a_full_list_loses_its_weakest() {
        let mut slots = [MaybeUninit::uninit(); 2];
        let mut list = List::new(&mut slots);
        let mut kept = Kept::new(&mut list);
        for (x, strength) in [(40, 9), (80, 20), (120, 12), (160, 3)] {
            kept.insert(bar(x, 6, [10, 30], strength));
        }
        leave_out_doubles(&mut list);
        assert_eq!(
            list.iter().map(|bar| bar.x_q5 >> 5).collect::<Vec<_, 2>>().as_slice(),
            [80, 120]
        );
    }

    #[test]
    fn of_three_that_cover_each_other_the_weakest_goes() {
        let mut slots = [MaybeUninit::uninit(); 4];
        let mut list = List::new(&mut slots);
        let mut kept = Kept::new(&mut list);
        for (x, width, strength) in [(40, 6, 9), (40, 10, 20), (38, 12, 12), (90, 6, 2)] {
            kept.insert(bar(x, width, [10, 30], strength));
        }
        leave_out_doubles(&mut list);
        assert_eq!(list.len(), 3);
        assert!(!list.contains(&bar(40, 6, [10, 30], 9)));
    }
}
