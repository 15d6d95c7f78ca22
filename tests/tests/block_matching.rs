//! The board's block matchers: OpenCV's numbers, naive windows, and kernels of every length.

use linestereo::{Dims, Gray};
use linestereo_block_matching::{DenseMemory, GridMemory, Misfit, NO_DISPARITY, Settings, dense_groups, grid_groups};
use linestereo_sim::baselines::{Search, StereoBm};
use linestereo_sim::engine::GrayImage;
use linestereo_sim::scene::{self, Kind, Sensor};
use linestereo_tests::captured;

type Dense = DenseMemory<330, { dense_groups(330, 64) }>;
type Grid = GridMemory<330, { grid_groups(330, 64) }>;

fn rendered(width: u16, height: u16, seed: u64) -> (GrayImage, GrayImage) {
    let dims = Dims { width, height };
    let sensor = Sensor { noise: 2.0, seed, ..Sensor::default() };
    let pair = scene::render(&scene::build(Kind::Boxes, dims, seed), dims, &sensor);
    (pair.left, pair.right)
}

/// Runs a matcher and puts its rows into an image.
fn image(dims: Dims, run: impl FnOnce(&mut dyn FnMut(usize, &[i16])) -> Result<(), Misfit>) -> Vec<i16> {
    let width = usize::from(dims.width);
    let mut out = vec![NO_DISPARITY; width * usize::from(dims.height)];
    let mut row = |y: usize, disparities: &[i16]| out[y * width..(y + 1) * width].copy_from_slice(disparities);
    run(&mut row).unwrap();
    out
}

fn dense((left, right): &(GrayImage, GrayImage), settings: &Settings) -> Vec<i16> {
    let pair = [left.view().unwrap(), right.view().unwrap()];
    let mut memory = Box::new(Dense::new());
    // What lies in the memory from the pair before changes nothing.
    memory.run(settings, [pair[1], pair[0]], &mut |_, _| {}).unwrap();
    image(left.dims, |row| memory.run(settings, pair, row))
}

#[test]
fn the_dense_matcher_is_stereo_bm_number_for_number() {
    let captured = captured::qvga().unwrap_or_default().into_iter().map(|scene| (scene.left, scene.right));
    let drawn = [(320, 240), (200, 99), (131, 46), (79, 16)].into_iter().zip(1..);
    let drawn = drawn.map(|((width, height), seed)| rendered(width, height, seed));
    for pair in drawn.chain(captured) {
        for disparities in [16, 48, 64] {
            let dims = pair.0.dims;
            if usize::from(dims.width) < disparities + 14 {
                continue;
            }
            for (settings, reference) in
                [(Settings::USUAL, StereoBm::default()), (Settings::STRICT, StereoBm::strict())]
            {
                let settings = Settings { disparities, left_right: None, ..settings };
                let map = reference.run(&pair.0, &pair.1, Search { dims, count: disparities });
                let ours = dense(&pair, &settings);
                let theirs = map.values().iter().map(|d| if d.is_nan() { NO_DISPARITY } else { (16.0 * d) as i16 });
                let different = ours.iter().zip(theirs).filter(|(ours, theirs)| *ours != theirs).count();
                assert_eq!(different, 0, "{dims}, {settings:?}");
            }
        }
    }
}
