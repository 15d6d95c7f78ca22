//! The classic methods: every cost against an oracle, sliding sums against plain ones, methods and after-steps on drawn pairs.

use linestereo::Dims;
use linestereo_baselines::{
    Acceptance, AfterStep, BlockMatcher, CostKind, DisparityMap, Fraction, Method, Minimum, PushbroomMatcher,
    ScanLineMatcher, Search, Shape, SparseBlockMatcher, StereoBm, StereoBmError, Window, descend, fill_from_neighbours,
    fill_surfaces, for_each_row, median, remove_speckles,
};
use linestereo_frames::GrayImage;
use linestereo_frames::Truth;
use linestereo_sim::engine::FrameResult;
use linestereo_sim::evaluate::{FrameScore, Summary};
use linestereo_sim::scene::{self, Kind, Sensor};
use linestereo_tests::drawn::{Random, painted};
use linestereo_tests::reference::{at, census, sobel};

/// Random greys.
fn noise(width: u16, height: u16, seed: u64) -> GrayImage {
    let mut random = Random(seed);
    painted(width, height, |_, _| random.grey())
}

/// Left noise that the right image shows `shift(x, y)` px further left; the right image's own noise where nothing falls.
fn shifted(width: u16, height: u16, seed: u64, shift: impl Fn(u16, u16) -> u16) -> (GrayImage, GrayImage) {
    let left = noise(width, height, seed);
    let right = seen_from_the_right(&left, seed + 1, shift);
    (left, right)
}

fn seen_from_the_right(left: &GrayImage, seed: u64, shift: impl Fn(u16, u16) -> u16) -> GrayImage {
    let (width, height) = (left.dims.width, left.dims.height);
    let mut right = noise(width, height, seed);
    for y in 0..height {
        // Nearer surfaces cover farther ones.
        let mut columns: Vec<u16> = (0..width).collect();
        columns.sort_by_key(|&x| shift(x, y));
        for x in columns {
            if let Some(column) = x.checked_sub(shift(x, y)) {
                right.pixels[usize::from(y) * usize::from(width) + usize::from(column)] =
                    left.pixels[usize::from(y) * usize::from(width) + usize::from(x)];
            }
        }
    }
    right
}

/// Greys of both windows, pixel by pixel.
fn windows(pair: (&GrayImage, &GrayImage), window: &Window, (x, y, d): (i32, i32, i32)) -> Vec<[f64; 2]> {
    let grey = |(dx, dy): (isize, isize)| {
        let (x, y) = (x + dx as i32, y + dy as i32);
        [f64::from(at(pair.0, x, y)), f64::from(at(pair.1, x - d, y))]
    };
    window.offsets().map(grey).collect()
}

/// Both windows with mean 0 and norm 1; 0 everywhere for a single grey level.
fn normalised(values: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let of = |i: usize| {
        let mean = values.iter().map(|v| v[i]).sum::<f64>() / values.len() as f64;
        let norm = values.iter().map(|v| (v[i] - mean).powi(2)).sum::<f64>().sqrt();
        values.iter().map(move |v| if norm > 0.0 { (v[i] - mean) / norm } else { 0.0 }).collect::<Vec<_>>()
    };
    of(0).into_iter().zip(of(1)).map(|(l, r)| [l, r]).collect()
}

/// Neighbours within 3 px that are darker.
fn rank(image: &GrayImage, x: i32, y: i32) -> i32 {
    let around = (-3..=3).flat_map(|dy| (-3..=3).map(move |dx| (dx, dy)));
    around.filter(|&(dx, dy)| at(image, x + dx, y + dy) < at(image, x, y)).count() as i32
}

