//! A segment that runs down the rows: windows shaped by it, census along it, and which of its sides owns the disparity.
//!
//! In: a left segment and the band of rows around it. Out: a candidate with one line of disparity and the evidence of each side that owns
//! it, or the name of the test it fails.
//!
//! ```text
//! window:  lower of two one-sided windows (edge and left side, edge and right side), over every disparity; unique?
//! census:  Hamming distances at points of interest beside the edge, lower side; unique? within the margin of the window?
//! back:    the better window, from the place found in the right image, returns to the segment?
//! halves:  a disparity for each half gives the line of disparity along the segment
//! votes:   lines of right segments at that disparity
//! owners:  a side's own window, edge left out, must prefer this disparity to every other
//! ```
//!
//! # Bounds
//! A strip costs at most 8 * 126 a row; 33 rows of two strips: 66 528, so sums saturate at `u16::MAX` only on windows that match nowhere.
//! All other numbers are disparities in 1/64 px (below 2^15) and ratios in Q8 (at most 768).

use super::aggregate::join_sides;
use super::band::{Band, Search};
use super::curve::{Curve, Minimum, ratio_q8};
use super::evidence::{Evidence, Kind, log2_mean_q8};
use super::feature::{SteepLine, for_each_partner};
use super::{Candidate, MAX_CENSUS_RATIO_Q8, MAX_SIDE_RATIO_Q8, MAX_SLANT_Q6, MAX_WINDOW_RATIO_Q8, MatchContext, Side};
use crate::kernel::{Strip, hamming_curve, sad_curve};
use crate::lines::{MAX_ROWS, Segment};
use crate::result::Rejection;
use crate::units::quotient;
use heapless::Vec;

/// First column of the three strips of eight, relative to the edge: the left side, the edge itself, the right side.
const STRIP_COLUMNS: [i32; 3] = [-9, -4, 2];
/// Between the centres of the two sides' strips.
const SIDES_APART: i32 = 11;
/// Columns of the census points of each side, relative to the edge.
const CENSUS_COLUMNS: [[i32; 3]; 2] = [[-5, -3, -1], [1, 3, 5]];
/// Largest difference between the window's disparity and the one found searching back, 1/64 px.
const MAX_BACK_GAP_Q6: i32 = 96;
/// Largest distance of a right segment's disparity that is still a vote for this one, 1/64 px.
const VOTE_REACH_Q6: i32 = 96;
/// Disparities around the whole segment's in which a half is sought.
const HALF_REACH: i32 = 4;

/// The segment on whole pixels.
struct Extent {
    line: SteepLine,
    /// First and last row.
    rows: (i32, i32),
    /// Smallest and largest column of the line.
    columns: (i32, i32),
}

/// Window curves of the upper and lower half, for each of the three strips.
struct Windows {
    halves: [[Curve; 3]; 2],
    /// Rows that were summed.
    rows: i32,
}

/// Where the whole segment's window matches.
struct WindowMatch {
    best: Minimum,
    ratio_q8: i32,
    disparity_q6: i32,
    /// First column of the side strip of the better window.
    better_side: i32,
}

/// Where census matches.
struct CensusMatch {
    sides: [Curve; 2],
    points: i32,
    cost: u16,
    ratio_q8: i32,
    disparity_q6: i32,
}

/// What one side's own window says of the accepted disparity.
struct Ownership {
    cost: u16,
    rival: u16,
    ratio_q8: i32,
    preferred: i32,
    disparity_q6: i32,
}

