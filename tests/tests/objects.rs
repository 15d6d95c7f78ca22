//! Depth per object: on captured frames against the promises, on drawn scenes against their
//! geometry, and on whatever a detector may say.

use linestereo::objects::{LabelRows, Reason, RegionError, Run};
use linestereo::{
    Area, Capacity, Dims, Matched, NoDepth, ObjectDepth, Options, Params, Region, image::Span,
};
use linestereo_frames::Scene;
use linestereo_lab::evaluate::{ObjectScore, ObjectSummary, Outline, object_cases, score_objects};
use linestereo_sim::engine::{Engine, FittedModels};
use linestereo_sim::results::mask::Mask;
use linestereo_sim::scene::{self, Kind, Pair, Pattern, Rendering, Sensor, Surface, Texture};
use linestereo_tests::drawn::Random;
use linestereo_tests::{captured, matched, run, run_alone};

const DIMS: Dims = Dims { width: 320, height: 240 };

/// Every object of every scene, by models that have not seen the scene.
fn leave_one_out(scenes: &[Scene]) -> Vec<ObjectScore> {
    let score = |(scene, models): (&Scene, &FittedModels)| {
        let mut engine = captured::engine(scene).with_models(*models);
        run(&mut engine, [&scene.left, &scene.right]);
        score_objects(&mut engine, &object_cases(scene).unwrap())
    };
    scenes.iter().zip(captured::models_left_out(scenes)).flat_map(score).collect()
}

#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn captured_objects_keep_the_promises() {
    let Some(scenes) = captured::qvga() else { return };
    let scores = leave_one_out(&scenes);
    // The promises: most wrong answers and least covered objects, in percent.
    let promises = [
        (Outline::Given, 0.0, 86.0),
        (Outline::TooLarge, 1.5, 88.0),
        (Outline::Eroded, 0.0, 78.0),
        (Outline::Box, 10.0, 80.0),
    ];
    for (outline, wrong, covered) in promises {
        let summary = ObjectSummary::pool(outline, &scores);
        if summary.objects == 0 {
            eprintln!("SKIPPED: no objects {}", outline.name());
            continue;
        }
        assert!(
            summary.wrong_percent() <= wrong && summary.covered_percent() >= covered,
            "{summary:?}"
        );
        if outline != Outline::Box {
            assert!(summary.median_relative_error <= Some(0.015), "{summary:?}");
            assert!(
                summary.within_sigma >= Some(0.6) && summary.within_two_sigma >= Some(0.9),
                "{summary:?}"
            );
        }
    }
}

/// A rectangle of the left image, `[left, top, right, bottom]`, with a disparity at its left and
/// one at its right border.
fn card(
    pair: &Pair,
    [left, top, right, bottom]: [f64; 4],
    d: [f64; 2],
    texture: Texture,
    label: u8,
) -> Surface {
    let [near, far] = d.map(|d| pair.depth(d));
    let corner = pair.point(left - 0.5, top - 0.5, near);
    let minus = |a: [f64; 3]| [a[0] - corner[0], a[1] - corner[1], a[2] - corner[2]];
    let across = minus(pair.point(right - 0.5, top - 0.5, far));
    let down = minus(pair.point(left - 0.5, bottom - 0.5, near));
    Surface::rectangle(corner, across, down, texture, label)
}

/// Rectangles of random greys, some 10 px wide at this disparity.
fn mosaic(pair: &Pair, disparity: f64, seed: u64) -> Texture {
    let metres = 10.0 * pair.depth(disparity) / pair.focal_px;
    let pattern = Pattern::Mosaic { greys: [40.0, 220.0], cell: [metres, metres] };
    Texture::grained(pattern, 10.0, 0.2 * metres, seed)
}

fn pair() -> Pair {
    Pair::centred(DIMS, 300.0, 0.1)
}

/// Cards, the nearest first, before a wall of disparity 6.
fn drawn(cards: Vec<Surface>, wall: Texture) -> (Engine, Rendering) {
    let pair = pair();
    let mut surfaces = cards;
    surfaces.push(card(&pair, [-200.0, -200.0, 520.0, 440.0], [6.0; 2], wall, 9));
    let scene = scene::Scene { pair, surfaces, objects: vec!["object"; 9] };
    let drawn = scene::render(&scene, DIMS, &Sensor { noise: 2.0, seed: 3, ..Sensor::default() });
    let params = Params { max_disparity: 48, rig: Some(pair.rig().unwrap()), ..Params::default() };
    (matched(&params, [&drawn.left, &drawn.right]).0, drawn)
}

