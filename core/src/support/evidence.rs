//! The evidence for a support point's disparity: plain numbers in Q8 that a linear model weighs.
//!
//! In: the costs of a point along the disparities, later its neighbours. Out: one signed 16-bit
//! number per kind, +-128 with a step of 1/256.
//!
//! # Cost
//! Three passes over the costs of a point, some 600 instructions at 64 disparities; its eight
//! neighbours another 250.

use super::SupportPoint;
use super::grid::Grid;
use super::paths::{PLANE_LABELS as LABELS, PointCosts};
use super::plane::PlaneLabel;
use crate::confidence::Model;
use crate::curve::subpixel_q6;
use crate::evidence::{define_evidence, log2_mean_q8};
use crate::ground::GroundPlane;
use crate::kernel::{JUMP_PENALTY, lowest_byte, place_of_byte};
use crate::units::narrow;
use core::ops::Range;

/// Disparities on both sides of the best that the second-best leaves out.
const NEIGHBOURHOOD: usize = 2;
/// Least uniqueness of a point, log2(second-best / best) of the paths' sum, Q8: 4 %. With less, a
/// pattern repeats or there is none.
const LEAST_UNIQUE_Q8: i32 = 16;
/// [`SupportKind::Detail`] where no window was evaluated, Q8.
pub(crate) const TYPICAL_DETAIL_Q8: i16 = 2500;
/// Least value of [`SupportKind::Detail`] that models were fitted on, Q8; smaller ones are limited
/// to it.
const LEAST_DETAIL_Q8: i16 = 1800;
/// Largest value of [`SupportKind::Detail`] that models were fitted on, Q8; larger ones are limited
/// to it.
const MOST_DETAIL_Q8: i16 = 3000;
/// Least increase of the window's cost 1 px to either side for an equal cost elsewhere to be a
/// repetition, and not a blank wall.
const LEAST_INCREASE: u8 = 4;
/// Largest difference between the disparities of neighbours that agree, 1/64 px.
const AGREES_Q6: i32 = 96;
/// Largest distance from the ground plane of a point that may be of it, 1/64 px.
pub(super) const NEAR_PLANE_Q6: i32 = 96;

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
    Changes: "log2(1 + how much codes change along the window)",
    PathsRatioSquared: "square of the first",
    OnPlane: "label beside the ground plane",
    NearPlane: "at most 1.5 px off the ground plane",
    BelowPlane: "farther than the ground plane by more",
    HalfSize: "log-odds of the answer at half of the size",
    Moved: "|answer - that at half of the size|, px",
    Agreeing: "log2(1 + neighbours that agree)",
    Conflicting: "log2(1 + neighbours that contradict)",
    SegmentsAgreeing: "log2(1 + hypotheses of segments nearby that agree)",
    SegmentsConflicting: "log2(1 + hypotheses of segments nearby that contradict)",
    Detail: "log2(1 + how much codes change along a window, on average); 0 in large images",
}

/// Labels of a point: disparities, and behind one that never matches those beside the ground plane.
pub(super) struct Labels {
    /// Indices of the disparities with the window on valid pixels.
    pub(super) range: Range<usize>,
    /// Number of disparities.
    pub(super) disparities: usize,
    /// Disparity of the first, px.
    pub(super) last: i32,
    /// Labels beside the plane, and the first of them with the window on valid pixels.
    pub(super) beside: Option<(PlaneLabel, usize)>,
}

impl Labels {
    /// The index of the same disparity among the labels of the other kind.
    fn twin(&self, index: usize) -> Option<usize> {
        let (beside, _) = self.beside?;
        let first = self.disparities + 1;
        let disparity_of = |index: usize| match index.checked_sub(first) {
            Some(at) => beside.disparity - at as i32,
            None => self.last - index as i32,
        };
        let disparity = disparity_of(index);
        if index < first {
            usize::try_from(beside.disparity - disparity)
                .ok()
                .filter(|&at| at < LABELS)
                .map(|at| first + at)
        } else {
            usize::try_from(self.last - disparity).ok().filter(|&at| at < self.disparities)
        }
    }
}

/// Disparity of a point, with its evidence.
pub(super) struct Found {
    /// Disparity at the point's place in the grid, 1/64 px.
    pub(super) disparity_q6: i32,
    /// True when it is a label beside the ground plane.
    pub(super) is_on_plane: bool,
    pub(super) uniqueness_q8: u8,
    pub(super) evidence: SupportEvidence,
}

/// Lowest cost outside of the neighbourhood of `at`; overwrites that neighbourhood with the largest
/// cost.
fn second_best(costs: &mut [u8], at: usize) -> u8 {
    mask(costs, at);
    lowest_byte(costs)
}

