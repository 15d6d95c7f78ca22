//! Disparity prior of a pixel: by the sides of segments and the support points nearby.
//!
//! In: the candidates and the support points of a run, a pixel, the region that it belongs to, if
//! any. Out: a [`DisparityPrior`]: disparities of the sides and the points nearby, with their
//! weights.
//!
//! ```text
//! a side counts only for pixels on its side of the edge, and only for pixels of the same region
//! disparity = its line of disparity at the position next to the pixel, continued across the
//!     edge by its slant
//! weight    = (2 p - 1) * (1 - distance / reach)^2
//! a support point counts for all pixels around it, with its disparity and the same weight
//! ```
//! A side beyond an edge, whose two sides are not known to be one surface, ends before the pixel: a
//! match that agrees with it most likely comes from a window that covers that surface, and the
//! pixel lies on one behind.
//!
//! # Bounds
//! `2 p - 1` is at most 255 in Q8, nearness 48: 255 * 48^2 is below 2^20; [`MOST_SIDES`] weights of
//! at most 255 are below 2^12.
//!
//! # Cost
//! Candidates are sorted by their tops: some 15 instructions for each in the rows around, 150 for
//! each within reach.

use super::evidence::{PixelEvidence, PixelKind};
use crate::evidence::log2_mean_q8;
use crate::lines::{Line, MAX_ROWS};
use crate::matching::{Candidate, Side};
use crate::objects::Region;
use crate::support::{Support, SupportPoint};
use crate::units::{about_length, quotient};
use heapless::Vec;

/// Distance from which a side has no weight, px.
const REACH: i32 = 48;
/// Most sides that are used; those with the largest weights.
const MOST_SIDES: usize = 16;
/// Distance from which a support point has no weight, px.
const POINT_REACH: i32 = 16;
/// Most support points within that distance.
const POINTS: usize = 16;
/// Distance from the edge up to which a side's slant is continued, px.
const CONTINUED: i32 = 12;
/// Distance up to which a surface that ends before the pixel counts, px.
const ACROSS_REACH: i32 = 12;
/// Most such surfaces that are kept.
const ENDS: usize = 8;
/// Largest difference to the disparity of a surface that ends before the pixel for it to agree,
/// 1/64 px.
const SAME_SURFACE_Q6: i32 = 96;
/// Distance from the edge at which the region of a side is determined, px.
const OFF_EDGE: i32 = 3;
/// Least total weight at which the prior limits the search range, Q8: a quarter of a certain
/// feature at distance 0.
const ENOUGH_Q8: i32 = 64;
/// Largest difference of disparity to a side at distance 0 that agrees, 1/64 px.
const AGREES_Q6: i32 = 64;
/// Increase of that difference with distance, 1/64 px per px, for slanted surfaces.
const SLANT_Q6: i32 = 3;
/// Weight added to the denominator of the contradicting share, Q8: a small contradicting weight
/// counts little.
const LITTLE_Q8: i32 = 50;
/// Limit of the distance from the range of the prior, 1/64 px.
const FAR_OUTSIDE_Q6: i32 = 256;

/// Disparity of a side or a support point near the pixel, with its weight.
#[derive(Clone, Copy, Debug)]
struct NearbySide {
    /// Disparity at the pixel, 1/64 px.
    d_q6: i32,
    weight_q8: i32,
    /// Distance from the pixel, px.
    distance: i32,
}

/// Disparities of the sides and support points near a pixel, in any order.
#[derive(Debug, Default)]
pub(super) struct DisparityPrior {
    sides: Vec<NearbySide, MOST_SIDES>,
    /// Surfaces that end before the pixel.
    ends: Vec<NearbySide, ENDS>,
    /// Support points.
    points: Vec<NearbySide, POINTS>,
}

/// Point of a segment next to a pixel, px.
struct Foot {
    x: i32,
    y: i32,
    /// Distance from the first end of the segment, and the segment's length, along its main
    /// direction, px.
    along: i32,
    length: i32,
}

impl Foot {
    fn new(candidate: &Candidate, x: i32, y: i32) -> Self {
        let line = Line::of(&candidate.segment);
        let (from, to) = line.extent();
        let flat = candidate.segment.near_horizontal;
        let at = if flat { x } else { y }.max(from).min(to);
        let (x, y) = if flat { (at, line.at(at)) } else { (line.at(at), at) };
        Self { x, y, along: at - from, length: to - from }
    }
}

impl DisparityPrior {
    /// The prior of a pixel; candidates are in the order of their tops.
    pub(super) fn new(
        candidates: &[Candidate],
        support: Support<'_>,
        (x, y): (i32, i32),
        region: Option<&Region<'_>>,
    ) -> Self {
        let mut prior = Self::default();
        let first =
            candidates.partition_point(|candidate| candidate.segment.top() < y - REACH - MAX_ROWS);
        for candidate in candidates.get(first..).unwrap_or(&[]) {
            if candidate.segment.top() >= y + REACH {
                break;
            }
            prior.add_sides(candidate, (x, y), region);
        }
        for (u, v, point) in support.around((x, y), POINT_REACH) {
            let distance = about_length(x - u, y - v);
            if distance < POINT_REACH && region.is_none_or(|region| region.contains(u, v)) {
                let _ = prior.points.push(NearbySide::of_point(point, distance)); // POINTS at most within reach
            }
        }
        prior
    }

