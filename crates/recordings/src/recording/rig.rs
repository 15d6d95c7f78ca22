//! `CameraInfo` of both cameras -> the rig of rectified images, or files with that of raw ones.
//!
//! Images are rectified where their topic says so, or where the calibration has no lens and no rotation. `P` of the right camera holds the
//! baseline, `P[3] = -f B`; the principal points are those of both `P`.

use super::RecordingFault;
use super::topics::is_rectified;
use crate::ros::messages::CameraInfo;
use core::fmt::Write;
use linestereo_frames::StoredRig;
use linestereo_wire::RigUpdate;
use std::path::Path;
use tempfile::TempDir;

/// Shares of a focal length by which those of two rectified images may differ.
const SAME_FOCAL: f64 = 1e-6;

type Infos<'a> = [Option<(&'a CameraInfo, bool)>; 2];

/// The rig, what is said of it, and the folder that its files are in.
pub(super) fn of(
    path: &Path,
    topics: [&str; 2],
    infos: Infos<'_>,
) -> Result<(StoredRig, String, Option<TempDir>), RecordingFault> {
    let unknown = |what: &str| Ok((StoredRig::Unknown, format!("no rig by the recording: {what}"), None));
    let [Some((left, left_changes)), Some((right, right_changes))] = infos else {
        return unknown("it has no CameraInfo of both");
    };
    let changes = if left_changes || right_changes { ", the first of several that differ" } else { "" };
    if left.k[0] == 0.0 || right.k[0] == 0.0 {
        return unknown("its CameraInfo is of cameras that are not calibrated");
    }
    if !topics.into_iter().all(is_rectified) && ![left, right].into_iter().all(is_ideal) {
        let (rig, folder) = raw([left, right]).map_err(|error| RecordingFault::Calibration(error.to_string()))?;
        return Ok((rig, format!("raw, rectified by their CameraInfo{changes}"), Some(folder)));
    }
    let numbers = [&left.p, &right.p].map(|p| p.iter().all(|value| value.is_finite()));
    let (focal_px, along) = (left.p[0], right.p[3] - left.p[3]);
    if numbers != [true; 2] || focal_px <= 0.0 {
        return Err(RecordingFault::Calibration("P is no projection".to_owned()));
    }
    let differs = |a: usize| (left.p[a] - right.p[a]).abs() > SAME_FOCAL * focal_px;
    if differs(0) || left.p[5] != right.p[5] && differs(5) || differs(6) {
        return Err(RecordingFault::Calibration("P of left and right differ by more than the baseline".to_owned()));
    }
    let baseline_m = -along / focal_px;
    if baseline_m == 0.0 {
        return unknown("P of the right camera has no baseline");
    }
    if baseline_m < 0.0 {
        return Err(RecordingFault::Calibration("the right camera is on the left; exchange the topics".to_owned()));
    }
    let rig = RigUpdate { focal_px, baseline_m, offset_px: right.p[2] - left.p[2] };
    rig.rig().map_err(|error| RecordingFault::Calibration(error.to_string()))?;
    let told = format!("rectified, focal length {focal_px:.3} px, baseline {baseline_m:.5} m by CameraInfo{changes}");
    Ok((StoredRig::Recorded(path.to_path_buf(), rig, [left.p[2], left.p[6]]), told, None))
}

/// True for a camera whose images need no rectification.
fn is_ideal(info: &CameraInfo) -> bool {
    let same = |a: f64, b: f64| (a - b).abs() < 1e-9;
    let straight = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let p = &info.p;
    let projected = [p[0], p[1], p[2], p[4], p[5], p[6], p[8], p[9], p[10]];
    let pairs = |a: &[f64; 9], b: &[f64; 9]| a.iter().zip(b).all(|(a, b)| same(*a, *b));
    info.d.iter().all(|&value| value == 0.0) && pairs(&info.r, &straight) && pairs(&info.k, &projected)
}

/// Both as the files that `camera_info_manager` writes, which the rectification takes.
fn raw(infos: [&CameraInfo; 2]) -> std::io::Result<(StoredRig, TempDir)> {
    let folder = tempfile::Builder::new().prefix("linestereo-rig-").tempdir()?;
    let paths = ["left.yaml", "right.yaml"].map(|name| folder.path().join(name));
    for (info, path) in infos.into_iter().zip(&paths) {
        let model: String = info.distortion_model.chars().filter(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
        let mut text = format!("width: {}\nheight: {}\ndistortion_model: \"{model}\"\n", info.width, info.height);
        for (name, values) in [("d", &info.d[..]), ("k", &info.k), ("r", &info.r), ("p", &info.p)] {
            let _ = writeln!(text, "{name}: {values:?}");
        }
        std::fs::write(path, text)?;
    }
    Ok((StoredRig::Raw(paths.to_vec()), folder))
}
