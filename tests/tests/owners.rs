//! Surfaces that results are credited to, on the built-in room: the side of a segment, the depth of an object.

use linestereo::{Dims, Match, Params, Region};
use linestereo_sim::engine::Engine;
use linestereo_sim::evaluate::OwnedMiddle;
use linestereo_sim::input::Truth;
use linestereo_sim::results::outline::Mask;
use linestereo_sim::scene::{self, Kind, Rendering, Scene, Sensor};

const DIMS: Dims = Dims { width: 320, height: 240 };
/// Rooms that are tried; `linestereo demo --seed N` shows one.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=40;

/// The room of a seed, its truth and the core after it.
fn matched(seed: u64) -> (Scene, Rendering, Truth, Engine, Vec<Match>) {
    let room = scene::build(Kind::Demo, DIMS, seed);
    let pair = scene::render(&room, DIMS, &Sensor { noise: 1.0, seed, ..Sensor::default() });
    let truth = Truth::new(DIMS, pair.disparity.clone(), pair.visible.clone());
    let params =
        Params { max_disparity: scene::search_range(&pair), rig: Some(room.pair.rig().unwrap()), ..Params::default() };
    let mut engine = Engine::new(&params, DIMS).unwrap();
    let matches = engine.run(pair.left.view().unwrap(), pair.right.view().unwrap()).unwrap().matches;
    (room, pair, truth, engine, matches)
}

#[test]
fn the_most_probable_segment_of_each_object_has_its_depth() {
    let mut answers = 0;
    for seed in SEEDS {
        let (room, pair, truth, _, matches) = matched(seed);
        for (object, label) in room.objects.iter().zip(1_u8..) {
            let middles = matches.iter().map(OwnedMiddle::new);
            let Some(middle) = middles.into_iter().find(|middle| pair.label(middle.pixel) == Some(label)) else {
                continue;
            };
            let error = middle.error(&truth).unwrap();
            assert!(error.abs() <= 1.0, "seed {seed}, {object}: {error:+.2} px, {middle:?}");
            answers += 1;
        }
    }
    assert!(answers > 7 * SEEDS.count(), "{answers} answers prove little");
}

#[test]
fn masks_of_objects_have_their_depth() {
    let mut answers = 0;
    for seed in SEEDS {
        let (room, pair, _, mut engine, _) = matched(seed);
        for (object, label) in room.objects.iter().zip(1_u8..) {
            let exact = Mask::new(DIMS, pair.labels.iter().map(|&of| of == label).collect());
            let disparities =
                || pair.labels.iter().zip(&pair.disparity).filter(|(of, _)| **of == label).map(|(_, d)| *d);
            let (low, high) = (disparities().fold(f32::MAX, f32::min), disparities().fold(0.0, f32::max));
            for (outline, mask) in [("exact", exact.clone()), ("2 px too large", exact.grown(2))] {
                let runs = mask.runs(1);
                let Ok(region) = Region::masked(1, &runs, DIMS) else { continue };
                let found = engine.objects(&[region], true)[0];
                let Ok(disparity) = found.disparity else { continue };
                let disparity: f32 = disparity.to_num();
                let is_right = (low - 1.0..=high + 1.0).contains(&disparity);
                assert!(is_right, "seed {seed}, {object}, {outline}: {low} to {high} px, found {found:?}");
                answers += 1;
            }
        }
    }
    assert!(answers > 12 * SEEDS.count(), "{answers} answers prove little");
}
