//! Sizes, contents, capacities and parameters at their limits. The test profile checks every
//! integer overflow.

use core::mem::MaybeUninit;
use linestereo::params::{Margin, ParamError};
use linestereo::results::Rejection;
use linestereo::units::{Confidence, Depth, Disparity};
use linestereo::{
    Capacity, Dims, Gray, Matcher, Memory, MemorySlice, Options, Params, Rig, RunError,
};
use linestereo_sim::engine::{Engine, FrameResult};
use linestereo_sim::results::health::is_fit;
use linestereo_sim::scene::{self, Kind};
use linestereo_tests::drawn::{hard_images, rendered};
use linestereo_tests::{matched, run, run_alone};
use std::collections::HashSet;

/// Every left segment is matched, dropped or rejected for one reason; points are unique, inside, in
/// range and credible enough.
fn check(name: &str, params: &Params, dims: Dims, result: &FrameResult) {
    let counts = result.counts;
    let rejected: u32 =
        Rejection::ALL.iter().map(|&reason| u32::from(counts.rejected(reason))).sum();
    let accounted = u32::from(counts.matched) + rejected;
    assert_eq!(u32::from(counts.segments_left), accounted, "{name}: {counts:?}");
    // A pair that is not fit to be used answers nothing.
    let answered = if is_fit(result.health) { usize::from(counts.matched) } else { 0 };
    assert_eq!(answered, result.matches.len(), "{name}");
    assert_eq!(counts.points as usize, result.points.len(), "{name}");
    let mut seen = HashSet::new();
    for point in &result.points {
        assert!(point.x < dims.width && point.y < dims.height, "{name}: {point:?}");
        assert!(seen.insert((point.x, point.y)), "{name}: {point:?} is claimed twice");
        assert!(point.confidence >= params.min_confidence, "{name}: {point:?}");
    }
    for found in &result.matches {
        assert!(found.confidence >= params.min_confidence, "{name}: {found:?}");
        for d in found.disparity {
            // The line through two halves reaches at most the allowed slant beyond the range.
            assert!(
                d >= params.min_disparity - 6 && d < i32::from(params.max_disparity) + 6,
                "{name}: {found:?}"
            );
        }
    }
    assert!(result.matches.is_sorted_by(|a, b| a.confidence >= b.confidence), "{name}");
}

#[test]
fn any_size_and_any_content() {
    for (width, height) in
        [(16, 16), (17, 16), (31, 47), (1280, 16), (16, 1280), (321, 243), (1280, 1280)]
    {
        let dims = Dims { width, height };
        let largest = 256.min(width - 1);
        for (min_disparity, max_disparity) in
            [(0, 8), (0, largest), (-32, 8.min(largest)), (-32, largest.min(224))]
        {
            let params = Params {
                min_disparity,
                max_disparity,
                min_confidence: Confidence::from_num(0.1),
                reach: 6,
                cell: 8,
                ..Params::default()
            };
            if u32::from(width) * u32::from(height) > 500_000 && max_disparity < largest {
                continue; // the widest range says it all, and takes a second
            }
            let mut engine = Engine::new(&params, dims).unwrap();
            let contents = hard_images(dims, &[4]);
            for (left_name, left) in &contents {
                for (right_name, right) in &contents[..2] {
                    let name = format!(
                        "{dims}, {min_disparity}..{max_disparity}, {left_name} against {right_name}"
                    );
                    check(&name, &params, dims, &run(&mut engine, [left, left]));
                    check(&name, &params, dims, &run(&mut engine, [left, right]));
                    if width > 1000 && height > 1000 {
                        break;
                    }
                }
            }
        }
    }
}

const DIMS: Dims = Dims { width: 160, height: 120 };

fn boxes() -> scene::Rendering {
    rendered(Kind::Boxes, DIMS, 1.0, 3)
}

#[test]
fn with_few_places_segments_come_from_larger_squares_and_all_are_counted() {
    let rendering = boxes();
    let images = [rendering.left.view().unwrap(), rendering.right.view().unwrap()];
    let params = Params { max_disparity: 48, cell: 8, ..Params::default() };
    let fine = Capacity { cell: 8, ..Capacity::new(DIMS) };
    let coarse = Capacity::new(DIMS);
    let [mut many, mut few] =
        [fine, coarse].map(|capacity| vec![MaybeUninit::uninit(); capacity.words()]);
    let [many, few] = [&mut many, &mut few].map(|words| MemorySlice::new(words, coarse.segments));
    let [all, some] =
        [many, few].map(|memory| run_alone(&params, memory, images, Options::default()).unwrap());
    assert!(
        all.candidates().len() > 48 && !some.segments().is_empty() && some.candidates().len() <= 48
    );
    // Every segment is listed or rejected, and each for the reason that was counted.
    for matched in [&all, &some] {
        let counts = matched.counts();
        let rejected: u16 = Rejection::ALL.iter().map(|&reason| counts.rejected(reason)).sum();
        assert_eq!(counts.segments_left, counts.matched + rejected, "{counts:?}");
        assert_eq!(usize::from(counts.matched), matched.segments().len());
        let unclear = matched
            .candidates()
            .iter()
            .filter(|one| one.rejection() == Some(Rejection::EdgeUnclear))
            .count();
        assert_eq!(unclear, usize::from(counts.rejected(Rejection::EdgeUnclear)));
    }
}

