//! Pairs that are not fit to be used, and what they answer: nothing. Exchanged images, and support
//! points alone.

use crate::bars;
use crate::ground::Floor;
use linestereo::objects::Reason;
use linestereo::params::Parts;
use linestereo::results::{PixelRejection, Source};
use linestereo::{Area, Capacity, Dims, Matcher, Options, Params, Region, health::HealthFlags};
use linestereo_frames::{GrayImage, Perturbation};
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_sim::results::health::{refusal, summary};
use linestereo_sim::scene::{Kind, Rendering, Sensor};
use linestereo_tests::drawn::{rendered, rendered_by};
use linestereo_tests::{captured, matched, run};

const DIMS: Dims = Dims { width: 320, height: 240 };

/// The image from right to left, and from below to above.
fn flipped(image: &GrayImage, is_upright: bool) -> GrayImage {
    let mut pixels = image.pixels.clone();
    if is_upright {
        pixels.chunks_mut(image.dims.width.into()).for_each(<[u8]>::reverse)
    } else {
        pixels.reverse()
    }
    GrayImage { dims: image.dims, pixels }
}

/// The pair with its images exchanged, both mirrored, and both upside down.
fn exchanged(left: &GrayImage, right: &GrayImage) -> [[GrayImage; 2]; 3] {
    let turned = |is_upright| [left, right].map(|image| flipped(image, is_upright));
    [[right.clone(), left.clone()], turned(true), turned(false)]
}

#[test]
fn exchanged_images_are_named_with_what_matches_when_they_change_places() {
    for kind in [Kind::Boxes, Kind::Cards, Kind::Demo, Kind::Corridor] {
        let pair = rendered(kind, DIMS, 1.5, 4);
        let params = Params { max_disparity: 64, ..Params::default() };
        let (mut engine, healthy) = matched(&params, [&pair.left, &pair.right]);
        assert_eq!(healthy.exchanged, None, "{kind:?}");
        for pair in exchanged(&pair.left, &pair.right) {
            let result = run(&mut engine, pair.each_ref());
            let [matched, segments] =
                result.exchanged.unwrap_or_else(|| panic!("{kind:?}: {:?}", result.counts));
            assert!(
                result.health.of_pair().contains(HealthFlags::FEW_MATCHES),
                "{kind:?}: {}",
                result.health
            );
            assert!(result.matches.is_empty() && result.points.is_empty(), "{kind:?}");
            let text = summary(&result);
            let said = format!("exchange them, then {matched} of {segments} segments match\n");
            assert!(text.contains(&said), "{kind:?}: {text}");
            let refusal = refusal(&result).unwrap();
            assert!(refusal.ends_with(said.trim_end()), "{kind:?}: {refusal}");
        }
    }
}

/// Pairs that are not what the rig saw match as many segments as chance has it, also where texture
/// repeats.
#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn captured_pairs_that_are_exchanged_or_mirrored_have_few_matches() {
    let Some(scenes) = captured::qvga() else { return };
    for scene in &scenes {
        let params = Params { max_disparity: scene.max_disparity, ..Params::default() };
        for pair in exchanged(&scene.left, &scene.right) {
            let (_, result) = matched(&params, pair.each_ref());
            let [matched, segments] = result.exchanged.unwrap_or_else(|| panic!("{}", scene.name));
            assert!(3 * matched > segments, "{}: {matched} of {segments}", scene.name);
            assert!(result.matches.is_empty() && result.points.is_empty(), "{}", scene.name);
        }
    }
}

/// Has neither segments nor points, bars or a ground plane.
fn is_empty(result: &FrameResult) -> bool {
    result.matches.is_empty()
        && result.points.is_empty()
        && result.obstacle_points.is_empty()
        && result.bars.is_empty()
        && result.ground.is_none()
}

