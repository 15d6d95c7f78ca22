//! Two cores find the same bits as one, whichever half is done first, and at the same time.

use core::mem::MaybeUninit;
use linestereo::health::HealthLimits;
use linestereo::params::Parts;
use linestereo::{
    Area, Capacity, Cores, Dims, Gray, Matcher, MemorySlice, OneCore, Options, Params,
};
use linestereo_boards::Board;
use linestereo_boards::built_in::Case;
use linestereo_frames::{GrayImage, Perturbation};
use linestereo_sim::scene::Kind;
use linestereo_tests::captured;
use linestereo_tests::drawn::{Random, rendered};

/// Both halves at the same time.
struct Threads;

impl Cores for Threads {
    fn join(&mut self, here: &mut (dyn FnMut() + Send), there: &mut (dyn FnMut() + Send)) {
        std::thread::scope(|scope| {
            scope.spawn(there);
            here();
        });
    }
}

/// The second half before the first.
struct Backwards;

impl Cores for Backwards {
    fn join(&mut self, here: &mut (dyn FnMut() + Send), there: &mut (dyn FnMut() + Send)) {
        there();
        here();
    }
}

/// One way to match a sequence of pairs: a matcher and a memory of its own.
struct Way {
    name: &'static str,
    matcher: Matcher,
    words: Vec<MaybeUninit<u64>>,
    cores: Option<Box<dyn Cores>>,
}

