//! Tests that a region's surface has to pass before its depth is answered.
//!
//! In: the surface, the weights of the region's hypotheses, the support points in and around the
//! region. Out: the reason why it is refused, or none.
//!
//! ```text
//! weight:      one hypothesis of high probability whose window lies in the region, without what
//!              outlines lost
//! others:      mask: a second surface with 7/8 of the weight.  box: surface in a corner with less
//!              than 3/4 of all weight
//! support points, by p, within 1.5 px of the plane (on it) or more than 3 px off (nearer,
//!     farther); all matched ones, not credible ones alone:
//!     contradicted   nearer + farther > 1.5 on, in the region; in a box, which holds background, 3
//!                    on
//!     surroundings   share on the plane < 7/8 in the region, and up to 24 px around it > 3/4 of
//!                    that: the surface is what stands beside the region
//!     beside         a third of what surrounds the region is on the plane, and in it less than
//!                    0.2 a point: paths carry the disparity beside a blank face over its border
//!     blank          thrice as much on the plane around the region as in it, and in it less than
//!                    1/6 a point of the grid, matched or not
//!     pattern        the windows of twice as many points in the region repeat
//!     hole           0.7 of what surrounds the region is nearer, and in it less than 0.2 a point
//!                    is on the plane: periodic texture and damaged pairs give such surfaces, and a
//!                    surface seen in a gap is seldom so poorly matched
//!     none of them for a mask of at most 4 px a row: points in it show what is behind
//! parallax:    at least 0.75 px
//! ```
//! Constants are round numbers at which no right answer of 14 undamaged QVGA scenes is lost; tried
//! on the same at 224 px, on eight scenes at a third of Middlebury's size and three at 480 px
//! (`linestereo-lab faults`).
//!
//! # Cost
//! Some 30 instructions a support point in or within 24 px of the region.

use super::Reason;
use super::cover::Cover;
use super::region_support::RegionSupport;
use super::surface::Surface;
use crate::image::Dims;
use crate::support::{SUPPORT_PITCH, SURROUNDINGS, Support};
use crate::units::quotient;

/// Least disparity of an answer, 1/64 px: the range of depths that one standard deviation spans is
/// as large as the depth. With the offset of a rig it is a thin slice of near depths instead, which
/// is given up: what stays at its pixel is rather dirt, overlaid text or the pattern of a sensor.
const STILL_Q6: i32 = 48;
/// Least weight of an answer, Q8: one hypothesis of high probability whose window lies in the
/// region.
const LEAST_WEIGHT_Q8: i32 = 282;
/// Largest distance of a support point on the plane, and least of one that contradicts it, 1/64 px.
const ON_Q6: i32 = 96;
const OFF_Q6: i32 = 192;
/// Number of pixels for each point of the grid.
const POINT_PIXELS: u32 = (SUPPORT_PITCH * SUPPORT_PITCH) as u32;
/// Least sum of probabilities in the region for support points to refuse a surface, Q8.
const LEAST_POINTS_Q8: u32 = 256;

/// Reason why the surface is refused, if it is.
pub(super) fn refusal(
    surface: &Surface,
    found: &RegionSupport,
    cover: &Cover<'_>,
    support: Support<'_>,
    dims: Dims,
) -> Option<Reason> {
    by_weight(surface, found)
        .or_else(|| has_equal(surface, found, cover).then_some(Reason::TwoSurfaces))
        .or_else(|| (surface.centre_q6.abs() < STILL_Q6).then_some(Reason::NoParallax))
        .or_else(|| {
            // The windows of points in a thin region show what is behind it.
            let agreement = || Agreement::of(surface, cover, support, dims).refusal(cover.is_box());
            if cover.is_thin { None } else { agreement() }
        })
}

fn by_weight(surface: &Surface, found: &RegionSupport) -> Option<Reason> {
    let with_outline =
        i32::try_from(found.weight_q8.saturating_add(found.outline_weight_q8)).unwrap_or(i32::MAX);
    let is_outline = found.outline_weight_q8 > 0 && with_outline >= LEAST_WEIGHT_Q8;
    let reason = if is_outline { Reason::OnlyOutline } else { Reason::LittleSupport };
    (surface.weight_q8 < LEAST_WEIGHT_Q8).then_some(reason)
}

