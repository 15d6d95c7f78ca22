//! `docs/formats.md`, number by number: each is changed in an example, and what follows is what its
//! table says.

use crate::calibration_gate::{RECTIFIED, infos, recorded};
use crate::interchange::{opencv_matrix, read};
use crate::rig_commands;
use crate::support::{Folder, json, refused, with_scene};
use core::fmt::Debug;
use linestereo::Dims;
use linestereo_calibration::interchange::Options;
use linestereo_frames::{Dataset, StoredPair};
use linestereo_recordings::ros::messages::RegionOfInterest;
use std::fs;
use std::path::Path;

/// The numbers that are used of files, and the notes about them; or the refusal.
pub(crate) type Outcome = Result<(String, String), String>;

/// Of every table of the page its heading and rows.
fn tables() -> Vec<(String, Vec<[String; 2]>)> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/formats.md");
    let text = fs::read_to_string(page).unwrap();
    let sections = text.split("\n## ").skip(1).map(|section| {
        let rows = section.lines().filter_map(|line| {
            let mut cells = line
                .strip_prefix("| `")?
                .split('|')
                .map(|cell| cell.trim().trim_matches('`').to_owned());
            Some([cells.next()?, cells.next()?])
        });
        (section.lines().next().unwrap().to_owned(), rows.collect::<Vec<_>>())
    });
    sections.filter(|(_, rows)| !rows.is_empty()).collect()
}

/// Changes that each row of a format's table makes in the texts of an example.
struct Format {
    name: &'static str,
    texts: Vec<String>,
    outcome: fn(&[String]) -> Outcome,
    /// The row, a text that stands in the example, once in each file, and what takes its place.
    changes: &'static [(&'static str, &'static str, &'static str)],
}

impl Format {
    /// The page's rows and these changes are the same, and each does what the page says.
    fn check(&self, rows: &[[String; 2]]) {
        let Self { name, texts, outcome, changes } = self;
        let listed: Vec<&str> = rows.iter().map(|[number, _]| number.as_str()).collect();
        assert_eq!(
            listed,
            changes.iter().map(|(number, ..)| *number).collect::<Vec<_>>(),
            "{name}"
        );
        let good = outcome(texts).unwrap_or_else(|error| panic!("{name}: {error}"));
        for ([number, word], (_, from, to)) in rows.iter().zip(*changes) {
            let changed: Vec<String> =
                texts.iter().map(|text| text.replacen(from, to, 1)).collect();
            assert_ne!(changed, *texts, "{name}, {number}: {from} is not there");
            let found = outcome(&changed);
            let is = match &found {
                Err(_) => "checked",
                Ok((used, _)) if *used != good.0 => "used",
                Ok((_, said)) if *said != good.1 => "checked",
                Ok(_) => "not used",
            };
            assert_eq!(is, word, "{name}, {number}: {found:?}");
        }
    }
}

/// The cameras of files for both, and what had to be assumed.
fn rig(texts: &[String]) -> Outcome {
    let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
    let found = read(&texts, &Options::default()).map_err(|error| error.to_string())?;
    Ok((format!("{:?}", found.rig.calibration), format!("{:?}", found.notes)))
}

/// An image of this size with something in it.
fn picture(path: &Path, [width, height]: [u32; 2]) {
    image::GrayImage::from_fn(width, height, |x, y| image::Luma([(x * y % 251) as u8]))
        .save(path)
        .unwrap();
}

pub(crate) fn debug(value: &impl Debug) -> String {
    format!("{value:?}")
}

/// The numbers of a rectified pair, checked against images of this size.
pub(crate) fn known(pair: &StoredPair, images: [u16; 2]) -> Outcome {
    let (_, info) = pair.info().map_err(|error| error.to_string())?.ok_or("nothing is known")?;
    let [width, height] = images;
    info.check_images(Dims { width, height }).map_err(|unfit| unfit.to_string())?;
    Ok((debug(&info), String::new()))
}

