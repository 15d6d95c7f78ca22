//! Poles before walls, drawn with exact truth.

use core::ops::Range;
use linestereo::units::Disparity;
use linestereo::{Dims, Params, Region, image::Span, objects::Run};
use linestereo_frames::GrayImage;
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_tests::drawn::{Random, painted};
use linestereo_tests::matched;

const DIMS: Dims = Dims { width: 320, height: 240 };
const WALL: i32 = 8;

/// A pole: first column, columns, disparity; over all rows but 30 at the top and at the bottom.
pub(crate) type Pole = (i32, i32, i32);

/// A wall with a random grain, and poles before it.
pub(crate) fn pair(poles: &[Pole], seed: u64) -> [GrayImage; 2] {
    pair_of(poles, seed, 0..0, |_| 50)
}

/// The same, the wall blank in these columns, the poles of this grey level at each row.
fn pair_of(
    poles: &[Pole],
    seed: u64,
    blank: Range<i32>,
    grey_at: impl Fn(i32) -> i32,
) -> [GrayImage; 2] {
    let grain = |x: i32, y: i32| {
        if blank.contains(&x) {
            return 45;
        }
        let smooth = |x: i32, y: i32| {
            (Random(seed ^ ((x / 2) as u64 * 7919) ^ ((y / 2) as u64 * 104_729)).bits() >> 59)
                as i32
        };
        smooth(x, y) + smooth(x + 1, y) + smooth(x, y + 1)
    };
    let noise = |x: i32, y: i32, eye: u64| {
        (Random(seed ^ eye ^ (x as u64 * 31 + y as u64 * 65_537)).bits() >> 62) as i32
    };
    [0, 1].map(|eye: i32| {
        painted(DIMS.width, DIMS.height, |x, y| {
            let (x, y) = (i32::from(x), i32::from(y));
            let of = |&&(start, width, d): &&Pole| {
                (start..start + width).contains(&(x + eye * d)) && (30..210).contains(&y)
            };
            let is_pole = poles.iter().any(|pole| of(&pole));
            let grey = if is_pole { grey_at(y) } else { 90 + grain(x + eye * WALL, y) };
            (grey + noise(x, y, eye as u64)) as u8
        })
    })
}

fn run(pair: &[GrayImage; 2]) -> (Engine, FrameResult) {
    matched(&Params::default(), pair.each_ref())
}

#[test]
fn poles_have_their_own_disparity() {
    for (seed, width) in [(1, 3), (2, 5), (3, 8), (4, 12)] {
        let (start, d) = (150, 24);
        let (mut engine, result) = run(&pair(&[(start, width, d)], seed));
        let rows: usize =
            result.bars.iter().map(|bar| usize::from(bar.rows()[1] - bar.rows()[0])).sum();
        assert!(rows >= 90, "{width} px: {rows} rows");
        for bar in &result.bars {
            let near = |value: f64, of: i32| (value - f64::from(of)).abs() <= 1.0;
            assert!(bar.disparity().iter().all(|at| near(at.to_num(), d)), "{bar:?}");
            assert!(
                near(bar.ends()[0].x.to_num(), start) && near(bar.width().to_num(), width),
                "{bar:?}"
            );
        }
        // Its pixels, and those beside it.
        let bar = result.bars.iter().max_by_key(|bar| bar.rows()[1] - bar.rows()[0]).unwrap();
        let [first, last] = bar.rows();
        let y = first.midpoint(last);
        for x in bar.columns(y) {
            let found = engine.depth_at((x, y)).unwrap();
            assert!(
                (found.disparity.to_num::<f64>() - f64::from(d)).abs() <= 1.0,
                "{x}, {y}: {found:?}"
            );
        }
        let found = by_mask(&mut engine, &[(start, width, d)]);
        assert!((found - f64::from(d)).abs() <= 1.0, "{width} px: {found}");
    }
}

/// Disparity of poles by one mask, px.
fn by_mask(engine: &mut Engine, poles: &[Pole]) -> f64 {
    let runs: Vec<Run> = (30..210)
        .flat_map(|y| {
            poles.iter().map(move |&(start, width, _)| {
                let span = Span { start: start as u16, end: (start + width) as u16 };
                Run { label: 1, y, span }
            })
        })
        .collect();
    engine.object(&Region::masked(1, &runs, DIMS).unwrap()).unwrap().disparity.to_num()
}

