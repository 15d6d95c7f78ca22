//! A near-horizontal segment: its line says nothing about disparity, the texture along it may. Each side is placed on its own.
//!
//! In: a left segment and the band of rows around it. Out: a candidate with a line of disparity for each side that has one clear minimum,
//! or the name of the test at which the better side failed.
//!
//! ```text
//! for each side: window:  rows beside the edge, over every disparity; unique?
//!                census:  Hamming distances beside the edge; unique? within the margin of the window?
//!                back:    from the place found in the right image to within 1 px?
//!                halves:  a disparity for each half gives the line of disparity along the segment
//! sides that agree are one surface
//! ```
//!
//! # Bounds
//! At most 4 blocks of 4 rows of 8 pixels, 126 each: 16 128. Census: at most 12 points a row, 3 rows, 8 bits each.

use super::aggregate::join_sides;
use super::band::{Band, Search};
use super::curve::{Curve, Minimum, ratio_q8};
use super::evidence::{Evidence, Kind, log2_mean_q8};
use super::{Candidate, MAX_CENSUS_RATIO_Q8, MAX_SIDE_RATIO_Q8, MatchContext, Side};
use crate::kernel::{STRIP, Strip, hamming_curve, sad_curve};
use crate::lines::Segment;
use crate::result::Rejection;
use crate::units::quotient;
use heapless::Vec;

/// Rows of each side's window, relative to the edge: every second one says as much as all seven.
const SIDE_ROWS: [[i32; 2]; 2] = [[-5, -2], [2, 5]];
/// Between the centres of the two sides' windows.
const SIDES_APART: i32 = 8;
/// Rows of each side's census points.
const CENSUS_ROWS: [[i32; 2]; 2] = [[-4, -2], [2, 4]];
/// Disparities around the whole side's in which a half is sought.
const HALF_REACH: i32 = 2;

/// A line y(x) in 1/32 px with its column range.
#[derive(Clone, Copy)]
pub(crate) struct FlatLine {
    x0: i32,
    y0: i32,
    x1: i32,
    /// dy/dx, Q12.
    slope_q12: i32,
}

impl FlatLine {
    pub(crate) fn new(segment: &Segment) -> Self {
        let (x0, y0, x1, y1) = segment.ends_q5();
        let slope_q12 = quotient((y1 - y0) << 12, x1 - x0).clamp(-(8 << 12), 8 << 12);
        Self { x0, y0, x1, slope_q12 }
    }

    /// First and last whole column.
    pub(crate) fn columns(&self) -> (i32, i32) {
        ((self.x0 + 31) >> 5, self.x1 >> 5)
    }

    /// Nearest row at a column given in 1/32 px.
    fn row_q5(&self, x_q5: i32) -> i32 {
        (self.y0 + (((x_q5 - self.x0) * self.slope_q12 + 2048) >> 12) + 16) >> 5
    }

    /// Nearest row at a whole column.
    pub(crate) fn row(&self, x: i32) -> i32 {
        self.row_q5(x << 5)
    }
}

/// Window curves of one side: of its two halves and of the whole.
struct SideWindows {
    halves: [Curve; 2],
    whole: Curve,
    pixels: i32,
    best: Minimum,
    rival: u16,
    ratio_q8: i32,
}