/// A folder whose texts lie at these places, with images of this size at those.
fn folder(texts: &[String], at: &str, images: [&str; 2], size: [u16; 2]) -> Outcome {
    let folder = Folder::new();
    for name in [&[at][..], &images].concat() {
        fs::create_dir_all(folder.path().join(name).parent().unwrap()).unwrap();
    }
    fs::write(folder.path().join(at), &texts[0]).unwrap();
    images.iter().for_each(|name| picture(&folder.path().join(name), size.map(u32::from)));
    let found = Dataset::find(folder.path()).map_err(|error| error.to_string())?;
    known(&found.pairs[0], size)
}

fn scene(texts: &[String]) -> Outcome {
    folder(texts, "scene.json", ["left.png", "right.png"], [64, 48])
}

fn kitti(texts: &[String]) -> Outcome {
    let images = ["image_2/000000_10.png", "image_3/000000_10.png"];
    folder(texts, "calib_cam_to_cam/000000.txt", images, [1242, 375])
}

fn middlebury(texts: &[String]) -> Outcome {
    folder(texts, "calib.txt", ["im0.png", "im1.png"], [740, 500])
}

/// `name value` a line, of the right camera; `P[3]` is one of the matrix.
fn camera_info(texts: &[String]) -> Outcome {
    let mut both = infos([64, 48], 50.0);
    let info = &mut both[1];
    for line in texts[0].lines() {
        let (name, value) = line.split_once(' ').unwrap();
        let number = |text: &str| text.parse::<f64>().unwrap();
        match name.split_once('[') {
            Some((_, index)) => {
                info.p[index.trim_end_matches(']').parse::<usize>().unwrap()] = number(value)
            }
            None => match name {
                "width" => info.width = number(value) as u32,
                "height" => info.height = number(value) as u32,
                "binning_x" => info.binning_x = number(value) as u32,
                "roi" => {
                    info.roi = RegionOfInterest {
                        x_offset: number(value) as u32,
                        y_offset: 0,
                        width: 64,
                        height: 48,
                        do_rectify: true,
                    }
                }
                "D" => info.d[0] = number(value),
                "K" => info.k[0] = number(value),
                _ => info.r[1] = number(value),
            },
        }
    }
    // Wide enough for a region.
    recorded(&[both], RECTIFIED, [64, 48])
}

const CAMERA_INFO: &str = "width 80
height 48
binning_x 0
roi 16
P[0] 50
P[1] 0
P[2] 47.5
P[3] -3
P[5] 50
P[6] 23.5
P[7] 0
P[10] 1
P[11] 0
D 0
K 50
R 0
";

const QUALITY: &str = "[quality]
source = \"here\"
views = 9
stereo_rms_px = 0.2
vertical_residual_px = 0.1
verdict = \"good\"
";

const SCENE: &str = r#"{"size": [64, 48], "max_disparity": 32, "disparity_zero_px": -5,
"rectified": {"focal_px": 60, "baseline_m": 0.06, "disparity_offset_px": 5.0,
"principal_point_px": [30.5, 25.5], "left_valid_normalized": [0, 0, 1, 0.9]},
"camera": {"height_m": 0.15, "pitch_deg": 7.5, "roll_deg": 0.25}}"#;

fn ros(name: &str, right: bool) -> String {
    let along = if right { "-40" } else { "0" };
    format!(
        "image_width: 640\nimage_height: 480\ncamera_name: {name}\nbinning_x: 0\nbinning_y: 0\n\
         roi: {{x_offset: 0, y_offset: 0, width: 640, height: 480, do_rectify: false}}\n\
         camera_matrix: {{rows: 3, cols: 3, data: [510, 0, 322, 0, 511, 242, 0, 0, 1]}}\ndistortion_model: rational_polynomial\n\
         distortion_coefficients: {{rows: 1, cols: 8, data: [0.2, 0.05, 0.001, 0.002, 0.01, 0.1, 0.02, 0.003]}}\n\
         rectification_matrix: {{rows: 3, cols: 3, data: [0.8, 0, -0.6, 0, 1, 0, 0.6, 0, 0.8]}}\n\
         projection_matrix: {{rows: 3, cols: 4, data: [400.0, 0, 310, {along}, 0, 400.0, 230, 0, 0, 0, 1, 0]}}\n---\n"
    )
}