/// One gate for all that answers.
#[test]
fn a_pair_that_is_not_fit_answers_nothing() {
    let pair = rendered(Kind::Boxes, DIMS, 1.0, 9);
    let mut engine = Engine::new(&Params { max_disparity: 64, ..Params::default() }, DIMS).unwrap();
    let (left, right) = (pair.left.view().unwrap(), pair.right.view().unwrap());
    let region =
        Region::boxed(3, Area { left: 60, top: 60, right: 260, bottom: 200 }, DIMS).unwrap();
    let healthy = engine.run(left, right).unwrap();
    let pixel = healthy
        .points
        .iter()
        .map(|point| (point.x, point.y))
        .find(|&at| engine.depth_at(at).is_ok());
    assert!(!healthy.matches.is_empty() && !healthy.obstacle_points.is_empty());
    assert!(pixel.is_some());
    // One camera delivered twice: everything matches.
    let result = engine.run(left, left).unwrap();
    assert!(result.health.of_pair().contains(HealthFlags::NO_PARALLAX), "{}", result.health);
    assert!(is_empty(&result));
    assert_eq!(engine.depth_at(pixel.unwrap()), Err(PixelRejection::UnhealthyPair));
    let found = engine.object(&region).map_err(|why| why.reason);
    assert_eq!(found, Err(Reason::UnhealthyPair));
    assert_eq!(engine.ask(|matched| matched.points().next()), None);
    let matched = engine.matched();
    assert!(matched.segments().is_empty() && matched.support_points().next().is_none());
    assert!(!matched.findings().matches.is_empty(), "what explains it stays");
    // A fault that the caller knows of.
    engine.run(left, right).unwrap();
    assert!(!engine.matched().segments().is_empty());
    engine.ask(|matched| matched.add_faults(HealthFlags::LEFT_FROZEN));
    let matched = engine.matched();
    assert!(
        matched.segments().is_empty() && matched.health().now.contains(HealthFlags::LEFT_FROZEN)
    );
}

/// A pair that repeats is matched like the one before it: only the gate keeps its results back.
#[test]
fn a_frozen_pair_has_neither_bars_nor_ground_nor_points_of_obstacles() {
    let poles = bars::pair(&[(150, 5, 24)], 2);
    let floor = Floor { down: 0.4, across: 0.0 }.draw(5);
    let range = Params::DEFAULT.max_disparity;
    for (name, [left, right], max_disparity) in [("poles", poles, range), ("floor", floor, 144)] {
        let mut engine = Engine::new(&Params { max_disparity, ..Params::default() }, DIMS).unwrap();
        let (left, right) = (left.view().unwrap(), right.view().unwrap());
        let healthy = engine.run(left, right).unwrap();
        let is_found =
            if name == "poles" { !healthy.bars.is_empty() } else { healthy.ground.is_some() };
        assert!(is_found && !healthy.obstacle_points.is_empty(), "{name}: {}", healthy.health);
        let frozen = engine.run_next((left, right), None, &mut ()).unwrap();
        let flags = frozen.health.of_pair();
        assert!(flags.contains(HealthFlags::LEFT_FROZEN | HealthFlags::RIGHT_FROZEN), "{flags}");
        assert!(is_empty(&frozen), "{name}: {flags}");
        assert!(!engine.matched().findings().matches.is_empty(), "{name}: it is matched");
    }
}

