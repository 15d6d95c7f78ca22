//! The surface with the largest support among a region's hypotheses, as a plane of disparity.
//!
//! In: the region's hypotheses. Out: a plane with its support and that of a second surface, or
//! nothing without a hypothesis.
//!
//! ```text
//! two hypotheses agree when their disparities differ by at most 1 px plus 0.04 px per px
//!     between them
//! weight of agreement: sum of the weights of the hypotheses that agree with one
//! mask: the hypothesis with the largest.  box: the nearest hypothesis with at least a third of the
//!                                         largest selects the surface, of which the
//!     largest counts: a box contains background, and more of it than of a thin object
//! plane: least squares over those that agree, then over all within 1 px of that plane; slopes are
//!        regularised towards 0
//! mask: of a plane with a quarter of that regularisation, if it explains an eighth more: a
//!     narrow wall that the cameras see along
//! ```
//!
//! # Bounds
//! Weights are at most 307, hypotheses 2 * 4096: sums below 2^22. Products with columns or
//! disparities below 2^36, with squares below 2^48, `i64`; scaled to 26 bits before they are
//! multiplied with each other.
//!
//! # Cost
//! [`HYPOTHESES`] comparisons a hypothesis at 12 instructions, and four passes at 40, three more
//! for a steeper plane.

use crate::list::List;
use crate::matching::consistency::Neighbour;
use crate::report::Ranked;
use crate::sort::sort_by_key;
use crate::units::{about_length, quotient};

/// Largest difference of disparity between hypotheses at one position, and between a hypothesis and
/// its plane, 1/64 px.
const TOLERANCE_Q6: i32 = 64;
/// Growth of the tolerance between hypotheses with the distance of their positions, 1/128 px per
/// px.
const GROWTH_Q7: i32 = 5;
/// Most hypotheses whose weight of agreement is computed; of more, every second, third ... in order
/// of disparity.
const HYPOTHESES: usize = 24;
/// Regularisation of slopes, weight (Q8) times px^2: errors of 0.8 px per hypothesis, slopes of
/// 0.03 px per px.
const LEVEL: i64 = 711 << 8;
/// Least weight of a surface that a steeper one replaces, Q8: what four hypotheses of high
/// probability weigh.
const LEAST_SLOPED_Q8: i32 = 4 << 8;
/// Least distance of a second surface from the plane, 1/64 px.
const SECOND_SURFACE_Q6: i32 = 3 << 6;
/// Largest distance of the plane's value at the region's centre from the range of its hypotheses'
/// disparities, 1/64 px.
const BEYOND_Q6: i32 = 16;

/// Plane of disparity of a region, with its support.
#[derive(Clone, Copy, Default)]
pub(crate) struct Surface {
    /// Disparity at the region's centre, 1/64 px.
    pub(crate) centre_q6: i32,
    /// Change of the disparity per pixel to the right and downwards, 1/1024 px.
    pub(crate) slope_q10: [i32; 2],
    /// Sum of its hypotheses' weights, Q8.
    pub(crate) weight_q8: i32,
    /// Number of segments and support points with a hypothesis on it.
    pub(crate) support: u16,
    /// Least and largest disparity of its hypotheses, 1/64 px.
    pub(crate) range_q6: (i32, i32),
    /// Largest distance of one of them from the plane, 1/64 px.
    pub(crate) spread_q6: i32,
    /// Mean position of its hypotheses relative to the region's centre, px.
    pub(crate) middle: [i32; 2],
    /// Variance of their positions along x and y, px^2.
    pub(crate) extent2: [i32; 2],
    /// Largest weight of agreement of a hypothesis far from this plane, Q8; 0 without a second
    /// surface.
    pub(crate) second_weight_q8: u32,
}

impl Surface {
    /// Disparity at a position relative to the region's centre, 1/64 px.
    pub(crate) fn at_q6(&self, u: i32, v: i32) -> i32 {
        let [across, down] = self.slope_q10;
        self.centre_q6 + ((across * u + down * v) >> 4)
    }
}

/// Position and disparity of a hypothesis, with the weight of agreement.
#[derive(Clone, Copy, Default)]
struct Hypothesis {
    x: i32,
    y: i32,
    d_q6: i32,
    weight_q8: u32,
}

impl Hypothesis {
    /// The better supported hypothesis of a neighbour, not yet weighed.
    fn new(neighbour: &Neighbour) -> Self {
        let [a, b] = &neighbour.hypotheses;
        let hypothesis = if b.support > a.support { b } else { a };
        Self {
            x: neighbour.x.into(),
            y: neighbour.y.into(),
            d_q6: hypothesis.d_q6.into(),
            weight_q8: 0,
        }
    }

