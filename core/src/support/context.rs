//! The probability with which a point is listed, by what the points around it are.
//!
//! In: the grid of a run, each point with its log-odds. Out: evidence for a network, since little
//! of it means anything without the rest, and a probability.
//!
//! Stages that read the grid itself keep to the probability by the point's own evidence: of damaged
//! pairs more objects are wrong where this one weighs them.
//!
//! # Cost
//! Some 1700 instructions a point on a Cortex-M7.

use super::{Grid, SUPPORT_PITCH, Support, SupportPoint};
use crate::confidence::{MOST_EVIDENCE_Q8, Network};
use crate::evidence::{define_evidence, log2_mean_q8};
use crate::ground::GroundPlane;

define_evidence! {
    /// Kinds of evidence for a support point among rated neighbours.
    ContextKind;
    /// One number per [`ContextKind`], Q8.
    ContextEvidence;
    CONTEXT_EVIDENCE;
    Score: "log-odds by its own evidence and that of its neighbours",
    Agreeing: "weight of the neighbours that agree",
    Nearer: "weight of those that are nearer",
    Farther: "weight of those that are farther",
    Unmatched: "neighbours without a disparity",
    Between: "the lesser weight of two that agree on opposite sides, the largest",
    Slope: "the same of two whose mean agrees",
    Uniqueness: "uniqueness of the paths' sum and of the window, the smaller",
    Disparity: "log2(1 + disparity)",
    Detail: "log2(1 + how much codes change along a window, on average)",
    UniqueAgreeing: "log2(1 + unique neighbours that agree)",
    UniqueConflicting: "log2(1 + unique neighbours that contradict)",
    SegmentsAgreeing: "log2(1 + hypotheses of segments nearby that agree)",
    SegmentsConflicting: "log2(1 + hypotheses of segments nearby that contradict)",
    HasPlane: "a pair with a ground plane",
    OnPlane: "label beside the ground plane",
    WideAgreeing: "weight of the points two columns or rows away that agree",
    WideNearer: "weight of these that are nearer",
    WideFarther: "weight of these that are farther",
    WideBetween: "the lesser weight of two of these that agree on opposite sides, the largest",
    WideSlope: "the same of two whose mean agrees",
}

/// Columns and rows of points around one that say what it is.
const REACH: isize = 2;
/// Points within these, itself included, row by row.
const AROUND: usize = 25;
/// The first of each two places on opposite sides, next to the point; the other is as far from the
/// end of the list.
const NEAR: [usize; 4] = [6, 7, 8, 11];
/// The same two columns or rows away.
const WIDE: [usize; 8] = [0, 1, 2, 3, 4, 5, 9, 10];

/// Log-odds from which a neighbour has a weight, Q8.
const LEAST_SCORE_Q8: i32 = -2 << 8;
/// Log-odds above that at which the weight is 1, Q8.
const MOST_SCORE_Q8: i32 = 8 << 8;
/// Largest difference of two disparities that agree, 1/64 px.
const AGREES_Q6: i32 = 64;
/// The same of the mean of two on opposite sides, doubled.
const MEAN_AGREES_Q6: i32 = 96;
/// Largest difference of the two.
const MOST_SLOPE_Q6: i32 = 256;

impl Support<'_> {
    /// Probability with which the point at `index` is listed, Q16.
    pub(crate) fn listed_q16(&self, index: usize, network: &Network<CONTEXT_EVIDENCE>) -> u16 {
        let own = |point: &SupportPoint| point.probability_q16;
        let is_own = |point: &&SupportPoint| self.is_fine() || point.is_of_bar();
        let rated = self.points.get(index).filter(is_own).map(own);
        let among = || self.context(index).map(|context| network.probability_q16(&context.0));
        rated.or_else(among).unwrap_or(0)
    }

    /// The evidence of the point at `index` among its neighbours, once all are rated; `None`
    /// without a disparity.
    #[must_use]
    pub fn context(&self, index: usize) -> Option<ContextEvidence> {
        ContextEvidence::of(self.points, self.grid, (self.detail_q8, self.plane), index)
    }
}

/// One neighbour: how much farther it is than the point, 1/64 px, and its weight, Q8.
#[derive(Clone, Copy)]
struct Neighbour {
    off_q6: i32,
    weight_q8: i32,
}

impl Neighbour {
    fn agrees(self) -> bool {
        self.off_q6.abs() <= AGREES_Q6
    }
}

/// Sums over neighbours.
#[derive(Default)]
struct Sums {
    /// Weights of those that agree, are nearer, and are farther, Q8.
    weights_q8: [i32; 3],
    /// Uniqueness of those that agree and of the others, Q8.
    unique_q8: [u32; 2],
    matched: i32,
}

