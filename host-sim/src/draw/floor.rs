//! Colours of what lies on the ground plane, and of what lies below it: a drop-off. What stands
//! above it has the colour of its disparity.

use linestereo::ground::GroundPlane;
use linestereo::obstacles::{BELOW_GROUND, ground_tolerance};
use linestereo::results::{ImagePosition, Match, Point};
use linestereo::units::Disparity;

/// Of the floor: pale, of no disparity.
pub(super) const FLOOR: [u8; 3] = [222, 214, 190];
/// Of what lies below it: a warning.
pub(super) const DROP: [u8; 3] = [255, 0, 220];

/// Colour of a point; `None` above the plane, between the floor and a drop-off, and without a
/// plane.
pub(super) fn of_point(plane: Option<GroundPlane>, point: &Point) -> Option<[u8; 3]> {
    of(plane?, &[(point.position(), point.disparity)])
}

/// Colour of a segment: of the floor, or below it, with both ends.
pub(super) fn of_segment(plane: Option<GroundPlane>, found: &Match) -> Option<[u8; 3]> {
    let [from, to] = found.ends;
    of(plane?, &[(from, found.disparity[0]), (to, found.disparity[1])])
}

fn of(plane: GroundPlane, places: &[(ImagePosition, Disparity)]) -> Option<[u8; 3]> {
    let above = |(at, disparity): &(ImagePosition, Disparity)| {
        let [x, y] = [at.x, at.y].map(|value| value.to_num::<i32>());
        i32::from(disparity.to_bits()) - plane.at_q6(x, y)
    };
    let limits = |&(_, disparity): &(_, Disparity)| {
        let [far, near] = [Disparity::ZERO, disparity].map(ground_tolerance);
        -i32::from(far.to_bits())..=near.to_bits().into()
    };
    let least = i32::from(BELOW_GROUND.to_bits());
    if places.iter().all(|place| limits(place).contains(&above(place))) {
        Some(FLOOR)
    } else if places.iter().all(|place| above(place) <= -least) {
        Some(DROP)
    } else {
        None
    }
}
