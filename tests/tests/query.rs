//! Depth at a pixel: on images with exact truth, and on captured frames.

use linestereo::image::Span;
use linestereo::objects::Reason;
use linestereo::results::{PixelDepth, PixelRejection};
use linestereo::units::Disparity;
use linestereo::unstable::FITTED_PIXEL;
use linestereo::{Area, Capacity, Dims, Gray, Matched, Matcher, Options, Params, Region, Rig};
use linestereo_frames::{GrayImage, Perturbation, Scene};
use linestereo_lab::evaluate::{PixelScore, QueriedPixel, query_pixels};
use linestereo_lab::fitting::{fit_pixels, pixel_source_text, without_gloss};
use linestereo_sim::engine::Engine;
use linestereo_tests::drawn::{Random, Texture, painted, surface};
use linestereo_tests::{answers, captured, matched, run_alone};
use std::path::PathBuf;

const DIMS: Dims = Dims { width: 200, height: 120 };
const RANGE: u16 = 48;

/// Disparity `at + across * x + down * y`.
#[derive(Clone, Copy, Debug)]
struct Plane {
    at: f64,
    across: f64,
    down: f64,
}

impl Plane {
    fn disparity(self, x: f64, y: f64) -> f64 {
        self.at + self.across * x + self.down * y
    }
}

fn pair_of(plane: Plane, seed: u64) -> [GrayImage; 2] {
    surface(DIMS, seed, |y| plane.disparity(0.0, y), plane.across)
}

/// Every `step`-th pixel of every `step`-th row.
fn grid(dims: Dims, step: usize) -> impl Iterator<Item = (u16, u16)> {
    (0..dims.height)
        .step_by(step)
        .flat_map(move |y| (0..dims.width).step_by(step).map(move |x| (x, y)))
}

/// Answers on a grid.
fn ask(
    left: &GrayImage,
    right: &GrayImage,
    step: usize,
) -> Vec<((u16, u16), Result<PixelDepth, PixelRejection>)> {
    let mut engine = Engine::new(&params(), left.dims).unwrap();
    let (left, right) = (left.view().unwrap(), right.view().unwrap());
    let mut matched = engine.run_in_place(left, right).unwrap();
    grid(left.dims(), step).map(|pixel| (pixel, matched.pixel(pixel))).collect()
}

#[test]
fn planes_are_answered_to_a_fraction_of_a_pixel() {
    let flat = [3.0, 7.25, 12.5, 20.75, 33.4].map(|at| Plane { at, across: 0.0, down: 0.0 });
    let slanted = [(0.05, 0.0), (-0.05, 0.0), (0.0, 0.05), (0.0, -0.05)]
        .map(|(across, down)| Plane { at: 20.0, across, down });
    for (plane, seed) in flat.into_iter().chain(slanted).zip(1..) {
        let [left, right] = pair_of(plane, seed);
        let (mut asked, mut errors) = (0, Vec::new());
        for ((x, y), answer) in ask(&left, &right, 5) {
            let truth = plane.disparity(x.into(), y.into());
            // The windows' own place in the right image has to exist.
            if f64::from(x) < truth + 20.0 || x + 12 > DIMS.width {
                continue;
            }
            asked += 1;
            errors.extend(answer.ok().map(|found| (found.disparity.to_num::<f64>() - truth).abs()));
        }
        errors.sort_by(f64::total_cmp);
        let (median, high) = (errors[errors.len() / 2], errors[errors.len() * 99 / 100]);
        assert!(errors.len() * 10 >= asked * 9, "{plane:?}: {} of {asked} answered", errors.len());
        assert!(median <= 0.1 && high <= 0.5, "{plane:?}: median {median}, 99 % within {high}");
    }
}

#[test]
fn a_blank_wall_is_not_known() {
    let blank = painted(DIMS.width, DIMS.height, |_, _| 90);
    for ((x, y), answer) in ask(&blank, &blank, 9) {
        let reason = if x < 18 { PixelRejection::NearBorder } else { PixelRejection::NoTexture };
        assert_eq!(answer, Err(reason), "{x},{y}");
    }
    for noise in [1.0, 3.0, 6.0] {
        let (left, right) = Perturbation { noise, ..Perturbation::default() }.apply(&blank, &blank);
        let answers = ask(&left, &right, 5);
        let answered = answers.iter().filter(|(_, answer)| answer.is_ok()).count();
        // Answers claim 0.9: noise may be credible once in a hundred times, not more.
        assert!(answered * 100 <= answers.len(), "noise {noise}: {answered} of {}", answers.len());
    }
}