    fn add_sides(
        &mut self,
        candidate: &Candidate,
        (x, y): (i32, i32),
        region: Option<&Region<'_>>,
    ) {
        let (x0, y0, x1, y1) = candidate.segment.ends_q5();
        let beside = x <= (x0.min(x1) >> 5) - REACH || x >= (x0.max(x1) >> 5) + REACH;
        if beside || y >= (y0.max(y1) >> 5) + REACH {
            return;
        }
        let foot = Foot::new(candidate, x, y);
        let (dx, dy) = (x - foot.x, y - foot.y);
        let distance = about_length(dx, dy);
        if distance >= REACH {
            return;
        }
        let flat = candidate.segment.near_horizontal;
        let off = if flat { dy } else { dx };
        let two_surfaces = !candidate.is_one_surface();
        for (side, sign) in candidate.sides.iter().zip([-1, 1]) {
            let Some(side) = side else { continue };
            // A side rejected by the uniqueness constraint is wrong.
            if side.rejected && candidate.violates_uniqueness {
                continue;
            }
            if off * sign < 0 {
                if two_surfaces && distance <= ACROSS_REACH {
                    let _ = self.ends.push(NearbySide::new(side, &foot, 0, distance)); // a few are enough
                }
                continue;
            }
            let (u, v) = if flat {
                (foot.x, foot.y + sign * OFF_EDGE)
            } else {
                (foot.x + sign * OFF_EDGE, foot.y)
            };
            if region.is_none_or(|region| region.contains(u, v)) {
                self.add(NearbySide::new(side, &foot, off.abs(), distance));
            }
        }
    }

    /// Adds a side, or replaces the one with the least weight.
    fn add(&mut self, side: NearbySide) {
        if side.weight_q8 == 0 {
            return;
        }
        let Err(side) = self.sides.push(side) else { return };
        if let Some(least) = self.sides.iter_mut().min_by_key(|side| side.weight_q8)
            && least.weight_q8 < side.weight_q8
        {
            *least = side;
        }
    }

    /// Sides and points with a weight above 0.
    fn weighted(&self) -> impl Iterator<Item = &NearbySide> {
        self.sides.iter().chain(&self.points).filter(|side| side.weight_q8 > 0)
    }

    fn span_q6(&self) -> (i32, i32) {
        let each = || self.weighted().map(|side| side.d_q6);
        (each().min().unwrap_or(i32::MIN), each().max().unwrap_or(i32::MAX))
    }

    /// First and last disparity to search, px: the range of the sides and points and 1 px more; all
    /// of the given range where their weight is too small.
    pub(super) fn search_range(&self, (first, len): (i32, i32)) -> (i32, i32) {
        let last = first + len - 1;
        let weight: i32 = self.weighted().map(|side| side.weight_q8).sum();
        if weight < ENOUGH_Q8 {
            return (first, last);
        }
        let (low_q6, high_q6) = self.span_q6();
        (((low_q6 >> 6) - 1).max(first), ((high_q6 >> 6) + 2).min(last))
    }

    /// Sets the evidence by the prior for a disparity.
    pub(super) fn evaluate(&self, d_q6: i32, evidence: &mut PixelEvidence) {
        let (agreeing, _) = weigh(&self.sides, d_q6);
        let (points_agreeing, points_conflicting) = weigh(&self.points, d_q6);
        let ends = self.ends.iter().filter(|side| (side.d_q6 - d_q6).abs() <= SAME_SURFACE_Q6);
        let across: i32 = ends.map(|side| side.weight_q8).sum();
        let (low_q6, high_q6) = self.span_q6();
        let outside_q6 = if self.weighted().next().is_none() {
            FAR_OUTSIDE_Q6 / 2
        } else {
            (low_q6 - d_q6).max(d_q6 - high_q6).clamp(0, FAR_OUTSIDE_Q6)
        };
        let log = |weight: i32| log2_mean_q8(weight.unsigned_abs(), ENOUGH_Q8);
        let points = points_agreeing + points_conflicting + LITTLE_Q8;
        evidence.set(PixelKind::Support, log(agreeing));
        evidence.set(PixelKind::Across, log(across));
        evidence.set(PixelKind::Outside, outside_q6 << 2);
        evidence.set(PixelKind::PointsAgreeing, log(points_agreeing));
        evidence.set(PixelKind::PointsConflicting, quotient(points_conflicting << 8, points));
    }
}

/// Weights of the sides that agree with a disparity, and of those that contradict it.
fn weigh(sides: &[NearbySide], d_q6: i32) -> (i32, i32) {
    sides.iter().fold((0, 0), |(agreeing, against), side| {
        let agrees = (side.d_q6 - d_q6).abs() <= AGREES_Q6 + SLANT_Q6 * side.distance;
        if agrees {
            (agreeing + side.weight_q8, against)
        } else {
            (agreeing, against + side.weight_q8)
        }
    })
}

/// Weight of a side with this probability at this distance, Q8.
fn weight_q8(probability_q16: u16, distance: i32, reach: i32) -> i32 {
    let credible_q8 = (i32::from(probability_q16) - (1 << 15)).max(0) >> 7;
    let nearness = reach - distance;
    quotient(credible_q8 * nearness * nearness, reach * reach)
}

impl NearbySide {
    fn of_point(point: &SupportPoint, distance: i32) -> Self {
        let weight_q8 = weight_q8(point.probability_q16, distance, POINT_REACH);
        Self { d_q6: point.disparity_q6.into(), weight_q8, distance }
    }

    fn new(side: &Side, foot: &Foot, off: i32, distance: i32) -> Self {
        let [d0, d1] = side.disparity_q6.map(i32::from);
        let edge_q6 = d0 + quotient((d1 - d0) * foot.along, foot.length);
        Self {
            d_q6: edge_q6 + ((i32::from(side.across_q10) * off.min(CONTINUED)) >> 4),
            weight_q8: weight_q8(side.probability_q16, distance, REACH),
            distance,
        }
    }
}
