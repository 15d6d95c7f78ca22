//! The surface that a region's claims agree on, as a plane of disparity.
//!
//! In: the region's claims. Out: a plane with its support, or which of them there are too few of.
//!
//! ```text
//! two claims agree when their disparities differ by at most 1 px plus 0.04 px per px between them
//! mask: the claim with which most agree.  box: of the claims with which at least a third as many agree, the nearest; it is the best of
//!     its surface. A box holds background, and more of it than of a thin object.
//! plane: least squares over those that agree, then over all within 1 px of that plane; slopes shrink to 0 where little supports them
//! ```
//!
//! # Bounds
//! Weights are at most 307, claims 2 * 4096: sums below 2^22. Products with columns or disparities below 2^36, with squares below 2^48, `i64`;
//! scaled to 26 bits before they are multiplied by each other.
//!
//! # Cost
//! [`HYPOTHESES`] comparisons a claim at 12 instructions, and four passes at 30.

use crate::matching::consistency::Place;
use crate::report::Ranked;
use crate::sort::sort_by_key;
use heapless::vec::VecView;

/// Largest difference of disparity between claims at one place, and between a claim and its plane.
const TOLERANCE_Q6: i32 = 64;
/// Claims that are asked how many agree with them: of more, every second, third ... by disparity.
const HYPOTHESES: usize = 24;
/// Weight by which a plane prefers no slope, times squared px: as if each claim were off by 0.8 px, and slopes of 0.03 px per px common.
const LEVEL: i64 = 711 << 8;
/// A second surface lies further than this from the plane.
const RIVAL_Q6: i32 = 3 << 6;
/// How far beyond its claims' disparities a plane's value is believed at the region's centre.
const BEYOND_Q6: i32 = 16;

/// What most claims agree on.
#[derive(Clone, Copy, Default)]
pub(crate) struct Surface {
    /// Disparity at the region's centre, 1/64 px.
    pub(crate) centre_q6: i32,
    /// Its change per pixel to the right and downwards, 1/1024 px.
    pub(crate) slope_q10: [i32; 2],
    /// Sum of its claims' weights, 1/256.
    pub(crate) weight_q8: i32,
    /// Segments that speak for it.
    pub(crate) segments: u16,
    /// Least and largest disparity of its claims.
    pub(crate) range_q6: (i32, i32),
    /// The largest distance of one of them from the plane.
    pub(crate) spread_q6: i32,
    /// Mean place of its claims, from the region's centre.
    pub(crate) middle: [i32; 2],
    /// Their mean squared distance from there, per direction.
    pub(crate) extent2: [i32; 2],
    /// Weight of the claims that agree best with each other far from this plane.
    pub(crate) rival_q8: u32,
}

/// A claim that others may agree with.
#[derive(Clone, Copy, Default)]
struct Hypothesis {
    x: i32,
    y: i32,
    d_q6: i32,
    weight_q8: u32,
}

impl Hypothesis {
    fn new(place: &Place) -> Self {
        let [a, b] = &place.claims;
        let claim = if b.agreeing > a.agreeing { b } else { a };
        Self { x: place.x.into(), y: place.y.into(), d_q6: claim.d_q6.into(), weight_q8: 0 }
    }

    fn agrees(&self, x: i32, y: i32, d_q6: i32) -> bool {
        (d_q6 - self.d_q6).abs() <= self.tolerance_q6(x, y)
    }

    /// Largest difference of disparity to a claim there that agrees.
    fn tolerance_q6(&self, x: i32, y: i32) -> i32 {
        let (dx, dy) = ((x - self.x).abs(), (y - self.y).abs());
        let distance = dx.max(dy) + ((3 * dx.min(dy)) >> 3); // within 7 % of the length
        TOLERANCE_Q6 + ((5 * distance) >> 1)
    }
}

/// Disparity as a plane over places relative to the region's centre.
#[derive(Clone, Copy)]
struct Plane {
    level_q6: i32,
    slope_q10: [i32; 2],
}

impl Plane {
    fn at_q6(&self, u: i32, v: i32) -> i32 {
        let [across, down] = self.slope_q10;
        self.level_q6 + ((across * u + down * v) >> 4)
    }
}

