//! Hypotheses for the depth of a region: support points in it, segments in and just around it, each
//! with a weight.
//!
//! In: the candidates and support points of a run, a region. Out: a [`Neighbour`] per support
//! point, and per segment with at least one hypothesis that counts; the weight of both, and the
//! weight that outlines lost.
//!
//! ```text
//! a side's hypothesis is evaluated at three pixels in the middle of its window (4 or 5 px off
//!     the edge):
//!     fewer than two of them in the region: it is left out
//! weight = (2 p - 0.6, 0.05 ..= 1.2) * share of the three;  p by the side's own evidence and
//!     the support points around it
//! both sides have the disparity and the other side lies outside: a quarter. Such an edge is
//!     the outline, and its inner side, most often
//!     blank, is matched at the disparity of the surface beside the region
//! the other side lies outside, and no support point in the region agrees: a half
//! a mask too thin for any window, at most 4 px wide on average: its upright edges, 2 but not 4
//!     px inside of which it lies, where they are before
//!     the support points beside them
//! support points: p >= 0.8, and 5 px around them in the region: half of a segment's weight
//! in a box, surfaces near its centre are preferred: a second weight, by which the surface is
//!     selected, falls to 3/8 at the border
//! ```
//!
//! # Cost
//! Some 20 instructions a candidate, 200 for each within [`OBJECT_REACH`].

use super::cover::Cover;
use crate::area::Area;
use crate::confidence::{Model, Models};
use crate::image::Dims;
use crate::lines::Segment;
use crate::matching::consistency::Neighbour;
use crate::matching::{Candidate, Side, WINDOW_MIDDLE};
use crate::memory::OBJECT_POINTS;
use crate::support::Support;
use crate::units::quotient;

/// Largest distance from a region's area at which a segment has an influence, px.
pub(crate) const OBJECT_REACH: u16 = 6;

/// Least weight of a hypothesis, Q8: up to twice as much supports a surface, but does not count in
/// the region's total.
const LEAST_WEIGHT: u16 = 13;
/// Least number of the three pixels that have to lie in the region.
const LEAST_INSIDE: u16 = 2;
/// Distance from the edge to the pixel next to it that shows one surface alone, px.
const NEXT_TO_EDGE: i32 = 2;
/// Share of support points that say farther, less that of those that say nearer, above which an
/// outline is before what surrounds it, Q8.
const BEFORE_Q8: i16 = 16;
/// Most support points of a region that are used.
const MOST_POINTS: usize = OBJECT_POINTS;
/// Probability, Q16, that a support point has to exceed: 0.8.
const LEAST_PROBABILITY: u16 = 0xcccc;
/// Distance of the corners tested around a support point, px: half of its window, and one more.
const WINDOW_HALF: i32 = 5;
/// Difference below which the disparities of both sides are equal, 1/64 px.
const SAME_Q6: i32 = 64;

/// Number and weight of a region's hypotheses.
#[derive(Clone, Copy, Default)]
pub(crate) struct RegionSupport {
    /// Number of support points and segments listed.
    pub(crate) hypotheses: usize,
    /// Sum of the weights of credible hypotheses, Q8.
    pub(crate) weight_q8: u32,
    /// Weight that outlines lost, Q8.
    pub(crate) outline_weight_q8: u32,
}

