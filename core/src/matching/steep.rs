//! A segment that runs down the rows: windows shaped by it, census along it, and which of its sides owns the disparity.

use super::band::{Band, Search};
use super::curve::{Curve, MAX_DISPARITIES, ratio_q8};
use super::evidence::{Evidence, Kind, log2_mean_q8};
use super::feature::{SteepLine, for_each_partner};
use super::{
    Candidate, MAX_CENSUS_RATIO_Q8, MAX_SIDE_RATIO_Q8, MAX_SLANT_Q6, MAX_WINDOW_RATIO_Q8, MIN_RANGE, MatchContext, Side, join_sides,
};
use crate::kernel::{Strip, hamming_curve, sad_curve};
use crate::lines::{MAX_ROWS, Segment};
use crate::result::Rejection;
use crate::units::quotient;
use heapless::Vec;

/// First column of the three strips of eight, relative to the edge: the left side, the edge itself, the right side.
const STRIP_COLUMNS: [i32; 3] = [-9, -4, 2];
const LEFT: usize = 0;
const EDGE: usize = 1;
const RIGHT: usize = 2;
/// Columns of the census points of each side, relative to the edge.
const CENSUS_COLUMNS: [[i32; 3]; 2] = [[-5, -3, -1], [1, 3, 5]];

/// Window curves of the upper and lower half, for each of the three strips.
struct Windows {
    halves: [[Curve; 3]; 2],
    /// Rows that were summed.
    rows: i32,
}

impl Windows {
    fn new(line: &SteepLine, rows: (i32, i32), band: &Band<'_>, len: i32) -> Self {
        let middle = (rows.0 + rows.1) / 2;
        let mut windows = Self { halves: [const { [const { Curve::EMPTY }; 3] }; 2], rows: 0 };
        for (half, rows) in windows.halves.iter_mut().zip([(rows.0, middle), (middle + 1, rows.1)]) {
            for (curve, column) in half.iter_mut().zip(STRIP_COLUMNS) {
                curve.clear(len);
                add_strips(line, rows, column, Search::Forward, band, curve);
            }
            windows.rows += quotient(rows.1 - rows.0, row_step(rows)) + 1;
        }
        windows
    }

    /// The whole segment's curve of one strip.
    fn strip(&self, strip: usize) -> Curve {
        let [upper, lower] = &self.halves;
        match (upper.get(strip), lower.get(strip)) {
            (Some(a), Some(b)) => a.sum(b),
            _ => Curve::new(0),
        }
    }

    /// The lower of the two one-sided windows' costs (each holds the edge and one side), of one half.
    fn half(&self, half: usize) -> Curve {
        match self.halves.get(half) {
            Some([left, edge, right]) => left.sum(edge).lower(&right.sum(edge)),
            None => Curve::new(0),
        }
    }

    /// A side's curve when the halves lie `upper` and `lower` px off the whole segment's disparity.
    fn side(&self, strip: usize, upper: i32, lower: i32) -> Curve {
        let [a, b] = &self.halves;
        match (a.get(strip), b.get(strip)) {
            (Some(a), Some(b)) => a.shifted_sum(upper, b, lower),
            _ => Curve::new(0),
        }
    }
}

/// Rows from one strip to the next: neighbouring rows say nearly the same, so of eight and more every second one is enough
/// (leave one out: no change in any score at 45 % fewer strips).
fn row_step(rows: (i32, i32)) -> i32 {
    if rows.1 - rows.0 >= 7 { 2 } else { 1 }
}

/// Adds the cost of one strip of eight columns that follows the line over `rows`, `column` columns off it.
fn add_strips(line: &SteepLine, rows: (i32, i32), column: i32, search: Search, band: &Band<'_>, curve: &mut Curve) {
    let mut strips: Vec<Strip<'_>, { MAX_ROWS as usize + 2 }> = Vec::new();
    let mut y = rows.0;
    while y <= rows.1 {
        if let Some(strip) = band.strip(search, line.column(y) + column, y, 0) {
            let _ = strips.push(strip); // a segment has at most MAX_ROWS + 1 rows
        }
        y += row_step(rows);
    }
    sad_curve(&strips, curve.blocks());
}