/// Matches both sides of one piece, or names the test at which the better side failed.
pub(crate) fn match_flat(
    segment: &Segment,
    context: &MatchContext<'_>,
    band: &Band<'_>,
) -> Result<Candidate, Rejection> {
    let line = FlatLine::new(segment);
    let columns = line.columns();
    let count = columns.1 - columns.0 + 1;
    let range = context.range_before(columns.0)?;
    if count < 3 {
        return Err(Rejection::NearBorder);
    }
    let mut shared = Evidence::new();
    shared.set(Kind::Length, log2_mean_q8(count.unsigned_abs(), 1));
    shared.set(Kind::Lean, line.slope_q12.abs() >> 4);
    shared.set(Kind::Range, log2_mean_q8(range.1.unsigned_abs(), 1));
    shared.set(Kind::Contrast, log2_mean_q8(segment.contrast.into(), 1));

    let [above_rows, below_rows] = SIDE_ROWS;
    let [above_points, below_points] = CENSUS_ROWS;
    let above = SideWindows::new(&line, columns, above_rows, range, band);
    let below = SideWindows::new(&line, columns, below_rows, range, band);
    let placed = [
        place(&line, (&above, above_rows, above_points), &below, shared.with(Kind::WhichSide, -256), context, band),
        place(&line, (&below, below_rows, below_points), &above, shared.with(Kind::WhichSide, 256), context, band),
    ];
    let (window_q6, census_q6) = match &placed {
        [Ok(a), Ok(b)] if b.side.evidence.get(Kind::SideRatio) < a.side.evidence.get(Kind::SideRatio) => b.techniques(),
        [Ok(a), _] => a.techniques(),
        [_, Ok(b)] => b.techniques(),
        // The reason that comes last in the order of tests: the side that came further.
        [Err(a), Err(b)] => return Err(if *a as usize >= *b as usize { *a } else { *b }),
    };
    let mut sides = placed.map(|side| side.ok().map(|placed| placed.side));
    if let [Some(a), Some(b)] = &sides {
        let ([a0, a1], [b0, b1]) = (a.disparity_q6, b.disparity_q6);
        let line_q6 = [(a0 + b0) / 2, (a1 + b1) / 2];
        join_sides(&mut sides, [(a0 + a1) / 2, (b0 + b1) / 2], SIDES_APART, line_q6);
    }
    Ok(Candidate::new(*segment, sides, window_q6, census_q6, None))
}

impl SideWindows {
    fn new(line: &FlatLine, (first, last): (i32, i32), rows: [i32; 2], range: (i32, i32), band: &Band<'_>) -> Self {
        let middle = (first + last) / 2;
        let mut halves = [const { Curve::EMPTY }; 2];
        let mut pixels = 0;
        for (curve, columns) in halves.iter_mut().zip([(first, middle), (middle + 1, last)]) {
            curve.clear(range);
            pixels += add_blocks(line, columns, rows, 0, Search::Forward, band, curve);
        }
        let [a, b] = &halves;
        let whole = a.sum(b);
        let best = whole.minimum();
        let rival = whole.rival(best.at);
        Self { halves, whole, pixels, best, rival, ratio_q8: ratio_q8(best.cost, rival) }
    }
}

/// Adds the cost of one side over `columns`, in blocks of eight that follow the line, moved left by `shift`; returns the pixels compared.
fn add_blocks(
    line: &FlatLine,
    (from, to): (i32, i32),
    rows: [i32; 2],
    shift: i32,
    search: Search,
    band: &Band<'_>,
    curve: &mut Curve,
) -> i32 {
    const WIDTH: i32 = STRIP as i32;
    let blocks = (to - from + WIDTH) / WIDTH;
    let mut strips: Vec<Strip<'_>, 32> = Vec::new();
    for block in 0..blocks {
        // Blocks share the columns evenly; they overlap when the length is no multiple of eight.
        let start = from + quotient((to - from + 1 - WIDTH) * block, blocks - 1);
        let y = line.row_q5((start << 5) + 112);
        for row in rows {
            if let Some(strip) = band.strip(search, start - shift, (y + row) & !1, curve.first()) {
                let _ = strips.push(strip); // at most 4 blocks
            }
        }
    }
    sad_curve(&strips, curve.blocks());
    i32::try_from(strips.len()).unwrap_or(0) * WIDTH
}