const KALIBR: &str = "cam0:
  camera_model: pinhole
  distortion_coeffs: [-0.3, 0.1, 0.001, 0.002]
  distortion_model: radtan
  intrinsics: [500.0, 501.0, 320.0, 240.0]
  resolution: [640, 480]
  cam_overlaps: [1]
  T_cam_imu:
  - [1.0, 0.0, 0.0, 0.02]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  timeshift_cam_imu: 0.001
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.1]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: [-0.2, 0.05, 0.003, 0.004]
  distortion_model: radtan
  intrinsics: [510.0, 511.0, 322.0, 242.0]
  resolution: [640, 480]
";

fn opencv() -> String {
    let matrix = opencv_matrix;
    let camera = "500., 0., 320., 0., 500., 240., 0., 0., 1.";
    let (whole, lens) =
        ("1., 0., 0., 0., 1., 0., 0., 0., 1.", "-0.3, 0.1, 0.001, 0.002, 0., 0.01, 0., 0.");
    let projection =
        |along: &str| format!("400., 0., 310., {along}, 0., 400., 230., 0., 0., 0., 1., 0.");
    let quarter = |last: &str| {
        format!("1., 0., 0., -310., 0., 1., 0., -230., 0., 0., 0., 400., 0., 0., {last}, 0.")
    };
    [
        "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\nsquare_size: \
         0.025\navg_reprojection_error: 0.2\n"
            .to_owned(),
        matrix("M1", 3, 3, camera),
        matrix("D1", 1, 8, lens),
        matrix("M2", 3, 3, camera),
        matrix("D2", 1, 8, lens),
        matrix("R", 3, 3, whole),
        matrix("T", 3, 1, "-2., 0., 0."),
        matrix("R1", 3, 3, whole),
        matrix("R2", 3, 3, whole),
        matrix("P1", 3, 4, &projection("0.")),
        matrix("P2", 3, 4, &projection("-800.")),
        matrix("Q", 4, 4, &quarter("0.5")),
        matrix("E", 3, 3, "0., 0., 0., 0., 0., 0.1, 0., -0.1, 0."),
        matrix("F", 3, 3, "0., 0., 0., 0., 0., 0.2, 0., -0.2, 1."),
    ]
    .concat()
}

fn sensor(place: &str) -> String {
    format!(
        "sensor_type: camera\nT_BS: {{rows: 4, cols: 4, data: [1, 0, 0, {place}, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}}\nrate_hz: 20\n\
         resolution: [640, 480]\ncamera_model: pinhole\nintrinsics: [500, 501, 320, 240]\ndistortion_model: radial-tangential\n\
         distortion_coefficients: [-0.3, 0.1, 0.001, 0.002]\n"
    )
}

const KITTI: &str = "calib_time: 09-Jan-2012
S_02: 1.392000e+03 5.120000e+02
K_02: 9.597910e+02 0 6.960217e+02 0 9.569251e+02 2.241806e+02 0 0 1
D_02: -3.691481e-01 1.968681e-01 1.353473e-03 5.677587e-04 -6.770705e-02
R_02: 1 0 0 0 1 0 0 0 1
T_02: 5.9e-02 0 0
S_rect_02: 1.242000e+03 3.750000e+02
R_rect_02: 1 0 0 0 1 0 0 0 1
P_rect_02: 7.215377e+02 0 6.095593e+02 4.485728e+01 0 7.215377e+02 1.728540e+02 2.163791e-01 0 0 1 2.745884e-03
P_rect_03: 7.215377e+02 0 6.095594e+02 -3.395242e+02 0 7.215378e+02 1.728540e+02 2.199936e+00 0 0 1 2.729905e-03
";

