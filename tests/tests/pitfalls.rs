//! The pitfalls that the method's source lists, each on images with exact truth.

use linestereo::{Dims, Params};
use linestereo_sim::engine::FrameResult;
use linestereo_sim::scene::{Kind, Rendering, Sensor};
use linestereo_tests::drawn::{painted, rendered_by};
use linestereo_tests::matched;

const DIMS: Dims = Dims { width: 240, height: 180 };

const PARAMS: Params = Params { max_disparity: 48, ..Params::DEFAULT };

fn rendered(kind: Kind, sensor: Sensor) -> Rendering {
    rendered_by(kind, DIMS, 11, &Sensor { seed: 11, ..sensor })
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
            let (_, result) = matched(&PARAMS, [&image; 2]);
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
fn exposure_noise_and_rows_cost_yield_and_not_truth() {
    let base = Sensor { noise: 1.0, ..Sensor::default() };
    let cases = [
        ("clean", base, 1.0),
        ("darker right image", Sensor { gain: 0.8, bias: 8.0, ..base }, 0.7),
        ("brighter right image", Sensor { gain: 1.15, bias: -5.0, ..base }, 0.7),
        ("noise", Sensor { noise: 5.0, ..base }, 0.1),
        ("right image 1 px low", Sensor { row_offset: 1.0, ..base }, 0.8),
        ("right image 1 px high", Sensor { row_offset: -1.0, ..base }, 0.8),
    ];
    let mut clean = 0;
    for (name, sensor, least_yield) in cases {
        let rendering = rendered(Kind::Boxes, sensor);
        let (_, result) = matched(&PARAMS, [&rendering.left, &rendering.right]);
        let (points, visible, all) = score(&rendering, &result);
        clean = clean.max(points);
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
    let [own, mixed] =
        [&a.right, &b.right].map(|right| matched(&PARAMS, [&a.left, right]).1.points.len());
    assert!(mixed * 20 < own, "{mixed} points from two scenes, {own} from one");
}
