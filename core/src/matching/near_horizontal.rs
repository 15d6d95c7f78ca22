//! Near-horizontal segments: the line itself gives no disparity, the texture along it may. Each
//! side is matched on its own.
//!
//! In: a left segment and the band of rows around it. Out: a candidate with a line of disparity for
//! each side with a unique minimum, or the test at which the better side failed.
//!
//! ```text
//! for each side: window:  rows beside the edge, over every disparity; has to be unique
//!                census:  Hamming distances beside the edge; has to be unique and within the
//!                         margin of the window
//!                halves:  a disparity for each half gives the line of disparity along the segment
//! sides that agree are one surface
//! ground:        where support points of a side lie beside the ground plane, each row is moved by
//!                the change of the plane's disparity from the line to it
//! ```
//!
//! # Bounds
//! At most 4 blocks of 2 rows of 8 pixels, 62 each: 3968. Census: at most 9 points a row, 2 rows, 8
//! bits each.
//!
//! # Cost
//! 16 strips of windows and at most 36 points of census over the disparities, some 20 passes over a
//! curve: 24 000 instructions at 64 disparities.

use super::aggregate::join_sides;
use super::band::{Band, on_band};
use super::{
    Candidate, MAX_CENSUS_RATIO_Q8, MAX_SIDE_RATIO_Q8, MatchContext, NEARER_Q8, Workspace,
};
use crate::curve::{Curve, Minimum, ratio_q8};
use crate::evidence::{SegmentEvidence, SegmentKind, log2_mean_q8};
use crate::kernel::{STRIP, Strip, hamming_curve, sad_curve};
use crate::lines::{Line, MAX_COLUMNS, Segment};
use crate::result::Rejection;
use crate::support::Support;
use crate::units::{narrow, quotient};
use heapless::Vec;

/// Rows of each side's window, relative to the edge, px; more rows between are redundant.
const SIDE_ROWS: [[i32; 2]; 2] = [[-2, -5], [2, 5]];
/// Half of a block, px, Q1. A window moves away from a slanted line by half of its rise over that,
/// whole rows: a block lies on one row and would reach across the edge.
const RISE_Q1: i32 = 7;
/// Largest uniqueness ratio, best / second-best, of a half, Q8: a half that shows nothing, beside
/// one that does, is of another surface.
const MAX_HALF_RATIO_Q8: i32 = 256;
/// Distance between the centres of the two sides' windows, px.
const SIDES_APART: i32 = 8;
/// Rows of each side's census points.
const CENSUS_ROWS: [[i32; 2]; 2] = [[-4, -2], [2, 4]];
/// Rows beside a line within which support points say what its side shows, px.
const BESIDE: i32 = 14;
/// Search range of a half around the whole side's disparity, px.
const HALF_REACH: i32 = 2;

/// Rows of the image beside a line, moved by the change of the ground's disparity from the line to
/// each of them where a side shows the ground: curves are of the disparity at the line.
#[derive(Clone, Copy)]
struct Shear {
    /// Change of the disparity from one row to the next, px in Q16.
    down_q16: i32,
}

/// Changes of the disparity less the whole pixels moved: their sum, 1/64 px, and their number.
#[derive(Clone, Copy, Default)]
struct Rest {
    sum_q6: i32,
    count: i32,
}

impl Shear {
    const NONE: Self = Self { down_q16: 0 };
    /// Steepest ground along which rows are moved, px in Q16.
    const STEEPEST_Q16: i32 = 1 << 16;

    /// For one side, -1 above and 1 below: along the ground where most of the unique support points
    /// on it were found beside the plane.
    fn of_side(segment: &Segment, line: &Line, sign: i32, support: Support<'_>) -> Self {
        let Some(plane) = support.plane().filter(|p| p.down_q16.abs() <= Self::STEEPEST_Q16) else {
            return Self::NONE;
        };
        let area = segment.area();
        let (top, bottom) = (i32::from(area.top), i32::from(area.bottom));
        let rows = if sign < 0 { (top - BESIDE, bottom) } else { (top, bottom + BESIDE) };
        let columns = (i32::from(area.left), i32::from(area.right));
        let (mut on_plane, mut all) = (0, 0);
        for (x, y, point) in support.between(columns, rows) {
            let is_beside = (y - line.at(x)) * sign > 0;
            if is_beside && point.is_unique() {
                all += 1;
                on_plane += i32::from(point.is_beside_ground());
            }
        }
        if 2 * on_plane > all { Self { down_q16: plane.down_q16 } } else { Self::NONE }
    }

    /// Whole pixels by which the disparity changes over these rows, 1/32 px; adds what is left.
    fn over(self, rows_q5: i32, rest: &mut Rest) -> i32 {
        let change_q6 = (self.down_q16 * rows_q5) >> 15;
        let whole = (change_q6 + 32) >> 6;
        rest.sum_q6 += change_q6 - (whole << 6);
        rest.count += 1;
        whole
    }

