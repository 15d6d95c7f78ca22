//! Rigs of other programs: conventions by worked examples, real files, and files that mean harm.
//!
//! The worked example: the right camera stands 100 mm to the right of the left one and is turned
//! inwards by atan(3/4). Its axes in left coordinates are x (0.8, 0, 0.6), y (0, 1, 0), z (-0.6, 0,
//! 0.8): the rows of R. So X = (0, 0, 1) m is at (0.52, 0, 0.86) in it.

use crate::support::{Folder, says};
use linestereo::Dims;
use linestereo_calibration::interchange::{
    Format, Imported, InterchangeError, LensModel, Options, Problem, TranslationUnit, export,
    load_rig,
};
use linestereo_calibration::rig_file::RigFile;
use linestereo_rig::{Calibration, CameraSide, Lens, View};
use linestereo_tests::captured;
use std::path::PathBuf;

const SIZE: Dims = Dims { width: 640, height: 480 };

fn files(texts: &[&str]) -> (Folder, Vec<PathBuf>) {
    let folder = Folder::new();
    let paths =
        (0..texts.len()).map(|i| folder.path().join(format!("file{i}.txt"))).collect::<Vec<_>>();
    for (path, text) in paths.iter().zip(texts) {
        std::fs::write(path, text).unwrap();
    }
    (folder, paths)
}

pub(crate) fn read(texts: &[&str], options: &Options) -> Result<Imported, InterchangeError> {
    let (_folder, paths) = files(texts);
    load_rig(&paths, options)
}

