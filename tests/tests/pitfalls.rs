//! The pitfalls that the method's source lists, each on images with exact truth.

use linestereo::{Dims, Params};
use linestereo_frames::GrayImage;
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_sim::scene::{self, Kind, Rendering, Sensor};
use linestereo_tests::drawn::painted;

const DIMS: Dims = Dims { width: 240, height: 180 };

fn run(left: &GrayImage, right: &GrayImage) -> FrameResult {
    let params = Params { max_disparity: 48, ..Params::default() };
    Engine::new(&params, left.dims)
        .unwrap()
        .run(left.view().unwrap(), right.view().unwrap())
        .unwrap()
}

fn rendered(kind: Kind, sensor: Sensor) -> Rendering {
    scene::render(&scene::build(kind, DIMS, 11), DIMS, &Sensor { seed: 11, ..sensor })
}

/// Points, and the share of them more than 1 px off among those that are visible in both images,
/// and among all.
fn score(rendering: &Rendering, result: &FrameResult) -> (usize, f64, f64) {
    let place = |x: u16, y: u16| usize::from(y) * usize::from(DIMS.width) + usize::from(x);
    let wrong: Vec<(bool, bool)> = result
        .points
        .iter()
        .map(|p| {
            let error = (p.disparity.to_num::<f32>() - rendering.disparity[place(p.x, p.y)]).abs();
            (error > 1.0, rendering.visible[place(p.x, p.y)])
        })
        .collect();
    let share = |of: &mut dyn Iterator<Item = bool>| {
        let all: Vec<bool> = of.collect();
        all.iter().filter(|&&w| w).count() as f64 / all.len().max(1) as f64
    };
    let visible = share(&mut wrong.iter().filter(|(_, visible)| *visible).map(|(w, _)| *w));
    (wrong.len(), visible, share(&mut wrong.iter().map(|(w, _)| *w)))
}

#[test]
fn repeated_structure_is_not_placed() {
    for period in [3_u16, 4, 6, 8, 12] {
        let columns = painted(240, 180, |x, _| if (x / period) % 2 == 0 { 40 } else { 210 });
        let board =
            painted(240, 180, |x, y| if (x / period + y / period) % 2 == 0 { 40 } else { 210 });
        for (name, image) in [("columns", columns), ("checkerboard", board)] {
            let result = run(&image, &image);
            // The images are the same, so 0 is the truth. Only next to the left border may it be
            // claimed: there every other candidate, one repetition further left, lies outside the
            // right image.
            for point in &result.points {
                let alone = point.x <= 2 * period + 16 && point.disparity.abs() <= 1;
                assert!(alone, "{name} of {period} px: {point:?}");
            }
            // Squares smaller than a segment hold none.
            let testable = name == "columns" || period >= 8;
            assert!(
                !testable || result.counts.segments_left > 0,
                "{name} of {period} px: nothing was tested"
            );
        }
    }
}

#[test]
fn blank_texture_is_not_placed() {
    let result = run(&painted(240, 180, |_, _| 90), &painted(240, 180, |_, _| 90));
    assert_eq!((result.matches.len(), result.points.len()), (0, 0));
}

#[test]
fn exposure_noise_and_rows_cost_yield_and_not_truth() {
    let cases = [
        ("clean", Sensor { noise: 1.0, ..Sensor::default() }, 1.0),
        (
            "darker right image",
            Sensor { noise: 1.0, gain: 0.8, bias: 8.0, ..Sensor::default() },
            0.7,
        ),
        (
            "brighter right image",
            Sensor { noise: 1.0, gain: 1.15, bias: -5.0, ..Sensor::default() },
            0.7,
        ),
        ("noise", Sensor { noise: 5.0, ..Sensor::default() }, 0.1),
        ("right image 1 px low", Sensor { noise: 1.0, row_offset: 1.0, ..Sensor::default() }, 0.8),
        (
            "right image 1 px high",
            Sensor { noise: 1.0, row_offset: -1.0, ..Sensor::default() },
            0.8,
        ),
    ];
    let mut clean = 0;
    for (name, sensor, least_yield) in cases {
        let rendering = rendered(Kind::Boxes, sensor);
        let (points, visible, all) = score(&rendering, &run(&rendering.left, &rendering.right));
        clean = clean.max(points);
        println!(
            "{name}: {points} points, {:.2} % wrong of the visible, {:.2} % of all",
            100.0 * visible,
            100.0 * all
        );
        assert!(points as f64 >= least_yield * clean as f64, "{name}: {points} points of {clean}");
        // Claims say 0.9 and more; a few per cent is what that allows, and what one look-alike
        // costs on a small scene.
        assert!(
            visible <= 0.04 && all <= 0.05,
            "{name}: {visible:.3} of the visible, {all:.3} of all are wrong"
        );
    }
    assert!(clean > 1000, "only {clean} points: nothing is tested");
}

#[test]
fn images_that_do_not_belong_together_give_next_to_nothing() {
    let (a, b) =
        (rendered(Kind::Boxes, Sensor::default()), rendered(Kind::Cards, Sensor::default()));
    let own = run(&a.left, &a.right).points.len();
    let mixed = run(&a.left, &b.right).points.len();
    assert!(mixed * 20 < own, "{mixed} points from two scenes, {own} from one");
}