/// Census curve of one side, and its points.
fn census_curve(
    line: &FlatLine,
    (from, to): (i32, i32),
    rows: [i32; 2],
    range: (i32, i32),
    band: &Band<'_>,
) -> (Curve, i32) {
    let mut curve = Curve::EMPTY;
    curve.clear(range);
    let mut count = 0;
    for row in rows {
        let mut points: Vec<(u8, &[u8]), 31> = Vec::new();
        let mut x = from;
        while x <= to {
            if let Some(point) = band.census(Search::Forward, x, (line.row(x) + row) & !1, curve.first()) {
                let _ = points.push(point); // every second of at most 25 columns
                count += 1;
            }
            x += 2;
        }
        hamming_curve(&points, curve.blocks());
    }
    (curve, count)
}

/// A side that passed every test.
struct Placed {
    side: Side,
    window_q6: i32,
    census_q6: i32,
}

impl Placed {
    fn techniques(&self) -> (i32, i32) {
        (self.window_q6, self.census_q6)
    }
}

/// Places one side by its window, census and the search back.
fn place(
    line: &FlatLine,
    (own, window_rows, census_rows): (&SideWindows, [i32; 2], [i32; 2]),
    other: &SideWindows,
    shared: Evidence,
    context: &MatchContext<'_>,
    band: &Band<'_>,
) -> Result<Placed, Rejection> {
    let at = own.best.at;
    if own.pixels == 0 || own.ratio_q8 > MAX_SIDE_RATIO_Q8 {
        return Err(Rejection::WindowNotUnique);
    }
    let columns = line.columns();
    let (census, points) = census_curve(line, columns, census_rows, context.range_before(columns.0)?, band);
    let census_near = census.minimum_near(at, 1);
    let census_ratio_q8 = ratio_q8(census_near.cost, census.rival(at));
    if census_ratio_q8 > MAX_CENSUS_RATIO_Q8 {
        return Err(Rejection::CensusNotUnique);
    }
    let window_q6 = own.whole.subpixel_q6(at);
    if !context.agreement.holds(window_q6, census.subpixel_q6(census.minimum().at)) {
        return Err(Rejection::TechniquesDisagree);
    }
    let census_q6 = census.subpixel_q6(census_near.at);

    let mut back = Curve::EMPTY;
    back.clear(context.range_after(columns.1 - at));
    add_blocks(line, columns, window_rows, at, Search::Back, band, &mut back);
    let back_best = back.minimum();
    let back_gap = (back_best.at - at).abs();
    if back_gap > 1 {
        return Err(Rejection::LeftRight);
    }

    let [first_q6, last_q6] =
        own.halves.each_ref().map(|curve| curve.subpixel_q6(curve.minimum_near(at, HALF_REACH).at));
    let slant_q6 = last_q6 - first_q6;
    let mut evidence = shared;
    evidence.set(Kind::SideRatio, own.ratio_q8);
    evidence.set(Kind::SideCost, log2_mean_q8(own.best.cost.into(), own.pixels));
    evidence.set(Kind::SideMargin, log2_mean_q8(own.rival.saturating_sub(own.best.cost).into(), own.pixels));
    evidence.set(Kind::CensusRatio, census_ratio_q8);
    evidence.set(Kind::CensusCost, log2_mean_q8(census_near.cost.into(), points));
    evidence.set(Kind::CensusGap, (window_q6 - census_q6).abs() << 2);
    evidence.set(Kind::BackGap, back_gap << 8);
    evidence.set(Kind::BackRatio, ratio_q8(back_best.cost, back.rival(back_best.at)));
    evidence.set(Kind::Slant, quotient(slant_q6.abs() << 3, columns.1 - columns.0 + 1));
    evidence.set(Kind::OtherRatio, other.ratio_q8);
    evidence.set(Kind::OtherDiffers, i32::from((other.best.at - at).abs() > 1) << 8);
    // The halves' disparities hold at the quarter points; the line through them reaches the ends.
    let side = Side::new([first_q6 - slant_q6 / 2, last_q6 + slant_q6 / 2], evidence);
    Ok(Placed { side, window_q6, census_q6 })
}
