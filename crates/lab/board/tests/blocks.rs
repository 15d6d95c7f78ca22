//! The board's block matcher: naive windows, and the board beside the PC.

use linestereo::Dims;
use linestereo_frames::GrayImage;
use linestereo_lab_board::{BOARD, GridMemory, NO_DISPARITY, Settings, grid_groups};
use linestereo_sim::board::toolchain::Toolchain;
use linestereo_sim::scene::Kind;
use linestereo_tests::board::or_skip;
use linestereo_tests::drawn::rendered;
use std::process::Command;

/// Sobel along the row, clipped, as OpenCV has it.
fn values(image: &GrayImage) -> Vec<i32> {
    let (width, height) = (i32::from(image.dims.width), i32::from(image.dims.height));
    let at = |x: i32, y: i32| {
        let y = if y < height { y.abs() } else { height - 2 };
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
    [left, right]: [&[i32]; 2],
    width: usize,
    (x, y): (usize, usize),
    settings: &Settings,
) -> i16 {
    let pixels = || (y - 8..y + 8).flat_map(move |y| (x - 8..x + 8).map(move |x| y * width + x));
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
fn the_matcher_gives_what_naive_windows_give() {
    let mut memory = Box::new(GridMemory::<160, { grid_groups(160, 64) }>::new());
    for ((width, height), seed) in [(160, 64), (131, 47), (97, 33)].into_iter().zip(5..) {
        let dims = Dims { width, height };
        let pair = rendered(Kind::Boxes, dims, 2.0, seed);
        let (left, right) = (values(&pair.left), values(&pair.right));
        let width = usize::from(width);
        for (disparities, settings) in
            [(16, Settings::USUAL), (48, Settings::USUAL), (64, Settings::STRICT)]
        {
            let settings = Settings { disparities, left_right: None, ..settings };
            let blank = || vec![NO_DISPARITY; width * usize::from(height)];
            let (mut found, mut expected) = (blank(), blank());
            let views = [&pair.left, &pair.right].map(|image| image.view().unwrap());
            memory
                .run(&settings, views, &mut |y, row| {
                    found[y * width..(y + 1) * width].copy_from_slice(row);
                })
                .unwrap();
            for y in (8..=usize::from(height) / 4 * 4 - 8).step_by(4) {
                for x in (8 + disparities..=width / 4 * 4 - 8).step_by(4) {
                    expected[y * width + x] = of_window([&left, &right], width, (x, y), &settings);
                }
            }
            assert_eq!(found, expected, "{dims}, {disparities} disparities");
            let count = found.iter().filter(|&&d| d != NO_DISPARITY).count();
            assert!(disparities != 16 || count > 50, "{dims}: {count} disparities say little");
        }
    }
}

/// The board runs the kernels for its processor, the PC the portable ones.
#[test]
fn the_board_gives_what_the_pc_gives() {
    if or_skip(Toolchain::for_board(&BOARD)).is_none() {
        return;
    }
    let output = Command::new(env!("CARGO_BIN_EXE_ratio")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.ends_with("every digest is the PC's\n"), "{said}");
}