const MIDDLEBURY: &str = "cam0=[994.978 0 311.193; 0 994.978 254.877; 0 0 1]
cam1=[994.978 0 342.279; 0 994.978 254.877; 0 0 1]
doffs=31.086
baseline=193.001
width=740
height=500
ndisp=70
isint=0
vmin=5
vmax=61
dyavg=0.1
dymax=0.9
";

fn formats() -> Vec<Format> {
    let one = |text: &str| vec![text.to_owned()];
    vec![
        Format {
            name: "rig.toml",
            texts: vec![[rig_commands::RIG, QUALITY].concat()],
            outcome: rig,
            changes: &[
                ("version", "version = 1", "version = 2"),
                ("size", "size = [640, 480]", "size = [320, 240]"),
                ("focal_px", "[510.0, 511.0]", "[512.0, 511.0]"),
                ("centre_px", "[322.0, 242.0]", "[323.0, 242.0]"),
                ("skew_px", "skew_px = 0.0", "skew_px = 1.0"),
                ("lens", "k = [-0.2,", "k = [-0.21,"),
                ("rotation_rad", "[0.01, -0.02, 0.03]", "[0.01, -0.03, 0.03]"),
                ("translation_m", "[-0.1,", "[-0.12,"),
                ("quality", "views = 9", "views = 8"),
            ],
        },
        Format {
            name: "scene.json",
            texts: one(SCENE),
            outcome: scene,
            changes: &[
                ("size", "[64, 48]", "\"128x96\""),
                ("max_disparity", "32", "48"),
                ("disparity_zero_px", "-5", "-5.001"),
                ("focal_px", "60,", "61,"),
                ("baseline_m", "0.06,", "0.07,"),
                ("disparity_offset_px", "5.0", "5.001"),
                ("principal_point_px", "[30.5", "[31.5"),
                ("left_valid_normalized", "0.9", "0.8"),
                ("height_m", "0.15", "0.16"),
                ("pitch_deg", "7.5", "8.5"),
                ("roll_deg", "0.25", "0.5"),
            ],
        },
        Format {
            name: "CameraInfo of rectified images",
            texts: one(CAMERA_INFO),
            outcome: camera_info,
            changes: &[
                ("width", "width 80", "width 64"),
                ("height", "height 48", "height 40"),
                ("binning_x", "binning_x 0", "binning_x 2"),
                ("roi", "roi 16", "roi 10"),
                ("P[0]", "P[0] 50", "P[0] 55"),
                ("P[1]", "P[1] 0", "P[1] 1"),
                ("P[2]", "P[2] 47.5", "P[2] 46.5"),
                ("P[3]", "P[3] -3", "P[3] -3.5"),
                ("P[5]", "P[5] 50", "P[5] 55"),
                ("P[6]", "P[6] 23.5", "P[6] 26.5"),
                ("P[7]", "P[7] 0", "P[7] -0.5"),
                ("P[10]", "P[10] 1", "P[10] 2"),
                ("P[11]", "P[11] 0", "P[11] 0.02"),
                ("D", "D 0", "D 0.1"),
                ("K", "K 50", "K 55"),
                ("R", "R 0", "R 0.1"),
            ],
        },
        Format {
            name: "ROS",
            texts: vec![ros("left", false), ros("right", true)],
            outcome: rig,
            changes: &[
                ("image_width", "image_width: 640", "image_width: 320"),
                ("binning_x", "binning_x: 0\nbinning_y: 0", "binning_x: 2\nbinning_y: 2"),
                (
                    "roi", "x_offset: 0, y_offset: 0, width: 640",
                    "x_offset: 1, y_offset: 0, width: 639",
                ),
                ("camera_matrix", "[510,", "[511,"),
                ("distortion_coefficients", "0.003]", "0.004]"),
                (
                    "rectification_matrix", "[0.8, 0, -0.6, 0, 1, 0, 0.6, 0, 0.8]",
                    "[1, 0, 0, 0, 1, 0, 0, 0, 1]",
                ),
                ("P[0]", "[400.0,", "[401.0,"),
                ("P[2]", "310, ", "311, "),
                ("P[3]", "310, -40", "310, -41"),
                ("P[7]", "230, 0,", "230, -20,"),
                ("camera_name", "camera_name: ", "camera_name: other_"),
            ],
        },
        Format {
            name: "Kalibr",
            texts: one(KALIBR),
            outcome: rig,
            changes: &[
                ("camera_model", "camera_model: pinhole", "camera_model: omni"),
                ("intrinsics", "[510.0,", "[511.0,"),
                ("distortion_coeffs", "[-0.2,", "[-0.21,"),
                ("resolution", "resolution: [640, 480]", "resolution: [320, 240]"),
                ("T_cn_cnm1", "-0.1]", "-0.12]"),
                ("T_cam_imu", "0.02]", "0.03]"),
                ("timeshift_cam_imu", "0.001\ncam1", "0.002\ncam1"),
                ("cam_overlaps", "cam_overlaps: [1]", "cam_overlaps: [0]"),
            ],
        },
        Format {
            name: "OpenCV",
            texts: vec![opencv()],
            outcome: rig,
            changes: &[
                (
                    "image_width", "image_width: 640\nimage_height: 480",
                    "image_width: 320\nimage_height: 240",
                ),
                ("M1", "[ 500.,", "[ 501.,"),
                ("D1", "-0.3, 0.1", "-0.31, 0.1"),
                (
                    "R",
                    "R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1., 0., \
                     0., 0., 1., 0., 0., 0., 1. ]",
                    "R: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ 0.02, 0., \
                     0. ]",
                ),
                ("T", "-2., 0., 0.", "-2.2, 0., 0."),
                ("square_size", "square_size: 0.025", "square_size: 25"),
                (
                    "R1",
                    "R1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1., 0., \
                     0., 0., 1., 0., 0., 0., 1. ]",
                    "R1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 0.8, 0., \
                     0.6, 0., 1., 0., -0.6, 0., 0.8 ]",
                ),
                ("P1", "310., 0., 0.", "320., 0., 0."),
                ("Q", "400., 0., 0., 0.5", "400., 0., 0., 0.6"),
                ("E", "0.1, 0., -0.1", "0.2, 0., -0.1"),
                ("F", "0.2, 0., -0.2", "0.3, 0., -0.2"),
                ("avg_reprojection_error", "error: 0.2", "error: 0.3"),
            ],
        },
        Format {
            name: "EuRoC",
            texts: vec![sensor("0"), sensor("0.1")],
            outcome: rig,
            changes: &[
                ("T_BS", "0.1, 0, 1", "0.12, 0, 1"),
                ("resolution", "[640, 480]", "[320, 240]"),
                ("intrinsics", "[500,", "[502,"),
                ("distortion_coefficients", "[-0.3,", "[-0.31,"),
                ("rate_hz", "rate_hz: 20", "rate_hz: 30"),
            ],
        },
        Format {
            name: "KITTI",
            texts: one(KITTI),
            outcome: kitti,
            changes: &[
                ("P[0]", "P_rect_03: 7.215377e+02", "P_rect_03: 7.715377e+02"),
                ("P[2]", "6.095594e+02", "6.195594e+02"),
                ("P[3]", "-3.395242e+02", "-3.495242e+02"),
                ("P[5]", "7.215378e+02", "7.715378e+02"),
                ("P[7]", "2.199936e+00", "2.199936e+01"),
                ("P[11]", "2.729905e-03", "2.729905e-02"),
                ("S_rect_02", "1.242000e+03", "6.210000e+02"),
                ("K_02", "9.597910e+02", "9.697910e+02"),
                ("D_02", "-3.691481e-01", "-3.791481e-01"),
                ("R_02", "R_02: 1", "R_02: 0.9"),
                ("T_02", "5.9e-02", "6.9e-02"),
                ("R_rect_02", "R_rect_02: 1", "R_rect_02: 0.9"),
            ],
        },
        Format {
            name: "Middlebury",
            texts: one(MIDDLEBURY),
            outcome: middlebury,
            changes: &[
                (
                    "cam0", "cam0=[994.978 0 311.193; 0 994.978",
                    "cam0=[994.978 0 311.193; 0 1094.978",
                ),
                ("cam1", "cam1=[994.978", "cam1=[1094.978"),
                ("doffs", "31.086", "-31.086"),
                ("baseline", "193.001", "194.001"),
                ("width", "width=740", "width=1480"),
                ("height", "height=500", "height=1000"),
                ("ndisp", "ndisp=70", "ndisp=80"),
                ("isint", "isint=0", "isint=1"),
                ("vmin", "vmin=5", "vmin=6"),
                ("vmax", "vmax=61", "vmax=62"),
                ("dyavg", "dyavg=0.1", "dyavg=0.2"),
                ("dymax", "dymax=0.9", "dymax=1.9"),
            ],
        },
    ]
}