/// Lists the hypotheses of the region at the front of `neighbours`: support points in it, then
/// segments.
pub(crate) fn gather(
    candidates: &[Candidate],
    support: Support<'_>,
    models: &Models,
    cover: &Cover<'_>,
    dims: Dims,
    neighbours: &mut [Neighbour],
) -> RegionSupport {
    let near = cover.area.grown(OBJECT_REACH, dims);
    let mut found = RegionSupport::default();
    list_points(support, cover, neighbours, &mut found);
    let points = found.hypotheses;
    for candidate in candidates.iter().filter(|candidate| touches(&candidate.segment, near)) {
        let inside = pixels_inside(&candidate.segment, WINDOW_MIDDLE, &|x, y| cover.contains(x, y));
        let [a, b] = inside;
        let is_outline = [b == 0, a == 0];
        let agree = is_agreed(candidate);
        let mut weights = [0; 2];
        let near_horizontal = candidate.segment.near_horizontal;
        let (model, edge_model) =
            (models.side(near_horizontal), &models.edge(near_horizontal).model);
        let sampled = candidate.sides.iter().zip(inside).zip(is_outline);
        for (weight, ((side, inside), is_outline)) in weights.iter_mut().zip(sampled) {
            let Some(side) = side.as_ref().filter(|_| inside >= LEAST_INSIDE) else { continue };
            let full = weigh(probability(model, side), inside);
            let lone = || !is_supported(neighbours.get(..points).unwrap_or(&[]), side);
            *weight = if agree && is_outline {
                full >> 2
            } else if is_outline && lone() {
                full >> 1
            } else {
                full
            };
            found.weight_q8 += if full > 2 * LEAST_WEIGHT { u32::from(*weight) } else { 0 };
            found.outline_weight_q8 += u32::from(full - *weight);
        }
        if let Some((index, side)) = thin_side(candidate, inside, cover) {
            let weight = weigh(edge_probability(edge_model, side), 3);
            if let Some(slot) = weights.get_mut(index) {
                *slot = weight;
                found.weight_q8 += u32::from(weight);
            }
        }
        if weights != [0; 2]
            && let Some(neighbour) = neighbours.get_mut(found.hypotheses)
        {
            *neighbour = Neighbour::new(candidate);
            for (hypothesis, weight) in neighbour.hypotheses.iter_mut().zip(weights) {
                hypothesis.weight_q8 = weight;
            }
            prefer_near(neighbour, cover);
            found.hypotheses += 1;
        }
    }
    found
}

/// Lists the support points whose windows lie in the region; of more than [`MOST_POINTS`] every
/// second, third, ...
fn list_points(
    support: Support<'_>,
    cover: &Cover<'_>,
    neighbours: &mut [Neighbour],
    found: &mut RegionSupport,
) {
    let inside = || {
        support.within(cover.area).filter(|(x, y, point)| {
            let [x0, x1] = [x - WINDOW_HALF, x + WINDOW_HALF];
            let [y0, y1] = [y - WINDOW_HALF, y + WINDOW_HALF];
            let mut corners = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)].into_iter();
            point.probability_q16 > LEAST_PROBABILITY
                && !point.is_ground_by_paths()
                && cover.contains(*x, *y)
                && corners.all(|(x, y)| cover.contains(x, y))
        })
    };
    let step = inside().count().div_ceil(MOST_POINTS.min(neighbours.len() / 2).max(1)).max(1);
    for (x, y, point) in inside().step_by(step) {
        let full = weigh(point.probability_q16, 3) >> 1;
        let Some(neighbour) = neighbours.get_mut(found.hypotheses) else { break };
        *neighbour = Neighbour::of_point(x, y, point.disparity_q6, full);
        prefer_near(neighbour, cover);
        found.weight_q8 += u32::from(full);
        found.hypotheses += 1;
    }
}

/// Sets the weight by which the surface is selected.
fn prefer_near(neighbour: &mut Neighbour, cover: &Cover<'_>) {
    let nearness_q8 = if cover.is_box() { nearness_q8(neighbour, cover) } else { 256 };
    for hypothesis in &mut neighbour.hypotheses {
        hypothesis.support = ((u32::from(hypothesis.weight_q8) * nearness_q8) >> 8) as u16;
    }
}

/// True when a support point inside the region agrees with the middle of the side.
fn is_supported(points: &[Neighbour], side: &Side) -> bool {
    points.iter().any(|neighbour| {
        let [hypothesis, _] = neighbour.hypotheses;
        (2 * i32::from(hypothesis.d_q6) - side.sum_q6()).abs() <= 3 * SAME_Q6
    })
}

/// Probability by the side's own evidence and the support points around it, Q16.
fn probability(model: &Model, side: &Side) -> u16 {
    model.probability_q16(model.with_nearby_q8(side.score_q8, side.nearby))
}

