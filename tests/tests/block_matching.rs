//! The board's block matchers: OpenCV's numbers, naive windows, and kernels of every length.

use linestereo::Dims;
use linestereo_baselines::{DisparityMap, Search, StereoBm};
use linestereo_block_matching::{
    DenseMemory, GridMemory, Misfit, NO_DISPARITY, Settings, dense_groups, grid_groups,
};
use linestereo_frames::GrayImage;
use linestereo_lab::evaluate::FrameScore;
use linestereo_lab::rivals::{MethodScore, comparison_table, summarise};
use linestereo_sim::engine::FrameResult;
use linestereo_sim::scene::Kind;
use linestereo_tests::captured;
use linestereo_tests::drawn::rendered;

type Dense = DenseMemory<330, { dense_groups(330, 64) }>;
type Grid = GridMemory<330, { grid_groups(330, 64) }>;

fn boxes(width: u16, height: u16, seed: u64) -> (GrayImage, GrayImage) {
    let pair = rendered(Kind::Boxes, Dims { width, height }, 2.0, seed);
    (pair.left, pair.right)
}

/// Runs a matcher and puts its rows into an image.
fn image(
    dims: Dims,
    run: impl FnOnce(&mut dyn FnMut(usize, &[i16])) -> Result<(), Misfit>,
) -> Vec<i16> {
    let width = usize::from(dims.width);
    let mut out = vec![NO_DISPARITY; width * usize::from(dims.height)];
    let mut row = |y: usize, disparities: &[i16]| {
        out[y * width..(y + 1) * width].copy_from_slice(disparities)
    };
    run(&mut row).unwrap();
    out
}

fn dense((left, right): &(GrayImage, GrayImage), settings: &Settings) -> Vec<i16> {
    let pair = [left.view().unwrap(), right.view().unwrap()];
    let mut memory = Box::new(Dense::new());
    // Memory from the pair before changes nothing.
    memory.run(settings, [pair[1], pair[0]], &mut |_, _| {}).unwrap();
    image(left.dims, |row| memory.run(settings, pair, row))
}

#[test]
fn the_dense_matcher_is_stereo_bm_number_for_number() {
    let captured = captured::qvga()
        .unwrap_or_default()
        .into_iter()
        .take(2)
        .map(|scene| (scene.left, scene.right));
    let drawn = [(320, 240), (200, 99), (131, 46), (79, 16)].into_iter().zip(1..);
    let drawn = drawn.map(|((width, height), seed)| boxes(width, height, seed));
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
                let theirs = map
                    .values()
                    .iter()
                    .map(|d| if d.is_nan() { NO_DISPARITY } else { (16.0 * d) as i16 });
                let different =
                    ours.iter().zip(theirs).filter(|(ours, theirs)| *ours != theirs).count();
                assert_eq!(different, 0, "{dims}, {settings:?}");
            }
        }
    }
}

fn grid((left, right): &(GrayImage, GrayImage), settings: &Settings) -> Vec<i16> {
    let pair = [left.view().unwrap(), right.view().unwrap()];
    let mut memory = Box::new(Grid::new());
    memory.run(settings, [pair[1], pair[0]], &mut |_, _| {}).unwrap();
    image(left.dims, |row| memory.run(settings, pair, row))
}

/// Sobel along the row, clipped, as OpenCV has it.
fn values(image: &GrayImage) -> Vec<i32> {
    let (width, height) = (i32::from(image.dims.width), i32::from(image.dims.height));
    let at = |x: i32, y: i32| {
        let y = if y < 0 {
            1
        } else if y >= height {
            height - 2
        } else {
            y
        };
        i32::from(image.pixels[(y * width + x) as usize])
    };
    let value = |x: i32, y: i32| {
        if x == 0 || x == width - 1 || y >= height & !1 {
            return 31;
        }
        let step = |y: i32| at(x + 1, y) - at(x - 1, y);
        (step(y - 1) + 2 * step(y) + step(y + 1)).clamp(-31, 31) + 31
    };
    (0..height).flat_map(|y| (0..width).map(move |x| value(x, y))).collect()
}

/// One disparity of the grid, by its definition.
fn of_window(
    values: [&[i32]; 2],
    width: usize,
    (x, y): (usize, usize),
    settings: &Settings,
) -> i16 {
    let pixels = || (y - 8..y + 8).flat_map(move |y| (x - 8..x + 8).map(move |x| y * width + x));
    let [left, right] = values;
    let texture: i32 = pixels().map(|i| (left[i] - 31).abs()).sum();
    if (texture as u32) < settings.texture_threshold * 256 / 225 {
        return NO_DISPARITY;
    }
    let cost = |d: usize| -> i32 { pixels().map(|i| (left[i] - right[i - d]).abs()).sum() };
    let costs: Vec<i32> = (0..settings.disparities).map(cost).collect();
    let lowest = *costs.iter().min().unwrap();
    let d = costs.iter().rposition(|&cost| cost == lowest).unwrap();
    let bound = lowest + lowest * i32::from(settings.uniqueness_ratio) / 100;
    if costs.iter().enumerate().any(|(other, &cost)| other.abs_diff(d) > 1 && cost <= bound) {
        return NO_DISPARITY;
    }
    let mut fraction = 0;
    if d > 0 && d + 1 < costs.len() {
        let (before, after) = (costs[d - 1], costs[d + 1]);
        if before.max(after) > lowest {
            fraction = (before - after) * 256 / (2 * (before.max(after) - lowest));
        }
    }
    ((d as i32 * 256 + fraction + 15) >> 4) as i16
}