/// The cost by its definition.
fn oracle(kind: CostKind, pair: (&GrayImage, &GrayImage), window: &Window, place: (i32, i32, i32)) -> f64 {
    let (x, y, d) = place;
    let greys = windows(pair, window, place);
    let sum = |term: &dyn Fn(&[f64; 2]) -> f64, values: &[[f64; 2]]| values.iter().map(term).sum::<f64>();
    let of_pixels = |value: &dyn Fn(&GrayImage, i32, i32, i32, i32) -> f64| {
        let term =
            |(dx, dy): (isize, isize)| value(pair.0, x + dx as i32, y + dy as i32, x + dx as i32 - d, y + dy as i32);
        window.offsets().map(term).sum::<f64>()
    };
    let quarter = |image: &GrayImage, x: i32, y: i32| (sobel(image, x, y).0 / 4).clamp(-31, 31);
    match kind {
        CostKind::Ssd => sum(&|[l, r]| (l - r).powi(2), &greys),
        CostKind::Sad => sum(&|[l, r]| (l - r).abs(), &greys),
        CostKind::Ncc => 32_768.0 * (1.0 - sum(&|[l, r]| l * r, &normalised(&greys))),
        CostKind::NormalisedSsd => 32_768.0 * sum(&|[l, r]| (l - r).powi(2), &normalised(&greys)),
        CostKind::NormalisedSad => 4096.0 * sum(&|[l, r]| (l - r).abs(), &normalised(&greys)),
        CostKind::Rank => of_pixels(&|_, x, y, rx, ry| f64::from(rank(pair.0, x, y).abs_diff(rank(pair.1, rx, ry)))),
        CostKind::Census => {
            of_pixels(&|_, x, y, rx, ry| f64::from((census(pair.0, x, y) ^ census(pair.1, rx, ry)).count_ones()))
        }
        CostKind::Gradient => {
            of_pixels(&|_, x, y, rx, ry| f64::from(quarter(pair.0, x, y).abs_diff(quarter(pair.1, rx, ry))))
        }
    }
}

/// Every cost of every window and disparity equals its definition to within `tolerance`.
fn check(kind: CostKind, tolerance: f64) {
    let search = Search { dims: Dims { width: 41, height: 17 }, count: 16 };
    let images =
        [noise(41, 17, 3), noise(41, 17, 4), painted(41, 17, |x, y| if (x / 7 + y / 5) % 2 == 0 { 255 } else { 0 })];
    let shapes =
        [Window::square(1), Window::square(5), Window::new(9, 3, Shape::Rectangle), Window::new(7, 9, Shape::Cross)];
    for window in shapes {
        for pair in [(&images[0], &images[1]), (&images[2], &images[0]), (&images[2], &images[2])] {
            let cost = kind.of(pair.0, pair.1, &window, search);
            let mut rows = 0;
            for_each_row(&*cost, search, &window, |row| {
                rows += 1;
                for (x, curve) in row.curves() {
                    for (d, &found) in curve.iter().enumerate() {
                        let expected = oracle(kind, pair, &window, (x as i32, row.y as i32, d as i32));
                        let error = (f64::from(found) - expected).abs();
                        assert!(
                            error <= tolerance,
                            "{kind:?} {window:?} at {x}, {}, {d}: {found}, is {expected}",
                            row.y
                        );
                    }
                }
            });
            assert_eq!(rows, 17 - 2 * window.half_rows());
        }
    }
}

#[test]
fn squared_differences() {
    check(CostKind::Ssd, 0.0);
}

#[test]
fn absolute_differences() {
    check(CostKind::Sad, 0.0);
}

#[test]
fn correlation_with_zero_means() {
    check(CostKind::Ncc, 0.501); // rounded to a step of 2^-15
}

#[test]
fn squared_differences_of_normalised_patches() {
    // By the correlation: 2 - 2 NCC. Where a patch has no norm the definition is 1 or 0 and the correlation says 2: see below.
    let search = Search { dims: Dims { width: 41, height: 9 }, count: 16 };
    let (left, right, window) = (noise(41, 9, 5), noise(41, 9, 6), Window::square(5));
    let cost = CostKind::NormalisedSsd.of(&left, &right, &window, search);
    for_each_row(&*cost, search, &window, |row| {
        for (x, curve) in row.curves() {
            for (d, &found) in curve.iter().enumerate() {
                let place = (x as i32, row.y as i32, d as i32);
                let expected = oracle(CostKind::NormalisedSsd, (&left, &right), &window, place);
                assert!((f64::from(found) - expected).abs() <= 0.501, "{place:?}: {found}, is {expected}");
            }
        }
    });
    let flat = painted(41, 9, |_, _| 90);
    let cost = CostKind::NormalisedSsd.of(&flat, &flat, &window, search);
    for_each_row(&*cost, search, &window, |row| assert!(row.costs.iter().all(|&cost| cost == 65_536)));
}

