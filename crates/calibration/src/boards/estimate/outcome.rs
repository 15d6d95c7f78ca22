//! Input and result of an estimate: boards, numbers with their spread, views, why there is none.

use super::super::board::BoardCorners;
use super::super::initial::LEAST_POINTS;
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
    pub fn new(name: String, left: BoardCorners, right: BoardCorners) -> Self {
        let right = right.turned_like(&left);
        let ((left_numbers, left), (right_numbers, right)) =
            (left.into_inner(), right.into_inner());
        Self { name, numbers: [left_numbers, right_numbers], corners: [left, right] }
    }

    /// All corners, row by row.
    pub fn whole(name: String, corners: [Vec<[f64; 2]>; 2]) -> Self {
        Self {
            name,
            numbers: corners.each_ref().map(|corners| (0..corners.len()).collect()),
            corners,
        }
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
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Dropped {
    /// It does not fit one camera alone, or both: its error in px.
    #[error("error {0:.2} px, far above the others: blurred, or the board is bent?")]
    Error(f64),
    /// It says something else about the cameras' pose than the others: off by so many px.
    #[error(
        "pose of the cameras off by {0:.0} px from the other views: were both photos taken at the \
         same time?"
    )]
    Pose(f64),
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
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum EstimateError {
    /// Fewer than five views are left: found, used.
    #[error(
        "only {1} of {0} views are usable, {LEAST_VIEWS} are needed (15 are good); take more sharp \
         photos with the whole board in both images"
    )]
    TooFew(usize, usize),
    /// No camera explains what is seen.
    #[error(
        "no lens model fits the corners of the {0} camera; check that the board is flat, the focus \
         is fixed and --lens is right"
    )]
    NoFit(CameraSide),
    /// The best fit is no camera.
    #[error("{0} camera: {1}; take photos with the board in all corners of the image")]
    Camera(CameraSide, CameraError),
    /// The best fit is no pair.
    #[error("{}", text_of_pair(.0))]
    Pair(CalibrationError),
    /// The photos of one camera are mirrored.
    #[error("the photos of the {0} camera are mirrored; turn mirroring off and take them again")]
    Mirrored(CameraSide),
    /// Too few views agree about the cameras' pose: those that agree, and all.
    #[error(
        "only {0} of {1} views agree about the pose between the cameras: the board is flipped \
         between the cameras, photos do not belong together, or a camera moved; check the pairs"
    )]
    NoRig(usize, usize),
    /// The photos do not fix the numbers.
    #[error(
        "the photos do not determine the cameras; take more, with the board tilted in different \
         directions"
    )]
    Undetermined,
}

fn text_of_pair(error: &CalibrationError) -> String {
    if *error == CalibrationError::Swapped {
        "the cameras are swapped: the right one lies to the left; exchange the names of their photos".to_owned()
    } else {
        format!("{error}; check which photos belong together and how they are turned")
    }
}