/// True when another surface explains the region as well.
fn has_equal(surface: &Surface, found: &RegionSupport, cover: &Cover<'_>) -> bool {
    let weight = surface.weight_q8;
    if cover.is_box() {
        // The nearest surface may be another object that reaches into a corner, above all where the
        // own one has little texture.
        i64::from(weight) * 4 < i64::from(found.weight_q8) * 3
            && is_in_a_corner(surface, cover.half_size)
    } else {
        u64::from(surface.second_weight_q8) * 8 >= u64::from(weight.unsigned_abs()) * 7
    }
}

/// True when the mean position of its hypotheses is more than 0.6 from the centre and their
/// standard deviation less than 0.3, in half sizes of the region.
fn is_in_a_corner(surface: &Surface, half_size: [i32; 2]) -> bool {
    let part_q8 = |value: i32, of: i32| quotient(value.min(1 << 22) << 8, of);
    let [width2, height2] = half_size.map(|half| half * half);
    let ([u, v], [uu, vv]) = (surface.middle, surface.extent2);
    part_q8(u * u, width2) + part_q8(v * v, height2) > 92
        && part_q8(uu, width2).max(part_q8(vv, height2)) < 23
}

/// Probabilities of support points, Q8, summed by where these lie relative to the plane. Below
/// 2^23: 2^15 points.
#[derive(Clone, Copy, Default)]
struct Sums {
    points: u32,
    all: u32,
    on: u32,
    nearer: u32,
    farther: u32,
}

impl Sums {
    /// Counts a point with this probability, Q8, so far nearer than the plane, 1/64 px.
    fn add(&mut self, nearer_q6: i32, probability_q8: u32) {
        self.points += 1;
        self.all += probability_q8;
        if nearer_q6.abs() <= ON_Q6 {
            self.on += probability_q8;
        } else if nearer_q6 > OFF_Q6 {
            self.nearer += probability_q8;
        } else if nearer_q6 < -OFF_Q6 {
            self.farther += probability_q8;
        }
    }
}

/// Support points in a region and around it against the region's plane.
struct Agreement {
    /// Number of the region's pixels.
    pixels: u32,
    /// Points in it whose windows repeat.
    repeating: u32,
    inside: Sums,
    around: Sums,
}

impl Agreement {
    fn of(surface: &Surface, cover: &Cover<'_>, support: Support<'_>, dims: Dims) -> Self {
        let (mut inside, mut around) = (Sums::default(), Sums::default());
        let [x0, y0] = cover.centre;
        for (x, y, point) in support.within(cover.area.grown(SURROUNDINGS, dims)) {
            let sums = if cover.contains(x, y) { &mut inside } else { &mut around };
            let nearer_q6 = i32::from(point.disparity_q6) - surface.at_q6(x - x0, y - y0);
            sums.add(nearer_q6, u32::from(point.probability_q16) >> 8);
        }
        let repeating = support.repeating(cover.area, |x, y| cover.contains(x, y));
        Self { pixels: cover.pixels, repeating, inside, around }
    }