fn mask_of(drawn: &Rendering, labels: &[u8]) -> Mask {
    Mask::new(DIMS, drawn.labels.iter().map(|label| labels.contains(label)).collect())
}

fn ask(engine: &mut Engine, mask: &Mask) -> Result<ObjectDepth, NoDepth> {
    let runs = mask.runs(1);
    engine.object(&Region::masked(1, &runs, DIMS).unwrap())
}

fn ask_box(
    engine: &mut Engine,
    [left, top, right, bottom]: [u16; 4],
) -> Result<ObjectDepth, NoDepth> {
    let area = Area { left, top, right, bottom };
    engine.object(&Region::boxed(1, area, DIMS).unwrap())
}

#[track_caller]
fn assert_near(found: &Result<ObjectDepth, NoDepth>, disparity: f64, within: f64) {
    let d = found.map(|object| object.disparity.to_num::<f64>());
    assert!(d.is_ok_and(|d| (d - disparity).abs() <= within), "{found:?}, expected {disparity}");
}

#[test]
fn a_slanted_object_has_the_depth_of_its_centre_however_sloppy_its_mask() {
    let pair = pair();
    // 20 px at its left border, 28 at its right one.
    let object = card(&pair, [100.0, 70.0, 200.0, 170.0], [20.0, 28.0], mosaic(&pair, 24.0, 5), 1);
    let (mut engine, drawn) = drawn(vec![object], mosaic(&pair, 6.0, 8));
    let exact = mask_of(&drawn, &[1]);
    for (name, mask) in
        [("exact", exact.clone()), ("too large", exact.grown(2)), ("eroded", exact.eroded(2))]
    {
        let found = ask(&mut engine, &mask);
        let centre = drawn.disparity[120 * usize::from(DIMS.width) + 150];
        assert_near(&found, centre.into(), 0.5);
        let found = found.unwrap();
        let [across, down] = found.slope_q10.map(|slope| f64::from(slope) / 1024.0);
        assert!((0.05..0.11).contains(&across) && down.abs() < 0.02, "{name}: {across}, {down}");
        let metres = found.metres.unwrap();
        let depth = metres.depth.to_num::<f64>();
        assert!((depth - pair.depth(centre.into())).abs() < 0.05, "{name}: {depth} m");
        assert!(metres.nearest < metres.depth && metres.sigma > 0, "{found:?}");
        assert!(found.confidence > 0.9 && found.support >= 10, "{found:?}");
    }
}

#[test]
fn a_box_holds_background_and_is_not_averaged_with_it() {
    let pair = pair();
    // A post that fills a third of its box; more segments lie on the wall behind it.
    let object = card(&pair, [140.0, 60.0, 170.0, 180.0], [22.0; 2], mosaic(&pair, 22.0, 2), 1);
    let (mut engine, _) = drawn(vec![object], mosaic(&pair, 6.0, 3));
    assert_near(&ask_box(&mut engine, [110, 58, 200, 182]), 22.0, 0.3);
    // The wall beside it.
    assert_near(&ask_box(&mut engine, [220, 58, 300, 182]), 6.0, 0.3);
}

#[test]
fn two_surfaces_under_one_mask_are_refused() {
    let pair = pair();
    let left = card(&pair, [80.0, 70.0, 150.0, 170.0], [30.0; 2], mosaic(&pair, 30.0, 4), 1);
    let right = card(&pair, [150.0, 70.0, 220.0, 170.0], [14.0; 2], mosaic(&pair, 14.0, 6), 2);
    let (mut engine, drawn) = drawn(vec![left, right], Texture::plain(Pattern::Blank(120.0)));
    assert_near(&ask(&mut engine, &mask_of(&drawn, &[1])), 30.0, 0.3);
    assert_near(&ask(&mut engine, &mask_of(&drawn, &[2])), 14.0, 0.3);
    let both = ask(&mut engine, &mask_of(&drawn, &[1, 2]));
    assert_eq!(both.map_err(|why| why.reason), Err(Reason::TwoSurfaces));
}

