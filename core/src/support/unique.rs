//! Uniqueness: a place of the right image shows one surface.
//!
//! In: the rated points of large images. Out: the same, without those that match what a farther
//! point matches.
//!
//! ```text
//! left     F F F F h h h N N N    N: near   F: far   h: of F, but hidden by N in the right image
//! right    F F F F N N N
//! ```
//! The paths of N go on through h, where a window at the disparity of N matches the F left of N in
//! the right image. That is the place of points of F. Both cannot be right, since N would hide F
//! there. So a point is rejected where a farther one of its row matches the same place, unless it
//! is clearly more probable than that, and so is a pixel beside a segment. On slopes and floors the
//! disparity changes by less from one column to the next.
//!
//! Smaller images gain nothing by it. Chosen on the large sets of `linestereo-lab bench`. Of the
//! first 70 and 80 % of the cells of 42 drawn scenes, which chose nothing, 3.6 and 9.1 instead of
//! 3.9 and 9.3 % are off by more than 1 px.
//!
//! # Cost
//! Some 15 instructions for each column of points within the disparity left of a point.
//!
//! # Source
//! Marr, Poggio 1976.

use super::{Grid, SUPPORT_PITCH, Support, SupportPoint, place};

/// Points whose places in the right image differ by this match the same one, if their disparities
/// differ by more, 1/64 px: points are 8 px apart.
const SAME_Q6: i32 = 6 << 6;
/// Share of a point's probability that the farther one has at least, 1/256: 0.8.
const LEAST_SHARE_Q8: u32 = 205;

/// A claim for a place of the right image.
struct Claim {
    /// Column in the left image, px.
    x: i32,
    disparity_q6: i32,
    probability_q16: u16,
}

impl Claim {
    /// True when a farther one of the points at the left, of the same row of the grid, has the
    /// same place.
    fn is_taken(&self, row: &[SupportPoint], grid: Grid) -> bool {
        let right_q6 = (self.x << 6) - self.disparity_q6;
        // The farthest that can be has the least disparity.
        let from = ((right_q6 - SAME_Q6) >> 6) + i32::from(grid.min_disparity) - place::MOST;
        let columns = grid.columns_within(from, self.x - place::LEAST);
        let first = columns.start;
        row.get(columns).unwrap_or_default().iter().zip(first..).any(|(other, column)| {
            let (x, disparity_q6) =
                (grid.x(column) + other.place.dx(), i32::from(other.disparity_q6));
            other.is_matched()
                && self.disparity_q6 - disparity_q6 > SAME_Q6
                && ((x << 6) - disparity_q6 - right_q6).abs() <= SAME_Q6
                && u32::from(other.probability_q16) << 8
                    >= u32::from(self.probability_q16) * LEAST_SHARE_Q8
        })
    }
}

/// Rejects the points of which a farther one matches the same place.
pub(super) fn reject(points: &mut [SupportPoint], grid: Grid) {
    for row in points.chunks_exact_mut(grid.columns.max(1)) {
        // From the right: those at the left are what they were.
        for column in (0..row.len()).rev() {
            let Some(point) = row.get(column).filter(|point| point.is_matched()) else { continue };
            let claim = Claim {
                x: grid.x(column) + point.place.dx(),
                disparity_q6: point.disparity_q6.into(),
                probability_q16: point.probability_q16,
            };
            if claim.is_taken(row, grid)
                && let Some(point) = row.get_mut(column)
            {
                *point = SupportPoint::none();
            }
        }
    }
}

impl Support<'_> {
    /// True when a farther point of large images matches what this pixel would with a disparity,
    /// 1/64 px, of this probability.
    pub(crate) fn is_taken(
        &self,
        (x, y): (u16, u16),
        disparity_q6: i32,
        probability_q16: u16,
    ) -> bool {
        if !self.is_fine() {
            return false;
        }
        let start = usize::from(y / SUPPORT_PITCH) * self.grid.columns;
        let row = self.points.get(start..start + self.grid.columns).unwrap_or_default();
        Claim { x: x.into(), disparity_q6, probability_q16 }.is_taken(row, self.grid)
    }
}

#[cfg(all(test, feature = "wide"))]
mod tests {
    use super::*;
    use crate::image::Dims;
    use crate::params::Params;

    const DIMS: Dims = Dims { width: 640, height: 16 };
    /// Column of the point in question, 100 px.
    const OWN: usize = 12;

    fn point(disparity: i16, probability_q16: u16) -> SupportPoint {
        SupportPoint::matched(disparity << 6, probability_q16)
    }

    /// True when a point of 40 px and 0.9 is rejected beside this one at a column, in its row or in
    /// the other one. Then a pixel there is taken as well.
    fn is_rejected(row: usize, column: usize, other: SupportPoint) -> bool {
        let grid = Grid::new(&Params::default(), DIMS);
        let mut points = [SupportPoint::none(); 160];
        points[OWN] = point(40, 59_000);
        points[row * grid.columns + column] = other;
        let support = Support::new(&Params::default(), DIMS, &points, 0);
        let is_taken = support.is_taken((100, 7), 40 << 6, 59_000);
        reject(&mut points, grid);
        assert_eq!(is_taken, !points[OWN].is_matched());
        is_taken
    }

    #[test]
    fn a_place_is_that_of_the_farther_point() {
        // At 68 px: its place is 60 px with a disparity of 8 px.
        let of = |disparity| is_rejected(0, 8, point(disparity, 59_000));
        assert_eq!([1, 2, 8, 14, 15].map(of), [false, true, true, true, false]);
        // One of the other row, and one at the right, which is nearer.
        assert!(!is_rejected(1, 8, point(8, 59_000)));
        assert!(!is_rejected(0, 16, point(72, 59_000)));
    }

    #[test]
    fn a_slope_is_no_second_surface() {
        // 8 px further left, 6 px and more than 6 px farther.
        let of = |disparity| is_rejected(0, 11, point(disparity, 59_000));
        assert_eq!([34, 33].map(of), [false, true]);
    }

    #[test]
    fn a_point_that_is_clearly_more_probable_stays() {
        let of = |probability_q16| is_rejected(0, 8, point(8, probability_q16));
        assert_eq!([47_247, 47_246].map(of), [true, false]);
        assert!(!is_rejected(0, 8, SupportPoint::none()));
    }
}
