//! Near-vertical segments: windows shaped by the segment, census along it, and the sides that own
//! its disparity.
//!
//! In: a left segment and the band of rows around it. Out: a candidate with one line of disparity
//! and the evidence of each side that owns it, or the test that it fails.
//!
//! ```text
//! window:  lower of two one-sided windows (edge and left side, edge and right side), over every
//!          disparity; has to be unique
//! census:  Hamming distances at points beside the edge, lower side; has to be unique and within
//!          the margin of the window
//! halves:  a disparity for each half gives the line of disparity along the segment
//! feature: the edge in the right image, near the window's disparity
//! owners:  sides whose own window, edge left out, is unique at this disparity; a strip narrower
//!          than that has both of its edges in the right image
//! ```
//!
//! # Bounds
//! Gradients differ by at most 62, so a strip costs at most 8 * 62 a row; two rows a half, two
//! halves, two strips: sums stay below 2^12. All other numbers are disparities in 1/64 px (below
//! 2^15) and ratios in Q8 (at most 768).
//!
//! # Cost
//! 12 strips and 16 points of census over the disparities, some 20 passes over a curve: 24 000
//! instructions at 64 disparities, whatever the length.

use super::aggregate::join_sides;
use super::band::{Band, SampledRows};
use super::{
    Candidate, MAX_CENSUS_RATIO_Q8, MAX_SIDE_RATIO_Q8, MAX_SLANT_Q6, MAX_WINDOW_RATIO_Q8,
    MatchContext, Workspace, feature, repetition,
};
use crate::curve::{Curve, Minimum, minimum_near, ratio_q8, subpixel_q6};
use crate::evidence::{SegmentEvidence, SegmentKind, log2_mean_q8};
use crate::kernel::{Strip, hamming_curve, sad_curve};
use crate::lines::{Line, Segment};
use crate::result::Rejection;
use crate::units::quotient;
use heapless::Vec;

/// Most rows of a half's window: adjacent rows are nearly redundant (leave one out: no change in
/// any score against twice as many).
const HALF_ROWS: i32 = 2;
/// Most rows of a census column, likewise.
const CENSUS_ROWS: i32 = 4;
/// First column of the three strips of eight, relative to the edge: the left side, the edge itself,
/// the right side.
const STRIP_COLUMNS: [i32; 3] = [-9, -4, 2];
/// Distance between the centres of the two sides' strips, px.
const SIDES_APART: i32 = 11;
/// Columns of the census points of each side, relative to the edge.
const CENSUS_COLUMNS: [[i32; 2]; 2] = [[-5, -2], [2, 5]];
/// [`SegmentKind::EdgeRatio`] up to which the edge's own strip places it, Q8.
const UNIQUE_EDGE_Q8: i32 = 64;
/// Search range of a half around the whole segment's disparity, px.
const HALF_REACH: i32 = 4;

/// The segment on whole pixels.
struct Extent {
    line: Line,
    /// First and last row.
    rows: (i32, i32),
    /// Smallest and largest column of the line.
    columns: (i32, i32),
}

