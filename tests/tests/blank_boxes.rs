//! Blank boxes on a textured floor: paths carry the ground plane across their sides, which must
//! make no direction free and give no object its depth.

use crate::drop_offs::seen;
use linestereo::obstacles::{ObstacleParams, Sector};
use linestereo::{Dims, Params, Region};
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_sim::results::mask::Mask;
use linestereo_sim::scene::{self, Pair, Pattern, Rendering, Scene, Sensor, Surface, Texture};
use linestereo_tests::drawn::Random;
use linestereo_tests::matched;

const DIMS: Dims = Dims { width: 320, height: 240 };
/// Height of the cameras above the floor, m. They look ahead.
const HEIGHT: f64 = 0.3;
/// Label of the box.
const BOX: u8 = 1;

/// A box ahead, m.
#[derive(Clone, Copy, Debug)]
struct Blank {
    distance: f64,
    width: f64,
    height: f64,
    grey: f64,
}

/// Boxes that block the way, 13 px high and more: 12 to 22 cm, 1 to 2 m ahead. Support points are 8
/// px apart.
fn boxes(count: usize) -> Vec<Blank> {
    let mut random = Random(23);
    let mut between = |low: f64, high: f64| random.uniform(low, high);
    let mut one = || Blank {
        distance: between(1.0, 2.0),
        width: between(0.6, 1.2),
        height: between(0.12, 0.22),
        grey: between(60.0, 220.0),
    };
    (0..count).map(|_| one()).collect()
}

/// A floor with fine grain up to a wall, and the box on it, if there is one.
fn drawn(blank: Option<Blank>, seed: u64) -> (Engine, FrameResult, Rendering) {
    let pair = Pair::centred(DIMS, 220.0, 0.08);
    let rough = |seed, size| Texture::grained(Pattern::Blank(120.0), 60.0, size, seed);
    let (right, down, ahead) = ([8.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 6.0]);
    let mut surfaces = vec![
        Surface::rectangle([-4.0, HEIGHT, 0.3], right, ahead, rough(seed, 0.02), 2),
        Surface::rectangle([-4.0, HEIGHT - 3.0, 6.0], right, down, rough(seed + 1, 0.1), 3),
    ];
    if let Some(Blank { distance, width, height, grey }) = blank {
        let texture = Texture::grained(Pattern::Blank(grey), 1.0, 0.05, seed + 2);
        let centre = [0.0, HEIGHT - 0.5 * height, distance + 0.15];
        let edges = [[width, 0.0, 0.0], [0.0, height, 0.0], [0.0, 0.0, 0.3]];
        surfaces.extend(Surface::cuboid(centre, edges, [texture; 3], BOX));
    }
    let scene = Scene { pair, surfaces, objects: vec!["box", "floor", "wall"] };
    let sensor = Sensor { noise: 1.5, seed, ..Sensor::default() };
    let drawn = scene::render(&scene, DIMS, &sensor);
    let params = Params { max_disparity: 48, rig: pair.rig().ok(), ..Params::default() };
    let (engine, result) = matched(&params, [&drawn.left, &drawn.right]);
    (engine, result, drawn)
}

/// The direction ahead, within 3 m and from 5 cm above the floor on.
fn ahead(engine: &Engine, result: &FrameResult) -> Sector {
    let above = |height: f64| (height - HEIGHT) as f32;
    let wanted = ObstacleParams {
        range_m: 3.0,
        heights_m: [above(0.05), above(0.6)],
        ..ObstacleParams::DEFAULT
    };
    let plan = wanted.plan(engine.matcher.params(), DIMS).unwrap().on_ground(result.ground);
    seen(&plan, result).sector(&plan, 0, 0)
}

#[test]
fn the_way_is_not_free_through_a_blank_box() {
    let is_free = |blank, seed| {
        let (engine, result, _) = drawn(blank, seed);
        assert!(result.ground.is_some());
        matches!(ahead(&engine, &result), Sector::Free { .. })
    };
    let boxes = boxes(20);
    let through: Vec<_> =
        boxes.iter().zip(0..).filter(|&(&blank, seed)| is_free(Some(blank), seed)).collect();
    let without = (0..20).filter(|&seed| is_free(None, seed)).count();
    eprintln!("free: {} of 20 with a box, {without} of 20 without", through.len());
    assert!(through.is_empty(), "{through:?}");
    assert!(without >= 10, "{without} of 20");
}

#[test]
fn a_blank_box_has_no_depth_of_the_floor() {
    let (mut answered, mut wrong) = (0, Vec::new());
    for (blank, seed) in boxes(20).into_iter().zip(0..) {
        let (mut engine, _, drawn) = drawn(Some(blank), seed);
        let mask = Mask::new(DIMS, drawn.labels.iter().map(|&label| label == BOX).collect());
        let runs = mask.runs(1);
        let Ok(found) = engine.object(&Region::masked(1, &runs, DIMS).unwrap()) else { continue };
        answered += 1;
        let pixels = drawn.labels.iter().zip(&drawn.disparity).filter(|(label, _)| **label == BOX);
        let [least, most] =
            pixels.fold([f32::MAX, 0.0], |[least, most], (_, &d)| [least.min(d), most.max(d)]);
        let d = found.disparity.to_num::<f32>();
        if d < least - 1.0 || d > most + 1.0 {
            wrong.push((blank, d, least, most));
        }
    }
    eprintln!("{answered} of 20 boxes answered, {} wrong", wrong.len());
    assert!(wrong.is_empty(), "{wrong:?}");
}