/// Overwrites the neighbourhood of `at` with the largest cost.
fn mask(costs: &mut [u8], at: usize) {
    let end = (at + NEIGHBOURHOOD + 1).min(costs.len());
    if let Some(near) = costs.get_mut(at.saturating_sub(NEIGHBOURHOOD)..end) {
        match near.first_chunk_mut() {
            Some(whole) => *whole = [u8::MAX; 2 * NEIGHBOURHOOD + 1], // two stores, not a call
            None => fill_part(near),
        }
    }
}

/// Masks a neighbourhood that ends with the range.
#[inline(never)] // otherwise the compiler makes one call of this and of the two stores
fn fill_part(near: &mut [u8]) {
    near.fill(u8::MAX);
}

/// Changes of codes, summed over the windows of an image.
#[derive(Default)]
pub(super) struct Detail {
    steps: u32,
    windows: i32,
}

impl Detail {
    pub(super) fn add(&mut self, steps: u16) {
        self.steps += u32::from(steps);
        self.windows += 1;
    }

    /// Adds the sums over other windows.
    pub(super) fn merge(&mut self, other: &Self) {
        self.steps += other.steps;
        self.windows += other.windows;
    }

    /// [`SupportKind::Detail`], Q8.
    pub(super) fn mean_q8(&self) -> i16 {
        if self.windows == 0 {
            return TYPICAL_DETAIL_Q8;
        }
        narrow(log2_mean_q8(self.steps, self.windows)).clamp(LEAST_DETAIL_Q8, MOST_DETAIL_Q8)
    }
}

/// log2(1 + value), Q8.
pub(super) fn log2_q8(value: u8) -> i32 {
    log2_mean_q8(value.into(), 1)
}

/// Why a point has no disparity.
pub(super) enum Unmatched {
    /// The paths' minimum lies at the end of the range, or is not unique.
    Unclear,
    /// The window matches elsewhere as well: paths would propagate one of the disparities of a
    /// pattern.
    Repeats,
}

/// Costs of a window at its best disparity, and above that beside it.
struct Increase {
    /// The cost there.
    here: u8,
    /// 1 px to either side, the smaller.
    one: u8,
    /// Up to 2 px to either side, the smaller: half way between two disparities both cost the same.
    two: u8,
}

impl Increase {
    /// From the costs 2 and 1 px before, and 1 and 2 px behind it. Where there is none, a cost 2 px
    /// away is 0, and one 1 px away the largest.
    fn of(here: u8, [two_before, before, after, two_after]: [u8; 4]) -> Self {
        let smaller = |one: u8, other: u8| one.min(other).saturating_sub(here);
        Self {
            here,
            one: smaller(before, after),
            two: smaller(before.max(two_before), after.max(two_after)),
        }
    }

    /// The largest cost elsewhere with which the window's pattern repeats; `None` on a blank wall,
    /// which is alike everywhere.
    fn most_of_repetition(&self) -> Option<u8> {
        let of_one = if self.one >= LEAST_INCREASE { self.one / 2 } else { 0 };
        let of_two = if self.two >= 2 * LEAST_INCREASE { self.two / 8 } else { 0 };
        Some(of_one.max(of_two)).filter(|&most| most > 0).map(|most| self.here.saturating_add(most))
    }
}

