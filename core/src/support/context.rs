//! The probability with which a point is listed, by what the points around it are and how alike
//! both images are there.
//!
//! In: the grid of a run, each point with its log-odds, and the pair. Out: evidence for a network,
//! since little of it means anything without the rest, and a probability.
//!
//! Images that are matched at half of their size first have fitted nothing of the network. In these
//! the log-odds are the mean of its own and the point's. `docs/experiments.md` has the figures of
//! both.
//!
//! Stages that read the grid itself keep to the probability by the point's own evidence: of damaged
//! pairs more objects are wrong where this one weighs them.
//!
//! # Cost
//! Some 3900 instructions a point on a Cortex-M7, 700 of them for the network.

use super::{Grid, Likeness, Support, SupportPoint};
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
    Unlike: "log2(1 + deviation of the differences of both images around the listed pixel)",
    Brighter: "log2(1 + their mean difference there)",
    Texture: "log2(1 + deviation of the left image there)",
}

/// Columns and rows of points around one that say what it is. Chosen on `robot_world`, `qvga`,
/// `oakd_agreed_320` and `robot_sequences`; the drives fitted no weight. First 50 and 80 % of the
/// cells, off by more than 1 px with a reach of 1 and 2: `robot_world` 2.9 and 15.3, 2.4 and
/// 14.8 %; a flight 2.3 and 3.9, 1.7 and 2.9 %; a corridor 0.1 and 15.1, 0.3 and 15.1 %. Sets that
/// chose and fitted nothing: `middlebury2003` 0.6 and 1.8 % with both, the pair of `middlebury2001`
/// 0 and 0, 0 and 0.3 %.
const REACH: usize = 2;
/// Points in each row of those within these, itself included.
const SIDE: usize = 2 * REACH + 1;
/// All of them, row by row.
const AROUND: usize = SIDE * SIDE;
/// The first of each two places on opposite sides, next to the point; the other is as far from the
/// end of the list.
const NEAR: [usize; 4] = [6, 7, 8, 11];
/// The same two columns or rows away.
const WIDE: [usize; 8] = [0, 1, 2, 3, 4, 5, 9, 10];
/// Place of the point itself.
const OWN: usize = AROUND / 2;
/// Bits of the places next to it.
const NEXT_TO_IT: u32 = 0b1110 << 5 | 0b1010 << 10 | 0b1110 << 15;

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

/// Rates the points of a grid as they are listed, once all are rated by their own evidence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Listing<'a> {
    pub(crate) support: Support<'a>,
    pub(crate) likeness: Likeness<'a>,
    pub(crate) network: &'a Network<CONTEXT_EVIDENCE>,
}

impl Listing<'_> {
    /// Probability with which the point at `index` is listed at this pixel, Q16.
    pub(crate) fn probability_q16(&self, index: usize, at: (u16, u16)) -> u16 {
        let Some(point) = self.support.points.get(index) else { return 0 };
        let own_q16 = point.probability_q16;
        if point.is_of_bar() {
            return own_q16;
        }
        let Some(ContextEvidence(evidence)) = self.evidence(index, at) else { return 0 };
        if self.support.is_fine() {
            self.network.probability_beside_q16(&evidence, own_q16)
        } else {
            self.network.probability_q16(&evidence)
        }
    }

    /// Its evidence; `None` without a disparity.
    pub(crate) fn evidence(&self, index: usize, at: (u16, u16)) -> Option<ContextEvidence> {
        let Support { grid, detail_q8, plane, points } = self.support;
        let own = points.get(index).filter(|point| point.is_matched())?;
        let along = plane.filter(|_| own.place.is_on_plane());
        let around = Around::of(points, grid, along, index, own);
        let alike = self.likeness.at(at, own.disparity_q6, along);
        Some(ContextEvidence::of(own, &around, alike, detail_q8, plane.is_some()))
    }
}

/// A point around another one; 0 without a disparity.
#[derive(Clone, Copy, Default)]
struct Neighbour {
    /// Its disparity less that of the other, 1/64 px.
    off_q6: i32,
    weight_q8: i32,
}

/// Index of its sum: 0 for a neighbour that agrees, 1 for a nearer one, 2 for a farther one.
fn side(off_q6: i32) -> usize {
    if off_q6.abs() <= AGREES_Q6 { 0 } else { 1 + usize::from(off_q6 < 0) }
}

/// The points around one.
#[derive(Default)]
struct Around {
    all: [Neighbour; AROUND],
    /// Weights of those two columns or rows away, and of those next to it, by [`side`], Q8.
    sums: [[i32; 4]; 2],
    /// Uniqueness of those next to it that agree and of the others, Q8.
    unique_q8: [u32; 2],
    /// Number of those next to it with a disparity.
    matched: i32,
}

