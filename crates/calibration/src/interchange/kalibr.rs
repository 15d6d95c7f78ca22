//! Kalibr's `camchain.yaml`: `cam0` is the left camera, `cam1` the right one.
//!
//! # Conventions
//! `T_cn_cnm1` of `cam1`, 4x4 by rows, takes a point of `cam0` to `cam1`: `X_1 = T X_0`, the same
//! direction as ours. Metres. Intrinsics are `fu fv pu pv`, coefficients `k1 k2 r1 r2` of `radtan`
//! (`r1`, `r2` are OpenCV's `p1`, `p2`) or `k1 .. k4` of `equidistant`.
//!
//! # Source
//! Kalibr's wiki, "Yaml formats" and "Supported models"; Furgale, Rehder, Siegwart, IROS 2013.

use super::error::{Fault, Problem};
use super::euroc::{four_coefficients, pinhole};
use super::node::Node;
use super::pose::{Pose, rows};
use linestereo::Dims;
use linestereo_rig::{Calibration, CameraSide};

pub(super) fn read(
    chain: &Node,
    swap: bool,
    notes: &mut Vec<String>,
) -> Result<Calibration, Fault> {
    let (left, right) = (chain.require("cam0")?, chain.require("cam1")?);
    let cameras = [(left, CameraSide::Left), (right, CameraSide::Right)]
        .map(|(node, eye)| pinhole(node, eye, "distortion_coeffs"));
    let [left, right_camera] = cameras;
    let pose = right.require("T_cn_cnm1")?;
    if chain.get("cam2").is_some() {
        notes.push("the chain has more than two cameras: cam0 and cam1 are taken".to_owned());
    }
    Pose::from_matrix(&pose.matrix("T_cn_cnm1")?)?.pair(
        [left?, right_camera?],
        swap,
        Some(pose.place),
    )
}

pub(super) fn text(calibration: &Calibration) -> Result<String, Problem> {
    let mut text = String::new();
    for (name, eye) in [("cam0", CameraSide::Left), ("cam1", CameraSide::Right)] {
        let camera = calibration.camera(eye);
        let (model, values) = four_coefficients(camera, "Kalibr", "radtan")?;
        let ([fx, fy], [cx, cy], Dims { width, height }) =
            (camera.focal(), camera.centre(), camera.dims());
        text.push_str(&format!("{name}:\n"));
        if eye == CameraSide::Right {
            let pose = Pose::of(calibration);
            text.push_str("  T_cn_cnm1:\n");
            for ([a, b, c], t) in rows(&pose.rotation).into_iter().zip(&pose.translation) {
                text.push_str(&format!("  - [{a:?}, {b:?}, {c:?}, {t:?}]\n"));
            }
            text.push_str("  - [0.0, 0.0, 0.0, 1.0]\n");
        }
        text.push_str(&format!(
            "  camera_model: pinhole\n  distortion_coeffs: {values:?}\n  distortion_model: {model}\n  \
             intrinsics: [{fx:?}, {fy:?}, {cx:?}, {cy:?}]\n  resolution: [{width}, {height}]\n  \
             rostopic: /{name}/image_raw\n"
        ));
    }
    Ok(text)
}