impl Way {
    fn new(
        (name, cores): (&'static str, Option<Box<dyn Cores>>),
        two_cores: bool,
        params: Params,
        dims: Dims,
    ) -> Self {
        let capacity = Capacity { cell: params.cell, two_cores, ..Capacity::new(dims) };
        let mut matcher = Matcher::new(params, dims).unwrap();
        matcher.limits = HealthLimits::DEFAULT;
        Self { name, matcher, words: vec![MaybeUninit::uninit(); capacity.words()], cores }
    }

    /// All that a run says, as text.
    fn run(&mut self, left: Gray<'_>, right: Gray<'_>, areas: Option<&[Area]>) -> String {
        let memory = MemorySlice::new(&mut self.words, 640);
        let options = Options { areas, ..Options::default() };
        let mut matched = match &mut self.cores {
            None => self.matcher.run_with(memory, left, right, options),
            Some(cores) => self.matcher.run_on(&mut &mut **cores, memory, left, right, options),
        }
        .unwrap();
        let health = format!("{:?}", matched.health());
        matched.ignore_health();
        let points: Vec<_> = matched.points().collect();
        let support: Vec<_> = matched.support().iter().collect();
        format!(
            "{health}\n{:?}\n{:?}\n{support:?}\n{:?}\n{:?}\n{:?}\n{points:?}",
            matched.counts(),
            matched.ground(),
            matched.candidates(),
            matched.segments(),
            matched.bars(),
        )
    }
}

/// One core; then two in several ways, with memory for both and without.
fn ways(params: Params, dims: Dims, with_threads: bool) -> Vec<Way> {
    let way = |name, cores, two_cores| Way::new((name, cores), two_cores, params, dims);
    let mut ways = vec![
        way("one core", None, false),
        way("one core, memory for two", None, true),
        way("one after the other", Some(Box::new(OneCore)), true),
        way("backwards", Some(Box::new(Backwards)), true),
        way("backwards, memory for one", Some(Box::new(Backwards)), false),
    ];
    if with_threads {
        ways.push(way("threads", Some(Box::new(Threads)), true));
    }
    ways
}

fn assert_same(ways: &mut [Way], name: &str, images: [Gray<'_>; 2], areas: Option<&[Area]>) {
    let [left, right] = images;
    let mut found = ways.iter_mut().map(|way| (way.name, way.run(left, right, areas)));
    let (_, expected) = found.next().unwrap();
    for (way, found) in found {
        for (line, (found, expected)) in found.lines().zip(expected.lines()).enumerate() {
            assert_eq!(found, expected, "{name}, {way}, line {line}");
        }
    }
}

#[test]
fn built_in_pairs_are_the_same_on_two_cores() {
    for case in Case::all(&Board::MPS2_AN500) {
        let pixels = usize::from(case.dims.width) * usize::from(case.dims.height);
        let [mut left, mut right] = [vec![0; pixels], vec![0; pixels]];
        case.scene.paint(case.dims, &mut left, &mut right);
        let view = |pixels| Gray::new(pixels, case.dims, case.dims.width.into()).unwrap();
        let mut ways = ways(case.params(), case.dims, true);
        assert_same(&mut ways, &case.to_string(), [view(&left), view(&right)], None);
    }
}

/// Damages that fill lists, spend budgets, leave images blank.
const DAMAGES: [(&str, Perturbation); 3] = [
    ("as it is", Perturbation::NONE),
    ("noise", Perturbation { noise: 12.0, ..Perturbation::NONE }),
    ("dark", Perturbation { gain: 0.2, ..Perturbation::NONE }),
];

fn assert_same_in_all_ways(name: &str, left: &GrayImage, right: &GrayImage, params: Params) {
    let Dims { width, height } = left.dims;
    let areas = [
        Area { left: width / 8, top: height / 6, right: width / 3, bottom: height / 2 },
        Area { left: width / 2, top: height / 3, right: width - 4, bottom: height - 9 },
    ];
    let mut ways = ways(params, left.dims, false);
    for (damage, perturbation) in DAMAGES {
        let (left, right) = perturbation.apply(left, right);
        let images = [left.view().unwrap(), right.view().unwrap()];
        assert_same(&mut ways, &format!("{name}, {damage}"), images, None);
        assert_same(&mut ways, &format!("{name}, {damage}, areas"), images, Some(&areas));
    }
}

/// Patches whose outlines are the shortest segments, of any slope: the rows of their windows reach
/// farther than those of others.
#[test]
fn short_edges_are_the_same_on_two_cores() {
    let dims = Dims { width: 200, height: 150 };
    for seed in (0..8).chain([893]) {
        let mut random = Random(seed);
        let mut wall =
            GrayImage { dims: Dims { width: 240, ..dims }, pixels: vec![100; 240 * 150] };
        for _ in 0..150 {
            let mut from = |low: i32, high: i32| low + random.below((high - low) as u64) as i32;
            let (centre, size) = ([from(0, 240), from(0, 150)], from(3, 14));
            let (a, b, grey) = (from(-8, 9), from(-8, 9), from(20, 230) as u8);
            for (y, x) in (-size..size).flat_map(|y| (-size..size).map(move |x| (y, x))) {
                let is_inside =
                    (x * a + y * b).abs() < 4 * size && (x * b - y * a).abs() < 6 * size;
                let [x, y] = [centre[0] + x, centre[1] + y];
                if is_inside && (0..240).contains(&x) && (0..150).contains(&y) {
                    wall.pixels[(y * 240 + x) as usize] = grey;
                }
            }
        }
        let [left, right] = [0, 12].map(|moved| {
            let rows = wall.pixels.chunks(240).flat_map(|row| &row[moved..moved + 200]);
            let noisy = rows.map(|&grey| grey + random.below(8) as u8 - 4);
            GrayImage { dims, pixels: noisy.collect() }
        });
        let params = Params { max_disparity: 32, ..Params::default() };
        let mut ways = ways(params, dims, false);
        let images = [left.view().unwrap(), right.view().unwrap()];
        assert_same(&mut ways, &format!("patches {seed}"), images, None);
    }
}

#[test]
fn drawn_scenes_are_the_same_on_two_cores() {
    let dims = Dims { width: 160, height: 120 };
    for (kind, name) in [(Kind::Demo, "demo"), (Kind::Boxes, "boxes"), (Kind::Corridor, "corridor")]
    {
        let scene = rendered(kind, dims, 1.5, 7);
        for parts in [Parts::Both, Parts::Support] {
            let params = Params { max_disparity: 48, parts, ..Params::default() };
            assert_same_in_all_ways(name, &scene.left, &scene.right, params);
        }
    }
    let large = rendered(Kind::Boxes, Dims { width: 640, height: 480 }, 1.5, 7);
    assert_same_in_all_ways("large", &large.left, &large.right, Params::default());
}

#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn captured_pairs_are_the_same_on_two_cores() {
    let Some(scenes) = captured::qvga() else { return };
    for scene in scenes {
        let params = captured::params(&scene);
        assert_same_in_all_ways(&scene.name, &scene.left, &scene.right, params);
    }
}