#[test]
fn every_number_of_every_format_is_what_the_page_says() {
    let tables = tables();
    let formats = formats();
    let names: Vec<&str> = tables.iter().map(|(name, _)| name.as_str()).collect();
    let mut tested: Vec<&str> = formats.iter().map(|format| format.name).collect();
    tested.push("Options, C and Python"); // below
    assert_eq!(names, tested);
    for (format, (_, rows)) in formats.iter().zip(&tables) {
        format.check(rows);
    }
}

#[test]
fn options_are_used_or_refused() {
    let folder = with_scene("cards", "160x120", "cards");
    fs::remove_file(folder.path().join("cards/scene.json")).unwrap(); // or it would be used
    let call = "run cards/left.png cards/right.png --json - --max-disparity 32";
    let depths =
        |options: &str| json(folder.path(), &format!("{call} {options}"))["segments"].clone();
    let base = depths("--focal-px 150 --baseline-m 0.06");
    for options in [
        "--focal-px 160 --baseline-m 0.06",
        "--focal-px 150 --baseline-m 0.07",
        "--focal-px 150 --baseline-m 0.06 --disparity-offset-px 2",
        "--fb 12",
    ] {
        assert_ne!(depths(options), base, "{options:?}");
    }
    for (options, word) in [
        (
            "--focal-px 4 --baseline-m 0.06",
            "--focal-px: a focal length of 4 px is not plausible for images 160 px wide",
        ),
        ("--focal-px 150 --baseline-m 60", "did you mean mm? then give 0.06"),
        ("--fb 12000", "--fb: a focal length times a baseline of 12000 px m"),
        ("--fb 12000", "did you mean px mm? then give 12;"),
        ("--fb 9 --camera-height 0.3 --camera-pitch 5", "not --fb, which gives no directions"),
        ("--fb 9 --sectors", "--sectors needs directions, and --fb gives depths alone"),
        ("--fb 9 --ply x.ply", "--ply needs directions"),
        (
            "--focal-px 150 --baseline-m 0.06 --principal-point 500,60",
            "500,60 lies outside of the image, which is 160x120",
        ),
        ("--focal-px 150 --baseline-m 0.00006", "not plausible for a stereo camera"),
        (
            "--focal-px 300 --baseline-m 0.06 --principal-point 159.5,119.5",
            "for another image size",
        ),
    ] {
        refused(folder.path(), &format!("{call} {options}"), &[word]);
    }
}