impl Around {
    /// Those around a point; beside the ground plane they agree along it.
    fn of(
        points: &[SupportPoint],
        grid: Grid,
        along: Option<GroundPlane>,
        index: usize,
        own: &SupportPoint,
    ) -> Self {
        let mut found = Self::default();
        let row = index.checked_div(grid.columns).unwrap_or(0);
        let column = index - row * grid.columns;
        let (first, end) = (column.saturating_sub(REACH), (column + REACH + 1).min(grid.columns));
        for down in 0..SIDE {
            // Above the grid it wraps to far beyond its end.
            let start = (row + down).wrapping_sub(REACH).wrapping_mul(grid.columns);
            let others = points.get(start.wrapping_add(first)..start.wrapping_add(end));
            let before = first + REACH - column;
            for (other, at) in others.unwrap_or_default().iter().zip(down * SIDE + before..) {
                if !other.is_matched() || at == OWN {
                    continue;
                }
                let change_q6 = along.map_or(0, |plane| {
                    let [dx, dy] = [at - down * SIDE, down].map(|at| at as i32 - REACH as i32);
                    grid.change_q6(plane, [own.place, other.place], (dx, dy))
                });
                let off_q6 =
                    i32::from(other.disparity_q6) - change_q6 - i32::from(own.disparity_q6);
                let score_q8 = i32::from(other.score_q8) - LEAST_SCORE_Q8;
                let weight_q8 = score_q8.clamp(0, MOST_SCORE_Q8) >> 3;
                found.add(at, Neighbour { off_q6, weight_q8 }, other.uniqueness_q8);
            }
        }
        found
    }

    /// Adds the point at a place of [`Around::all`].
    #[inline(always)] // in the loop over all points
    fn add(&mut self, place: usize, one: Neighbour, uniqueness_q8: u8) {
        if let Some(place) = self.all.get_mut(place) {
            *place = one;
        }
        let side = side(one.off_q6);
        let is_near = NEXT_TO_IT >> place & 1;
        if let Some(sum) = self.sums.as_flattened_mut().get_mut(4 * is_near as usize + side) {
            *sum += one.weight_q8;
        }
        if is_near > 0 {
            let [agreeing, others] = &mut self.unique_q8;
            *if side == 0 { agreeing } else { others } += u32::from(uniqueness_q8);
            self.matched += 1;
        }
    }

    /// Of pairs of neighbours on opposite sides, each by the place of its first, the largest lesser
    /// weight, Q8: of those that both agree with the point, and of those whose mean does.
    fn opposite(&self, pairs: &[usize]) -> [i32; 2] {
        let (mut between, mut slope) = (0, 0);
        for &first in pairs {
            let (Some(a), Some(b)) = (self.all.get(first), self.all.get(AROUND - 1 - first)) else {
                continue;
            };
            let weight_q8 = a.weight_q8.min(b.weight_q8);
            if weight_q8 <= between.min(slope) {
                continue; // neither would grow
            }
            if a.off_q6.abs() <= AGREES_Q6 && b.off_q6.abs() <= AGREES_Q6 {
                between = weight_q8.max(between);
            }
            let (sum, difference) = (a.off_q6 + b.off_q6, a.off_q6 - b.off_q6);
            if sum.abs() <= MEAN_AGREES_Q6 && difference.abs() <= MOST_SLOPE_Q6 {
                slope = weight_q8.max(slope);
            }
        }
        [between, slope]
    }
}

