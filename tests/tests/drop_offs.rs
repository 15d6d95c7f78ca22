//! Drop-offs by direction: the rules on single points, drawn floors that end, and a drive towards
//! an edge.

use crate::obstacles::{point, seen_of_points};
use linestereo::obstacles::{DropOff, ObstacleParams, ObstaclePlan, Obstacles, Sector};
use linestereo::results::{Point, Source};
use linestereo::units::{Confidence, Disparity};
use linestereo::{Dims, Params, Rig, ground::GroundPlane, health::HealthFlags};
use linestereo_frames::GrayImage;
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_tests::drawn::surface;
use linestereo_tests::{captured, run};

const DIMS: Dims = Dims { width: 320, height: 240 };
const FOCAL: f64 = 300.0;
const BASELINE: f64 = 0.1;
/// Row of the horizon, px.
const HORIZON: f64 = 80.0;
/// Change of the floor's disparity down the rows, px: cameras 0.25 m above it.
const DOWN: f64 = 0.4;
const HEIGHT: f64 = BASELINE / DOWN;

fn params() -> Params {
    let rig = Rig::new(FOCAL as f32, BASELINE as f32, 0.0).unwrap();
    let rig = rig.with_principal_point([159.5, HORIZON as f32]).unwrap();
    Params { rig: Some(rig), max_disparity: 80, ..Params::default() }
}

fn floor() -> GroundPlane {
    let q16 = |value: f64| (value * 65536.0) as i32;
    GroundPlane { down_q16: q16(DOWN), across_q16: 0, origin_q16: q16(-DOWN * HORIZON) }
}

fn plan(drop_m: Option<f32>) -> ObstaclePlan {
    let wanted = ObstacleParams { drop_m, range_m: 5.0, ..ObstacleParams::DEFAULT };
    wanted.plan(&params(), DIMS).unwrap()
}

/// Points ahead at row 120, where the floor has 16 px.
fn ahead(count: u16, disparity: f64, confidence: f64) -> impl Iterator<Item = Point> {
    (0..count).map(move |n| point((150 + 8 * n, 120), disparity, confidence, Source::Support))
}

fn told(plan: &ObstaclePlan, points: impl Iterator<Item = Point>) -> Option<DropOff> {
    seen_of_points(plan, points).drop_off(plan, 0, 0)
}

#[test]
fn three_points_that_agree_below_the_floor_are_a_drop_off() {
    let at_5_cm = plan(Some(0.05)).on_ground(Some(floor()));

    // The ray meets the floor where the point's lower end is: 3 rows below it.
    let edge_cm = (100.0 * FOCAL * BASELINE / (DOWN * (123.0 - HORIZON))) as u16;
    let found = told(&at_5_cm, ahead(3, 10.0, 0.95)).unwrap();
    assert!(found.distance_cm.abs_diff(edge_cm) <= 1, "{found:?} not {edge_cm} cm");
    assert!(found.confidence >= Confidence::from_num(0.99));
    assert_eq!(told(&at_5_cm, ahead(2, 10.0, 0.99)), None, "neighbours are wrong together");
    assert_eq!(told(&at_5_cm, ahead(3, 10.0, 0.6)), None);
    assert_eq!(told(&at_5_cm, ahead(3, 14.2, 0.95)), None, "less than 2 px below the floor");

    // A step of 4 cm: 0.25 m * 16 / (0.25 + 0.04).
    let step = DOWN * (120.0 - HORIZON) * HEIGHT / (HEIGHT + 0.04);
    assert_eq!(told(&at_5_cm, ahead(3, step, 0.95)), None);
    let at_3_cm = plan(Some(0.03)).on_ground(Some(floor()));
    assert!(told(&at_3_cm, ahead(3, step, 0.95)).is_some());

    let flying = plan(None).on_ground(Some(floor()));
    assert_eq!(told(&flying, ahead(3, 10.0, 0.95)), None);
    assert_eq!(told(&plan(Some(0.05)), ahead(3, 10.0, 0.95)), None, "without a floor");
    // Beyond the range of 5 m, where the floor has 6 px.
    let beyond = ahead(3, 2.0, 0.95).map(|point| Point { y: 90, ..point });
    assert_eq!(told(&at_5_cm, beyond), None);
}

