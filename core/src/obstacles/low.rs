//! Support points just in front of the ground plane, among points on it.
//!
//! In: a support point, and those around it. Out: its probability for directions.
//!
//! A point is right within 1 px, so one up to 2 px in front of the ground may be ground. Where a
//! floor changes little along the rows, as planks and joints of tiles do, many points are wrong in
//! the same way: each is doubtful, and they agree. Points on the ground beside and above them
//! contradict. What stands on the ground covers it there, and outnumbers them.
//!
//! # Cost
//! 25 points for each that is this near to the ground.

use super::{LEAST_CONFIDENCE, ground_tolerance_q6};
use crate::result::Point;
use crate::support::{Grid, SUPPORT_PITCH, Support};
use crate::units::Confidence;

/// Distance in front of the ground plane from which a point is no part of it, 1/64 px.
const CLEAR_Q6: i32 = 128;
/// Distance of the points that count, px: two columns to both sides, two rows upward.
const REACH: i32 = 20;
/// Largest probability of a point that is outnumbered: 0.6. `docs/experiments.md` says what chose
/// the three, and what others do.
const OUTNUMBERED: Confidence = Confidence::from_bits(0x9999);

/// Probability of a support point for directions.
#[inline(never)] // in each place that asks for points of obstacles
pub(crate) fn beside_ground(point: &Point, support: &Support<'_>) -> Confidence {
    let Some(plane) = support.plane else { return point.confidence };
    let (own_x, own_y) = (i32::from(point.x), i32::from(point.y));
    let own_q6 = i32::from(point.disparity.to_bits());
    let above_q6 = own_q6 - plane.at_q6(own_x, own_y);
    let is_ground = |above_q6: i32, d_q6: i32| above_q6 <= ground_tolerance_q6(d_q6);
    if is_ground(above_q6, own_q6) || above_q6 >= CLEAR_Q6 {
        return point.confidence;
    }
    // Points on the ground or behind it less those before it.
    let grid = support.grid;
    let columns = grid.columns_within(own_x - REACH, own_x + REACH);
    let mut more = 0;
    for row in grid.rows_within(own_y - REACH, own_y + i32::from(SUPPORT_PITCH / 2)) {
        for column in columns.clone() {
            let Some(other) = support.points.get(row * grid.columns + column) else { continue };
            if other.confidence() >= LEAST_CONFIDENCE {
                let d_q6 = i32::from(other.disparity_q6);
                let above_q6 = d_q6 - plane.at_q6(grid.x(column), Grid::y(row));
                more += if is_ground(above_q6, d_q6) { 1 } else { -1 };
            }
        }
    }
    if more > 0 { point.confidence.min(OUTNUMBERED) } else { point.confidence }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ground::GroundPlane;
    use crate::image::Dims;
    use crate::params::Params;
    use crate::result::Source;
    use crate::support::SupportPoint;
    use crate::units::Disparity;

    const DIMS: Dims = Dims { width: 40, height: 40 };
    const GROUND_Q6: i16 = 640;

    /// Probability of the middle one of 25 points, of which the first so many, row by row, lie as
    /// far before the ground as it does, and the others on it.
    fn told(above_q6: i16, alike: usize) -> u16 {
        let credible = Confidence::from_bits(60_000);
        let d_q6 = GROUND_Q6 + above_q6;
        let points: [SupportPoint; 25] = core::array::from_fn(|index| {
            let is_alike = index < alike || index == 12;
            SupportPoint::matched(if is_alike { d_q6 } else { GROUND_Q6 }, credible.to_bits())
        });
        let plane =
            GroundPlane { down_q16: 0, across_q16: 0, origin_q16: i32::from(GROUND_Q6) << 10 };
        let support = Support::new(&Params::default(), DIMS, &points, 0).with_plane(Some(plane));
        let (disparity, confidence) = (Disparity::from_bits(d_q6), credible);
        let point = Point { x: 20, y: 20, disparity, confidence, source: Source::Support };
        beside_ground(&point, &support).to_bits()
    }

    #[test]
    fn a_point_just_before_the_ground_is_doubtful_among_points_on_it() {
        let doubtful = OUTNUMBERED.to_bits();
        assert_eq!([49, 127].map(|above_q6| told(above_q6, 0)), [doubtful; 2]);
        assert_eq!([-100, 0, 48, 128].map(|above_q6| told(above_q6, 0)), [60_000; 4]);
        assert_eq!([5, 6, 7].map(|alike| told(100, alike)), [doubtful, doubtful, 60_000]);
    }
}
