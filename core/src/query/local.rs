//! Match on demand: dislocated windows and census around one pixel over every disparity, with a
//! left-right check.
//!
//! In: the rows around the pixel, the disparity prior. Out: a disparity with its evidence.
//!
//! ```text
//! windows: four of 14 columns by 5 rows, the pixel on the border row and within 4 px of the border
//!          column of each, so that one of them covers a single surface unless the surface is thin:
//!          absolute differences of horizontal gradients, the lowest of the four at every disparity
//! census:  Hamming distances at points around the pixel
//! joint:   their weighted sum; the minimum, or one nearly as low in the range of the prior
//! check:   the window that matches best, searched from its match in the right image back in the
//!          left one
//! ```
//!
//! # Bounds
//! A window has two strips in each of five rows: 10 * 8 * 62 = 4960. Census: 15 points of 8 bits,
//! times 16: 1920. Their sum is below 2^13.
//!
//! # Cost
//! At 64 disparities: 30 and 10 strips (13 400 instructions on Armv7E-M), 15 points (3700), some 15
//! passes over a curve (6000).
//!
//! # Source
//! Fusiello, Roberto, Trucco 1997 (windows around a pixel, the best of them counts); Hirschmueller,
//! Innocent, Garibaldi 2002.

use super::evidence::{PixelEvidence, PixelKind};
use super::patch::{Patch, ROWS_REACH};
use super::prior::DisparityPrior;
use crate::curve::{CURVES, Curve, Minimum, ratio_q8};
use crate::kernel::{Strip, hamming_curve, sad_curve};
use heapless::Vec;

/// First columns of the three strips that windows consist of, relative to the pixel.
const COLUMNS: [i32; 3] = [-10, -4, 2];
/// Rows of the upper and of the lower windows.
const HALVES: [(i32, i32); 2] = [(-ROWS_REACH, 0), (0, ROWS_REACH)];
const STRIPS: usize = 2 * (ROWS_REACH as usize + 1);
/// Census points, relative to the pixel.
const CENSUS_ROWS: [i32; 3] = [-2, 0, 2];
const CENSUS_COLUMNS: [i32; 5] = [-4, -2, 0, 2, 4];
const POINTS: usize = CENSUS_ROWS.len() * CENSUS_COLUMNS.len();
/// Weight of a census bit, in steps of gradient.
const CENSUS_WEIGHT: u16 = 16;
/// Largest ratio of the lowest cost in the prior's range to the lowest cost for it to be preferred,
/// Q8.
const GUIDED_Q8: u32 = 256 + 26;
/// Disparities on both sides of the best that the second-best leaves out, px.
const NEIGHBOURHOOD: i32 = 2;
/// Limit of the left-right gap, 1/64 px.
const FAR_APART_Q6: i32 = 256;

/// Adds the costs of the strips in rows `first_row ..= last_row` with first columns `columns`.
fn add<'p>(
    (first_row, last_row): (i32, i32),
    columns: &[i32],
    strip: impl Fn(i32, i32) -> Option<Strip<'p>>,
    costs: &mut [u16],
) {
    let mut strips: Vec<Strip<'p>, STRIPS> = Vec::new();
    for row in first_row..=last_row {
        for &column in columns {
            if let Some(strip) = strip(row, column) {
                let _ = strips.push(strip); // at most two columns of a half
            }
        }
    }
    sad_curve(&strips, costs);
}

