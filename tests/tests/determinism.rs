//! The same bits whatever the stride, the padding, the memory's contents, the number of runs and the profile.

use linestereo::{
    Confidence, Dims, Gray, Match, Output, Params, Plan, PointClaim, Rig, Scratch, mark_words, row_bytes,
};
use linestereo_sim::scene::{self, Kind, Sensor};
use linestereo_tests::drawn::with_padding;

const DIMS: Dims = Dims { width: 160, height: 120 };
type Memory =
    Scratch<{ row_bytes(DIMS.width) }, { mark_words(DIMS) }, 512, 512, { linestereo::most_support_points(DIMS) }>;
type Lists = Output<512, 16384>;

/// What `digest` gave for [`scenes`] when it was last looked at. A change that is meant to change the output changes it: run the test and
/// take the number it prints. Debug and release builds are held to the same one.
const BLESSED: u64 = 0x4590_b474_9071_5100;

fn scenes() -> Vec<scene::Rendering> {
    let sensor = Sensor { noise: 1.5, seed: 7, ..Sensor::default() };
    [Kind::Demo, Kind::Boxes, Kind::Corridor]
        .map(|kind| scene::render(&scene::build(kind, DIMS, 7), DIMS, &sensor))
        .into()
}

fn plan() -> Plan {
    let rig = Some(Rig::new(150.0, 0.12, 0.0).unwrap());
    Params { max_disparity: 48, rig, min_confidence: Confidence::from_num(0.5), ..Params::default() }
        .plan(DIMS)
        .unwrap()
}

fn run(memory: &mut Memory, lists: &mut Lists, left: Gray<'_>, right: Gray<'_>) -> (Vec<Match>, Vec<PointClaim>) {
    plan().run(left, right, memory, lists).unwrap();
    (lists.matches.to_vec(), lists.points.to_vec())
}

/// FNV-1a over every number of the result.
fn digest(results: &[(Vec<Match>, Vec<PointClaim>)]) -> u64 {
    let text = format!("{results:?}");
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn nothing_but_the_pixels_matters() {
    let (mut memory, mut lists) = (Box::new(Memory::new()), Box::new(Lists::new()));
    for rendering in scenes() {
        let (left, right) = (rendering.left.view().unwrap(), rendering.right.view().unwrap());
        let expected = run(&mut Box::new(Memory::new()), &mut Box::new(Lists::new()), left, right);
        assert!(expected.0.len() > 10, "only {} matches: nothing is tested", expected.0.len());
        assert_eq!(run(&mut memory, &mut lists, left, right), expected, "memory that held another scene");
        assert_eq!(run(&mut memory, &mut lists, left, right), expected, "again");
        for (padding, fill) in [(1, 0), (13, 255)] {
            let (pixels, stride) = with_padding(&rendering.left, padding, fill);
            let padded = Gray::new(&pixels, DIMS, stride).unwrap();
            assert_eq!(
                run(&mut memory, &mut lists, padded, right),
                expected,
                "{padding} bytes of {fill} after each row"
            );
        }
    }
}

#[test]
fn debug_and_release_give_the_blessed_bits() {
    let (mut memory, mut lists) = (Box::new(Memory::new()), Box::new(Lists::new()));
    let results: Vec<_> = scenes()
        .iter()
        .map(|r| run(&mut memory, &mut lists, r.left.view().unwrap(), r.right.view().unwrap()))
        .collect();
    let found = digest(&results);
    assert_eq!(found, BLESSED, "the output changed; if that is meant, BLESSED is {found:#x}");
}
