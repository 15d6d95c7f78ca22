//! Input and result of an estimate: boards, numbers with their spread, views, why there is none.

use super::super::board::BoardCorners;
use super::super::initial::LEAST_POINTS;
use crate::rig_file::side_name;
use core::fmt;
use linestereo_rig::{Calibration, CalibrationError, CameraError, CameraSide};

/// Views without which nothing is estimated.
pub const LEAST_VIEWS: usize = 5;

/// Corners of a board without which a photo says too little of it.
pub const LEAST_CORNERS: usize = LEAST_POINTS;

/// A board seen in both photos of a pair, px. Corners have the same place in both.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardPair {
    /// For messages.
    pub name: String,
    /// Numbers of the corners on the board, ascending: left, right.
    pub numbers: [Vec<usize>; 2],
    /// Left, right.
    pub corners: [Vec<[f64; 2]>; 2],
}

impl BoardPair {
    /// From what was found in both photos.
    #[must_use]
    pub fn new(name: String, left: BoardCorners, right: BoardCorners) -> Self {
        let right = right.turned_like(&left);
        let ((left_numbers, left), (right_numbers, right)) = (left.into_inner(), right.into_inner());
        Self { name, numbers: [left_numbers, right_numbers], corners: [left, right] }
    }

    /// All corners, row by row.
    #[must_use]
    pub fn whole(name: String, corners: [Vec<[f64; 2]>; 2]) -> Self {
        Self { name, numbers: corners.each_ref().map(|corners| (0..corners.len()).collect()), corners }
    }
}

/// An estimated number.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// `left.fx`, `pose.rx`, ...: px, no unit, rad or m.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its standard deviation; 0 for what was held.
    pub sigma: f64,
}

/// Why a view is not used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dropped {
    /// It does not fit one camera alone, or both: its error in px.
    Error(f64),
    /// It says something else about the cameras' pose than the others: off by so many px.
    Pose(f64),
}

impl fmt::Display for Dropped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Error(rms) => write!(f, "error {rms:.2} px, far above the others: blurred, or the board is bent?"),
            Self::Pose(off) => {
                write!(f, "off by {off:.0} px from what the others say of the cameras: not taken at the same time?")
            }
        }
    }
}

/// One pair of photos after the estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewReport {
    /// As given.
    pub name: String,
    /// Root mean square of the errors in each photo, px; 0 when it was dropped.
    pub rms: [f64; 2],
    /// Angle between the board and the left image, degrees.
    pub tilt: f64,
    /// Corners left out as they do not fit.
    pub bad_corners: usize,
    /// Why it was not used.
    pub dropped: Option<Dropped>,
}

/// One corner and how far the estimate is from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerError {
    /// Index of the view.
    pub view: usize,
    /// Index on the board.
    pub corner: usize,
    /// Where it was seen, px.
    pub at: [f64; 2],
    /// Predicted less seen, px.
    pub error: [f64; 2],
}

/// A calibrated pair and what it is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Cameras and pose.
    pub calibration: Calibration,
    /// Every number of both cameras and the pose.
    pub parameters: Vec<Parameter>,
    /// Standard deviation of the baseline, m.
    pub baseline_sigma: f64,
    /// Root mean square of the distances between predicted and seen corners, both cameras, px.
    pub rms: f64,
    /// The same for each camera.
    pub camera_rms: [f64; 2],
    /// Standard deviation of one coordinate of a corner, px.
    pub sigma: f64,
    /// As given, in their order.
    pub views: Vec<ViewReport>,
    /// Corners used, left and right.
    pub errors: [Vec<CornerError>; 2],
}

/// Why there is no calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EstimateError {
    /// Fewer than five views are left: found, used.
    TooFew(usize, usize),
    /// No camera explains what is seen.
    NoFit(CameraSide),
    /// The best fit is no camera.
    Camera(CameraSide, CameraError),
    /// The best fit is no pair.
    Pair(CalibrationError),
    /// The photos of one camera are mirrored.
    Mirrored(CameraSide),
    /// Too few views agree about the cameras' pose: those that agree, and all.
    NoRig(usize, usize),
    /// The photos do not fix the numbers.
    Undetermined,
}

impl fmt::Display for EstimateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew(found, used) => write!(
                f,
                "only {used} of {found} views are usable, {LEAST_VIEWS} are needed (15 are good); \
                 take more sharp photos with the whole board in both images"
            ),
            Self::NoFit(eye) => write!(
                f,
                "no lens explains the corners of the {} camera; is the board flat, the focus fixed, --lens right?",
                side_name(*eye)
            ),
            Self::Camera(eye, error) => {
                write!(f, "{} camera: {error}; take photos with the board in all corners of the image", side_name(*eye))
            }
            Self::Pair(CalibrationError::Swapped) => {
                write!(f, "the cameras are swapped: the right one lies to the left; exchange the names of their photos")
            }
            Self::Pair(error) => write!(f, "{error}; check which photos belong together and how they are turned"),
            Self::Mirrored(eye) => {
                write!(
                    f,
                    "the photos of the {} camera are mirrored; turn mirroring off and take them again",
                    side_name(*eye)
                )
            }
            Self::NoRig(agree, of) => write!(
                f,
                "only {agree} of {of} views agree about the pose between the cameras: the board is flipped between the \
                 cameras, photos do not belong together, or a camera moved; check the pairs"
            ),
            Self::Undetermined => {
                write!(f, "the photos do not fix the cameras; tilt the board in different directions and take more")
            }
        }
    }
}

impl core::error::Error for EstimateError {}
