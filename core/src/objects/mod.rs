//! Regions of a detector -> the depth of each, or the reason why there is none.
//!
//! In: the candidates and support points of the last run, and regions. Out: an [`ObjectDepth`]
//! each.
//!
//! ```text
//! cover:   the region's pixels, its centre
//! region_support: hypotheses whose windows lie in it, or whose edges where it is thinner than
//!                 windows, each with a weight; without support points that their neighbours alone
//!                 put on the ground
//! surface: the plane of disparity with the largest support (in a box: the nearest one with
//!     enough support)
//! refusal: where its weight is small, where it lies on the outline only, where a second surface or
//!          the support points contradict it, where it has no parallax
//! answer:  its value at the region's centre, limited to the range of its hypotheses and 1/4 px
//!          more
//! sigma^2 = 1/8^2 + 0.4^2 / weight + (distance of the hypotheses' middle from the region's /
//!     48)^2 + (range of their disparities / 8)^2
//! ```
//! In a box 0.8^2 and range / 4: its hypotheses and its centre need not be the object's. Real
//! surfaces bend: a plane is less accurate away from its hypotheses and for a wide range of
//! disparities. The constants are rounded from a fit of the errors on 14 QVGA scenes left one out
//! and on the same scenes at 1.3 and 2 times the size.
//!
//! The answer depends on the region, on segments within `OBJECT_REACH`, 6 px, of it and on the
//! support points around these; not on other regions, or the order of lists.
//!
//! # Cost
//! A box of a fifteenth of a QVGA image: 92 000 instructions on a Cortex-M7; at most 24 comparisons
//! a hypothesis.

mod cover;
mod refusal;
mod region;
pub(crate) mod region_support;
mod rows;
mod surface;

use crate::bars::{self, Bar, MaskMatcher};
use crate::confidence::Models;
use crate::image::Dims;
use crate::list::List;
use crate::matching::Candidate;
use crate::matching::consistency::Neighbour;
use crate::named::named_enum;
use crate::report::Ranked;
use crate::rig::Rig;
use crate::support::Support;
use crate::units::{Confidence, Depth, Disparity, about_length, disparity_from_q6, quotient};
use cover::Cover;
pub use region::{Region, RegionError, Run, Shape};
pub use rows::LabelRows;
use surface::Surface;

/// Why an object has no depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[error("{reason}")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NoDepth {
    /// The reason.
    pub reason: Reason,
    /// Number of segments and support points on the refused surface.
    pub support: u16,
}

named_enum! {
    /// Reason why an object has no depth.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
    #[cfg_attr(feature = "defmt", derive(defmt::Format))]
    #[non_exhaustive]
    pub enum Reason {
        /// Too few credible hypotheses in the region.
        #[error("too few credible hypotheses in the region")]
        LittleSupport = "little_support",
        /// Two groups of hypotheses explain the region equally well.
        #[error("two surfaces explain the region equally well")]
        TwoSurfaces = "two_surfaces",
        /// Hypotheses lie on the outline only: they may belong to the surface behind.
        #[error("hypotheses on the outline only: they may belong to what is beside the region")]
        OnlyOutline = "only_outline",
        /// The pair is not fit to be used.
        #[error("the pair is not fit to be used")]
        UnhealthyPair = "unhealthy_pair",
        /// Its pixels are the same in both images: it is too far for a depth, or no part of the
        /// scene (dirt, overlaid text).
        #[error("the same pixels in both images: too far for a depth, or dirt, or overlaid text")]
        NoParallax = "no_parallax",
    }

    /// Every reason.
    const ALL;

    /// The reason in snake case, as in JSON and tables.
    fn name;
}

