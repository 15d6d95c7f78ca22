//! Rectification: cameras, the common view, the mesh and the rows, against floating-point oracles.

use linestereo::{Dims, image::Span};
use linestereo_frames::{GrayImage, load_gray};
use linestereo_rig::{
    Band, Calibration, Camera, CameraSide, Lens, Mesh, MeshError, Rectification, RowError, View,
    fine_mesh_nodes, mesh_nodes,
};
use linestereo_tests::captured;
use linestereo_tests::drawn::{Random, painted};
use linestereo_tests::reference;
use nalgebra::{Matrix3, Matrix3x4, Quaternion, Rotation3, UnitQuaternion, Vector3};

const LARGEST: Dims = Dims { width: 752, height: 480 };
const QVGA: Dims = Dims { width: 320, height: 240 };
const SMALL: Dims = Dims { width: 160, height: 120 };

type LargeMesh = Mesh<{ fine_mesh_nodes(LARGEST) }, { LARGEST.height as usize }>;
type LargeBand = Band<{ 752 * 480 }>;

fn brown(k: [f64; 3], p: [f64; 2]) -> Lens {
    Lens::BrownConrady { k, p }
}

/// A rotation by a vector of degrees, as unit quaternion.
fn turned(degrees: [f64; 3]) -> [f64; 4] {
    let rotation = UnitQuaternion::from_scaled_axis(Vector3::from(degrees.map(f64::to_radians)));
    [rotation.w, rotation.i, rotation.j, rotation.k]
}

/// Two cameras of one kind whose centres lie a little off and that look apart by degrees.
fn rig(dims: Dims, focal: f64, lens: Lens, degrees: [f64; 3]) -> Calibration {
    let (w, h) = (f64::from(dims.width), f64::from(dims.height));
    let camera = |dx: f64, dy: f64| {
        let centre = [(w - 1.0) / 2.0 + dx * w, (h - 1.0) / 2.0 + dy * h];
        Camera::new(dims, [focal * w, focal * w * 1.003], centre, 0.0, lens).unwrap()
    };
    Calibration::new(
        camera(0.01, -0.015),
        camera(-0.012, 0.01),
        turned(degrees),
        [-0.06, 0.001, -0.0008],
    )
    .unwrap()
}

