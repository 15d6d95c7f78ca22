//! The end of the search: walls nearer than the disparities that are searched, and walls whose
//! match lies left of the right image. The right match is not among those compared, so the best of
//! them is wrong.
//!
//! An answer claims a probability of 0.9 at least. Chance may pass for a match once where a hundred
//! are found on a wall that can be matched; the last disparity that is compared never does.

use linestereo::{Dims, Params};
use linestereo_frames::GrayImage;
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_tests::drawn::surface;
use linestereo_tests::run;

const DIMS: Dims = Dims { width: 320, height: 240 };
/// End of the disparities searched, px.
const RANGE: u16 = 32;
/// Most that an answer may be off, px.
const RIGHT: f64 = 1.0;

/// A surface of disparity `top` in row 0, which changes by `down` px per row.
#[derive(Clone, Copy, Debug)]
struct Wall {
    top: f64,
    down: f64,
}

impl Wall {
    const fn upright(disparity: f64) -> Self {
        Self { top: disparity, down: 0.0 }
    }

    fn disparity(self, y: f64) -> f64 {
        self.top + self.down * y
    }

    fn draw(self, seed: u64) -> [GrayImage; 2] {
        surface(DIMS, seed, |y| self.disparity(y), 0.0)
    }

    /// True where the match of a pixel lies left of the right image.
    fn is_cut_off(self, x: u16, y: u16) -> bool {
        f64::from(x) < self.disparity(y.into())
    }

    fn is_wrong(self, disparity: f64, y: f64) -> bool {
        (disparity - self.disparity(y)).abs() > RIGHT
    }
}

fn engine() -> Engine {
    Engine::new(&Params { max_disparity: RANGE, ..Params::default() }, DIMS).unwrap()
}

/// Every sixth pixel of every sixth row.
fn pixels() -> impl Iterator<Item = (u16, u16)> {
    let every = |end: u16| (2..end).step_by(6);
    every(DIMS.height).flat_map(move |y| every(DIMS.width).map(move |x| (x, y)))
}

/// Disparities told of the ends of matched segments.
fn ends(result: &FrameResult) -> impl Iterator<Item = f64> {
    result.matches.iter().flat_map(|found| found.disparity).map(|told| told.to_num::<f64>())
}

/// Disparities from here on belong to the last one that is compared, px.
fn last() -> f64 {
    Params::largest_disparity(RANGE).to_num()
}

#[test]
fn the_largest_disparity_is_where_answers_end() {
    for seed in 1..=3 {
        let found = |disparity| run(&mut engine(), Wall::upright(disparity).draw(seed).each_ref());
        let near = found(last() - 0.3);
        assert!(near.points.len() > 10_000, "texture {seed}: {}", near.health);
        let nearer = found(last() + 0.3);
        assert!(nearer.points.is_empty(), "texture {seed}: {}", nearer.points.len());
    }
    let searched =
        [8, 64, 256, u16::MAX].map(|range| Params::largest_disparity(range).to_num::<f64>());
    assert_eq!(searched, [6.5, 62.5, 254.5, 254.5]);
}

#[test]
fn a_wall_nearer_than_the_range_is_not_matched_at_its_end() {
    let (mut points, mut possible, mut answered, mut asked) = (0, 0, 0, 0);
    for seed in 1..=3 {
        let within = run(&mut engine(), Wall::upright(20.0).draw(seed).each_ref());
        assert!(within.points.len() > 10_000, "{}", within.health);
        for disparity in [33.0, 36.0, 40.0, 48.0, 60.0] {
            let what = format!("texture {seed} at {disparity} px");
            let pair = Wall::upright(disparity).draw(seed);
            // A user is answered nothing at all.
            let mut used = engine();
            let result = run(&mut used, pair.each_ref());
            assert!(!result.health.of_pair().is_fit(), "{what}: {}", result.health);
            assert!(result.matches.is_empty() && result.points.is_empty(), "{what}");
            assert!(pixels().all(|pixel| used.depth_at(pixel).is_err()), "{what}");
            // Nor would the matches be any without the check of the pair.
            let mut alone = engine().answering_unfit();
            let result = run(&mut alone, pair.each_ref());
            assert!(ends(&result).all(|told| told < last()), "{what}: {:?}", result.matches);
            for point in &result.points {
                assert!(point.disparity.to_num::<f64>() < last(), "{what}: {point:?}");
            }
            for pixel in pixels() {
                let found = alone.depth_at(pixel);
                let is_last = found.is_ok_and(|found| found.disparity.to_num::<f64>() >= last());
                assert!(!is_last, "{what}, {pixel:?}: {found:?}");
                (answered, asked) = (answered + usize::from(found.is_ok()), asked + 1);
            }
            points += result.points.len();
            possible += within.points.len();
        }
    }
    assert!(points * 100 <= possible, "{points} points, {possible} within the range");
    assert!(answered * 100 <= asked, "{answered} of {asked} pixels");
}

#[test]
fn a_wall_whose_match_is_left_of_the_right_image_is_not_matched_elsewhere() {
    let floor = Wall { top: 4.0, down: 0.1 };
    let (mut wrong_points, mut possible) = (0, 0.0);
    let (mut wrong_pixels, mut asked) = (0, 0);
    let (mut wrong_segments, mut segments) = (0, 0);
    for seed in 1..=4 {
        for wall in [Wall::upright(20.0), Wall::upright(28.0), Wall::upright(30.0), floor] {
            let mut engine = engine();
            let result = run(&mut engine, wall.draw(seed).each_ref());
            assert!(result.health.of_pair().is_fit(), "{wall:?}: {}", result.health);
            let is_wrong = |told: f64, y: u16| usize::from(wall.is_wrong(told, y.into()));
            let mut seen = 0;
            for point in &result.points {
                if wall.is_cut_off(point.x, point.y) {
                    wrong_points += is_wrong(point.disparity.to_num(), point.y);
                } else {
                    seen += 1;
                }
            }
            // Points that as many pixels of the rest hold.
            let area = |is_cut_off: bool| {
                let columns = |y: u16| (0..DIMS.width).map(move |x| (x, y));
                let all = (0..DIMS.height).flat_map(columns);
                all.filter(|&(x, y)| wall.is_cut_off(x, y) == is_cut_off).count() as f64
            };
            possible += f64::from(seen) * area(true) / area(false);
            for (x, y) in pixels().filter(|&(x, y)| wall.is_cut_off(x, y)) {
                let found = engine.depth_at((x, y));
                asked += 1;
                wrong_pixels += found.map_or(0, |found| is_wrong(found.disparity.to_num(), y));
            }
            segments += result.matches.len();
            for found in &result.matches {
                let mut ends = found.disparity.iter().zip(found.ends);
                let is_off = ends.any(|(told, end)| wall.is_wrong(told.to_num(), end.y.to_num()));
                wrong_segments += usize::from(is_off);
            }
        }
    }
    let told = format!(
        "wrong: {wrong_points} points, {possible:.0} possible; {wrong_pixels} of {asked} pixels; \
         {wrong_segments} of {segments} segments"
    );
    assert!(wrong_points as f64 * 100.0 <= possible, "{told}");
    assert!(wrong_pixels * 100 <= asked, "{told}");
    assert!(wrong_segments * 100 <= segments, "{told}");
}
