//! `CameraInfo` of both cameras -> the rig of rectified images, or files with that of raw ones.
//!
//! Images are rectified where their topic says so, or where the calibration has no lens and no
//! rotation. `P` of the right camera holds the baseline, `P[3] = -f B`; the principal points are
//! those of both `P`. Binning and region of `CameraInfo` turn the numbers of the full image into
//! those of the images as sent, which have to have the size that this makes.

use super::topics::is_rectified;
use super::{Calibration, RecordingFault};
use crate::ros::kind::NO_ROTATION;
use crate::ros::messages::{CameraInfo, RegionOfInterest};
use core::fmt::Write;
use linestereo_frames::rectified::{Dims, check_centre_of};
use linestereo_frames::{RectifiedRig, RigText, SentWindow, StoredRig, Unfit};
use linestereo_wire::RigUpdate;
use std::path::{Path, PathBuf};

/// The rig of images of this size, and what is said of it.
pub(super) fn of(
    path: &Path,
    topics: [&str; 2],
    infos: [Option<Calibration<'_>>; 2],
    images: Dims,
) -> Result<(StoredRig, String), RecordingFault> {
    let unknown = |what: &str| Ok((StoredRig::Unknown, format!("no rig in the recording: {what}")));
    let fault = |unfit: Unfit| RecordingFault::Calibration(unfit.to_string());
    let [Some(left_info), Some(right_info)] = infos else {
        return unknown("it has no CameraInfo for both cameras");
    };
    let infos = [left_info, right_info];
    let left = as_sent(left_info.info, images).map_err(fault)?;
    let right = as_sent(right_info.info, images).map_err(fault)?;
    let changes = if infos.iter().any(|info| info.changes) {
        ", the first of several that differ"
    } else {
        ""
    };
    let named = topics.map(is_rectified);
    if named[0] != named[1] {
        return Err(RecordingFault::Calibration(
            "one of the topics is rectified by its name, the other one is not".to_owned(),
        ));
    }
    let is_rectified = named == [true; 2] || [&left, &right].into_iter().all(is_ideal);
    if [&left, &right]
        .into_iter()
        .any(|info| if is_rectified { info.p[0] == 0.0 } else { info.k[0] == 0.0 })
    {
        return unknown("its CameraInfo is of cameras that are not calibrated");
    }
    if !is_rectified {
        let files = infos.map(|Calibration { topic, info, .. }| raw(path, topic, info, images));
        let rig = StoredRig::Raw(files.to_vec());
        return Ok((rig, format!("raw, rectified by their CameraInfo{changes}")));
    }
    let rig = match RectifiedRig::of_projections([&left.p, &right.p], None) {
        Err(Unfit::NoBaseline) => return unknown("P of the right camera has no baseline"),
        rig => RectifiedRig { size: Some(images), ..rig.map_err(fault)? },
    };
    rig.check_images(images).map_err(fault)?;
    let RigUpdate { focal_px, baseline_m, .. } = rig.numbers;
    let told = format!(
        "rectified, focal length {focal_px:.3} px, baseline {baseline_m:.5} m by \
         CameraInfo{changes}"
    );
    Ok((StoredRig::Rectified(path.to_path_buf(), rig), told))
}

/// Size of the full image: that of the images where nobody set it.
fn full_size(info: &CameraInfo, images: Dims) -> [u32; 2] {
    if info.width > 0 && info.height > 0 {
        [info.width, info.height]
    } else {
        [images.width, images.height].map(u32::from)
    }
}

/// The calibration of images of this size, which are the part of the full image that it says is
/// sent.
fn as_sent(info: &CameraInfo, images: Dims) -> Result<CameraInfo, Unfit> {
    let RegionOfInterest { x_offset, y_offset, width, height, .. } = info.roi;
    let full = full_size(info, images);
    let [Ok(full_width), Ok(full_height)] = full.map(u16::try_from) else {
        return Err(Unfit::Window(info.binning_x, info.binning_y, full[0], full[1]));
    };
    let centre = if info.p[0] > 0.0 { [info.p[2], info.p[6]] } else { [info.k[2], info.k[5]] };
    if info.p[0] > 0.0 || info.k[0] > 0.0 {
        check_centre_of(centre, Dims { width: full_width, height: full_height })?;
    }
    let window = SentWindow {
        full,
        binning: [info.binning_x, info.binning_y],
        roi: [x_offset, y_offset, width, height],
    };
    window.check_images(images)?;
    let mut sent = info.clone();
    window.apply(&mut sent.k, 3);
    window.apply(&mut sent.p, 4);
    Ok(sent)
}

/// True for a camera whose images need no rectification.
fn is_ideal(info: &CameraInfo) -> bool {
    let same = |a: f64, b: f64| (a - b).abs() < 1e-9;
    let p = &info.p;
    let projected = [p[0], p[1], p[2], p[4], p[5], p[6], p[8], p[9], p[10]];
    let pairs = |a: &[f64; 9], b: &[f64; 9]| a.iter().zip(b).all(|(a, b)| same(*a, *b));
    info.d.iter().all(|&value| value == 0.0)
        && pairs(&info.r, &NO_ROTATION)
        && pairs(&info.k, &projected)
}

/// As a file that `camera_info_manager` writes, which the rectification takes.
fn raw(path: &Path, topic: &str, info: &CameraInfo, images: Dims) -> RigText {
    let model: String =
        info.distortion_model.chars().filter(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
    let [width, height] = full_size(info, images);
    let mut text = format!("width: {width}\nheight: {height}\ndistortion_model: \"{model}\"\n");
    let RegionOfInterest { x_offset, y_offset, width, height, .. } = info.roi;
    let _ = writeln!(text, "binning_x: {}\nbinning_y: {}", info.binning_x, info.binning_y);
    let _ = writeln!(
        text,
        "roi: {{x_offset: {x_offset}, y_offset: {y_offset}, width: {width}, height: {height}}}"
    );
    for (name, values) in [("d", &info.d[..]), ("k", &info.k), ("r", &info.r), ("p", &info.p)] {
        let _ = writeln!(text, "{name}: {values:?}");
    }
    RigText { path: PathBuf::from(format!("{}, {topic}", path.display())), text: Some(text) }
}
