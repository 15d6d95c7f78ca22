//! Curves of costs over disparity: the minimum, its uniqueness, its fraction, the left-right check.
//!
//! In: a row of curves. Out: for each left pixel a disparity with a confidence, or none.
//!
//! ```text
//! best       = the disparity of the lowest cost, the largest of equals
//! second     = the lowest cost more than 1 px from it
//! confidence = 1 - best cost / second cost            0: another place is as good
//! fraction   = vertex of two lines of opposite slope through the costs around the best
//! check      = the best disparity of the right pixel, from the same curves, is the same to 1 px
//! ```
//!
//! # Source
//! Fraction: Shimizu and Okutomi, "Precise sub-pixel estimation on area-based matching" (2001).
//! Check: Muehlmann et al., "Calculating dense disparity maps from color stereo images" (2002).

use crate::DisparityMap;

/// Largest difference of the disparities of a left pixel and its right one, px.
const TOLERANCE_PX: usize = 1;

/// The costs of a row of pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurveRow<'a> {
    /// The row.
    pub(crate) y: usize,
    /// Column of the first curve.
    pub(crate) first: usize,
    /// Disparities of a curve.
    pub(crate) count: usize,
    /// Curve after curve.
    pub(crate) costs: &'a [i16],
}

impl<'a> CurveRow<'a> {
    /// Columns and their costs at disparities 0, 1, 2, ...
    pub(crate) fn curves(self) -> impl Iterator<Item = (usize, &'a [i16])> {
        (self.first..).zip(self.costs.chunks_exact(self.count))
    }

    /// The best disparity of each right column, 0 where no curve reaches.
    ///
    /// Right column `x - d` sees what left column `x` sees at disparity `d`.
    fn right_disparities(self) -> Vec<usize> {
        let mut best = vec![(i16::MAX, 0); self.first + self.costs.len() / self.count];
        for (x, curve) in self.curves() {
            for ((d, &cost), best) in
                curve.iter().enumerate().rev().zip(&mut best[x + 1 - self.count..=x])
            {
                // Left columns come from the left: of equal costs the larger disparity comes last.
                if cost <= best.0 {
                    *best = (cost, d);
                }
            }
        }
        best.into_iter().map(|(_, d)| d).collect()
    }
}

/// The lowest place of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Minimum {
    /// Its disparity.
    pub(crate) disparity: usize,
    /// Its cost.
    pub(crate) cost: i16,
    /// The lowest cost more than 1 px from it; `i16::MAX` when nothing is.
    pub(crate) second: i16,
}

impl Minimum {
    /// Of a curve that holds at least one cost.
    pub(crate) fn of(curve: &[i16]) -> Self {
        let cost = lowest(curve);
        let disparity = curve.iter().rposition(|&other| other == cost).unwrap_or(0);
        let below = lowest(&curve[..disparity.saturating_sub(1)]);
        let above = lowest(curve.get(disparity + 2..).unwrap_or(&[]));
        Self { disparity, cost, second: below.min(above) }
    }

    /// `1 - cost / second`: 0 when another place is as good.
    pub(crate) fn confidence(&self) -> f32 {
        if self.second == 0 { 0.0 } else { 1.0 - f32::from(self.cost) / f32::from(self.second) }
    }

    /// The costs before and after it; `None` at either end of the curve.
    ///
    /// It is the last of the lowest ones, so the cost after it is above it.
    pub(crate) fn neighbours(&self, curve: &[i16]) -> Option<[i16; 2]> {
        Some([*curve.get(self.disparity.checked_sub(1)?)?, *curve.get(self.disparity + 1)?])
    }

    /// The disparity with its fraction, px.
    fn refined(&self, curve: &[i16]) -> f32 {
        let fraction = self.neighbours(curve).map_or(0.0, |neighbours| {
            let [before, after] = neighbours.map(f32::from);
            (before - after) / (2.0 * (before.max(after) - f32::from(self.cost)))
        });
        self.disparity as f32 + fraction
    }
}

/// `i16::MAX` of nothing.
fn lowest(costs: &[i16]) -> i16 {
    costs.iter().copied().fold(i16::MAX, i16::min)
}

/// Tests that a minimum has to pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Acceptance {
    /// Least confidence, 0 to 1. OpenCV's `uniquenessRatio` u of block matching is `u / (100 + u)`
    /// here, that of SGBM `u / 100`.
    pub(crate) least_confidence: f32,
    /// True if the right image has to agree.
    pub(crate) left_right: bool,
}

impl Acceptance {
    /// Fills a row of the map.
    pub(crate) fn fill(&self, row: CurveRow<'_>, map: &mut DisparityMap) {
        let right = self.left_right.then(|| row.right_disparities());
        for (x, curve) in row.curves() {
            let minimum = Minimum::of(curve);
            let d = minimum.disparity;
            let is_agreed =
                right.as_ref().is_none_or(|right| right[x - d].abs_diff(d) <= TOLERANCE_PX);
            if is_agreed && minimum.confidence() >= self.least_confidence {
                map.set(x, row.y, minimum.refined(curve), minimum.confidence());
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
        assert_eq!(Minimum::of(&[1, 1]), Minimum { disparity: 1, cost: 1, second: i16::MAX });
    }

    #[test]
    fn right_pixels_choose_among_the_left_ones() {
        // Columns 2, 3 and 4 with three disparities each. Right column 2 is seen at (2, 0), (3, 1)
        // and (4, 2), right column 0 only at (2, 2).
        let costs = [5, 9, 9, 9, 4, 9, 9, 9, 6];
        let right = CurveRow { y: 0, first: 2, count: 3, costs: &costs }.right_disparities();
        assert_eq!((right[2], right[0]), (1, 2));
    }
}
