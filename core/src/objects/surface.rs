//! The surface that a region's hypotheses agree on, as a plane of disparity.
//!
//! In: the region's hypotheses. Out: a plane with its support, or which of them there are too few of.
//!
//! ```text
//! two hypotheses agree when their disparities differ by at most 1 px plus 0.04 px per px between them
//! mask: the hypothesis with which most agree.  box: of the hypotheses with which at least a third as many agree, the nearest; it is the best of
//!     its surface. A box holds background, and more of it than of a thin object.
//! plane: least squares over those that agree, then over all within 1 px of that plane; slopes shrink to 0 where little supports them
//! ```
//!
//! # Bounds
//! Weights are at most 307, hypotheses 2 * 4096: sums below 2^22. Products with columns or disparities below 2^36, with squares below 2^48, `i64`;
//! scaled to 26 bits before they are multiplied by each other.
//!
//! # Cost
//! [`HYPOTHESES`] comparisons a hypothesis at 12 instructions, and four passes at 30.

use crate::matching::consistency::Neighbour;
use crate::report::Ranked;
use crate::sort::sort_by_key;
use crate::units::about_length;
use crate::units::quotient;
use heapless::vec::VecView;

/// Largest difference of disparity between hypotheses at one place, and between a hypothesis and its plane.
const TOLERANCE_Q6: i32 = 64;
/// Hypotheses that are asked how many agree with them: of more, every second, third ... by disparity.
const HYPOTHESES: usize = 24;
/// Weight by which a plane prefers no slope, times squared px: as if each hypothesis were off by 0.8 px, and slopes of 0.03 px per px common.
const LEVEL: i64 = 711 << 8;
/// A second surface lies further than this from the plane.
const SECOND_SURFACE_Q6: i32 = 3 << 6;
/// How far beyond its hypotheses' disparities a plane's value is believed at the region's centre.
const BEYOND_Q6: i32 = 16;

/// The plane of disparity that most hypotheses of a region agree on, and their spread.
#[derive(Clone, Copy, Default)]
pub(crate) struct Surface {
    /// Disparity at the region's centre, 1/64 px.
    pub(crate) centre_q6: i32,
    /// Its change per pixel to the right and downwards, 1/1024 px.
    pub(crate) slope_q10: [i32; 2],
    /// Sum of its hypotheses' weights, 1/256.
    pub(crate) weight_q8: i32,
    /// Segments that speak for it.
    pub(crate) segments: u16,
    /// Least and largest disparity of its hypotheses.
    pub(crate) range_q6: (i32, i32),
    /// The largest distance of one of them from the plane.
    pub(crate) spread_q6: i32,
    /// Mean place of its hypotheses, from the region's centre.
    pub(crate) middle: [i32; 2],
    /// Their mean squared distance from there, per direction.
    pub(crate) extent2: [i32; 2],
    /// Weight of the hypotheses that agree best with each other far from this plane.
    pub(crate) second_weight_q8: u32,
}

/// A hypothesis that others may agree with.
#[derive(Clone, Copy, Default)]
struct Hypothesis {
    x: i32,
    y: i32,
    d_q6: i32,
    weight_q8: u32,
}

impl Hypothesis {
    fn new(place: &Neighbour) -> Self {
        let [a, b] = &place.hypotheses;
        let hypothesis = if b.support > a.support { b } else { a };
        Self { x: place.x.into(), y: place.y.into(), d_q6: hypothesis.d_q6.into(), weight_q8: 0 }
    }

    /// Sums up what agrees with it.
    fn weigh(&mut self, neighbours: &[Neighbour]) {
        let mut weight_q8 = 0;
        for place in neighbours {
            let tolerance_q6 = self.tolerance_q6(place.x.into(), place.y.into());
            let [a, b] = &place.hypotheses;
            for hypothesis in [a, b] {
                let agrees = (i32::from(hypothesis.d_q6) - self.d_q6).abs() <= tolerance_q6;
                weight_q8 += if agrees { u32::from(hypothesis.support) } else { 0 };
            }
        }
        self.weight_q8 = weight_q8;
    }