#[test]
fn a_blank_surface_is_not_given_the_depth_of_what_stands_beside_it() {
    let pair = pair();
    // Seen between two posts, a blank wall: every edge of the region belongs to the posts.
    let posts = [[60.0, 20.0, 120.0, 220.0], [190.0, 20.0, 250.0, 220.0]];
    let posts = posts.map(|at| card(&pair, at, [26.0; 2], mosaic(&pair, 26.0, 7), 1)).to_vec();
    let (mut engine, drawn) = drawn(posts, Texture::plain(Pattern::Blank(120.0)));
    let between = (0..DIMS.height).flat_map(|y| (0..DIMS.width).map(move |x| (x, y)));
    let between: Vec<bool> =
        between.map(|(x, y)| (125..185).contains(&x) && (60..180).contains(&y)).collect();
    let between = Mask::new(DIMS, between);
    for mask in [between.clone(), between.grown(5), between.grown(7)] {
        let found = ask(&mut engine, &mask);
        assert!(
            found.is_err_and(|why| {
                matches!(why.reason, Reason::OnlyOutline | Reason::LittleSupport)
            }),
            "{found:?}"
        );
    }
    assert_near(&ask(&mut engine, &mask_of(&drawn, &[1])), 26.0, 0.3);
}

#[test]
fn a_blank_image_supports_nothing() {
    let (mut engine, _) = drawn(Vec::new(), Texture::plain(Pattern::Blank(90.0)));
    let found = ask_box(&mut engine, [0, 0, 320, 240]);
    assert_eq!(found, Err(NoDepth { reason: Reason::LittleSupport, support: 0 }));
}

/// Objects of the scenes that come with the program, which no parameter was chosen on. Not those
/// that repeat a pattern on purpose: claims there agree on the wrong period. Of the others 2 % are
/// wrong today, all of them walls that are blank where claims lie.
#[test]
fn built_in_scenes() {
    let (mut wrong, mut answers, mut asked) = (Vec::new(), 0, 0);
    for kind in Kind::ALL.into_iter().filter(|kind| *kind != Kind::Repetition) {
        for seed in [1, 2] {
            let scene = scene::build(kind, DIMS, seed);
            let drawn =
                scene::render(&scene, DIMS, &Sensor { noise: 2.0, seed, ..Sensor::default() });
            let max_disparity = drawn.search_range().min(128);
            let params = Params { max_disparity, ..Params::default() };
            let (mut engine, _) = matched(&params, [&drawn.left, &drawn.right]);
            for label in 1..=scene.objects.len() as u8 {
                let own = drawn
                    .labels
                    .iter()
                    .zip(&drawn.disparity)
                    .filter(|(l, d)| **l == label && d.is_finite());
                let mut truth: Vec<f32> = own.map(|(_, d)| *d).collect();
                if truth.len() < 400 {
                    continue;
                }
                truth.sort_by(f32::total_cmp);
                let (low, high) =
                    (truth[truth.len() / 20], truth[truth.len() - 1 - truth.len() / 20]);
                for mask in [mask_of(&drawn, &[label]), mask_of(&drawn, &[label]).grown(2)] {
                    asked += 1;
                    let Ok(found) = ask(&mut engine, &mask) else { continue };
                    let d = found.disparity.to_num::<f32>();
                    answers += 1;
                    if d < low - 1.0 || d > high + 1.0 {
                        wrong.push(format!(
                            "{} {seed}, object {label}: {d} of {low} to {high}",
                            kind.name()
                        ));
                    }
                }
            }
        }
    }
    assert!(wrong.len() * 100 <= 3 * answers, "{answers} answers: {wrong:#?}");
    assert!(answers * 10 >= asked * 6, "{answers} of {asked}");
}

/// A plain object that is nearer than the range has no match; the wall behind it is not its depth.
#[test]
fn what_is_nearer_than_the_range_is_not_answered_by_what_is_behind_it() {
    let pair = pair();
    for (left, grey) in [(90, 60.0), (130, 120.0), (150, 200.0)] {
        let [x0, x1] = [left, left + 95].map(f64::from);
        let object =
            card(&pair, [x0, 60.0, x1, 240.0], [100.0; 2], Texture::plain(Pattern::Blank(grey)), 1);
        let (mut engine, drawn) = drawn(vec![object], mosaic(&pair, 6.0, 8));
        let boxed = ask_box(&mut engine, [left, 60, left + 95, 240]);
        let masked = ask(&mut engine, &mask_of(&drawn, &[1]));
        assert!(boxed.is_err() && masked.is_err(), "at {left}: {boxed:?} {masked:?}");
    }
}