#[test]
fn absolute_differences_of_normalised_patches() {
    check(CostKind::NormalisedSad, 1.0); // single precision, and rounded to a step
}

#[test]
fn ranks() {
    check(CostKind::Rank, 0.0);
}

#[test]
fn census_codes() {
    check(CostKind::Census, 0.0);
}

#[test]
fn horizontal_gradients() {
    check(CostKind::Gradient, 0.0);
}

#[test]
fn costs_that_forgive_exposure_do() {
    let (left, right) = shifted(96, 24, 7, |_, _| 9);
    // A gain of 1/2 and an offset: order stays, differences do not. Even greys so that nothing is rounded.
    let left = painted(96, 24, |x, y| at(&left, x.into(), y.into()) as u8 & 0xfe);
    let darker = painted(96, 24, |x, y| (at(&right, x.into(), y.into()) as u8 & 0xfe) / 2 + 20);
    let search = Search::up_to(left.dims, 16);
    let acceptance = Acceptance { fraction: Fraction::None, ..Acceptance::default() };
    for (cost, forgives) in [
        (CostKind::Sad, false),
        (CostKind::Ncc, true),
        (CostKind::NormalisedSsd, true),
        (CostKind::NormalisedSad, true),
        (CostKind::Rank, true),
        (CostKind::Census, true),
    ] {
        let map = BlockMatcher { cost, window: Window::square(5), acceptance }.run(&left, &darker, search);
        let confidence: f32 = (40..80).map(|x| map.confidence(x, 12)).sum::<f32>() / 40.0;
        assert!((40..80).all(|x| map.at(x, 12) == Some(9.0)) || !forgives, "{cost:?}");
        assert_eq!(confidence > 0.7, forgives, "{cost:?}: {confidence}");
    }
}

#[test]
fn fractions_of_three_costs() {
    // A parabola with its vertex at 0.2: (d - 0.2)^2 * 100 + 10.
    assert!((Fraction::Parabola.of(154, 14, 74) - 0.2).abs() < 1e-6);
    // Two lines of slope 50 that meet at -0.3.
    assert!((Fraction::Equiangular.of(45, 25, 75) + 0.3).abs() < 1e-6);
    assert_eq!(Fraction::None.of(1, 0, 9), 0.0);
    assert_eq!([Fraction::Parabola, Fraction::Equiangular].map(|f| f.of(5, 5, 5)), [0.0; 2]);
    assert_eq!(Minimum::of(&[3, 9, 9]).refined(&[3, 9, 9], Fraction::Parabola), 0.0);
}

/// A near square before a wall, 96 x 64; the wall at 4 px, the square at 11 px.
fn square(x: u16, y: u16) -> u16 {
    if (40..70).contains(&x) && (16..48).contains(&y) { 11 } else { 4 }
}

/// Share of known disparities that are right to half a px, and how many there are, without a frame of 4 px around the square's sides.
fn score(map: &DisparityMap, right: impl Fn(u16, u16) -> u16) -> (f64, usize) {
    let (mut good, mut count) = (0, 0);
    for (x, y) in (0..64_u16).flat_map(|y| (0..96_u16).map(move |x| (x, y))) {
        if let Some(d) = map.at(x.into(), y.into()) {
            count += 1;
            good += usize::from((d - f32::from(right(x, y))).abs() <= 0.5);
        }
    }
    (good as f64 / count.max(1) as f64, count)
}

#[test]
fn dense_methods_see_a_square_before_a_wall() {
    let (left, right) = shifted(96, 64, 11, square);
    for method in Method::all() {
        let map = method.run(&left, &right, 16);
        let (share, count) = score(&map, square);
        let (least_share, least_count) = match method.name.as_str() {
            // Noise has a peak of its gradient in about a quarter of its pixels.
            "sparse-block" => (0.85, 600),
            // Half of the range is 8: nothing is there.
            "pushbroom" => {
                assert_eq!(count, 0, "pushbroom at a disparity where nothing is");
                continue;
            }
            // A window of 15 px sees two surfaces 7 px around the square.
            "bm" | "bm-strict" => (0.8, 1200),
            "scan-line" | "sgm4" | "sgm8" | "sgm8-strict" => (0.93, 3500),
            _ => (0.8, 2500),
        };
        assert!(share >= least_share && count >= least_count, "{}: {share:.3} of {count}", method.name);
    }
}