/// The depth of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ObjectDepth {
    /// Disparity at the region's centre, px.
    pub disparity: Disparity,
    /// Standard deviation of the disparity, px.
    pub sigma: Disparity,
    /// Slope of the object's plane: change of the disparity per pixel to the right and downwards,
    /// 1/1024 px.
    pub slope_q10: [i16; 2],
    /// Largest distance of its hypotheses' disparities from the plane, px.
    pub spread: Disparity,
    /// The same in metres; `None` without a rig.
    pub metres: Option<ObjectMetres>,
    /// Number of segments and support points with a hypothesis on the plane.
    pub support: u16,
    /// Probability that the disparity is within 1 px of the range of the object's true disparities.
    pub confidence: Confidence,
}

/// The depth of an object, m.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ObjectMetres {
    /// Depth at the region's centre, m.
    pub depth: Depth,
    /// Standard deviation of depth, m.
    pub sigma: Depth,
    /// Depth of the object's nearest hypothesis, m.
    pub nearest: Depth,
}

impl ObjectMetres {
    fn new(rig: &Rig, disparity: Disparity, sigma: Disparity, nearest: Disparity) -> Self {
        Self {
            depth: rig.depth(disparity),
            sigma: rig.depth_sigma(disparity, sigma),
            nearest: rig.depth(nearest),
        }
    }
}

/// Results of the last run that the depth of regions is computed from, and working memory
/// (`neighbours`, `order`, `marks`).
pub(crate) struct ObjectQuery<'a> {
    pub(crate) candidates: &'a [Candidate],
    pub(crate) support: Support<'a>,
    pub(crate) models: &'a Models,
    pub(crate) dims: Dims,
    pub(crate) rig: Option<Rig>,
    pub(crate) neighbours: &'a mut [Neighbour],
    pub(crate) order: List<'a, Ranked>,
    pub(crate) marks: &'a mut [u32],
    pub(crate) bars: &'a [Bar],
    /// For thin masks without a bar.
    pub(crate) masks: Option<MaskMatcher<'a>>,
}

impl ObjectQuery<'_> {
    /// The depth of one region.
    #[inline(never)]
    pub(crate) fn depth_of(mut self, region: &Region<'_>) -> Result<ObjectDepth, NoDepth> {
        let cover = Cover::new(region, self.dims.width, self.marks);
        let (area, [_, row]) = (region.area(), cover.centre);
        let bar_of = |pixels: u32| {
            let contains = |x: i32, y: i32| cover.contains(x, y);
            if cover.is_box() {
                None
            } else {
                bars::depth_of(self.bars, area, pixels, row, contains)
            }
        };
        let pieces = |masks: MaskMatcher<'_>| {
            masks.depth_of(area, cover.pixels, row, |y, column| region.run(y, column))
        };
        let bar = bar_of(cover.pixels).or_else(|| self.masks.take().and_then(pieces));
        if let Some((bar, d_q6)) = bar {
            return Ok(of_bar(&bar, d_q6, self.rig.as_ref()));
        }
        let found = region_support::gather(
            self.candidates, self.support, self.models, &cover, self.dims, self.neighbours,
        );
        let neighbours = self.neighbours.get(..found.hypotheses).unwrap_or(&[]);
        let all_q8 = i32::try_from(found.weight_q8).unwrap_or(i32::MAX / 8); // sums are below 2^22
        let surface =
            surface::find(neighbours, cover.centre, cover.is_box(), all_q8, &mut self.order)
                .unwrap_or_default();
        match refusal::refusal(&surface, &found, &cover, self.support, self.dims) {
            Some(reason @ (Reason::LittleSupport | Reason::OnlyOutline))
                if cover.pixels > bars::most_pixels(area) =>
            {
                bar_of(bars::most_pixels(area))
                    .map(|(bar, d_q6)| of_bar(&bar, d_q6, self.rig.as_ref()))
                    .ok_or(NoDepth { reason, support: surface.support })
            }
            Some(reason) => Err(NoDepth { reason, support: surface.support }),
            None => Ok(answer(&surface, found.weight_q8, cover.is_box(), self.rig.as_ref())),
        }
    }
}

