//! Scenes whose depths are known, seen by two cameras with lenses: the board's segments are those
//! of the PC, bit for bit, and those of the scene.

use super::super::{Run, frames_of, hex, host, rig};
use super::execute;
use linestereo::params::{Margin, Parts};
use linestereo::units::{Confidence, Depth, Disparity};
use linestereo::{Dims, Options, results::Match};
use linestereo_boards::Board;
use linestereo_firmware::boards::stm32h743::BoardMemory;
use linestereo_firmware::memory::Memory;
use linestereo_firmware::session::{Reply, Session};
use linestereo_frames::Truth;
use linestereo_lab::evaluate::FrameScore;
use linestereo_rig::{Calibration, Camera, CameraSide, Lens, Rectification, RigImage, View};
use linestereo_sim::engine::FrameResult;
use linestereo_sim::scene::{self, Kind, Pair, Rendering, Sensor};
use linestereo_tests::drawn::painted;
use linestereo_tests::fuzz::sealed;
use linestereo_tests::reference::bilinear;
use linestereo_wire::{
    Command, Health, MAX_REGIONS, ObjectRecord, Outcome, ParamUpdate, Refusal, RegionBox, Regions,
    Request, RigBytes, RigFault, RigUpdate, name,
};
use serde_json::{Value, json};
use std::sync::LazyLock;

const QVGA: Dims = Dims { width: 320, height: 240 };

/// Two cameras that look past each other a little, and how they are rectified.
struct Lenses {
    calibration: Calibration,
    /// Size of rectified images.
    dims: Dims,
    view: View,
    /// Disparities, px.
    range: (i16, u16),
}

impl Lenses {
    fn new(
        lenses: [Lens; 2],
        focal: f64,
        rotation: [f64; 4],
        (dims, view): (Dims, View),
        range: (i16, u16),
    ) -> Self {
        let [left, right] =
            [(lenses[0], [161.5, 117.25]), (lenses[1], [157.0, 121.75])].map(|(lens, centre)| {
                Camera::new(QVGA, [focal, 1.002 * focal], centre, 0.0, lens).unwrap()
            });
        Self {
            calibration: Calibration::new(left, right, rotation, [-0.12, 0.0006, 0.001]).unwrap(),
            dims,
            view,
            range,
        }
    }

    fn rig(&self) -> RigImage {
        RigImage::new(self.calibration, self.dims, self.view, self.range).unwrap()
    }

    fn rectification(&self) -> Rectification {
        self.calibration.rectify(self.dims, self.view).unwrap()
    }
}

/// A scene: what is true of it, what both cameras send, and boxes around its objects.
struct Shown {
    truth: Rendering,
    raw: [Vec<u8>; 2],
    boxes: Vec<RegionBox>,
}

/// A scene is rendered wider by this on all sides, px, before the lenses' positions are read out of
/// it.
const MARGIN: u16 = 40;

impl Shown {
    fn new(kind: Kind, lenses: &Lenses) -> Self {
        let (dims, rectification) = (lenses.dims, &lenses.rectification());
        let (focal_px, baseline_m, centre) =
            (rectification.focal(), rectification.baseline(), rectification.centre());
        let mut scene = scene::build(kind, dims, 7);
        scene.pair = Pair { focal_px, baseline_m, centre, disparity_offset_px: 0.0 };
        let truth = scene::render(&scene, dims, &Sensor::default());
        let wider = |at: f64| at + f64::from(MARGIN);
        scene.pair.centre = centre.map(wider);
        let dims = Dims { width: dims.width + 2 * MARGIN, height: dims.height + 2 * MARGIN };
        let wide =
            scene::render(&scene, dims, &Sensor { noise: 2.0, seed: 7, ..Sensor::default() });
        let raw = CameraSide::BOTH.map(|eye| {
            let image = if eye == CameraSide::Left { &wide.left } else { &wide.right };
            // Frames get lighter by up to 3.
            let grey = |at: [f64; 2]| bilinear(image, at.map(wider)).round().min(250.0) as u8;
            let raw = painted(QVGA.width, QVGA.height, |x, y| {
                rectification.rectified(eye, [x.into(), y.into()]).map_or(0, grey)
            });
            raw.pixels
        });
        let boxes = boxes(&truth, scene.objects.len());
        Self { truth, raw, boxes }
    }
}