    /// Change of the disparity per pixel away from the line on this side, 1/1024 px.
    fn across_q10(self, sign: i32) -> i32 {
        (self.down_q16 * sign) >> 6
    }
}

impl Rest {
    /// A disparity without it, 1/64 px.
    fn off(self, disparity_q6: i32) -> i32 {
        disparity_q6 - quotient(self.sum_q6, self.count)
    }
}

/// Rows of one side, relative to the line, and how far they are moved.
#[derive(Clone, Copy)]
struct SideRows {
    /// Of its window: the nearer and the farther one.
    window: [i32; 2],
    census: [i32; 2],
    shear: Shear,
}

/// Window curves of one side, of its two halves and the whole, with the minimum of the whole.
struct SideWindows<'w> {
    /// Of the rows nearest to the edge alone.
    near: [&'w mut Curve; 2],
    halves: [&'w mut Curve; 2],
    whole: &'w mut Curve,
    rows: SideRows,
    /// First disparity and number of disparities compared.
    range: (i32, i32),
    rest: Rest,
    pixels: i32,
    best: Minimum,
    second_best: u16,
    ratio_q8: i32,
}

/// Matches both sides of one segment, or returns the test at which the better side failed.
pub(crate) fn match_near_horizontal(
    segment: &Segment,
    context: &MatchContext<'_>,
    band: &Band<'_>,
    work: &mut Workspace,
) -> Result<Candidate, Rejection> {
    let line = Line::level(segment);
    let columns = line.extent();
    let count = columns.1 - columns.0 + 1;
    let row = line.at((columns.0 + columns.1) / 2);
    let range = context.range_before(columns.0, band.right_columns(row))?;
    if count < 3 {
        return Err(Rejection::NearBorder);
    }
    let mut shared = SegmentEvidence::new();
    shared.set(SegmentKind::Length, log2_mean_q8(count.unsigned_abs(), 1));
    shared.set(SegmentKind::Lean, line.slope_q12().abs() >> 4);
    shared.set(SegmentKind::Range, log2_mean_q8(range.1.unsigned_abs(), 1));
    shared.set(SegmentKind::Detail, context.detail_q8());
    shared.set(SegmentKind::Contrast, log2_mean_q8(segment.contrast.into(), 1));

    let [a, b, c, d, e, f, g, h, i, j, census_above, census_below] = &mut work.curves;
    let shears = [-1, 1].map(|sign| Shear::of_side(segment, &line, sign, context.support));
    let [above_rows, below_rows] = side_rows(&line, shears);
    let mut above = SideWindows::new([a, b, c, d, e], &line, columns, above_rows, range, band);
    let mut below = SideWindows::new([f, g, h, i, j], &line, columns, below_rows, range, band);
    let match_one = |own: &mut SideWindows<'_>,
                     other: &SideWindows<'_>,
                     which_side: i32,
                     census: &mut Curve| {
        let mut shared = shared;
        shared.set(SegmentKind::WhichSide, which_side);
        match_side(&line, own, other, shared, context, band, census)
    };
    let matched = [
        match_one(&mut above, &below, -256, census_above),
        match_one(&mut below, &above, 256, census_below),
    ];
    let (window_q6, census_q6) = match &matched {
        [Ok(a), Ok(b)]
            if b.evidence.get(SegmentKind::SideRatio) < a.evidence.get(SegmentKind::SideRatio) =>
        {
            b.techniques()
        }
        [Ok(a), _] => a.techniques(),
        [_, Ok(b)] => b.techniques(),
        // The reason that comes last in the order of tests.
        [Err(a), Err(b)] => return Err(if *a as usize >= *b as usize { *a } else { *b }),
    };
    let lines_q6 = matched.each_ref().map(|side| side.as_ref().map_or([0; 2], |side| side.line_q6));
    let evidence = matched.map(|side| side.ok().map(|side| side.evidence));
    let is_behind = evidence
        .map(|evidence| evidence.is_some_and(|of| of.get(SegmentKind::OtherNearer) > NEARER_Q8));
    let mut sides = work.rate(&evidence, lines_q6, context.models, true);
    for (side, is_behind) in sides.iter_mut().zip(is_behind) {
        if let Some(side) = side {
            side.is_behind = is_behind;
        }
    }
    let [[a0, a1], [b0, b1]] = lines_q6;
    let line_q6 = [(a0 + b0) / 2, (a1 + b1) / 2];
    // Disparities at the line differ by what surfaces do, those at windows by their slope as well.
    let apart = if shears.iter().any(|shear| shear.down_q16 != 0) { 0 } else { SIDES_APART };
    join_sides(&mut sides, [(a0 + a1) / 2, (b0 + b1) / 2], apart, line_q6);
    for ((side, shear), sign) in sides.iter_mut().zip(shears).zip([-1, 1]) {
        if let Some(side) = side.as_mut().filter(|_| apart == 0) {
            side.across_q10 = narrow(shear.across_q10(sign));
        }
    }
    Ok(Candidate::new(*segment, sides, window_q6, census_q6, None))
}

/// Rows above and below.
fn side_rows(line: &Line, [above, below]: [Shear; 2]) -> [SideRows; 2] {
    let away = (line.slope_q12().abs() * RISE_Q1) >> 14;
    let ([window_above, window_below], [census_above, census_below]) = (SIDE_ROWS, CENSUS_ROWS);
    [
        SideRows { window: window_above.map(|row| row - away), census: census_above, shear: above },
        SideRows { window: window_below.map(|row| row + away), census: census_below, shear: below },
    ]
}

impl<'w> SideWindows<'w> {
    fn new(
        [near_a, near_b, a, b, whole]: [&'w mut Curve; 5],
        line: &Line,
        (first, last): (i32, i32),
        rows: SideRows,
        range: (i32, i32),
        band: &Band<'_>,
    ) -> Self {
        let middle = (first + last) / 2;
        let (mut pixels, mut rest) = (0, Rest::default());
        let halves =
            [(&mut *near_a, &mut *a, (first, middle)), (&mut *near_b, &mut *b, (middle + 1, last))];
        for (near, half, columns) in halves {
            let [near_row, far_row] =
                rows.window.map(|row| RowPiece { line, columns, row, shear: rows.shear });
            near.fill(range, |costs| {
                pixels += near_row.add_blocks(range.0, band, &mut rest, costs);
            });
            half.fill_upon(near, |costs| {
                pixels += far_row.add_blocks(range.0, band, &mut rest, costs);
            });
        }
        whole.set_sum(a, b);
        let best = whole.minimum();
        let second_best = whole.second_best(best.at);
        let ratio_q8 = ratio_q8(best.cost, second_best);
        Self {
            near: [near_a, near_b],
            halves: [a, b],
            whole,
            rows,
            range,
            rest,
            pixels,
            best,
            second_best,
            ratio_q8,
        }
    }

    /// Uniqueness ratio of the row nearest to the edge alone, at the disparity of all rows, Q8.
    fn near_ratio_q8(&mut self) -> i32 {
        let [a, b] = &mut self.near;
        a.add(b);
        ratio_near_q8(a, self.best.at, 1)
    }

    /// That of the half which is less unique, Q8.
    fn half_ratio_q8(&self) -> i32 {
        let [a, b] =
            self.halves.each_ref().map(|half| ratio_near_q8(half, self.best.at, HALF_REACH));
        a.max(b)
    }
}

/// Uniqueness ratio of a curve's lowest cost within this reach, Q8.
fn ratio_near_q8(curve: &Curve, at: i32, reach: i32) -> i32 {
    let near = curve.minimum_near(at, reach);
    ratio_q8(near.cost, curve.second_best(near.at))
}

/// A row beside the line, between a first and a last column.
struct RowPiece<'l> {
    line: &'l Line,
    columns: (i32, i32),
    /// Relative to the line.
    row: i32,
    shear: Shear,
}

impl RowPiece<'_> {
    /// Adds its cost, in blocks of eight columns that follow the line, from disparity `first` on;
    /// returns the pixels compared.
    fn add_blocks(&self, first: i32, band: &Band<'_>, rest: &mut Rest, costs: &mut [u16]) -> i32 {
        let Self { line, columns: (from, to), row, shear } = *self;
        const WIDTH: i32 = STRIP as i32;
        /// Blocks of the longest piece.
        const MOST: usize = (MAX_COLUMNS as usize + 1).div_ceil(STRIP);
        let blocks = (to - from + WIDTH) / WIDTH;
        let mut strips: Vec<Strip<'_>, MOST> = Vec::new();
        for block in 0..blocks {
            // Blocks share the columns evenly; they overlap when the length is no multiple of
            // eight.
            let start = from + quotient((to - from + 1 - WIDTH) * block, blocks - 1);
            // Of one beside an end of the segment the band need not hold the rows.
            let line_q5 = line.at_q5(line.nearest_q5((start << 5) + 112));
            let y = on_band(((line_q5 + 16) >> 5) + row);
            let first = first + shear.over((y << 5) - line_q5, rest);
            if let Some(strip) = band.strip(start, y, first) {
                let _ = strips.push(strip); // a piece is at most MAX_COLUMNS long
            }
        }
        sad_curve(&strips, costs);
        i32::try_from(strips.len()).unwrap_or(0) * WIDTH
    }
}