/// Matches one segment, or names the test it fails.
pub(crate) fn match_steep(
    segment: &Segment,
    context: &MatchContext<'_>,
    band: &Band<'_>,
) -> Result<Candidate, Rejection> {
    let extent = Extent::new(segment);
    let windows = Windows::new(&extent, context, band)?;
    let window = windows.place()?;
    let census = place_by_census(&extent, context, band)?;
    if !context.agreement.holds(window.disparity_q6, census.disparity_q6) {
        return Err(Rejection::TechniquesDisagree);
    }
    let (back_gap_q6, back_ratio_q8) = search_back(&extent, &window, context, band)?;
    let (upper_q6, lower_q6) = windows.place_halves(window.best.at)?;
    let (slant_q6, middle_q6) = (lower_q6 - upper_q6, (upper_q6 + lower_q6) / 2);
    let (feature_q6, votes) = count_votes(segment, &extent, middle_q6, context);

    let count = extent.rows.1 - extent.rows.0 + 1;
    let mut shared = Evidence::new();
    shared.set(Kind::WindowRatio, window.ratio_q8);
    shared.set(Kind::WindowCost, log2_mean_q8(window.best.cost.into(), windows.rows * 16));
    shared.set(Kind::CensusRatio, census.ratio_q8);
    shared.set(Kind::CensusCost, log2_mean_q8(census.cost.into(), census.points));
    shared.set(Kind::CensusGap, (window.disparity_q6 - census.disparity_q6).abs() << 2);
    shared.set(Kind::BackGap, back_gap_q6 << 2);
    shared.set(Kind::BackRatio, back_ratio_q8);
    shared.set(Kind::Slant, quotient(slant_q6.abs() << 3, count));
    shared.set(Kind::Length, log2_mean_q8(count.unsigned_abs(), 1));
    shared.set(Kind::RightAgrees, i32::from(feature_q6.is_some()) << 8);
    shared.set(Kind::NoRight, i32::from(votes == 0) << 8);
    shared.set(Kind::Lean, extent.line.slope_q12().abs() >> 4);
    shared.set(Kind::Range, log2_mean_q8(windows.range(), 1));
    shared.set(Kind::Contrast, log2_mean_q8(segment.contrast.into(), 1));
    shared.set(Kind::EdgeRatio, windows.edge_ratio_q8(window.best.at));

    // The halves' disparities hold at the quarter points; the line through them reaches the ends.
    let line_q6 = [upper_q6 - slant_q6 / 2, lower_q6 + slant_q6 / 2];
    let [left, right] = windows.ask_sides(window.best.at, upper_q6, lower_q6);
    let at = window.best.at;
    let [census_left, census_right] = &census.sides;
    let mut sides = [
        claim(shared, &left, &right, census_left, at, windows.rows, -256).map(|e| Side::new(line_q6, e)),
        claim(shared, &right, &left, census_right, at, windows.rows, 256).map(|e| Side::new(line_q6, e)),
    ];
    if sides.iter().all(Option::is_none) {
        return Err(Rejection::NoOwner);
    }
    join_sides(&mut sides, [left.disparity_q6, right.disparity_q6], SIDES_APART, line_q6);
    Ok(Candidate::new(*segment, sides, window.disparity_q6, census.disparity_q6, feature_q6))
}

impl Extent {
    fn new(segment: &Segment) -> Self {
        let line = SteepLine::new(segment);
        let rows = line.rows();
        let (a, b) = (line.column(rows.0), line.column(rows.1));
        Self { line, rows, columns: (a.min(b), a.max(b)) }
    }
}

impl Windows {
    fn new(extent: &Extent, context: &MatchContext<'_>, band: &Band<'_>) -> Result<Self, Rejection> {
        let range = context.range_before(extent.columns.0)?;
        let (first, last) = extent.rows;
        if last - first < 2 {
            return Err(Rejection::NearBorder);
        }
        let middle = (first + last) / 2;
        let mut windows = Self { halves: [const { [const { Curve::EMPTY }; 3] }; 2], rows: 0 };
        for (half, rows) in windows.halves.iter_mut().zip([(first, middle), (middle + 1, last)]) {
            for (curve, column) in half.iter_mut().zip(STRIP_COLUMNS) {
                curve.clear(range);
                add_strips(&extent.line, rows, 3, column, Search::Forward, band, curve);
            }
            windows.rows += quotient(rows.1 - ((rows.0 + 1) & !1), row_step(rows, 3)) + 1;
        }
        Ok(windows)
    }

    /// Disparities compared.
    fn range(&self) -> u32 {
        let [[first, ..], _] = &self.halves;
        u32::try_from(first.costs().len()).unwrap_or(0)
    }

