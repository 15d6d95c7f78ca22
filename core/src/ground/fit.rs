//! Least squares over the strips near a plane.
//!
//! ```text
//! four times, with strips within 4, 4, 3, 3 px and then 3.5, 2.5, 1.5, 1.2 px of the plane so far:
//!     d(strip) = b y + c x + a, weighted by 1 - cost / mean, sub-pixel, roll shrunk towards 0
//! taken with b of 0.05 to 2.2, 18 strips on it, and a tenth of all that see it with their lowest
//! cost; half of them with b below 0.14
//! ```
//!
//! # Bounds
//! Weights below 2^6, rows from their mean below 2^8 and columns below 2^9, disparities below 2^14
//! in 1/64 px, 2^10 strips: sums below 2^34 (x x) and 2^39 (x d), products of two below 2^63 with 4
//! and 6 bits less.

use super::GroundPlane;
use super::strips::Strips;
use crate::cores::{Cores, join, lend};
use crate::curve::subpixel_q6;
use core::ops::Range;

/// Distance searched around the plane, px, and of strips that are used afterwards, 1/64 px.
const ROUNDS: [(i32, i32); 4] = [(4, 224), (4, 160), (3, 96), (3, 77)];
/// Least number of strips.
const FEWEST: u32 = 8;
/// Least number of strips of a plane that is taken.
const FEWEST_OF_PLANE: u32 = 18;
/// Slopes of a plane that is taken, Q16: 0.05 to 2.2.
const SLOPES_Q16: core::ops::RangeInclusive<i32> = 3277..=144_179;
/// Slope below which walls and furniture come near a plane, and half of the strips that see it have
/// to lie on it, Q16: 0.14. Chosen on drawn rooms under high cameras; `docs/experiments.md` has
/// others.
pub(super) const SHALLOW_Q16: i32 = 9175;
/// Shrinks roll: 1000 px^2 of columns at weight 1, as weights are counted.
const SHRINK: i64 = 63_000;

/// The plane near this one.
pub(super) fn fit(
    mut cores: Option<&mut dyn Cores>,
    strips: &Strips<'_>,
    mut plane: GroundPlane,
) -> Option<GroundPlane> {
    let mut strong = false;
    for (reach, tolerance_q6) in ROUNDS {
        let (mut sums, mut others) = (Sums::default(), Sums::default());
        let (end, add) = (strips.rows, |sums: &mut Sums, rows: Range<usize>| {
            sums.add_near(strips, plane, reach, tolerance_q6, rows);
        });
        let middle = if cores.is_some() { end / 2 } else { end };
        join(lend(&mut cores), || add(&mut sums, 0..middle), || add(&mut others, middle..end));
        sums.merge(&others);
        if sums.count < FEWEST {
            return None;
        }
        plane = sums.solve()?;
        let part = if plane.down_q16 < SHALLOW_Q16 { 2 } else { 10 };
        strong = sums.count >= FEWEST_OF_PLANE && part * sums.lowest >= sums.seen;
    }
    (strong && SLOPES_Q16.contains(&plane.down_q16)).then_some(plane)
}

/// A strip near the plane.
struct Sample {
    x: i32,
    y: i32,
    d_q6: i32,
    weight: i32,
}

/// Numbers of strips, and their weighted sums.
#[derive(Default)]
struct Sums {
    /// Strips that see the plane.
    seen: u32,
    /// Those whose lowest cost of all lies on it.
    lowest: u32,
    /// Those that are used.
    count: u32,
    weight: i64,
    x: i64,
    y: i64,
    d: i64,
    xx: i64,
    xy: i64,
    yy: i64,
    xd: i64,
    yd: i64,
}