/// Boxes around the objects of a scene that are in view, the largest first.
fn boxes(truth: &Rendering, objects: usize) -> Vec<RegionBox> {
    let mut boxes = Vec::new();
    for label in 1..=objects as u16 {
        let none = RegionBox { label, left: u16::MAX, top: u16::MAX, right: 0, bottom: 0 };
        let (mut count, mut of) = (0, none);
        for (x, y) in pixels(truth.left.dims).filter(|&at| label_at(truth, at) == label) {
            count += 1;
            (of.left, of.right) = (of.left.min(x), of.right.max(x + 1));
            (of.top, of.bottom) = (of.top.min(y), of.bottom.max(y + 1));
        }
        if count > 100 {
            boxes.push((count, of));
        }
    }
    boxes.sort_by_key(|&(count, of)| (core::cmp::Reverse(count), of.label));
    boxes.into_iter().map(|(_, of)| of).take(MAX_REGIONS).collect()
}

fn pixels(dims: Dims) -> impl Iterator<Item = (u16, u16)> {
    (0..dims.height).flat_map(move |y| (0..dims.width).map(move |x| (x, y)))
}

fn label_at(truth: &Rendering, (x, y): (u16, u16)) -> u16 {
    truth.label((x.into(), y.into())).unwrap().into()
}

/// The lenses, and what is seen through them.
static LENSES: LazyLock<[(Lenses, &[Kind]); 3]> = LazyLock::new(|| {
    let barrel = |k: [f64; 3]| Lens::BrownConrady { k, p: [8e-4, -5e-4] };
    let first = Lenses::new(
        [barrel([-0.3, 0.1, -0.01]), barrel([-0.28, 0.09, 0.0])],
        250.0,
        [0.9998, 0.004, 0.006, 0.016],
        (QVGA, View::Alpha(0.25)),
        (0, 96),
    );
    let second = Lenses::new(
        [
            Lens::Fisheye { k: [0.02, -0.01, 0.0, 0.0] },
            Lens::Fisheye { k: [0.025, -0.012, 0.0, 0.0] },
        ],
        150.0,
        [0.9999, -0.008, 0.003, -0.01],
        (QVGA, View::Alpha(0.0)),
        (-3, 58),
    );
    // Half of the size, for speed, from lenses that need a mesh as fine as the board has room for.
    let third = Lenses::new(
        [
            Lens::Fisheye { k: [0.05, -0.03, 0.01, 0.0] },
            Lens::Fisheye { k: [0.05, -0.03, 0.01, 0.0] },
        ],
        140.0,
        [0.9999, 0.005, 0.002, 0.006],
        (Dims { width: 162, height: 106 }, View::Alpha(0.0)),
        (0, 40),
    );
    [
        (first, &[Kind::Demo, Kind::Cards, Kind::Repetition]),
        (second, &[Kind::Corridor, Kind::Poles, Kind::Blank]),
        (third, &[Kind::Boxes]),
    ]
});

static SHOWN: LazyLock<Vec<Shown>> = LazyLock::new(|| {
    let all = LENSES
        .iter()
        .flat_map(|(lenses, kinds)| kinds.iter().map(move |&kind| Shown::new(kind, lenses)));
    all.collect()
});

/// When the board gets its first orders and the first scene is shown, for how long each is, and
/// when a pair with its boxes has come: a whole one before it, after a rig.
const ORDERS_US: u64 = 70_000;
const FIRST_US: u64 = 210_000;
const SCENE_US: u64 = 320_000;
const SETTLED_US: u64 = 200_000;

fn start_us(scene: usize) -> u64 {
    FIRST_US + SCENE_US * scene as u64
}