pub(crate) fn good(texts: &[&str]) -> Imported {
    read(texts, &Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A rig as it is read from its files in this format.
pub(crate) fn written(rig: &RigFile, to: Format) -> Imported {
    let texts = export(rig, to).unwrap().texts;
    assert_eq!(texts.len(), to.files());
    good(&texts.iter().map(String::as_str).collect::<Vec<_>>())
}

/// Line and problem.
pub(crate) fn bad(texts: &[&str]) -> (Option<usize>, Problem) {
    let error = read(texts, &Options::default()).expect_err("the file is wrong");
    assert!(!error.to_string().contains('\n'), "{error}");
    (error.line, error.problem)
}

/// Where a point of the left camera's coordinates is in the right one's: by the quaternion formula,
/// not by the code's matrices.
fn seen_from_right(calibration: &Calibration, point: [f64; 3]) -> [f64; 3] {
    let [w, x, y, z] = calibration.rotation();
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let twice = cross([x, y, z], point).map(|v| 2.0 * v);
    let further = cross([x, y, z], twice);
    let t = calibration.translation();
    [0, 1, 2].map(|i| point[i] + w * twice[i] + further[i] + t[i])
}

pub(crate) fn assert_is_the_example(found: &Imported) {
    let calibration = &found.rig.calibration;
    for (point, expected) in [
        ([0.0, 0.0, 1.0], [0.52, 0.0, 0.86]),
        ([0.1, 0.0, 0.0], [0.0; 3]),
        ([0.0, 0.5, 0.0], [-0.08, 0.5, 0.06]),
    ] {
        let seen = seen_from_right(calibration, point);
        for (seen, expected) in seen.into_iter().zip(expected) {
            assert!((seen - expected).abs() < 1e-12, "{}: {point:?} is at {seen:?}", found.format);
        }
    }
    let (left, right) =
        (calibration.camera(CameraSide::Left), calibration.camera(CameraSide::Right));
    assert_eq!((left.dims(), left.focal(), left.centre()), (SIZE, [500.0, 501.0], [320.0, 240.0]));
    assert_eq!((right.focal(), right.centre()), ([510.0, 511.0], [322.0, 242.0]));
    assert_eq!(left.lens(), Lens::BrownConrady { k: [-0.3, 0.1, 0.0], p: [0.001, 0.002] });
    assert_eq!(right.lens(), Lens::BrownConrady { k: [-0.2, 0.05, 0.0], p: [0.003, 0.004] });
}

pub(crate) fn opencv_matrix(name: &str, rows: usize, cols: usize, data: &str) -> String {
    format!(
        "{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {cols}\n   dt: d\n   data: [ {data} ]\n"
    )
}

/// The example's cameras under these names.
pub(crate) fn opencv_cameras([m1, d1, m2, d2]: [&str; 4]) -> String {
    opencv_matrix(m1, 3, 3, "500., 0., 320., 0.,\n       501., 240., 0., 0., 1.")
        + &opencv_matrix(d1, 1, 5, "-3.0e-01, .1, 1e-3, 2.e-03, 0.")
        + &opencv_matrix(m2, 3, 3, "510., 0., 322., 0., 511., 242., 0., 0., 1.")
        + &opencv_matrix(d2, 4, 1, "-0.2, 0.05, 0.003, 0.004")
}

pub(crate) fn opencv_pose(millimetres: bool) -> String {
    opencv_matrix("R", 3, 3, "0.8, 0., 0.6, 0., 1., 0., -0.6, 0., 0.8")
        + &opencv_matrix("T", 3, 1, if millimetres { "-80., 0., 60." } else { "-0.08, 0., 0.06" })
}

const IMAGE_SIZE: &str = "image_width: 640\nimage_height: 480\n";
pub(crate) const USUAL: [&str; 4] = ["M1", "D1", "M2", "D2"];

pub(crate) fn opencv() -> String {
    format!("%YAML:1.0\n---\n{IMAGE_SIZE}{}{}", opencv_cameras(USUAL), opencv_pose(false))
}

fn opencv_xml() -> &'static str {
    "<?xml version=\"1.0\"?>\n<opencv_storage>\n<!-- by hand -->\n<imageSize>640 480</imageSize>\n<M1 type_id=\"opencv-matrix\">\n\
     <rows>3</rows><cols>3</cols><dt>d</dt>\n<data>500. 0. 320.\n 0. 501. 240. 0. 0. 1.</data></M1>\n\
     <D1 type_id=\"opencv-matrix\"><rows>1</rows><cols>5</cols><dt>d</dt><data>-0.3 .1 1e-3 2e-3 0.</data></D1>\n\
     <M2 type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols><dt>d</dt><data>510. 0. 322. 0. 511. 242. 0. 0. 1.</data></M2>\n\
     <D2 type_id=\"opencv-matrix\"><rows>4</rows><cols>1</cols><dt>d</dt><data>-0.2 0.05 0.003 0.004</data></D2>\n\
     <R type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols><dt>d</dt><data>0.8 0. 0.6 0. 1. 0. -0.6 0. 0.8</data></R>\n\
     <T>-0.08 0. 0.06</T>\n</opencv_storage>\n"
}

pub(crate) const KALIBR: &str = "\
cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.3, 0.1, 0.001, 0.002]
  distortion_model: radtan
  intrinsics: [500.0, 501.0, 320.0, 240.0]
  resolution: [640, 480]
  rostopic: /left
cam1:
  T_cn_cnm1:
  - [0.8, 0.0, 0.6, -0.08]
  - [0.0, 1.0, 0.0, 0.0]
  - [-0.6, 0.0, 0.8, 0.06]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [0]
  camera_model: pinhole
  distortion_coeffs: [-0.2, 0.05, 0.003, 0.004]
  distortion_model: radtan
  intrinsics: [510.0, 511.0, 322.0, 242.0]
  resolution: [640, 480]
  rostopic: /right
";

/// The body's axes: x is the left camera's -y, y its x, z its z; the left camera stands at (1, 2,
/// 3) in it.
pub(crate) const EUROC: [&str; 2] = [
    "%YAML:1.0
sensor_type: camera

T_BS:
  cols: 4
  rows: 4
  data: [0.0, -1.0, 0.0, 1.0,
         1.0, 0.0, 0.0, 2.0,
         0.0, 0.0, 1.0, 3.0,
         0.0, 0.0, 0.0, 1.0]
resolution: [640, 480]
camera_model: pinhole
intrinsics: [500.0, 501.0, 320.0, 240.0] #fu, fv, cu, cv
distortion_model: radial-tangential
distortion_coefficients: [-0.3, 0.1, 0.001, 0.002]
",
    // The right camera's axes in the body are the columns; it stands at left's y + 0.1.
    "%YAML:1.0
sensor_type: camera

T_BS:
  cols: 4
  rows: 4
  data: [0.0, -1.0, 0.0, 1.0,
         0.8, 0.0, -0.6, 2.1,
         0.6, 0.0, 0.8, 3.0,
         0.0, 0.0, 0.0, 1.0]
resolution: [640, 480]
camera_model: pinhole
intrinsics: [510.0, 511.0, 322.0, 242.0]
distortion_model: radial-tangential
distortion_coefficients: [-0.2, 0.05, 0.003, 0.004]
",
];

/// The baseline runs along the left camera's x axis: its rectification is none, the right camera's
/// turns it back.
pub(crate) const ROS: [&str; 2] = [
    "image_width: 640
image_height: 480
camera_name: left
camera_matrix:
  rows: 3
  cols: 3
  data: [500, 0, 320, 0, 501, 240, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.3, 0.1, 0.001, 0.002, 0]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [400, 0, 310, 0, 0, 400, 230, 0, 0, 0, 1, 0]
",
    // As a printed message. -400 px * 0.1 m = -40.
    "header: {frame_id: right}
height: 480
width: 640
distortion_model: rational_polynomial
D: [-0.2, 0.05, 0.003, 0.004, 0.0, 0.0, 0.0, 0.0]
K: [510.0, 0.0, 322.0, 0.0, 511.0, 242.0, 0.0, 0.0, 1.0]
R: [0.8, 0.0, -0.6, 0.0, 1.0, 0.0, 0.6, 0.0, 0.8]
P: [400.0, 0.0, 310.0, -40.0, 0.0, 400.0, 230.0, 0.0, 0.0, 0.0, 1.0, 0.0]
",
];

#[test]
fn every_format_means_the_same_rig() {
    let yaml = opencv();
    let with_space = yaml.replace("%YAML:1.0", "%YAML 1.0");
    let without_dashes = yaml.replace("---\n", "");
    let touching = yaml.replace("data: [", "data:[");
    for (texts, format) in [
        (&[yaml.as_str()][..], Format::OpencvYaml),
        (&[with_space.as_str()], Format::OpencvYaml),
        (&[without_dashes.as_str()], Format::OpencvYaml),
        (&[touching.as_str()], Format::OpencvYaml),
        (&[opencv_xml()], Format::OpencvXml),
        (&[KALIBR], Format::Kalibr),
        (&ROS, Format::Ros),
        (&EUROC, Format::Euroc),
    ] {
        let found = good(texts);
        assert_eq!(found.format, format);
        assert_is_the_example(&found);
    }
}

#[test]
fn what_is_written_is_read_back_as_the_same_numbers() {
    let rig = good(&[KALIBR]).rig;
    for to in [
        Format::RigToml,
        Format::OpencvYaml,
        Format::OpencvXml,
        Format::Kalibr,
        Format::Ros,
        Format::Euroc,
    ] {
        let found = written(&rig, to);
        assert_eq!(found.format, to);
        assert_is_the_example(&found);
        assert_eq!(
            found.stored.is_some(),
            [Format::OpencvYaml, Format::OpencvXml].contains(&to),
            "{to}"
        );
    }
}

#[test]
fn fisheyes_and_skew_are_carried_or_refused() {
    let fisheye = KALIBR.replace("radtan", "equidistant");
    let rig = good(&[&fisheye]).rig;
    let lens = rig.calibration.camera(CameraSide::Right).lens();
    assert_eq!(lens, Lens::Fisheye { k: [-0.2, 0.05, 0.003, 0.004] });
    let foxglove = good(&[&KALIBR.replace("radtan", "kannala_brandt")]).rig;
    assert_eq!(foxglove.calibration, rig.calibration);
    for to in [Format::OpencvYaml, Format::OpencvXml, Format::Kalibr, Format::Ros, Format::Euroc] {
        let found = written(&rig, to).rig.calibration;
        let right = |of: &Calibration| *of.camera(CameraSide::Right);
        assert_eq!(right(&found), right(&rig.calibration), "{to}");
    }
    // One of each, a k3 and a skew: formats that cannot say so refuse to.
    let mixed = good(&[&KALIBR.replacen("radtan", "equidistant", 1)]).rig;
    let refused = |rig, to| matches!(export(rig, to), Err(Problem::NotRepresentable { .. }));
    let k3 = good(&[&opencv().replace("2.e-03, 0. ]", "2.e-03, 0.01 ]")]).rig;
    let skew = good(&[&opencv().replace("500., 0., 320.", "500., 0.5, 320.")]).rig;
    for (rig, to, is_refused) in [
        (&mixed, Format::OpencvYaml, true),
        (&mixed, Format::Ros, false),
        (&mixed, Format::Kalibr, false),
        (&k3, Format::Kalibr, true),
        (&k3, Format::Euroc, true),
        (&k3, Format::Ros, false),
        (&skew, Format::Kalibr, true),
        (&skew, Format::Euroc, true),
    ] {
        assert_eq!(refused(rig, to), is_refused, "{to}");
    }
    let again = written(&skew, Format::OpencvXml).rig.calibration;
    assert_eq!(again.camera(CameraSide::Left).skew(), 0.5);
}

#[test]
fn opencv_names_are_habits() {
    for names in [
        ["K1", "D1", "K2", "D2"],
        ["cameraMatrix1", "distCoeffs1", "cameraMatrix2", "distCoeffs2"],
        ["camera_matrix_left", "dist_coeffs_left", "camera_matrix_right", "dist_coeffs_right"],
        [
            "left_camera_matrix", "left_distortion_coefficients", "right_camera_matrix",
            "right_distortion_coefficients",
        ],
        ["LEFT.K", "LEFT.D", "RIGHT.K", "RIGHT.D"],
        ["K_l", "D_l", "K_r", "D_r"],
        ["mtxL", "distL", "mtxR", "distR"],
        ["K0", "D0", "K1", "D1"],
        ["cam1_matrix", "cam1_dist", "cam2_matrix", "cam2_dist"],
    ] {
        let cameras = opencv_cameras(names);
        assert_is_the_example(&good(&[&format!("{IMAGE_SIZE}{cameras}{}", opencv_pose(false))]));
    }
    // One file for each camera and one for the pose; intrinsics and extrinsics apart; maps within
    // maps.
    let bare = ["camera_matrix", "distortion_coefficients"];
    let cameras = opencv_cameras([bare[0], bare[1], "camera_matrix", "distortion_coefficients"]);
    let second = cameras.rfind("camera_matrix").unwrap();
    let (left, right) = cameras.split_at(second);
    let pose = opencv_pose(false);
    let [first, second] = [left, right].map(|camera| format!("{IMAGE_SIZE}{camera}"));
    assert_is_the_example(&good(&[&first, &second, &pose]));
    let intrinsics = format!("%YAML:1.0\n{IMAGE_SIZE}{}", opencv_cameras(USUAL));
    assert_is_the_example(&good(&[&intrinsics, &pose]));
    let inner = |text: &str| text.lines().map(|line| format!("  {line}\n")).collect::<String>();
    let nested = format!("{IMAGE_SIZE}left:\n{}right:\n{}{pose}", inner(left), inner(right));
    assert_is_the_example(&good(&[&nested]));
    // Two meanings are none.
    let both = opencv()
        + &opencv_cameras(["K_left", "D_left", "K_right", "D_right"]).replace("500.", "499.");
    assert!(matches!(bad(&[&both]).1, Problem::Ambiguous(_)));
    let elsewhere = opencv_matrix("T", 3, 1, "-0.09, 0., 0.06");
    assert!(matches!(bad(&[&opencv(), &elsewhere]).1, Problem::Ambiguous(_)));
}

#[test]
fn opencv_lengths_have_the_unit_that_is_given_or_likely() {
    let text =
        |millimetres| format!("{IMAGE_SIZE}{}{}", opencv_cameras(USUAL), opencv_pose(millimetres));
    let with = |text: &str, unit| {
        read(&[text], &Options { translation_unit: Some(unit), ..Options::default() }).unwrap()
    };
    for (millimetres, note) in [(true, "assumed to be in mm"), (false, "assumed to be in m:")] {
        let guessed = good(&[&text(millimetres)]);
        assert_is_the_example(&guessed);
        says(&guessed.notes.concat(), &[note]);
    }
    assert_is_the_example(&with(&text(true), TranslationUnit::Millimetres));
    assert_is_the_example(&with(&text(false), TranslationUnit::Metres));
    // 0.1 squares of 1000 mm.
    assert_is_the_example(&with(&text(false), TranslationUnit::Squares { millimetres: 1000.0 }));
    // The squares have the unit of T: 25 is no board in metres, 0.025 none in millimetres, 1 says
    // nothing.
    let long = text(false).replace("-0.08, 0., 0.06", "-8., 0., 6.");
    for (square, pose, metres) in [
        ("25.", &text(true), 0.1),
        ("2.5e-02", &text(false), 0.1),
        ("0.025", &long, 10.0),
        ("1.", &text(false), 0.1),
    ] {
        let found = good(&[&format!("square_size: {square}\n{pose}")]);
        assert!(
            (found.rig.calibration.baseline() - metres).abs() < 1e-12,
            "{square}: {:?}",
            found.notes
        );
    }
    // 2 m: possible, but worth a word. 100 m is none of a stereo head, nor is 0.1 mm.
    let strange =
        with(&text(false).replace("-0.08, 0., 0.06", "-1.6, 0., 1.2"), TranslationUnit::Metres);
    says(&strange.notes.concat(), &["2.0000 m; if that is wrong"]);
    for (millimetres, unit) in
        [(true, TranslationUnit::Metres), (false, TranslationUnit::Millimetres)]
    {
        let options = Options { translation_unit: Some(unit), ..Options::default() };
        says(&read(&[&text(millimetres)], &options).unwrap_err().to_string(), &["metres"]);
    }
}

#[test]
fn sizes_and_lenses_come_from_the_file_or_the_options() {
    let without = format!("{}{}", opencv_cameras(USUAL), opencv_pose(false));
    let Problem::NoSize { guess } = bad(&[&without]).1 else { panic!("the size is missing") };
    assert_eq!(guess, [641.0, 481.0]);
    let options = Options { size: Some(SIZE), ..Options::default() };
    assert_is_the_example(&read(&[&without], &options).unwrap());
    let other = Options { size: Some(Dims { width: 320, height: 240 }), ..Options::default() };
    for texts in [&[opencv().as_str()][..], &[KALIBR], &ROS, &EUROC] {
        let error = read(texts, &other).unwrap_err();
        assert!(matches!(error.problem, Problem::SizeDiffers { .. }), "{error}");
    }
    let four = opencv()
        .replace("1, 5", "1, 4")
        .replace("cols: 5", "cols: 4")
        .replace("2.e-03, 0. ]", "2.e-03 ]");
    let fisheye = Lens::Fisheye { k: [-0.3, 0.1, 0.001, 0.002] };
    let options = Options { lens: Some(LensModel::Fisheye), ..Options::default() };
    let found = read(&[&four], &options).unwrap();
    assert_eq!(found.rig.calibration.camera(CameraSide::Left).lens(), fisheye);
    let stated = four.replace("image_width", "fisheye_model: 1\nimage_width");
    assert_eq!(good(&[&stated]).rig.calibration.camera(CameraSide::Left).lens(), fisheye);
    // What the files say holds.
    assert_eq!(read(&[&stated], &options).unwrap().rig, good(&[&stated]).rig);
    let radial = Options { lens: Some(LensModel::BrownConrady), ..Options::default() };
    let error = read(&[&stated], &radial).unwrap_err();
    assert!(matches!(error.problem, Problem::Stated("--lens")) && error.line.is_some(), "{error}");
    let unit = Some(TranslationUnit::Millimetres);
    let units = Options { translation_unit: unit, ..Options::default() };
    for texts in [&[KALIBR][..], &ROS, &EUROC] {
        for options in [&radial, &units] {
            let error = read(texts, options).unwrap_err();
            assert!(matches!(error.problem, Problem::Stated(_)), "{error}");
        }
    }
    let found = read(&[&opencv()], &options).unwrap_err();
    assert!(
        matches!(found.problem, Problem::Shape { .. }),
        "five coefficients are no fisheye: {found}"
    );
}

#[test]
fn a_mark_with_nothing_behind_it_begins_no_document() {
    for end in ["---\n", "---", "---\n\n", "---\n# nothing\n", "...\n"] {
        assert_is_the_example(&good(&[&format!("{}{end}", ROS[0]), &format!("{}{end}", ROS[1])]));
        assert_is_the_example(&good(&[&format!("{KALIBR}{end}")]));
    }
    let (line, problem) = bad(&[&format!("{}---\n{}", ROS[0], ROS[0]), ROS[1]]);
    assert_eq!((line, problem.to_string().contains("second document")), (Some(21), true));
}

#[test]
fn cameras_in_the_wrong_order_are_exchanged_on_demand() {
    let options = Options { swap: true, ..Options::default() };
    assert_is_the_example(&read(&[EUROC[1], EUROC[0]], &options).unwrap());
    // X_left = R^T X_right - R^T t: the right camera is at (0.1, 0, 0).
    let pose = opencv_matrix("R", 3, 3, "0.8, 0., -0.6, 0., 1., 0., 0.6, 0., 0.8")
        + &opencv_matrix("T", 3, 1, ".1, 0., 0.");
    let text = format!("{IMAGE_SIZE}{}{pose}", opencv_cameras(["M2", "D2", "M1", "D1"]));
    assert!(matches!(bad(&[&text]).1, Problem::Swapped));
    assert_is_the_example(&read(&[&text], &options).unwrap());
    let (first, second) = KALIBR.split_at(KALIBR.find("cam1:").unwrap());
    let inverse = "  - [0.8, 0.0, -0.6, 0.1]\n  - [0.0, 1.0, 0.0, 0.0]\n  - [0.6, 0.0, 0.8, 0.0]\n";
    let rows = second.find("  - [0.8").unwrap()..second.find("  - [0.0, 0.0, 0.0, 1.0]").unwrap();
    let left =
        first.replace("cam0:", &format!("cam1:\n  T_cn_cnm1:\n{inverse}  - [0.0, 0.0, 0.0, 1.0]"));
    let mut right = second.replace("cam1:", "cam0:");
    right.replace_range(rows, "");
    let right = right.replace("  T_cn_cnm1:\n  - [0.0, 0.0, 0.0, 1.0]\n", "");
    assert_is_the_example(&read(&[&(right + &left)], &options).unwrap());
    assert!(matches!(read(&[KALIBR], &options).unwrap_err().problem, Problem::NotSwapped));
    // ROS: files in the wrong order, and a calibration with exchanged cameras, whose second file
    // has the baseline with another sign.
    let [left, right] = ROS;
    let moved = left.replace("[400, 0, 310, 0,", "[400, 0, 310, 40,");
    let still = right.replace("-40.0", "0.0");
    for texts in [[right, left], [&still, &moved]] {
        assert!(matches!(bad(&texts).1, Problem::Projection(_)));
        assert_is_the_example(&read(&texts, &options).unwrap());
    }
    assert!(matches!(read(&ROS, &options).unwrap_err().problem, Problem::NotSwapped));
}

#[test]
fn further_coefficients_are_zero_or_named() {
    for (count, zeros) in
        [(8, "0, 0, 0"), (12, "0, 0, 0, 0, 0, 0, 0"), (14, "0, 0, 0, 0, 0, 0, 0, 0., 0")]
    {
        let text = opencv().replace("cols: 5", &format!("cols: {count}"));
        assert_is_the_example(&good(&[
            &text.replace("2.e-03, 0. ]", &format!("2.e-03, 0., {zeros} ]"))
        ]));
        let Some((before, _)) = zeros.rsplit_once('0').filter(|_| count > 8) else { continue };
        let last = text.replace("2.e-03, 0. ]", &format!("2.e-03, 0., {before}0.25 ]"));
        let (line, Problem::Coefficients { names }) = bad(&[&last]) else {
            panic!("{count} coefficients")
        };
        assert_eq!((line, names.as_str()), (Some(11), if count == 12 { "s4" } else { "tau_y" }));
    }
    let six = opencv().replace("cols: 5", "cols: 6").replace("2.e-03, 0. ]", "2.e-03, 0., 0. ]");
    assert!(matches!(bad(&[&six]), (Some(11), Problem::Shape { .. })));
}

/// Without the name of a model nobody knows what coefficients mean.
#[test]
fn coefficients_without_a_model_are_refused_unless_they_are_0() {
    let [left, right] = ROS;
    let unnamed = left.replace("plumb_bob", "\"\"");
    let (line, problem) = bad(&[&unnamed, right]);
    assert!(line.is_some() && problem.to_string().contains("plumb_bob"), "{problem}");
    let zero = unnamed.replace("[-0.3, 0.1, 0.001, 0.002, 0]", "[0, 0, 0, 0, 0]");
    let rig = good(&[&zero, right]).rig;
    assert_eq!(rig.calibration.camera(CameraSide::Left).lens(), Lens::NONE);
}

#[test]
fn errors_name_the_line() {
    let yaml = opencv();
    let focal = |text: &str| yaml.replace("501., 240.", text);
    for (text, line, problem) in [
        (focal(".nan, 240."), 10, "NotFinite"),
        (focal("1e999, 240."), 10, "NotFinite"),
        (focal("inf, 240."), 10, "NotFinite"),
        (focal("50l., 240."), 10, "NotANumber"),
        (yaml.replacen("rows: 3", "rows: 4", 1), 5, "Shape"),
        (yaml.replacen("rows: 3", "rows: 65535", 1), 5, "Shape"),
        (yaml.replacen("rows: 3", "rows: 1e300", 1), 6, "NotANumber"),
        (yaml.replace("0., 0.6", "0., 0.7"), 26, "NoRotation"),
        // A mirror image has perpendicular unit rows too.
        (yaml.replace("0., 1., 0., -0.6", "0., -1., 0., -0.6"), 26, "NoRotation"),
        (yaml.replace("0., 0., 1. ]", "0., 0., 2. ]"), 5, "NoCameraMatrix"),
        (yaml.replace("-0.08, 0., 0.06", "0.08, 0., -0.06"), 31, "Swapped"),
        (yaml.replace("500., 0.", "-500., 0."), 5, "Camera(Left"),
        (yaml.clone() + "T: 3\n", 36, "Duplicate"),
        (opencv_xml().replace("0. 501.", "0. x"), 8, "NotANumber"),
        (KALIBR.replace("radtan", "fov"), 5, "Model"),
        (KALIBR.replace("pinhole", "omni"), 3, "Model"),
    ] {
        let (found, error) = bad(&[&text]);
        assert_eq!(found, Some(line), "{error}");
        assert!(format!("{error:?}").starts_with(problem), "{error:?} is not {problem}");
    }
    let scaled = KALIBR.replace("0.0, 1.0]\n  cam", "0.0, 2.0]\n  cam");
    assert!(matches!(bad(&[&scaled]), (Some(_), Problem::Shape { .. })));
    assert!(matches!(bad(&[ROS[1], ROS[0]]), (Some(_), Problem::Projection(_))));
    assert!(matches!(bad(&[ROS[0], ROS[0]]), (Some(_), Problem::Projection(_))));
    assert!(matches!(bad(&[ROS[0]]).1, Problem::FileCount { .. }));
    assert!(matches!(bad(&[EUROC[0]]).1, Problem::FileCount { .. }));
    assert!(matches!(bad(&[EUROC[1], EUROC[0]]), (Some(_), Problem::Swapped)));
    assert!(matches!(bad(&[&opencv_cameras(USUAL), "a: 1"]).1, Problem::NoSize { .. }));
    let unposed = format!("{IMAGE_SIZE}{}", opencv_cameras(USUAL));
    assert!(matches!(bad(&[&unposed]).1, Problem::Missing(_)));
    for nothing in
        ["", "hello", "[1, 2]", "%YAML:1.0", "<a/>", "<?xml version=\"1.0\"?><opencv_storage/>"]
    {
        let (_, problem) = bad(&[nothing]);
        let named =
            matches!(problem, Problem::UnknownFormat | Problem::Missing(_) | Problem::Syntax(_));
        assert!(named, "{nothing}: {problem}");
    }
}

#[test]
fn harmful_files_are_refused() {
    let deep = format!("a: {}{}", "[".repeat(200), "]".repeat(200));
    assert!(matches!(bad(&[&deep]), (Some(1), Problem::TooDeep)));
    let deep: String = (0..200).map(|i| format!("{}a:\n", " ".repeat(i))).collect();
    assert!(matches!(bad(&[&deep]), (Some(_), Problem::TooDeep)));
    let mut laughs = "a: &a [x, x, x, x, x, x, x, x, x]\n".to_owned();
    for (one, next) in "abcdefgh".chars().zip("bcdefghi".chars()) {
        let nine = vec![format!("*{one}"); 9].join(", ");
        laughs.push_str(&format!("{next}: &{next} [{nine}]\n"));
    }
    assert!(matches!(bad(&[&laughs]), (Some(_), Problem::TooManyValues)));
    let itself = bad(&["a: &a [1, *a]\n"]);
    assert!(matches!(itself, (Some(1), Problem::Syntax(_))), "{itself:?}");
    let entities = "<?xml version=\"1.0\"?>\n<!DOCTYPE a [<!ENTITY x \"xxx\">]>\n\
                    <opencv_storage><a>&x;</a></opencv_storage>";
    assert!(matches!(bad(&[entities]), (Some(2), Problem::Syntax(_))));
    let deep =
        format!("<opencv_storage>{}{}</opencv_storage>", "<a>".repeat(50), "</a>".repeat(50));
    assert!(matches!(bad(&[&deep]), (Some(1), Problem::TooDeep)));
    let attributes: String = (0..10_000).map(|i| format!(" a{i}=\"\"")).collect();
    let many = format!("<opencv_storage\n{attributes}/>");
    assert!(matches!(bad(&[&many]), (Some(1), Problem::Syntax(_))));
    let hidden = format!("<opencv_storage b=\">\"\n{attributes}/>");
    assert!(matches!(bad(&[&hidden]), (Some(1), Problem::Syntax(_))));
    // Took minutes: the parser copies what is in scope.
    let spaces: String = (0..30_000).map(|i| format!("<a{i} xmlns:b{i}=\"x\">")).collect();
    assert!(matches!(bad(&[&format!("<opencv_storage>{spaces}")]), (Some(1), Problem::Syntax(_))));
    assert!(matches!(bad(&[&"a: 1\n".repeat(300_000)]), (None, Problem::TooLarge)));
    let many: String = (0..80_000).map(|i| format!("a{i}: 1\n")).collect();
    let found = bad(&[&many[..1_000_000.min(many.len())]]);
    assert!(matches!(found.1, Problem::TooManyValues), "{found:?}");
    let (folder, paths) = files(&["M1: \n\u{e9}"]);
    std::fs::write(&paths[0], b"M1: 1\nM2: \xff\n").unwrap();
    let error = load_rig(&paths, &Options::default()).unwrap_err();
    assert!(matches!((error.line, error.problem), (Some(2), Problem::NoText)));
    let error = load_rig(&[folder.path().join("nothing")], &Options::default()).unwrap_err();
    assert!(matches!((error.line, error.problem), (None, Problem::Read(_))));
}

#[test]
fn aliases_that_repeat_a_list_are_understood() {
    let text = KALIBR.replacen("resolution: [640, 480]", "resolution: &id001 [640, 480]", 1);
    let second = text.rfind("[640, 480]").unwrap();
    let text = format!("{}*id001{}", &text[..second], &text[second + 10..]);
    assert_is_the_example(&good(&[&text]));
}

fn assert_close(found: [[f64; 3]; 3], expected: [[f64; 3]; 3], bound: f64) {
    for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
        assert!((found - expected).abs() <= bound, "{found} is not {expected}");
    }
}