impl Sums {
    fn add(&mut self, neighbour: Neighbour, uniqueness_q8: u8) {
        let kind = match neighbour.off_q6 {
            _ if neighbour.agrees() => 0,
            0.. => 1,
            _ => 2,
        };
        if let Some(sum) = self.weights_q8.get_mut(kind) {
            *sum += neighbour.weight_q8;
        }
        if let Some(sum) = self.unique_q8.get_mut(kind.min(1)) {
            *sum += u32::from(uniqueness_q8);
        }
        self.matched += 1;
    }
}

impl ContextEvidence {
    /// The evidence of the point at `index`, if it has a disparity.
    pub(super) fn of(
        points: &[SupportPoint],
        grid: Grid,
        (detail_q8, plane): (i16, Option<GroundPlane>),
        index: usize,
    ) -> Option<Self> {
        let own = points.get(index).filter(|point| point.is_matched())?;
        let row = index.checked_div(grid.columns)?;
        let column = index - row * grid.columns;
        let along = plane.filter(|_| own.place.is_on_plane());
        let (mut all, [mut near, mut wide]) = ([None; AROUND], <[Sums; 2]>::default());
        let offsets = (-REACH..=REACH).flat_map(|dy| (-REACH..=REACH).map(move |dx| (dx, dy)));
        for (place, (dx, dy)) in all.iter_mut().zip(offsets) {
            let column = column.checked_add_signed(dx).filter(|&column| column < grid.columns);
            let other = column.zip(row.checked_add_signed(dy)).and_then(|(column, row)| {
                points.get(row * grid.columns + column).filter(|other| other.is_matched())
            });
            let (Some(other), false) = (other, (dx, dy) == (0, 0)) else { continue };
            let change_q6 = along.map_or(0, |plane| {
                let across = grid.across(dx as i32) + other.place.dx() - own.place.dx();
                let down = dy as i32 * i32::from(SUPPORT_PITCH) + other.place.dy() - own.place.dy();
                plane.change_q6(across, down)
            });
            let off_q6 = i32::from(other.disparity_q6) - change_q6 - i32::from(own.disparity_q6);
            let score_q8 = i32::from(other.score_q8) - LEAST_SCORE_Q8;
            let neighbour = Neighbour { off_q6, weight_q8: score_q8.clamp(0, MOST_SCORE_Q8) >> 3 };
            let sums = if dx.abs().max(dy.abs()) == 1 { &mut near } else { &mut wide };
            sums.add(neighbour, other.uniqueness_q8);
            *place = Some(neighbour);
        }
        let [between, slope] = opposite(&all, &NEAR);
        let [wide_between, wide_slope] = opposite(&all, &WIDE);
        let disparity_q6 = u32::try_from(own.disparity_q6).unwrap_or(0);
        let [supporting, contradicting] = own.segments.map(|sum| log2_mean_q8(sum.into(), 16));
        let [agreeing, nearer, farther] = near.weights_q8;
        let [wide_agreeing, wide_nearer, wide_farther] = wide.weights_q8;
        let [unique, conflicting] = near.unique_q8.map(|sum| log2_mean_q8(sum, 256));
        let one_if = |is: bool| i32::from(is) << 8;
        let mut evidence = Self::new();
        for (kind, value_q8) in [
            (ContextKind::Score, own.score_q8.into()),
            (ContextKind::Agreeing, agreeing),
            (ContextKind::Nearer, nearer),
            (ContextKind::Farther, farther),
            (ContextKind::Unmatched, (8 - near.matched) << 8),
            (ContextKind::Between, between),
            (ContextKind::Slope, slope),
            (ContextKind::Uniqueness, own.uniqueness_q8.into()),
            (ContextKind::Disparity, log2_mean_q8(disparity_q6, 64)),
            (ContextKind::Detail, detail_q8.into()),
            (ContextKind::UniqueAgreeing, unique),
            (ContextKind::UniqueConflicting, conflicting),
            (ContextKind::SegmentsAgreeing, supporting),
            (ContextKind::SegmentsConflicting, contradicting),
            (ContextKind::HasPlane, one_if(plane.is_some())),
            (ContextKind::OnPlane, one_if(own.place.is_on_plane())),
            (ContextKind::WideAgreeing, wide_agreeing),
            (ContextKind::WideNearer, wide_nearer),
            (ContextKind::WideFarther, wide_farther),
            (ContextKind::WideBetween, wide_between),
            (ContextKind::WideSlope, wide_slope),
        ] {
            evidence.set(kind, value_q8.clamp(-MOST_EVIDENCE_Q8, MOST_EVIDENCE_Q8));
        }
        Some(evidence)
    }
}

