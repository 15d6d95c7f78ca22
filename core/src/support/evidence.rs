//! The evidence for a support point's disparity: plain numbers in Q8 that a linear model weighs.
//!
//! In: the costs of a point along the disparities, later its neighbours. Out: one signed 16-bit number per kind, +-128 with a step of 1/256.

use super::SupportPoint;
use super::paths::Answer;
use crate::confidence::Model;
use crate::kernel::lowest_byte;
use crate::matching::curve::subpixel_q6;
use crate::matching::evidence::log2_mean_q8;
use core::ops::Range;

/// Disparities on both sides of the best that are not its rivals.
const NEIGHBOURHOOD: usize = 2;
/// Least uniqueness of a point, log2(second-best / best) of the paths' sum, 1/256: 4 %. With less, a pattern repeats or there is none.
const LEAST_UNIQUE_Q8: i32 = 16;
/// Disparities of neighbours that agree differ by at most this, 1/64 px.
const AGREES_Q6: i32 = 96;

/// Kinds of evidence of a support point, in the order of the model's coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum SupportKind {
    /// log2 of the paths' sum: best / second-best.
    PathsRatio,
    /// log2 of the window's cost: at the disparity / best elsewhere.
    WindowRatio,
    /// log2(1 + the window's cost).
    WindowCost,
    /// log2(1 + disparities compared).
    Range,
    /// log2(1 + how much worse the window is 1 px away).
    Curvature,
    /// Square of `PathsRatio`.
    PathsRatioSquared,
    /// Square of `WindowRatio`.
    WindowRatioSquared,
    /// log2(1 + neighbours that agree).
    Agreeing,
    /// log2(1 + neighbours that contradict).
    Conflicting,
    /// log2(1 + claims of segments nearby that agree).
    SegmentsAgreeing,
    /// log2(1 + claims of segments nearby that contradict).
    SegmentsConflicting,
}

impl SupportKind {
    /// Meaning and unit of each entry, in the model's order.
    pub const NAMES: [&'static str; SUPPORT_EVIDENCE] = [
        "log2 of the paths' sum: best / second-best",
        "log2 of the window's cost: at the disparity / best elsewhere",
        "log2(1 + the window's cost)",
        "log2(1 + disparities compared)",
        "log2(1 + how much worse the window is 1 px away)",
        "square of the first",
        "square of the second",
        "log2(1 + neighbours that agree)",
        "log2(1 + neighbours that contradict)",
        "log2(1 + claims of segments nearby that agree)",
        "log2(1 + claims of segments nearby that contradict)",
    ];
}

/// Number of entries.
pub const SUPPORT_EVIDENCE: usize = SupportKind::SegmentsConflicting as usize + 1;

/// One number per [`SupportKind`], Q8.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SupportEvidence(pub [i16; SUPPORT_EVIDENCE]);

impl SupportEvidence {
    fn set(&mut self, kind: SupportKind, value_q8: i32) {
        if let Some(slot) = self.0.get_mut(kind as usize) {
            *slot = i16::try_from(value_q8.clamp(-32767, 32767)).unwrap_or(0);
        }
    }
}

/// The answer of a point, as indices into its costs.
pub(super) struct Found {
    /// Sub-pixel place of the best, 1/64.
    pub(super) at_q6: i32,
    pub(super) sure_q8: u8,
    pub(super) evidence: SupportEvidence,
}

/// The lowest of some costs, and where it stands.
struct Lowest {
    at: usize,
    cost: u8,
}

/// The first lowest of some costs, whose number is a multiple of four.
fn lowest(costs: &[u8]) -> Lowest {
    let cost = lowest_byte(costs);
    let (ones, tops) = (0x0101_0101_u32, 0x8080_8080);
    let zeros = |word: u32| word.wrapping_sub(ones) & !word & tops;
    for (word, at) in costs.as_chunks::<4>().0.iter().zip((0..).step_by(4)) {
        // The lowest marked byte is zero, whatever is marked above it.
        let equal = zeros(u32::from_le_bytes(*word) ^ ones.wrapping_mul(cost.into()));
        if equal != 0 {
            return Lowest { at: at + equal.trailing_zeros() as usize / 8, cost };
        }
    }
    Lowest { at: 0, cost }
}

/// The lowest cost in a range and outside of the neighbourhood of `at`.
fn rival(costs: &[u8], range: &Range<usize>, at: usize) -> u8 {
    let before = range.start..at.saturating_sub(NEIGHBOURHOOD).max(range.start);
    let after = (at + NEIGHBOURHOOD + 1).min(range.end)..range.end;
    let lowest = |range: Range<usize>| lowest_byte(costs.get(range).unwrap_or(&[]));
    lowest(before).min(lowest(after))
}

