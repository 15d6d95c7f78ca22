//! Distance per direction, seen from above: the vehicle below, ahead is up.

use super::sheet::{GOOD, INK, Sheet};
use super::text::Align;
use crate::results::directions::{Direction, Directions};
use image::RgbImage;

const SIDE: u32 = 900;
const OBSTACLE: [u8; 3] = [255, 70, 60];
/// Where the floor ends.
const DROP_OFF: [u8; 3] = [190, 90, 255];
const UNKNOWN: [u8; 3] = [110, 110, 118];
/// Directions of a wedge's outline, per sector.
const STEPS: u8 = 8;
/// Where distances are written, as a share of the range: there they do not overlap.
const LABELS: f64 = 0.94;

/// The sectors in view as a fan: green is free, red is where an obstacle and what is behind it
/// stand, violet is where the floor has ended, grey is unknown.
pub fn fan(directions: &Directions) -> RgbImage {
    let mut sheet = Sheet::new([SIDE; 2]);
    let seen: Vec<Direction> =
        directions.list().into_iter().filter(|one| one.state != "outside").collect();
    let half = 0.5 * directions.width_deg();
    let widest = seen.iter().map(|one| one.direction_deg.abs()).fold(0.0, f64::max);
    let side = SIDE as f32;
    let (origin, reach) = if widest <= 90.0 {
        let aside = (widest + half).min(90.0).to_radians().sin() as f32;
        ((0.5 * side, 0.93 * side), (0.48 / aside).min(0.85) * side)
    } else {
        ((0.5 * side, 0.5 * side), 0.44 * side)
    };
    let place = |degrees: f64, share: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        (origin.0 + reach * (share * sine) as f32, origin.1 - reach * (share * cosine) as f32)
    };
    let range = directions.range_m();
    let mut labels = vec![(place(0.0, 1.03), format!("{range} m"))];
    for Direction { direction_deg, state, distance_m, drop_off_m, .. } in seen {
        let mut wedge = |from: f64, to: f64, rgb: [u8; 3], alpha: f32| {
            let angle =
                |step: u8| direction_deg + half * (2.0 * f64::from(step) / f64::from(STEPS) - 1.0);
            let arc = (0..=STEPS).map(|step| place(angle(step), from));
            let back = (0..=STEPS).rev().map(|step| place(angle(step), to));
            sheet.fill(&arc.chain(back).collect::<Vec<_>>(), rgb, alpha);
        };
        match distance_m {
            Some(metres) => {
                wedge(0.0, metres / range, UNKNOWN, 0.25);
                wedge(metres / range, 1.0, OBSTACLE, 0.3);
                wedge(metres / range, (metres / range + 0.012).min(1.0), OBSTACLE, 1.0);
                labels.push((place(direction_deg, LABELS), format!("{metres:.2}")));
            }
            None if state == "free" => wedge(0.0, 1.0, GOOD, 0.4),
            None => wedge(0.0, 1.0, UNKNOWN, 0.25),
        }
        // What lies behind an obstacle does not matter.
        if let Some(metres) = drop_off_m.filter(|&edge| distance_m.is_none_or(|near| edge < near)) {
            wedge(metres / range, (metres / range + 0.012).min(1.0), DROP_OFF, 1.0);
            wedge(metres / range, distance_m.map_or(1.0, |near| near / range), DROP_OFF, 0.3);
            if distance_m.is_none() {
                labels.push((place(direction_deg, LABELS), format!("{metres:.2}")));
            }
        }
    }
    for ((x, y), text) in labels {
        sheet.label((x, y - 8.0), Align::Centre, INK, text);
    }
    sheet.into_picture()
}