/// Window curves of the upper and lower half and of both, for each of the three strips.
struct Windows<'w> {
    halves: [[&'w mut Curve; 3]; 2],
    whole: [&'w mut Curve; 3],
    /// Rows that were summed.
    rows: i32,
    /// Mean row of each half, in half rows.
    centres_q1: [i32; 2],
}

/// Match of the whole segment's window.
struct WindowMatch {
    best: Minimum,
    ratio_q8: i32,
    disparity_q6: i32,
}

/// Match of census.
struct CensusMatch {
    points: i32,
    cost: u16,
    ratio_q8: i32,
    disparity_q6: i32,
}

/// Match of one side's own window, edge left out, near the accepted disparity.
struct Ownership {
    cost: u16,
    second_best: u16,
    ratio_q8: i32,
    /// Disparity of its lowest cost, px.
    preferred: i32,
    disparity_q6: i32,
}

/// Matches one segment, or returns the test that it fails.
pub(crate) fn match_near_vertical(
    segment: &Segment,
    context: &MatchContext<'_>,
    band: &Band<'_>,
    work: &mut Workspace,
) -> Result<Candidate, Rejection> {
    let [a, b, c, d, e, f, g, h, i, joint, census_left, census_right] = &mut work.curves;
    let extent = Extent::new(segment);
    let mut windows =
        Windows { halves: [[a, b, c], [d, e, f]], whole: [g, h, i], rows: 0, centres_q1: [0; 2] };
    let range = context.range_before(extent.columns.0, band.right_columns(extent.middle()))?;
    windows.fill(&extent, range, band)?;
    let window = windows.match_whole(joint)?;
    if context.is_end(window.best.at, range) {
        return Err(Rejection::WindowNotUnique);
    }
    let census = match_census(&extent, range, band, [census_left, census_right], joint)?;
    if !context.agreement.holds(window.disparity_q6, census.disparity_q6) {
        return Err(Rejection::TechniquesDisagree);
    }
    let (upper_q6, lower_q6) = windows.match_halves(window.best.at)?;
    let (slant_q6, middle_q6) = (lower_q6 - upper_q6, (upper_q6 + lower_q6) / 2);
    let feature_q6 = feature::find(&extent.line, segment.rising, (middle_q6 + 32) >> 6, band);

    let count = extent.rows.1 - extent.rows.0 + 1;
    let mut shared = SegmentEvidence::new();
    shared.set(SegmentKind::WindowRatio, window.ratio_q8);
    shared.set(SegmentKind::WindowCost, log2_mean_q8(window.best.cost.into(), windows.rows * 16));
    shared.set(SegmentKind::CensusRatio, census.ratio_q8);
    shared.set(SegmentKind::CensusCost, log2_mean_q8(census.cost.into(), census.points));
    shared.set(SegmentKind::CensusGap, (window.disparity_q6 - census.disparity_q6).abs() << 2);
    shared.set(SegmentKind::Slant, quotient(slant_q6.abs() << 3, count));
    shared.set(SegmentKind::Length, log2_mean_q8(count.unsigned_abs(), 1));
    shared.set(SegmentKind::NoFeature, i32::from(feature_q6.is_none()) << 8);
    shared.set(
        SegmentKind::FeatureGap,
        feature_q6.map_or(0, |feature| (feature - middle_q6).abs().min(128) << 2),
    );
    shared.set(SegmentKind::Lean, extent.line.slope_q12().abs() >> 4);
    shared.set(SegmentKind::Range, log2_mean_q8(windows.range(), 1));
    shared.set(SegmentKind::Detail, context.detail_q8());
    shared.set(SegmentKind::Contrast, log2_mean_q8(segment.contrast.into(), 1));
    shared.set(SegmentKind::EdgeRatio, windows.edge_ratio_q8(window.best.at));

    let line_q6 = windows.line_q6(upper_q6, lower_q6, extent.rows);
    let at = window.best.at;
    let [left, right] = windows.evaluate_sides(at, upper_q6, lower_q6);
    let may_own = |sign: i32| {
        shared.get(SegmentKind::EdgeRatio) <= UNIQUE_EDGE_Q8
            || !feature::lacks_other_edge(&extent.line, segment.rising, sign, line_q6, band)
    };
    let evidence = [
        hypothesis(shared, &left, &right, census_left, at, windows.rows, -256)
            .filter(|_| may_own(-1)),
        hypothesis(shared, &right, &left, census_right, at, windows.rows, 256)
            .filter(|_| may_own(1)),
    ];
    if evidence.iter().all(Option::is_none) {
        return Err(Rejection::NoOwner);
    }
    if repetition::repeats(&extent.line, extent.rows, band, joint) {
        return Err(Rejection::WindowNotUnique);
    }
    let mut sides = work.rate(&evidence, [line_q6; 2], context.models, false);
    join_sides(&mut sides, [left.disparity_q6, right.disparity_q6], SIDES_APART, line_q6);
    Ok(Candidate::new(*segment, sides, window.disparity_q6, census.disparity_q6, feature_q6))
}

impl Extent {
    fn new(segment: &Segment) -> Self {
        let line = Line::upright(segment);
        let rows = line.extent();
        let (a, b) = (line.at(rows.0), line.at(rows.1));
        Self { line, rows, columns: (a.min(b), a.max(b)) }
    }

    /// The middle row.
    fn middle(&self) -> i32 {
        (self.rows.0 + self.rows.1) / 2
    }
}

impl Windows<'_> {
    fn fill(
        &mut self,
        extent: &Extent,
        range: (i32, i32),
        band: &Band<'_>,
    ) -> Result<(), Rejection> {
        let (first, last) = extent.rows;
        if last - first < 2 {
            return Err(Rejection::NearBorder);
        }
        let middle = (first + last) / 2;
        let halves = self.halves.iter_mut().zip(&mut self.centres_q1);
        for ((half, centre), rows) in halves.zip([(first, middle), (middle + 1, last)]) {
            let rows = SampledRows::new(rows, HALF_ROWS);
            *centre = rows.centre_q1();
            let mut strips = [const { Vec::new() }; 3];
            gather(&extent.line, rows, STRIP_COLUMNS, range.0, band, &mut strips);
            for (curve, strips) in half.iter_mut().zip(&strips) {
                curve.fill(range, |costs| sad_curve(strips, costs));
            }
            self.rows += rows.count();
        }
        let [upper, lower] = &self.halves;
        for ((whole, upper), lower) in self.whole.iter_mut().zip(upper).zip(lower) {
            whole.set_sum(upper, lower);
        }
        Ok(())
    }

    /// Number of disparities compared.
    fn range(&self) -> u32 {
        let [any, ..] = &self.whole;
        u32::try_from(any.len()).unwrap_or(0)
    }

    /// Matches the lower of two one-sided windows, so that a depth edge still matches on its nearer
    /// side.
    fn match_whole(&self, joint: &mut Curve) -> Result<WindowMatch, Rejection> {
        let [left, edge, right] = &self.whole;
        joint.set_lower_sum(left, right, edge);
        let best = joint.minimum();
        let ratio_q8 = ratio_q8(best.cost, joint.second_best(best.at));
        if ratio_q8 > MAX_WINDOW_RATIO_Q8 {
            return Err(Rejection::WindowNotUnique);
        }
        Ok(WindowMatch { best, ratio_q8, disparity_q6: joint.subpixel_q6(best.at) })
    }

    /// The disparity of each half by its own windows, 1/64 px.
    fn match_halves(&self, at: i32) -> Result<(i32, i32), Rejection> {
        // One side throughout: the lower of two sides at each disparity would be no curve of
        // absolute differences.
        let [left, _, right] = &self.whole;
        let left_is_better = left.at(at) <= right.at(at);
        let [upper, lower] = self.halves.each_ref().map(|[left, edge, right]| {
            let side = if left_is_better { left } else { right };
            let cost = |d| Some(side.at(d)?.saturating_add(edge.at(d)?));
            subpixel_q6(minimum_near(at, HALF_REACH, cost).at, cost)
        });
        if (lower - upper).abs() > MAX_SLANT_Q6 / 2 {
            Err(Rejection::Slant)
        } else {
            Ok((upper, lower))
        }
    }

    /// The line through the halves' disparities, each at the mean of its rows: values at the first
    /// and the last row, 1/64 px.
    fn line_q6(&self, upper_q6: i32, lower_q6: i32, (first, last): (i32, i32)) -> [i32; 2] {
        let [upper, lower] = self.centres_q1;
        let slant_q6 = lower_q6 - upper_q6;
        [first, last].map(|row| upper_q6 + quotient(slant_q6 * (2 * row - upper), lower - upper))
    }

    /// Uniqueness ratio of the edge's own strip at `at`, Q8.
    fn edge_ratio_q8(&mut self, at: i32) -> i32 {
        let [_, edge, _] = &mut self.whole;
        ratio_q8(edge.minimum_near(at, 1).cost, edge.second_best(at))
    }

    /// Evaluates the left and the right side's own windows, edge left out, at the disparity `at`;
    /// each half moved by its own slant.
    fn evaluate_sides(&mut self, at: i32, upper_q6: i32, lower_q6: i32) -> [Ownership; 2] {
        let [upper_shift, lower_shift] = [upper_q6, lower_q6].map(|q6| (q6 - (at << 6) + 32) >> 6);
        let [[upper_left, _, upper_right], [lower_left, _, lower_right]] = &self.halves;
        let [left, _, right] = &mut self.whole;
        [(left, upper_left, lower_left), (right, upper_right, lower_right)].map(
            |(curve, upper, lower)| {
                if (upper_shift, lower_shift) != (0, 0) {
                    curve.set_shifted_sum(upper, upper_shift, lower, lower_shift);
                }
                let near = curve.minimum_near(at, 1);
                let second_best = curve.second_best(at);
                Ownership {
                    cost: near.cost,
                    second_best,
                    ratio_q8: ratio_q8(near.cost, second_best),
                    preferred: curve.minimum().at,
                    disparity_q6: curve.subpixel_q6(near.at),
                }
            },
        )
    }
}

/// Most strips of one column.
const STRIPS: usize = HALF_ROWS as usize;

/// Lists strips of eight columns that follow the line over `rows`, one list per offset from it in
/// `columns`, searched from disparity `first` on.
fn gather<'b>(
    line: &Line,
    rows: SampledRows,
    columns: [i32; 3],
    first: i32,
    band: &'b Band<'_>,
    lists: &mut [Vec<Strip<'b>, STRIPS>; 3],
) {
    for y in rows {
        let edge = line.at(y);
        if let Some(strips) = band.strips(columns.map(|column| edge + column), y, first) {
            for (list, strip) in lists.iter_mut().zip(strips) {
                let _ = list.push(strip); // at most STRIPS rows are sampled
            }
        }
    }
}

/// Matches by census, over two columns of points on each side of the edge, the lower side at each
/// disparity.
fn match_census(
    extent: &Extent,
    range: (i32, i32),
    band: &Band<'_>,
    sides: [&mut Curve; 2],
    lower: &mut Curve,
) -> Result<CensusMatch, Rejection> {
    const MOST: usize = CENSUS_ROWS as usize * 2;
    let rows = SampledRows::new(extent.rows, CENSUS_ROWS);
    let [left, right] = sides;
    let mut count = 0;
    for (curve, columns) in [&mut *left, &mut *right].into_iter().zip(CENSUS_COLUMNS) {
        let mut points: Vec<(u8, &[u8]), MOST> = Vec::new();
        for y in rows {
            let edge = extent.line.at(y);
            for column in columns {
                if let Some(point) = band.census(edge + column, y, range.0) {
                    let _ = points.push(point); // at most CENSUS_ROWS rows
                }
            }
        }
        count = points.len();
        curve.fill(range, |costs| hamming_curve(&points, costs));
    }
    lower.set_lower(left, right);
    let best = lower.minimum();
    let ratio_q8 = ratio_q8(best.cost, lower.second_best(best.at));
    if ratio_q8 > MAX_CENSUS_RATIO_Q8 {
        return Err(Rejection::CensusNotUnique);
    }
    let points = i32::try_from(count).unwrap_or(0);
    Ok(CensusMatch { points, cost: best.cost, ratio_q8, disparity_q6: lower.subpixel_q6(best.at) })
}

/// The evidence of one side's hypothesis, if the side owns the disparity.
fn hypothesis(
    shared: SegmentEvidence,
    own: &Ownership,
    other: &Ownership,
    census: &mut Curve,
    at: i32,
    rows: i32,
    which_side: i32,
) -> Option<SegmentEvidence> {
    if own.ratio_q8 > MAX_SIDE_RATIO_Q8 {
        return None;
    }
    let mut evidence = shared;
    evidence.set(SegmentKind::SideRatio, own.ratio_q8);
    evidence.set(SegmentKind::SideCost, log2_mean_q8(own.cost.into(), rows * 8));
    evidence.set(
        SegmentKind::SideMargin,
        log2_mean_q8(own.second_best.saturating_sub(own.cost).into(), rows * 8),
    );
    evidence.set(
        SegmentKind::CensusSideRatio,
        ratio_q8(census.minimum_near(at, 1).cost, census.second_best(at)),
    );
    evidence.set(SegmentKind::OtherRatio, other.ratio_q8);
    evidence.set(SegmentKind::OtherDiffers, i32::from((other.preferred - at).abs() > 2) << 8);
    let other_nearer =
        if other.preferred > at + 2 { (other.ratio_q8 - 256).clamp(0, 256) } else { 0 };
    evidence.set(SegmentKind::OtherNearer, other_nearer);
    evidence.set(SegmentKind::SideDiffers, i32::from((own.preferred - at).abs() > 1) << 8);
    evidence.set(SegmentKind::WhichSide, which_side);
    Some(evidence)
}
