//! A near-horizontal segment: its line says nothing about disparity, the texture along it may. Each side is placed on its own.

use super::band::{Band, Search};
use super::curve::{Curve, MAX_DISPARITIES, ratio_q8};
use super::evidence::{Evidence, Kind, log2_mean_q8};
use super::{Candidate, MAX_CENSUS_RATIO_Q8, MAX_SIDE_RATIO_Q8, MIN_RANGE, MatchContext, Side, join_sides};
use crate::kernel::{STRIP, Strip, hamming_curve, sad_curve};
use crate::lines::Segment;
use crate::result::Rejection;
use crate::units::quotient;
use heapless::Vec;

/// Rows of each side's window, relative to the edge.
const SIDE_ROWS: [[i32; 4]; 2] = [[-7, -5, -3, -1], [1, 3, 5, 7]];
/// Rows of each side's census points.
const CENSUS_ROWS: [[i32; 3]; 2] = [[-5, -3, -1], [1, 3, 5]];

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

/// Cost of one side over columns `from..=to`, in blocks of eight columns that follow the line.
fn side_curve(
    line: &FlatLine,
    (from, to): (i32, i32),
    side: usize,
    shift: i32,
    search: Search,
    band: &Band<'_>,
    len: i32,
) -> (Curve, i32) {
    let mut curve = Curve::new(len);
    let mut pixels = 0;
    let blocks = (to - from + STRIP as i32) / STRIP as i32;
    let mut strips: Vec<Strip<'_>, 32> = Vec::new();
    for block in 0..blocks {
        // Blocks share the columns evenly; the last ones overlap when the length is no multiple of eight.
        let start = if blocks > 1 { from + quotient((to - from + 1 - STRIP as i32) * block, blocks - 1) } else { from };
        let y = line.row_q5((start << 5) + 112);
        for row in SIDE_ROWS.get(side).into_iter().flatten() {
            if let Some(strip) = band.strip(search, start - shift, y + row, 0) {
                let _ = strips.push(strip);
                pixels += STRIP as i32;
            }
        }
    }
    sad_curve(&strips, curve.blocks());
    (curve, pixels)
}

