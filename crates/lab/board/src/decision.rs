//! From the costs of a window to a disparity, and from a row of them to those that the right image
//! confirms.
//!
//! ```text
//! unique:   every cost more than 1 px from the lowest > lowest + lowest * ratio / 100; the largest
//!           disparity of equals
//! result:   lowest + (before - after) / (2 (max(before, after) - lowest cost)), in 1/256 px, plus
//!           15 and halved four times
//! confirm:  each right pixel belongs to the disparity with the lowest cost that meets it; others
//!           that differ are dropped
//! ```
//!
//! # Bounds
//! Costs are at most 15 872, so a bound with a ratio of up to 300 fits `u16`.
//!
//! # Cost
//! Most pixels are turned down by the lowest of every fourth cost: two further on lies no neighbour
//! of the lowest.
//!
//! # Source
//! OpenCV, `calib3d/stereobm.cpp` and `validateDisparity` of `stereosgbm.cpp`, both with a shift of
//! four bits.

use crate::kernel::{Group, groups_within, places_within};
use core::cmp::Ordering;

/// A pixel without a disparity, in 1/16 px.
pub const NO_DISPARITY: i16 = -16;
/// Largest uniqueness ratio, percent.
pub const MOST_UNIQUE: u16 = 300;

/// A disparity and what it costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Found {
    pub(super) sixteenths: i16,
    pub(super) cost: u16,
}

/// The disparity of these costs, of which `lowest` are the lowest of every fourth, if it is unique.
#[inline]
pub(super) fn decide(costs: &[Group], lowest: Group, uniqueness_ratio: u16) -> Option<Found> {
    let Group([a, c, b, d]) = lowest;
    let cost = a.min(b).min(c.min(d));
    let ratio = u32::from(uniqueness_ratio.min(MOST_UNIQUE));
    let bound = (u32::from(cost) + u32::from(cost) * ratio / 100) as u16;
    // Two further on, modulo four, lies no neighbour of the lowest. Where two neighbours are the
    // lowest it is not known which one counts.
    let opposite = match a.min(c).cmp(&b.min(d)) {
        Ordering::Less => a.max(c),
        Ordering::Greater => b.max(d),
        Ordering::Equal => u16::MAX,
    };
    if opposite <= bound {
        return None;
    }
    unique(costs, cost, bound)
}

fn unique(costs: &[Group], cost: u16, bound: u16) -> Option<Found> {
    let [first, last] = groups_within(costs, bound)?;
    if last > first + 1 {
        return None;
    }
    let near = costs.get(first..=last)?;
    // Bit d: disparity 4 * first + d is within the bound; is the lowest.
    let (mut within, mut is_lowest) = (0_u32, 0_u32);
    for (&group, place) in near.iter().zip([0, 4]) {
        within |= places_within(group, bound) << place;
        is_lowest |= places_within(group, cost) << place;
    }
    let place = is_lowest.checked_ilog2()?;
    if within << 1 & !(0b111 << place) != 0 {
        return None;
    }
    let d = 4 * first + place as usize;
    Some(Found { sixteenths: refined(costs, d, cost), cost })
}

fn refined(costs: &[Group], d: usize, cost: u16) -> i16 {
    let at = |d: usize| costs.get(d / 4).map(|group| i32::from(group.at(d)));
    let fraction = match (d.checked_sub(1).and_then(at), at(d + 1)) {
        (Some(before), Some(after)) => {
            let width = 2 * (before.max(after) - i32::from(cost));
            ((before - after) * 256).checked_div(width).unwrap_or(0)
        }
        _ => 0,
    };
    ((d as i32 * 256 + fraction + 15) >> 4) as i16
}

/// Memory for what is decided of a row.
#[derive(Debug)]
pub(super) struct DecidedMemory<const ROW: usize> {
    disparities: [i16; ROW],
    right_costs: [u16; ROW],
    right_disparities: [i16; ROW],
}

impl<const ROW: usize> DecidedMemory<ROW> {
    pub(super) const CLEARED: Self =
        Self { disparities: [0; ROW], right_costs: [0; ROW], right_disparities: [0; ROW] };

    /// As far as rows of this width need it.
    pub(super) fn row(&mut self, width: usize) -> DecidedRow<'_> {
        DecidedRow {
            left: &mut self.disparities[..width],
            right_costs: &mut self.right_costs[..width],
            right: &mut self.right_disparities[..width],
        }
    }
}

/// The disparities of a left row, and those that meet the pixels of the right one, each with the
/// lowest cost.
#[derive(Debug)]
pub(super) struct DecidedRow<'a> {
    left: &'a mut [i16],
    right_costs: &'a mut [u16],
    right: &'a mut [i16],
}

impl DecidedRow<'_> {
    pub(super) fn clear(&mut self) {
        self.left.fill(NO_DISPARITY);
        self.right_costs.fill(u16::MAX);
        self.right.fill(NO_DISPARITY);
    }

    /// Notes the disparity of a left pixel.
    #[inline]
    pub(super) fn note(&mut self, x: usize, found: Found) {
        self.left[x] = found.sixteenths;
        let met = x.wrapping_sub(((found.sixteenths + 8) >> 4) as usize);
        if let (Some(cost), Some(sixteenths)) =
            (self.right_costs.get_mut(met), self.right.get_mut(met))
            && *cost > found.cost
        {
            *cost = found.cost;
            *sixteenths = found.sixteenths;
        }
    }

    /// The disparities, without those that meet two right pixels which belong to others, if that is
    /// asked for.
    pub(super) fn checked(&mut self, most_px: Option<u16>) -> &[i16] {
        if let Some(most_px) = most_px {
            self.check(most_px);
        }
        self.left
    }

    fn check(&mut self, most_px: u16) {
        let most = 16 * most_px;
        for (x, disparity) in self.left.iter_mut().enumerate() {
            let d = *disparity;
            if d == NO_DISPARITY {
                continue;
            }
            let differs = |px: i16| {
                let other = self.right.get(x.wrapping_sub(px as usize));
                other.is_some_and(|&other| other != NO_DISPARITY && other.abs_diff(d) > most)
            };
            if differs(d >> 4) && differs((d + 15) >> 4) {
                *disparity = NO_DISPARITY;
            }
        }
    }
}