/// OpenCV's rectification of this rig, as ORB-SLAM2 publishes it for the same calibration
/// (`Examples/Stereo/EuRoC.yaml`).
#[test]
fn the_euroc_rig_is_the_one_that_others_read_from_it() {
    let Some(folder) = captured::folder("euroc_micro") else { return };
    let paths = ["cam0_sensor.yaml", "cam1_sensor.yaml"].map(|name| folder.join(name));
    let found = load_rig(&paths, &Options::default()).unwrap();
    let calibration = found.rig.calibration;
    assert_eq!(found.format, Format::Euroc);
    assert!((calibration.baseline() - 47.906_393_844_239_01 / 435.204_695_971_459_9).abs() < 1e-6);
    assert_eq!(calibration.camera(CameraSide::Left).focal(), [458.654, 457.296]);
    let [left, right] =
        calibration.rectify(Dims { width: 752, height: 480 }, View::default()).unwrap().rotations();
    let orb_left = [
        [0.999_966_347_530_033, -0.001_422_739_138_722_922, 0.008_079_580_483_432_283],
        [0.001_365_741_834_644_127, 0.999_974_176_089_484_7, 0.007_055_629_199_258_132],
        [-0.008_089_410_156_878_961, -0.007_044_357_138_835_809, 0.999_942_467_582_917_6],
    ];
    let orb_right = [
        [0.999_963_352_619_437_6, -0.003_625_811_871_560_086, 0.007_755_443_660_172_947],
        [0.003_680_398_547_259_526, 0.999_968_475_277_162_9, -0.007_035_845_251_224_894],
        [-0.007_729_688_520_722_713, 0.007_064_130_529_506_649, 0.999_945_173_484_644],
    ];
    assert_close(left, orb_left, 1e-6);
    assert_close(right, orb_right, 1e-6);
}