/// The side of an upright edge on which a thin region lies, and its index, where the edge lies
/// before what is beside it. One that does not is rather mistaken for the surface behind.
fn thin_side<'a>(
    candidate: &'a Candidate,
    windows: [u16; 2],
    cover: &Cover<'_>,
) -> Option<(usize, &'a Side)> {
    if !cover.is_thin || candidate.segment.near_horizontal || windows != [0; 2] {
        return None;
    }
    let index = match pixels_inside(&candidate.segment, NEXT_TO_EDGE, &|x, y| cover.contains(x, y))
    {
        [3, 0] => 0,
        [0, 3] => 1,
        _ => return None,
    };
    let side = candidate.sides.get(index)?.as_ref()?;
    (side.nearby.farther - side.nearby.nearer > BEFORE_Q8).then_some((index, side))
}

/// Probability that the edge itself has the side's disparity, by its own evidence and the support
/// points around it, Q16.
fn edge_probability(edge_model: &Model, side: &Side) -> u16 {
    edge_model.probability_q16(edge_model.with_nearby_q8(side.edge_score_q8, side.nearby))
}

/// True when the segment's bounding box meets the area.
fn touches(segment: &Segment, area: Area) -> bool {
    let (x0, y0, x1, y1) = segment.ends_q5();
    let common = |from: u16, to: u16, a: i32, b: i32| {
        a.min(b) >> 5 < i32::from(to) && a.max(b) >> 5 >= i32::from(from)
    };
    // Rows first: most candidates lie above or below.
    common(area.top, area.bottom, y0, y1) && common(area.left, area.right, x0, x1)
}

/// True when a window of the segment can count for a region with this area.
pub(crate) fn supports_area(segment: &Segment, area: Area) -> bool {
    pixels_inside(segment, WINDOW_MIDDLE, &|x, y| area.contains(x, y))
        .into_iter()
        .any(|inside| inside >= LEAST_INSIDE)
}

/// Number, 0 ..= 3, of pixels on each side, so far away from the edge, one more beside
/// near-horizontal edges, that belong to the region.
#[inline(never)]
fn pixels_inside(segment: &Segment, away: i32, contains: &dyn Fn(i32, i32) -> bool) -> [u16; 2] {
    let (x0, y0, x1, y1) = segment.ends_q5();
    let (dx, dy) = if segment.near_horizontal { (0, away + 1) } else { (away, 0) };
    let (mut before, mut after) = (0, 0);
    for sixteenth in [3, 8, 13] {
        let at = |a: i32, b: i32| (a + (((b - a) * sixteenth) >> 4) + 16) >> 5;
        let (x, y) = (at(x0, x1), at(y0, y1));
        before += u16::from(contains(x - dx, y - dy));
        after += u16::from(contains(x + dx, y + dy));
    }
    [before, after]
}

/// True when both sides have the same disparity.
fn is_agreed(candidate: &Candidate) -> bool {
    candidate.sides_apart_q6().is_some_and(|apart| apart < 2 * SAME_Q6)
}

/// Weight of a hypothesis, Q8, 8 ..= 307.
fn weigh(probability_q16: u16, inside: u16) -> u16 {
    let weight = (i32::from(probability_q16 >> 7) - 154).clamp(LEAST_WEIGHT.into(), 307);
    let share = if inside >= 3 { weight } else { (weight * 171) >> 8 };
    share as u16 // 8 ..= 307
}

/// Factor from 1 at the centre of the area to 3/8 at its border, Q8; below that outside, at least
/// 1/256.
fn nearness_q8(neighbour: &Neighbour, cover: &Cover<'_>) -> u32 {
    let [half_width, half_height] = cover.half_size;
    let [x, y] = cover.centre;
    let part = |d: i32, half: i32| quotient(d.abs() << 8, half);
    let out_q8 = part(i32::from(neighbour.x) - x, half_width)
        .max(part(i32::from(neighbour.y) - y, half_height))
        .min(409);
    (256 - ((out_q8 * 5) >> 3)).unsigned_abs()
}