#[test]
fn every_parameter_out_of_range_is_named() {
    let base = Params::default();
    let cases = [
        ("min_disparity", Params { min_disparity: 1, ..base }),
        ("min_disparity", Params { min_disparity: -33, ..base }),
        ("max_disparity", Params { max_disparity: 7, ..base }),
        ("max_disparity", Params { max_disparity: 160, ..base }),
        ("max_disparity", Params { max_disparity: 257, ..base }),
        ("anchor_gradient", Params { anchor_gradient: 3, ..base }),
        ("anchor_gradient", Params { anchor_gradient: 1021, ..base }),
        ("edge_gradient", Params { edge_gradient: 3, ..base }),
        ("edge_gradient", Params { edge_gradient: 49, ..base }),
        ("min_extent", Params { min_extent: 5, ..base }),
        ("min_extent", Params { min_extent: 33, ..base }),
        ("cell", Params { cell: 7, ..base }),
        ("cell", Params { cell: 257, ..base }),
        ("reach", Params { reach: 0, ..base }),
        ("reach", Params { reach: 7, ..base }),
        ("min_confidence", Params { min_confidence: Confidence::ZERO, ..base }),
        ("margin", Params { margin: Margin::Pixels(Disparity::ZERO), ..base }),
    ];
    for (field, params) in cases {
        match params.check(DIMS) {
            Err(ParamError::OutOfRange { param, value, low, high }) => {
                assert!(param.name().starts_with(field), "{param:?} is not {field}");
                assert!(
                    !(low..=high).contains(&value),
                    "{field}: {value} is inside {low} to {high}"
                );
            }
            other => panic!("{field}: {other:?}"),
        }
    }
    let metres = Margin::Metres { nearer: Depth::from_num(0.1), farther: Depth::from_num(0.1) };
    assert_eq!(
        Params { margin: metres, ..base }.check(DIMS).err(),
        Some(ParamError::MarginNeedsRig)
    );
    let rig = Some(Rig::new(150.0, 0.12, 0.0).unwrap());
    assert!(Params { margin: metres, rig, ..base }.check(DIMS).is_ok());
}

#[test]
fn a_narrow_margin_in_metres_rejects_what_a_wide_one_accepts() {
    let rendering = boxes();
    let rig = Some(Rig::new(150.0, 0.12, 0.0).unwrap());
    let disagreeing = |metres: f64| {
        let metres = Depth::from_num(metres);
        let margin = Margin::Metres { nearer: metres, farther: metres };
        let params = Params { max_disparity: 48, rig, margin, ..Params::default() };
        let (_, result) = matched(&params, [&rendering.left, &rendering.right]);
        check(&format!("{metres} m"), &params, DIMS, &result);
        result.counts.rejected(Rejection::TechniquesDisagree)
    };
    let (narrow, wide) = (disagreeing(0.005), disagreeing(1000.0));
    assert!(narrow > wide + 10, "{narrow} disagree by 5 mm, {wide} by 1 km");
}

#[test]
fn wrong_sizes_and_too_little_memory_are_refused() {
    let rendering = boxes();
    let (left, right) = (rendering.left.view().unwrap(), rendering.right.view().unwrap());
    let mut matcher = Matcher::new(Params::default(), DIMS).unwrap();
    let mut memory = Box::new(Memory::<{ Capacity::new(DIMS).words() }>::new());
    let other = Dims { width: 160, height: 119 };
    let small = Gray::new(&rendering.left.pixels, other, 160).unwrap();
    let refused = Err(RunError::SizeMismatch { planned: DIMS, given: other });
    assert_eq!(matcher.run(&mut memory, small, right).map(|_| ()), refused);
    assert_eq!(matcher.run(&mut memory, left, small).map(|_| ()), refused);
    assert!(matcher.run(&mut memory, left, right).is_ok());

    const LESS: usize = Capacity::new(DIMS).words() - 1;
    let mut tiny = Box::new(Memory::<LESS>::new());
    let refused = Err(RunError::MemoryTooSmall { needed: LESS + 1, given: LESS });
    assert_eq!(matcher.run(&mut tiny, left, right).map(|_| ()), refused);
}