/// Finds the surface of the claims in `places`; `None` without a claim that weighs anything.
pub(crate) fn find(places: &[Place], centre: [i32; 2], is_box: bool, order: &mut VecView<Ranked>) -> Option<Surface> {
    let mut hypotheses = [Hypothesis::default(); HYPOTHESES];
    let count = ask(places, order, &mut hypotheses);
    let asked = hypotheses.get(..count)?;
    let chosen = choose(asked, is_box)?;
    let near = fit(places, centre, |x, y, d_q6| chosen.agrees(x, y, d_q6))?;
    let [x0, y0] = centre;
    let on = |plane: &Plane, x: i32, y: i32, d_q6: i32| (d_q6 - plane.at_q6(x - x0, y - y0)).abs() <= TOLERANCE_Q6;
    let plane = fit(places, centre, |x, y, d_q6| on(&near, x, y, d_q6)).unwrap_or(near);
    let mut surface = describe(places, centre, &plane, |x, y, d_q6| on(&plane, x, y, d_q6))?;
    let far = asked.iter().filter(|h| (h.d_q6 - plane.at_q6(h.x - x0, h.y - y0)).abs() > RIVAL_Q6);
    surface.rival_q8 = far.max_by_key(|h| (h.weight_q8, h.d_q6)).map_or(0, |rival| parted(places, chosen, rival));
    Some(surface)
}

/// Weight of what agrees with `rival`; 0 where an eighth of it agrees with `chosen` too: then it is one surface that bends.
fn parted(places: &[Place], chosen: &Hypothesis, rival: &Hypothesis) -> u32 {
    let mut common = 0;
    visit(places, [0; 2], |x, y, d_q6| chosen.agrees(x, y, d_q6) && rival.agrees(x, y, d_q6), |_, _, _, w| common += w);
    if common.unsigned_abs() * 8 >= rival.weight_q8 { 0 } else { rival.weight_q8 }
}

/// Weighs what agrees with each claim, or with every n-th of many; returns how many were asked. The order of the places does not matter.
fn ask(places: &[Place], order: &mut VecView<Ranked>, hypotheses: &mut [Hypothesis; HYPOTHESES]) -> usize {
    order.clear();
    for (place, i) in places.iter().zip(0..) {
        let disparity = (Hypothesis::new(place).d_q6 + 32768) as u16;
        let _ = order.push(Ranked { probability_q16: disparity, candidate: i }); // one per candidate: it fits
    }
    let column = |r: &Ranked| places.get(usize::from(r.candidate)).map(|place| (place.y, place.x));
    sort_by_key(order, |r| (r.probability_q16, column(r)));
    let step = order.len().div_ceil(HYPOTHESES).max(1);
    let mut count = 0;
    for (ranked, hypothesis) in order.iter().step_by(step).zip(hypotheses.iter_mut()) {
        let Some(place) = places.get(usize::from(ranked.candidate)) else { continue };
        *hypothesis = Hypothesis::new(place);
        let mut weight_q8 = 0;
        for place in places {
            let tolerance_q6 = hypothesis.tolerance_q6(place.x.into(), place.y.into());
            for claim in place.claims.iter().filter(|claim| claim.agreeing > 0) {
                let agrees = (i32::from(claim.d_q6) - hypothesis.d_q6).abs() <= tolerance_q6;
                weight_q8 += if agrees { u32::from(claim.agreeing) } else { 0 };
            }
        }
        hypothesis.weight_q8 = weight_q8;
        count += 1;
    }
    count
}

/// The claim that speaks for the object; of equal ones the nearest.
fn choose(asked: &[Hypothesis], is_box: bool) -> Option<&Hypothesis> {
    let best = asked.iter().max_by_key(|h| (h.weight_q8, h.d_q6))?;
    if !is_box {
        return Some(best);
    }
    let nearest = asked.iter().filter(|h| h.weight_q8 * 3 >= best.weight_q8).max_by_key(|h| (h.d_q6, h.weight_q8))?;
    asked.iter().filter(|h| nearest.agrees(h.x, h.y, h.d_q6)).max_by_key(|h| (h.weight_q8, h.d_q6))
}

/// Calls `visit(u, v, disparity, weight)` for each claim that belongs, with its place relative to the centre.
fn visit(
    places: &[Place],
    [x0, y0]: [i32; 2],
    belongs: impl Fn(i32, i32, i32) -> bool,
    mut visit: impl FnMut(i32, i32, i32, i32),
) {
    for place in places {
        let (x, y) = (i32::from(place.x), i32::from(place.y));
        for claim in &place.claims {
            let d_q6 = i32::from(claim.d_q6);
            if claim.weight_q8 > 0 && belongs(x, y, d_q6) {
                visit(x - x0, y - y0, d_q6, claim.weight_q8.into());
            }
        }
    }
}

/// Mean place and disparity of the claims that belong, and their weight.
struct Means {
    weight: i32,
    u: i32,
    v: i32,
    d_q6: i32,
}