/// Boxes asked for when a scene is shown. Some scenes are matched in the boxes of their smallest
/// objects alone.
fn regions(kind: Kind, shown: &Shown) -> Request {
    let only = kind == Kind::Corridor; // once a whole pair has been matched
    let of = if only { &shown.boxes[4..] } else { &shown.boxes[..] };
    Request::SetRegions(Regions { boxes: of.iter().copied().collect(), only })
}

/// Parameters that change when a scene is shown: how far the techniques may be apart, and which
/// parts are asked for.
fn parameters(kind: Kind) -> Option<Request> {
    let (margin, parts) = match kind {
        Kind::Repetition => (
            Some(Margin::Metres {
                nearer: Depth::from_bits(0x2000),
                farther: Depth::from_bits(0x6000),
            }),
            None,
        ),
        Kind::Corridor => (Some(Margin::Pixels(Disparity::from_bits(96))), None),
        Kind::Blank => (None, Some(Parts::Support)),
        Kind::Boxes => (None, Some(Parts::Both)),
        _ => return None,
    };
    Some(Request::SetParams(ParamUpdate { margin, parts, ..ParamUpdate::default() }))
}

fn rig_request(rig: &RigImage) -> Request {
    Request::SetRig(RigBytes::from_slice(&rig.encode(0)).unwrap())
}

/// Rigs that no board can use: bytes at this place of a good one, and the fault that has to be
/// named.
const FAULTS: [(usize, &[u8], RigFault); 18] = [
    (0, b"RIFF", RigFault::Foreign),
    (4, &[9, 0], RigFault::OtherVersion),
    (6, &[0, 1], RigFault::Length),
    (18, &[0xff, 0x7f], RigFault::Range),
    (24, &[0, 0, 0xc0, 0x7f], RigFault::View), // not a number
    (28, &[0, 0, 0xc0, 0x7f], RigFault::View),
    (36, &[0, 0, 0xc0, 0x7f], RigFault::View),
    (40, &[0, 0, 0xc0, 0x7f], RigFault::View), // of a rotation
    (76, &[0, 0, 0xc0, 0x7f], RigFault::LeftCamera),
    (96, &[7, 0, 0, 0], RigFault::LeftCamera), // no such lens
    (172, &[0, 0, 0xc0, 0x7f], RigFault::RightCamera),
    (192, &[7, 0, 0, 0], RigFault::RightCamera),
    (20, &[0, 0], RigFault::LeftCamera), // images without width
    (84, &[0, 0, 0x80, 0x4e], RigFault::LeftCamera), // centre far outside
    (92, &[0, 0, 0x80, 0x4e], RigFault::LeftCamera), // skew
    (196, &[0, 0, 0x80, 0x4e], RigFault::RightCamera), // a coefficient of the lens
    (228, &[0, 0, 0x80, 0xbf], RigFault::RightCamera), // a limit below zero
    (40, &BACKWARDS, RigFault::View),    // the left camera looks away from what the right one sees
];
/// Three rows of a rotation by 180 degrees about the upright axis.
const BACKWARDS: [u8; 36] = {
    const ONE: [u8; 4] = 1_f32.to_le_bytes();
    let mut rows = [0; 36];
    let mut at = 0;
    while at < 4 {
        (rows[at], rows[16 + at], rows[32 + at]) = (ONE[at], ONE[at], ONE[at]);
        at += 1;
    }
    (rows[3], rows[35]) = (0xbf, 0xbf);
    rows
};

