//! Where support points are listed: off the border of their surface.
//!
//! In: the grid of a run, rated. Out: the pixel of a point in the list of points.
//!
//! A point stands in the middle of its window's texture. Where that is an outline, the pixel there
//! may show what is behind it. Neighbours that have the point's disparity say on which side its
//! surface lies: in the list the point is 2 px closer to these. What reads the grid itself keeps to
//! the texture, which was matched.
//!
//! # Cost
//! Some 300 instructions a point.

use super::evidence::around;
use super::{Support, SupportPoint};

/// Distance that a point is moved by, across and down, px. Chosen, as are the limits below, on
/// `qvga`, `middlebury2006_third`, `robot_world` and `robot_sequences`. Sets that did not choose
/// it, answers wrong as the texture lies and as listed: `middlebury2003` 2.8 and 1.8 %,
/// `middlebury2005_half` 3.6 and 3.3, `kitti2012_640` 3.4 and 3.2.
const STEP: i32 = 2;
/// Least probability of a neighbour, Q16: 0.85.
const LEAST_OF_NEIGHBOUR: u16 = 55_705;
/// Largest difference between the disparities of points of one surface, 1/64 px.
const SAME_Q6: i32 = 64;
/// Least difference between the votes for two sides. A neighbour beside the point has two votes,
/// one in a corner one for each of its sides.
const LEAST_VOTES: i32 = 2;

impl<'a> Support<'a> {
    /// The point with this index, matched or not, with the pixel that it is listed at.
    pub fn listed(&self, index: usize) -> Option<((u16, u16), &'a SupportPoint)> {
        let point = self.points.get(index)?;
        let [dx, dy] = self.step_of(index, point);
        Some((self.grid.pixel(index, point.place.moved(dx, dy)), point))
    }

    /// Distance to the right and downward that a point is moved by, px. A bar is too narrow for
    /// that, and the ground goes on at all sides.
    fn step_of(&self, index: usize, point: &SupportPoint) -> [i32; 2] {
        if !point.is_matched() || point.is_of_bar() || point.place.is_on_plane() {
            return [0; 2];
        }
        let (near, before) = around(self.points, self.grid, index);
        let mut votes = [0_i32; 2];
        for (points, dy) in near.into_iter().zip(-1_i32..) {
            for (other, dx) in points.iter().zip(-before..) {
                let apart = i32::from(other.disparity_q6) - i32::from(point.disparity_q6);
                if other.probability_q16 >= LEAST_OF_NEIGHBOUR && apart.abs() <= SAME_Q6 {
                    let [across, down] = &mut votes;
                    *across += dx * (2 - dy.abs());
                    *down += dy * (2 - dx.abs());
                }
            }
        }
        votes.map(|votes| if votes.abs() < LEAST_VOTES { 0 } else { votes.signum() * STEP })
    }
}

#[cfg(test)]
mod tests {
    use super::super::place::Place;
    use super::*;
    use crate::image::Dims;
    use crate::params::Params;

    const DIMS: Dims = Dims { width: 24, height: 24 };
    /// The middle of three by three points.
    const MIDDLE: usize = 4;

    /// A credible point of a surface at 10 px.
    fn point() -> SupportPoint {
        SupportPoint::matched(640, u16::MAX)
    }

    /// Where the middle is listed, relative to its texture.
    fn moved(points: &[SupportPoint; 9]) -> (i32, i32) {
        let support = Support::new(&Params::default(), DIMS, points, 0);
        let (listed, _) = support.listed(MIDDLE).unwrap();
        let (x, y) = support.grid.pixel(MIDDLE, points[MIDDLE].place);
        (i32::from(listed.0) - i32::from(x), i32::from(listed.1) - i32::from(y))
    }

    /// All points of the surface but these.
    fn without(others: &[usize]) -> [SupportPoint; 9] {
        let mut points = [point(); 9];
        others.iter().for_each(|&other| points[other] = SupportPoint::none());
        points
    }

    #[test]
    fn points_are_listed_towards_their_surface() {
        assert_eq!(moved(&without(&[])), (0, 0));
        assert_eq!(moved(&without(&[0, 3, 6])), (2, 0));
        assert_eq!(moved(&without(&[2, 5, 8])), (-2, 0));
        assert_eq!(moved(&without(&[0, 1, 2])), (0, 2));
        assert_eq!(moved(&without(&[5, 6, 7, 8])), (-2, -2));
        // A single corner that lacks says little.
        assert_eq!(moved(&without(&[0])), (0, 0));
        // A strip of points has no side.
        assert_eq!(moved(&without(&[0, 1, 2, 6, 7, 8])), (0, 0));
    }

    #[test]
    fn other_surfaces_and_points_in_doubt_have_no_vote() {
        let mut points = without(&[]);
        for other in [0, 3, 6] {
            points[other].disparity_q6 += 65;
        }
        assert_eq!(moved(&points), (2, 0));
        for other in [0, 3, 6] {
            points[other].disparity_q6 -= 1;
        }
        assert_eq!(moved(&points), (0, 0));
        for other in [0, 3, 6] {
            points[other].probability_q16 = LEAST_OF_NEIGHBOUR - 1;
        }
        assert_eq!(moved(&points), (2, 0));
    }

    #[test]
    fn bars_and_the_ground_stay_where_they_are() {
        let mut points = without(&[0, 3, 6]);
        points[MIDDLE].place = points[MIDDLE].place.on_plane();
        assert_eq!(moved(&points), (0, 0));
        points[MIDDLE] = point();
        points[MIDDLE].take_bar(640, point().confidence());
        assert_eq!(moved(&points), (0, 0));
    }

    #[test]
    fn a_point_stays_in_its_square() {
        let mut points = without(&[0, 3, 6]);
        points[MIDDLE].place = Place::MIDDLE.moved(2, 0);
        assert_eq!(moved(&points), (1, 0));
        points[MIDDLE].place = Place::MIDDLE.moved(3, -4);
        assert_eq!(moved(&points), (0, 0));
    }
}