/// Disparity of the pixel, 1/64 px, and its evidence. `range` holds the disparities to compare
/// (first, number), `range_back` gives those of the left-right check from one.
pub(super) fn match_pixel(
    patch: &mut Patch<'_>,
    range: (i32, i32),
    range_back: impl Fn(i32) -> (i32, i32),
    prior: &DisparityPrior,
    curves: &mut [Curve; CURVES],
) -> (i32, PixelEvidence) {
    patch.fill(range, &CENSUS_ROWS);
    let [a, b, c, d, e, f, corner_a, corner_b, corner_c, corner_d, census, lower] = curves;
    for (half, columns) in
        HALVES.into_iter().zip([[&mut *a, &mut *b, &mut *c], [&mut *d, &mut *e, &mut *f]])
    {
        for (curve, column) in columns.into_iter().zip(COLUMNS) {
            curve.fill(range, |costs| {
                add(half, &[column], |row, at| patch.forward(row, at, range.0), costs)
            });
        }
    }
    corner_a.set_sum(a, b);
    corner_b.set_sum(b, c);
    corner_c.set_sum(d, e);
    corner_d.set_sum(e, f);
    let (windows, joint, back) = (lower, a, b);
    c.set_lower(corner_a, corner_b);
    d.set_lower(corner_c, corner_d);
    windows.set_lower(c, d);
    count_census(patch, range, census);
    joint.set_weighted_sum(windows, census, CENSUS_WEIGHT);

    let search_range = prior.search_range(range);
    let best = choose(joint, search_range);
    let at = best.at;
    let d_q6 = joint.subpixel_q6(at);

    let mut evidence = PixelEvidence::new();
    let census_cost = census.minimum_near(at, 1).cost;
    evidence.set(PixelKind::CensusRatio, ratio_q8(census_cost, census.second_best(at)));
    evidence.set(PixelKind::JointRatio, ratio_q8(best.cost, joint.second_best(at)));
    evidence.set(
        PixelKind::GuidedRatio,
        ratio_q8(best.cost, second_best_within(joint, at, search_range)),
    );

    let [above, below] = HALVES;
    let corners = [
        (&*corner_a, above, 0),
        (&*corner_b, above, 1),
        (&*corner_c, below, 0),
        (&*corner_d, below, 1),
    ];
    let mut best_window = (Minimum { at, cost: u16::MAX }, above, 0);
    for (curve, half, column) in corners {
        let near = curve.minimum_near(at, 1);
        if near.cost < best_window.0.cost {
            best_window = (near, half, column);
        }
    }
    let (Minimum { at: from, .. }, half, column) = best_window;
    let range_back = range_back(from);
    patch.fill_back(from, range_back, half);
    let columns = COLUMNS.get(column..column + 2).unwrap_or(&[]);
    back.fill(range_back, |costs| {
        add(half, columns, |row, at| patch.backward(row, at, from, range_back.0), costs)
    });
    let returned = back.minimum().at;
    evidence.set(PixelKind::LeftRightGap, gap_q8(returned << 6, d_q6));

    prior.evaluate(d_q6, &mut evidence);
    (d_q6, evidence)
}

fn count_census(patch: &Patch<'_>, range: (i32, i32), curve: &mut Curve) {
    let mut points: Vec<(u8, &[u8]), POINTS> = Vec::new();
    for row in CENSUS_ROWS {
        for column in CENSUS_COLUMNS {
            if let Some(point) = patch.census(row, column, range.0) {
                let _ = points.push(point); // POINTS at most
            }
        }
    }
    curve.fill(range, |costs| hamming_curve(&points, costs));
}

/// The lowest cost, or that among the disparities of `search_range` if it is nearly as low.
fn choose(joint: &Curve, (low, high): (i32, i32)) -> Minimum {
    let best = joint.minimum();
    let mut guided = Minimum { at: best.at, cost: u16::MAX };
    for d in low..=high {
        if let Some(cost) = joint.at(d)
            && cost < guided.cost
        {
            guided = Minimum { at: d, cost };
        }
    }
    if u32::from(guided.cost) << 8 <= u32::from(best.cost) * GUIDED_Q8 { guided } else { best }
}

fn second_best_within(joint: &Curve, at: i32, (low, high): (i32, i32)) -> u16 {
    let others = (low..=high).filter(|d| (d - at).abs() > NEIGHBOURHOOD);
    others.filter_map(|d| joint.at(d)).min().unwrap_or(u16::MAX)
}

fn gap_q8(a_q6: i32, b_q6: i32) -> i32 {
    (a_q6 - b_q6).abs().min(FAR_APART_Q6) << 2
}