/// The depth of a mask that shows a bar.
fn of_bar(bar: &Bar, d_q6: i32, rig: Option<&Rig>) -> ObjectDepth {
    let (disparity, sigma) = (disparity_from_q6(d_q6), bar.sigma());
    let [a, b] = bar.disparity();
    ObjectDepth {
        disparity,
        sigma,
        slope_q10: [0; 2],
        spread: disparity_from_q6((i32::from(a.to_bits()) - i32::from(b.to_bits())).abs()),
        metres: rig.map(|rig| ObjectMetres::new(rig, disparity, sigma, a.max(b))),
        support: 1,
        confidence: bar.confidence(),
    }
}

fn answer(surface: &Surface, all_q8: u32, is_box: bool, rig: Option<&Rig>) -> ObjectDepth {
    let disparity = disparity_from_q6(surface.centre_q6);
    let (low, high) = surface.range_q6;
    let sigma = disparity_from_q6(sigma_q6(surface, is_box));
    ObjectDepth {
        disparity,
        sigma,
        slope_q10: surface.slope_q10.map(crate::units::narrow),
        spread: disparity_from_q6(surface.spread_q6),
        metres: rig
            .map(|rig| ObjectMetres::new(rig, disparity, sigma, disparity_from_q6(high.max(low)))),
        support: surface.support,
        confidence: confidence(surface.weight_q8, all_q8, is_box),
    }
}

/// Standard deviation of the disparity, 1/64 px: see the head of the module.
fn sigma_q6(surface: &Surface, is_box: bool) -> i32 {
    let [u, v] = surface.middle;
    let off = about_length(u, v);
    let (low, high) = surface.range_q6;
    let few = quotient(if is_box { 2621 } else { 655 } << 8, surface.weight_q8);
    let away = (off * 4) / 3; // 64 / 48
    let bent = (high - low) >> if is_box { 2 } else { 3 };
    (64 + few + away * away + bent * bent).unsigned_abs().isqrt() as i32 // below 2^13
}

