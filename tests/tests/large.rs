//! Images that are matched at half of their size first: their points are true at full size.

use crate::slopes::Texture;
use linestereo::{Dims, Params, results::Source};
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_tests::drawn::painted;

const DIMS: Dims = Dims { width: 640, height: 240 };
/// Rows of the wall, above a floor.
const WALL: f64 = 110.0;

/// A wall at 21.3 px, and a floor that comes nearer by 0.45 px per row.
fn disparity(y: f64) -> f64 {
    21.3 + 0.45 * (y - WALL).max(0.0)
}

fn run(seed: u64) -> FrameResult {
    let texture = Texture::new(seed);
    let paint = |shift: &dyn Fn(f64) -> f64| {
        painted(DIMS.width, DIMS.height, |x, y| {
            let y = f64::from(y);
            texture.at(f64::from(x) + shift(y), y).round() as u8
        })
    };
    let (left, right) = (paint(&|_| 0.0), paint(&disparity));
    let params = Params { max_disparity: 128, ..Params::default() };
    let mut engine = Engine::new(&params, DIMS).unwrap();
    engine.run(left.view().unwrap(), right.view().unwrap()).unwrap()
}

#[test]
fn points_of_a_wall_and_of_a_floor_are_true() {
    for seed in [11, 12] {
        let result = run(seed);
        assert!(result.ground.is_some());
        let of = |is_floor: bool| {
            let points = result.points.iter().filter(|point| point.source == Source::Support);
            let points = points.filter(|point| (f64::from(point.y) > WALL + 8.0) == is_floor);
            let errors = points
                .map(|point| (point.disparity.to_num::<f64>() - disparity(point.y.into())).abs());
            let mut errors: Vec<f64> = errors.collect();
            errors.sort_by(f64::total_cmp);
            let wrong = errors.iter().filter(|&&error| error > 1.0).count();
            (errors.len(), errors[errors.len() / 2], wrong)
        };
        for is_floor in [false, true] {
            let (points, median, wrong) = of(is_floor);
            println!(
                "floor {is_floor}: {points} points, median error {median:.3} px, {wrong} off by \
                 more than 1 px"
            );
            assert!(
                points > 500 && median < 0.1 && wrong * 50 <= points,
                "{points}, {median}, {wrong}"
            );
        }
    }
}
