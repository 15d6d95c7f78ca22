//! Calibration from boards: rigs that are known, rigs that were photographed, and photos that
//! cannot be used.

use crate::support::says;
use linestereo::Dims;
use linestereo_calibration::boards::{
    Board, BoardFinder, BoardPair, Estimate, EstimateError, Finding, JunctionFinder, LensModel,
    NotFound, Options, Pattern, Verdict, assess, estimate,
};
use linestereo_calibration::rig_file::quaternion;
use linestereo_frames::GrayImage;
use linestereo_rig::{Calibration, Camera, CameraSide, Lens};
use linestereo_tests::drawn::Random;
use std::sync::{Arc, Mutex};

const VGA: Dims = Dims { width: 640, height: 480 };

fn board() -> Board {
    Board::new(9, 6, 0.025).unwrap()
}

fn brown(focal: [f64; 2], centre: [f64; 2], k: [f64; 3], p: [f64; 2]) -> Camera {
    Camera::new(VGA, focal, centre, 0.0, Lens::BrownConrady { k, p }).unwrap()
}

fn rig(left: Camera, right: Camera, rotation: [f64; 3]) -> Calibration {
    Calibration::new(left, right, quaternion(rotation), [-0.08, 0.001, -0.002]).unwrap()
}

/// The rigs that are recovered: name, rig, family of lens.
fn rigs() -> Vec<(&'static str, Calibration, LensModel)> {
    let lens = |k, p| {
        let left = brown([520.0, 523.0], [322.0, 236.0], k, p);
        let right = brown([517.0, 519.0], [315.0, 243.0], k.map(|k| 0.95 * k), [p[1], -p[0]]);
        rig(left, right, [0.004, -0.006, 0.003])
    };
    let wide = |focal: f64, cx: f64| {
        Camera::new(
            VGA,
            [focal, focal + 1.0],
            [cx, 241.0],
            0.0,
            Lens::Fisheye { k: [-0.02, 0.006, -0.004, 0.001] },
        )
        .unwrap()
    };
    let barrel = [-0.31, 0.12, -0.02];
    let turned = {
        let left = brown([520.0, 523.0], [322.0, 236.0], barrel, [4e-4, -3e-4]);
        let right = brown([517.0, 519.0], [315.0, 243.0], barrel, [-2e-4, 5e-4]);
        rig(left, right, [0.010, 0.030, -0.015]) // 2 degrees in all
    };
    vec![
        ("barrel", lens(barrel, [4e-4, -3e-4]), LensModel::BrownConrady),
        ("pincushion", lens([0.18, 0.05, 0.0], [-5e-4, 2e-4]), LensModel::BrownConrady),
        ("mustache", lens([-0.25, 0.30, -0.06], [3e-4, 1e-4]), LensModel::BrownConrady),
        (
            "fisheye",
            rig(wide(285.0, 320.0), wide(287.0, 316.0), [0.004, -0.006, 0.003]),
            LensModel::Fisheye,
        ),
        ("2 degrees", turned, LensModel::BrownConrady),
    ]
}

/// Where a board stands: rows of its rotation into the left camera, and its first corner there.
#[derive(Clone, Copy)]
struct Placed {
    rotation: [[f64; 3]; 3],
    shift: [f64; 3],
}