impl Found {
    /// The best of the costs in this range of indices, where the window lies on valid pixels.
    ///
    /// Where the border of the right image cuts the range off, the pattern may repeat at larger
    /// disparities. `costs_in_left` gives the window's costs in its own image from so many pixels
    /// to the right on, and their number.
    pub(super) fn new(
        costs: PointCosts<'_>,
        labels: &Labels,
        steps: u16,
        costs_in_left: impl FnOnce(usize, &mut [u8]) -> usize,
    ) -> Result<Self, Unmatched> {
        let PointCosts { costs, sums, lowest } = costs;
        let best = place_of_byte(sums, lowest).ok_or(Unmatched::Unclear)?;
        let ratio_q8 = |best: u8, second: u8| log2_q8(best) - log2_q8(second);
        let twin = labels.twin(best);
        if let Some(twin) = twin {
            mask(sums, twin);
        }
        let paths_q8 = ratio_q8(lowest, second_best(sums, best));
        if paths_q8 > -LEAST_UNIQUE_Q8 {
            return Err(Unmatched::Unclear);
        }
        let (disparities, beside) =
            costs.split_at_mut_checked(labels.disparities).ok_or(Unmatched::Unclear)?;
        let (beside_label, first) = labels.beside.unzip();
        let first = labels.disparities + 1 + first.unwrap_or(0);
        let is_on_plane = best > labels.disparities;
        // Costs of the kind of the best label, where windows lie on valid pixels, and of the other
        // kind.
        let (cut_off, in_range) =
            disparities.split_at_mut_checked(labels.range.start).ok_or(Unmatched::Unclear)?;
        let in_range = in_range.get_mut(..labels.range.len()).ok_or(Unmatched::Unclear)?;
        let end = (labels.disparities + 1 + LABELS).min(labels.disparities + beside.len());
        let on_plane =
            beside.get_mut(first - labels.disparities..end - labels.disparities).unwrap_or(&mut []);
        let start = if is_on_plane { first } else { labels.range.start };
        let other_start = if is_on_plane { labels.range.start } else { first };
        let (costs, others) = if is_on_plane { (on_plane, in_range) } else { (in_range, on_plane) };
        // At the largest disparity compared the minimum may lie beyond.
        let is_inside = |at: &usize| *at > 0 && (!is_on_plane || at + 1 < costs.len());
        let at = best.checked_sub(start).filter(is_inside).ok_or(Unmatched::Unclear)?;
        let cost = |at: usize| costs.get(at).map(|cost| cost.saturating_sub(JUMP_PENALTY));
        let [before, here] = [at.wrapping_sub(1), at].map(|at| cost(at).unwrap_or(u8::MAX));
        let after = cost(at + 1);
        let [two_before, two_after] =
            [at.wrapping_sub(2), at + 2].map(|at| cost(at).unwrap_or_default());
        let increase =
            Increase::of(here, [two_before, before, after.unwrap_or(u8::MAX), two_after]);
        let both = u16::from(before) + u16::from(after.unwrap_or(here));
        let curvature = both.saturating_sub(2 * u16::from(here)).min(u8::MAX.into()) as u8;
        let beside = |distance: i32| match distance {
            -1 => Some(before),
            0 => Some(here),
            _ => after,
        };
        let sub_q6 = subpixel_q6(0, |distance| beside(distance).map(u16::from));
        let whole = match beside_label.filter(|_| is_on_plane) {
            Some(label) => label.at_zero_q6 - ((best - labels.disparities - 1) << 6) as i32,
            None => (labels.last - best as i32) << 6,
        };
        let disparity_q6 = whole - sub_q6;
        let length = labels.range.len() as u32;
        if let Some(twin) = twin.and_then(|twin| twin.checked_sub(other_start)) {
            mask(others, twin);
        }
        let second = second_best(costs, at);
        let second = if others.is_empty() { second } else { second.min(lowest_byte(others)) }
            .saturating_sub(JUMP_PENALTY);
        if let Some(most) = increase.most_of_repetition() {
            // Where nothing repeats in the range, the left image itself tells whether something
            // does where it is cut off.
            let is_whole = second <= most || is_on_plane || cut_off.is_empty();
            let length = if is_whole { 0 } else { costs_in_left(at + 1, cut_off) };
            let in_left = cut_off.get(..length).filter(|costs| !costs.is_empty()).map(lowest_byte);
            if second <= most
                || in_left.is_some_and(|cost| cost.saturating_sub(JUMP_PENALTY) <= most)
            {
                return Err(Unmatched::Repeats);
            }
        }
        let window_q8 = ratio_q8(here, second);

        let mut evidence = SupportEvidence::new();
        evidence.set(SupportKind::PathsRatio, paths_q8);
        evidence.set(SupportKind::WindowRatio, window_q8);
        evidence.set(SupportKind::WindowCost, log2_q8(here));
        evidence.set(SupportKind::Range, log2_mean_q8(length, 1));
        evidence.set(SupportKind::Curvature, log2_q8(curvature));
        evidence.set(SupportKind::Changes, log2_mean_q8(steps.into(), 1));
        evidence.set(SupportKind::PathsRatioSquared, (paths_q8 * paths_q8) >> 8);
        // Uniqueness of the window, not of the paths alone: these propagate the disparity of one
        // repetition along a row.
        if let Some(label) = beside_label {
            // The plane at the point's place in the grid: the label of the plane itself.
            evidence.set_plane(is_on_plane, disparity_q6 - label.plane_q6);
        }
        Ok(Self {
            disparity_q6,
            is_on_plane,
            uniqueness_q8: (-paths_q8).min(-window_q8).clamp(0, 255) as u8,
            evidence,
        })
    }
}

impl SupportEvidence {
    /// Sets the evidence by the ground plane, of a disparity so far above the plane's.
    #[inline]
    pub(super) fn set_plane(&mut self, is_on_plane: bool, above_q6: i32) {
        let mut set = |kind, is: bool| self.set(kind, i32::from(is) << 8);
        set(SupportKind::OnPlane, is_on_plane);
        set(SupportKind::NearPlane, above_q6.abs() <= NEAR_PLANE_Q6);
        set(SupportKind::BelowPlane, above_q6 < -NEAR_PLANE_Q6);
    }
}