/// Support points alone say nothing about rows: a pair now and then is matched with segments for
/// that.
#[test]
fn support_points_alone_are_matched_at_the_rows_of_the_pair() {
    let pair = |row_offset: f64, seed: u64| {
        let sensor = Sensor { noise: 1.5, seed, row_offset, ..Sensor::default() };
        rendered_by(Kind::Boxes, DIMS, 5, &sensor)
    };
    let params = |parts| Params { max_disparity: 64, parts, ..Params::default() };
    let areas = [Area { left: 60, top: 60, right: 200, bottom: 180 }];
    let mut matcher = Matcher::new(params(Parts::Support), DIMS).unwrap();
    let mut memory = Box::new(<linestereo::Memory<{ Capacity::new(DIMS).words() }>>::new());
    let mut see = |matcher: &mut Matcher, pair: &Rendering, areas: Option<&[Area]>| {
        let (left, right) = (pair.left.view().unwrap(), pair.right.view().unwrap());
        let options = Options { areas, ..Options::default() };
        let matched = matcher.run_with(&mut memory, left, right, options).unwrap();
        (matched.row_offset_q5(), matched.support_points().count(), matched.health().flags)
    };
    let (rows_q5, points, flags) = see(&mut matcher, &pair(1.2, 1), None);
    assert!((rows_q5 - 38).abs() <= 8 && points > 400, "{rows_q5}, {points} points");
    assert!(flags.contains(HealthFlags::ROWS_OFF), "{flags}");
    let [whole, part] = [2, 3].map(|seed| pair(1.2, seed));
    for _ in 0..3 {
        assert_eq!(see(&mut matcher, &whole, None).0, rows_q5);
        assert_eq!(see(&mut matcher, &part, Some(&areas)).0, rows_q5);
    }
    matcher.set_params(params(Parts::Both), DIMS).unwrap();
    assert_eq!(
        see(&mut matcher, &pair(1.2, 5), Some(&areas)).0,
        rows_q5,
        "parts of a pair with segments"
    );
    // Where edges are too faint to say it, it stays as well.
    let faint = Perturbation { gain: 0.06, ..Perturbation::NONE };
    let (left, right) = faint.apply(&whole.left, &whole.right);
    let faint = Rendering { left, right, ..pair(1.2, 2) };
    assert_eq!(see(&mut Matcher::new(params(Parts::Both), DIMS).unwrap(), &faint, None).0, 0);
    assert_eq!(see(&mut matcher, &faint, None).0, rows_q5, "faint edges");
    // Known from pairs with segments, it holds for points alone.
    let mut matcher = Matcher::new(params(Parts::Both), DIMS).unwrap();
    assert!((see(&mut matcher, &pair(-1.2, 6), None).0 + 38).abs() <= 8);
    matcher.set_params(params(Parts::Support), DIMS).unwrap();
    assert!((see(&mut matcher, &pair(-1.2, 7), None).0 + 38).abs() <= 8);
    let smaller = Dims { width: 160, height: 120 };
    matcher.set_params(params(Parts::Support), smaller).unwrap();
    assert!(!matcher.knows_rows(), "of images of another size");
    // Images of two scenes, and how long that is held against the pairs after them.
    let mut matcher = Matcher::new(params(Parts::Support), DIMS).unwrap();
    let other = rendered(Kind::Boxes, DIMS, 1.5, 8);
    let wrong = Rendering { right: other.right, ..pair(0.0, 8) };
    assert!(see(&mut matcher, &wrong, None).2.contains(HealthFlags::FEW_MATCHES));
    assert!(!matcher.knows_rows(), "of a pair that is not fit none is kept");
    let in_turn = [20, 21].map(|seed| pair(0.0, seed));
    let fit = (0..40).position(|number| see(&mut matcher, &in_turn[number % 2], None).2.is_fit());
    assert_eq!(fit, Some(23), "three checks, eight pairs apart");
    // An area without edges says nothing of rows, and does not keep others from saying it.
    let mut matcher = Matcher::new(params(Parts::Support), DIMS).unwrap();
    assert_eq!(see(&mut matcher, &whole, Some(&[])).0, 0);
    assert!(!matcher.knows_rows());
    let rows = (0..8).map(|_| see(&mut matcher, &whole, Some(&areas)).0).last();
    assert!(rows.is_some_and(|rows_q5| (rows_q5 - 38).abs() <= 8), "{rows:?}");
    // Rows that are far apart in one pair alone are not held against many others.
    let mut matcher = Matcher::new(params(Parts::Support), DIMS).unwrap();
    let far = pair(2.0, 24);
    let flags: Vec<_> = (0..20)
        .map(|number| match number {
            3 => see(&mut matcher, &far, None).2,
            _ => see(&mut matcher, &in_turn[number % 2], None).2,
        })
        .collect();
    let unfit = flags.iter().filter(|flags| !flags.is_fit()).count();
    assert!(!flags[3].is_fit() && (1..=4).contains(&unfit), "{flags:?}");
    // Where they are so far apart that points match little, the next pair is a check.
    let mut matcher = Matcher::new(params(Parts::Support), DIMS).unwrap();
    let farther = [25, 26].map(|seed| pair(5.0, seed));
    let fit: Vec<_> = (0..6)
        .map(|number| match number {
            ..3 => see(&mut matcher, &in_turn[number % 2], None).2.is_fit(),
            _ => see(&mut matcher, &farther[number % 2], None).2.is_fit(),
        })
        .collect();
    assert_eq!(fit, [true, true, true, true, false, false]);
}

/// A check of points alone adds nothing to them.
#[test]
fn support_points_alone_have_no_bars() {
    let [left, right] = bars::pair(&[(150, 5, 24)], 2);
    let params = Params { parts: Parts::Support, ..Params::default() };
    let mut matcher = Matcher::new(params, DIMS).unwrap();
    let mut memory = Box::new(<linestereo::Memory<{ Capacity::new(DIMS).words() }>>::new());
    for number in 0..3 {
        let (left, right) = (left.view().unwrap(), right.view().unwrap());
        let mut matched = matcher.run(&mut memory, left, right).unwrap();
        assert!(matched.points().all(|point| point.source == Source::Support), "{number}");
        assert_eq!(matched.bars().len(), 0, "{number}");
    }
}

/// Half of a short range is still one that points can be matched in.
#[test]
fn large_images_with_a_short_range_have_support_points() {
    const LARGE: Dims = Dims { width: 640, height: 480 };
    let scene = rendered(Kind::Corridor, LARGE, 1.5, 3);
    let (left, right) = (scene.left.view().unwrap(), scene.right.view().unwrap());
    let mut memory = Box::new(<linestereo::Memory<{ Capacity::new(LARGE).words() }>>::new());
    for max_disparity in [8, 14, 15] {
        let params = Params { max_disparity, ..Params::default() };
        let mut matcher = Matcher::new(params, LARGE).unwrap();
        let matched = matcher.run(&mut memory, left, right).unwrap();
        let count = matched.support().iter().filter(|(_, point)| point.is_matched()).count();
        assert!(count > 500, "{max_disparity}: {count}");
    }
}
