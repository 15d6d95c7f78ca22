//! Evaluation of cost curves over disparity: the minimum, its uniqueness, the left-right check, fractions.
//!
//! In: a row of curves. Out: for each left pixel a disparity with a confidence, or none.
//!
//! ```text
//! best       = the disparity of the lowest cost, the largest of equals
//! second     = the lowest cost more than 1 px from it
//! confidence = 1 - best cost / second cost                               0: another place is as good; 1: no other is possible
//! check      = the best disparity of the right pixel, from the same curves, is the same within a tolerance
//! fraction   = vertex of a parabola, or of two lines of opposite slope (equiangular), through the costs at best - 1, best, best + 1
//! ```
//!
//! # Source
//! Equiangular fit: Shimizu and Okutomi, "Precise sub-pixel estimation on area-based matching" (2001). Right disparities from the
//! left curves: Muehlmann et al., "Calculating dense disparity maps from color stereo images" (2002).

use super::map::DisparityMap;
use super::sums::CurveRow;

/// How a disparity gets its fraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Fraction {
    /// It stays whole.
    None,
    /// By the vertex of a parabola.
    Parabola,
    /// By the vertex of two lines of opposite slope.
    #[default]
    Equiangular,
}

impl Fraction {
    /// Fraction, -0.5 to 0.5, of a minimum `cost` between its neighbours.
    #[must_use]
    pub fn of(self, before: u32, cost: u32, after: u32) -> f32 {
        let [before, cost, after] = [before, cost, after].map(|cost| cost as f32);
        let width = match self {
            Self::None => return 0.0,
            Self::Parabola => before + after - 2.0 * cost,
            Self::Equiangular => 2.0 * (before.max(after) - cost),
        };
        let steps = match self {
            Self::Parabola => 0.5 * (before - after),
            _ => before - after,
        };
        if width > 0.0 { (steps / width).clamp(-0.5, 0.5) } else { 0.0 }
    }
}

/// The lowest place of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Minimum {
    /// Its disparity.
    pub disparity: usize,
    /// Its cost.
    pub cost: u32,
    /// The lowest cost more than 1 px from it; `u32::MAX` when nothing is.
    pub second: u32,
}

impl Minimum {
    /// Of a curve that holds at least one cost.
    #[must_use]
    pub fn of(curve: &[u32]) -> Self {
        let cost = lowest(curve);
        Self::at(curve, curve.iter().rposition(|&other| other == cost).unwrap_or(0))
    }

    /// A place of a curve, whether it is the lowest or not.
    #[must_use]
    pub fn at(curve: &[u32], disparity: usize) -> Self {
        let below = lowest(&curve[..disparity.saturating_sub(1)]);
        let above = lowest(curve.get(disparity + 2..).unwrap_or(&[]));
        Self { disparity, cost: curve[disparity], second: below.min(above) }
    }

    /// `1 - cost / second`: 0 when another place is as good.
    #[must_use]
    pub fn confidence(&self) -> f32 {
        if self.second == 0 { 0.0 } else { 1.0 - self.cost as f32 / self.second as f32 }
    }

    /// The disparity with its fraction.
    #[must_use]
    pub fn refined(&self, curve: &[u32], fraction: Fraction) -> f32 {
        let d = self.disparity;
        let inside = d > 0 && d + 1 < curve.len();
        d as f32 + if inside { fraction.of(curve[d - 1], curve[d], curve[d + 1]) } else { 0.0 }
    }
}

/// `u32::MAX` of nothing.
fn lowest(costs: &[u32]) -> u32 {
    costs.iter().copied().fold(u32::MAX, u32::min)
}

/// Acceptance tests of a curve's minimum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Acceptance {
    /// Least confidence, 0 to 1: OpenCV's `uniquenessRatio` u of block matching is `u / (100 + u)` here, that of SGBM `u / 100`.
    pub least_confidence: f32,
    /// How far the disparities of both images may differ, px; `None` does not ask the right image.
    pub left_right: Option<u32>,
    /// How fractions are found.
    pub fraction: Fraction,
}

impl Acceptance {
    /// Fills a row of the map.
    pub fn read(&self, row: CurveRow<'_>, scratch: &mut Vec<RightPixel>, map: &mut DisparityMap) {
        if self.left_right.is_some() {
            right_disparities(row, scratch);
        }
        for (x, curve) in row.curves() {
            let minimum = Minimum::of(curve);
            if minimum.confidence() < self.least_confidence {
                continue;
            }
            map.set(x, row.y, minimum.refined(curve, self.fraction), minimum.confidence());
            if let Some(tolerance) = self.left_right {
                let partner = scratch[x - minimum.disparity];
                if partner.disparity.abs_diff(minimum.disparity as u32) > tolerance {
                    map.mark_occluded(x, row.y);
                }
            }
        }
    }
}

/// The best disparity of a pixel of the right image.
#[derive(Clone, Copy, Debug)]
pub struct RightPixel {
    cost: u32,
    disparity: u32,
}

/// Right column `x - d` sees what left column `x` sees at disparity `d`.
fn right_disparities(row: CurveRow<'_>, best: &mut Vec<RightPixel>) {
    let columns = row.first + row.costs.len() / row.count;
    best.clear();
    best.resize(columns, RightPixel { cost: u32::MAX, disparity: 0 });
    for (x, curve) in row.curves() {
        let start = x + 1 - row.count;
        for ((d, &cost), pixel) in curve.iter().enumerate().rev().zip(&mut best[start..=x]) {
            // Left columns come from the left: of equal costs the larger disparity stays last.
            if cost <= pixel.cost {
                *pixel = RightPixel { cost, disparity: d as u32 };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_is_more_than_one_pixel_away() {
        let minimum = Minimum::of(&[9, 4, 3, 2, 3, 8, 5]);
        assert_eq!(minimum, Minimum { disparity: 3, cost: 2, second: 4 });
        assert_eq!(minimum.confidence(), 0.5);
        assert_eq!(Minimum::of(&[1, 1]), Minimum { disparity: 1, cost: 1, second: u32::MAX });
    }

    #[test]
    fn right_pixels_choose_among_the_left_ones() {
        // Columns 2, 3 and 4 with three disparities each; right column 2 is seen at (2, 0), (3, 1) and (4, 2).
        let costs = [5, 9, 9, 9, 4, 9, 9, 9, 6];
        let mut best = Vec::new();
        right_disparities(CurveRow { y: 0, first: 2, count: 3, costs: &costs }, &mut best);
        assert_eq!(best[2].disparity, 1);
        assert_eq!(best[0].disparity, 2); // only column 2 at disparity 2 falls there
    }
}
