//! Who speaks of a region: the claims of segments in and just around it, each with a weight.
//!
//! In: the candidates of a run, a region. Out: a [`Place`] per segment with at least one claim that counts, and what was withheld.
//!
//! ```text
//! a side's claim is asked at three pixels in the middle of its own window (they are that far off the edge):
//!     fewer than two of them in the region: the claim is about something else
//! weight = (2 p - 0.6, 0.05 ..= 1.2) * share of the three;  p by the side's own evidence, without neighbours
//! both sides have the disparity and the other side lies outside: a quarter. Such an edge is the outline, and its inner side, most often
//!     blank, seems to have the disparity of whatever stands beside the region
//! in a box, what is chosen is the surface near its centre: a second weight falls to 3/8 at the border
//! ```
//! Nothing here comes from candidates elsewhere: neither neighbours nor exclusion, nor what lists could hold.
//!
//! # Cost
//! Some 20 instructions a candidate, 200 for each within [`OBJECT_REACH`].

use super::cover::Cover;
use crate::area::Area;
use crate::confidence::Models;
use crate::image::Dims;
use crate::lines::Segment;
use crate::matching::Candidate;
use crate::matching::consistency::Place;

/// What is said of a region depends on segments that lie, wholly or in part, within so many pixels of its area, and on no others.
pub(crate) const OBJECT_REACH: u16 = 6;

/// Weight of the least credible claim, 1/256: so little, and up to twice that, supports a surface but speaks against none.
const LEAST_WEIGHT: u16 = 13;
/// Of three pixels, so many have to lie in the region.
const LEAST_INSIDE: u16 = 2;
/// Distance from the edge at which a claim is asked: the middle of its window. One more beside near-horizontal edges.
const WINDOW_MIDDLE: i32 = 4;
/// Disparities of both sides closer than this are one.
const SAME_Q6: i32 = 64;

/// All claims of a region.
#[derive(Clone, Copy, Default)]
pub(crate) struct Witnesses {
    /// Segments listed.
    pub(crate) segments: usize,
    /// Sum of the weights of credible claims, 1/256.
    pub(crate) weight_q8: u32,
    /// Weight that outlines lost.
    pub(crate) withheld_q8: u32,
}

/// Lists the segments that say something of the region at the front of `places`.
pub(crate) fn gather(
    candidates: &[Candidate],
    models: &Models,
    (cover, area, dims): (&Cover<'_>, Area, Dims),
    places: &mut [Place],
) -> Witnesses {
    let near = area.grown(OBJECT_REACH, dims);
    let mut found = Witnesses::default();
    for candidate in candidates.iter().filter(|candidate| touches(&candidate.segment, near)) {
        let inside = pixels_inside(&candidate.segment, |x, y| cover.contains(x, y));
        let [a, b] = inside;
        let is_outline = [b == 0, a == 0];
        let agree = is_agreed(candidate);
        let mut weights = [0; 2];
        let (model, _) = models.of(candidate.segment.near_horizontal);
        let asked = candidate.sides.iter().zip(inside).zip(is_outline);
        for (weight, ((side, inside), is_outline)) in weights.iter_mut().zip(asked) {
            let Some(side) = side.as_ref().filter(|_| inside >= LEAST_INSIDE) else { continue };
            let full = weigh(model.probability_q16(side.score_q8.into()), inside);
            *weight = if agree && is_outline { full >> 2 } else { full };
            found.weight_q8 += if full > 2 * LEAST_WEIGHT { u32::from(*weight) } else { 0 };
            found.withheld_q8 += u32::from(full - *weight);
        }
        if weights != [0; 2]
            && let Some(place) = places.get_mut(found.segments)
        {
            *place = Place::new(candidate);
            let nearness_q8 = if cover.is_box() { nearness_q8(place, cover) } else { 256 };
            for (claim, weight) in place.claims.iter_mut().zip(weights) {
                claim.weight_q8 = weight;
                claim.agreeing = ((u32::from(weight) * nearness_q8) >> 8) as u16;
            }
            found.segments += 1;
        }
    }
    found
}

/// Does any of it lie in the area?
fn touches(segment: &Segment, area: Area) -> bool {
    let (x0, y0, x1, y1) = segment.ends_q5();
    let common = |from: u16, to: u16, a: i32, b: i32| a.min(b) >> 5 < i32::from(to) && a.max(b) >> 5 >= i32::from(from);
    // Rows first: most candidates lie above or below.
    common(area.top, area.bottom, y0, y1) && common(area.left, area.right, x0, x1)
}

/// Can it speak of a region with this area? Only such segments are asked.
pub(crate) fn may_speak(segment: &Segment, area: Area) -> bool {
    pixels_inside(segment, |x, y| area.contains(x, y)).into_iter().any(|inside| inside >= LEAST_INSIDE)
}

/// How many of three pixels in the middle of each side's window belong to the region.
#[inline]
fn pixels_inside(segment: &Segment, contains: impl Fn(i32, i32) -> bool) -> [u16; 2] {
    let (x0, y0, x1, y1) = segment.ends_q5();
    let (dx, dy) = if segment.near_horizontal { (0, WINDOW_MIDDLE + 1) } else { (WINDOW_MIDDLE, 0) };
    let (mut before, mut after) = (0, 0);
    for sixteenth in [3, 8, 13] {
        let at = |a: i32, b: i32| (a + (((b - a) * sixteenth) >> 4) + 16) >> 5;
        let (x, y) = (at(x0, x1), at(y0, y1));
        before += u16::from(contains(x - dx, y - dy));
        after += u16::from(contains(x + dx, y + dy));
    }
    [before, after]
}

/// Do both sides have the same disparity?
fn is_agreed(candidate: &Candidate) -> bool {
    candidate.sides_apart_q6().is_some_and(|apart| apart < 2 * SAME_Q6)
}

/// 1/256; at most 307.
fn weigh(probability_q16: u16, inside: u16) -> u16 {
    let weight = (i32::from(probability_q16 >> 7) - 154).clamp(LEAST_WEIGHT.into(), 307);
    let share = if inside >= 3 { weight } else { (weight * 171) >> 8 };
    share as u16 // 8 ..= 307
}

/// 1 at the centre of the area to 3/8 at its border, 1/256.
fn nearness_q8(place: &Place, cover: &Cover<'_>) -> u32 {
    let [half_width, half_height] = cover.half_size;
    let [x, y] = cover.centre;
    let part = |d: i32, half: i32| crate::units::quotient(d.abs() << 8, half);
    let out_q8 = part(i32::from(place.x) - x, half_width).max(part(i32::from(place.y) - y, half_height)).min(409);
    (256 - ((out_q8 * 5) >> 3)).unsigned_abs()
}