/// Parameters outside of what they may be, their names, and the ends of what is allowed.
fn out_of_range() -> Vec<(ParamUpdate, Refusal)> {
    let none = ParamUpdate::default;
    let numbers = RigUpdate { focal_px: 250.0, baseline_m: 0.1, offset_px: 0.0 };
    let margin = |nearer, farther| ParamUpdate {
        rig: Some(numbers),
        margin: Some(Margin::Metres {
            nearer: Depth::from_bits(nearer),
            farther: Depth::from_bits(farther),
        }),
        ..none()
    };
    let rig = |rig| ParamUpdate { rig: Some(rig), ..none() };
    let tiny = 1e-40_f64; // what a failed calibration may give: no normal number as an f32, or none at all
    let refusal =
        |what: &str, value, low, high| Refusal::OutOfRange { name: name(what), value, low, high };
    vec![
        (ParamUpdate { min_disparity: Some(1), ..none() }, refusal("min_disparity", 1, -32, 0)),
        (ParamUpdate { max_disparity: Some(300), ..none() }, refusal("max_disparity", 300, 8, 256)),
        (
            ParamUpdate { anchor_gradient: Some(3), ..none() },
            refusal("anchor_gradient", 3, 4, 1020),
        ),
        (ParamUpdate { edge_gradient: Some(49), ..none() }, refusal("edge_gradient", 49, 4, 48)),
        (ParamUpdate { min_extent: Some(33), ..none() }, refusal("min_extent", 33, 6, 32)),
        (ParamUpdate { cell: Some(257), ..none() }, refusal("cell", 257, 8, 256)),
        (ParamUpdate { reach: Some(0), ..none() }, refusal("reach", 0, 1, 6)),
        (
            ParamUpdate { min_confidence: Some(Confidence::ZERO), ..none() },
            refusal("min_confidence (percent)", 0, 10, 99),
        ),
        (
            ParamUpdate { margin: Some(Margin::Pixels(Disparity::from_bits(15))), ..none() },
            refusal("margin (1/64 px)", 15, 16, 1024),
        ),
        (margin(0, 0x2000), refusal("margin nearer (mm)", 0, 1, 1_000_000)),
        (margin(0x2000, -0x2000), refusal("margin farther (mm)", -125, 1, 1_000_000)),
        (rig(RigUpdate { focal_px: 1e300, ..numbers }), Refusal::Focal(f64::INFINITY)),
        (rig(RigUpdate { baseline_m: tiny, ..numbers }), Refusal::Baseline((tiny as f32).into())),
        (rig(RigUpdate { offset_px: 1e5, ..numbers }), Refusal::Offset(1e5)),
        (rig(RigUpdate { focal_px: f64::NAN, ..numbers }), Refusal::Focal(f64::NAN)),
    ]
}

/// A rig with a fault; its checksum is that of its bytes.
pub(super) fn faulty(at: usize, with: &[u8], sequence: u32) -> Vec<u8> {
    let mut bytes = rig().encode(sequence).to_vec();
    bytes[at..at + with.len()].copy_from_slice(with);
    sealed(bytes)
}

/// A rig of raw images of this size, rectified to that one, with the right camera rolled; `roll` is
/// the sine of half the angle.
fn sized(raw: Dims, rectified: Dims, roll: f64) -> RigImage {
    let [width, height] = [raw.width, raw.height].map(f64::from);
    let camera =
        Camera::new(raw, [width; 2], [0.5 * width, 0.5 * height], 0.0, Lens::NONE).unwrap();
    let calibration = Calibration::new(
        camera,
        camera,
        [(1.0 - roll * roll).sqrt(), 0.0, 0.0, roll],
        [-0.1, 0.0, 0.0],
    )
    .unwrap();
    RigImage::new(calibration, rectified, View::default(), (0, 64)).unwrap()
}

/// Rigs that this board has no memory for, and what it says.
fn oversized() -> [(RigImage, Refusal); 4] {
    let dims = |width, height| Dims { width, height };
    let small =
        |what: &str, needed, given| Refusal::MemoryTooSmall { name: name(what), needed, given };
    [
        (sized(dims(752, 480), QVGA, 0.0), small("raw row", 752, 320)),
        (
            sized(QVGA, dims(640, 480), 0.0),
            Refusal::OutOfRange { name: name("width"), value: 640, low: 16, high: 320 },
        ),
        (sized(QVGA, dims(320, 256), 0.0), small("frame", 320 * 256, 320 * 240)),
        (sized(QVGA, QVGA, 0.2), small("band", 16_833, 12 * 1024)), // 52 rows of 320 px and 193 bytes that the kernel may read
    ]
}