#[test]
fn a_mask_answers_where_no_bar_is_found() {
    let dashed = |y: i32| if y % 8 < 3 { 50 } else { 136 };
    let of_mask = |poles: &[Pole], seed: u64, grey: Option<i32>| {
        let grey_at = |y: i32| grey.unwrap_or(dashed(y));
        let (mut engine, result) = run(&pair_of(poles, seed, 0..0, grey_at));
        assert!(result.bars.is_empty(), "{:?}", result.bars);
        let found = by_mask(&mut engine, poles);
        assert!((found - 24.0).abs() <= 1.0, "{poles:?}: {found}");
    };
    for (seed, width, grey) in [(7, 4, Some(110)), (9, 10, Some(120)), (7, 4, None), (8, 6, None)] {
        of_mask(&[(150, width, 24)], seed, grey);
    }
    // Two legs of a table, unlike each other: equal ones repeat.
    for (seed, width) in [(7, 4), (8, 6)] {
        of_mask(&[(150, width, 24), (260, width + 2, 24)], seed, None);
    }
}

/// One piece is not enough, and a hole in its mask makes no second one of it.
#[test]
fn a_hole_confirms_nothing() {
    let grey_at = |y: i32| if y % 8 < 3 { 50 } else { 136 };
    let (mut engine, _) = run(&pair_of(&[(150, 8, 24)], 8, 0..0, grey_at));
    let mut answers = |top: u16, spans: &[(u16, u16)]| {
        let rows = top..top + 12;
        let run_of = |y| spans.iter().map(move |&(start, end)| (y, Span { start, end }));
        let runs: Vec<Run> =
            rows.flat_map(run_of).map(|(y, span)| Run { label: 1, y, span }).collect();
        engine.object(&Region::masked(1, &runs, DIMS).unwrap()).is_ok()
    };
    for top in (30..198).step_by(6) {
        let whole = answers(top, &[(150, 158)]);
        for hole in 0..=2 {
            assert_eq!(answers(top, &[(150, 154), (154 + hole, 158)]), whole, "row {top}: {hole}");
        }
    }
}

#[test]
fn a_wide_mask_that_nothing_else_answers_has_the_depth_of_its_bars() {
    // A table's side, which is blank between its legs.
    let poles = [(110, 5, 24), (210, 5, 24)];
    let (mut engine, result) = run(&pair_of(&poles, 3, 118..207, |_| 50));
    assert!(!result.bars.is_empty());
    let found = by_mask(&mut engine, &[(110, 105, 24)]);
    assert!((found - 24.0).abs() <= 1.0, "{found}");
}

#[test]
fn a_fence_and_a_print_have_no_bars() {
    let fence: Vec<Pole> = (0..14).map(|k| (60 + 16 * k, 5, 24)).collect();
    for (poles, seed) in [(&fence[..], 5), (&[(150, 6, WALL)], 6)] {
        let (_, result) = run(&pair(poles, seed));
        assert!(result.bars.is_empty(), "{poles:?}: {:?}", result.bars);
    }
}

/// The disparities of poles and wall differ by the distance from pole to pole, or the border hides
/// where a pole stands: windows match poles and gaps at a wrong disparity.
#[test]
fn no_point_and_no_wrong_pixel_is_told_on_a_fence() {
    for (first, apart, width, d) in [(60, 16, 5, WALL + 16), (60, 12, 3, WALL + 12), (4, 24, 6, 45)]
    {
        let fence: Vec<Pole> = (0..8).map(|k| (first + apart * k, width, d)).collect();
        let (mut engine, result) = run(&pair(&fence, 5));
        let is_on_pole = |x: i32, y: i32| {
            (30..210).contains(&y) && fence.iter().any(|&(at, ..)| (at..at + width).contains(&x))
        };
        let on_poles: Vec<_> = result
            .points
            .iter()
            .filter(|point| is_on_pole(point.x.into(), point.y.into()))
            .collect();
        assert!(on_poles.is_empty(), "{apart} px: {} {:?}", on_poles.len(), on_poles[0]);
        // Nobody knows which pole a pixel's window matches.
        for &(x, width, _) in &fence {
            for y in (50..200).step_by(10) {
                let found = engine.depth_at(((x + width / 2) as u16, y));
                let is_wrong = found.as_ref().is_ok_and(|found| {
                    found.confidence > 0.9 && (found.disparity - Disparity::from_num(d)).abs() > 1
                });
                assert!(!is_wrong, "{apart} px: {x}, {y}: {found:?}");
            }
        }
    }
}