fn rows_of([w, x, y, z]: [f64; 4]) -> [[f64; 3]; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

fn turned([a, b, c]: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    [a, b, c].map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

impl Placed {
    /// Tilted by up to 40 degrees, its middle anywhere in the left image.
    fn anywhere(rig: &Calibration, board: &Board, random: &mut Random) -> Self {
        let mut angle = |limit: f64| random.uniform(-limit, limit);
        let rotation = rows_of(quaternion([angle(0.6), angle(0.6), angle(0.4)]));
        let camera = rig.camera(CameraSide::Left);
        let at = [random.uniform(0.15, 0.85) * 640.0, random.uniform(0.15, 0.85) * 480.0];
        let [x, y] = camera.unproject(at).unwrap();
        let depth = random.uniform(0.22, 0.5) * camera.focal()[0] / 520.0;
        let last = board.points()[board.corners() - 1];
        let middle = turned(rotation, [last[0] / 2.0, last[1] / 2.0, 0.0]);
        Self { rotation, shift: [x * depth - middle[0], y * depth - middle[1], depth - middle[2]] }
    }

    fn in_left(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let v = turned(self.rotation, [x, y, 0.0]);
        [0, 1, 2].map(|i| v[i] + self.shift[i])
    }

    /// Pixel at which a camera sees a place of the board, if it does.
    fn seen_at(&self, rig: &Calibration, eye: CameraSide, place: [f64; 2]) -> Option<[f64; 2]> {
        let point = self.in_left(place);
        let point = if eye == CameraSide::Left { point } else { in_right(rig, point) };
        rig.camera(eye).project(point).filter(|&at| rig.camera(eye).is_inside(at))
    }

    /// Pixels of the board's corners, if the camera sees all of them.
    fn corners(&self, rig: &Calibration, eye: CameraSide, board: &Board) -> Option<Vec<[f64; 2]>> {
        board.points().into_iter().map(|place| self.seen_at(rig, eye, place)).collect()
    }
}

/// A point of the left camera in the right one.
pub(crate) fn in_right(rig: &Calibration, point: [f64; 3]) -> [f64; 3] {
    let v = turned(rows_of(rig.rotation()), point);
    [0, 1, 2].map(|i| v[i] + rig.translation()[i])
}

/// Boards that both cameras see whole, their corners displaced by noise.
fn boards(
    rig: &Calibration,
    board: &Board,
    count: usize,
    noise: f64,
    random: &mut Random,
) -> Vec<BoardPair> {
    let mut pairs = Vec::new();
    while pairs.len() < count {
        let placed = Placed::anywhere(rig, board, random);
        if let [Some(left), Some(right)] =
            CameraSide::BOTH.map(|eye| placed.corners(rig, eye, board))
        {
            let corners = noisy([left, right], noise, random);
            pairs.push(BoardPair::whole(pairs.len().to_string(), corners));
        }
    }
    pairs
}

fn noisy(corners: [Vec<[f64; 2]>; 2], noise: f64, random: &mut Random) -> [Vec<[f64; 2]>; 2] {
    let mut displaced = |at: [f64; 2]| at.map(|v| v + noise * random.normal());
    corners.map(|eye| eye.into_iter().map(&mut displaced).collect())
}

/// True values, by the names of the estimate's parameters.
fn truth(rig: &Calibration, name: &str) -> f64 {
    let (part, name) = name.split_once('.').unwrap();
    if part == "pose" {
        let axis = ["x", "y", "z"].iter().position(|axis| name.ends_with(axis)).unwrap();
        let vector = linestereo_calibration::rig_file::rotation_vector(rig.rotation());
        return if name.starts_with('r') { vector[axis] } else { rig.translation()[axis] };
    }
    let camera = rig.camera(if part == "left" { CameraSide::Left } else { CameraSide::Right });
    let numbered = |values: &[f64]| values[name[1..].parse::<usize>().unwrap() - 1];
    match (name, camera.lens()) {
        ("fx", _) => camera.focal()[0],
        ("fy", _) => camera.focal()[1],
        ("cx", _) => camera.centre()[0],
        ("cy", _) => camera.centre()[1],
        ("skew", _) => camera.skew(),
        (_, Lens::BrownConrady { k, p }) => numbered(if name.starts_with('k') { &k } else { &p }),
        (_, Lens::Fisheye { k }) => numbered(&k),
        (_, Lens::Rational { .. }) => panic!("no rig of these has one"),
    }
}

/// Errors in stated standard deviations, by name; what was held has none.
pub(crate) fn scores(rig: &Calibration, estimate: &Estimate) -> Vec<(String, f64)> {
    let free = estimate.parameters.iter().filter(|parameter| parameter.sigma > 0.0);
    free.map(|p| (p.name.clone(), (p.value - truth(rig, &p.name)) / p.sigma)).collect()
}

#[test]
fn known_rigs_are_recovered_within_three_stated_deviations() {
    let (mut compared, mut beyond) = (0, Vec::new());
    for (seed, (name, rig, lens)) in rigs().into_iter().enumerate() {
        let pairs = boards(&rig, &board(), 20, 0.1, &mut Random(seed as u64));
        let options = Options { lens, ..Options::default() };
        let found = estimate(&board(), VGA, &pairs, &options)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        // The distance of two coordinates with a deviation of 0.1 px each.
        assert!((found.rms / 0.1414 - 1.0).abs() < 0.05, "{name}: {}", found.rms);
        assert!(found.views.iter().all(|view| view.dropped.is_none()), "{name}");
        let scores = scores(&rig, &found);
        assert_eq!(scores.len(), if lens == LensModel::Fisheye { 22 } else { 24 }, "{name}");
        compared += scores.len();
        beyond.extend(
            scores.into_iter().filter(|(_, score)| score.abs() > 3.0).map(|found| (name, found)),
        );
        let baseline = (found.calibration.baseline() - rig.baseline()).abs();
        assert!(
            baseline < 3.0 * found.baseline_sigma && found.baseline_sigma < 2e-4,
            "{name}: {baseline}"
        );
    }
    assert_eq!(beyond, [], "of {compared}");
}

#[test]
fn stated_deviations_are_those_of_many_repetitions() {
    const SEEDS: u64 = 24;
    let (_, rig, lens) = rigs().remove(0);
    let options = Options { lens, ..Options::default() };
    let mut squares: Vec<(String, f64)> = Vec::new();
    let (mut compared, mut beyond) = (0, 0);
    for seed in 100..100 + SEEDS {
        let pairs = boards(&rig, &board(), 12, 0.1, &mut Random(seed));
        let found = estimate(&board(), VGA, &pairs, &options).unwrap();
        let scores = scores(&rig, &found);
        squares.resize(scores.len(), (String::new(), 0.0));
        for (sum, (name, score)) in squares.iter_mut().zip(scores) {
            *sum = (name, sum.1 + score * score / SEEDS as f64);
            compared += 1;
            beyond += u32::from(score.abs() > 3.0);
        }
    }
    // The root of the mean of 24 squares of normal numbers is within 0.57 to 1.43 with 99.7 %.
    for (name, square) in &squares {
        assert!((0.55..1.45).contains(&square.sqrt()), "{name}: {}", square.sqrt());
    }
    let mean = squares.iter().map(|(_, square)| square).sum::<f64>() / squares.len() as f64;
    assert!((0.8..1.2).contains(&mean.sqrt()), "{}", mean.sqrt());
    assert!(f64::from(beyond) <= 0.01 * f64::from(compared), "{beyond} of {compared}");
}

#[test]
fn a_bad_view_and_bad_corners_are_left_out() {
    let (_, rig, lens) = rigs().remove(0);
    let random = &mut Random(7);
    let mut pairs = boards(&rig, &board(), 12, 0.1, random);
    // The board was moved before the right photo was taken.
    pairs[3].corners[1] = boards(&rig, &board(), 1, 0.1, random).remove(0).corners[1].clone();
    pairs[5].corners[0][10][0] += 2.5;
    let found = estimate(&board(), VGA, &pairs, &Options { lens, ..Options::default() }).unwrap();
    let dropped: Vec<usize> = (0..12).filter(|&view| found.views[view].dropped.is_some()).collect();
    assert_eq!(dropped, [3]);
    let bad: Vec<usize> = found.views.iter().map(|view| view.bad_corners).collect();
    assert!(
        bad[5] == 1
            && bad.iter().enumerate().all(|(view, &bad)| view == 3 || view == 5 || bad == 0),
        "{bad:?}"
    );
    assert!((found.rms / 0.1414 - 1.0).abs() < 0.05, "{}", found.rms);
}

/// A mistake with photos.
type Change = fn(&mut Vec<BoardPair>);

#[test]
fn photos_that_cannot_be_used_are_named() {
    let (_, rig, lens) = rigs().remove(0);
    let options = Options { lens, ..Options::default() };
    let pairs = boards(&rig, &board(), 10, 0.1, &mut Random(8));
    let changes: [(Change, &str); 4] = [
        (|pairs| pairs.truncate(4), "only 4 of 4 views"),
        (|pairs| pairs.iter_mut().for_each(|pair| pair.corners.reverse()), "cameras are swapped"),
        // As if the board had been turned round between the two photos.
        (|pairs| pairs.iter_mut().step_by(2).for_each(|pair| pair.corners[1].reverse()), "flipped"),
        (
            |pairs| {
                let mut right: Vec<_> = pairs.iter().map(|pair| pair.corners[1].clone()).collect();
                right.rotate_right(1);
                pairs.iter_mut().zip(right).for_each(|(pair, right)| pair.corners[1] = right);
            },
            "do not belong together",
        ),
    ];
    for (change, word) in changes {
        let mut changed = pairs.clone();
        change(&mut changed);
        says(&estimate(&board(), VGA, &changed, &options).unwrap_err().to_string(), &[word]);
    }
}

#[test]
fn few_parallel_boards_are_not_called_good() {
    let (_, rig, lens) = rigs().remove(0);
    let random = &mut Random(9);
    let rotation = rows_of(quaternion([0.0, 0.02, 0.0]));
    let pairs: Vec<BoardPair> = (0..6)
        .map(|i| {
            let place = Placed { rotation, shift: [-0.1 + 0.01 * f64::from(i), -0.06, 0.45] };
            let corners = CameraSide::BOTH.map(|eye| place.corners(&rig, eye, &board()).unwrap());
            BoardPair::whole(i.to_string(), noisy(corners, 0.1, random))
        })
        .collect();
    // Either no numbers at all, or a verdict that says what to do.
    match estimate(&board(), VGA, &pairs, &Options { lens, ..Options::default() }) {
        Ok(found) => {
            let assessment = assess(&found, 64);
            assert_eq!(assessment.verdict, Verdict::Repeat);
            let tilts = |finding: &Finding| finding.remedy.contains("tilt it");
            assert!(assessment.findings.iter().any(tilts), "{:?}", assessment.findings);
        }
        Err(EstimateError::Undetermined | EstimateError::NoFit(_) | EstimateError::Camera(..)) => {}
        Err(error) => panic!("{error}"),
    }
}

/// A photo of a board: each pixel is the mean of 3x3 rays, dark 40, light 210, grey beyond the
/// board.
pub(crate) struct Photographer {
    dims: Dims,
    rays: Vec<[f64; 3]>,
}

const RAYS: usize = 3;

impl Photographer {
    /// With the left and with the right camera; tests share them, since their rays take as long as
    /// many photos.
    fn both(rig: &Calibration) -> Arc<[Self; 2]> {
        type Known = Vec<(Calibration, Arc<[Photographer; 2]>)>;
        static KNOWN: Mutex<Known> = Mutex::new(Vec::new());
        let mut known = KNOWN.lock().unwrap();
        if let Some((_, both)) = known.iter().find(|(of, _)| of == rig) {
            return Arc::clone(both);
        }
        let both = Arc::new(CameraSide::BOTH.map(|eye| Self::new(rig, eye)));
        known.push((*rig, Arc::clone(&both)));
        both
    }

    pub(crate) fn new(rig: &Calibration, eye: CameraSide) -> Self {
        let camera = rig.camera(eye);
        let dims = camera.dims();
        let (width, height) = (usize::from(dims.width), usize::from(dims.height));
        let place = |i: usize| (i as f64 + 0.5) / RAYS as f64 - 0.5;
        let ray = |i: usize| {
            let [x, y] = camera
                .unproject([place(i % (width * RAYS)), place(i / (width * RAYS))])
                .unwrap_or([100.0, 0.0]);
            [x, y, 1.0]
        };
        Self { dims, rays: (0..width * height * RAYS * RAYS).map(ray).collect() }
    }

    /// The plane of the board is given by the first corner and the directions of rows and columns,
    /// in this camera's coordinates.
    fn take(&self, board: &Board, plane: [[f64; 3]; 3]) -> GrayImage {
        if board.pattern() != Pattern::Chessboard {
            return self.take_plane(plane, painted(board));
        }
        self.take_plane(plane, |[x, y]| {
            let (col, row) = (x / 0.025 + 1.0, y / 0.025 + 1.0);
            let outside = |v: f64, corners: usize| v < 0.0 || v >= corners as f64 + 1.0;
            if outside(col, board.cols()) || outside(row, board.rows()) {
                return 180.0;
            }
            if (col.floor() + row.floor()) as i64 % 2 == 0 { 40.0 } else { 210.0 }
        })
    }

    /// A plane of which the grey is known by metres along its two directions.
    pub(crate) fn take_plane(
        &self,
        [first, right, down]: [[f64; 3]; 3],
        paint: impl Fn([f64; 2]) -> f64,
    ) -> GrayImage {
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let normal = cross(right, down);
        let grey = |ray: &[f64; 3]| {
            let scale = dot(normal, first) / dot(normal, *ray);
            let on = [0, 1, 2].map(|i| ray[i] * scale - first[i]);
            paint([dot(on, right), dot(on, down)])
        };
        let width = usize::from(self.dims.width);
        let pixel = |i: usize| {
            let (x, y) = (i % width * RAYS, i / width * RAYS);
            let rays =
                (0..RAYS * RAYS).map(|k| &self.rays[(y + k / RAYS) * width * RAYS + x + k % RAYS]);
            (rays.map(grey).sum::<f64>() / (RAYS * RAYS) as f64).round() as u8
        };
        GrayImage {
            dims: self.dims,
            pixels: (0..width * usize::from(self.dims.height)).map(pixel).collect(),
        }
    }
}

/// Greys of a board with markers, by metres from its first corner; buckets of 2 cm, in rows of
/// `across`, hold what is black there.
fn painted(board: &Board) -> impl Fn([f64; 2]) -> f64 {
    const BUCKET: f64 = 0.02;
    let [left, top, width, height] = board.extent();
    let rim = 0.01;
    let bucket = move |at: f64, first: f64| ((at - first + rim) / BUCKET) as usize;
    let across = bucket(left + width + rim, left) + 1;
    let mut buckets = vec![Vec::new(); across * (bucket(top + height + rim, top) + 1)];
    for black in board.black() {
        let [x, y, width, height] = black;
        for row in bucket(y, top)..=bucket(y + height, top) {
            let cells = row * across + bucket(x, left)..=row * across + bucket(x + width, left);
            buckets[cells].iter_mut().for_each(|cell: &mut Vec<[f64; 4]>| cell.push(black));
        }
    }
    move |[x, y]| {
        let inside =
            |at: f64, first: f64, length: f64| (first - rim..first + length + rim).contains(&at);
        if !inside(x, left, width) || !inside(y, top, height) {
            return 180.0;
        }
        let covers = |[l, t, w, h]: &[f64; 4]| (*l..l + w).contains(&x) && (*t..t + h).contains(&y);
        let black = &buckets[bucket(y, top) * across + bucket(x, left)];
        if black.iter().any(covers) { 40.0 } else { 210.0 }
    }
}

fn mirrored(image: &GrayImage) -> GrayImage {
    let width = usize::from(image.dims.width);
    let pixels =
        image.pixels.chunks_exact(width).flat_map(|row| row.iter().rev().copied()).collect();
    GrayImage { dims: image.dims, pixels }
}

/// The rig of drawn photos: 320x240, or so many times that.
pub(crate) fn drawn_rig(scale: u16) -> Calibration {
    let dims = Dims { width: 320 * scale, height: 240 * scale };
    let lens = Lens::BrownConrady { k: [-0.28, 0.1, 0.0], p: [3e-4, -2e-4] };
    let scaled = |at: f64| (at + 0.5) * f64::from(scale) - 0.5;
    let camera = |focal: f64, centre: [f64; 2]| {
        Camera::new(dims, [focal * f64::from(scale); 2], centre.map(scaled), 0.0, lens).unwrap()
    };
    let cameras = [camera(260.0, [161.0, 118.0]), camera(258.0, [158.0, 122.0])];
    Calibration::new(cameras[0], cameras[1], quaternion([0.01, 0.02, -0.01]), [-0.06, 0.0, 0.0])
        .unwrap()
}

/// A board in view of a drawn rig: in each camera's coordinates its first corner and the directions
/// of its rows and columns.
pub(crate) type Planes = [[[f64; 3]; 3]; 2];

/// Photos of one rig at 320x240.
pub(crate) fn photos(board: &Board, count: usize, seed: u64) -> (Calibration, Vec<[GrayImage; 2]>) {
    let rig = drawn_rig(1);
    let photos = photos_of(&rig, board, count, seed, 1.0);
    (rig, photos.into_iter().map(|(_, photos)| photos).collect())
}

/// Photos of boards of which this share of the corners, at least, is in both images.
pub(crate) fn photos_of(
    rig: &Calibration,
    board: &Board,
    count: usize,
    seed: u64,
    share: f64,
) -> Vec<(Planes, [GrayImage; 2])> {
    let photographers = Photographer::both(rig);
    let random = &mut Random(seed);
    let mut photos = Vec::new();
    let points = board.points();
    let last = points[points.len() - 1];
    let step = board.square();
    while photos.len() < count {
        let mut angle = |limit: f64| random.uniform(-limit, limit);
        let rotation = rows_of(quaternion([angle(0.5), angle(0.5), angle(0.3)]));
        let depth = random.uniform(0.28, 0.45);
        let middle = turned(rotation, [last[0] / 2.0, last[1] / 2.0, 0.0]);
        let place = [random.uniform(-0.35, 0.45) * depth, random.uniform(-0.3, 0.3) * depth];
        let placed = Placed {
            rotation,
            shift: [place[0] - middle[0], place[1] - middle[1], depth - middle[2]],
        };
        let seen = |at: [f64; 2]| {
            CameraSide::BOTH.iter().all(|&eye| placed.seen_at(rig, eye, at).is_some())
        };
        let far = [-step, last[0] + step].map(|x| [-step, last[1] + step].map(|y| [x, y]));
        let inside = points.iter().filter(|&&at| seen(at)).count() as f64 / points.len() as f64;
        let whole =
            if share < 1.0 { inside >= share } else { far.iter().flatten().all(|&at| seen(at)) };
        if !whole {
            continue;
        }
        let corner = placed.in_left([0.0, 0.0]);
        let column = |i: usize| [0, 1, 2].map(|row: usize| placed.rotation[row][i]);
        let spin = |v: [f64; 3]| turned(rows_of(rig.rotation()), v);
        let planes = [
            [corner, column(0), column(1)],
            [in_right(rig, corner), spin(column(0)), spin(column(1))],
        ];
        let photo = |eye: usize| photographers[eye].take(board, planes[eye]);
        photos.push((planes, [photo(0), photo(1)]));
    }
    photos
}

/// The boards found in photos, as the command finds them.
pub(crate) fn found(board: &Board, photos: &[[GrayImage; 2]]) -> Vec<BoardPair> {
    let find = |image: &GrayImage| JunctionFinder.find(image, board);
    let pair = |(index, [left, right]): (usize, &[GrayImage; 2])| {
        Some(BoardPair::new(index.to_string(), find(left).ok()?, find(right).ok()?))
    };
    photos.iter().enumerate().filter_map(pair).collect()
}

#[test]
fn boards_are_found_in_drawn_photos() {
    // 9x6 has one numbering, 8x6 two, 6x6 four.
    for (cols, rows) in [(9, 6), (8, 6), (6, 6)] {
        let board = Board::new(cols, rows, 0.025).unwrap();
        let (rig, photos) = photos(&board, 12, 3);
        let pairs = found(&board, &photos);
        // Squares of 14 px, steeply tilted, are the limit of what is found.
        assert!(pairs.len() >= 11, "{board}: {}", pairs.len());
        let estimate = estimate(&board, photos[0][0].dims, &pairs, &Options::default()).unwrap();
        assert!(estimate.rms < 0.1, "{board}: {}", estimate.rms);
        assert!((estimate.calibration.baseline() / rig.baseline() - 1.0).abs() < 0.005, "{board}");
        for eye in CameraSide::BOTH {
            let (found, put) =
                (estimate.calibration.camera(eye).focal()[0], rig.camera(eye).focal()[0]);
            assert!((found / put - 1.0).abs() < 0.005, "{board}: {found} for {put}");
        }
        // Rows with independent errors differ by 0.8 times the RMS in the mean.
        let vertical = assess(&estimate, 64).rectified.unwrap().vertical;
        assert!(vertical < estimate.rms, "{board}: {vertical}");
    }
}

#[test]
fn mirrored_photos_and_wrong_sizes_are_named() {
    let (_, photos) = photos(&board(), 8, 4);
    let options = Options::default();
    for (side, eye) in [(0, CameraSide::Left), (1, CameraSide::Right)] {
        let mut turned = photos.clone();
        turned.iter_mut().for_each(|pair| pair[side] = mirrored(&pair[side]));
        let pairs = found(&board(), &turned);
        assert_eq!(pairs.len(), 8);
        assert_eq!(
            estimate(&board(), photos[0][0].dims, &pairs, &options),
            Err(EstimateError::Mirrored(eye))
        );
    }
    for (cols, rows) in [(10, 7), (8, 5), (7, 6)] {
        let wrong = Board::new(cols, rows, 0.025).unwrap();
        assert_eq!(
            JunctionFinder.find(&photos[0][0], &wrong),
            Err(NotFound::OtherSize(9, 6)),
            "{cols}x{rows}"
        );
    }
    let empty = GrayImage { dims: VGA, pixels: vec![99; 640 * 480] };
    assert_eq!(JunctionFinder.find(&empty, &board()), Err(NotFound::Nothing));
}