    /// Sums up the weights of the hypotheses that agree with it.
    fn weigh(&mut self, neighbours: &[Neighbour]) {
        let mut weight_q8 = 0;
        for neighbour in neighbours {
            let (dx, dy) = (i32::from(neighbour.x) - self.x, i32::from(neighbour.y) - self.y);
            let tolerance_q6 = TOLERANCE_Q6 + ((GROWTH_Q7 * about_length(dx, dy)) >> 1);
            let [a, b] = &neighbour.hypotheses;
            for hypothesis in [a, b] {
                let agrees = (i32::from(hypothesis.d_q6) - self.d_q6).abs() <= tolerance_q6;
                weight_q8 += if agrees { u32::from(hypothesis.support) } else { 0 };
            }
        }
        self.weight_q8 = weight_q8;
    }

    /// Key: weight, then disparity, then position, so that the order of the list does not matter.
    fn by_weight(&self) -> (u32, i32, i32, i32) {
        (self.weight_q8, self.d_q6, self.y, self.x)
    }

    /// Key: disparity, then weight, then position.
    fn by_disparity(&self) -> (i32, u32, i32, i32) {
        (self.d_q6, self.weight_q8, self.y, self.x)
    }

    /// The plane of this disparity, by which hypotheses agree with this one.
    fn plane(&self) -> Plane {
        Plane {
            origin: [self.x, self.y],
            level_q6: self.d_q6,
            slope_q10: [0; 2],
            growth_q7: GROWTH_Q7,
        }
    }
}

/// Disparity as a plane, and how far from it hypotheses lie that belong to it.
#[derive(Clone, Copy)]
struct Plane {
    /// Position with the disparity `level_q6`, px.
    origin: [i32; 2],
    level_q6: i32,
    slope_q10: [i32; 2],
    /// Growth of the tolerance with the distance from `origin`, 1/128 px per px.
    growth_q7: i32,
}

impl Plane {
    /// Disparity at a position, 1/64 px.
    fn at_q6(&self, x: i32, y: i32) -> i32 {
        let ([x0, y0], [across, down]) = (self.origin, self.slope_q10);
        self.level_q6 + ((across * (x - x0) + down * (y - y0)) >> 4)
    }

    /// Largest distance from the plane, 1/64 px, of a hypothesis at a position.
    fn tolerance_q6(&self, x: i32, y: i32) -> i32 {
        let [x0, y0] = self.origin;
        TOLERANCE_Q6 + ((self.growth_q7 * about_length(x - x0, y - y0)) >> 1)
    }

    fn holds(&self, x: i32, y: i32, d_q6: i32) -> bool {
        (d_q6 - self.at_q6(x, y)).abs() <= self.tolerance_q6(x, y)
    }
}

/// Finds the surface of the hypotheses in `neighbours`, whose weight is `all_q8`; `None` without a
/// hypothesis of nonzero weight.
pub(crate) fn find(
    neighbours: &[Neighbour],
    centre: [i32; 2],
    is_box: bool,
    all_q8: i32,
    order: &mut List<'_, Ranked>,
) -> Option<Surface> {
    let mut hypotheses = [Hypothesis::default(); HYPOTHESES];
    let count = weigh_agreement(neighbours, order, &mut hypotheses);
    let sampled = hypotheses.get(..count)?;
    let chosen = choose(sampled, is_box)?.plane();
    let mut surface = around(neighbours, centre, &chosen, LEVEL)?;
    let explains_more = |weight_q8: i32, of: &Surface| 8 * weight_q8 >= 9 * of.weight_q8;
    if !is_box && surface.weight_q8 >= LEAST_SLOPED_Q8 && explains_more(all_q8, &surface) {
        let sloped = around(neighbours, centre, &chosen, LEVEL / 4)?;
        if explains_more(sloped.weight_q8, &surface) {
            surface = sloped;
        }
    }
    let [x0, y0] = centre;
    let far = sampled
        .iter()
        .filter(|h| (h.d_q6 - surface.at_q6(h.x - x0, h.y - y0)).abs() > SECOND_SURFACE_Q6);
    let second = far.max_by_key(|h| h.by_weight());
    surface.second_weight_q8 =
        second.map_or(0, |second| separate_weight(neighbours, &chosen, second));
    Some(surface)
}

/// The surface around the hypothesis whose plane `chosen` is, slopes regularised by `level`; `None`
/// without a hypothesis of nonzero weight.
#[inline(never)]
fn around(
    neighbours: &[Neighbour],
    centre: [i32; 2],
    chosen: &Plane,
    level: i64,
) -> Option<Surface> {
    let near = Sums::of(neighbours, centre, chosen).plane(centre, level)?;
    let plane = Sums::of(neighbours, centre, &near).plane(centre, level).unwrap_or(near);
    Sums::of(neighbours, centre, &plane).surface(&plane)
}