/// Of pairs of neighbours on opposite sides, each by the place of its first, the largest lesser
/// weight, Q8: of those that both agree with the point, and of those whose mean does.
fn opposite(all: &[Option<Neighbour>; AROUND], pairs: &[usize]) -> [i32; 2] {
    let (mut between, mut slope) = (0, 0);
    for &first in pairs {
        let at = |place: usize| all.get(place).copied().flatten();
        let (Some(a), Some(b)) = (at(first), at(AROUND - 1 - first)) else { continue };
        let weight_q8 = a.weight_q8.min(b.weight_q8);
        if a.agrees() && b.agrees() {
            between = weight_q8.max(between);
        }
        let (sum, difference) = (a.off_q6 + b.off_q6, a.off_q6 - b.off_q6);
        if sum.abs() <= MEAN_AGREES_Q6 && difference.abs() <= MOST_SLOPE_Q6 {
            slope = weight_q8.max(slope);
        }
    }
    [between, slope]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Dims;
    use crate::params::Params;

    const DIMS: Dims = Dims { width: 24, height: 24 };
    /// The middle of three by three points.
    const MIDDLE: usize = 4;

    fn point(disparity_q6: i16, score_q8: i16) -> SupportPoint {
        SupportPoint { disparity_q6, score_q8, uniqueness_q8: 64, ..SupportPoint::none() }
    }

    /// One kind of evidence of a point.
    fn context(points: &[SupportPoint; 9], index: usize, kind: ContextKind) -> i32 {
        let support = Support::new(&Params::default(), DIMS, points, 700);
        support.context(index).unwrap().get(kind)
    }

    #[test]
    fn neighbours_count_by_their_log_odds() {
        // 2 above the least: a quarter of the whole weight.
        let mut points = [point(640, 0); 9];
        points[0] = point(640 + 65, 6 << 8);
        points[1] = point(640 - 65, -2 << 8);
        points[2] = SupportPoint::none();
        let context = |kind| context(&points, MIDDLE, kind);
        assert_eq!(context(ContextKind::Agreeing), 5 * 64);
        assert_eq!(context(ContextKind::Nearer), 256);
        assert_eq!(context(ContextKind::Farther), 0);
        assert_eq!(context(ContextKind::Unmatched), 256);
        assert_eq!(context(ContextKind::Between), 64);
        assert_eq!(context(ContextKind::Detail), 700);
    }

    #[test]
    fn a_slope_is_the_mean_of_two_opposite_points() {
        let mut points = [SupportPoint::none(); 9];
        points[3] = point(640 - 100, 6 << 8);
        points[MIDDLE] = point(640, 0);
        points[5] = point(640 + 100, 2 << 8);
        assert_eq!(context(&points, MIDDLE, ContextKind::Slope), 128);
        assert_eq!(context(&points, MIDDLE, ContextKind::Between), 0);
        points[5].disparity_q6 += 97;
        assert_eq!(context(&points, MIDDLE, ContextKind::Slope), 0);
    }

    #[test]
    fn points_two_away_count_by_themselves() {
        const WIDE: Dims = Dims { width: 40, height: 40 };
        let mut points = [point(640, -2 << 8); 25];
        let at = |dx: i32, dy: i32| (12 + 5 * dy + dx) as usize;
        for (dx, dy) in [(-2, -2), (2, 2), (1, 2), (-2, 1)] {
            points[at(dx, dy)] = point(640, 6 << 8);
        }
        points[at(2, -1)] = point(640 + 65, 2 << 8);
        points[at(0, -2)] = point(640 - 100, 6 << 8);
        points[at(0, 2)] = point(640 + 100, 0);
        let support = Support::new(&Params::default(), WIDE, &points, 700);
        let context = |index, kind| support.context(index).unwrap().get(kind);
        assert_eq!(context(12, ContextKind::WideAgreeing), 4 * 256);
        assert_eq!(context(12, ContextKind::WideNearer), 128 + 64);
        assert_eq!(context(12, ContextKind::WideFarther), 256);
        assert_eq!(context(12, ContextKind::WideBetween), 256);
        assert_eq!(context(12, ContextKind::WideSlope), 256);
        // Those next to it have no weight, and a corner has none across the border.
        assert_eq!(context(12, ContextKind::Agreeing), 0);
        assert_eq!(context(0, ContextKind::WideAgreeing), 0);
        points[at(2, 2)] = point(640, -2 << 8);
        let support = Support::new(&Params::default(), WIDE, &points, 700);
        let slope = support.context(12).unwrap().get(ContextKind::WideSlope);
        assert_eq!(slope, 128);
    }

    #[test]
    fn points_at_the_border_lack_neighbours() {
        let points = [point(640, 0); 9];
        for (index, lacking) in [(0, 5), (1, 3), (2, 5), (3, 3), (5, 3), (8, 5)] {
            assert_eq!(context(&points, index, ContextKind::Unmatched), lacking << 8, "{index}");
        }
        let mut points = points;
        points[MIDDLE] = SupportPoint::none();
        let support = Support::new(&Params::default(), DIMS, &points, 700);
        assert_eq!(support.context(MIDDLE), None);
    }
}