    /// The lower of two one-sided windows, so that a depth edge still matches on its nearer side.
    fn place(&self) -> Result<WindowMatch, Rejection> {
        let [[upper_left, upper_edge, upper_right], [lower_left, lower_edge, lower_right]] = &self.halves;
        let edge = upper_edge.sum(lower_edge);
        let left = upper_left.sum(lower_left).sum(&edge);
        let right = upper_right.sum(lower_right).sum(&edge);
        let window = left.lower(&right);
        let best = window.minimum();
        let ratio_q8 = ratio_q8(best.cost, window.rival(best.at));
        if ratio_q8 > MAX_WINDOW_RATIO_Q8 {
            return Err(Rejection::WindowNotUnique);
        }
        let [left_column, _, right_column] = STRIP_COLUMNS;
        let better_side = if left.at(best.at) <= right.at(best.at) { left_column } else { right_column };
        Ok(WindowMatch { best, ratio_q8, disparity_q6: window.subpixel_q6(best.at), better_side })
    }

    /// The disparity of each half by its own windows, 1/64 px.
    fn place_halves(&self, at: i32) -> Result<(i32, i32), Rejection> {
        let [upper, lower] = self.halves.each_ref().map(|[left, edge, right]| {
            let curve = left.sum(edge).lower(&right.sum(edge));
            curve.subpixel_q6(curve.minimum_near(at, HALF_REACH).at)
        });
        if (lower - upper).abs() > MAX_SLANT_Q6 / 2 { Err(Rejection::Slant) } else { Ok((upper, lower)) }
    }

    /// How much better the edge alone matches here than elsewhere.
    fn edge_ratio_q8(&self, at: i32) -> i32 {
        let [[_, upper, _], [_, lower, _]] = &self.halves;
        let edge = upper.sum(lower);
        ratio_q8(edge.minimum_near(at, 1).cost, edge.rival(at))
    }

    /// What the left and the right side's own windows, edge left out, say of the disparity `at`; each half moved by its own slant.
    fn ask_sides(&self, at: i32, upper_q6: i32, lower_q6: i32) -> [Ownership; 2] {
        let whole = |q6: i32| (q6 - (at << 6) + 32) >> 6;
        let [[upper_left, _, upper_right], [lower_left, _, lower_right]] = &self.halves;
        [(upper_left, lower_left), (upper_right, lower_right)].map(|(upper, lower)| {
            let curve = upper.shifted_sum(whole(upper_q6), lower, whole(lower_q6));
            let near = curve.minimum_near(at, 1);
            let rival = curve.rival(at);
            Ownership {
                cost: near.cost,
                rival,
                ratio_q8: ratio_q8(near.cost, rival),
                preferred: curve.minimum().at,
                disparity_q6: curve.subpixel_q6(near.at),
            }
        })
    }
}

/// Rows from one strip to the next: neighbouring rows say nearly the same, so of eight and more every second one is enough
/// (leave one out: no change in any score at 45 % fewer strips).
fn row_step(rows: (i32, i32), most: i32) -> i32 {
    2 * quotient((rows.1 - rows.0 + 2) / 2 + most - 1, most)
}
/// Adds the cost of one strip of eight columns that follows the line over `rows`, `column` columns off it.
fn add_strips(
    line: &SteepLine,
    rows: (i32, i32),
    most: i32,
    column: i32,
    search: Search,
    band: &Band<'_>,
    curve: &mut Curve,
) {
    let mut strips: Vec<Strip<'_>, { MAX_ROWS as usize + 2 }> = Vec::new();
    let mut y = (rows.0 + 1) & !1;
    while y <= rows.1 {
        if let Some(strip) = band.strip(search, line.column(y) + column, y, curve.first()) {
            let _ = strips.push(strip); // a segment has at most MAX_ROWS + 1 rows
        }
        y += row_step(rows, most);
    }
    sad_curve(&strips, curve.blocks());
}