    /// By weight; of equal ones the nearer, then one of them whatever their order is.
    fn by_weight(&self) -> (u32, i32, i32, i32) {
        (self.weight_q8, self.d_q6, self.y, self.x)
    }

    /// By disparity, then weight.
    fn by_disparity(&self) -> (i32, u32, i32, i32) {
        (self.d_q6, self.weight_q8, self.y, self.x)
    }

    fn agrees(&self, x: i32, y: i32, d_q6: i32) -> bool {
        (d_q6 - self.d_q6).abs() <= self.tolerance_q6(x, y)
    }

    /// Largest difference of disparity to a hypothesis there that agrees.
    fn tolerance_q6(&self, x: i32, y: i32) -> i32 {
        TOLERANCE_Q6 + ((5 * about_length(x - self.x, y - self.y)) >> 1)
    }
}

/// Disparity as a plane over positions relative to the region's centre.
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

/// Finds the surface of the hypotheses in `neighbours`; `None` without a hypothesis that weighs anything.
pub(crate) fn find(
    neighbours: &[Neighbour],
    centre: [i32; 2],
    is_box: bool,
    order: &mut VecView<Ranked>,
) -> Option<Surface> {
    let mut hypotheses = [Hypothesis::default(); HYPOTHESES];
    let count = ask(neighbours, order, &mut hypotheses);
    let asked = hypotheses.get(..count)?;
    let chosen = choose(asked, is_box)?;
    let near = fit(neighbours, centre, |x, y, d_q6| chosen.agrees(x, y, d_q6))?;
    let [x0, y0] = centre;
    let on = |plane: &Plane, x: i32, y: i32, d_q6: i32| (d_q6 - plane.at_q6(x - x0, y - y0)).abs() <= TOLERANCE_Q6;
    let plane = fit(neighbours, centre, |x, y, d_q6| on(&near, x, y, d_q6)).unwrap_or(near);
    let mut surface = describe(neighbours, centre, &plane, |x, y, d_q6| on(&plane, x, y, d_q6))?;
    let far = asked.iter().filter(|h| (h.d_q6 - plane.at_q6(h.x - x0, h.y - y0)).abs() > SECOND_SURFACE_Q6);
    surface.second_weight_q8 = far.max_by_key(|h| h.by_weight()).map_or(0, |second| parted(neighbours, chosen, second));
    Some(surface)
}

/// Weight of what agrees with `second`; 0 where an eighth of it agrees with `chosen` too: then it is one surface that bends.
fn parted(neighbours: &[Neighbour], chosen: &Hypothesis, second: &Hypothesis) -> u32 {
    let mut common = 0;
    visit(
        neighbours,
        [0; 2],
        |x, y, d_q6| chosen.agrees(x, y, d_q6) && second.agrees(x, y, d_q6),
        |_, _, _, w| common += w,
    );
    if common.unsigned_abs() * 8 >= second.weight_q8 { 0 } else { second.weight_q8 }
}

/// Weighs what agrees with each hypothesis, or with every n-th of many by disparity; returns how many were asked. The order of the neighbours does not
/// matter.
fn ask(neighbours: &[Neighbour], order: &mut VecView<Ranked>, hypotheses: &mut [Hypothesis; HYPOTHESES]) -> usize {
    let step = neighbours.len().div_ceil(HYPOTHESES).max(1);
    if step == 1 {
        for (place, hypothesis) in neighbours.iter().zip(hypotheses.iter_mut()) {
            *hypothesis = Hypothesis::new(place);
        }
    } else {
        sort_by_disparity(neighbours, order);
        for (ranked, hypothesis) in order.iter().step_by(step).zip(hypotheses.iter_mut()) {
            *hypothesis = neighbours.get(usize::from(ranked.candidate)).map(Hypothesis::new).unwrap_or_default();
        }
    }
    let count = neighbours.len().div_ceil(step);
    for hypothesis in hypotheses.iter_mut().take(count) {
        hypothesis.weigh(neighbours);
    }
    count
}