    fn refusal(&self, is_box: bool) -> Option<Reason> {
        let Self { pixels, repeating, inside, around } = self;
        if repeating << 8 > 2 * inside.on {
            return Some(Reason::LittleSupport);
        }
        if inside.all < LEAST_POINTS_Q8 {
            return None;
        }
        let is_part = 8 * inside.on < 7 * inside.all;
        let product = |of: u32, by: u32| u64::from(of) * u64::from(by);
        let is_beside =
            is_part && 4 * product(around.on, inside.all) > 3 * product(inside.on, around.all);
        let off = inside.nearer + inside.farther;
        let is_poor = 5 * inside.on < 256 * inside.points;
        let is_blank = 6 * inside.on < 256 * (pixels / POINT_PIXELS) && around.on > 3 * inside.on;
        if off > if is_box { 3 * inside.on } else { inside.on + inside.on / 2 } {
            Some(Reason::TwoSurfaces)
        } else if is_beside || is_blank || is_poor && 3 * around.on > around.all {
            Some(Reason::OnlyOutline)
        } else {
            // 0.7
            (is_poor && 10 * around.nearer > 7 * around.all).then_some(Reason::LittleSupport)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of probability 1: on the plane, nearer, farther.
    fn points(on: u32, nearer: u32, farther: u32) -> Sums {
        let mut sums = Sums::default();
        for (count, nearer_q6) in [(on, ON_Q6), (nearer, OFF_Q6 + 1), (farther, -OFF_Q6 - 1)] {
            (0..count).for_each(|_| sums.add(nearer_q6, 256));
        }
        sums
    }

    fn refused(inside: Sums, around: Sums) -> [Option<Reason>; 2] {
        refused_of(inside.points, inside, around)
    }

    /// Of a region of so many points of the grid.
    fn refused_of(places: u32, inside: Sums, around: Sums) -> [Option<Reason>; 2] {
        let pixels = places * POINT_PIXELS;
        [false, true]
            .map(|is_box| Agreement { pixels, repeating: 0, inside, around }.refusal(is_box))
    }

    #[test]
    fn points_that_contradict_refuse_a_mask_before_a_box() {
        let around = points(0, 0, 20);
        assert_eq!(refused(points(10, 7, 8), around), [None, None]);
        assert_eq!(refused(points(10, 8, 8), around), [Some(Reason::TwoSurfaces), None]);
        assert_eq!(refused(points(10, 0, 31), around), [Some(Reason::TwoSurfaces); 2]);
    }

    #[test]
    fn a_surface_of_the_surroundings_is_refused_unless_the_region_is_all_of_it() {
        assert_eq!(refused(points(6, 0, 4), points(8, 12, 0)), [None, None]);
        assert_eq!(refused(points(6, 0, 4), points(10, 10, 0)), [Some(Reason::OnlyOutline); 2]);
        assert_eq!(refused(points(9, 0, 1), points(20, 0, 0)), [None, None]);
    }

    /// Ten points, so many of them of probability 1 and the others of none.
    fn doubtful(on: u32) -> Sums {
        let mut sums = points(on, 0, 0);
        (on..10).for_each(|_| sums.add(0, 0));
        sums
    }

    #[test]
    fn a_blank_region_has_not_the_surface_beside_it() {
        // Of six points of the grid: a sixth of them is on the plane.
        assert_eq!(refused_of(6, doubtful(1), points(7, 0, 13)), [Some(Reason::OnlyOutline); 2]);
        assert_eq!(refused_of(6, doubtful(1), points(6, 0, 14)), [None, None]);
        assert_eq!(refused_of(6, doubtful(2), points(7, 0, 13)), [None, None]);
    }

    #[test]
    fn a_region_with_few_matched_points_has_not_one_of_several_surfaces_around_it() {
        assert_eq!(
            refused_of(7, points(1, 0, 0), points(4, 0, 30)),
            [Some(Reason::OnlyOutline); 2]
        );
        assert_eq!(refused_of(7, points(1, 0, 0), points(3, 0, 30)), [None, None]);
        assert_eq!(refused_of(6, points(1, 0, 0), points(4, 0, 30)), [None, None]);
    }

    #[test]
    fn a_hole_needs_points_that_are_well_matched() {
        assert_eq!(refused(doubtful(1), points(0, 15, 5)), [Some(Reason::LittleSupport); 2]);
        assert_eq!(refused(doubtful(2), points(0, 15, 5)), [None, None]);
        assert_eq!(refused(doubtful(1), points(0, 14, 6)), [None, None]);
    }

    #[test]
    fn a_region_of_a_pattern_has_no_depth_where_a_part_of_it_seems_matched() {
        let refused = |repeating| {
            let (inside, around) = (points(5, 0, 0), points(0, 0, 20));
            Agreement { pixels: 20 * POINT_PIXELS, repeating, inside, around }.refusal(false)
        };
        assert_eq!([10, 11].map(refused), [None, Some(Reason::LittleSupport)]);
    }

    #[test]
    fn few_points_refuse_nothing() {
        let mut sums = Sums::default();
        sums.add(OFF_Q6 + 1, LEAST_POINTS_Q8 - 1);
        assert_eq!(refused(sums, points(0, 20, 0)), [None, None]);
    }
}