pub(super) static SCENES: LazyLock<Option<Run>> = LazyLock::new(|| {
    let mut requests: Vec<_> = (0..)
        .zip(FAULTS)
        .map(|(n, (at, with, _))| {
            (
                ORDERS_US + 4000 * n,
                Request::SetRig(RigBytes::from_slice(&faulty(at, with, 0)).unwrap()),
            )
        })
        .collect();
    let updates = out_of_range().into_iter().map(|(update, _)| Request::SetParams(update));
    requests
        .extend((0..).zip(updates).map(|(n, request)| (ORDERS_US + 72_000 + 2000 * n, request)));
    let mut number = 0;
    for (lenses, kinds) in LENSES.iter() {
        requests.push((start_us(number) - 30_000, rig_request(&lenses.rig())));
        for &kind in *kinds {
            requests.push((start_us(number), regions(kind, &SHOWN[number])));
            requests.extend(parameters(kind).map(|request| (start_us(number) + 2000, request)));
            number += 1;
        }
    }
    let end_us = start_us(number);
    requests.push((FIRST_US - 20_000, Request::Start));
    requests.extend(
        [0, 1, 2, 4]
            .into_iter()
            .zip(oversized())
            .map(|(n, (rig, _))| (start_us(n) + 5000, rig_request(&rig))),
    );
    requests.push((end_us, rig_request(&sized(Dims { width: 160, height: 120 }, QVGA, 0.0))));
    requests.sort_by_key(|&(time_us, _)| time_us);
    let images: serde_json::Map<String, Value> = (0..)
        .zip(SHOWN.iter())
        .map(|(n, shown)| (format!("{n}"), json!(shown.raw.each_ref().map(|raw| hex(raw)))))
        .collect();
    let pictures: Vec<_> =
        (0..number).map(|n| json!([start_us(n), start_us(n + 1), format!("{n}")])).collect();
    let scenario = json!({
        "until_us": end_us + 180_000, "host": host(&requests), "images": images, "pictures": pictures, "erase_us": 1000,
    });
    execute("live", &scenario)
});

/// The board's memory and session on this machine.
struct Twin {
    memory: Box<BoardMemory>,
    session: Session<'static>,
    pairs: u8,
}

impl Twin {
    fn new() -> Self {
        Self {
            memory: Box::new(BoardMemory::CLEARED),
            session: Session::new(Board::STM32H743),
            pairs: 0,
        }
    }

    fn take(&mut self, request: Request) {
        let reply = self.session.command(&Command { id: 1, request }, &mut *self.memory);
        let Reply::Answer(answer) = reply else { panic!("{reply:?}") };
        assert_eq!(answer.outcome, Outcome::Accepted);
    }

    fn pair(&mut self, dims: Dims, raw: &[Vec<u8>; 2]) -> (Vec<Match>, Vec<ObjectRecord>) {
        self.memory.restart();
        self.pairs += 1;
        let lighter = self.pairs % 4; // as in the model: a camera whose pixels stay is frozen
        for (pixels, eye) in raw.iter().zip(CameraSide::BOTH) {
            for row in pixels.chunks(QVGA.width.into()) {
                let grey = row.iter().map(|grey| grey + lighter);
                self.memory.raw_row().iter_mut().zip(grey).for_each(|(slot, grey)| *slot = grey);
                self.memory.push_row(eye).unwrap();
            }
        }
        let areas = self.session.areas();
        let options = Options { areas: areas.as_deref(), ..Options::default() };
        let matcher = self.session.matcher(dims).unwrap();
        let mut matched = self.memory.run(None, matcher, options).unwrap();
        let objects = self.session.objects(&mut matched);
        (matched.segments().to_vec(), objects.to_vec())
    }
}