/// log2(1 + value), Q8.
fn log2_q8(value: u32) -> i32 {
    log2_mean_q8(value, 1)
}

impl Found {
    /// Of the costs in this range of indices, where the window lies on usable pixels; `None` where the paths prefer a place outside
    /// of it, or no place.
    pub(super) fn new(answer: &Answer<'_>, range: Range<usize>) -> Option<Self> {
        let Answer { costs, sums } = *answer;
        let best = lowest(sums);
        if !range.contains(&best.at) {
            return None;
        }
        let second = rival(sums, &(0..sums.len()), best.at);
        let cost = |at: usize| if range.contains(&at) { costs.get(at).copied() } else { None };
        let here = cost(best.at)?;
        let elsewhere = rival(costs, &range, best.at);
        let ratio_q8 = |best: u8, rival: u8| log2_q8(best.into()) - log2_q8(rival.into());
        let paths_q8 = ratio_q8(best.cost, second);
        if paths_q8 > -LEAST_UNIQUE_Q8 {
            return None;
        }
        let window_q8 = ratio_q8(here, elsewhere);
        let sides =
            [best.at.checked_sub(1).and_then(cost), cost(best.at + 1)].map(|side| u32::from(side.unwrap_or(here)));
        let curvature = (sides[0] + sides[1]).saturating_sub(2 * u32::from(here));
        let length = range.len() as i32;

        let mut evidence = SupportEvidence([0; SUPPORT_EVIDENCE]);
        evidence.set(SupportKind::PathsRatio, paths_q8);
        evidence.set(SupportKind::WindowRatio, window_q8);
        evidence.set(SupportKind::WindowCost, log2_q8(here.into()));
        evidence.set(SupportKind::Range, log2_mean_q8(length.unsigned_abs(), 1));
        evidence.set(SupportKind::Curvature, log2_q8(curvature));
        evidence.set(SupportKind::PathsRatioSquared, (paths_q8 * paths_q8) >> 8);
        evidence.set(SupportKind::WindowRatioSquared, (window_q8 * window_q8) >> 8);
        let at = |index: i32| u16::from(usize::try_from(index).ok().and_then(cost)?).into();
        // A point does not pass on what it has heard alone: paths carry one repetition's place all along a row.
        Some(Self {
            at_q6: subpixel_q6(best.at as i32, at),
            sure_q8: (-paths_q8).min(-window_q8).clamp(0, 255) as u8,
            evidence,
        })
    }
}

/// Evidence by neighbours and segments, known when everything is matched.
const HEARD: [SupportKind; 4] =
    [SupportKind::Agreeing, SupportKind::Conflicting, SupportKind::SegmentsAgreeing, SupportKind::SegmentsConflicting];

impl SupportEvidence {
    pub(super) fn with_heard(mut self, heard_q8: [i16; 4]) -> Self {
        for (kind, value) in HEARD.into_iter().zip(heard_q8) {
            self.set(kind, value.into());
        }
        self
    }
}

/// Log-odds of that evidence by a model, Q8.
pub(super) fn heard_score_q8(heard_q8: [i16; 4], model: &Model<SUPPORT_EVIDENCE>) -> i32 {
    model.part_q8(HEARD.into_iter().map(|kind| kind as usize).zip(heard_q8))
}

/// Evidence by the eight points around the one at `place`, in rows of `columns` points, and by segments, Q8.
pub(super) fn heard(points: &[SupportPoint], columns: usize, place: usize) -> [i16; 4] {
    let Some(own) = points.get(place).filter(|point| point.is_matched()) else { return [0; 4] };
    let (mut agreeing, mut conflicting) = (0_u32, 0_u32);
    let column = place - place.checked_div(columns).unwrap_or(0) * columns;
    let first = column.saturating_sub(1);
    let width = (column + 2).min(columns) - first;
    for row in [place.checked_sub(columns), Some(place), place.checked_add(columns)].into_iter().flatten() {
        let start = row + first - column;
        for point in points.get(start..).unwrap_or(&[]).iter().take(width).filter(|point| point.is_matched()) {
            let apart = (i32::from(point.disparity_q6) - i32::from(own.disparity_q6)).abs();
            *(if apart <= AGREES_Q6 { &mut agreeing } else { &mut conflicting }) += u32::from(point.sure_q8);
        }
    }
    agreeing -= u32::from(own.sure_q8).min(agreeing);
    let said = |sum: u32| i16::try_from(log2_mean_q8(sum, 256)).unwrap_or(0);
    let [for_it, against_it] = own.heard.map(|sum| i16::try_from(log2_mean_q8(sum.into(), 16)).unwrap_or(0));
    [said(agreeing), said(conflicting), for_it, against_it]
}
