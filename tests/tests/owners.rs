//! Surfaces that segments are credited to, on the built-in room.

use linestereo::{Dims, Params, results::Match};
use linestereo_frames::Truth;
use linestereo_lab::evaluate::OwnedMiddle;
use linestereo_sim::scene::{self, Kind, Rendering, Scene, Sensor};

const DIMS: Dims = Dims { width: 320, height: 240 };
/// Rooms that are tried; `linestereo demo --seed N` shows one.
const SEEDS: core::ops::RangeInclusive<u64> = 1..=12;

/// The room of a seed, its truth and its matches.
fn matched(seed: u64) -> (Scene, Rendering, Truth, Vec<Match>) {
    let room = scene::build(Kind::Demo, DIMS, seed);
    let pair = scene::render(&room, DIMS, &Sensor { noise: 1.0, seed, ..Sensor::default() });
    let truth = Truth::new(DIMS, pair.disparity.clone(), pair.visible.clone());
    let params = Params {
        max_disparity: pair.search_range(),
        rig: Some(room.pair.rig().unwrap()),
        ..Params::default()
    };
    let matches = linestereo_tests::matched(&params, [&pair.left, &pair.right]).1.matches;
    (room, pair, truth, matches)
}

/// Edges of the room's poles, each of which has to be at its pole's disparity.
fn edges_of_poles(
    seed: u64,
    (room, pair, truth, matches): &(Scene, Rendering, Truth, Vec<Match>),
) -> usize {
    let is_pole = |label: u8| label > 0 && room.objects[usize::from(label) - 1].ends_with("pole");
    let middles = matches.iter().map(OwnedMiddle::new);
    let edges = middles.filter(|middle| pair.label(middle.pixel).is_some_and(is_pole));
    let check = |middle: OwnedMiddle| {
        let error = middle.error(truth).unwrap();
        assert!(error.abs() <= 1.0, "seed {seed}: {error:+.2} px, {middle:?}");
    };
    edges.map(check).count()
}

#[test]
fn the_most_probable_segment_of_each_object_has_its_depth() {
    let (mut answers, mut with_pole) = (0, 0);
    for seed in SEEDS {
        let found = matched(seed);
        with_pole += usize::from(edges_of_poles(seed, &found) > 0);
        let (room, pair, truth, matches) = found;
        for (object, label) in room.objects.iter().zip(1_u8..) {
            let mut middles = matches.iter().map(OwnedMiddle::new);
            let Some(middle) = middles.find(|middle| pair.label(middle.pixel) == Some(label))
            else {
                continue;
            };
            let error = middle.error(&truth).unwrap();
            assert!(error.abs() <= 1.0, "seed {seed}, {object}: {error:+.2} px, {middle:?}");
            answers += 1;
        }
    }
    assert!(answers > 7 * SEEDS.count(), "{answers} answers prove little");
    assert!(with_pole >= 8, "edges of poles in {with_pole} rooms alone");
}

/// Rooms whose poles are easily matched at the disparity of what is behind them: they are narrower
/// than the window of a support point, which knows the background alone.
const POLES: [u64; 8] = [13, 72, 82, 101, 106, 118, 142, 180];

#[test]
fn an_edge_of_a_thin_pole_is_not_where_the_background_is() {
    let edges: usize = POLES.into_iter().map(|seed| edges_of_poles(seed, &matched(seed))).sum();
    assert!(edges >= POLES.len(), "{edges} edges prove little");
}
