//! Folders of pairs as data sets store them: tiny ones of every layout, real frames laid out anew,
//! and everything that can be wrong.

use crate::support::Folder;
use image::{DynamicImage, GrayImage, ImageBuffer, Luma, Rgb};
use linestereo::{Dims, Params, Rig, health::HealthFlags};
use linestereo_calibration::rectify_raw;
use linestereo_frames::{
    Dataset, DisparityFault, FrameError, Layout, LayoutFault, Scene, find_scenes, layouts,
    load_disparities, load_scene,
};
use linestereo_sim::engine::Engine;
use linestereo_tests::captured;
use std::fs;
use std::io::Write;

const WIDTH: u32 = 48;
const HEIGHT: u32 = 20;
/// True disparity of every pixel that is known; the first column is not.
const TRUTH: f32 = 6.5;

fn texture(x: u32, y: u32) -> u8 {
    (x * 37 + y * 91 + x * y * 7 % 50) as u8
}

/// An 8-bit image of the usual size.
fn image(value: impl Fn(u32, u32) -> u8) -> File {
    image_of(WIDTH, HEIGHT, value)
}

fn image_of(width: u32, height: u32, value: impl Fn(u32, u32) -> u8) -> File {
    File::Image(GrayImage::from_fn(width, height, |x, y| Luma([value(x, y)])).into())
}

fn image_16(value: impl Fn(u32, u32) -> u16) -> File {
    let image = ImageBuffer::<Luma<u16>, _>::from_fn(WIDTH, HEIGHT, |x, y| Luma([value(x, y)]));
    File::Image(image.into())
}

fn grey() -> File {
    image(texture)
}

fn grey_16() -> File {
    image_16(|x, y| u16::from(texture(x, y)) * 257)
}

fn colour() -> File {
    let image = image::RgbImage::from_fn(WIDTH, HEIGHT, |x, y| Rgb([texture(x, y); 3]));
    File::Image(image.into())
}

/// Truth in steps of 1/`steps` px; 0 = unknown.
fn steps_8(steps: f32) -> File {
    image(|x, _| if x == 0 { 0 } else { (TRUTH * steps) as u8 })
}

fn steps_16() -> File {
    image_16(|x, _| if x == 0 { 0 } else { (TRUTH * 256.0) as u16 })
}

/// The truth as floats: unknown is infinite or not a number.
fn values(unknown: f32) -> Vec<f32> {
    (0..WIDTH * HEIGHT)
        .map(|i| if i % WIDTH == 0 { unknown } else { TRUTH + (i / WIDTH) as f32 / 64.0 })
        .collect()
}

fn pfm(values: &[f32], scale: &str, is_big: bool) -> Vec<u8> {
    let mut bytes = format!("Pf\n{WIDTH} {HEIGHT}\n{scale}\n").into_bytes();
    for row in values.chunks(WIDTH as usize).rev() {
        bytes.extend(
            row.iter()
                .flat_map(|value| if is_big { value.to_be_bytes() } else { value.to_le_bytes() }),
        );
    }
    bytes
}

