//! A segment against the truth of the surface that it is said to belong to.

use linestereo::results::{Match, Owner};
use linestereo_frames::Truth;

/// A segment with `|dx|` above this many times `|dy|` is near-horizontal: its sides are above and
/// below.
const STEEP_LIMIT: f64 = 4.0;
/// Distance square to the edge, px, at which the owning side's surface is looked up: beyond the
/// pixels that hold both surfaces.
const BESIDE: f64 = 1.5;

/// Disparity of a segment at its middle, and the pixel of its owner beside that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnedMiddle {
    /// Column and row of the owner's pixel; left or above where both sides own it.
    pub pixel: (i32, i32),
    /// Disparity at the middle, px.
    pub disparity: f64,
}

impl OwnedMiddle {
    /// The middle of this segment.
    pub fn new(segment: &Match) -> Self {
        let [[x0, y0], [x1, y1]] =
            segment.ends.map(|end| [end.x.to_num::<f64>(), end.y.to_num::<f64>()]);
        let [d0, d1] = segment.disparity.map(|disparity| disparity.to_num::<f64>());
        let (along_x, along_y) = (x1 - x0, y1 - y0);
        let near_horizontal = along_x.abs() > STEEP_LIMIT * along_y.abs();
        // The normal that points below, or to the right.
        let sign = if near_horizontal { along_x.signum() } else { -along_y.signum() };
        let beside = if segment.owner == Owner::Right { BESIDE } else { -BESIDE };
        let scale = sign * beside / along_x.hypot(along_y).max(f64::MIN_POSITIVE);
        let (dx, dy) = (-along_y * scale, along_x * scale);
        let pixel = ((0.5 * (x0 + x1) + dx).round() as i32, (0.5 * (y0 + y1) + dy).round() as i32);
        Self { pixel, disparity: 0.5 * (d0 + d1) }
    }

    /// Disparity minus that of the owner's surface, px; `None` without truth there.
    pub fn error(&self, truth: &Truth) -> Option<f64> {
        let (x, y) = self.pixel;
        truth.disparity(x, y).map(|d| self.disparity - f64::from(d))
    }
}

#[cfg(test)]
mod tests {
    use super::super::frame::tests::{segment, truth};
    use super::*;

    #[test]
    fn the_side_is_looked_up_square_to_the_edge() {
        let pixel =
            |ends, owner| OwnedMiddle::new(&Match { owner, ..segment(ends, [8.0, 8.0]) }).pixel;
        // Sixteen degrees off the rows: near-vertical by its sides, but the surface lies above or
        // below.
        let slanted = [[20.0, 10.0], [27.0, 12.0]];
        assert_eq!(
            [Owner::Left, Owner::Right].map(|owner| pixel(slanted, owner)),
            [(23, 12), (24, 10)]
        );
        let falling = [[10.0, 20.0], [20.0, 20.0]];
        for ends in [falling, [falling[1], falling[0]]] {
            assert_eq!(
                [Owner::Left, Owner::Right].map(|owner| pixel(ends, owner)),
                [(15, 19), (15, 22)]
            );
        }
    }

    #[test]
    fn a_segment_is_compared_with_the_side_that_owns_it() {
        // An edge between disparities of 8 and 12.
        let edge = segment([[19.5, 2.0], [19.5, 10.0]], [12.25, 12.25]);
        let error = |owner| OwnedMiddle::new(&Match { owner, ..edge }).error(&truth());
        assert_eq!(
            [Owner::Left, Owner::Right, Owner::Both].map(error),
            [Some(4.25), Some(0.25), Some(4.25)]
        );
    }
}