/// The lower side's census curve, over three columns of points on each side of the edge.
fn place_by_census(extent: &Extent, context: &MatchContext<'_>, band: &Band<'_>) -> Result<CensusMatch, Rejection> {
    let range = context.range_before(extent.columns.0)?;
    let step = row_step(extent.rows, 4);
    let mut sides = [const { Curve::EMPTY }; 2];
    let mut count = 0;
    for (curve, columns) in sides.iter_mut().zip(CENSUS_COLUMNS) {
        curve.clear(range);
        count = 0;
        for column in columns {
            let mut points: Vec<(u8, &[u8]), 31> = Vec::new();
            let mut y = (extent.rows.0 + 1) & !1;
            while y <= extent.rows.1 {
                if let Some(point) = band.census(Search::Forward, extent.line.column(y) + column, y, curve.first()) {
                    let _ = points.push(point); // at most 17 rows
                    count += 1;
                }
                y += step;
            }
            hamming_curve(&points, curve.blocks());
        }
    }
    let [left, right] = &sides;
    let census = left.lower(right);
    let best = census.minimum();
    let ratio_q8 = ratio_q8(best.cost, census.rival(best.at));
    if ratio_q8 > MAX_CENSUS_RATIO_Q8 {
        return Err(Rejection::CensusNotUnique);
    }
    let disparity_q6 = census.subpixel_q6(best.at);
    Ok(CensusMatch { sides, points: count, cost: best.cost, ratio_q8, disparity_q6 })
}

/// From the place found in the right image back over the whole range: the gap to the segment (1/64 px) and the uniqueness.
fn search_back(
    extent: &Extent,
    window: &WindowMatch,
    context: &MatchContext<'_>,
    band: &Band<'_>,
) -> Result<(i32, i32), Rejection> {
    let mut curve = Curve::EMPTY;
    curve.clear(context.range_after(extent.columns.1 - window.best.at));
    let [_, edge_column, _] = STRIP_COLUMNS;
    for column in [window.better_side, edge_column] {
        add_strips(&extent.line, extent.rows, 4, column - window.best.at, Search::Back, band, &mut curve);
    }
    let best = curve.minimum();
    let gap_q6 = ((best.at << 6) - window.disparity_q6).abs();
    if gap_q6 > MAX_BACK_GAP_Q6 {
        return Err(Rejection::LeftRight);
    }
    Ok((gap_q6, ratio_q8(best.cost, curve.rival(best.at))))
}

/// The nearest vote of a right segment (1/64 px), and how many right segments are compatible with any disparity.
fn count_votes(segment: &Segment, extent: &Extent, middle_q6: i32, context: &MatchContext<'_>) -> (Option<i32>, u32) {
    let (mut votes, mut feature_q6) = (0, None::<i32>);
    let middle_row_q5 = (extent.rows.0 + extent.rows.1) << 4;
    for_each_partner(segment, context, middle_row_q5, |d_q6| {
        votes += 1;
        let gap = (d_q6 - middle_q6).abs();
        if gap < VOTE_REACH_Q6 && feature_q6.is_none_or(|nearest| gap < (nearest - middle_q6).abs()) {
            feature_q6 = Some(d_q6);
        }
    });
    (feature_q6, votes)
}

/// The evidence of one side's claim, if the side owns the disparity.
fn claim(
    shared: Evidence,
    own: &Ownership,
    other: &Ownership,
    census: &Curve,
    at: i32,
    rows: i32,
    which_side: i32,
) -> Option<Evidence> {
    if own.ratio_q8 > MAX_SIDE_RATIO_Q8 {
        return None;
    }
    let mut evidence = shared;
    evidence.set(Kind::SideRatio, own.ratio_q8);
    evidence.set(Kind::SideCost, log2_mean_q8(own.cost.into(), rows * 8));
    evidence.set(Kind::SideMargin, log2_mean_q8(own.rival.saturating_sub(own.cost).into(), rows * 8));
    evidence.set(Kind::CensusSideRatio, ratio_q8(census.minimum_near(at, 1).cost, census.rival(at)));
    evidence.set(Kind::OtherRatio, other.ratio_q8);
    evidence.set(Kind::OtherDiffers, i32::from((other.preferred - at).abs() > 2) << 8);
    evidence.set(Kind::SideDiffers, i32::from((own.preferred - at).abs() > 1) << 8);
    evidence.set(Kind::WhichSide, which_side);
    Some(evidence)
}
