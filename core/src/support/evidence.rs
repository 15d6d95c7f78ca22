//! The evidence for a support point's disparity: plain numbers in Q8 that a linear model weighs.
//!
//! In: the costs of a point along the disparities, later its neighbours. Out: one signed 16-bit number per kind, +-128 with a step of 1/256.
//!
//! # Cost
//! Three passes over the costs of a point, some 600 instructions at 64 disparities; its eight neighbours another 250.

use super::SupportPoint;
use super::paths::PointCosts;
use crate::confidence::Model;
use crate::curve::subpixel_q6;
use crate::evidence::{define_evidence, log2_mean_q8};
use crate::kernel::{JUMP_PENALTY, RankColumn, STRIP, lowest_byte, place_of_byte};
use crate::units::narrow;
use core::ops::Range;

/// Disparities on both sides of the best that the second-best leaves out.
const NEIGHBOURHOOD: usize = 2;
/// Least uniqueness of a point, log2(second-best / best) of the paths' sum, Q8: 4 %. With less, a pattern repeats or there is none.
const LEAST_UNIQUE_Q8: i32 = 16;
/// [`SupportKind::Detail`] where no window was evaluated, Q8: sharp captured frames have 1040 to 1115, blurred ones less, noisy ones more.
pub(crate) const TYPICAL_DETAIL_Q8: i16 = 1060;
/// Least value of [`SupportKind::Detail`] that models were fitted on, Q8; smaller ones are limited to it.
const LEAST_DETAIL_Q8: i16 = 900;
/// Largest value of [`SupportKind::Detail`] that models were fitted on, Q8; larger ones are limited to it.
const MOST_DETAIL_Q8: i16 = 1160;
/// Least increase of the window's cost 1 px to either side for an equal cost elsewhere to be a repetition, and not a blank wall.
const LEAST_DEPTH: u8 = 2;
/// Largest difference between the disparities of neighbours that agree, 1/64 px.
const AGREES_Q6: i32 = 96;

define_evidence! {
    /// Kinds of evidence of a support point, in the order of the model's coefficients.
    SupportKind;
    /// One number per [`SupportKind`], Q8.
    SupportEvidence;
    SUPPORT_EVIDENCE;
    PathsRatio: "log2 of the paths' sum: best / second-best",
    WindowRatio: "log2 of the window's cost: at the disparity / best elsewhere",
    WindowCost: "log2(1 + the window's cost)",
    Range: "log2(1 + disparities compared)",
    Curvature: "log2(1 + how much worse the window is 1 px away)",
    Changes: "log2(1 + ranks that change along the window)",
    PathsRatioSquared: "square of the first",
    WindowRatioSquared: "square of the second",
    Agreeing: "log2(1 + neighbours that agree)",
    Conflicting: "log2(1 + neighbours that contradict)",
    SegmentsAgreeing: "log2(1 + hypotheses of segments nearby that agree)",
    SegmentsConflicting: "log2(1 + hypotheses of segments nearby that contradict)",
    Detail: "log2(1 + ranks that change along a window, on average)",
}

/// Disparity of a point, as an index into its costs, with its evidence.
pub(super) struct Found {
    /// Sub-pixel index of the best, 1/64.
    pub(super) at_q6: i32,
    pub(super) uniqueness_q8: u8,
    pub(super) evidence: SupportEvidence,
}

/// Lowest cost outside of the neighbourhood of `at`; overwrites that neighbourhood with the largest cost.
fn second_best(costs: &mut [u8], at: usize) -> u8 {
    let end = (at + NEIGHBOURHOOD + 1).min(costs.len());
    if let Some(near) = costs.get_mut(at.saturating_sub(NEIGHBOURHOOD)..end) {
        match near.first_chunk_mut() {
            Some(whole) => *whole = [u8::MAX; 2 * NEIGHBOURHOOD + 1], // two stores, not a call
            None => fill_part(near),
        }
    }
    lowest_byte(costs)
}

/// Masks a neighbourhood that ends with the range.
#[inline(never)] // otherwise the compiler makes one call of this and of the two stores
fn fill_part(near: &mut [u8]) {
    near.fill(u8::MAX);
}

/// Number of ranks of a window that differ from the one in the next column, 0 ..= 28.
pub(super) fn changes_of(window: &[RankColumn; STRIP]) -> u8 {
    let (most, ones) = (0x7f7f_7f7f_u32, 0x0101_0101);
    let &[a, b, c, d, e, f, g, h] = window;
    let of = |a, b| ((u32::from_le_bytes(a) ^ u32::from_le_bytes(b)) + most) >> 7 & ones;
    let of_rows: u32 = of(a, b) + of(b, c) + of(c, d) + of(d, e) + of(e, f) + of(f, g) + of(g, h);
    (of_rows.wrapping_mul(ones) >> 24) as u8
}

/// Changes of ranks, summed over the windows of an image.
#[derive(Default)]
pub(super) struct Detail {
    changes: u32,
    windows: i32,
}

impl Detail {
    pub(super) fn add(&mut self, changes: u8) {
        self.changes += u32::from(changes);
        self.windows += 1;
    }

    /// [`SupportKind::Detail`], Q8.
    pub(super) fn mean_q8(&self) -> i16 {
        if self.windows == 0 {
            return TYPICAL_DETAIL_Q8;
        }
        narrow(log2_mean_q8(self.changes, self.windows)).clamp(LEAST_DETAIL_Q8, MOST_DETAIL_Q8)
    }
}