impl Sums {
    /// Adds the strips of these rows.
    fn add_near(
        &mut self,
        strips: &Strips<'_>,
        plane: GroundPlane,
        reach: i32,
        tolerance_q6: i32,
        rows: Range<usize>,
    ) {
        let sums = self;
        for (row, y) in rows.clone().zip(strips.ys().skip(rows.start)) {
            for index in 0..strips.strips {
                let x = Strips::middle(index);
                let expected_q6 = plane.at_q6(x, y);
                let Some((summary, costs)) = strips.strip(row, index) else { continue };
                let middle = (expected_q6 + 32) >> 6;
                if middle <= 2 || middle + reach >= costs.len() as i32 {
                    continue;
                }
                sums.seen += 1;
                let cost = |d: i32| usize::try_from(d).ok().and_then(|d| costs.get(d)).copied();
                let mut best = (middle, u8::MAX);
                for d in middle - reach..=middle + reach {
                    if let Some(cost) = cost(d)
                        && cost < best.1
                    {
                        best = (d, cost);
                    }
                }
                let (at, lowest) = best;
                let d_q6 = subpixel_q6(at, |d| cost(d).map(u16::from));
                if (at - middle).abs() == reach || (d_q6 - expected_q6).abs() > tolerance_q6 {
                    continue;
                }
                sums.lowest += u32::from(lowest <= summary.lowest);
                if 10 * u32::from(lowest) < 13 * u32::from(summary.lowest).max(1) {
                    let part =
                        crate::units::quotient(i32::from(lowest) << 6, i32::from(summary.mean));
                    sums.add(&Sample { x, y, d_q6, weight: (63 - part).clamp(0, 63) });
                }
            }
        }
    }

    /// Adds those of other rows.
    fn merge(&mut self, other: &Self) {
        self.seen += other.seen;
        self.lowest += other.lowest;
        self.count += other.count;
        self.weight += other.weight;
        self.x += other.x;
        self.y += other.y;
        self.d += other.d;
        self.xx += other.xx;
        self.xy += other.xy;
        self.yy += other.yy;
        self.xd += other.xd;
        self.yd += other.yd;
    }

    fn add(&mut self, sample: &Sample) {
        let [x, y, d, weight] = [sample.x, sample.y, sample.d_q6, sample.weight].map(i64::from);
        self.count += 1;
        self.weight += weight;
        self.x += weight * x;
        self.y += weight * y;
        self.d += weight * d;
        self.xx += weight * x * x;
        self.xy += weight * x * y;
        self.yy += weight * y * y;
        self.xd += weight * x * d;
        self.yd += weight * y * d;
    }

    /// The plane through the strips; `None` where they lie on a line.
    fn solve(&self) -> Option<GroundPlane> {
        // About the weighted means.
        let about =
            |product: i64, a: i64, b: i64| Some(product - (a * b).checked_div(self.weight)?);
        let xx = about(self.xx, self.x, self.x)? + SHRINK;
        let (xy, yy) = (about(self.xy, self.x, self.y)?, about(self.yy, self.y, self.y)?);
        let (xd, yd) = (about(self.xd, self.x, self.d)?, about(self.yd, self.y, self.d)?);
        // Products of sums need 63 bits: a quarter of each side of the equations, with 4 bits less
        // of d.
        let [xx, xy, yy] = [xx, xy, yy].map(|sum| sum >> 4);
        let [xd, yd] = [xd, yd].map(|sum| sum >> 6);
        let determinant = xx * yy - xy * xy;
        // d is in 1/64 px and was divided by 4 more: 2^4 of each px are left.
        let down_q16 = ratio_q12(yd * xx - xd * xy, determinant)?;
        let across_q16 = ratio_q12(xd * yy - yd * xy, determinant)?;
        let mean_q16 = |sum: i64| (sum << 16).checked_div(self.weight);
        let d_q16 = mean_q16(self.d)? >> 6;
        let origin =
            d_q16 - ((down_q16 * mean_q16(self.y)? + across_q16 * mean_q16(self.x)?) >> 16);
        Some(GroundPlane {
            down_q16: i32::try_from(down_q16).ok()?,
            across_q16: i32::try_from(across_q16).ok()?,
            origin_q16: i32::try_from(origin).ok()?,
        })
    }
}

/// `numerator / denominator`, Q12; `None` where that is 0 or less, or the ratio is beyond 16.
fn ratio_q12(numerator: i64, denominator: i64) -> Option<i64> {
    if denominator <= 0 {
        return None;
    }
    let excess = 47_u32.saturating_sub(denominator.leading_zeros().min(47));
    let (numerator, denominator) = (numerator >> excess, denominator >> excess);
    (numerator.abs() < denominator << 8).then(|| (numerator << 12).checked_div(denominator))?
}