#[test]
fn chance_tells_no_drop_off_where_the_right_image_ends() {
    let plan = plan(Some(0.05)).on_ground(Some(floor()));
    // In one sector: the floor's 16 px end in the right image, or left of it.
    let told_at = |columns: [u16; 3]| {
        let points = columns.map(|x| point((x, 120), 10.0, 0.95, Source::Support));
        seen_of_points(&plan, points.into_iter()).drop_off(&plan, 67, 0).is_some()
    };
    assert!(told_at([18, 25, 33]));
    assert!(!told_at([4, 9, 14]));
}

#[test]
fn what_is_lower_than_a_twentieth_of_the_cameras_height_is_the_floor() {
    let plan = plan(None).on_ground(Some(floor()));
    let is_obstacle = |y: u16, before: f64| {
        let disparity = Disparity::from_num(DOWN * (f64::from(y) - HORIZON) + before);
        let points = ahead(3, 0.0, 0.95).map(|point| Point { y, disparity, ..point });
        matches!(seen_of_points(&plan, points).sector(&plan, 0, 0), Sector::Obstacle { .. })
    };
    // The floor has 56 px, and 12.
    assert_eq!([2.5, 3.5].map(|before| is_obstacle(220, before)), [false, true]);
    assert_eq!([0.7, 0.8].map(|before| is_obstacle(110, before)), [false, true]);
}

/// Points of the floor down the rows, in three columns of the sector ahead.
fn of_floor() -> impl Iterator<Item = Point> {
    (84_u16..236).step_by(8).flat_map(|y| {
        let disparity = Disparity::from_num(DOWN * (f64::from(y) - HORIZON));
        ahead(3, 0.0, 0.95).map(move |point| Point { y, disparity, ..point })
    })
}

#[test]
fn a_sector_is_free_where_the_floor_is_seen_in_both_halves() {
    let plan = plan(Some(0.05)).on_ground(Some(floor()));
    for seen in [0..=158_u16, 159..=u16::MAX] {
        let half = of_floor().filter(move |point| seen.contains(&point.x));
        assert_eq!(seen_of_points(&plan, half).sector(&plan, 0, 0), Sector::Unknown);
    }
    assert!(matches!(seen_of_points(&plan, of_floor()).sector(&plan, 0, 0), Sector::Free { .. }));
}

#[test]
fn a_drop_off_is_kept_and_its_sector_not_free() {
    let plan = plan(Some(0.05)).on_ground(Some(floor()));
    let mut obstacles = seen_of_points(&plan, of_floor());
    assert!(matches!(obstacles.sector(&plan, 0, 0), Sector::Free { .. }));
    obstacles.update(&plan, &[], ahead(3, 10.0, 0.95), HealthFlags::GOOD, 0);
    assert_eq!(obstacles.sector(&plan, 0, 0), Sector::Unknown);
    // Seen whole again: what was nearer stays until it is too old.
    obstacles.update(&plan, &[], of_floor(), HealthFlags::GOOD, 100_000);
    assert_eq!(obstacles.drop_off(&plan, 0, 100_000).unwrap().age_ms, 100);
    assert_eq!(obstacles.drop_off(&plan, 0, 501_000), None);
    assert!(matches!(obstacles.sector(&plan, 0, 501_000), Sector::Free { .. }));
    assert_eq!(obstacles.drop_off(&plan, 36, 0), None, "outside of the view");
    assert_eq!(obstacles.drop_off(&plan, 255, 0), None);
}