#[test]
fn the_grid_gives_what_naive_windows_give() {
    for ((width, height), seed) in [(160, 64), (131, 47), (97, 33)].into_iter().zip(5..) {
        let pair = boxes(width, height, seed);
        let (left, right) = (values(&pair.0), values(&pair.1));
        let width = usize::from(width);
        for (disparities, settings) in
            [(16, Settings::USUAL), (48, Settings::USUAL), (64, Settings::STRICT)]
        {
            let settings = Settings { disparities, left_right: None, ..settings };
            let found = grid(&pair, &settings);
            let mut expected = vec![NO_DISPARITY; found.len()];
            for y in (8..=usize::from(height) / 4 * 4 - 8).step_by(4) {
                for x in (8 + disparities..=width / 4 * 4 - 8).step_by(4) {
                    expected[y * width + x] = of_window([&left, &right], width, (x, y), &settings);
                }
            }
            assert_eq!(found, expected, "{width} x {height}, {disparities} disparities");
            let count = found.iter().filter(|&&d| d != NO_DISPARITY).count();
            assert!(
                disparities != 16 || count > 50,
                "{width} x {height}: {count} disparities say little"
            );
        }
    }
}

#[test]
fn sizes_that_do_not_fit_are_refused() {
    let mut memory = Box::new(Dense::new());
    let mut run = |(width, height), disparities| {
        let (left, right) = boxes(width, height, 1);
        let settings = Settings { disparities, ..Settings::USUAL };
        memory.run(&settings, [left.view().unwrap(), right.view().unwrap()], &mut |_, _| {})
    };
    let size = |width, height| Err(Misfit::Size(Dims { width, height }));
    assert_eq!(run((78, 40), 64), Ok(()));
    assert_eq!(run((77, 40), 64), size(77, 40));
    assert_eq!(run((331, 40), 64), size(331, 40));
    assert_eq!(run((330, 40), 64), Ok(()));
    assert_eq!(run((200, 40), 65), Err(Misfit::Disparities(65)));
    assert_eq!(run((200, 40), 0), Err(Misfit::Disparities(0)));
}

/// `--nocapture` prints the table of docs/experiments.md.
#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn captured_frames_are_matched_as_well_as_the_settings_promise() {
    let Some(scenes) = captured::qvga() else { return };
    let usual = Settings { left_right: None, ..Settings::USUAL };
    let strict = Settings { left_right: None, ..Settings::STRICT };
    type Run = fn(&(GrayImage, GrayImage), &Settings) -> Vec<i16>;
    let methods: [(&str, Run, Settings); 8] = [
        ("dense, unchecked", dense, usual),
        ("dense", dense, Settings::USUAL),
        ("dense-strict, unchecked", dense, strict),
        ("dense-strict", dense, Settings::STRICT),
        ("grid, unchecked", grid, usual),
        ("grid", grid, Settings::USUAL),
        ("grid-strict, unchecked", grid, strict),
        ("grid-strict", grid, Settings::STRICT),
    ];
    let score = |scene: linestereo_frames::Scene| {
        let truth = scene.truth.unwrap();
        let pair = (scene.left, scene.right);
        let of = |&(name, run, settings): &(&str, Run, Settings)| {
            let values = run(&pair, &settings);
            let known = |d: i16| if d == NO_DISPARITY { f32::NAN } else { f32::from(d) / 16.0 };
            let result = FrameResult::of_points(
                DisparityMap::of_values(pair.0.dims, values.into_iter().map(known)).points(),
            );
            let score = FrameScore::new(&scene.name, &truth, &result);
            MethodScore { method: name.to_owned(), score, objects: Vec::new(), result: None }
        };
        methods.iter().map(of).collect::<Vec<_>>()
    };
    let scores: Vec<_> = scenes.into_iter().map(score).collect();
    let summaries = summarise(scores.iter().map(Vec::as_slice));
    println!("{}", comparison_table(&summaries));
    for [unchecked, checked] in summaries.as_chunks::<2>().0 {
        let errors = [unchecked, checked].map(|of| of.summary.all.errors.all_gt_bad2.unwrap());
        // On the grid hardly two left pixels meet the same right one.
        let is_better = if checked.method.starts_with("grid") {
            errors[1] <= errors[0]
        } else {
            errors[1] < errors[0]
        };
        assert!(is_better, "the left-right check of {} drops the right ones", checked.method);
    }
}