/// First kind of the evidence by neighbours and segments, known when everything is matched.
pub(super) const NEARBY: SupportKind = SupportKind::Agreeing;

/// Log-odds of the evidence by neighbours and segments by a model, Q8.
pub(super) fn nearby_score_q8(nearby_q8: [i16; 5], model: &Model<SUPPORT_EVIDENCE>) -> i32 {
    model.part_q8(NEARBY as usize, &nearby_q8)
}

/// Weights of these three rows of points that agree with a disparity, and of all; `change_q6` gives
/// how much the disparity of a point differs by its place, from its row and index.
fn weights(
    near: [&[SupportPoint]; 3],
    d_q6: i32,
    change_q6: impl Fn(&SupportPoint, i32, usize) -> i32,
) -> (u32, u32) {
    let (mut agreeing, mut all) = (0, 0);
    for (points, row) in near.into_iter().zip(0..) {
        for (at, point) in points.iter().enumerate() {
            // 0 without a disparity.
            let weight = u32::from(point.uniqueness_q8);
            all += weight;
            let off_q6 = i32::from(point.disparity_q6) - change_q6(point, row, at) - d_q6;
            if off_q6.abs() <= AGREES_Q6 {
                agreeing += weight;
            }
        }
    }
    (agreeing, all)
}

/// [`weights`] where the disparities of points are compared as they are.
fn plain_weights(near: [&[SupportPoint]; 3], d_q6: i32) -> (u32, u32) {
    let (mut agreeing, mut all) = (0, 0);
    let mut add = |point: &SupportPoint| {
        let weight = u32::from(point.uniqueness_q8);
        all += weight;
        // Within the limit of either sign.
        let above = i32::from(point.disparity_q6) - (d_q6 - AGREES_Q6);
        if above.cast_unsigned() <= 2 * AGREES_Q6.cast_unsigned() {
            agreeing += weight;
        }
    };
    for points in near {
        match points {
            // Most often: a loop of three is not unrolled where code is to be small.
            [a, b, c] => {
                add(a);
                add(b);
                add(c);
            }
            points => points.iter().for_each(&mut add),
        }
    }
    (agreeing, all)
}

/// The points of the row above, the same row and the row below, from the column before the one at
/// `index` to the column after it; how many columns before it they begin.
#[inline(always)] // in the loop over all points
pub(super) fn around(
    points: &[SupportPoint],
    grid: Grid,
    index: usize,
) -> ([&[SupportPoint]; 3], i32) {
    let columns = grid.columns;
    let row = index.checked_div(columns).unwrap_or(0);
    let column = index - row * columns;
    let before = column.min(1);
    let (width, start) = ((column + 2).min(columns) + before - column, index - before);
    let row = |start: usize| points.get(start..start.wrapping_add(width)).unwrap_or(&[]);
    let near = [row(start.wrapping_sub(columns)), row(start), row(start.wrapping_add(columns))];
    (near, before as i32)
}

/// Evidence by the eight points around the one at `index`, and by segments, Q8.
pub(super) fn nearby(
    points: &[SupportPoint],
    grid: Grid,
    detail_q8: i16,
    plane: Option<GroundPlane>,
    index: usize,
) -> [i16; 5] {
    let Some(own) = points.get(index).filter(|point| point.is_matched()) else { return [0; 5] };
    let (near, before) = around(points, grid, index);
    let d_q6 = i32::from(own.disparity_q6);
    let (agreeing, all) = match plane.filter(|_| own.place.is_on_plane()) {
        None => plain_weights(near, d_q6),
        // Beside the plane neighbours agree along it.
        Some(plane) => weights(near, d_q6, |point, row, at| {
            grid.change_q6(plane, [own.place, point.place], (at as i32 - before, row - 1))
        }),
    };
    let log2_q8 = |sum: u32| i16::try_from(log2_mean_q8(sum, 256)).unwrap_or(0);
    // Among large pairs detail tells roads from rooms, not right from wrong.
    let detail_q8 = if grid.is_fine() { 0 } else { detail_q8 };
    let [supporting, conflicting] =
        own.segments.map(|sum| i16::try_from(log2_mean_q8(sum.into(), 16)).unwrap_or(0));
    [
        log2_q8(agreeing.saturating_sub(own.uniqueness_q8.into())),
        log2_q8(all - agreeing),
        supporting,
        conflicting,
        detail_q8,
    ]
}