/// A floor that ends at `edge_m`, and another one 0.3 m lower behind it. With one texture across
/// the edge it would be a torn image.
pub(crate) fn pair(edge_m: Option<f64>, seed: u64) -> [GrayImage; 2] {
    let floor = |seed: u64, height: f64| {
        let down = DOWN * HEIGHT / height;
        surface(DIMS, seed, |y| down * (y.max(HORIZON + 8.0) - HORIZON), 0.0)
    };
    let mut pair = floor(seed, HEIGHT);
    let Some(edge_m) = edge_m else { return pair };
    let edge_row = HORIZON + FOCAL * BASELINE / edge_m / DOWN;
    let behind = edge_row.ceil() as usize * usize::from(DIMS.width);
    for (image, lower) in pair.iter_mut().zip(floor(seed + 100, HEIGHT + 0.3)) {
        image.pixels[..behind].copy_from_slice(&lower.pixels[..behind]);
    }
    pair
}

/// Directions of a result.
pub(crate) fn seen(plan: &ObstaclePlan, result: &FrameResult) -> Obstacles {
    let mut obstacles = Obstacles::new();
    let points = result.obstacle_points.iter().copied();
    obstacles.update(plan, &result.matches, points, result.health.of_pair(), 0);
    obstacles
}

/// Middles of sectors whose edge is told within 10 % of `edge_m`, and of those where one is told
/// elsewhere, of [`pair`].
fn drawn(edge_m: Option<f64>, seed: u64) -> [u32; 2] {
    let mut engine = Engine::new(&params(), DIMS).unwrap();
    // Of two floors the larger one would be taken: an IMU or the pair before says which it is.
    engine.matcher.expect_ground(Some(floor()));
    let result = run(&mut engine, pair(edge_m, seed).each_ref());
    let plan = plan(Some(0.05)).on_ground(result.ground);
    let obstacles = seen(&plan, &result);
    let mut told = [0, 0];
    for offset in -3_i32..=3 {
        let Some(found) = obstacles.drop_off(&plan, offset.rem_euclid(72) as u8, 0) else {
            continue;
        };
        // The edge lies across the view.
        let expected_cm = edge_m.map(|m| 100.0 * m / (5.0 * f64::from(offset)).to_radians().cos());
        let is_right =
            expected_cm.is_some_and(|cm| (f64::from(found.distance_cm) - cm).abs() < 0.1 * cm);
        told[usize::from(!is_right)] += 1;
    }
    told
}

#[test]
fn drawn_floors_end_where_they_do() {
    for (edge_m, seed) in [(0.7, 3), (0.9, 4), (1.2, 5), (1.5, 6)] {
        let [right, wrong] = drawn(Some(edge_m), seed);
        assert!(right >= 6 && wrong == 0, "{edge_m} m: {right} right, {wrong} wrong");
    }
    for seed in 7..10 {
        assert_eq!(drawn(None, seed), [0, 0], "a floor without an end, seed {seed}");
    }
}

/// A rendered drive to a drop-off, without an IMU: the 0.4 m before the edge is the least
/// that a robot needs to stop.
#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn a_drive_is_told_of_the_edge_before_it() {
    let Some(drive) = captured::folder("robot_sequences/drop_off") else { return };
    let mut asked = 0;
    for frame in linestereo_frames::find_scenes(&drive).unwrap() {
        let text = std::fs::read_to_string(frame.join("scene.json")).unwrap();
        let ahead_m = serde_json::from_str::<serde_json::Value>(&text).unwrap()["drop_ahead_m"]
            .as_f64()
            .unwrap();
        let scene = linestereo_frames::load_scene(&frame, None).unwrap();
        let mut engine = captured::engine(&scene);
        let result = run(&mut engine, [&scene.left, &scene.right]);
        let params = Params { rig: scene.rig, ..Params::default() };
        let plan = ObstacleParams::DEFAULT.plan(&params, scene.left.dims).unwrap();
        let plan = plan.on_ground(result.ground);
        let told = seen(&plan, &result).drop_off(&plan, 0, 0);
        if (0.35..=0.6).contains(&ahead_m) {
            let told_m = told.map(|found| f64::from(found.distance_cm) / 100.0);
            let is_right = told_m.is_some_and(|told_m| (told_m - ahead_m).abs() < 0.1 * ahead_m);
            assert!(is_right, "{ahead_m} m before the edge: {told:?}");
            asked += 1;
        }
    }
    assert!(asked >= 5, "only {asked} frames near the edge");
}