#[test]
fn ten_thousand_boxes_are_answered_one_by_one() {
    let pair = pair();
    let object = card(&pair, [100.0, 70.0, 200.0, 170.0], [24.0; 2], mosaic(&pair, 24.0, 5), 1);
    let (mut engine, _) = drawn(vec![object], mosaic(&pair, 6.0, 8));
    let mut random = Random(1);
    let mut below = |of: u64| random.below(of) as u16;
    let regions: Vec<Region<'_>> = (0..10_000)
        .map(|label| {
            let (left, top) = (below(320), below(240));
            let area =
                Area { left, top, right: left + 1 + below(1000), bottom: top + 1 + below(1000) };
            Region::boxed(label, area, DIMS).unwrap()
        })
        .collect();
    let all: Vec<_> = regions.iter().map(|region| engine.object(region)).collect();
    // Neither the others nor what the memory held before matter.
    for i in (0..regions.len()).step_by(199) {
        assert_eq!(engine.object(&regions[i]), all[i]);
    }
}

#[test]
fn objects_leave_the_points_of_the_run_as_they_are() {
    type Memory = linestereo::Memory<{ Capacity { cell: 16, ..Capacity::new(DIMS) }.words() }>;
    let pair = pair();
    let object = card(&pair, [100.0, 70.0, 200.0, 170.0], [24.0; 2], mosaic(&pair, 24.0, 5), 1);
    let (_, drawn) = drawn(vec![object], mosaic(&pair, 6.0, 8));
    let (left, right) = (drawn.left.view().unwrap(), drawn.right.view().unwrap());
    let params = Params { max_disparity: 48, ..Params::default() };
    let mut memory = Box::new(Memory::new());
    let mut matched = run_alone(&params, &mut memory, [left, right], Options::default()).unwrap();
    let points = |matched: &mut Matched<'_>| matched.points().collect::<Vec<_>>();
    let before = points(&mut matched);
    let runs = mask_of(&drawn, &[1]).runs(1);
    let regions =
        [Region::masked(1, &runs, DIMS).unwrap(), Region::boxed(2, Area::of(DIMS), DIMS).unwrap()];
    let first = regions.map(|region| matched.object(&region));
    assert_eq!(points(&mut matched), before);
    assert_eq!(first, regions.map(|region| matched.object(&region)));
}

#[test]
fn label_rows_become_runs_and_count_what_they_drop() {
    let dims = Dims { width: 16, height: 16 };
    let mut runs = heapless::Vec::<Run, 4>::new();
    let mut rows = LabelRows::new(dims, &mut runs);
    rows.push(&[5; 40]); // wider than the image
    rows.push(&[]);
    rows.push(&[0, 1, 1, 2, 2, 0, 1]);
    rows.push(&[3, 0, 3]);
    let run = |label, y, start, end| Run { label, y, span: Span { start, end } };
    assert_eq!(rows.runs(), [run(5, 0, 0, 16), run(1, 2, 1, 3), run(2, 2, 3, 5), run(1, 2, 6, 7)]);
    assert_eq!(rows.dropped(), 2);
    for _ in 0..100 {
        rows.push(&[1; 16]);
    }
    assert_eq!(rows.dropped(), 2 + 12); // 12 rows were left of the image
    assert_eq!(rows.labels().collect::<Vec<_>>(), [1, 2, 5]);
    let region = Region::masked(1, rows.runs(), dims).unwrap();
    assert_eq!(region.area(), Area { left: 1, top: 2, right: 7, bottom: 3 });
    assert_eq!(Region::masked(9, rows.runs(), dims), Err(RegionError::Empty));
}

#[test]
fn regions_of_other_images_are_answered_without_harm() {
    let (mut engine, _) = drawn(Vec::new(), mosaic(&pair(), 6.0, 8));
    let large = Dims { width: 1280, height: 1280 };
    let runs = [Run { label: 1, y: 1279, span: Span { start: 0, end: 1280 } }];
    let mask = Region::masked(1, &runs, large).unwrap();
    let boxed =
        Region::boxed(2, Area { left: 1000, top: 1000, right: 1280, bottom: 1280 }, large).unwrap();
    for region in [mask, boxed] {
        let found = engine.object(&region);
        assert_eq!(found.map_err(|why| why.reason), Err(Reason::LittleSupport));
    }
}