/// Census curve of one side; returns its points, and what moved rows leave.
fn census_curve(
    line: &Line,
    (from, to): (i32, i32),
    rows: SideRows,
    range: (i32, i32),
    band: &Band<'_>,
    curve: &mut Curve,
) -> (i32, Rest) {
    /// Columns from one point to the next; a census code covers two columns on either side.
    const STEP: i32 = 3;
    const MOST: usize = (MAX_COLUMNS / STEP + 1) as usize * 2;
    let mut points: Vec<(u8, &[u8]), MOST> = Vec::new();
    let (mut x, mut rest) = (from, Rest::default());
    while x <= to {
        let line_q5 = line.at_q5(x << 5);
        for row in rows.census {
            let y = on_band(((line_q5 + 16) >> 5) + row);
            let first = range.0 + rows.shear.over((y << 5) - line_q5, &mut rest);
            if let Some(point) = band.census(x, y, first) {
                let _ = points.push(point); // a piece is at most MAX_COLUMNS long
            }
        }
        x += STEP;
    }
    curve.fill(range, |costs| hamming_curve(&points, costs));
    (i32::try_from(points.len()).unwrap_or(0), rest)
}

/// A side that passed every test, with its line of disparity, 1/64 px.
struct MatchedSide {
    evidence: SegmentEvidence,
    line_q6: [i32; 2],
    window_q6: i32,
    census_q6: i32,
}