#[test]
fn what_is_hidden_is_found_by_the_other_image() {
    let (left, right) = shifted(96, 64, 13, square);
    let search = Search::up_to(left.dims, 16);
    let hidden = |map: &DisparityMap| (33..40).filter(|&x| (20..44).all(|y| map.is_occluded(x, y))).count();
    let seen = |map: &DisparityMap| {
        (44..66).flat_map(|x| (20..44).map(move |y| (x, y))).filter(|&(x, y)| map.is_occluded(x, y)).count()
    };
    let acceptance = Acceptance { left_right: Some(1), ..Acceptance::default() };
    let block = BlockMatcher { cost: CostKind::Sad, window: Window::square(3), acceptance }.run(&left, &right, search);
    let scan = ScanLineMatcher { window: Window::square(3), ..ScanLineMatcher::default() }.run(&left, &right, search);
    // The 7 columns left of the square have no partner; windows of 3 px blur a column on each side.
    for (name, map) in [("block", block), ("scan-line", scan)] {
        assert!(hidden(&map) >= 3, "{name}: {} columns", hidden(&map));
        assert!(seen(&map) <= 20, "{name}: {} of 528 visible pixels", seen(&map));
    }
}

#[test]
fn uniqueness_refuses_repetition() {
    // Stripes of 4 px: every fourth disparity is as good. (Paths of sgm tell what the image's border says: it may answer.)
    let stripes = painted(96, 40, |x, _| if x % 4 < 2 { 40 } else { 200 });
    let search = Search::up_to(stripes.dims, 16);
    let acceptance = Acceptance { least_confidence: 0.1, ..Acceptance::default() };
    let census = BlockMatcher { cost: CostKind::Census, window: Window::square(7), acceptance };
    for (name, map) in [
        ("census", census.run(&stripes, &stripes, search)),
        ("bm", StereoBm::default().run(&stripes, &stripes, search)),
        ("sparse-block", SparseBlockMatcher::default().run(&stripes, &stripes, search)),
    ] {
        // A window that touches the image's border sees it, and the border is unique.
        let found = (8..32).flat_map(|y| (0..84).map(move |x| (x, y))).filter(|&(x, y)| map.at(x, y).is_some()).count();
        assert_eq!(found, 0, "{name}");
    }
}

#[test]
fn pushbroom_sees_its_one_disparity() {
    // Means of 3 x 3 px: its edges are those of pictures, not of noise, which is all edge.
    let rough = noise(96, 64, 17);
    let left = painted(96, 64, |x, y| {
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
        (around.map(|(dx, dy)| at(&rough, i32::from(x) + dx, i32::from(y) + dy)).sum::<i32>() / 9) as u8
    });
    let right = seen_from_the_right(&left, 18, square);
    let map = PushbroomMatcher::new(11).run(&left, &right);
    let inside = |x: usize, y: usize| (40..70).contains(&x) && (16..48).contains(&y);
    let hits = (0..96).flat_map(|x| (0..64).map(move |y| (x, y))).filter(|&(x, y)| map.at(x, y).is_some());
    let (on, off): (Vec<_>, Vec<_>) = hits.partition(|&(x, y)| inside(x, y));
    // 5 x 6 blocks of the grid fit; a block speaks for 3 x 3 px.
    assert!(on.len() >= 9 * 25 && off.is_empty(), "{} on it, {} beside", on.len(), off.len());
    // A picture that repeats along the row matches anywhere: no block may.
    let stripes = painted(96, 40, |x, _| if x % 4 < 2 { 40 } else { 200 });
    assert_eq!(PushbroomMatcher::new(8).run(&stripes, &stripes).count(), 0);
}

