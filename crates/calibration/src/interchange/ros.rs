//! A pair of ROS `camera_info` files, the left camera's first: as `camera_calibration` writes them,
//! or as a printed message (`K D R P`).
//!
//! # Conventions
//! Matrices by rows. `rectification_matrix` turns a camera into the rectified directions; the
//! baseline `B` in metres stands in the right projection, `P[0][3] = -fx' B`. There is no pose: it
//! follows from both rectifications (see [`pose::from_rectification`]). `plumb_bob` is `k1 k2 p1 p2
//! k3`, `rational_polynomial` has `k4 k5 k6` too, `equidistant` and Foxglove's `kannala_brandt` are
//! `k1 .. k4`. `binning_x`, `binning_y` and `roi` of a message turn the camera matrix into that of
//! the images as sent.
//!
//! # Source
//! ROS `sensor_msgs/CameraInfo.msg` and REP 104; `camera_calibration_parsers` for the file.

use super::camera::{LensModel, camera, coefficients, intrinsics, matrix, no_lens};
use super::error::{Fault, Problem};
use super::node::{Matrix, Node};
use super::opencv::projections;
use super::pose;
use linestereo::Dims;
use linestereo_frames::rectified::check_centre_of;
use linestereo_frames::{SentWindow, Unfit};
use linestereo_rig::{Calibration, Camera, CameraSide, Lens, View};
use nalgebra::Matrix3;

/// Names in files, and in messages of ROS 1 and 2.
const NAMES: [[&str; 3]; 4] = [
    ["camera_matrix", "K", "k"],
    ["distortion_coefficients", "D", "d"],
    ["rectification_matrix", "R", "r"],
    ["projection_matrix", "P", "p"],
];

/// Is this one of the two files?
pub(super) fn is_camera_info(node: &Node) -> bool {
    node.get("distortion_model").is_some() && NAMES.iter().all(|names| find(node, names).is_some())
}

fn find<'a>(node: &'a Node, names: &[&'static str]) -> Option<(&'static str, &'a Node)> {
    names.iter().find_map(|&name| Some((name, node.get(name)?)))
}

/// One camera with its rectification.
struct Info {
    camera: Camera,
    rotation: Matrix3<f64>,
    projection: Matrix,
}

/// The rig; with `swap` the second file is the left camera's, or the calibration took the cameras
/// for each other.
pub(super) fn read([left, right]: [&Node; 2], mut swap: bool) -> Result<Calibration, Fault> {
    let (mut left, mut right) = (info(left, CameraSide::Left)?, info(right, CameraSide::Right)?);
    let shift = |info: &Info| info.projection.shaped::<12>(3, 4).map_or(0.0, |p| p[3]);
    if swap && shift(&left) != 0.0 {
        (left, right, swap) = (right, left, false);
    }
    let place = right.projection.place;
    let [p1, p2] = [&left, &right].map(shift);
    if !swap && (p2 > 0.0 || p1 > 0.0 && p2 >= 0.0) {
        let unfit = Unfit::Sign { left: p1, right: p2 };
        let text = format!("{unfit}, or use convert-rig --swap where cameras are exchanged");
        return Err(Problem::Projection(text).at(place));
    }
    let pose = pose::from_rectification(
        [&left.rotation, &right.rotation],
        [&left.projection, &right.projection],
    )?;
    pose.pair([left.camera, right.camera], swap, Some(place))
}

fn info(node: &Node, eye: CameraSide) -> Result<Info, Fault> {
    let get = |names: &[&'static str; 3]| {
        let missing = || Problem::Missing(format!("there is no \"{}\"", names[0])).at(node.place);
        let (name, found) = find(node, names).ok_or_else(missing)?;
        found.matrix(name)
    };
    let [matrix, values, rotation, projection] = NAMES.each_ref().map(get);
    let (matrix, values) = (matrix?, values?);
    let side = |long: &'static str, short: &'static str| match find(node, &[long, short]) {
        Some((name, side)) => side.whole(name),
        None => Err(Problem::Missing(format!("there is no \"{long}\"")).at(node.place)),
    };
    let full =
        Dims { width: side("image_width", "width")?, height: side("image_height", "height")? };
    let model = node.require("distortion_model")?;
    let lens = match LensModel::named(model.text().unwrap_or("a list"), model.place)? {
        Some(model) => model.lens(&values)?,
        None => no_lens(&values)?,
    };
    let (focal, centre, skew) = intrinsics(&matrix)?;
    check_centre_of(centre, full).map_err(|unfit| Problem::Unfit(eye, unfit).at(matrix.place))?;
    let window = window(node, full)?;
    let mut sent = [focal[0], skew, centre[0], 0.0, focal[1], centre[1]];
    window.apply(&mut sent, 3);
    let [fx, skew, cx, _, fy, cy] = sent;
    let dims = window.sent().map_err(|unfit| Problem::Window(unfit).at(node.place))?;
    let camera = camera((eye, matrix.place), dims, ([fx, fy], [cx, cy], skew), lens)?;
    Ok(Info { camera, rotation: pose::rotation(&rotation?)?, projection: projection? })
}

/// Part of the full image that is sent, by a message's binning and region.
fn window(node: &Node, Dims { width, height }: Dims) -> Result<SentWindow, Fault> {
    let whole = |node: Option<&Node>, name: &str| match node.and_then(|node| node.get(name)) {
        Some(value) => value.whole(name).map(u32::from),
        None => Ok(0),
    };
    let roi = |name| whole(node.get("roi"), name);
    Ok(SentWindow {
        full: [width, height].map(u32::from),
        binning: [whole(Some(node), "binning_x")?, whole(Some(node), "binning_y")?],
        roi: [roi("x_offset")?, roi("y_offset")?, roi("width")?, roi("height")?],
    })
}

/// Both files.
pub(super) fn text(calibration: &Calibration) -> Result<[String; 2], Problem> {
    let dims = calibration.camera(CameraSide::Left).dims();
    let rectified = calibration.rectify(dims, View::default()).map_err(Problem::Rectify)?;
    let (rotations, projections) = (rectified.rotations(), projections(&rectified));
    let one = |index: usize, eye, name| {
        let camera = calibration.camera(eye);
        let Dims { width, height } = camera.dims();
        let values = coefficients(camera.lens(), false);
        let model = match camera.lens() {
            Lens::Fisheye { .. } => "equidistant",
            Lens::Rational { .. } => "rational_polynomial",
            Lens::BrownConrady { .. } => "plumb_bob",
        };
        let mut text = format!(
            "image_width: {width}\nimage_height: {height}\ncamera_name: \
             {name}\ndistortion_model: {model}\n"
        );
        for (name, rows, data) in [
            ("camera_matrix", 3, matrix(camera).as_slice()),
            ("distortion_coefficients", 1, &values),
            ("rectification_matrix", 3, rotations[index].as_flattened()),
            ("projection_matrix", 3, &projections[index]),
        ] {
            let cols = data.len() / rows;
            text.push_str(&format!("{name}:\n  rows: {rows}\n  cols: {cols}\n  data: {data:?}\n"));
        }
        text
    };
    Ok([one(0, CameraSide::Left, "left"), one(1, CameraSide::Right, "right")])
}
