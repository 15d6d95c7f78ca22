//! ChArUco boards and AprilGrids: boards that OpenCV drew, drawn photos of parts of boards, and
//! what is said of wrong ones.

use crate::calibration::{Planes, drawn_rig, found, photos_of, scores};
use crate::support::{self, Folder, says, succeed};
use linestereo_calibration::boards::{
    Board, BoardFinder, BoardPair, Dictionary, JunctionFinder, NotFound, Options, estimate,
};
use linestereo_frames::{GrayImage, load_gray};
use linestereo_rig::{Calibration, CameraSide};
use linestereo_tests::drawn::Random;
use std::fs;
use std::path::Path;

fn charuco(
    sides: [u8; 2],
    [square_mm, marker_mm]: [f64; 2],
    dictionary: &str,
    legacy: bool,
) -> Board {
    let dictionary = Dictionary::named(dictionary).unwrap();
    Board::charuco(sides, square_mm / 1e3, marker_mm / 1e3, dictionary, legacy).unwrap()
}

/// Boards drawn by OpenCV 5.0.0 (`CharucoBoard::generateImage`, `generateImageMarker` in Kalibr's
/// layout with its squares), px for mm, and where the first corner is.
fn drawn_by_opencv() -> [(&'static str, Board, f64); 3] {
    [
        ("charuco_5x4.png", charuco([5, 4], [40.0, 30.0], "DICT_4X4_50", false), 60.0),
        ("charuco_5x4_legacy.png", charuco([5, 4], [40.0, 30.0], "DICT_4X4_50", true), 60.0),
        ("aprilgrid_3x2.png", Board::april_grid([3, 2], 0.04, 0.3).unwrap(), 32.0),
    ]
}

fn opencv(name: &str) -> GrayImage {
    load_gray(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/boards").join(name)).unwrap()
}

#[test]
fn what_is_printed_is_what_opencv_draws() {
    for (name, board, first) in drawn_by_opencv() {
        let image = opencv(name);
        let width = usize::from(image.dims.width);
        let mut drawn = vec![255; image.pixels.len()];
        for [x, y, w, h] in board.black().iter().map(|black| black.map(|m| 1e3 * m)) {
            let pixels = |from: f64, length: f64| {
                (from + first).round() as usize..(from + first + length).round() as usize
            };
            pixels(y, h).for_each(|row| drawn[row * width..][pixels(x, w)].fill(0));
        }
        assert!(drawn == image.pixels, "{name}");
    }
}

#[test]
fn boards_of_opencv_are_read() {
    for (name, board, first) in drawn_by_opencv() {
        let (numbers, corners) = JunctionFinder.find(&opencv(name), &board).unwrap().into_inner();
        assert_eq!(numbers, (0..board.corners()).collect::<Vec<_>>(), "{name}");
        for (at, place) in corners.iter().zip(board.points()) {
            // A pixel's middle is its coordinate.
            let off = [0, 1].map(|axis| at[axis] - (1e3 * place[axis] + first - 0.5));
            assert!(off[0].hypot(off[1]) < 0.1, "{name}: {place:?} at {at:?}");
        }
    }
}

/// Blurred a little, with noise of 3 grey levels.
fn worn(image: &GrayImage, random: &mut Random) -> GrayImage {
    let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
    let pixel = |i: usize| {
        let (x, y) = ((i % width).clamp(1, width - 2), (i / width).clamp(1, height - 2));
        let row = |y: usize| {
            let at = |x: usize| f64::from(image.pixels[y * width + x]);
            (at(x - 1) + 2.0 * at(x) + at(x + 1)) / 4.0
        };
        let grey = (row(y - 1) + 2.0 * row(y) + row(y + 1)) / 4.0;
        (grey + 3.0 * random.normal()).round().clamp(0.0, 255.0) as u8
    };
    GrayImage { dims: image.dims, pixels: (0..width * height).map(pixel).collect() }
}

/// Squares of the distances from the true corners, px.
fn off(rig: &Calibration, board: &Board, planes: &Planes, pair: &BoardPair) -> Vec<f64> {
    let points = board.points();
    let of = |eye: CameraSide| {
        let [first, right, down] = planes[usize::from(eye == CameraSide::Right)];
        let side = usize::from(eye == CameraSide::Right);
        let seen = pair.numbers[side].iter().zip(&pair.corners[side]);
        let points = &points;
        seen.map(move |(&number, at)| {
            let [x, y] = points[number];
            let truth = rig
                .camera(eye)
                .project([0, 1, 2].map(|i| first[i] + x * right[i] + y * down[i]))
                .unwrap();
            (at[0] - truth[0]).powi(2) + (at[1] - truth[1]).powi(2)
        })
    };
    of(CameraSide::Left).chain(of(CameraSide::Right)).collect()
}

/// Photos of each board.
const PHOTOS: usize = 8;

#[test]
fn parts_of_boards_calibrate_within_three_stated_deviations() {
    // The legacy layout has the same corners, which `boards_of_opencv_are_read` finds.
    let boards = [
        charuco([8, 6], [40.0, 30.0], "DICT_5X5_100", false),
        Board::april_grid([6, 6], 0.035, 0.3).unwrap(),
    ];
    let rig = drawn_rig(2);
    for (seed, board) in [0, 2].into_iter().zip(boards) {
        let drawn = photos_of(&rig, &board, PHOTOS, 20 + seed, 0.4);
        let random = &mut Random(seed);
        let photos: Vec<[GrayImage; 2]> = drawn
            .iter()
            .map(|(_, photos)| photos.each_ref().map(|image| worn(image, random)))
            .collect();
        let pairs = found(&board, &photos);
        assert_eq!(pairs.len(), PHOTOS, "{board}");
        let part = pairs
            .iter()
            .filter(|pair| pair.numbers.iter().any(|numbers| numbers.len() < board.corners()));
        assert!(part.count() >= PHOTOS / 2, "{board}: boards are whole");
        let squares: Vec<f64> = pairs
            .iter()
            .zip(&drawn)
            .flat_map(|(pair, (planes, _))| off(&rig, &board, planes, pair))
            .collect();
        let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        assert!(rms < 0.1, "{board}: corners are {rms} px off");
        let estimate = estimate(&board, photos[0][0].dims, &pairs, &Options::default()).unwrap();
        assert!(estimate.views.iter().all(|view| view.dropped.is_none()), "{board}");
        let scores = scores(&rig, &estimate);
        let beyond: Vec<_> = scores.iter().filter(|(_, score)| score.abs() > 3.0).collect();
        assert!(beyond.is_empty(), "{board}: {beyond:?}");
    }
}

#[test]
fn wrong_dictionaries_and_sizes_are_named() {
    let image = opencv("charuco_5x4.png");
    let find = |board: &Board| JunctionFinder.find(&image, board);
    assert_eq!(
        find(&charuco([5, 4], [40.0, 30.0], "DICT_6X6_50", false)),
        Err(NotFound::NoMarkers(12))
    );
    assert_eq!(
        find(&charuco([6, 4], [40.0, 30.0], "DICT_4X4_50", false)),
        Err(NotFound::OtherLayout)
    );
    let tags = opencv("aprilgrid_3x2.png");
    assert_eq!(
        JunctionFinder.find(&tags, &Board::april_grid([4, 2], 0.04, 0.3).unwrap()),
        Err(NotFound::OtherLayout)
    );
    let empty = GrayImage { dims: tags.dims, pixels: vec![99; tags.pixels.len()] };
    assert_eq!(
        JunctionFinder.find(&empty, &Board::april_grid([3, 2], 0.04, 0.3).unwrap()),
        Err(NotFound::Nothing)
    );
}

#[test]
fn the_command_says_what_to_do() {
    let folder = Folder::new();
    let photos = folder.path().join("photos");
    fs::create_dir(&photos).unwrap();
    for (number, side) in (1..=6).flat_map(|number| [(number, "left"), (number, "right")]) {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/boards/charuco_5x4.png");
        fs::copy(from, photos.join(format!("{side}{number}.png"))).unwrap();
    }
    let refused = |args: &str, words: &[&str]| {
        support::refused(folder.path(), &format!("calibrate photos {args}"), words);
    };
    refused(
        "--board charuco:5x4 --square-mm 40 --marker-mm 30 --dictionary DICT_6X6_50",
        &["DICT_6X6_50", "--dictionary"],
    );
    refused(
        "--board charuco:6x4 --square-mm 40 --marker-mm 30 --dictionary 4X4_50",
        &["other places", "--board"],
    );
    refused(
        "--board charuco:5x4 --square-mm 40 --marker-mm 30 --dictionary 4X4",
        &["no dictionary 4X4", "DICT_4X4_50"],
    );
    refused("--board charuco:5x4 --square-mm 40 --marker-mm 30", &["--dictionary"]);
    refused("--board charuco:5x4 --square-mm 40 --dictionary DICT_4X4_50", &["--marker-mm"]);
    refused(
        "--board charuco:5x4 --square-mm 30 --marker-mm 40 --dictionary DICT_4X4_50",
        &["a marker's side"],
    );
    refused(
        "--board charuco:20x20 --square-mm 40 --marker-mm 30 --dictionary DICT_4X4_50",
        &["200 markers", "50"],
    );
    refused("--board aprilgrid:3x2 --tag-mm 30 --spacing 0.3", &["no tags of 36h11"]);
    refused("--board aprilgrid:3x2 --tag-mm 30", &["--spacing"]);
    refused("--board aprilgrid:3x2 --square-mm 30", &["--square-mm is not of an AprilGrid"]);
    refused("--board circles:3x2 --square-mm 30", &["circles"]);
}

#[test]
fn boards_are_printed_in_their_size() {
    let folder = Folder::new();
    let print = |args: &str| {
        succeed(folder.path(), &format!("print-board {args} --out board.svg"));
        fs::read_to_string(folder.path().join("board.svg")).unwrap()
    };
    let chessboard = print("9x6 --square-mm 25");
    // 10x7 squares and half a square around, but 10 mm at least.
    says(&chessboard, &["width=\"275.0000mm\" height=\"200.0000mm\""]);
    assert_eq!(chessboard.matches("h25.0000v25.0000").count(), 35);
    let tags = print("aprilgrid:3x2 --tag-mm 40 --spacing 0.3");
    says(&tags, &["width=\"208.0000mm\" height=\"156.0000mm\""]);
    assert_eq!(tags.matches("h12.0000v12.0000").count(), 12);
}