/// `1 - 0.01 - 0.08 / weight`, in a box less another 0.08 times the share of weight that is not on
/// the plane: rounded above the errors observed.
fn confidence(weight_q8: i32, all_q8: u32, is_box: bool) -> Confidence {
    let few = quotient(5243 << 8, weight_q8);
    let all = i32::try_from(all_q8).unwrap_or(i32::MAX);
    let other =
        if is_box { (5243 * (256 - quotient(weight_q8 << 8, all)).clamp(0, 256)) >> 8 } else { 0 };
    Confidence::from_bits(u16::try_from(65_536 - 655 - few - other).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::area::Area;
    use crate::confidence::FITTED;
    use crate::evidence::{NearbyEvidence, SegmentEvidence};
    use crate::image::Span;
    use crate::lines::Segment;
    use crate::matching::Side;
    use crate::result::ImagePosition;
    use crate::units::Position;
    use core::mem::MaybeUninit;
    use heapless::Vec;
    use region_support::OBJECT_REACH;

    const DIMS: Dims = Dims { width: 320, height: 240 };
    const MOST: usize = 64;

    /// Linear congruential generator (Knuth's multiplier).
    struct Random(u32);

    impl Random {
        fn below(&mut self, of: u32) -> u16 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((u64::from(self.0) * u64::from(of)) >> 32) as u16
        }
    }

    fn side(d_q6: i32, score_q8: i16) -> Side {
        let evidence = SegmentEvidence::new();
        Side { score_q8, ..Side::new([d_q6; 2], &evidence, &FITTED, false) }
    }

    fn candidate([x0, y0, x1, y1]: [u16; 4], sides: [Option<Side>; 2]) -> Candidate {
        let end =
            |x: u16, y: u16| ImagePosition { x: Position::from_num(x), y: Position::from_num(y) };
        let near_horizontal = x0.abs_diff(x1) > y0.abs_diff(y1);
        let segment = Segment {
            ends: [end(x0, y0), end(x1, y1)],
            rising: true,
            contrast: 40,
            near_horizontal,
        };
        Candidate::new(segment, sides, 0, 0, None)
    }

    /// Hypotheses of every kind, all over the image.
    fn scattered(seed: u32, count: usize, least_x: u16, most_x: u16) -> Vec<Candidate, MOST> {
        let mut random = Random(seed);
        let mut list = Vec::new();
        for _ in 0..count {
            let (x, y) =
                (least_x + random.below(u32::from(most_x - least_x - 24)), 10 + random.below(200));
            let (dx, dy) =
                if random.below(2) == 0 { (random.below(4), 20) } else { (20, random.below(4)) };
            let d_q6 = 64 * (8 + 2 * i32::from(random.below(4))) + i32::from(random.below(40));
            let mut one = |d_q6: i32| {
                (random.below(4) > 0).then(|| side(d_q6, random.below(2000) as i16 - 400))
            };
            let sides = [one(d_q6), one(d_q6 + 20)];
            list.push(candidate([x, y, x + dx, y + dy], sides)).unwrap();
        }
        list
    }

    fn evaluate(candidates: &[Candidate], region: &Region<'_>) -> Result<ObjectDepth, NoDepth> {
        evaluate_with(candidates, region, None)
    }

    fn evaluate_with(
        candidates: &[Candidate],
        region: &Region<'_>,
        rig: Option<Rig>,
    ) -> Result<ObjectDepth, NoDepth> {
        let (mut neighbours, mut order, mut marks) =
            ([Neighbour::EMPTY; MOST], [const { MaybeUninit::uninit() }; MOST], [u32::MAX; 2400]);
        let (neighbours, order, marks) =
            (&mut neighbours[..], List::new(&mut order), &mut marks[..]);
        let support = Support::new(&crate::params::Params::DEFAULT, DIMS, &[], 0);
        ObjectQuery {
            candidates,
            support,
            models: &FITTED,
            dims: DIMS,
            rig,
            neighbours,
            order,
            marks,
            bars: &[],
            masks: None,
        }
        .depth_of(region)
    }

    /// A disc as runs.
    fn disc(runs: &mut [Run; 60]) -> Region<'_> {
        for (run, y) in runs.iter_mut().zip(70..) {
            let half = 10 + (y - 70_u16).min(129 - y) / 2;
            *run = Run { label: 4, y, span: Span { start: 80 - half, end: 80 + half } };
        }
        Region::masked(4, runs, DIMS).unwrap()
    }

    #[test]
    fn the_order_of_the_candidates_does_not_matter() {
        let mut runs = [Run { label: 0, y: 0, span: Span { start: 0, end: 1 } }; 60];
        let mask = disc(&mut runs);
        let area = Area { left: 30, top: 40, right: 160, bottom: 190 };
        let boxed = Region::boxed(1, area, DIMS).unwrap();
        let mut answers = 0;
        for seed in 0..40 {
            let mut list = scattered(seed, 60, 0, 200);
            for region in [&mask, &boxed] {
                let first = evaluate(&list, region);
                answers += u32::from(first.is_ok());
                for turn in [7, 23, 41] {
                    list.rotate_left(turn);
                    list.reverse();
                    assert_eq!(evaluate(&list, region), first, "seed {seed}");
                }
            }
        }
        assert!(answers > 40, "{answers} answers prove little");
    }

    #[test]
    fn hypotheses_elsewhere_change_no_bit() {
        let mut runs = [Run { label: 0, y: 0, span: Span { start: 0, end: 1 } }; 60];
        let region = disc(&mut runs);
        let reach = region.area().right + OBJECT_REACH;
        for seed in 0..40 {
            let near = scattered(seed, 20, 40, 130);
            let first = evaluate(&near, &region);
            let mut all = scattered(seed + 100, 40, reach, 320);
            for candidate in &near {
                all.push(candidate.clone()).unwrap();
            }
            assert_eq!(evaluate(&all, &region), first, "seed {seed}");
            // Results of the report, which depend on other candidates.
            for candidate in &mut all {
                candidate.violates_uniqueness = true;
                candidate.listed = Some(3);
                for side in candidate.sides.iter_mut().flatten() {
                    side.weight_q8 = 1;
                    (side.probability_q16, side.edge_probability_q16, side.rejected) = (9, 9, true);
                }
            }
            assert_eq!(evaluate(&all, &region), first, "seed {seed}");
        }
    }

    #[test]
    fn masks_are_painted_and_counted_as_drawn() {
        let mut runs = [Run { label: 0, y: 0, span: Span { start: 0, end: 1 } }; 60];
        let region = disc(&mut runs);
        let mut marks = [u32::MAX; 2400];
        let cover = Cover::new(&region, DIMS.width, &mut marks);
        for y in 0..240 {
            for x in 0..320 {
                assert_eq!(cover.contains(x, y), region.contains(x, y), "{x}, {y}");
            }
        }
        assert_eq!(cover.centre, [79, 99]); // columns 80 - half ..= 79 + half, rows 70 ..= 129, both means rounded down
    }

    /// Hypotheses at these places of a box of 120 px, its left top at (40, 40), each with this
    /// disparity, px.
    fn boxed(places: &[([u16; 2], i32)], rig: Option<Rig>) -> Result<Disparity, Reason> {
        let mut list = Vec::<Candidate, MOST>::new();
        for &([x, y], d) in places {
            list.push(candidate(
                [40 + x, 40 + y, 40 + x, 50 + y],
                [Some(side(d * 64, 1200)), None],
            ))
            .unwrap();
        }
        let area = Area { left: 40, top: 40, right: 160, bottom: 160 };
        disparity_of(evaluate_with(&list, &Region::boxed(1, area, DIMS).unwrap(), rig))
    }

    fn disparity_of(found: Result<ObjectDepth, NoDepth>) -> Result<Disparity, Reason> {
        found.map(|object| object.disparity).map_err(|why| why.reason)
    }

    #[test]
    fn a_nearer_surface_in_a_corner_needs_most_of_the_weight() {
        let corner =
            [[95, 95], [100, 105], [105, 95], [110, 105], [105, 100], [95, 100]].map(|at| (at, 30));
        let own = [[60, 50], [40, 40], [70, 60]].map(|at| (at, 20));
        let both = |own: &[([u16; 2], i32)]| boxed(&[&corner[..], own].concat(), None);
        assert_eq!(both(&own), Err(Reason::TwoSurfaces));
        assert!(both(&own[..1]).is_ok(), "one of seven");
        assert!(
            boxed(&corner.map(|([x, y], d)| ([x - 45, y - 45], d)), None).is_ok(),
            "in the middle"
        );
    }

    #[test]
    fn a_thin_region_has_the_depth_of_its_edge_before_what_is_behind() {
        // A pole of four columns, its left edge at 100, with its disparity on the right side.
        let runs: [Run; 60] = core::array::from_fn(|row| Run {
            label: 4,
            y: 70 + row as u16,
            span: Span { start: 100, end: 104 },
        });
        let pole = Region::masked(4, &runs, DIMS).unwrap();
        let depth = |nearby: NearbyEvidence, inner: usize, region: &Region<'_>| {
            let edge = Side { nearby, edge_score_q8: 1800, ..side(20 * 64, 1200) };
            let sides = if inner == 0 { [Some(edge), None] } else { [None, Some(edge)] };
            disparity_of(evaluate(&[candidate([100, 80, 100, 110], sides)], region))
        };
        let level = NearbyEvidence::default();
        let before = NearbyEvidence { farther: 64, ..level };
        let behind = NearbyEvidence { nearer: 64, ..level };
        assert_eq!(depth(before, 1, &pole), Ok(Disparity::from_num(20)));
        assert_eq!(depth(behind, 1, &pole), Err(Reason::LittleSupport), "behind what is beside it");
        assert_eq!(
            depth(level, 1, &pole),
            Err(Reason::LittleSupport),
            "where what is beside it is"
        );
        assert_eq!(depth(before, 0, &pole), Err(Reason::LittleSupport), "of the other side");
        let boxed = Region::boxed(4, pole.area(), DIMS).unwrap();
        assert_eq!(depth(before, 1, &boxed), Err(Reason::LittleSupport), "a box");
        // Wider above: the pole is a part of something else.
        let wide = |run: Run| Run {
            span: Span { end: if run.y < 76 { 140 } else { 104 }, ..run.span },
            ..run
        };
        let part = runs.map(wide);
        let part = Region::masked(4, &part, DIMS).unwrap();
        assert_eq!(depth(before, 1, &part), Err(Reason::LittleSupport), "a thin part");
    }

    #[test]
    fn what_stays_at_its_pixel_has_no_depth_in_any_rig() {
        let places = [[40, 40], [60, 60], [80, 80], [50, 70]];
        let shifted = Rig::new(900.0, 0.16, 64.0).unwrap();
        for rig in [None, Some(shifted)] {
            assert_eq!(boxed(&places.map(|at| (at, 0)), rig), Err(Reason::NoParallax));
            assert!(boxed(&places.map(|at| (at, 2)), rig).is_ok());
        }
    }

    #[test]
    fn a_slanted_plane_is_followed_to_the_centre() {
        // d = 20 px at the centre (100, 100), 0.02 px per px to the right, -0.01 downwards;
        // hypotheses on the left half only.
        let mut list = Vec::<Candidate, MOST>::new();
        for y in [60, 80, 100, 120] {
            for x in [60_u16, 75, 90] {
                let d_q6 = 20.0 * 64.0
                    + 64.0 * (0.02 * (f64::from(x) - 99.0) - 0.01 * (f64::from(y + 5) - 99.0));
                list.push(candidate([x, y, x, y + 10], [Some(side(d_q6 as i32, 1200)), None]))
                    .unwrap();
            }
        }
        let area = Area { left: 40, top: 40, right: 160, bottom: 160 };
        let found = evaluate(&list, &Region::boxed(1, area, DIMS).unwrap()).unwrap();
        let d = found.disparity.to_num::<f64>();
        assert!((d - 20.0).abs() < 0.3, "{found:?}");
        let [across, down] = found.slope_q10.map(|slope| f64::from(slope) / 1024.0);
        assert!(
            (0.01..0.021).contains(&across) && (-0.0105..-0.006).contains(&down),
            "{across} {down}"
        );
        assert_eq!(found.support, 12);
    }

    #[test]
    fn a_narrow_steep_wall_has_the_depth_of_its_centre() {
        // d = 12 px at the centre, 0.18 px per px to the right; most hypotheses on the right half.
        let runs: [Run; 60] = core::array::from_fn(|row| Run {
            label: 4,
            y: 70 + row as u16,
            span: Span { start: 100, end: 132 },
        });
        let wall = Region::masked(4, &runs, DIMS).unwrap();
        let at = |x: u16, rows: &[u16], list: &mut Vec<Candidate, MOST>| {
            for &y in rows {
                let d_q6 = 64.0 * (12.0 + 0.18 * (f64::from(x) - 116.0));
                list.push(candidate([x, y, x, y + 8], [Some(side(d_q6 as i32, 1200)), None]))
                    .unwrap();
            }
        };
        let mut list = Vec::new();
        at(126, &[72, 80, 88, 96, 104, 112, 120], &mut list);
        at(116, &[80, 100], &mut list);
        at(108, &[90, 110], &mut list);
        let d = evaluate(&list, &wall).unwrap().disparity.to_num::<f64>();
        assert!((d - 12.0).abs() < 0.75, "{d}");
        // A single wrong one is no slope.
        let mut level = Vec::new();
        at(126, &[72, 80, 88, 96, 104, 112, 120], &mut level);
        at(108, &[90], &mut level);
        assert_eq!(evaluate(&level, &wall).unwrap().slope_q10, [0; 2]);
    }
}