/// Weight of agreement of `second`; 0 where an eighth of it agrees with `chosen` too: then it is
/// one surface that bends.
fn separate_weight(neighbours: &[Neighbour], chosen: &Plane, second: &Hypothesis) -> u32 {
    let mut common = 0;
    let plane = second.plane();
    visit(neighbours, chosen, |[x, y], [d_q6, _], w| {
        common += if plane.holds(x, y, d_q6) { w } else { 0 }
    });
    if common.unsigned_abs() * 8 >= second.weight_q8 { 0 } else { second.weight_q8 }
}

/// Computes the weight of agreement of each hypothesis, or of every n-th of many in order of
/// disparity; returns their number. Does not depend on the order of the neighbours.
fn weigh_agreement(
    neighbours: &[Neighbour],
    order: &mut List<'_, Ranked>,
    hypotheses: &mut [Hypothesis; HYPOTHESES],
) -> usize {
    let step = neighbours.len().div_ceil(HYPOTHESES).max(1);
    if step == 1 {
        for (neighbour, hypothesis) in neighbours.iter().zip(hypotheses.iter_mut()) {
            *hypothesis = Hypothesis::new(neighbour);
        }
    } else {
        sort_by_disparity(neighbours, order);
        for (ranked, hypothesis) in order.iter().step_by(step).zip(hypotheses.iter_mut()) {
            *hypothesis = neighbours
                .get(usize::from(ranked.candidate))
                .map(Hypothesis::new)
                .unwrap_or_default();
        }
    }
    let count = neighbours.len().div_ceil(step);
    for hypothesis in hypotheses.iter_mut().take(count) {
        hypothesis.weigh(neighbours);
    }
    count
}

fn sort_by_disparity(neighbours: &[Neighbour], order: &mut List<'_, Ranked>) {
    order.clear();
    for (neighbour, i) in neighbours.iter().zip(0..) {
        let disparity = (Hypothesis::new(neighbour).d_q6 + 32768) as u16;
        let _ = order.push(Ranked { probability_q16: disparity, candidate: i }); // one per candidate: it fits
    }
    let column = |r: &Ranked| {
        neighbours.get(usize::from(r.candidate)).map(|neighbour| (neighbour.y, neighbour.x))
    };
    sort_by_key(order, |r| (r.probability_q16, column(r)));
}

/// The hypothesis that the object's surface is fitted around; of equal ones the nearest.
fn choose(sampled: &[Hypothesis], is_box: bool) -> Option<&Hypothesis> {
    let best = sampled.iter().max_by_key(|h| h.by_weight())?;
    if !is_box {
        return Some(best);
    }
    let nearest = sampled
        .iter()
        .filter(|h| h.weight_q8 * 3 >= best.weight_q8)
        .max_by_key(|h| h.by_disparity())?;
    let near = nearest.plane();
    sampled.iter().filter(|h| near.holds(h.x, h.y, h.d_q6)).max_by_key(|h| h.by_weight())
}

/// Calls `visit(position, [disparity, distance from the plane], weight)` for each hypothesis that
/// belongs to the plane; returns the number of neighbours with one.
#[inline]
fn visit(
    neighbours: &[Neighbour],
    plane: &Plane,
    mut visit: impl FnMut([i32; 2], [i32; 2], i32),
) -> u16 {
    let mut count = 0_u16;
    for neighbour in neighbours {
        let [x, y] = [neighbour.x, neighbour.y].map(i32::from);
        let (here_q6, tolerance_q6) = (plane.at_q6(x, y), plane.tolerance_q6(x, y));
        let mut has_one = false;
        let [a, b] = &neighbour.hypotheses;
        for hypothesis in [a, b] {
            let d_q6 = i32::from(hypothesis.d_q6);
            let off_q6 = (d_q6 - here_q6).abs();
            if hypothesis.weight_q8 > 0 && off_q6 <= tolerance_q6 {
                visit([x, y], [d_q6, off_q6], hypothesis.weight_q8.into());
                has_one = true;
            }
        }
        count = count.saturating_add(has_one.into());
    }
    count
}

/// Weighted sums over the hypotheses of a plane: positions relative to the centre, disparities, and
/// their products; and what else is said of them.
#[derive(Clone, Copy, Default)]
struct Sums {
    weight: i32,
    u: i64,
    v: i64,
    d_q6: i64,
    uu: i64,
    vv: i64,
    uv: i64,
    ud: i64,
    vd: i64,
    /// Number of neighbours with a hypothesis.
    support: u16,
    /// Least and largest disparity, 1/64 px.
    range_q6: (i32, i32),
    /// Largest distance from the plane, 1/64 px.
    spread_q6: i32,
}