fn sort_by_disparity(neighbours: &[Neighbour], order: &mut VecView<Ranked>) {
    order.clear();
    for (place, i) in neighbours.iter().zip(0..) {
        let disparity = (Hypothesis::new(place).d_q6 + 32768) as u16;
        let _ = order.push(Ranked { probability_q16: disparity, candidate: i }); // one per candidate: it fits
    }
    let column = |r: &Ranked| neighbours.get(usize::from(r.candidate)).map(|place| (place.y, place.x));
    sort_by_key(order, |r| (r.probability_q16, column(r)));
}

/// The hypothesis that speaks for the object; of equal ones the nearest.
fn choose(asked: &[Hypothesis], is_box: bool) -> Option<&Hypothesis> {
    let best = asked.iter().max_by_key(|h| h.by_weight())?;
    if !is_box {
        return Some(best);
    }
    let nearest = asked.iter().filter(|h| h.weight_q8 * 3 >= best.weight_q8).max_by_key(|h| h.by_disparity())?;
    asked.iter().filter(|h| nearest.agrees(h.x, h.y, h.d_q6)).max_by_key(|h| h.by_weight())
}

/// Calls `visit(u, v, disparity, weight)` for each hypothesis that belongs, with its place relative to the centre; returns how many have one.
fn visit(
    neighbours: &[Neighbour],
    [x0, y0]: [i32; 2],
    belongs: impl Fn(i32, i32, i32) -> bool,
    mut visit: impl FnMut(i32, i32, i32, i32),
) -> u16 {
    let mut count = 0_u16;
    for place in neighbours {
        let (x, y) = (i32::from(place.x), i32::from(place.y));
        let mut speaks = false;
        let [a, b] = &place.hypotheses;
        for hypothesis in [a, b] {
            let d_q6 = i32::from(hypothesis.d_q6);
            if hypothesis.weight_q8 > 0 && belongs(x, y, d_q6) {
                visit(x - x0, y - y0, d_q6, hypothesis.weight_q8.into());
                speaks = true;
            }
        }
        count = count.saturating_add(speaks.into());
    }
    count
}

/// Weighted sums over hypotheses: positions relative to the centre, disparities, and products of positions.
#[derive(Clone, Copy, Default)]
struct Sums {
    weight: i32,
    u: i64,
    v: i64,
    d_q6: i64,
    uu: i64,
    vv: i64,
}

impl Sums {
    fn add(&mut self, u: i32, v: i32, d_q6: i32, w: i32) {
        let (wu, wv) = (w * u, w * v);
        self.weight += w;
        self.u += i64::from(wu);
        self.v += i64::from(wv);
        self.d_q6 += i64::from(w) * i64::from(d_q6);
        self.uu += i64::from(wu) * i64::from(u);
        self.vv += i64::from(wv) * i64::from(v);
    }

    /// Mean place and disparity; `None` without a hypothesis.
    fn means(&self) -> Option<[i32; 3]> {
        Some([self.per_weight(self.u)?, self.per_weight(self.v)?, self.per_weight(self.d_q6)?])
    }

    /// A sum divided by the weight, limited to 32 bits. Few sums are longer than that, and a division of 64 bits takes hundreds of instructions.
    fn per_weight(&self, sum: i64) -> Option<i32> {
        match i32::try_from(sum) {
            Ok(sum) => sum.checked_div(self.weight),
            Err(_) => sum.checked_div(self.weight.into()).map(|quotient| i32::try_from(quotient).unwrap_or(i32::MAX)),
        }
    }

    /// A sum of products about a mean each, which come with the sum that they are the mean of.
    fn about(&self, products: i64, [a, sum_a]: [i64; 2], [b, sum_b]: [i64; 2]) -> i64 {
        products - a * sum_b - b * sum_a + a * b * i64::from(self.weight)
    }
}