impl Means {
    fn new(places: &[Place], centre: [i32; 2], belongs: impl Fn(i32, i32, i32) -> bool) -> Option<Self> {
        let (mut weight, mut u_sum, mut v_sum, mut d_sum) = (0_i32, 0_i64, 0_i64, 0_i64);
        visit(places, centre, belongs, |u, v, d_q6, w| {
            weight += w;
            u_sum += i64::from(u * w);
            v_sum += i64::from(v * w);
            d_sum += i64::from(d_q6) * i64::from(w);
        });
        let mean = |sum: i64| sum.checked_div(weight.into()).map(|mean| mean as i32); // a mean is in the range of its terms
        Some(Self { weight, u: mean(u_sum)?, v: mean(v_sum)?, d_q6: mean(d_sum)? })
    }
}

/// The plane through the claims that belong, by least squares; `None` when none does.
fn fit(places: &[Place], centre: [i32; 2], belongs: impl Fn(i32, i32, i32) -> bool) -> Option<Plane> {
    let mean = Means::new(places, centre, &belongs)?;
    let [mut uu, mut uv, mut vv, mut ud, mut vd] = [LEVEL, 0, LEVEL, 0, 0];
    visit(places, centre, &belongs, |u, v, d_q6, w| {
        let (u, v, d) = (u - mean.u, v - mean.v, d_q6 - mean.d_q6);
        let (wu, wv) = (i64::from(u * w), i64::from(v * w));
        uu += wu * i64::from(u);
        uv += wu * i64::from(v);
        vv += wv * i64::from(v);
        ud += wu * i64::from(d);
        vd += wv * i64::from(d);
    });
    // Both diagonals are above 0: 26 bits of the larger one.
    let shift = uu.max(vv).checked_ilog2().unwrap_or(0).saturating_sub(26);
    let [uu, uv, vv, ud, vd] = [uu, uv, vv, ud, vd].map(|sum| sum >> shift);
    let determinant = uu * vv - uv * uv;
    let slope = |numerator: i64| {
        let slope_q10 = (numerator << 4).checked_div(determinant).unwrap_or(0); // 1/64 px to 1/1024 px
        i32::try_from(slope_q10.clamp(-MAX_SLOPE_Q10, MAX_SLOPE_Q10)).unwrap_or(0)
    };
    let slope_q10 = [slope(ud * vv - vd * uv), slope(vd * uu - ud * uv)];
    let level = Plane { level_q6: mean.d_q6, slope_q10 };
    Some(Plane { level_q6: level.at_q6(-mean.u, -mean.v), slope_q10 })
}

/// Steeper planes are none that a camera sees: 2 px per px.
const MAX_SLOPE_Q10: i64 = 2 << 10;

/// What there is to say of the plane by the claims on it; `None` when none is.
fn describe(
    places: &[Place],
    centre: [i32; 2],
    plane: &Plane,
    belongs: impl Fn(i32, i32, i32) -> bool,
) -> Option<Surface> {
    let mean = Means::new(places, centre, &belongs)?;
    let (mut uu, mut vv) = (0_i64, 0_i64);
    let (mut low, mut high, mut spread) = (i32::MAX, i32::MIN, 0);
    visit(places, centre, &belongs, |u, v, d_q6, w| {
        uu += i64::from((u - mean.u) * w) * i64::from(u - mean.u);
        vv += i64::from((v - mean.v) * w) * i64::from(v - mean.v);
        low = low.min(d_q6);
        high = high.max(d_q6);
        spread = spread.max((d_q6 - plane.at_q6(u, v)).abs());
    });
    let speaks = |place: &Place| {
        let claims = &place.claims;
        claims.iter().any(|c| c.weight_q8 > 0 && belongs(place.x.into(), place.y.into(), c.d_q6.into()))
    };
    let segments = places.iter().filter(|place| speaks(place)).count();
    let per_weight = |sum: i64| i32::try_from(sum.checked_div(mean.weight.into()).unwrap_or(0)).unwrap_or(i32::MAX);
    Some(Surface {
        // Not `clamp`, which panics when its bounds cross.
        centre_q6: plane.level_q6.max(low - BEYOND_Q6).min(high + BEYOND_Q6),
        slope_q10: plane.slope_q10,
        weight_q8: mean.weight,
        segments: u16::try_from(segments).unwrap_or(u16::MAX),
        range_q6: (low, high),
        spread_q6: spread,
        middle: [mean.u, mean.v],
        extent2: [per_weight(uu), per_weight(vv)],
        rival_q8: 0,
    })
}