impl ContextEvidence {
    /// The evidence of a point among those around it, whose pixel looks like this.
    fn of(
        own: &SupportPoint,
        around: &Around,
        [unlike, brighter, texture]: [i32; 3],
        detail_q8: i16,
        has_plane: bool,
    ) -> Self {
        let [between, slope] = around.opposite(&NEAR);
        let [wide_between, wide_slope] = around.opposite(&WIDE);
        let [[wide_agreeing, wide_nearer, wide_farther, _], [agreeing, nearer, farther, _]] =
            around.sums;
        let disparity_q6 = u32::try_from(own.disparity_q6).unwrap_or(0);
        let [supporting, contradicting] = own.segments.map(|sum| log2_mean_q8(sum.into(), 16));
        let [unique, conflicting] = around.unique_q8.map(|sum| log2_mean_q8(sum, 256));
        let one_if = |is: bool| i32::from(is) << 8;
        let limited =
            |value_q8: i16| i32::from(value_q8).clamp(-MOST_EVIDENCE_Q8, MOST_EVIDENCE_Q8);
        // Others are within the limits of a network by what they are.
        let mut evidence = Self::new();
        let mut set = |kind: ContextKind, value_q8: i32| evidence.set(kind, value_q8);
        set(ContextKind::Score, limited(own.score_q8));
        set(ContextKind::Agreeing, agreeing);
        set(ContextKind::Nearer, nearer);
        set(ContextKind::Farther, farther);
        set(ContextKind::Unmatched, (8 - around.matched) << 8);
        set(ContextKind::Between, between);
        set(ContextKind::Slope, slope);
        set(ContextKind::Uniqueness, own.uniqueness_q8.into());
        set(ContextKind::Disparity, log2_mean_q8(disparity_q6, 64));
        set(ContextKind::Detail, limited(detail_q8));
        set(ContextKind::UniqueAgreeing, unique);
        set(ContextKind::UniqueConflicting, conflicting);
        set(ContextKind::SegmentsAgreeing, supporting);
        set(ContextKind::SegmentsConflicting, contradicting);
        set(ContextKind::HasPlane, one_if(has_plane));
        set(ContextKind::OnPlane, one_if(own.place.is_on_plane()));
        set(ContextKind::WideAgreeing, wide_agreeing);
        set(ContextKind::WideNearer, wide_nearer);
        set(ContextKind::WideFarther, wide_farther);
        set(ContextKind::WideBetween, wide_between);
        set(ContextKind::WideSlope, wide_slope);
        set(ContextKind::Unlike, unlike);
        set(ContextKind::Brighter, brighter);
        set(ContextKind::Texture, texture);
        evidence
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Dims, Gray};
    use crate::params::Params;
    use crate::support::FITTED_SUPPORT;

    const DIMS: Dims = Dims { width: 24, height: 24 };
    /// The middle of three by three points.
    const MIDDLE: usize = 4;

    fn point(disparity_q6: i16, score_q8: i16) -> SupportPoint {
        SupportPoint { disparity_q6, score_q8, uniqueness_q8: 64, ..SupportPoint::none() }
    }

    /// Evidence of a point of blank images.
    fn evidence(
        dims: Dims,
        points: &[SupportPoint],
        index: usize,
        detail_q8: i16,
    ) -> Option<ContextEvidence> {
        let image = Gray::new(&[0; 40 * 40], dims, dims.width.into()).unwrap();
        let listing = Listing {
            support: Support::new(&Params::default(), dims, points, detail_q8),
            likeness: Likeness { images: [image; 2], row_offset: 0, brighter: 0 },
            network: &FITTED_SUPPORT.context,
        };
        listing.evidence(index, (0, 0))
    }

    /// One kind of it.
    fn context(points: &[SupportPoint; 9], index: usize, kind: ContextKind) -> i32 {
        evidence(DIMS, points, index, 700).unwrap().get(kind)
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
        let context = |index, kind| evidence(WIDE, &points, index, 700).unwrap().get(kind);
        assert_eq!(context(12, ContextKind::WideAgreeing), 4 * 256);
        assert_eq!(context(12, ContextKind::WideNearer), 128 + 64);
        assert_eq!(context(12, ContextKind::WideFarther), 256);
        assert_eq!(context(12, ContextKind::WideBetween), 256);
        assert_eq!(context(12, ContextKind::WideSlope), 256);
        // Those next to it have no weight, and a corner has none across the border.
        assert_eq!(context(12, ContextKind::Agreeing), 0);
        assert_eq!(context(0, ContextKind::WideAgreeing), 0);
        points[at(2, 2)] = point(640, -2 << 8);
        let slope = evidence(WIDE, &points, 12, 700).unwrap().get(ContextKind::WideSlope);
        assert_eq!(slope, 128);
    }

    #[test]
    fn all_evidence_is_within_the_limits_of_a_network() {
        const WIDE: Dims = Dims { width: 40, height: 40 };
        for (score_q8, detail_q8) in [(super::super::MOST_Q8, i16::MAX), (i16::MIN + 1, i16::MIN)] {
            let most = SupportPoint {
                uniqueness_q8: u8::MAX,
                segments: [u8::MAX; 2],
                ..point(i16::MAX, score_q8)
            };
            let points = [most; 25];
            let ContextEvidence(evidence) = evidence(WIDE, &points, 12, detail_q8).unwrap();
            assert!(evidence.iter().all(|&value| i32::from(value).abs() <= MOST_EVIDENCE_Q8));
            assert_eq!(evidence[0].abs(), MOST_EVIDENCE_Q8 as i16);
        }
    }

    #[test]
    fn points_at_the_border_lack_neighbours() {
        let points = [point(640, 0); 9];
        for (index, lacking) in [(0, 5), (1, 3), (2, 5), (3, 3), (5, 3), (8, 5)] {
            assert_eq!(context(&points, index, ContextKind::Unmatched), lacking << 8, "{index}");
        }
        let mut points = points;
        points[MIDDLE] = SupportPoint::none();
        assert_eq!(evidence(DIMS, &points, MIDDLE, 700), None);
    }
}
