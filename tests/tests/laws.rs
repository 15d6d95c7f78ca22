//! Laws of the method on drawn scenes: what another brightness, a larger range of disparities, a
//! shift or a mirror changes.
//!
//! Brightness changes no bit. The others change bits: edges have a position every second pixel,
//! support points one every eighth, segments are chosen in cells of 20 px, costs are summed along
//! paths from the borders, and edges are those of the left image, which a mirror makes the right
//! one. What holds is that no surface is given another disparity: what is there in both results
//! agrees, but for few points beside jumps of depth. Two results of 90 % each may contradict each
//! other at up to 20 % of the points; at most a tenth of that is allowed here. Upside down it is
//! 2.1 % of the corridor's points (paths of costs run down alone): no law.

use linestereo::results::{Match, Point, Source};
use linestereo::{Capacity, Dims, Options, Params};
use linestereo_frames::GrayImage;
use linestereo_tests::drawn::{painted, scenes};
use linestereo_tests::reference::at;
use linestereo_tests::{answers, run_alone};
use std::collections::HashMap;

const DIMS: Dims = Dims { width: 240, height: 160 };
/// Rendered, so that images can be cut out at several places.
const WHOLE: Dims = Dims { width: DIMS.width + 40, height: DIMS.height + 40 };
type Memory = linestereo::Memory<{ Capacity::new(DIMS).words() }>;
type Pair = [GrayImage; 2];

fn pairs() -> impl Iterator<Item = Pair> {
    scenes(WHOLE).map(|scene| [scene.left, scene.right])
}

/// Both images, each pixel from another place.
fn moved(pair: &Pair, from: impl Fn(u16, u16) -> (u16, u16)) -> Pair {
    pair.each_ref().map(|image| {
        painted(DIMS.width, DIMS.height, |x, y| {
            let (x, y) = from(x, y);
            at(image, x.into(), y.into()) as u8
        })
    })
}

fn run([left, right]: &Pair, max_disparity: u16) -> (Vec<Match>, Vec<Point>) {
    let params = Params { max_disparity, ..Params::default() };
    let mut memory = Box::new(Memory::new());
    let images = [left.view().unwrap(), right.view().unwrap()];
    answers(&mut run_alone(&params, &mut memory, images, Options::default()).unwrap())
}

/// Two results compared, of the points of one that are expected well inside the other's image.
struct Agreement {
    /// Share of these that have a point there, per thousand.
    kept: usize,
    /// Share of those whose disparities differ by more than 1 px, per thousand.
    off: usize,
}

impl Agreement {
    /// Without points of the outer 16 px, which borders reach.
    fn of(one: &[Point], other: &[Point], expected: impl Fn(&Point) -> (i32, i32)) -> Self {
        let there: HashMap<_, _> =
            other.iter().map(|p| ((i32::from(p.x), i32::from(p.y)), p.disparity)).collect();
        let inside = |(x, y)| {
            (16..i32::from(DIMS.width) - 16).contains(&x)
                && (16..i32::from(DIMS.height) - 16).contains(&y)
        };
        let expected: Vec<_> = one
            .iter()
            .map(|point| (point, expected(point)))
            .filter(|&(_, at)| inside(at))
            .collect();
        let both: Vec<_> = expected
            .iter()
            .filter_map(|(point, at)| Some(there.get(at)?.abs_diff(point.disparity)))
            .collect();
        assert!(both.len() > 1000, "{} points: nothing is tested", both.len());
        let off = both.iter().filter(|&&apart| apart > 1).count();
        Self { kept: 1000 * both.len() / expected.len(), off: (1000 * off).div_ceil(both.len()) }
    }
}

#[test]
fn brightness_changes_nothing() {
    for pair in pairs() {
        let pair = moved(&pair, |x, y| (x, y));
        let brighter = |by: [u8; 2]| {
            let mut pair = pair.clone();
            for (image, by) in pair.iter_mut().zip(by) {
                // Nothing is cut off at white.
                image.pixels.iter_mut().for_each(|pixel| *pixel = (*pixel).min(225) + by);
            }
            run(&pair, 48)
        };
        let expected = brighter([0, 0]);
        assert!(expected.0.len() > 40, "{} matches", expected.0.len());
        for by in [[30, 30], [0, 30], [7, 0]] {
            assert!(brighter(by) == expected, "by {by:?}");
        }
    }
}

#[test]
fn a_larger_range_keeps_a_disparity_or_refuses_it() {
    for pair in pairs() {
        let pair = moved(&pair, |x, y| (x, y));
        let (matches, points) = run(&pair, 48);
        // A bar that is doubtful in a larger range is refused with all of its pixels.
        let of_bars = |point: &&Point| point.source == Source::Side;
        let others: Vec<Point> = points.iter().filter(|point| !of_bars(point)).copied().collect();
        for range in [49, 64, 96] {
            let (found, more) = run(&pair, range);
            for (points, least) in [(&points, 900), (&others, 950)] {
                let Agreement { kept, off } =
                    Agreement::of(points, &more, |point| (point.x.into(), point.y.into()));
                assert!(off == 0 && kept >= least, "to {range} px: {kept} kept, {off} off");
            }
            let again = |one: &&Match| found.iter().any(|other| other.ends == one.ends);
            assert!(
                2 * matches.iter().filter(again).count() > matches.len(),
                "too few are matched again"
            );
            for one in &matches {
                for other in found.iter().filter(|other| other.ends == one.ends) {
                    let apart =
                        one.disparity.iter().zip(other.disparity).map(|(a, b)| a.abs_diff(b));
                    assert!(apart.max().unwrap() <= 1, "{one:?} is {other:?}");
                }
            }
        }
    }
}

#[test]
fn a_shift_moves_what_is_found() {
    for pair in pairs() {
        let (_, points) = run(&moved(&pair, |x, y| (x, y)), 48);
        for (dx, dy) in [(40, 40), (8, 0), (0, 8), (1, 0), (3, 5)] {
            let (_, found) = run(&moved(&pair, |x, y| (x + dx, y + dy)), 48);
            let Agreement { kept, off } = Agreement::of(&points, &found, |point| {
                (i32::from(point.x) - i32::from(dx), i32::from(point.y) - i32::from(dy))
            });
            // Where the grid falls on other pixels, its points stand in the middle of other
            // windows' texture.
            let least = if dx % 8 == 0 && dy % 8 == 0 { 500 } else { 450 };
            assert!(off <= 20 && kept >= least, "by {dx}, {dy} px: {kept} kept, {off} off");
        }
    }
}

#[test]
fn a_mirror_swaps_the_cameras() {
    let last = i32::from(DIMS.width) - 1;
    for pair in pairs() {
        let (_, points) = run(&moved(&pair, |x, y| (x, y)), 48);
        let [left, right] = moved(&pair, |x, y| (DIMS.width - 1 - x, y));
        let (_, found) = run(&[right, left], 48);
        let Agreement { kept, off } = Agreement::of(&points, &found, |point| {
            (last - i32::from(point.x) + point.disparity.round().to_num::<i32>(), point.y.into())
        });
        // Where the border cuts disparities off, a window that repeats further right in the left
        // image is no point, and left and right are exchanged.
        assert!(off <= 20 && kept >= 480, "{kept} kept, {off} off");
    }
}
