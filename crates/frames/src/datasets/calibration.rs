//! The small text files of data sets: `calib.txt` of Middlebury and ETH3D, `calib` and
//! `calib_cam_to_cam` of KITTI.
//!
//! ```text
//! calib.txt                    calib/000000.txt, calib_cam_to_cam/000000.txt
//! cam0=[f 0 cx; 0 f cy; ..]    P0: f 0 cx 0 0 f cy 0 0 0 1 0         (P_rect_02: in 2015)
//! cam1=[..]                    P1: f 0 cx -f*B ..                    B = (P[3] of the left - P[3] of the right) / f
//! doffs=cx1-cx0                offset = cx right - cx left
//! baseline=in mm
//! width, height: of the images          S_rect_02: width and height, in 2015
//! ndisp=a bound of the search
//! ```
//!
//! # Source
//! Middlebury: `vision.middlebury.edu/stereo/data/scenes2014/` ("calibration file format"); ETH3D
//! has the same, "baseline in mm". KITTI: the devkits' readme.txt; Geiger, Lenz, Stiller, Urtasun,
//! "Vision meets robotics", IJRR 2013, Eq. 4.

use crate::error::{FrameError, LayoutFault};
use crate::rectified::{RectifiedRig, Unfit};
use crate::untrusted::{self, SETTINGS_BYTES};
use linestereo::Dims;
use std::path::Path;

/// Columns by which `doffs` may differ from what `cam0` and `cam1` say, px.
const SAME_OFFSET_PX: f64 = 0.1;

/// Numbers of a `calib.txt`.
pub(crate) struct MiddleburyCalibration {
    pub(crate) rig: RectifiedRig,
    /// Disparities to search, px; what is no bound of anything counts as not said.
    pub(crate) range: Option<f64>,
}

pub(crate) fn middlebury(path: &Path) -> Result<MiddleburyCalibration, FrameError> {
    let text = read(path)?;
    let value = |name: &str| {
        let lines = text.lines().filter_map(|line| line.split_once('='));
        lines
            .map(|(key, value)| (key.trim(), value.trim()))
            .find(|(key, _)| *key == name)
            .map(|(_, value)| value)
    };
    let fault = |what| FrameError::Layout(path.to_path_buf(), LayoutFault::Calibration(what));
    let number = |name: &'static str| value(name).and_then(finite).ok_or_else(|| fault(name));
    let camera = |name: &'static str| value(name).and_then(matrix).ok_or_else(|| fault(name));
    let left = camera("cam0")?;
    let (baseline_mm, doffs) = (number("baseline")?, number("doffs")?);
    let right = camera("cam1")?;
    if (right[2] - left[2] - doffs).abs() > SAME_OFFSET_PX {
        return Err(fault(
            "doffs is not the difference of the principal points of cam1 and cam0: one of them",
        ));
    }
    let side = |name| {
        value(name)
            .and_then(finite)
            .filter(|side| (1.0..=65535.0).contains(side))
            .map(|side| side as u16)
    };
    let size = side("width").zip(side("height")).map(|(width, height)| Dims { width, height });
    let projection = |[fx, skew, cx, below, fy, cy, a, b, c]: [f64; 9], along| {
        [fx, skew, cx, along, below, fy, cy, 0.0, a, b, c, 0.0]
    };
    let right = projection(right, -left[0] * baseline_mm / 1000.0);
    let rig = RectifiedRig::of_projections([&projection(left, 0.0), &right], size)
        .map_err(|unfit| self::unfit(path, unfit))?;
    let range = value("ndisp").and_then(finite);
    Ok(MiddleburyCalibration {
        rig,
        // ETH3D writes the images' width: that bounds nothing.
        range: range.filter(|range| {
            *range >= 1.0 && size.is_none_or(|size| *range < f64::from(size.width))
        }),
    })
}

/// `[f 0 cx; 0 f cy; 0 0 1]`.
fn matrix(text: &str) -> Option<[f64; 9]> {
    let numbers = text.split(['[', ' ', ';', ',', ']']).filter(|word| !word.is_empty());
    <[f64; 9]>::try_from(numbers.map(finite).collect::<Option<Vec<f64>>>()?).ok()
}

/// The rig of the cameras with these numbers.
pub(crate) fn kitti(path: &Path, cameras: [u8; 2]) -> Result<RectifiedRig, FrameError> {
    let text = read(path)?;
    let fault = |what| FrameError::Layout(path.to_path_buf(), LayoutFault::Calibration(what));
    let values = |names: &[String]| -> Option<Vec<f64>> {
        let mut lines = text.lines().filter_map(|line| line.split_once(':'));
        let (_, values) = lines.find(|(key, _)| names.iter().any(|name| name == key.trim()))?;
        values.split_whitespace().map(finite).collect()
    };
    let projection = |camera: u8| {
        let values = values(&[format!("P{camera}"), format!("P_rect_0{camera}")])?;
        <[f64; 12]>::try_from(values).ok()
    };
    let left = projection(cameras[0])
        .ok_or_else(|| fault("the left camera's projection (P0, P2 or P_rect_02)"))?;
    let right = projection(cameras[1])
        .ok_or_else(|| fault("the right camera's projection (P1, P3 or P_rect_03)"))?;
    let size = match values(&[format!("S_rect_0{}", cameras[0])]).as_deref() {
        Some(&[width, height]) if width >= 1.0 && height >= 1.0 => {
            Some(Dims { width: width as u16, height: height as u16 })
        }
        _ => None,
    };
    RectifiedRig::of_projections([&left, &right], size).map_err(|unfit| self::unfit(path, unfit))
}

fn unfit(path: &Path, unfit: Unfit) -> FrameError {
    FrameError::Unfit(path.to_path_buf(), unfit)
}

/// The number in a file of one number.
pub(crate) fn single_number(path: &Path, what: &'static str) -> Result<f64, FrameError> {
    let text = read(path)?;
    finite(text.trim())
        .ok_or_else(|| FrameError::Layout(path.to_path_buf(), LayoutFault::Calibration(what)))
}

fn read(path: &Path) -> Result<String, FrameError> {
    untrusted::read_text(path, SETTINGS_BYTES)
        .map_err(|error| FrameError::Read(path.to_path_buf(), error))
}

fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}