fn npy(kind: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

fn npz(arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in arrays {
        let options = zip::write::SimpleFileOptions::default()
            .compression_method(zip::CompressionMethod::Deflated);
        archive.start_file(format!("{name}.npy"), options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// Content of a file of a tiny data set.
#[derive(Clone)]
enum File {
    Image(DynamicImage),
    Bytes(Vec<u8>),
}

fn text(content: &str) -> File {
    File::Bytes(content.as_bytes().to_vec())
}

fn folder(files: &[(impl AsRef<str>, File)]) -> Folder {
    let folder = Folder::new();
    for (name, file) in files {
        let path = folder.path().join(name.as_ref());
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        match file {
            File::Image(image) => image.save(&path).unwrap(),
            File::Bytes(bytes) => fs::write(&path, bytes).unwrap(),
        }
    }
    folder
}

const CALIB: &str = "cam0=[400.5 0 20; 0 400.5 10; 0 0 1]\ncam1=[400.5 0 23; 0 400.5 10; 0 0 1]\ndoffs=3\nbaseline=150\n\
                     width=48\nheight=20\nndisp=30\nisint=0\n";
const KITTI_2012: &str = "P0: 400 0 20 0 0 400 10 0 0 0 1 0\nP1: 400 0 20 -200 0 400 10 0 0 0 1 0\n\
                          P2: 400 0 20 30 0 400 10 0 0 0 1 0\nP3: 400 0 20 -190 0 400 10 0 0 0 1 0\n";

/// The only pair of a folder, loaded.
fn only(folder: &Folder, layout: Layout) -> Scene {
    let set = Dataset::find(folder.path()).unwrap();
    assert_eq!(layouts(&set.pairs), [(layout, 1)], "{:?}", set.pairs);
    set.pairs[0].load(None, &rectify_raw).unwrap()
}

fn names(set: &Dataset) -> Vec<&str> {
    set.pairs.iter().map(|pair| pair.name.as_str()).collect()
}

/// Truth is known but for the first column, and as it was stored.
fn check_truth(scene: &Scene, slanted: bool) {
    let truth = scene.truth.as_ref().unwrap();
    assert_eq!(truth.dims(), Dims { width: WIDTH as u16, height: HEIGHT as u16 });
    for y in [0, 7, HEIGHT as i32 - 1] {
        let expected = TRUTH + if slanted { y as f32 / 64.0 } else { 0.0 };
        assert_eq!((truth.disparity(0, y), truth.disparity(1, y)), (None, Some(expected)));
    }
}

#[test]
fn middlebury_2001_and_2003() {
    let set = folder(&[
        ("venus/im2.ppm", colour()),
        ("venus/im6.ppm", colour()),
        ("venus/disp2.pgm", steps_8(8.0)),
        ("venus/disp6.pgm", steps_8(8.0)),
        ("tsukuba/scene1.row3.col3.ppm", colour()),
        ("tsukuba/scene1.row3.col4.ppm", colour()),
        ("tsukuba/truedisp.row3.col3.pgm", steps_8(16.0)),
        ("map/im0.pgm", grey()),
        ("map/im1.pgm", grey()),
        ("map/disp0.pgm", steps_8(8.0)),
    ]);
    let found = Dataset::find(set.path()).unwrap();
    assert_eq!(layouts(&found.pairs), [(Layout::Middlebury2001, 3)]);
    assert_eq!(names(&found), ["map", "tsukuba", "venus"]);
    for pair in &found.pairs {
        let scene = pair.load(None, &rectify_raw).unwrap();
        check_truth(&scene, false);
        assert_eq!((scene.rig, scene.max_disparity), (None, 16), "{}", scene.name);
        assert_eq!(scene.left.pixels[3], texture(3, 0));
    }
    // 2003: the steps follow from the rows, 375 of them here.
    let set = folder(&[
        ("im2.png", image_of(40, 375, texture)),
        ("im6.png", image_of(40, 375, texture)),
        ("disp2.png", image_of(40, 375, |_, _| 50)),
        ("disp6.png", image_of(40, 375, |_, _| 50)),
    ]);
    let truth = only(&set, Layout::Middlebury2003).truth.unwrap();
    assert_eq!(
        (truth.disparity(20, 9), truth.is_visible(12, 9), truth.is_visible(13, 9)),
        (Some(12.5), false, true)
    );
}

#[test]
fn middlebury_2005_and_2006() {
    let view = || image_of(240, 370, texture);
    let truth = || image_of(240, 370, |_, _| 21);
    let two_views = folder(&[
        ("Art/view1.png", view()),
        ("Art/view5.png", view()),
        ("Art/disp1.png", truth()),
        ("Art/disp5.png", truth()),
        ("Art/dmin.txt", text("150\n")),
    ]);
    let scene = only(&two_views, Layout::Middlebury2006);
    assert_eq!((scene.name.as_str(), scene.truth.unwrap().disparity(9, 9)), ("Art", Some(7.0)));
    assert_eq!(scene.rig, Some(Rig::new(3740.0 / 3.0, 0.16, 50.0).unwrap()));

    let exposures = folder(&[
        ("Art/Illum1/Exp0/view1.png", view()),
        ("Art/Illum1/Exp0/view5.png", view()),
        ("Art/Illum2/Exp1/view1.png", view()),
        ("Art/Illum2/Exp1/view5.png", view()),
        ("Art/disp1.png", truth()),
        ("Art/dmin.txt", text("150")),
    ]);
    let found = Dataset::find(exposures.path()).unwrap();
    assert_eq!(names(&found), ["Art/Illum1/Exp0", "Art/Illum2/Exp1"]);
    for pair in &found.pairs {
        let truth = pair.load(None, &rectify_raw).unwrap().truth.unwrap();
        assert_eq!(truth.disparity(9, 9), Some(7.0));
    }

    // Resized by somebody: nothing says what a grey value is.
    let resized = folder(&[
        ("view1.png", grey()),
        ("view5.png", grey()),
        ("disp1.png", steps_8(3.0)),
        ("dmin.txt", text("150")),
    ]);
    let error =
        Dataset::find(resized.path()).unwrap().pairs[0].load(None, &rectify_raw).unwrap_err();
    assert!(matches!(error, FrameError::Layout(_, LayoutFault::TruthScale(_))), "{error}");
}

#[test]
fn middlebury_2014_and_eth3d() {
    let images = || [("im0.png", colour()), ("im1.png", colour()), ("calib.txt", text(CALIB))];
    for unknown in [f32::INFINITY, f32::NAN, f32::NEG_INFINITY] {
        for (scale, is_big) in [("-1.0", false), ("1", true), ("-0.0039", false)] {
            let truth = [("disp0.pfm", File::Bytes(pfm(&values(unknown), scale, is_big)))];
            let set = folder(&images().into_iter().chain(truth).collect::<Vec<_>>());
            let scene = only(&set, Layout::Middlebury2014);
            check_truth(&scene, true);
            assert_eq!(
                (scene.rig, scene.max_disparity),
                (Some(Rig::new(400.5, 0.15, 3.0).unwrap()), 30)
            );
        }
    }
    // Version 3 of the benchmark: a mask says what is visible.
    let mask = || image(|x, _| if x < 24 { 128 } else { 255 });
    let truth = || File::Bytes(pfm(&values(f32::INFINITY), "-1", false));
    let benchmark = [("disp0GT.pfm", truth()), ("mask0nocc.png", mask())];
    let set = folder(&images().into_iter().chain(benchmark).collect::<Vec<_>>());
    let visible = only(&set, Layout::Middlebury2014).truth.unwrap();
    assert!(!visible.is_visible(23, 5) && visible.is_visible(24, 5));

    // ETH3D: truth in a folder of its own; what it calls ndisp is the width.
    let set = folder(&[
        ("two_view_training/forest_1s/im0.png", grey()),
        ("two_view_training/forest_1s/im1.png", grey()),
        (
            "two_view_training/forest_1s/calib.txt",
            text(
                &CALIB
                    .replace("ndisp=30", "ndisp=48")
                    .replace("doffs=3", "doffs=0")
                    .replace("0 23;", "0 20;"),
            ),
        ),
        ("two_view_training/forest_1s/cameras.txt", text("")),
        ("two_view_training/forest_1s/images.txt", text("")),
        ("two_view_training_gt/forest_1s/disp0GT.pfm", truth()),
        ("two_view_training_gt/forest_1s/mask0nocc.png", mask()),
    ]);
    let scene = only(&set, Layout::Eth3d);
    check_truth(&scene, true);
    assert_eq!((scene.name.as_str(), scene.max_disparity), ("two_view_training/forest_1s", 16));
    assert!(
        !scene.truth.as_ref().unwrap().is_visible(23, 5) && scene.truth.unwrap().is_visible(24, 5)
    );
}

#[test]
fn kitti_2012_and_2015() {
    let visible = image_16(|x, _| if x < 24 { 0 } else { (TRUTH * 256.0) as u16 });
    let rectified =
        KITTI_2012.replace("P2", "P_rect_02").replace("P3", "P_rect_03").replace("30 0", "44.5 0");
    for (layout, images, truth, calibration, baseline) in [
        (
            Layout::Kitti2012,
            ["image_0", "image_1"],
            ["disp_occ", "disp_noc"],
            ("calib", KITTI_2012),
            0.5,
        ),
        (
            Layout::Kitti2012,
            ["colored_0", "colored_1"],
            ["disp_occ", "disp_noc"],
            ("calib", KITTI_2012),
            0.55,
        ),
        (
            Layout::Kitti2015,
            ["image_2", "image_3"],
            ["disp_occ_0", "disp_noc_0"],
            ("calib_cam_to_cam", &rectified),
            234.5 / 400.0,
        ),
    ] {
        let at = |folder: &str, file: &str| format!("training/{folder}/{file}");
        let files = [
            (at(images[0], "000007_10.png"), colour()),
            (at(images[1], "000007_10.png"), colour()),
            (at(images[0], "000007_11.png"), colour()),
            (at(images[1], "000007_11.png"), colour()),
            (at(truth[0], "000007_10.png"), steps_16()),
            (at(truth[1], "000007_10.png"), visible.clone()),
            (at(calibration.0, "000007.txt"), text(calibration.1)),
        ];
        let set = folder(&files);
        let found = Dataset::find(set.path()).unwrap();
        assert_eq!(layouts(&found.pairs), [(layout, 2)]);
        let names: Vec<_> =
            found.pairs.iter().map(|pair| (pair.name.as_str(), pair.has_truth())).collect();
        assert_eq!(names, [("training/000007_10", true), ("training/000007_11", false)]);
        let scene = found.pairs[0].load(None, &rectify_raw).unwrap();
        check_truth(&scene, false);
        assert_eq!(scene.rig, Some(Rig::new(400.0, baseline, 0.0).unwrap()));
        let truth = scene.truth.unwrap();
        assert!(!truth.is_visible(23, 5) && truth.is_visible(24, 5));
        assert_eq!(
            found.pairs[1].load(None, &rectify_raw).unwrap().max_disparity,
            47,
            "of 48 columns"
        );
    }
}

#[test]
fn euroc_is_rectified_by_its_sensor_files() {
    let sensor = |x: f64| {
        format!(
            "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1.0, 0.0, 0.0, {x}, 0.0, 1.0, 0.0, 0.0, \
             0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]\nresolution: [48, 20]\ncamera_model: pinhole\n\
             intrinsics: [40.0, 40.0, 23.5, 9.5]\ndistortion_model: radial-tangential\n\
             distortion_coefficients: [0.0, 0.0, 0.0, 0.0]\n"
        )
    };
    // Two levels a pixel to the right, three downwards.
    let slope = || image(|x, y| (2 * x + 3 * y + 40) as u8);
    let files = |root: &str| {
        let images = ["140", "150"].into_iter().flat_map(|time| {
            ["cam0", "cam1"]
                .map(|camera| (format!("{root}{camera}/data/{time}3715273262142976.png"), slope()))
        });
        let sensors = [("cam0", 0.0), ("cam1", 0.1)];
        let sensors =
            sensors.map(|(camera, x)| (format!("{root}{camera}/sensor.yaml"), text(&sensor(x))));
        images.chain(sensors).collect::<Vec<_>>()
    };
    for root in ["MH_01/mav0/", "MH_01/"] {
        let files = files(root);
        let set = folder(&files);
        let found = Dataset::find(set.path()).unwrap();
        assert_eq!(layouts(&found.pairs), [(Layout::Euroc, 2)]);
        assert_eq!(found.pairs[0].name, "MH_01/1403715273262142976");
        let scene = found.pairs[0].load(None, &rectify_raw).unwrap();
        // Without a lens and side by side already: the images as they are, but for less than 1 % of
        // the view, which is cut so that every pixel has a source (0.2 px along the row, 0.1 px
        // down), for the mesh's 1/32 px and for rounding.
        let (found, drawn) = (f64::from(scene.left.pixels[5]), f64::from(2 * 5 + 40));
        assert!(
            (found - drawn).abs() <= 2.0 * 0.23 + 3.0 * 0.13 + 1.0 && scene.truth.is_none(),
            "{found} {drawn}"
        );
        let rig = scene.rig_numbers.unwrap();
        assert!(
            (40.0..40.4).contains(&rig.focal_px) && (rig.baseline_m - 0.1).abs() < 1e-9,
            "{rig:?}"
        );

        fs::remove_file(set.path().join(root).join("cam1/sensor.yaml")).unwrap();
        let error = Dataset::find(set.path()).unwrap_err();
        assert!(
            matches!(&error, FrameError::Layout(path, LayoutFault::MissingCalibration(Layout::Euroc)) if path.ends_with("cam1/sensor.yaml")),
            "{error}"
        );
    }
}

#[test]
fn plain_folders_sequences_and_side_by_side() {
    let array = |kind, data: &[u8]| npz(&[("arr_0", npy(kind, "(20, 48)", data))]);
    let doubles: Vec<u8> =
        values(f32::NAN).iter().flat_map(|value| f64::from(*value).to_be_bytes()).collect();
    let set = folder(&[
        ("left/2.png", grey_16()),
        ("right/2.png", grey_16()),
        ("left/10.pgm", grey()),
        ("right/10.pgm", grey_16()),
        ("left/11.png", grey()),
        ("disp/2.npz", File::Bytes(array("<f4", &floats(&values(f32::INFINITY))))),
        ("disp/10.npy", File::Bytes(npy(">f8", "(20, 48)", &doubles))),
        (
            "scene.json",
            text(r#"{"max_disparity":24,"rectified":{"focal_px":100,"baseline_m":0.1}}"#),
        ),
    ]);
    let found = Dataset::find(set.path()).unwrap();
    assert_eq!((layouts(&found.pairs), found.alone), (vec![(Layout::CameraFolders, 2)], 1));
    for (pair, name) in found.pairs.iter().zip(["2", "10"]) {
        let scene = pair.load(None, &rectify_raw).unwrap();
        assert_eq!(
            (scene.name.as_str(), scene.max_disparity, scene.left.pixels[5]),
            (name, 24, texture(5, 0))
        );
        assert_eq!(scene.rig, Some(Rig::new(100.0, 0.1, 0.0).unwrap()));
        check_truth(&scene, true);
    }

    let set = folder(&[
        ("a/0001_left.png", grey()),
        ("a/0001_right.png", grey()),
        ("a/0001_disp.png", steps_16()),
        ("a/0002_left.png", grey()),
        ("a/0002_right.png", grey()),
        ("b/left.ppm", colour()),
        ("b/right.jpg", grey()),
        ("b/gt.pfm", File::Bytes(pfm(&values(f32::INFINITY), "-1", false))),
    ]);
    let found = Dataset::find(set.path()).unwrap();
    assert_eq!(layouts(&found.pairs), [(Layout::SidesInNames, 2), (Layout::PairFolder, 1)]);
    let names: Vec<_> =
        found.pairs.iter().map(|pair| (pair.name.as_str(), pair.has_truth())).collect();
    assert_eq!(names, [("a/0001", true), ("a/0002", false), ("b", true)]);
    check_truth(&found.pairs[0].load(None, &rectify_raw).unwrap(), false);
    check_truth(&found.pairs[2].load(None, &rectify_raw).unwrap(), true);

    let set = folder(&[
        ("x/1.png", image_of(2 * WIDTH + 1, HEIGHT, texture)),
        ("x/square.png", image_of(48, 48, |_, _| 0)),
    ]);
    let sequence = Dataset::sequence(set.path(), false).unwrap();
    let found = (layouts(&sequence.pairs), sequence.alone, &*sequence.pairs[0].name);
    assert_eq!(found, (vec![(Layout::SideBySide, 1)], 0, "x/1"));
    let scene = only(&set, Layout::SideBySide);
    assert_eq!((scene.left.pixels[47], scene.right.pixels[0]), (texture(47, 0), texture(49, 0)));
}

#[test]
fn truth_of_one_file_and_scale_for_a_scene_file() {
    let set = folder(&[
        ("left.png", grey()),
        ("right.png", grey()),
        (
            "d.npz",
            File::Bytes(npz(&[
                ("mask", npy("|u1", "(1,)", &[1])),
                ("disp", npy("<f4", "(20, 48)", &floats(&values(f32::INFINITY)))),
            ])),
        ),
        (
            "scene.json",
            text(r#"{"scene":"s","ground_truth":{"file":"d.npz","disparity_scale":1}}"#),
        ),
    ]);
    let scene = only(&set, Layout::SceneJson);
    assert_eq!(scene.name, "s");
    check_truth(&scene, true);
    check_truth(&load_scene(set.path(), None).unwrap(), true);
}

fn fault(bytes: &[u8]) -> DisparityFault {
    let set = folder(&[("d.pfm", File::Bytes(bytes.to_vec()))]);
    match load_disparities(&set.path().join("d.pfm")) {
        Err(error @ FrameError::Disparities(..)) => {
            let line = error.to_string();
            assert!(line.contains("d.pfm: ") && line.contains("; "), "{line}");
            let FrameError::Disparities(_, fault) = error else { unreachable!() };
            fault
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn damaged_float_files_are_named() {
    let good = pfm(&values(f32::INFINITY), "-1", false);
    let bytes = 4 * u64::from(WIDTH * HEIGHT);
    let cut = |left: usize| DisparityFault::Truncated { needed: bytes, found: bytes - left as u64 };
    assert_eq!(fault(&good[..good.len() - 1]), cut(1));
    assert_eq!(fault(&good[..good.len() - 700]), cut(700));
    for (scale, says_big) in [("1.0", true), ("-1.0", false)] {
        let found = fault(&pfm(&values(f32::INFINITY), scale, !says_big));
        assert_eq!(found, DisparityFault::ByteOrder { says_big });
    }
    for marker in ["0", "0.0", "x", "nan"] {
        let found = fault(&pfm(&values(f32::INFINITY), marker, false));
        assert_eq!(found, DisparityFault::NoByteOrder(marker.to_owned()));
    }
    for nothing in [f32::INFINITY, f32::NAN] {
        let unknown = vec![nothing; (WIDTH * HEIGHT) as usize];
        assert_eq!(fault(&pfm(&unknown, "-1", false)), DisparityFault::NothingKnown);
    }
    assert_eq!(fault(b"PF\n1 1\n-1\n000000000000"), DisparityFault::Coloured);
    for header in [
        "P5\n1 1\n255\n0", "Pf\n0 1\n-1\n", "Pf\n99999999 99999999\n-1\n", "Pf\n4", "", "Pf\n4 4\n",
    ] {
        assert!(matches!(fault(header.as_bytes()), DisparityFault::Header(_)), "{header}");
    }
}

#[test]
fn damaged_arrays_are_named() {
    let good = npy("<f4", "(20, 48)", &floats(&values(f32::NAN)));
    for cut in [&good[..good.len() - 4], &npy("<f4", "(5000, 6000)", &[0; 8])] {
        assert!(matches!(fault(cut), DisparityFault::Truncated { .. }));
    }
    for (text, shape) in [
        ("(60000, 60000)", &[60_000, 60_000][..]),
        ("(99999, 2)", &[99_999, 2]),
        ("(4,)", &[4]),
        ("(2, 1, 2, 1)", &[2, 1, 2, 1]),
    ] {
        let found = fault(&npy("<f4", text, &[0; 16]));
        assert_eq!(found, DisparityFault::Shape(shape.to_vec()));
    }
    assert!(matches!(fault(&npy("<c8", "(2, 1)", &[0; 16])), DisparityFault::ElementType(_)));
    assert!(matches!(fault(b"\x93NUMPY\x01\x00\x05\x00{'a'}"), DisparityFault::Array(_)));
    assert!(matches!(fault(b"PK\x03\x04 and no archive"), DisparityFault::Array(_)));
    assert_eq!(fault(&npz(&[])), DisparityFault::Arrays(vec![]));
    fault(b"\x93NUMPY\x02\x00\xff\xff\xff\xff{}");
    for shape in [
        "(99999999999, 99999999999)",
        "(65535, 65535, 65535)",
        "(65535, 65535)",
        "(9, 9, 9, 9)",
        "(0, 0)",
        "(-1, 4)",
        &"(".repeat(9000),
    ] {
        fault(&npy("<f4", shape, &[0; 64]));
    }
    let two = npz(&[("a", good.clone()), ("b", good)]);
    let DisparityFault::Arrays(mut names) = fault(&two) else { panic!() };
    names.sort();
    assert_eq!(names, ["a", "b"]);
}

#[test]
fn what_is_missing_or_does_not_fit_is_named() {
    let fault = |files: &[(&str, File)]| {
        let set = folder(files);
        let error = Dataset::find(set.path())
            .and_then(|found| found.pairs[0].load(None, &rectify_raw))
            .unwrap_err();
        assert!(error.to_string().contains("; "), "{error}");
        error
    };
    let truth = || File::Bytes(pfm(&values(f32::INFINITY), "-1", false));
    let doffs = text("cam0=[400 0 1; 0 400 1; 0 0 1]\ndoffs=nan\nbaseline=3\n");
    let middlebury = || vec![("im0.png", grey()), ("im1.png", grey()), ("disp0.pfm", truth())];
    let with = |calibration| [middlebury(), vec![("calib.txt", calibration)]].concat();
    let dims = Dims { width: WIDTH as u16, height: HEIGHT as u16 };
    for (files, end, expected) in [
        (middlebury(), "calib.txt", LayoutFault::MissingCalibration(Layout::Middlebury2014)),
        (with(doffs), "calib.txt", LayoutFault::Calibration("doffs")),
        (with(text("baseline=3\n")), "calib.txt", LayoutFault::Calibration("cam0")),
        (
            vec![("view1.png", grey()), ("view5.png", grey()), ("disp1.png", grey())],
            "dmin.txt",
            LayoutFault::MissingCalibration(Layout::Middlebury2006),
        ),
        (
            vec![("image_2/000000_10.png", grey()), ("image_3/000000_10.png", grey())],
            "calib_cam_to_cam/000000.txt",
            LayoutFault::MissingCalibration(Layout::Kitti2015),
        ),
        (
            vec![("left.png", grey()), ("right.png", grey()), ("disp.png", steps_8(8.0))],
            "disp.png",
            LayoutFault::TruthScale(dims),
        ),
        (vec![("readme.txt", text("nothing here"))], "", LayoutFault::NotRecognised),
    ] {
        match fault(&files) {
            FrameError::Layout(path, found) => {
                assert_eq!(found, expected);
                assert!(path.ends_with(end), "{path:?} is not {end}");
            }
            other => panic!("{other} is not {expected}"),
        }
    }

    let small = || image_of(32, HEIGHT, texture);
    let error = fault(&[("left.png", grey()), ("right.png", small())]);
    assert!(matches!(error, FrameError::SizesDiffer { .. }), "{error}");
    let error = fault(&[("left.png", small()), ("right.png", small()), ("disp.pfm", truth())]);
    assert!(
        matches!(&error, FrameError::SizesDiffer { second: (path, _), .. } if path.ends_with("disp.pfm")),
        "{error}"
    );
}

/// A scene's folder, its layout, its files and what the data set calls them, and what `dmin.txt`
/// says.
type Renamed =
    (&'static str, Layout, &'static [(&'static str, &'static str)], Option<&'static str>);

/// Real scenes, under their data set's own names, are what they are with a `scene.json`.
#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn captured_scenes_in_their_own_layout() {
    let cases: [Renamed; 4] = [
        (
            "middlebury2003/teddy",
            Layout::Middlebury2003,
            &[("left", "im2"), ("right", "im6"), ("gt", "disp2"), ("gt_right", "disp6")],
            None,
        ),
        (
            "middlebury2001/tsukuba",
            Layout::Middlebury2001,
            &[
                ("left", "scene1.row3.col3"),
                ("right", "scene1.row3.col4"),
                ("gt", "truedisp.row3.col3"),
            ],
            None,
        ),
        (
            "middlebury2006_third/Aloe",
            Layout::Middlebury2006,
            &[("left", "view1"), ("right", "view5"), ("gt", "disp1"), ("gt_right", "disp5")],
            Some("270"),
        ),
        (
            "middlebury2005_half/Art",
            Layout::Middlebury2006,
            &[("left", "view1"), ("right", "view5"), ("gt", "disp1"), ("gt_right", "disp5")],
            Some("200"),
        ),
    ];
    for (name, layout, renamed, least) in cases {
        let Some(source) = captured::folder(name) else { return };
        let set = Folder::new();
        for (from, to) in renamed {
            for ending in ["png", "ppm", "jpg"] {
                let from = source.join(format!("{from}.{ending}"));
                if from.is_file() {
                    fs::copy(&from, set.path().join(format!("{to}.{ending}"))).unwrap();
                }
            }
        }
        if let Some(least) = least {
            fs::write(set.path().join("dmin.txt"), least).unwrap();
        }
        let (found, known) = (only(&set, layout), load_scene(&source, None).unwrap());
        assert!(found.left == known.left && found.right == known.right, "{name}");
        let [truth, expected] = [found.truth.unwrap(), known.truth.unwrap()];
        let pixels = || {
            (0..i32::from(truth.dims().height))
                .flat_map(|y| (0..i32::from(truth.dims().width)).map(move |x| (x, y)))
        };
        assert!(pixels().all(|(x, y)| truth.disparity(x, y) == expected.disparity(x, y)), "{name}");
        if let Some(rig) = known.rig_numbers {
            let numbers = found.rig_numbers.unwrap();
            assert!(
                (numbers.focal_px - rig.focal_px).abs() < 1e-3
                    && numbers.baseline_m == rig.baseline_m,
                "{name}: {numbers:?}"
            );
            assert!(
                (numbers.offset_px - rig.offset_px).abs() < 1e-9,
                "{name}: {numbers:?} {rig:?}"
            );
        }
    }
}

#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn captured_folders_are_recognised() {
    let Some(qvga) = captured::folder("qvga") else { return };
    let found = Dataset::find(&qvga).unwrap();
    let folders: Vec<_> = found.pairs.iter().map(|pair| pair.folder.clone()).collect();
    assert_eq!(folders, find_scenes(&qvga).unwrap());
    assert!(
        layouts(&found.pairs).len() == 1
            && found.pairs.iter().all(|pair| pair.layout == Layout::SceneJson && pair.has_truth())
    );
    if let Some(boards) = captured::folder("calibration_boards") {
        assert_eq!(
            layouts(&Dataset::find(&boards).unwrap().pairs),
            [(Layout::SidesInNames, 13 + 28)]
        );
    }
    if let Some(flights) = captured::folder("tudelft_stereoboard") {
        let found = Dataset::find(&flights).unwrap();
        assert_eq!((layouts(&found.pairs), found.alone), (vec![(Layout::SidesInNames, 149)], 0));
    }
}

/// Rows of a drone's raw pairs agree once they are loaded, at two sizes, and do not before.
#[test]
#[cfg_attr(not(captured), ignore = "no captured frames: LINESTEREO_FRAMES names them")]
fn captured_euroc_pairs_are_rectified() {
    let Some(source) = captured::folder("euroc_micro") else { return };
    let set = Folder::new();
    for (camera, side) in [("cam0", "left"), ("cam1", "right")] {
        let data = set.path().join("mav0").join(camera).join("data");
        fs::create_dir_all(&data).unwrap();
        fs::copy(source.join(format!("{camera}_sensor.yaml")), data.with_file_name("sensor.yaml"))
            .unwrap();
        for folder in find_scenes(&source).unwrap() {
            let name = format!("{}.png", folder.file_name().unwrap().to_string_lossy());
            fs::copy(folder.join(side).with_extension("png"), data.join(name)).unwrap();
        }
    }
    let found = Dataset::find(set.path()).unwrap();
    assert_eq!(layouts(&found.pairs), [(Layout::Euroc, 5)]);
    let rows_off = |scene: &Scene, max_disparity| {
        let params = Params { max_disparity, ..Params::default() };
        let mut engine = Engine::new(&params, scene.left.dims).unwrap();
        let result = engine.run(scene.left.view().unwrap(), scene.right.view().unwrap()).unwrap();
        let flags = result.health.of_pair();
        flags
            .intersects(HealthFlags::ROWS_OFF | HealthFlags::ROWS_UNEVEN | HealthFlags::FEW_MATCHES)
    };
    let raw = Dataset::find(&source).unwrap();
    for (pair, raw) in found.pairs.iter().zip(&raw.pairs) {
        assert!(!rows_off(&pair.load(None, &rectify_raw).unwrap(), 96), "{}", pair.name);
        assert!(!rows_off(&pair.load(Some(376), &rectify_raw).unwrap(), 48), "{}", pair.name);
        assert!(rows_off(&raw.load(None, &rectify_raw).unwrap(), 96), "{} raw", raw.name);
    }
}