/// The block matcher of OpenCV by its definition, without sliding anything.
#[test]
fn stereo_bm_is_what_its_head_says() {
    let room = scene::build(Kind::Boxes, Dims { width: 96, height: 49 }, 3);
    let pair = scene::render(&room, Dims { width: 96, height: 49 }, &Sensor { noise: 2.0, ..Sensor::default() });
    let search = Search::up_to(pair.left.dims, 16);
    let value = |image: &GrayImage, x: i32, y: i32| {
        if x == 0 || x == 95 || y == 48 {
            return 0; // an odd last row is not filtered
        }
        // Above the first row lies the second.
        let row = |dy: i32| if y + dy < 0 { 1 } else { y + dy };
        let step = |dy: i32| at(image, x + 1, row(dy)) - at(image, x - 1, row(dy));
        (step(-1) + 2 * step(0) + step(1)).clamp(-31, 31)
    };
    let around = |x: i32, y: i32| (-3..=3).flat_map(move |dy| (-3..=3).map(move |dx| (x + dx, y + dy)));
    let mut matcher = StereoBm::new(7, 31).unwrap();
    (matcher.texture_threshold, matcher.uniqueness_ratio) = (300, 20);
    let map = matcher.run(&pair.left, &pair.right, search);
    let mut count = 0;
    for (x, y) in (0..49).flat_map(|y| (0..96).map(move |x| (x, y))) {
        let inside = (15 + 3..96 - 3).contains(&x) && (3..49 - 3).contains(&y);
        let cost = |d: i32| {
            around(x, y).map(|(x, y)| (value(&pair.left, x, y) - value(&pair.right, x - d, y)).abs()).sum::<i32>()
        };
        let texture: i32 = around(x, y).map(|(x, y)| value(&pair.left, x, y).abs()).sum();
        let expected = (inside && texture >= 300).then(|| (0..16).map(cost).collect::<Vec<_>>()).and_then(|costs| {
            let least = *costs.iter().min().unwrap();
            let d = costs.iter().rposition(|&cost| cost == least).unwrap();
            let unique = |(other, &cost): (usize, &i32)| other.abs_diff(d) <= 1 || cost > least + least * 20 / 100;
            costs.iter().enumerate().all(unique).then(|| {
                let mut value = d as i32 * 256 + 15;
                if (1..15).contains(&d) && costs[d - 1].max(costs[d + 1]) > least {
                    value += (costs[d - 1] - costs[d + 1]) * 256 / (2 * (costs[d - 1].max(costs[d + 1]) - least));
                }
                (value >> 4) as f32 / 16.0
            })
        });
        count += usize::from(expected.is_some());
        assert_eq!(map.at(x as usize, y as usize), expected, "at {x}, {y}");
    }
    assert!(count > 300, "only {count} disparities: the test says little");
    assert_eq!(StereoBm::new(14, 31), Err(StereoBmError::Window(14)));
    assert_eq!(StereoBm::new(23, 31), Err(StereoBmError::Window(23)));
    assert_eq!(StereoBm::new(15, 64), Err(StereoBmError::Cap(64)));
}

/// A map of rows of numbers; `.` is a gap.
fn map(rows: &[&str]) -> DisparityMap {
    let value = |text: &str| if text == "." { f32::NAN } else { text.parse().unwrap() };
    let values: Vec<Vec<f32>> = rows.iter().map(|row| row.split_whitespace().map(value).collect()).collect();
    let dims = Dims { width: values[0].len() as u16, height: rows.len() as u16 };
    DisparityMap::of_values(dims, values.concat())
}

fn drawn(map: &DisparityMap) -> Vec<String> {
    let text = |value: &f32| if value.is_nan() { ".".to_owned() } else { value.to_string() };
    let rows = map.values().chunks(map.dims().width.into());
    rows.map(|row| row.iter().map(text).collect::<Vec<_>>().join(" ")).collect()
}

#[test]
fn the_median_takes_single_values_and_leaves_edges() {
    let mut found = map(&["1 1 1 8 8", "1 9 1 8 8", "1 1 1 8 .", "1 1 1 8 8"]);
    median(&mut found, 1);
    assert_eq!(drawn(&found), ["1 1 8 8 8", "1 1 1 8 8", "1 1 1 8 .", "1 1 1 8 8"]);
}

#[test]
fn speckles_are_small_patches() {
    let mut found = map(&["1 1 2 9 9", "1 1 3 9 .", ". . 4 . 7", "1 1 5 . 7"]);
    remove_speckles(&mut found, 3, 1.0);
    assert_eq!(drawn(&found), ["1 1 2 . .", "1 1 3 . .", ". . 4 . .", ". . 5 . ."]);
}

#[test]
fn gaps_take_the_farther_side() {
    let mut found = map(&["3 . . 8 .", ". 5 . . 2", ". . . . ."]);
    fill_from_neighbours(&mut found);
    assert_eq!(drawn(&found), ["3 3 3 8 8", "5 5 2 2 2", ". . . . ."]);
}