#[test]
fn repeated_structure_is_not_known() {
    for period in [3_u16, 4, 6, 8, 12] {
        let columns =
            painted(DIMS.width, DIMS.height, |x, _| if (x / period) % 2 == 0 { 40 } else { 210 });
        let board = painted(DIMS.width, DIMS.height, |x, y| {
            if (x / period + y / period) % 2 == 0 { 40 } else { 210 }
        });
        for (name, image) in [("columns", columns), ("checkerboard", board)] {
            for ((x, y), answer) in ask(&image, &image, 3) {
                // The images are the same: next to the left border 0 is alone, the next repetition
                // lies outside the right image.
                let alone =
                    answer.is_ok_and(|found| x <= 2 * period + 16 && found.disparity.abs() <= 1);
                assert!(answer.is_err() || alone, "{name} of {period} px at {x},{y}: {answer:?}");
            }
        }
    }
}

/// A textured square of disparity 24 in front of a textured wall of disparity 6.
struct Square;

impl Square {
    const NEAR: f64 = 24.0;
    const FAR: f64 = 6.0;
    const AREA: Area = Area { left: 80, top: 30, right: 140, bottom: 90 };

    fn pair() -> [GrayImage; 2] {
        let [near, far] = [77, 5].map(Texture::new);
        [0.0, 1.0].map(|eye: f64| {
            painted(DIMS.width, DIMS.height, |x, y| {
                let of_near = f64::from(x) + eye * Self::NEAR;
                let of_far = f64::from(x) + eye * Self::FAR;
                let is_near = Self::AREA.contains(of_near as i32, y.into());
                let grey =
                    if is_near { near.at(of_near, y.into()) } else { far.at(of_far, y.into()) };
                grey.round() as u8
            })
        })
    }

    /// Disparity, and whether the right image sees it.
    fn truth(x: u16, y: u16) -> (f64, bool) {
        let inside = |x: i32| Self::AREA.contains(x, y.into());
        if inside(x.into()) {
            return (Self::NEAR, true);
        }
        (Self::FAR, !inside(i32::from(x) + (Self::NEAR - Self::FAR) as i32))
    }
}

#[test]
fn a_hidden_strip_has_no_wrong_depth() {
    let [left, right] = Square::pair();
    let (mut hidden, mut seen) = ((0, 0), (0, 0, 0));
    for ((x, y), answer) in ask(&left, &right, 2) {
        let (truth, visible) = Square::truth(x, y);
        let wrong = answer.is_ok_and(|found| (found.disparity.to_num::<f64>() - truth).abs() > 2.0);
        if visible {
            seen = (seen.0 + 1, seen.1 + usize::from(answer.is_ok()), seen.2 + usize::from(wrong));
        } else {
            hidden = (hidden.0 + 1, hidden.1 + usize::from(wrong));
        }
    }
    assert!(hidden.0 > 200 && hidden.1 * 20 <= hidden.0, "hidden: {hidden:?}");
    assert!(seen.1 * 10 >= seen.0 * 7 && seen.2 * 50 <= seen.1, "seen: {seen:?}");
}

/// Memory for a small pair.
type Small = linestereo::Memory<{ Capacity { cell: 16, ..Capacity::new(DIMS) }.words() }>;

fn params() -> Params {
    Params { max_disparity: RANGE, ..Params::default() }
}

fn run<'a>(images: [Gray<'a>; 2], memory: &'a mut Small) -> Matched<'a> {
    run_alone(&params(), memory, images, Options::default()).unwrap()
}

#[test]
fn what_cannot_be_answered_is_named() {
    let [left, right] = pair_of(Plane { at: 10.0, across: 0.0, down: 0.0 }, 3);
    let mut small = Box::new(Small::new());
    let (l, r) = (left.view().unwrap(), right.view().unwrap());
    let mut matched = run([l, r], &mut small);
    assert_eq!(matched.pixel((DIMS.width, 5)), Err(PixelRejection::Outside));
    assert_eq!(matched.pixel((5, DIMS.height)), Err(PixelRejection::Outside));
    assert_eq!(matched.pixel((u16::MAX, u16::MAX)), Err(PixelRejection::Outside));
    assert_eq!(matched.pixel((3, 60)), Err(PixelRejection::NearBorder));
    let region =
        Region::boxed(1, Area { left: 90, top: 40, right: 120, bottom: 70 }, DIMS).unwrap();
    assert_eq!(matched.pixel_of((80, 50), &region), Err(PixelRejection::OutsideRegion));
    assert!(matched.pixel_of((100, 50), &region).is_ok());

    // Spans that leave out the pixel, or all right columns it could match.
    let spans = vec![Span { start: 60, end: DIMS.width }; DIMS.height.into()];
    let cut = l.with_valid(&spans).unwrap();
    let mut matched = run([cut, r], &mut small);
    assert_eq!(matched.pixel((50, 50)), Err(PixelRejection::Outside));
    let cut = r.with_valid(&spans).unwrap();
    let mut matched = run([l, cut], &mut small);
    assert_eq!(matched.pixel((62, 50)), Err(PixelRejection::NearBorder));

    // A pair that is refused: captured too far apart.
    let mut matcher = Matcher::new(params(), DIMS).unwrap();
    let options = Options { times_us: Some([0, 1_000_000]), ..Options::default() };
    let mut matched = matcher.run_with(&mut small, l, r, options).unwrap();
    assert!(
        matched.segments().is_empty()
            && matched.candidates().is_empty()
            && matched.health().is_refused()
    );
    assert_eq!(matched.pixel((100, 50)), Err(PixelRejection::UnhealthyPair));
    assert_eq!(matched.points().next(), None);
    let refused = matched.object(&region).map_err(|why| why.reason);
    assert_eq!(refused, Err(Reason::UnhealthyPair));
    for reason in PixelRejection::ALL {
        assert!(!reason.to_string().is_empty() && !reason.name().contains(' '));
    }
}

