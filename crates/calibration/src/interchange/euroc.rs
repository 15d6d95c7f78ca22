//! A pair of `sensor.yaml` files of the ASL dataset format (EuRoC), the left camera's first.
//!
//! # Conventions
//! `T_BS`, 4x4 by rows, takes a point of the sensor to the body: `X_body = T_BS X_sensor`. From
//! left to right that is `T_BS(right)^-1 T_BS(left)`. Metres. Intrinsics are `fu fv cu cv`,
//! coefficients `k1 k2 p1 p2`, or `k1 .. k4` of an equidistant lens.
//!
//! # Source
//! Burri et al., "The EuRoC micro aerial vehicle datasets", IJRR 2016, and the sensor files
//! themselves.

use super::camera::{LensModel, camera, coefficients, no_lens};
use super::error::{Fault, Problem};
use super::names::size;
use super::node::Node;
use super::pose::{Pose, rows};
use linestereo::Dims;
use linestereo_rig::{Calibration, Camera, CameraSide, Lens};

pub(super) fn read([left, right]: [&Node; 2], swap: bool) -> Result<Calibration, Fault> {
    let ((left_camera, left_pose), (right_camera, right_pose)) =
        (sensor(left, CameraSide::Left)?, sensor(right, CameraSide::Right)?);
    let place = right.require("T_BS")?.place;
    right_pose.inverse().after(&left_pose).pair([left_camera, right_camera], swap, Some(place))
}

fn sensor(node: &Node, eye: CameraSide) -> Result<(Camera, Pose), Fault> {
    let camera = pinhole(node, eye, "distortion_coefficients")?;
    Ok((camera, Pose::from_matrix(&node.require("T_BS")?.matrix("T_BS")?)?))
}

/// A camera with the names that EuRoC and Kalibr share.
pub(super) fn pinhole(node: &Node, eye: CameraSide, coefficients: &str) -> Result<Camera, Fault> {
    let model = node.require("camera_model")?;
    if model.text() != Some("pinhole") {
        let found: String = model.text().unwrap_or("a list").chars().take(24).collect();
        return Err(
            Problem::Model(format!("the camera model \"{found}\" is not known")).at(model.place)
        );
    }
    let dims = size(node.require("resolution")?, "resolution")?;
    let intrinsics = node.require("intrinsics")?;
    let [fx, fy, cx, cy] = intrinsics.matrix("intrinsics")?.vector_of()?;
    let model = node.require("distortion_model")?;
    let lens = match LensModel::named(model.text().unwrap_or("a list"), model.place)? {
        Some(model) => model.lens(&node.require(coefficients)?.matrix(coefficients)?)?,
        None => no_lens(&node.require(coefficients)?.matrix(coefficients)?)?,
    };
    camera((eye, intrinsics.place), dims, ([fx, fy], [cx, cy], 0.0), lens)
}

/// Name of the lens and its coefficients, for formats with four of them and without skew.
pub(super) fn four_coefficients(
    camera: &Camera,
    format: &'static str,
    radial: &'static str,
) -> Result<(&'static str, Vec<f64>), Problem> {
    if camera.skew() != 0.0 {
        return Err(Problem::NotRepresentable { format, what: "skew" });
    }
    match coefficients(camera.lens(), true) {
        values if values.len() == 4 => {
            let name =
                if matches!(camera.lens(), Lens::Fisheye { .. }) { "equidistant" } else { radial };
            Ok((name, values))
        }
        values if values.len() > 5 => {
            Err(Problem::NotRepresentable { format, what: "the lens coefficients k4 k5 k6" })
        }
        _ => Err(Problem::NotRepresentable { format, what: "the lens coefficient k3" }),
    }
}

/// Both files; the body is the left camera.
pub(super) fn text(calibration: &Calibration) -> Result<[String; 2], Problem> {
    let right = Pose::of(calibration).inverse();
    let one = |eye, name, pose: &Pose| {
        let camera = calibration.camera(eye);
        let (model, values) = four_coefficients(camera, "EuRoC", "radial-tangential")?;
        let ([fx, fy], [cx, cy], Dims { width, height }) =
            (camera.focal(), camera.centre(), camera.dims());
        let lines = rows(&pose.rotation).into_iter().zip(&pose.translation);
        let lines: String =
            lines.map(|([a, b, c], t)| format!("{a:?}, {b:?}, {c:?}, {t:?},\n         ")).collect();
        Ok(format!(
            "%YAML:1.0\nsensor_type: camera\ncomment: {name}\n\n# Position of the sensor to the body, which is the left camera.\n\
             T_BS:\n  cols: 4\n  rows: 4\n  data: [{lines}0.0, 0.0, 0.0, 1.0]\n\nresolution: [{width}, {height}]\n\
             camera_model: pinhole\nintrinsics: [{fx:?}, {fy:?}, {cx:?}, {cy:?}] # fu, fv, cu, cv\n\
             distortion_model: {model}\ndistortion_coefficients: {values:?}\n"
        ))
    };
    Ok([
        one(CameraSide::Left, "left camera", &Pose::IDENTITY)?,
        one(CameraSide::Right, "right camera", &right)?,
    ])
}