/// Census curves of the left and the right side.
fn census_curves(line: &SteepLine, rows: (i32, i32), band: &Band<'_>, len: i32) -> ([Curve; 2], i32) {
    let step = if rows.1 - rows.0 >= 16 { 2 } else { 1 };
    let mut count = 0;
    let curves = CENSUS_COLUMNS.map(|columns| {
        let mut curve = Curve::new(len);
        count = 0;
        for column in columns {
            let mut points: Vec<(u8, &[u8]), 31> = Vec::new();
            let mut y = rows.0;
            while y <= rows.1 {
                if let Some(point) = band.census(Search::Forward, line.column(y) + column, y, 0) {
                    let _ = points.push(point);
                    count += 1;
                }
                y += step;
            }
            hamming_curve(&points, curve.blocks());
        }
        curve
    });
    (curves, count)
}

/// Matches one segment, or names the test it fails.
pub(crate) fn match_steep(
    segment: &Segment,
    context: &MatchContext<'_>,
    band: &Band<'_>,
) -> Result<Candidate, Rejection> {
    let line = SteepLine::new(segment);
    let rows = line.rows();
    let count = rows.1 - rows.0 + 1;
    let columns = (line.column(rows.0), line.column(rows.1));
    let len = context.max_disparity.min(columns.0.min(columns.1) + 1);
    if len < MIN_RANGE || len > MAX_DISPARITIES as i32 || count < 3 {
        return Err(Rejection::NearBorder);
    }

    // Window: the lower of two one-sided windows, so that a depth edge still matches on its nearer side.
    let windows = Windows::new(&line, rows, band, len);
    let (left, edge, right) = (windows.strip(LEFT), windows.strip(EDGE), windows.strip(RIGHT));
    let (left_window, right_window) = (left.sum(&edge), right.sum(&edge));
    let window = left_window.lower(&right_window);
    let best = window.minimum();
    let window_ratio = ratio_q8(best.cost, window.rival(best.at));
    if window_ratio > MAX_WINDOW_RATIO_Q8 {
        return Err(Rejection::WindowNotUnique);
    }
    let window_q6 = window.subpixel_q6(best.at);

    // Census.
    let (census_sides, census_count) = census_curves(&line, rows, band, len);
    let [census_left, census_right] = &census_sides;
    let census = census_left.lower(census_right);
    let census_best = census.minimum();
    let census_ratio = ratio_q8(census_best.cost, census.rival(census_best.at));
    if census_ratio > MAX_CENSUS_RATIO_Q8 {
        return Err(Rejection::CensusNotUnique);
    }
    let census_q6 = census.subpixel_q6(census_best.at);
    let census_gap = (window_q6 - census_q6).abs();
    if !context.margin_holds(window_q6, census_q6) {
        return Err(Rejection::TechniquesDisagree);
    }

    // Back: from the place found in the right image, with the better of the two windows, over the whole range.
    let use_left = left_window.at(best.at).unwrap_or(u16::MAX) <= right_window.at(best.at).unwrap_or(u16::MAX);
    let side_column = STRIP_COLUMNS[if use_left { LEFT } else { RIGHT }];
    let back_len = context.max_disparity.min(context.width - columns.0.max(columns.1) + best.at);
    let mut back = Curve::EMPTY;
    back.clear(back_len);
    for column in [side_column, STRIP_COLUMNS[EDGE]] {
        add_strips(&line, rows, column - best.at, Search::Back, band, &mut back);
    }
    let back_best = back.minimum();
    let back_gap = ((back_best.at << 6) - window_q6).abs();
    if back_gap > 96 {
        return Err(Rejection::LeftRight);
    }
    let back_ratio = ratio_q8(back_best.cost, back.rival(back_best.at));

    // Halves: their disparities hold at the quarter points; the line through them reaches the ends.
    let half = |i: usize| {
        let curve = windows.half(i);
        let at = curve.minimum_near(best.at, 4).at;
        curve.subpixel_q6(at)
    };
    let (upper, lower) = (half(0), half(1));
    if (lower - upper).abs() > MAX_SLANT_Q6 / 2 {
        return Err(Rejection::Slant);
    }
    let disparity_q6 = [upper - (lower - upper) / 2, lower + (lower - upper) / 2];
    let middle_q6 = (upper + lower) / 2;

    // Votes of right segments.
    let (mut votes, mut feature_q6) = (0, None::<i32>);
    let middle_row_q5 = (rows.0 + rows.1) << 4;
    for_each_partner(segment, context.right, context.row_offset_q5, context.max_disparity, middle_row_q5, |d_q6| {
        votes += 1;
        let nearer = feature_q6.is_none_or(|f: i32| (d_q6 - middle_q6).abs() < (f - middle_q6).abs());
        if (d_q6 - middle_q6).abs() < 96 && nearer {
            feature_q6 = Some(d_q6);
        }
    });

    // Which side owns it: the side's own window, edge left out, must prefer this disparity.
    let shift = |q6: i32| (q6 - (best.at << 6) + 32) >> 6;
    let mut own_q6 = [0; 2];
    let mut own_q6_of = |strip: usize, q6: i32| if strip == LEFT { own_q6[0] = q6 } else { own_q6[1] = q6 };
    let sides = [LEFT, RIGHT].map(|strip| {
        let curve = windows.side(strip, shift(upper), shift(lower));
        let near = curve.minimum_near(best.at, 1);
        own_q6_of(strip, curve.subpixel_q6(near.at));
        (near, curve.rival(best.at), curve.minimum().at)
    });
    let side_ratios = sides.map(|(near, rival, _)| ratio_q8(near.cost, rival));
    let mut shared = Evidence::new();
    shared.set(Kind::WindowRatio, window_ratio);
    shared.set(Kind::WindowCost, log2_mean_q8(best.cost.into(), windows.rows * 16));
    shared.set(Kind::CensusRatio, census_ratio);
    shared.set(Kind::CensusCost, log2_mean_q8(census_best.cost.into(), census_count));
    shared.set(Kind::CensusGap, census_gap << 2);
    shared.set(Kind::BackGap, back_gap << 2);
    shared.set(Kind::BackRatio, back_ratio);
    shared.set(Kind::Slant, quotient((lower - upper).abs() << 3, count));
    shared.set(Kind::Length, log2_mean_q8(count as u32, 1));
    shared.set(Kind::RightAgrees, i32::from(feature_q6.is_some()) << 8);
    shared.set(Kind::NoRight, i32::from(votes == 0) << 8);
    shared.set(Kind::Lean, line.slope_q12().abs() >> 4);
    shared.set(Kind::Range, log2_mean_q8(len as u32, 1));
    shared.set(Kind::Contrast, log2_mean_q8(segment.contrast.into(), 1));
    let edge_best = edge.minimum_near(best.at, 1);
    shared.set(Kind::EdgeRatio, ratio_q8(edge_best.cost, edge.rival(best.at)));

    let claim = |i: usize| {
        let (near, rival, preferred) = *sides.get(i)?;
        let ratio = *side_ratios.get(i)?;
        let (other_ratio, (_, _, other_preferred)) = (*side_ratios.get(1 - i)?, *sides.get(1 - i)?);
        if ratio > MAX_SIDE_RATIO_Q8 {
            return None;
        }
        let mut evidence = shared;
        evidence.set(Kind::SideRatio, ratio);
        evidence.set(Kind::SideCost, log2_mean_q8(near.cost.into(), windows.rows * 8));
        evidence.set(Kind::SideMargin, log2_mean_q8(rival.saturating_sub(near.cost).into(), windows.rows * 8));
        let census_side = census_sides.get(i)?;
        let census_near = census_side.minimum_near(best.at, 1);
        evidence.set(Kind::CensusSideRatio, ratio_q8(census_near.cost, census_side.rival(best.at)));
        evidence.set(Kind::OtherRatio, other_ratio);
        evidence.set(Kind::OtherDiffers, i32::from((other_preferred - best.at).abs() > 2) << 8);
        evidence.set(Kind::SideDiffers, i32::from((preferred - best.at).abs() > 1) << 8);
        evidence.set(Kind::WhichSide, if i == 0 { -256 } else { 256 });
        Some(Side::new(disparity_q6, evidence))
    };
    let mut sides = [claim(0), claim(1)];
    if sides.iter().all(Option::is_none) {
        return Err(Rejection::NoOwner);
    }
    if std_mean() {
        let moved = (own_q6[0] + own_q6[1]) / 2 - middle_q6;
        join_sides(&mut sides, own_q6, 11, disparity_q6.map(|d| d + moved));
    } else {
        join_sides(&mut sides, own_q6, 11, disparity_q6);
    }
    Ok(Candidate { segment: *segment, sides, window_q6, census_q6, feature_q6, beaten: false, listed: None })
}

const fn std_mean() -> bool {
    false
}