impl MatchedSide {
    fn techniques(&self) -> (i32, i32) {
        (self.window_q6, self.census_q6)
    }
}

/// Matches one side by its window, census and the halves of the window.
fn match_side(
    line: &Line,
    own: &mut SideWindows<'_>,
    other: &SideWindows<'_>,
    shared: SegmentEvidence,
    context: &MatchContext<'_>,
    band: &Band<'_>,
    census: &mut Curve,
) -> Result<MatchedSide, Rejection> {
    let (at, range, columns) = (own.best.at, own.range, line.extent());
    if own.pixels == 0 || own.ratio_q8 > MAX_SIDE_RATIO_Q8 || context.is_end(at, range) {
        return Err(Rejection::WindowNotUnique);
    }
    let half_ratio_q8 = own.half_ratio_q8();
    if half_ratio_q8 > MAX_HALF_RATIO_Q8 {
        return Err(Rejection::WindowNotUnique);
    }
    let (points, census_rest) = census_curve(line, columns, own.rows, range, band, census);
    let census_near = census.minimum_near(at, 1);
    let census_ratio_q8 = ratio_q8(census_near.cost, census.second_best(at));
    if census_ratio_q8 > MAX_CENSUS_RATIO_Q8 {
        return Err(Rejection::CensusNotUnique);
    }
    let window_q6 = own.rest.off(own.whole.subpixel_q6(at));
    let census_at = |at: i32| census_rest.off(census.subpixel_q6(at));
    if !context.agreement.holds(window_q6, census_at(census.minimum().at)) {
        return Err(Rejection::TechniquesDisagree);
    }
    let census_q6 = census_at(census_near.at);

    let [first_q6, last_q6] = own
        .halves
        .each_ref()
        .map(|curve| own.rest.off(curve.subpixel_q6(curve.minimum_near(at, HALF_REACH).at)));
    let slant_q6 = last_q6 - first_q6;
    let mut evidence = shared;
    evidence.set(SegmentKind::SideRatio, own.ratio_q8);
    evidence.set(SegmentKind::SideCost, log2_mean_q8(own.best.cost.into(), own.pixels));
    evidence.set(
        SegmentKind::SideMargin,
        log2_mean_q8(own.second_best.saturating_sub(own.best.cost).into(), own.pixels),
    );
    evidence.set(SegmentKind::CensusRatio, census_ratio_q8);
    evidence.set(SegmentKind::CensusCost, log2_mean_q8(census_near.cost.into(), points));
    evidence.set(SegmentKind::CensusGap, (window_q6 - census_q6).abs() << 2);
    evidence.set(SegmentKind::Slant, quotient(slant_q6.abs() << 3, columns.1 - columns.0 + 1));
    evidence.set(SegmentKind::OtherRatio, other.ratio_q8);
    evidence.set(SegmentKind::OtherDiffers, i32::from((other.best.at - at).abs() > 1) << 8);
    evidence.set(
        SegmentKind::OtherNearer,
        if other.best.at > at + 1 { (256 - other.ratio_q8).max(0) } else { 0 },
    );
    evidence.set(SegmentKind::EdgeRatio, own.near_ratio_q8());
    evidence.set(SegmentKind::HalfRatio, half_ratio_q8);
    // The halves' disparities hold at the quarter points; the line through them reaches the ends.
    let line_q6 = [first_q6 - slant_q6 / 2, last_q6 + slant_q6 / 2];
    Ok(MatchedSide { evidence, line_q6, window_q6, census_q6 })
}