/// log2(1 + value), Q8.
fn log2_q8(value: u8) -> i32 {
    log2_mean_q8(value.into(), 1)
}

impl Found {
    /// The best of the costs in this range of indices, where the window lies on valid pixels; `None` where the paths' minimum lies outside of it,
    /// or is not unique.
    pub(super) fn new(costs: PointCosts<'_>, range: Range<usize>, changes: u8) -> Option<Self> {
        let PointCosts { costs, sums, lowest } = costs;
        let best = place_of_byte(sums, lowest)?;
        if best == 0 {
            return None; // the largest disparity: the minimum may lie beyond
        }
        let ratio_q8 = |best: u8, second: u8| log2_q8(best) - log2_q8(second);
        let paths_q8 = ratio_q8(lowest, second_best(sums, best));
        if paths_q8 > -LEAST_UNIQUE_Q8 {
            return None;
        }
        let at = best.checked_sub(range.start)?;
        let costs = costs.get_mut(range)?;
        let cost = |at: usize| costs.get(at).map(|cost| cost.saturating_sub(JUMP_PENALTY));
        let (before, here, after) = (at.checked_sub(1).and_then(cost), cost(at)?, cost(at + 1));
        let [one, other] = [before, after].map(|side| u16::from(side.unwrap_or(here)));
        let curvature = (one + other).saturating_sub(2 * u16::from(here)).min(u8::MAX.into()) as u8;
        let beside = |distance: i32| match distance {
            -1 => before,
            0 => Some(here),
            _ => after,
        };
        let at_q6 = (best << 6) as i32 + subpixel_q6(0, |distance| beside(distance).map(u16::from));
        let length = costs.len() as u32;
        let second = second_best(costs, at).saturating_sub(JUMP_PENALTY);
        let depth = before.unwrap_or(u8::MAX).min(after.unwrap_or(u8::MAX)).saturating_sub(here);
        if depth >= LEAST_DEPTH && second <= here {
            return None; // the pattern repeats: paths would propagate one of its disparities
        }
        let window_q8 = ratio_q8(here, second);

        let mut evidence = SupportEvidence::new();
        evidence.set(SupportKind::PathsRatio, paths_q8);
        evidence.set(SupportKind::WindowRatio, window_q8);
        evidence.set(SupportKind::WindowCost, log2_q8(here));
        evidence.set(SupportKind::Range, log2_mean_q8(length, 1));
        evidence.set(SupportKind::Curvature, log2_q8(curvature));
        evidence.set(SupportKind::Changes, log2_q8(changes));
        evidence.set(SupportKind::PathsRatioSquared, (paths_q8 * paths_q8) >> 8);
        evidence.set(SupportKind::WindowRatioSquared, (window_q8 * window_q8) >> 8);
        // Uniqueness of the window, not of the paths alone: these propagate the disparity of one repetition along a row.
        Some(Self { at_q6, uniqueness_q8: (-paths_q8).min(-window_q8).clamp(0, 255) as u8, evidence })
    }
}

/// Evidence by neighbours and segments, known when everything is matched; entries one after the other.
const NEARBY: [SupportKind; 5] = [
    SupportKind::Agreeing,
    SupportKind::Conflicting,
    SupportKind::SegmentsAgreeing,
    SupportKind::SegmentsConflicting,
    SupportKind::Detail,
];

impl SupportEvidence {
    pub(super) fn with_nearby(mut self, nearby_q8: [i16; 5]) -> Self {
        for (kind, value) in NEARBY.into_iter().zip(nearby_q8) {
            self.set(kind, value.into());
        }
        self
    }
}

/// Log-odds of the evidence by neighbours and segments by a model, Q8.
pub(super) fn nearby_score_q8(nearby_q8: [i16; 5], model: &Model<SUPPORT_EVIDENCE>) -> i32 {
    model.part_q8(NEARBY[0] as usize, &nearby_q8)
}

/// Evidence by the eight points around the one at `index`, in rows of `columns` points, and by segments, Q8.
pub(super) fn nearby(points: &[SupportPoint], columns: usize, detail_q8: i16, index: usize) -> [i16; 5] {
    let Some(own) = points.get(index).filter(|point| point.is_matched()) else { return [0; 5] };
    let column = index - index.checked_div(columns).unwrap_or(0) * columns;
    let first = column.saturating_sub(1);
    let (width, start) = ((column + 2).min(columns) - first, index + first - column);
    let near = |start: usize| points.get(start..start.wrapping_add(width)).unwrap_or(&[]);
    let lowest = i32::from(own.disparity_q6) - AGREES_Q6;
    let (mut agreeing, mut all) = (0_u32, 0_u32);
    let mut add = |row: &[SupportPoint]| {
        for point in row {
            // 0 without a disparity.
            let weight = u32::from(point.uniqueness_q8);
            all += weight;
            if (i32::from(point.disparity_q6) - lowest) as u32 <= 2 * AGREES_Q6 as u32 {
                agreeing += weight;
            }
        }
    };
    add(near(start.wrapping_sub(columns)));
    add(near(start));
    add(near(start + columns));
    let log2_q8 = |sum: u32| i16::try_from(log2_mean_q8(sum, 256)).unwrap_or(0);
    let [supporting, conflicting] = own.segments.map(|sum| i16::try_from(log2_mean_q8(sum.into(), 16)).unwrap_or(0));
    [
        log2_q8(agreeing.saturating_sub(own.uniqueness_q8.into())),
        log2_q8(all - agreeing),
        supporting,
        conflicting,
        detail_q8,
    ]
}