fn census_curve(line: &FlatLine, (from, to): (i32, i32), side: usize, band: &Band<'_>, len: i32) -> (Curve, i32) {
    let mut curve = Curve::new(len);
    let mut count = 0;
    for row in CENSUS_ROWS.get(side).into_iter().flatten() {
        let mut points: Vec<(u8, &[u8]), 31> = Vec::new();
        let mut x = from;
        while x <= to {
            if let Some(point) = band.census(Search::Forward, x, line.row(x) + row, 0) {
                let _ = points.push(point);
                count += 1;
            }
            x += 2;
        }
        hamming_curve(&points, curve.blocks());
    }
    (curve, count)
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
    let len = context.max_disparity.min(columns.0 + 1);
    if len < MIN_RANGE || len > MAX_DISPARITIES as i32 || count < 3 {
        return Err(Rejection::NearBorder);
    }
    let middle = (columns.0 + columns.1) / 2;
    let spans = [(columns.0, middle), (middle + 1, columns.1)];
    let curves = [0, 1].map(|side| {
        let [(a, pixels_a), (b, pixels_b)] =
            spans.map(|span| side_curve(&line, span, side, 0, Search::Forward, band, len));
        let whole = a.sum(&b);
        (a, b, whole, pixels_a + pixels_b)
    });
    let minima = [0_usize, 1].map(|i| {
        let (_, _, whole, _) = &curves[i];
        let best = whole.minimum();
        (best, whole.rival(best.at), ratio_q8(best.cost, whole.rival(best.at)))
    });
    let mut reasons = Rejection::WindowNotUnique;
    let mut census_q6 = 0;
    let mut window_q6 = 0;
    let mut side_of = |i: usize| -> Result<Side, Rejection> {
        let (a, b, whole, pixels) = &curves[i];
        let (best, rival, ratio) = minima[i];
        let (other_best, _, other_ratio) = minima[1 - i];
        if *pixels == 0 || ratio > MAX_SIDE_RATIO_Q8 {
            return Err(Rejection::WindowNotUnique);
        }
        let (census, census_count) = census_curve(&line, columns, i, band, len);
        let census_best = census.minimum();
        let census_near = census.minimum_near(best.at, 1);
        let census_ratio = ratio_q8(census_near.cost, census.rival(best.at));
        let whole_q6 = whole.subpixel_q6(best.at);
        let c_q6 = census.subpixel_q6(census_near.at);
        if census_ratio > MAX_CENSUS_RATIO_Q8 {
            return Err(Rejection::CensusNotUnique);
        }
        if !context.margin_holds(whole_q6, census.subpixel_q6(census_best.at)) {
            return Err(Rejection::TechniquesDisagree);
        }
        let back_len = context.max_disparity.min(context.width - columns.1 + best.at);
        let (back, _) = side_curve(&line, columns, i, best.at, Search::Back, band, back_len);
        let back_best = back.minimum();
        if (back_best.at - best.at).abs() > 1 {
            return Err(Rejection::LeftRight);
        }
        let half = |curve: &Curve| curve.subpixel_q6(curve.minimum_near(best.at, 2).at);
        let (first, last) = (half(a), half(b));
        let slant = last - first;
        census_q6 = c_q6;
        window_q6 = whole_q6;
        let mut evidence = Evidence::new();
        evidence.set(Kind::SideRatio, ratio);
        evidence.set(Kind::SideCost, log2_mean_q8(best.cost.into(), *pixels));
        evidence.set(Kind::SideMargin, log2_mean_q8(rival.saturating_sub(best.cost).into(), *pixels));
        evidence.set(Kind::CensusRatio, census_ratio);
        evidence.set(Kind::CensusCost, log2_mean_q8(census_near.cost.into(), census_count));
        evidence.set(Kind::CensusGap, (whole_q6 - c_q6).abs() << 2);
        evidence.set(Kind::BackGap, (back_best.at - best.at).abs() << 8);
        evidence.set(Kind::BackRatio, ratio_q8(back_best.cost, back.rival(back_best.at)));
        evidence.set(Kind::Slant, quotient(slant.abs() << 3, count));
        evidence.set(Kind::Length, log2_mean_q8(count as u32, 1));
        evidence.set(Kind::OtherRatio, other_ratio);
        evidence.set(Kind::OtherDiffers, i32::from((other_best.at - best.at).abs() > 1) << 8);
        evidence.set(Kind::WhichSide, if i == 0 { -256 } else { 256 });
        evidence.set(Kind::Lean, line.slope_q12.abs() >> 4);
        evidence.set(Kind::Range, log2_mean_q8(len as u32, 1));
        evidence.set(Kind::Contrast, log2_mean_q8(segment.contrast.into(), 1));
        Ok(Side::new([first - slant / 2, last + slant / 2], evidence))
    };
    let mut keep = |i: usize| match side_of(i) {
        Ok(side) => Some(side),
        Err(reason) => {
            if reason as usize > reasons as usize {
                reasons = reason;
            }
            None
        }
    };
    let mut sides = [keep(0), keep(1)];
    if sides.iter().all(Option::is_none) {
        return Err(reasons);
    }
    if let [Some(above), Some(below)] = &sides {
        let mean = |i: usize| -> Option<i32> { Some((above.disparity_q6.get(i)? + below.disparity_q6.get(i)?) / 2) };
        if let (Some(first), Some(last)) = (mean(0), mean(1)) {
            let own_q6 = [above, below].map(|side| side.disparity_q6.iter().sum::<i32>() / 2);
            join_sides(&mut sides, own_q6, 8, [first, last]);
        }
    }
    Ok(Candidate { segment: *segment, sides, window_q6, census_q6, feature_q6: None, beaten: false, listed: None })
}