#[test]
fn metres_come_from_the_rig_and_the_least_probability_from_the_parameters() {
    let pair = pair_of(Plane { at: 12.5, across: 0.0, down: 0.0 }, 3);
    let rig = Rig::new(300.0, 0.1, 0.0).unwrap();
    let params = Params { rig: Some(rig), ..params() };
    let (mut engine, _) = matched(&params, pair.each_ref());
    let mut answered = 0;
    for pixel in grid(DIMS, 7) {
        let Ok(found) = engine.depth_at(pixel) else { continue };
        answered += 1;
        assert_eq!(found.depth, Some(rig.depth(found.disparity)));
        assert_eq!(found.depth_sigma, Some(rig.depth_sigma(found.disparity, found.sigma)));
        assert!(found.confidence >= params.min_confidence && found.sigma > Disparity::ZERO);
    }
    assert!(answered > 100);
}

#[test]
fn memory_and_order_do_not_matter() {
    let [left, right] = Square::pair();
    let (l, r) = (left.view().unwrap(), right.view().unwrap());
    let noise = painted(DIMS.width, DIMS.height, |x, y| {
        Random(u64::from(x) << 16 | u64::from(y)).bits() as u8
    });
    let (mut fresh, mut used) = (Box::new(Small::new()), Box::new(Small::new()));
    let n = noise.view().unwrap();
    let _ = run([n, n], &mut used).pixel((100, 60));
    let (mut fresh, mut used) = (run([l, r], &mut fresh), run([l, r], &mut used));
    let before = answers(&mut used);
    let pixels: Vec<_> = grid(DIMS, 6).collect();
    let forward: Vec<_> = pixels.iter().map(|&pixel| fresh.pixel(pixel)).collect();
    let mut backward: Vec<_> = pixels.iter().rev().map(|&pixel| used.pixel(pixel)).collect();
    backward.reverse();
    assert_eq!(forward, backward);
    // The run's results are still what they were.
    assert!(answers(&mut fresh) == before && answers(&mut used) == before);
}

#[test]
fn a_region_leaves_out_features_of_others() {
    // For any region, an answer inside the square is the square's.
    let (mut engine, _) = matched(&params(), Square::pair().each_ref());
    let region = Region::boxed(1, Square::AREA, DIMS).unwrap();
    let answers = |engine: &mut Engine, region: Option<&Region<'_>>| -> (usize, usize) {
        let inside = grid(DIMS, 3).filter(|&(x, y)| Square::AREA.contains(x.into(), y.into()));
        let mut ask = |pixel| match region {
            Some(region) => engine.ask(|matched| matched.pixel_of(pixel, region)),
            None => engine.depth_at(pixel),
        };
        let found: Vec<_> = inside.filter_map(|pixel| ask(pixel).ok()).collect();
        let wrong = found
            .iter()
            .filter(|f| (f.disparity.to_num::<f64>() - Square::NEAR).abs() > 1.0)
            .count();
        (found.len(), wrong)
    };
    let (without, with) = (answers(&mut engine, None), answers(&mut engine, Some(&region)));
    assert_eq!((without.1, with.1), (0, 0));
    assert!(with.0 >= without.0, "{with:?} of {without:?}");
}