/// The plane through the hypotheses that belong, by least squares; `None` when none does.
fn fit(neighbours: &[Neighbour], centre: [i32; 2], belongs: impl Fn(i32, i32, i32) -> bool) -> Option<Plane> {
    let mut sums = Sums::default();
    let [mut uv, mut ud, mut vd] = [0_i64; 3];
    visit(neighbours, centre, &belongs, |u, v, d_q6, w| {
        sums.add(u, v, d_q6, w);
        let wu = i64::from(w * u);
        uv += wu * i64::from(v);
        ud += wu * i64::from(d_q6);
        vd += i64::from(w * v) * i64::from(d_q6);
    });
    let [u, v, d_q6] = sums.means()?;
    let [of_u, of_v, of_d] = [[u.into(), sums.u], [v.into(), sums.v], [d_q6.into(), sums.d_q6]];
    let (uu, vv) = (LEVEL + sums.about(sums.uu, of_u, of_u), LEVEL + sums.about(sums.vv, of_v, of_v));
    let [uv, ud, vd] = [sums.about(uv, of_u, of_v), sums.about(ud, of_u, of_d), sums.about(vd, of_v, of_d)];
    // Both diagonals are above 0: 26 bits of the larger one.
    let shift = uu.max(vv).checked_ilog2().unwrap_or(0).saturating_sub(26);
    let [uu, uv, vv, ud, vd] = [uu, uv, vv, ud, vd].map(|sum| sum >> shift);
    let determinant = uu * vv - uv * uv;
    // 20 bits of the determinant: then a slope within the limit has a numerator of 31.
    let shift = determinant.checked_ilog2().unwrap_or(0).saturating_sub(19);
    let slope = |numerator: i64| {
        let numerator = ((numerator << 4) >> shift).clamp(-LIMIT, LIMIT); // 1/64 px to 1/1024 px
        let slope_q10 = quotient(numerator as i32, (determinant >> shift) as i32);
        slope_q10.clamp(-MAX_SLOPE_Q10, MAX_SLOPE_Q10)
    };
    let slope_q10 = [slope(ud * vv - vd * uv), slope(vd * uu - ud * uv)];
    let level = Plane { level_q6: d_q6, slope_q10 };
    Some(Plane { level_q6: level.at_q6(-u, -v), slope_q10 })
}

/// Steeper planes are none that a camera sees: 2 px per px.
const MAX_SLOPE_Q10: i32 = 2 << 10;
/// Of 32 bits.
const LIMIT: i64 = i32::MAX as i64;

/// The surface of the hypotheses that lie on a plane; `None` when none does.
fn describe(
    neighbours: &[Neighbour],
    centre: [i32; 2],
    plane: &Plane,
    belongs: impl Fn(i32, i32, i32) -> bool,
) -> Option<Surface> {
    let mut sums = Sums::default();
    let (mut low, mut high, mut spread) = (i32::MAX, i32::MIN, 0);
    let segments = visit(neighbours, centre, &belongs, |u, v, d_q6, w| {
        sums.add(u, v, d_q6, w);
        low = low.min(d_q6);
        high = high.max(d_q6);
        spread = spread.max((d_q6 - plane.at_q6(u, v)).abs());
    });
    let [u, v, _] = sums.means()?;
    let (of_u, of_v) = ([u.into(), sums.u], [v.into(), sums.v]);
    let per_weight = |sum: i64| sums.per_weight(sum).unwrap_or(0);
    Some(Surface {
        // Not `clamp`, which panics when its bounds cross.
        centre_q6: plane.level_q6.max(low - BEYOND_Q6).min(high + BEYOND_Q6),
        slope_q10: plane.slope_q10,
        weight_q8: sums.weight,
        segments,
        range_q6: (low, high),
        spread_q6: spread,
        middle: [u, v],
        extent2: [sums.about(sums.uu, of_u, of_u), sums.about(sums.vv, of_v, of_v)].map(per_weight),
        second_weight_q8: 0,
    })
}