/// Lenses of every kind at both ends of what is common; focal length as a share of the width.
fn lenses() -> [(&'static str, f64, Lens); 9] {
    [
        ("none", 0.8, Lens::NONE),
        ("slight barrel", 0.9, brown([-0.1, 0.01, 0.0], [0.0005, -0.0003])),
        ("barrel", 0.7, brown([-0.32, 0.12, -0.02], [0.001, -0.0005])),
        ("strong barrel", 0.5, brown([-0.3, 0.09, -0.011], [0.0, 0.001])),
        ("pincushion", 0.8, brown([0.2, 0.05, 0.0], [-0.001, 0.0005])),
        ("mustache", 0.7, brown([-0.25, 0.35, -0.12], [0.0, 0.0])),
        // An OAK's.
        (
            "rational",
            0.8,
            Lens::Rational {
                k: [1.2616, -57.753, 282.645, 1.107, -56.354, 277.476],
                p: [8.7e-4, 1.33e-3],
            },
        ),
        ("fisheye 90", 0.6, Lens::Fisheye { k: [-0.02, 0.003, -0.001, 0.0] }),
        ("fisheye 140", 0.4, Lens::Fisheye { k: [0.01, -0.004, 0.001, 0.0] }),
    ]
}

fn euroc(width: f64, dims: Dims) -> Calibration {
    let s = width / 752.0;
    // Pixel centres are whole numbers: a scaled image has its centre at s (c + 1/2) - 1/2.
    let centre = |[x, y]: [f64; 2]| [s * (x + 0.5) - 0.5, s * (y + 0.5) - 0.5];
    let left = Camera::new(
        dims,
        [458.654 * s, 457.296 * s],
        centre([367.215, 248.375]),
        0.0,
        brown([-0.28340811, 0.07395907, 0.0], [0.00019359, 1.76187114e-05]),
    )
    .unwrap();
    let right = Camera::new(
        dims,
        [457.587 * s, 456.134 * s],
        centre([379.999, 255.238]),
        0.0,
        brown([-0.28368365, 0.07451284, 0.0], [-0.00010473, -3.55590700e-05]),
    )
    .unwrap();
    // From both T_BS: the right camera's inverse times the left one's.
    #[rustfmt::skip]
    let t_left = Matrix3x4::new(
        0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,
        0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,
        -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949,
    );
    #[rustfmt::skip]
    let t_right = Matrix3x4::new(
        0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556,
        0.999598781151, 0.0130119051815, 0.0251588363115, 0.0453689425024,
        -0.0253898008918, 0.0179005838253, 0.999517347078, 0.00786212447038,
    );
    let to_right = t_right.fixed_columns::<3>(0).transpose();
    let translation = to_right * (t_left.column(3) - t_right.column(3));
    let rotation = quaternion(to_right * t_left.fixed_columns::<3>(0));
    Calibration::new(left, right, rotation, translation.into()).unwrap()
}

fn quaternion(rotation: Matrix3<f64>) -> [f64; 4] {
    let rotation = Rotation3::from_matrix_unchecked(rotation);
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
    [rotation.w, rotation.i, rotation.j, rotation.k]
}

fn mesh(rectification: &Rectification, eye: CameraSide) -> Box<LargeMesh> {
    let mut mesh = Box::new(LargeMesh::new());
    mesh.build(&rectification.remap(), eye).unwrap();
    mesh
}

/// Largest distance of the mesh from the exact source over all pixels that have one, px; and the
/// share of pixels that have one.
fn error(rectification: &Rectification, eye: CameraSide) -> (f64, f64) {
    let mesh = mesh(rectification, eye);
    let dims = rectification.dims();
    let (mut worst, mut valid) = (0.0_f64, 0);
    for y in 0..dims.height {
        for x in mesh.spans()[usize::from(y)].start..mesh.spans()[usize::from(y)].end {
            let [u, v] = mesh.source(x, y).unwrap().map(|q| f64::from(q) / 65536.0);
            let [a, b] = rectification.source(eye, [f64::from(x), f64::from(y)]).unwrap();
            worst = worst.max((u - a).hypot(v - b));
            valid += 1;
        }
    }
    (worst, f64::from(valid) / f64::from(dims.width) / f64::from(dims.height))
}

/// Rigs of every kind and size, with the size of their rectified images.
fn rigs() -> Vec<(String, Calibration, Dims)> {
    let small = Dims { width: 320, height: 204 };
    let mut rigs = vec![
        ("euroc".to_owned(), euroc(752.0, LARGEST), LARGEST),
        ("euroc at 320x204".to_owned(), euroc(320.0, small), small),
        ("euroc from 752x480 to 320x204".to_owned(), euroc(752.0, LARGEST), small),
    ];
    for dims in [QVGA, SMALL] {
        for (name, focal, lens) in lenses() {
            rigs.push((
                format!("{name} at {dims}"),
                rig(dims, focal, lens, [0.5, -0.7, 1.0]),
                dims,
            ));
        }
    }
    rigs.push((
        "barrel turned the other way".to_owned(),
        rig(QVGA, 0.7, lenses()[2].2, [-1.0, 1.5, -2.0]),
        QVGA,
    ));
    rigs
}

#[test]
fn mesh_is_within_a_thirtieth_of_a_pixel() {
    for (name, calibration, dims) in rigs() {
        let rectification = calibration.rectify(dims, View::Alpha(0.0)).unwrap();
        for eye in CameraSide::BOTH {
            let (worst, _) = error(&rectification, eye);
            let stated = f64::from(mesh(&rectification, eye).error());
            let rounding = 1.5e-3;
            assert!(
                worst <= 1.1 * stated + rounding,
                "{name}, {eye:?}: {worst} px, {stated} px are stated"
            );
            assert!(worst <= 1.0 / 32.0 + rounding, "{name}, {eye:?}: {worst} px");
        }
    }
}

#[test]
fn with_alpha_0_every_pixel_has_a_source() {
    for (name, calibration, dims) in rigs() {
        let rectification = calibration.rectify(dims, View::Alpha(0.0)).unwrap();
        let mut touching = 0;
        for eye in CameraSide::BOTH {
            let (mesh, raw) = (mesh(&rectification, eye), rectification.camera(eye).dims());
            for y in 0..dims.height {
                assert_eq!(
                    mesh.spans()[usize::from(y)],
                    Span { start: 0, end: dims.width },
                    "{name}, {eye:?}, row {y}"
                );
                for x in (0..dims.width)
                    .filter(|x| y == 0 || y + 1 == dims.height || *x == 0 || x + 1 == dims.width)
                {
                    let [u, v] = rectification.source(eye, [f64::from(x), f64::from(y)]).unwrap();
                    let (w, h) = (f64::from(raw.width - 1), f64::from(raw.height - 1));
                    assert!(u >= 0.0 && v >= 0.0 && u <= w && v <= h);
                    touching += i32::from(u.min(w - u).min(v).min(h - v) < 3.0);
                }
            }
        }
        // As much view as possible: somewhere it ends with the raw image.
        assert!(touching > 0, "{name}");
    }
}

#[test]
fn with_alpha_1_every_raw_pixel_is_inside() {
    for (name, calibration, dims) in rigs() {
        if name.contains("140") {
            continue; // wider than a flat image shows
        }
        let rectification = calibration.rectify(dims, View::Alpha(1.0)).unwrap();
        for eye in CameraSide::BOTH {
            let raw = rectification.camera(eye).dims();
            let (w, h) = (raw.width - 1, raw.height - 1);
            let border = (0..=w)
                .flat_map(|x| [(x, 0), (x, h)])
                .chain((0..=h).flat_map(|y| [(0, y), (w, y)]));
            for (u, v) in border {
                let Some([x, y]) = rectification.rectified(eye, [f64::from(u), f64::from(v)])
                else {
                    continue;
                };
                let inside = |v: f64, side: u16| (-1e-6..=f64::from(side - 1) + 1e-6).contains(&v);
                assert!(
                    inside(x, dims.width) && inside(y, dims.height),
                    "{name}, {eye:?}: ({u}, {v}) at ({x}, {y})"
                );
            }
        }
    }
}

/// Grey level between pixels, in floating point; not further outside than a 32nd of a pixel.
fn bilinear(image: &GrayImage, position: [f64; 2]) -> f64 {
    for (at, side) in position.into_iter().zip([image.dims.width, image.dims.height]) {
        assert!((-1.0 / 32.0..=f64::from(side - 1) + 1.0 / 32.0).contains(&at), "{at}");
    }
    reference::bilinear(image, position)
}

/// All raw rows one after the other; the frame's memory held something else before.
fn rectify(mesh: &LargeMesh, band: &mut LargeBand, raw: &GrayImage) -> Vec<u8> {
    let dims = mesh.dims();
    let mut frame = vec![0xa5; usize::from(dims.width) * usize::from(dims.height)];
    let mut expected = 0;
    band.restart();
    for row in raw.pixels.chunks(mesh.raw_dims().width.into()) {
        assert!(!band.is_complete(mesh) || expected == dims.height);
        let finished = band.push(mesh, row, &mut frame).unwrap();
        assert_eq!(finished.start, expected);
        expected = finished.end;
    }
    assert!(expected == dims.height && band.is_complete(mesh));
    frame
}

fn noise(dims: Dims, seed: u64) -> GrayImage {
    let mut random = Random(seed);
    painted(dims.width, dims.height, |_, _| random.grey())
}

#[test]
fn rows_are_bilinear_at_the_positions_of_the_mesh() {
    let mut band = Box::new(LargeBand::new());
    for (name, calibration, dims) in rigs() {
        for alpha in [0.0, 0.6, 1.0] {
            let rectification = calibration.rectify(dims, View::Alpha(alpha)).unwrap();
            let mesh = mesh(&rectification, CameraSide::Right);
            let raw = noise(mesh.raw_dims(), 3);
            let frame = rectify(&mesh, &mut band, &raw);
            let mut worst = 0.0_f64;
            for (row, y) in frame.chunks(dims.width.into()).zip(0..) {
                for (&found, x) in row.iter().zip(0..) {
                    let Some(source) = mesh.source(x, y) else {
                        assert_eq!(found, 0, "{name}: ({x}, {y}) has no source");
                        continue;
                    };
                    let exact = bilinear(&raw, source.map(|v| f64::from(v) / 65536.0));
                    worst = worst.max((f64::from(found) - exact).abs());
                }
            }
            // Fractions of 1/128 across: half of that times 255, and the rounding of the grey
            // level.
            assert!(worst <= 1.0 + 0.5 + 0.05, "{name}, alpha {alpha}: {worst} levels");
        }
    }
}

#[test]
fn a_restart_leaves_nothing_behind() {
    let (_, calibration, dims) = rigs().swap_remove(5);
    let rectification = calibration.rectify(dims, View::Alpha(1.0)).unwrap();
    let mesh = mesh(&rectification, CameraSide::Left);
    let (first, second) = (noise(mesh.raw_dims(), 5), noise(mesh.raw_dims(), 6));
    let mut band = Box::new(LargeBand::new());
    let expected = rectify(&mesh, &mut band, &second);
    for torn in [0, 1, 7, 100, 239, 240] {
        let mut other = Box::new(LargeBand::new());
        let mut frame = vec![1; expected.len()];
        for row in first.pixels.chunks(dims.width.into()).take(torn) {
            other.push(&mesh, row, &mut frame).unwrap();
        }
        assert_eq!(rectify(&mesh, &mut other, &second), expected, "torn after {torn} rows");
    }
}

#[test]
fn what_does_not_fit_is_refused_and_changes_nothing() {
    let (_, calibration, dims) = rigs().swap_remove(5);
    let rectification = calibration.rectify(dims, View::Alpha(0.0)).unwrap();
    let mut small = Box::new(Mesh::<100, 240>::new());
    let needed = mesh_nodes(dims);
    assert_eq!(
        small.build(&rectification.remap(), CameraSide::Left),
        Err(MeshError::Nodes { needed, given: 100 })
    );
    let mut low = Box::new(Mesh::<{ mesh_nodes(QVGA) }, 239>::new());
    assert_eq!(
        low.build(&rectification.remap(), CameraSide::Left),
        Err(MeshError::Rows { needed: 240, given: 239 })
    );

    let mesh = mesh(&rectification, CameraSide::Left);
    let mut frame = vec![9; 320 * 240];
    let given = 320 * 4;
    let row = [100; 320];
    let mut band = Box::new(Band::<{ 320 * 4 }>::new());
    assert_eq!(band.push(&low, &row, &mut frame), Err(RowError::NoMesh));
    assert_eq!(
        band.push(&mesh, &row, &mut frame),
        Err(RowError::Band { needed: mesh.band_bytes(), given })
    );
    let mut band = Box::new(LargeBand::new());
    assert_eq!(
        band.push(&mesh, &row[1..], &mut frame),
        Err(RowError::Width { needed: 320, given: 319 })
    );
    let short = &mut frame[1..];
    assert_eq!(
        band.push(&mesh, &row, short),
        Err(RowError::Frame { needed: 320 * 240, given: 320 * 240 - 1 })
    );
    assert!(frame.iter().all(|&grey| grey == 9) && band.raw_rows() == 0);
    for _ in 0..240 {
        band.push(&mesh, &row, &mut frame).unwrap();
    }
    assert!(band.is_complete(&mesh) && frame.iter().all(|&grey| grey == 100));
    assert_eq!(band.push(&mesh, &row, &mut frame), Err(RowError::TooMany));
    band.restart();
    assert!(!band.is_complete(&mesh) && band.raw_rows() == 0);
}

#[test]
fn a_band_of_exactly_the_stated_size_is_enough_and_one_row_less_is_not() {
    let (_, calibration, dims) = rigs().swap_remove(1);
    let rectification = calibration.rectify(dims, View::Alpha(0.0)).unwrap();
    let mesh = mesh(&rectification, CameraSide::Left);
    assert!(mesh.band_bytes() < 24 * 1024, "{} bytes", mesh.band_bytes());
    // As a rectified row needs them: from its least raw row to the last one that has come when it
    // is written.
    let (mut held, mut last) = (0, 0);
    for y in 0..dims.height {
        let rows = (0..dims.width).map(|x| mesh.source(x, y).unwrap()[1] >> 16);
        let (low, high) =
            rows.fold((i32::MAX, 0), |(low, high), row| (low.min(row.max(0)), high.max(row + 1)));
        last = high.min(i32::from(mesh.raw_dims().height) - 1).max(last);
        held = held.max(last - low + 1);
    }
    assert_eq!(held, i32::from(mesh.band_rows()));
}

/// The numbers of one matrix in OpenCV's XML.
fn matrix(xml: &str, name: &str) -> Vec<f64> {
    let (_, rest) = xml.split_once(&format!("<{name} ")).unwrap();
    let (_, rest) = rest.split_once("<data>").unwrap();
    let (data, _) = rest.split_once("</data>").unwrap();
    data.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

/// The captured pair with OpenCV's calibration: both raw images and OpenCV's own rectification.
struct Captured {
    raw: [GrayImage; 2],
    calibration: Calibration,
    rectification: Rectification,
    xml: String,
}

fn captured() -> Option<Captured> {
    let folder = captured::folder("robot_pairs/sparsestereo_example")?;
    let xml = std::fs::read_to_string(folder.join("calib.xml")).unwrap();
    let dims = Dims { width: 640, height: 480 };
    let camera = |m: &str, d: &str| {
        let (m, d) = (matrix(&xml, m), matrix(&xml, d));
        let lens = brown([d[0], d[1], d[4]], [d[2], d[3]]);
        Camera::new(dims, [m[0], m[4]], [m[2], m[5]], m[1], lens).unwrap()
    };
    let [r1, r2] = ["R1", "R2"].map(|name| Matrix3::from_row_slice(&matrix(&xml, name)));
    let p2 = matrix(&xml, "P2");
    let rotation = quaternion(r2.transpose() * r1);
    let translation = r2.row(0).transpose() * (p2[3] / p2[0]);
    let [left, right] = [camera("M1", "D1"), camera("M2", "D2")];
    let calibration = Calibration::new(left, right, rotation, translation.into()).unwrap();
    // An array of rows is a matrix's transpose, by columns.
    let rotations = [r1, r2].map(|rotation| rotation.transpose().into());
    let rectification = calibration.rectify_as(dims, rotations, p2[0], [p2[2], p2[6]]).unwrap();
    let raw = ["left.png", "right.png"].map(|name| load_gray(&folder.join(name)).unwrap());
    Some(Captured { raw, calibration, rectification, xml })
}

/// Raw position of a rectified pixel as OpenCV's documentation of `initUndistortRectifyMap` writes
/// it, by the camera's M, D, R and P; nothing of ours.
fn opencv_source([m, d, r, p]: &[Vec<f64>; 4], [x, y]: [f64; 2]) -> [f64; 2] {
    let ray = [(x - p[2]) / p[0], (y - p[6]) / p[5], 1.0];
    // The inverse of a rotation: its columns.
    let turned = [0, 1, 2].map(|i| r[i] * ray[0] + r[3 + i] * ray[1] + r[6 + i] * ray[2]);
    let (x, y) = (turned[0] / turned[2], turned[1] / turned[2]);
    let s = x * x + y * y;
    let radial = 1.0 + d[0] * s + d[1] * s * s + d[4] * s * s * s;
    let u = x * radial + 2.0 * d[2] * x * y + d[3] * (s + 2.0 * x * x);
    let v = y * radial + d[2] * (s + 2.0 * y * y) + 2.0 * d[3] * x * y;
    [m[0] * u + m[2], m[4] * v + m[5]]
}

#[test]
fn captured_pair_is_rectified_as_opencv_does() {
    let Some(Captured { raw, rectification, xml, .. }) = captured() else { return };
    let mut band = Box::new(LargeBand::new());
    for (eye, raw) in CameraSide::BOTH.into_iter().zip(&raw) {
        let mesh = mesh(&rectification, eye);
        let number = if eye == CameraSide::Left { 1 } else { 2 };
        let camera = ["M", "D", "R", "P"].map(|name| matrix(&xml, &format!("{name}{number}")));
        let frame = rectify(&mesh, &mut band, raw);
        let dims = mesh.dims();
        let (mut worst, mut pixels, mut off) = (0.0_f64, 0, 0);
        for y in 0..dims.height {
            let sources: Vec<_> = (0..dims.width)
                .map(|x| opencv_source(&camera, [f64::from(x), f64::from(y)]))
                .collect();
            // The longest run of pixels that OpenCV finds well inside: all of them have a source
            // here.
            let outside =
                |&[u, v]: &[f64; 2]| !((0.05..638.95).contains(&u) && (0.05..478.95).contains(&v));
            let runs = sources.split_inclusive(outside).scan(0, |start, run| {
                let from = *start;
                *start += run.len() as u16;
                Some(from..*start - u16::from(run.last().is_some_and(outside)))
            });
            let seen = runs.max_by_key(|run| run.len()).unwrap();
            for (x, [u, v]) in (0..).zip(sources.iter().copied()) {
                let Some(source) = mesh.source(x, y) else {
                    assert!(!seen.contains(&x), "({x}, {y}) comes from ({u}, {v})");
                    continue;
                };
                let [a, b] = source.map(|v| f64::from(v) / 65536.0);
                worst = worst.max((a - u).hypot(b - v));
                let exact = bilinear(raw, [u, v]);
                let found = frame[usize::from(y) * usize::from(dims.width) + usize::from(x)];
                off += i32::from((f64::from(found) - exact.round()).abs() > 1.0);
                pixels += 1;
            }
        }
        assert!(worst <= 0.02, "{eye:?}: {worst} px");
        assert!(
            f64::from(off) <= 0.001 * f64::from(pixels),
            "{eye:?}: {off} of {pixels} off by more than 1"
        );
    }
}

#[test]
fn captured_rotations_are_ours() {
    let Some(Captured { raw, calibration, rectification, .. }) = captured() else { return };
    // OpenCV's own choice for this pair, found again from its R and T alone: directions of pixels
    // agree.
    let view = View::Focal(rectification.focal());
    let ours = calibration.rectify(raw[0].dims, view).unwrap();
    let [dx, dy] = [0, 1].map(|i| ours.centre()[i] - rectification.centre()[i]);
    let mut worst = 0.0_f64;
    for eye in CameraSide::BOTH {
        for (x, y) in
            [(100.0, 80.0), (500.0, 100.0), (320.0, 240.0), (120.0, 400.0), (560.0, 380.0)]
        {
            let theirs = rectification.source(eye, [x, y]).unwrap();
            let same = ours.source(eye, [x + dx, y + dy]).unwrap();
            worst = worst.max((theirs[0] - same[0]).hypot(theirs[1] - same[1]));
        }
    }
    assert!(worst < 0.01, "{worst} px between OpenCV's rotations and ours");
}

/// Points of the normalised plane inside the image, from the middle outwards, with their pixel by
/// an oracle that shares no code.
fn oracle_pixel(
    lens: Lens,
    focal: [f64; 2],
    centre: [f64; 2],
    skew: f64,
    [x, y]: [f64; 2],
) -> [f64; 2] {
    let r = x.hypot(y);
    let radial = |[k1, k2, k3]: [f64; 3]| 1.0 + k1 * r.powi(2) + k2 * r.powi(4) + k3 * r.powi(6);
    let distorted = |radial: f64, [p1, p2]: [f64; 2]| {
        [
            x * radial + 2.0 * p1 * x * y + p2 * (r * r + 2.0 * x * x),
            y * radial + p1 * (r * r + 2.0 * y * y) + 2.0 * p2 * x * y,
        ]
    };
    let [dx, dy] = match lens {
        Lens::BrownConrady { k, p } => distorted(radial(k), p),
        Lens::Rational { k: [k1, k2, k3, k4, k5, k6], p } => {
            distorted(radial([k1, k2, k3]) / radial([k4, k5, k6]), p)
        }
        Lens::Fisheye { k: [k1, k2, k3, k4] } => {
            let t = r.atan();
            let d = t + k1 * t.powi(3) + k2 * t.powi(5) + k3 * t.powi(7) + k4 * t.powi(9);
            if r > 0.0 { [x * d / r, y * d / r] } else { [x, y] }
        }
    };
    [focal[0] * dx + skew * dy + centre[0], focal[1] * dy + centre[1]]
}

#[test]
fn rays_and_pixels_are_each_others_inverse_for_every_lens() {
    let (focal, centre, skew) = ([0.0, 0.0], [158.2, 121.7], 0.7);
    for (name, share, lens) in lenses() {
        let focal = focal.map(|_: f64| 320.0 * share);
        let camera = Camera::new(QVGA, focal, centre, skew, lens).unwrap();
        let (mut seen, mut worst) = (0, 0.0_f64);
        for v in (0..240).step_by(7) {
            for u in (0..320).step_by(7) {
                let raw = [f64::from(u), f64::from(v)];
                let Some([x, y]) = camera.unproject(raw) else { continue };
                let [a, b] = oracle_pixel(lens, focal, centre, skew, [x, y]);
                worst = worst.max((a - raw[0]).hypot(b - raw[1]));
                let [a, b] = camera.project([2.0 * x, 2.0 * y, 2.0]).unwrap();
                worst = worst.max((a - raw[0]).hypot(b - raw[1]));
                seen += 1;
            }
        }
        assert!(worst < 1e-6, "{name}: {worst} px");
        // Where a lens folds, what lies beyond has no ray; nothing else is lost.
        let reach = (1..4000)
            .map(|i| oracle_pixel(lens, [1.0; 2], [0.0; 2], 0.0, [f64::from(i) / 1000.0, 0.0])[0])
            .try_fold(0.0, |last, next| if next > last { Ok(next) } else { Err(last) });
        let (Ok(reach) | Err(reach)) = reach;
        let grid = (0..240)
            .step_by(7)
            .flat_map(|v| (0..320).step_by(7).map(move |u| [f64::from(u), f64::from(v)]));
        let inside =
            grid.filter(|[u, v]| (u - centre[0]).hypot(v - centre[1]) / focal[0] < reach).count();
        let missed = inside.abs_diff(seen);
        // The tangential part moves that edge by up to 2 px: 1 % of the pixels lie so close to it.
        assert!(missed * 100 <= inside, "{name}: {seen} pixels of {inside} are seen");
    }
}

#[test]
fn a_ray_behind_or_beyond_the_lens_has_no_pixel() {
    let lens = brown([-0.3, 0.0, 0.0], [0.0; 2]);
    let camera = Camera::new(QVGA, [250.0; 2], [160.0, 120.0], 0.0, lens).unwrap();
    assert_eq!(camera.project([0.1, 0.1, -1.0]), None);
    assert_eq!(camera.project([0.1, 0.1, 0.0]), None);
    // r (1 - 0.3 r^2) turns at r = 1.054.
    assert!(camera.project([1.0, 0.0, 1.0]).is_some());
    assert_eq!(camera.project([1.1, 0.0, 1.0]), None);
    let folded = Camera::new(QVGA, [90.0; 2], [160.0, 120.0], 0.0, lens);
    assert!(matches!(folded, Err(linestereo_rig::CameraError::Folds(_))), "{folded:?}");
}

#[test]
fn cameras_in_the_wrong_places_are_refused() {
    use linestereo_rig::CalibrationError;
    let camera = Camera::new(QVGA, [250.0; 2], [160.0, 120.0], 0.0, Lens::NONE).unwrap();
    let straight = [1.0, 0.0, 0.0, 0.0];
    let rig = |translation| Calibration::new(camera, camera, straight, translation);
    assert!(rig([-0.06, 0.0, 0.0]).is_ok());
    assert_eq!(rig([0.06, 0.0, 0.0]), Err(CalibrationError::Swapped));
    assert_eq!(rig([0.0, -0.06, 0.0]), Err(CalibrationError::NotSideBySide));
    assert_eq!(rig([0.0, 0.0, 0.06]), Err(CalibrationError::NotSideBySide));
    assert_eq!(rig([0.0; 3]), Err(CalibrationError::Baseline(0.0)));
    assert!(matches!(rig([f64::NAN, 0.0, 0.0]), Err(CalibrationError::Baseline(_))));
    let turned = Calibration::new(camera, camera, turned([0.0, 70.0, 0.0]), [-0.06, 0.0, 0.0]);
    assert_eq!(turned, Err(CalibrationError::Turned));
    let small = Camera::new(SMALL, [125.0; 2], [80.0, 60.0], 0.0, Lens::NONE).unwrap();
    let mixed = Calibration::new(camera, small, straight, [-0.06, 0.0, 0.0]);
    assert_eq!(mixed, Err(CalibrationError::SizesDiffer));
}

#[test]
fn points_far_away_lie_at_the_same_place_in_both_rectified_images() {
    for (name, calibration, dims) in rigs() {
        let rectification = calibration.rectify(dims, View::Alpha(0.0)).unwrap();
        let (focal, baseline, [cx, cy]) =
            (rectification.focal(), rectification.baseline(), rectification.centre());
        let [w, i, j, k] = calibration.rotation();
        let rotation = UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k));
        for (x, y) in [(20.0, 30.0), (80.0, 60.0), (100.0, 20.0)] {
            for depth in [1e7, 2.0] {
                // By the rig alone: a point in the left camera's coordinates, then in the right
                // one's.
                let left_raw = rectification.source(CameraSide::Left, [x, y]).unwrap();
                let [a, b] = rectification.camera(CameraSide::Left).unproject(left_raw).unwrap();
                let ray = Vector3::new(a, b, 1.0);
                // Distance along the common z axis: that of the ray's length for the wanted depth.
                let common = Vector3::new((x - cx) / focal, (y - cy) / focal, 1.0);
                let point = ray * (depth * common.norm() / ray.norm());
                let right = rotation * point + Vector3::from(calibration.translation());
                let camera = rectification.camera(CameraSide::Right);
                let right_raw = camera.project(right.into()).unwrap();
                let [rx, ry] = rectification.rectified(CameraSide::Right, right_raw).unwrap();
                let disparity = focal * baseline / depth;
                assert!(
                    (x - rx - disparity).abs() < 1e-4 && (y - ry).abs() < 1e-4,
                    "{name}: ({x}, {y}) at ({rx}, {ry})"
                );
            }
        }
    }
}