#[test]
fn any_size_range_and_content_gives_an_answer_or_a_reason() {
    let mut random = Random(9);
    for (width, height) in [(16, 16), (17, 40), (33, 16), (64, 48), (300, 18)] {
        for (min_disparity, range) in [(0, 8), (-32, 8), (-5, 60), (0, 250), (0, 15)] {
            let Some(max_disparity) = Some(range).filter(|&range| range < width) else { continue };
            let dims = Dims { width, height };
            let params = Params { min_disparity, max_disparity, ..Params::default() };
            let mut engine = Engine::new(&params, dims).unwrap();
            for content in 0..4 {
                let mut image = || match content {
                    0 => painted(width, height, |_, _| random.bits() as u8),
                    1 => {
                        painted(width, height, |_, _| if random.bits() & 1 == 0 { 0 } else { 255 })
                    }
                    2 => painted(width, height, |x, _| (x % 7 * 36) as u8),
                    _ => painted(width, height, |x, y| ((x + y) * 5) as u8),
                };
                linestereo_tests::run(&mut engine, [&image(), &image()]);
                for pixel in
                    grid(dims, 3).chain([(width - 1, height - 1), (width - 1, 0), (0, height - 1)])
                {
                    if let Ok(found) = engine.depth_at(pixel) {
                        let d = found.disparity.to_num::<f64>();
                        let (low, high) =
                            (f64::from(min_disparity) - 0.5, f64::from(max_disparity) - 0.5);
                        assert!((low..=high).contains(&d), "{dims} {pixel:?}: {d}");
                    }
                }
            }
        }
    }
}

fn asked(scene: &Scene, perturbation: &Perturbation) -> Vec<QueriedPixel> {
    let (left, right) = perturbation.apply(&scene.left, &scene.right);
    let (mut engine, _) = matched(&captured::params(scene), [&left, &right]);
    query_pixels(&mut engine, scene.truth.as_ref().unwrap(), (2000, 1))
}

#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn captured_frames_that_the_model_has_not_seen() {
    let Some(qvga) = captured::qvga() else { return };
    let rooms = captured::scenes("robot_world").unwrap_or_default();
    let rooms: Vec<Scene> = rooms.into_iter().map(|room| without_gloss(room).unwrap()).collect();
    let scenes: Vec<&Scene> = qvga.iter().chain(&rooms).collect();
    // Pairs that are not fit to be used show what models have to tell apart.
    let asked = |scene: &&Scene| {
        let mut engine = captured::engine(scene).answering_unfit();
        linestereo_tests::run(&mut engine, [&scene.left, &scene.right]);
        query_pixels(&mut engine, scene.truth.as_ref().unwrap(), (2000, 1))
    };
    let pixels: Vec<Vec<QueriedPixel>> = scenes.iter().map(asked).collect();
    let scores: Vec<PixelScore> = (0..qvga.len())
        .map(|held| {
            let others: Vec<&[QueriedPixel]> = pixels
                .iter()
                .enumerate()
                .filter(|(i, _)| *i != held)
                .map(|(_, asked)| asked.as_slice())
                .collect();
            PixelScore::new(&pixels[held], &fit_pixels(&others).model)
        })
        .collect();
    let (answered, [_, bad2]) =
        PixelScore::pool(&scores).answered(Params::DEFAULT.min_confidence).unwrap();
    assert!(
        answered >= 60.0 && bad2 <= 1.5,
        "{answered:.1} % answered, {bad2:.2} % of them off by more than 2 px"
    );

    if scenes.len() == 70 {
        let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
        let origin = format!("2000 pixels each of {} scenes ({})", names.len(), names.join(", "));
        let text = pixel_source_text(
            &fit_pixels(&pixels.iter().map(Vec::as_slice).collect::<Vec<_>>()),
            &origin,
        );
        let committed =
            PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../core/src/query/fitted.rs");
        assert_eq!(text, std::fs::read_to_string(committed).unwrap());
    }
}

#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn faults_of_captured_frames_cost_answers_and_not_truth() {
    let Some(scenes) = captured::qvga() else { return };
    let faults = [
        ("noise", Perturbation { noise: 5.0, ..Perturbation::default() }),
        ("darker right image", Perturbation { gain: 0.8, bias: 8.0, ..Perturbation::default() }),
        ("right image 1 px low", Perturbation { row_offset: 1.0, ..Perturbation::default() }),
    ];
    for (name, fault) in faults {
        let score = |scene: &Scene| PixelScore::new(&asked(scene, &fault), &FITTED_PIXEL.model);
        let scores: Vec<PixelScore> = scenes.iter().map(score).collect();
        let (answered, [bad1, bad2]) =
            PixelScore::pool(&scores).answered(Params::DEFAULT.min_confidence).unwrap();
        assert!(
            answered >= 10.0 && bad2 <= 2.0,
            "{name}: {answered:.1} % answered, bad1/bad2 {bad1:.2}/{bad2:.2} %"
        );
    }
}