#[test]
fn an_opencv_file_with_its_own_rectification() {
    let Some(folder) = captured::folder("robot_pairs/sparsestereo_example") else { return };
    let found = load_rig(&[folder.join("calib.xml")], &Options::default()).unwrap();
    assert_eq!(found.format, Format::OpencvXml);
    let calibration = found.rig.calibration;
    // Q[3][2] = 1 / baseline.
    assert!((calibration.baseline() * 9.162_018_819_812_918 - 1.0).abs() < 1e-9);
    let stored = found.stored.expect("R1, R2, P1 and P2 are in the file");
    assert_eq!(
        (stored.focal, stored.centre),
        (545.813_181_047_855_2, [339.943_843_841_552_73, 225.400_251_388_549_8])
    );
    // Our choice of the common direction is OpenCV's, to what its iteration leaves.
    let ours = calibration.rectify(SIZE, View::default()).unwrap();
    let [left, right] = ours.rotations();
    assert_close(left, stored.rotations[0], 1e-6);
    assert_close(right, stored.rotations[1], 1e-6);
    // By the stored rectification, a point in space lies on one row, f B / z apart.
    let rectified =
        calibration.rectify_as(SIZE, stored.rotations, stored.focal, stored.centre).unwrap();
    for point in [[0.1, -0.2, 1.0], [-0.5, 0.3, 2.0], [1.0, 0.5, 5.0]] {
        let in_right = seen_from_right(&calibration, point);
        let raw = [(CameraSide::Left, point), (CameraSide::Right, in_right)].map(|(eye, point)| {
            rectified.rectified(eye, calibration.camera(eye).project(point).unwrap()).unwrap()
        });
        let [a, b, c] = stored.rotations[0][2];
        let depth = a * point[0] + b * point[1] + c * point[2];
        assert!((raw[0][1] - raw[1][1]).abs() < 1e-4, "{raw:?}");
        let disparity = raw[0][0] - raw[1][0];
        assert!(
            (disparity - stored.focal * calibration.baseline() / depth).abs() < 1e-4,
            "{raw:?}"
        );
    }
}