#[test]
fn gaps_take_the_plane_around_them() {
    // d = 2 + x / 4 + y / 2, with a gap in the middle; a near surface to the right of the gap does not pull it.
    let plane = |x: usize, y: usize| 2.0 + 0.25 * x as f32 + 0.5 * y as f32;
    let dims = Dims { width: 12, height: 9 };
    let is_gap = |x: usize, y: usize| (4..7).contains(&x) && (3..6).contains(&y);
    let pixels = || (0..9).flat_map(|y| (0..12).map(move |x| (x, y)));
    let value = |(x, y): (usize, usize)| match (is_gap(x, y), x >= 7) {
        (true, _) => f32::NAN,
        (_, true) => 30.0,
        _ => plane(x, y),
    };
    let mut found = DisparityMap::of_values(dims, pixels().map(value));
    fill_surfaces(&mut found, 2);
    for (x, y) in pixels().filter(|&(x, y)| is_gap(x, y)) {
        let error = (found.at(x, y).unwrap() - plane(x, y)).abs();
        assert!(error < 1e-3, "{x}, {y}: {error}");
    }
    // A gap that reaches the border has no other side.
    let mut open = map(&["1 1 . 1", "1 1 . 1", "1 1 1 1"]);
    fill_surfaces(&mut open, 2);
    assert_eq!(drawn(&open)[0], "1 1 . 1");
}

#[test]
fn descent_finds_the_fraction() {
    // A smooth picture moved by 5.37 px.
    let grey = |x: f64, y: f64| 128.0 + 50.0 * (x * 0.35).sin() + 40.0 * (x * 0.13 + y * 0.21).cos();
    let left = painted(80, 30, |x, y| grey(f64::from(x), f64::from(y)).round() as u8);
    let right = painted(80, 30, |x, y| grey(f64::from(x) + 5.37, f64::from(y)).round() as u8);
    let mut found = DisparityMap::of_values(left.dims, vec![5.0; 80 * 30]);
    descend(&mut found, &left, &right, 4);
    for (x, y) in (8..24).flat_map(|y| (14..70).map(move |x| (x, y))) {
        let d = found.at(x, y).unwrap();
        // Straight lines between pixels are up to 50 * 0.35^2 / 8 = 0.8 grey levels off, where a step of 1 px is 10 to 17.
        assert!((d - 5.37).abs() < 0.1, "{x}, {y}: {d}");
    }
    assert_eq!(found.at(0, 0), Some(5.0)); // no window there
}

#[test]
fn after_steps_follow_their_order() {
    let (left, right) = shifted(96, 64, 19, square);
    let mut method = Method::named("sad").unwrap().with_window(Window::square(5));
    let plain = method.run(&left, &right, 16);
    method.after = vec![AfterStep::Speckle, AfterStep::FillSurface, AfterStep::FillNeighbours];
    let filled = method.run(&left, &right, 16);
    let rows = 2..62;
    assert!(rows.clone().all(|y| (0..96).all(|x| filled.at(x, y).is_some())), "a row with disparities is filled");
    assert!(plain.count() < filled.count());
    assert!(Method::named("nothing").is_none());
}

#[test]
fn images_too_small_for_a_search_have_no_disparities() {
    let tiny = noise(16, 16, 1);
    for method in Method::all() {
        assert_eq!(method.run(&tiny, &tiny, 32).count(), 0, "{}", method.name);
    }
}

/// Scores of a map on the built-in room: rivals are judged by the words of `eval`.
#[test]
fn maps_are_scored_like_the_core() {
    let dims = Dims { width: 160, height: 120 };
    let pair = scene::render(&scene::build(Kind::Boxes, dims, 2), dims, &Sensor::default());
    let truth = &Truth::new(dims, pair.disparity.clone(), pair.visible.clone());
    let range = scene::search_range(&pair);
    let map = Method::named("sgm8").unwrap().run(&pair.left, &pair.right, range);
    let summary = Summary::pool([&FrameScore::new("boxes", truth, &FrameResult::of_points(map.points()))]);
    assert_eq!(summary.all.points_per_frame, map.count() as f64);
    assert!(summary.all.errors.vis_bad1.unwrap() < 10.0, "{:?}", summary.all);
}