/// Scenes through two pairs of lenses: what the board says is what the PC says of the same pixels,
/// and it is true.
#[test]
fn depths_of_scenes_are_those_of_the_pc_and_true() {
    let Some(run) = &*SCENES else { return };
    run.assert_whole();
    let frames = frames_of(run);
    let (mut twin, mut number) = (Twin::new(), 0);
    for (lenses, kinds) in LENSES.iter() {
        twin.take(rig_request(&lenses.rig()));
        for &kind in *kinds {
            let shown = &SHOWN[number];
            twin.take(regions(kind, shown));
            parameters(kind).into_iter().for_each(|request| twin.take(request));
            twin.pair(lenses.dims, &shown.raw); // of the first one nobody knows yet how far the rows are apart
            let (segments, objects) = twin.pair(lenses.dims, &shown.raw);
            let settled = start_us(number) + SETTLED_US..start_us(number + 1);
            let settled: Vec<_> = frames
                .iter()
                .filter(|frame| settled.contains(&frame.head.capture_time_us))
                .collect();
            assert!(!settled.is_empty(), "{kind:?}");
            for frame in settled {
                assert_eq!(
                    (&frame.segments, &frame.objects),
                    (&segments, &objects),
                    "{kind:?}: {:?}",
                    frame.head
                );
            }
            assert_true(kind, shown, &segments, &objects);
            number += 1;
        }
    }
}

/// Segments and objects of a scene as they are promised: nine of ten segments within a pixel of
/// what is there; a box's depth is one of something in it. Stripes and fences have look-alikes by
/// construction, and are not held to that.
fn assert_true(kind: Kind, shown: &Shown, segments: &[Match], objects: &[ObjectRecord]) {
    let dims = shown.truth.left.dims;
    let truth = Truth::new(dims, shown.truth.disparity.clone(), shown.truth.visible.clone());
    let (matches, points) = (segments.to_vec(), Vec::new());
    let result = FrameResult { matches, ..FrameResult::of_points(points) };
    let score = FrameScore::new(&truth, &result);
    let right = score.segment_errors.iter().filter(|&&error| error <= 1.0).count();
    println!("{kind:?}: {right} of {} segments within a pixel", segments.len());
    if kind == Kind::Repetition {
        return;
    }
    assert!(right * 10 >= segments.len() * 9, "{kind:?}: {right} of {}", segments.len());
    let near =
        |disparity_q6: i16, true_px: f32| (f32::from(disparity_q6) / 64.0 - true_px).abs() <= 1.0;
    for object in objects {
        let Ok(disparity_q6) = object.disparity_q6 else { continue };
        let of = shown.boxes.iter().find(|of| of.label == object.label).unwrap();
        let mut inside = pixels(dims).filter(|&(x, y)| of.area().contains(x.into(), y.into()));
        let disparity = |(x, y): (u16, u16)| truth.disparity(x.into(), y.into()).unwrap();
        assert!(inside.any(|at| near(disparity_q6, disparity(at))), "{kind:?}: {object:?}");
    }
    if kind == Kind::Cards {
        // Nothing hides them: each has its own depth.
        let right = objects.iter().filter(|object| {
            let mut own = pixels(dims).filter(|&at| label_at(&shown.truth, at) == object.label);
            let disparity =
                own.next().and_then(|(x, y)| truth.disparity(x.into(), y.into())).unwrap();
            object.disparity_q6.is_ok_and(|disparity_q6| near(disparity_q6, disparity))
        });
        assert_eq!(right.count(), MAX_REGIONS);
    }
}

/// Rigs and parameters that cannot be used are refused by what is wrong with them, and those in use
/// stay; one of other cameras makes every pair one of another size.
#[test]
fn rigs_and_parameters_are_refused_by_their_fault() {
    let Some(run) = &*SCENES else { return };
    let mut expected: Vec<_> = FAULTS.map(|(_, _, fault)| Refusal::Rig(fault)).into();
    expected.extend(out_of_range().into_iter().map(|(_, refusal)| refusal));
    expected.extend(oversized().map(|(_, refusal)| refusal));
    let refused = run.answers().filter_map(|answer| match &answer.outcome {
        Outcome::Refused(refusal) => Some(refusal.clone()),
        Outcome::Accepted => None,
    });
    // As text: a number that is none equals no other.
    assert_eq!(format!("{:?}", refused.collect::<Vec<_>>()), format!("{expected:?}"));
    let end_us = start_us(SHOWN.len());
    let last = *run.frames().last().unwrap();
    assert!(
        last.health.contains(Health::SIZE_MISMATCH) && last.segments == 0,
        "{last:?} after {end_us} us"
    );
}
