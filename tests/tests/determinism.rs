//! The same bits whatever the stride, the padding, the memory's contents, the number of runs and
//! the profile.

use linestereo::results::{Match, Point};
use linestereo::unstable::{Stage, StageDigests};
use linestereo::{Capacity, Dims, Gray, Options, Params, Rig, units::Confidence};
use linestereo_tests::drawn::{scenes, with_padding};
use linestereo_tests::{answers, run_alone};

const DIMS: Dims = Dims { width: 160, height: 120 };
type Memory = linestereo::Memory<{ Capacity::new(DIMS).words() }>;

/// Digests of the values of all matches and points of [`scenes`], names left out. A change that is
/// meant to change the output changes them: run the test and take the numbers it prints. Debug and
/// release builds are held to the same ones.
const BLESSED: [u32; 3] = [0xdb5c_c820, 0x21fe_23df, 0x18aa_1b33];

fn params() -> Params {
    let rig = Some(Rig::new(150.0, 0.12, 0.0).unwrap());
    Params {
        max_disparity: 48,
        rig,
        min_confidence: Confidence::from_num(0.5),
        ..Params::default()
    }
}

fn run(memory: &mut Memory, left: Gray<'_>, right: Gray<'_>) -> (Vec<Match>, Vec<Point>) {
    answers(&mut run_alone(&params(), memory, [left, right], Options::default()).unwrap())
}

#[test]
fn nothing_but_the_pixels_matters() {
    let mut memory = Box::new(Memory::new());
    for rendering in scenes(DIMS) {
        let (left, right) = (rendering.left.view().unwrap(), rendering.right.view().unwrap());
        let expected = run(&mut Box::new(Memory::new()), left, right);
        assert!(expected.0.len() > 10, "only {} matches: nothing is tested", expected.0.len());
        assert_eq!(run(&mut memory, left, right), expected, "memory that held another scene");
        assert_eq!(run(&mut memory, left, right), expected, "again");
        for (padding, fill) in [(1, 0), (7, 90), (13, 255)] {
            let [left, right] =
                [&rendering.left, &rendering.right].map(|image| with_padding(image, padding, fill));
            let view = |(pixels, stride)| Gray::new(pixels, DIMS, stride).unwrap();
            let found = run(&mut memory, view((&left.0, left.1)), view((&right.0, right.1)));
            assert_eq!(found, expected, "{padding} bytes of {fill} after each row");
        }
    }
}

#[test]
fn debug_and_release_give_the_blessed_bits() {
    let mut memory = Box::new(Memory::new());
    let found: Vec<u32> = scenes(DIMS)
        .map(|rendering| {
            let images = [rendering.left.view().unwrap(), rendering.right.view().unwrap()];
            let mut digests = StageDigests::new();
            let options = Options { observer: Some(&mut digests), ..Options::default() };
            let mut matched = run_alone(&params(), &mut memory, images, options).unwrap();
            matched.points().for_each(|point| digests.add_point(&point));
            digests.of(Stage::Report)
        })
        .collect();
    assert_eq!(found, BLESSED, "the output changed; if that is meant, BLESSED is {found:#x?}");
}
