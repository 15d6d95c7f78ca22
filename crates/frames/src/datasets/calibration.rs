//! The small text files of data sets: `calib.txt` of Middlebury and ETH3D, `calib` and `calib_cam_to_cam` of KITTI.
//!
//! ```text
//! calib.txt                    calib/000000.txt, calib_cam_to_cam/000000.txt
//! cam0=[f 0 cx; 0 f cy; ..]    P0: f 0 cx 0 0 f cy 0 0 0 1 0         (P_rect_02: in 2015)
//! cam1=[..]                    P1: f 0 cx -f*B ..                    B = (P[3] of the left - P[3] of the right) / f
//! doffs=cx1-cx0                offset = cx right - cx left
//! baseline=in mm
//! ndisp=a bound of the search
//! ```
//!
//! # Source
//! Middlebury: `vision.middlebury.edu/stereo/data/scenes2014/` ("calibration file format"); ETH3D has the same, "baseline in mm". KITTI: the
//! devkits' readme.txt; Geiger, Lenz, Stiller, Urtasun, "Vision meets robotics", IJRR 2013, Eq. 4.

use crate::error::{FrameError, LayoutFault};
use crate::untrusted::{self, SETTINGS_BYTES};
use linestereo_wire::RigUpdate;
use std::path::Path;

/// Numbers of a `calib.txt`.
pub(crate) struct MiddleburyCalibration {
    pub(crate) rig: RigUpdate,
    /// Disparities to search, px; what is no bound of anything counts as not said.
    pub(crate) range: Option<f64>,
}

pub(crate) fn middlebury(path: &Path) -> Result<MiddleburyCalibration, FrameError> {
    let text = read(path)?;
    let value = |name: &str| {
        let lines = text.lines().filter_map(|line| line.split_once('='));
        lines.map(|(key, value)| (key.trim(), value.trim())).find(|(key, _)| *key == name).map(|(_, value)| value)
    };
    let fault = |what| FrameError::Layout(path.to_path_buf(), LayoutFault::Calibration(what));
    let number = |name: &'static str| value(name).and_then(finite).ok_or_else(|| fault(name));
    let camera = value("cam0").and_then(|text| text.trim_start_matches('[').split([' ', ';', ']']).next());
    let focal_px = camera.and_then(finite).ok_or_else(|| fault("cam0"))?;
    let (baseline_mm, offset_px) = (number("baseline")?, number("doffs")?);
    let (range, width) = (value("ndisp").and_then(finite), value("width").and_then(finite));
    Ok(MiddleburyCalibration {
        rig: RigUpdate { focal_px, baseline_m: baseline_mm / 1000.0, offset_px },
        // ETH3D writes the images' width: that bounds nothing.
        range: range.filter(|range| *range >= 1.0 && width.is_none_or(|width| *range < width)),
    })
}

/// The rig of the cameras with these numbers.
pub(crate) fn kitti(path: &Path, cameras: [u8; 2]) -> Result<RigUpdate, FrameError> {
    let text = read(path)?;
    let fault = |what| FrameError::Layout(path.to_path_buf(), LayoutFault::Calibration(what));
    let matrix = |camera: u8| {
        let names = [format!("P{camera}"), format!("P_rect_0{camera}")];
        let mut lines = text.lines().filter_map(|line| line.split_once(':'));
        let (_, values) = lines.find(|(key, _)| names.iter().any(|name| name == key.trim()))?;
        let values: Vec<f64> = values.split_whitespace().map(finite).collect::<Option<_>>()?;
        <[f64; 12]>::try_from(values).ok()
    };
    let left = matrix(cameras[0]).ok_or_else(|| fault("the left camera's projection (P0, P2 or P_rect_02)"))?;
    let right = matrix(cameras[1]).ok_or_else(|| fault("the right camera's projection (P1, P3 or P_rect_03)"))?;
    let focal_px = left[0];
    Ok(RigUpdate { focal_px, baseline_m: (left[3] - right[3]) / focal_px, offset_px: right[2] - left[2] })
}

/// The number in a file of one number.
pub(crate) fn single_number(path: &Path, what: &'static str) -> Result<f64, FrameError> {
    let text = read(path)?;
    finite(text.trim()).ok_or_else(|| FrameError::Layout(path.to_path_buf(), LayoutFault::Calibration(what)))
}

fn read(path: &Path) -> Result<String, FrameError> {
    untrusted::read_text(path, SETTINGS_BYTES).map_err(|error| FrameError::Read(path.to_path_buf(), error))
}

fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}