impl Sums {
    /// Over the hypotheses that belong to a plane.
    #[inline(never)]
    fn of(neighbours: &[Neighbour], [x0, y0]: [i32; 2], plane: &Plane) -> Self {
        let mut sums = Self { range_q6: (i32::MAX, i32::MIN), ..Self::default() };
        sums.support = visit(neighbours, plane, |[x, y], [d_q6, off_q6], w| {
            let (u, v) = (x - x0, y - y0);
            let (wu, wv) = (w * u, w * v);
            sums.weight += w;
            sums.u += i64::from(wu);
            sums.v += i64::from(wv);
            sums.d_q6 += i64::from(w) * i64::from(d_q6);
            sums.uu += i64::from(wu) * i64::from(u);
            sums.vv += i64::from(wv) * i64::from(v);
            sums.uv += i64::from(wu) * i64::from(v);
            sums.ud += i64::from(wu) * i64::from(d_q6);
            sums.vd += i64::from(wv) * i64::from(d_q6);
            let (low, high) = sums.range_q6;
            sums.range_q6 = (low.min(d_q6), high.max(d_q6));
            sums.spread_q6 = sums.spread_q6.max(off_q6);
        });
        sums
    }

    /// Mean position, px, and disparity, 1/64 px; `None` without a hypothesis.
    fn means(&self) -> Option<[i32; 3]> {
        Some([self.per_weight(self.u)?, self.per_weight(self.v)?, self.per_weight(self.d_q6)?])
    }

    /// A sum divided by the weight, limited to 32 bits. Few sums are longer, and a division of 64
    /// bits takes hundreds of instructions.
    fn per_weight(&self, sum: i64) -> Option<i32> {
        match i32::try_from(sum) {
            Ok(sum) => sum.checked_div(self.weight),
            Err(_) => sum
                .checked_div(self.weight.into())
                .map(|quotient| i32::try_from(quotient).unwrap_or(i32::MAX)),
        }
    }

    /// A sum of products `sum(a b)` taken about the means: each factor as `[mean, sum]`.
    fn about(&self, products: i64, [a, sum_a]: [i64; 2], [b, sum_b]: [i64; 2]) -> i64 {
        products - a * sum_b - b * sum_a + a * b * i64::from(self.weight)
    }

    /// The plane of least squares, with slopes regularised by `level`; `None` without a hypothesis.
    fn plane(&self, centre: [i32; 2], level: i64) -> Option<Plane> {
        let [u, v, d_q6] = self.means()?;
        let [of_u, of_v, of_d] = [[u.into(), self.u], [v.into(), self.v], [d_q6.into(), self.d_q6]];
        let (uu, vv) =
            (level + self.about(self.uu, of_u, of_u), level + self.about(self.vv, of_v, of_v));
        let uv = self.about(self.uv, of_u, of_v);
        let (ud, vd) = (self.about(self.ud, of_u, of_d), self.about(self.vd, of_v, of_d));
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
        let at_mean = Plane { origin: [u, v], level_q6: d_q6, slope_q10, growth_q7: 0 };
        Some(Plane { origin: centre, level_q6: at_mean.at_q6(0, 0), ..at_mean })
    }

    /// The surface of these hypotheses, on their plane; `None` without one.
    fn surface(&self, plane: &Plane) -> Option<Surface> {
        let [u, v, _] = self.means()?;
        let (of_u, of_v) = ([u.into(), self.u], [v.into(), self.v]);
        let per_weight = |sum: i64| self.per_weight(sum).unwrap_or(0);
        let (low, high) = self.range_q6;
        Some(Surface {
            // Not `clamp`, which panics when its bounds cross.
            centre_q6: plane.level_q6.max(low - BEYOND_Q6).min(high + BEYOND_Q6),
            slope_q10: plane.slope_q10,
            weight_q8: self.weight,
            support: self.support,
            range_q6: self.range_q6,
            spread_q6: self.spread_q6,
            middle: [u, v],
            extent2: [self.about(self.uu, of_u, of_u), self.about(self.vv, of_v, of_v)]
                .map(per_weight),
            second_weight_q8: 0,
        })
    }
}

/// Largest slope of a surface visible to both cameras, 1/1024 px per px: 2.
const MAX_SLOPE_Q10: i32 = 2 << 10;
/// Largest numerator of a slope: 31 bits.
const LIMIT: i64 = i32::MAX as i64;