#[test]
fn real_files_that_are_no_rig_say_what_is_missing() {
    let Some(folder) = captured::folder("calibration_boards/opencv_chessboard") else { return };
    let options = Options { size: Some(SIZE), ..Options::default() };
    let read = |names: &[&str]| {
        let paths: Vec<PathBuf> = names.iter().map(|name| folder.join(name)).collect();
        load_rig(&paths, &options).unwrap_err().to_string()
    };
    assert!(read(&["intrinsics.yml"]).contains("no pose between the cameras"));
    assert!(read(&["left_intrinsics.yml"]).contains("only one camera"));
    assert!(read(&["stereo_calib.xml"]).contains("no two camera matrices"));
    // With a pose beside it, it is one.
    let text = opencv_matrix("R", 3, 3, "1., 0., 0., 0., 1., 0., 0., 0., 1.")
        + &opencv_matrix("T", 3, 1, "-3.33, 0., 0.");
    let (_pose, poses) = files(&[&text]);
    let paths = [folder.join("intrinsics.yml"), poses[0].clone()];
    let found = load_rig(&paths, &options).unwrap().rig.calibration;
    assert_eq!(found.camera(CameraSide::Left).focal(), [534.803_268_450_513_1; 2]);
    assert_eq!(
        found.camera(CameraSide::Right).centre(),
        [334.557_445_279_120_15, 242.053_245_733_766]
    );
}
