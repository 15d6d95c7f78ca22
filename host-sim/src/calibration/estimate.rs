//! Corners of a board in pairs of photos -> two cameras and the pose between them, with what they are worth.
//!
//! In: [`BoardPair`]s, found by [`finder`](super::finder) or made up by a test. Out: an [`Estimate`]: a [`Calibration`], every number
//! with its standard deviation, what was dropped and why, all errors.
//!
//! ```text
//! each camera alone: focal length by search -> focal length and k1 -> everything; views that do not fit are dropped
//! the pose between the cameras as each view sees it -> the one most others agree with; views that disagree are dropped
//! all at once, by bundle adjustment; corners and views that do not fit are dropped; again, until none is
//! ```
//!
//! What is free: focal lengths (both, as the pixels of cheap sensors after scaling are not always square), centre, all of the lens. Skew is
//! 0 unless asked for: no sensor of today has any. The lens terms carry a weak belief ([`BELIEFS`]): photos that reach the corners of the
//! image outweigh it a hundredfold; where they do not, it keeps k2 and k3 from cancelling each other out with large values that fit
//! these boards and no others.
//!
//! # Source
//! Zhang, 2000, for the plan; Triggs and others, 2000, for bundle adjustment, dropping what does not fit, and the covariance.

use super::board::Board;
use super::bundle::{Belief, BoardView, Bundle, RIG, camera_numbers};
use super::initial::{self, Sightings};
use super::model::{FX, FY, Intrinsics, K1, LensModel, Pose, SKEW};
use crate::input::rig_file::quaternion;
use crate::statistics::upper_median;
use core::fmt;
use linestereo::Dims;
use linestereo::rectify::{Calibration, CalibrationError, CameraError, Eye};
use std::thread;

/// ValidPixels without which nothing is estimated.
pub const LEAST_VIEWS: usize = 5;
/// A view whose error is above this many times the median of all views is dropped.
const BAD_VIEW: f64 = 3.0;
/// A corner further off than this many standard deviations, and than this in px, is dropped.
const BAD_CORNER: (f64, f64) = (8.0, 0.5);
/// ValidPixels that may differ in what they say of the cameras' pose before it is refined, in widths of the image.
const AGREE: f64 = 0.03;
/// Rounds of dropping and estimating again.
const ROUNDS: usize = 6;
/// An error above which a first guess was a wrong one, px.
const LOST: f64 = 3.0;
/// How much of the radius k1, k2, k3 (k1 to k4 of a fisheye) and p1, p2 move a corner of the image, as a standard deviation of belief, and
/// the error of a corner that this is weighed against, px.
const BELIEFS: ([f64; 4], f64) = ([1.0, 0.5, 0.2, 0.2], 0.02);
const BELIEF_ERROR: f64 = 0.15;

/// A board seen in both photos of a pair: all its corners, row by row, px. Corners have the same place in both.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardPair {
    /// For messages.
    pub name: String,
    /// Left, right.
    pub corners: [Vec<[f64; 2]>; 2],
}

/// What to estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Family of both lenses.
    pub lens: LensModel,
    /// Estimate the skew too.
    pub skew: bool,
    /// Hold `fx = fy`.
    pub square_pixels: bool,
    /// Hold k3 (k3 and k4 of a fisheye) at 0.
    pub fix_k3: bool,
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
    NoFit(Eye),
    /// What fits best is no camera.
    Camera(Eye, CameraError),
    /// What fits best is no pair.
    Pair(CalibrationError),
    /// The photos of one camera are mirrored.
    Mirrored(Eye),
    /// So many of so many views agree about the cameras' pose.
    NoRig(usize, usize),
    /// The photos do not fix the numbers.
    Undetermined,
}

impl fmt::Display for EstimateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |eye: &Eye| if *eye == Eye::Left { "left" } else { "right" };
        match self {
            Self::TooFew(found, used) => write!(
                f,
                "only {used} of {found} views are usable, {LEAST_VIEWS} are needed (15 are good); \
                 take more sharp photos with the whole board in both images"
            ),
            Self::NoFit(eye) => write!(
                f,
                "no lens explains the corners of the {} camera; is the board flat, the focus fixed, --lens right?",
                name(eye)
            ),
            Self::Camera(eye, error) => {
                write!(f, "{} camera: {error}; take photos with the board in all corners of the image", name(eye))
            }
            Self::Pair(CalibrationError::Swapped) => {
                write!(f, "the cameras are swapped: the right one lies to the left; exchange the names of their photos")
            }
            Self::Pair(error) => write!(f, "{error}; check which photos belong together and how they are turned"),
            Self::Mirrored(eye) => {
                write!(f, "the photos of the {} camera are mirrored; turn mirroring off and take them again", name(eye))
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

/// Estimates both cameras and their pose from boards that both saw.
pub fn estimate(board: &Board, dims: Dims, pairs: &[BoardPair], options: &Options) -> Result<Estimate, EstimateError> {
    if pairs.len() < LEAST_VIEWS {
        return Err(EstimateError::TooFew(pairs.len(), pairs.len()));
    }
    let places = board.points();
    let seen = |eye: usize| -> Vec<Sightings> {
        let sightings = |pair: &BoardPair| places.iter().copied().zip(pair.corners[eye].iter().copied()).collect();
        pairs.iter().map(sightings).collect()
    };
    let sightings = [seen(0), seen(1)];
    let (left, right) = thread::scope(|scope| {
        let right = scope.spawn(|| single(dims, &sightings[1], options));
        (single(dims, &sightings[0], options), right.join())
    });
    let left = left.ok_or(EstimateError::NoFit(Eye::Left))?;
    let right = right.ok().flatten().ok_or(EstimateError::NoFit(Eye::Right))?;

    let mut dropped: Vec<Option<Dropped>> =
        left.dropped.iter().zip(&right.dropped).map(|(left, right)| left.or(*right)).collect();
    let rig = agreed_rig(board, dims, &sightings, [&left, &right], &mut dropped)?;
    let mut joint = Bundle {
        cameras: [left.bundle.cameras[0], right.bundle.cameras[0]],
        rig,
        views: left.bundle.views.iter().zip(&sightings[1]).map(|(view, right)| with_right(view, right)).collect(),
        free: shared_numbers(options, true),
        square_pixels: options.square_pixels,
        beliefs: Vec::new(),
    };
    joint.beliefs = beliefs(&joint.cameras, dims);
    let (bundle, used) = robust(joint, &mut dropped)?;
    report(dims, &places, pairs, &bundle, &used, &dropped)
}

fn with_right(left: &BoardView, right: &Sightings) -> BoardView {
    BoardView { seen: [left.seen[0].clone(), right.clone()], pose: left.pose }
}

/// Shared numbers that are estimated.
fn shared_numbers(options: &Options, both: bool) -> Vec<usize> {
    let names = options.lens.names();
    let held = |number: usize| {
        (number == SKEW && !options.skew)
            || (number == FY && options.square_pixels)
            || (options.fix_k3 && ["k3", "k4"].contains(&names[number]))
    };
    let camera: Vec<usize> = (0..names.len()).filter(|&number| !held(number)).collect();
    let eyes = if both { 0..2 } else { 0..1 };
    let cameras = eyes.flat_map(|eye| camera.iter().map(move |number| camera_numbers(eye) + number));
    cameras.chain(if both { RIG..RIG + 6 } else { 0..0 }).collect()
}

/// What is believed of the lenses, by how far the image reaches.
fn beliefs(cameras: &[Intrinsics; 2], dims: Dims) -> Vec<Belief> {
    let (radial, tangential) = BELIEFS;
    let corner = f64::from(dims.width).hypot(f64::from(dims.height)) / 2.0;
    let of = |eye: usize| {
        let camera = cameras[eye];
        let reach = corner / camera.numbers[FX];
        // Of a fisheye, the radius in the image is nearly the angle, which is what its terms are powers of.
        let names = camera.model.names();
        (K1..names.len()).map(move |number| {
            let share = match names[number] {
                "k1" => radial[0] / reach.powi(2),
                "k2" => radial[1] / reach.powi(4),
                "k3" => radial[2] / reach.powi(6),
                "k4" => radial[3] / reach.powi(8),
                _ => tangential / reach,
            };
            Belief { number: camera_numbers(eye) + number, weight: BELIEF_ERROR / share }
        })
    };
    [0, 1].into_iter().flat_map(of).collect()
}

/// One camera from its own photos.
struct Single {
    bundle: Bundle,
    dropped: Vec<Option<Dropped>>,
}

fn single(dims: Dims, sightings: &[Sightings], options: &Options) -> Option<Single> {
    let searched = initial::focals(options.lens, dims, sightings);
    let width = f64::from(dims.width);
    let starts = searched.first().copied().into_iter().chain([0.6, 1.0, 1.8].map(|widths| widths * width));
    let mut best: Option<(f64, Bundle)> = None;
    for start in starts {
        let Some(bundle) = refined(dims, sightings, options, start) else { continue };
        let error = median(&view_errors(&bundle));
        if error.is_finite() && best.as_ref().is_none_or(|(least, _)| error < *least) {
            best = Some((error, bundle));
        }
        if best.as_ref().is_some_and(|(least, _)| *least < LOST) {
            break;
        }
    }
    let (_, mut bundle) = best?;
    let mut dropped = vec![None; sightings.len()];
    // ValidPixels that do not fit pull the others off: estimate without them, then pose them again for the report.
    for _ in 0..ROUNDS {
        let kept: Vec<usize> = (0..dropped.len()).filter(|&view| dropped[view].is_none()).collect();
        let errors = view_errors(&bundle);
        let limit = BAD_VIEW * median(&kept.iter().map(|&view| errors[view]).collect::<Vec<_>>());
        let bad: Vec<usize> = kept.iter().copied().filter(|&view| errors[view] > limit).collect();
        if bad.is_empty() || kept.len() - bad.len() < LEAST_VIEWS {
            break;
        }
        for view in bad {
            dropped[view] = Some(Dropped::Error(errors[view]));
        }
        let views = bundle.views.clone();
        bundle.views =
            (0..views.len()).filter(|&view| dropped[view].is_none()).map(|view| views[view].clone()).collect();
        bundle.solve();
        let mut solved = core::mem::take(&mut bundle.views).into_iter();
        bundle.views = views
            .into_iter()
            .zip(&dropped)
            .map(|(view, dropped)| if dropped.is_none() { solved.next().unwrap_or(view) } else { view })
            .collect();
    }
    Some(Single { bundle, dropped })
}

/// Refined from one focal length.
fn refined(dims: Dims, sightings: &[Sightings], options: &Options, focal: f64) -> Option<Bundle> {
    let camera = Intrinsics::plain(options.lens, dims, focal);
    // A view whose first pose fails must not cost the others: the solver finds it from a board face to face, or it is dropped.
    let view = |seen: &Sightings| {
        let pose = initial::pose(&camera, dims, seen).unwrap_or_else(|| initial::facing(&camera, seen));
        BoardView { seen: [seen.clone(), Vec::new()], pose }
    };
    let views = sightings.iter().map(view).collect();
    let mut bundle = Bundle {
        cameras: [camera; 2],
        rig: Pose([0.0; 6]),
        views,
        free: vec![FX, K1],
        square_pixels: true,
        beliefs: beliefs(&[camera; 2], dims),
    };
    bundle.solve();
    bundle.free = shared_numbers(options, false);
    bundle.square_pixels = options.square_pixels;
    bundle.beliefs = beliefs(&bundle.cameras, dims);
    bundle.solve().then_some(bundle)
}

/// Root mean square distance of each view's corners, px.
fn view_errors(bundle: &Bundle) -> Vec<f64> {
    bundle.views.iter().map(|view| root_mean_square(&bundle.errors(view))).collect()
}

/// Of distances, from their coordinates one after the other.
fn root_mean_square(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / (errors.len() / 2).max(1) as f64).sqrt()
}

fn median(values: &[f64]) -> f64 {
    upper_median(values.to_vec(), f64::total_cmp).unwrap_or(f64::INFINITY)
}

/// The cameras' pose that most views agree with; the others are dropped.
fn agreed_rig(
    board: &Board,
    dims: Dims,
    sightings: &[Vec<Sightings>; 2],
    [left, right]: [&Single; 2],
    dropped: &mut [Option<Dropped>],
) -> Result<Pose, EstimateError> {
    let used: Vec<usize> = (0..dropped.len()).filter(|&view| dropped[view].is_none()).collect();
    if used.len() < LEAST_VIEWS {
        return Err(EstimateError::TooFew(dropped.len(), used.len()));
    }
    let limit = AGREE * f64::from(dims.width);
    let camera = right.bundle.cameras[0];
    let poses = |single: &Single| -> Vec<Pose> { used.iter().map(|&view| single.bundle.views[view].pose).collect() };
    let from = poses(left);
    let seen: Vec<&Sightings> = used.iter().map(|&view| &sightings[1][view]).collect();
    let (rig, off) = nearest_rig(&camera, &from, &poses(right), &seen);
    let agree = off.iter().filter(|&&off| off <= limit).count();
    if agree >= LEAST_VIEWS && 2 * agree > used.len() {
        for (&view, &off) in used.iter().zip(&off) {
            if off > limit {
                dropped[view] = Some(Dropped::Pose(off));
            }
        }
        return Ok(rig);
    }
    let mirrored = [false, true].into_iter().find_map(|rows| {
        let seen: Vec<Sightings> = seen.iter().map(|seen| unmirrored(board, dims, seen, rows)).collect();
        let to = seen.iter().map(|seen| initial::pose(&camera, dims, seen)).collect::<Option<Vec<_>>>()?;
        let (rig, off) = nearest_rig(&camera, &from, &to, &seen.iter().collect::<Vec<_>>());
        (2 * off.iter().filter(|&&off| off <= 2.0 * limit).count() > off.len()).then_some(rig)
    });
    Err(match mirrored {
        // With both mirrored the right camera appears on the wrong side: then it was the left one that was.
        Some(rig) if rig.inverse().translation().x < 0.0 => EstimateError::Mirrored(Eye::Left),
        Some(_) => EstimateError::Mirrored(Eye::Right),
        None => EstimateError::NoRig(agree, used.len()),
    })
}

/// Of the poses between the cameras that the views suggest, the one that is off least in the median, and how far it is off in each view, px.
fn nearest_rig(camera: &Intrinsics, from: &[Pose], to: &[Pose], seen: &[&Sightings]) -> (Pose, Vec<f64>) {
    let off = |rig: &Pose| -> Vec<f64> {
        let one = |(pose, seen): (&Pose, &&Sightings)| {
            let right = pose.then(rig);
            let (turn, shift) = (right.rotation(), right.translation());
            let apart = |&([x, y], [u, v]): &([f64; 2], [f64; 2])| {
                let [pu, pv] = camera.project(turn * nalgebra::Vector3::new(x, y, 0.0) + shift);
                [pu - u, pv - v]
            };
            root_mean_square(&seen.iter().flat_map(apart).collect::<Vec<_>>())
        };
        from.iter().zip(seen).map(one).collect()
    };
    let rigs = from.iter().zip(to).map(|(from, to)| from.inverse().then(to));
    let tried = rigs.map(|rig| (rig, off(&rig)));
    let best = tried.min_by(|a, b| median(&a.1).total_cmp(&median(&b.1)));
    best.unwrap_or((Pose([0.0; 6]), Vec::new()))
}

/// As the photo would be without its mirroring. The numbering of a mirrored board runs backwards along one side: the rows, or the columns.
fn unmirrored(board: &Board, dims: Dims, seen: &Sightings, rows: bool) -> Sightings {
    let (cols, count) = (board.cols(), board.corners());
    let other = |index: usize| {
        if rows {
            (count / cols - 1 - index / cols) * cols + index % cols
        } else {
            index / cols * cols + cols - 1 - index % cols
        }
    };
    let turned = |(index, &(place, _)): (usize, &([f64; 2], [f64; 2]))| {
        let [u, v] = seen[other(index)].1;
        (place, [f64::from(dims.width - 1) - u, v])
    };
    seen.iter().enumerate().map(turned).collect()
}

/// Estimates all at once, drops what does not fit, and again. Out: the bundle, and which views it holds.
fn robust(mut bundle: Bundle, dropped: &mut [Option<Dropped>]) -> Result<(Bundle, Vec<usize>), EstimateError> {
    let found = dropped.len();
    let mut used: Vec<usize> = (0..found).filter(|&view| dropped[view].is_none()).collect();
    bundle.views = used.iter().map(|&view| bundle.views[view].clone()).collect();
    for _ in 0..ROUNDS {
        if used.len() < LEAST_VIEWS {
            return Err(EstimateError::TooFew(found, used.len()));
        }
        bundle.solve();
        let bad_corners = drop_corners(&mut bundle);
        let errors = view_errors(&bundle);
        let limit = BAD_VIEW * median(&errors);
        let bad: Vec<bool> = errors.iter().map(|&error| error > limit).collect();
        if bad_corners == 0 && !bad.contains(&true) {
            return Ok((bundle, used));
        }
        for ((&view, &error), _) in used.iter().zip(&errors).zip(&bad).filter(|(_, bad)| **bad) {
            dropped[view] = Some(Dropped::Error(error));
        }
        let mut keep = bad.iter().map(|bad| !bad);
        bundle.views.retain(|_| keep.next().unwrap_or(true));
        used.retain(|&view| dropped[view].is_none());
    }
    bundle.solve();
    Ok((bundle, used))
}

/// Takes corners out that are far off; how many.
fn drop_corners(bundle: &mut Bundle) -> usize {
    let errors: Vec<Vec<f64>> = bundle.views.iter().map(|view| bundle.errors(view)).collect();
    let sizes: Vec<f64> = errors.iter().flatten().map(|error| error.abs()).collect();
    // The median of absolute values of a normal distribution is 0.6745 standard deviations.
    let limit = (BAD_CORNER.0 * median(&sizes) / 0.6745).max(BAD_CORNER.1);
    let mut gone = 0;
    for (view, errors) in bundle.views.iter_mut().zip(&errors) {
        let mut far = errors.chunks_exact(2).map(|error| error[0].hypot(error[1]) > limit);
        for seen in &mut view.seen {
            let before = seen.len();
            seen.retain(|_| !far.next().unwrap_or(false));
            gone += before - seen.len();
        }
    }
    gone
}

fn report(
    dims: Dims,
    places: &[[f64; 2]],
    pairs: &[BoardPair],
    bundle: &Bundle,
    used: &[usize],
    dropped: &[Option<Dropped>],
) -> Result<Estimate, EstimateError> {
    let camera =
        |eye: usize, name: Eye| bundle.cameras[eye].camera(dims).map_err(|error| EstimateError::Camera(name, error));
    let [rx, ry, rz, shift @ ..] = bundle.rig.0;
    let calibration = Calibration::new(camera(0, Eye::Left)?, camera(1, Eye::Right)?, quaternion([rx, ry, rz]), shift)
        .map_err(EstimateError::Pair)?;
    let spread = bundle.spread().ok_or(EstimateError::Undetermined)?;

    let mut errors = [Vec::new(), Vec::new()];
    let mut views: Vec<ViewReport> = pairs
        .iter()
        .zip(dropped)
        .map(|(pair, dropped)| ViewReport {
            name: pair.name.clone(),
            rms: [0.0; 2],
            tilt: 0.0,
            bad_corners: 0,
            dropped: *dropped,
        })
        .collect();
    for (view, &index) in bundle.views.iter().zip(used) {
        let all = bundle.errors(view);
        let (left, right) = all.split_at(2 * view.seen[0].len());
        for (eye, own) in [left, right].into_iter().enumerate() {
            views[index].rms[eye] = root_mean_square(own);
            for ((place, at), error) in view.seen[eye].iter().zip(own.chunks_exact(2)) {
                let corner = places.iter().position(|other| other == place).unwrap_or(0);
                errors[eye].push(CornerError { view: index, corner, at: *at, error: [error[0], error[1]] });
            }
        }
        views[index].bad_corners = 2 * places.len() - view.seen[0].len() - view.seen[1].len();
        views[index].tilt = (view.pose.rotation() * nalgebra::Vector3::z()).z.clamp(-1.0, 1.0).acos().to_degrees();
    }
    let distances = |eye: usize| errors[eye].iter().flat_map(|corner| corner.error).collect::<Vec<f64>>();
    let all: Vec<f64> = distances(0).into_iter().chain(distances(1)).collect();
    let sigma_of = |number: usize| {
        let position = bundle.free.iter().position(|&free| free == number);
        position.map_or(0.0, |i| spread.covariance[(i, i)].sqrt())
    };
    Ok(Estimate {
        calibration,
        parameters: parameters(bundle, sigma_of),
        baseline_sigma: baseline_sigma(bundle, &spread.covariance),
        rms: root_mean_square(&all),
        camera_rms: [root_mean_square(&distances(0)), root_mean_square(&distances(1))],
        sigma: spread.sigma,
        views,
        errors,
    })
}

fn parameters(bundle: &Bundle, sigma_of: impl Fn(usize) -> f64) -> Vec<Parameter> {
    let mut parameters = Vec::new();
    for (eye, side) in ["left", "right"].into_iter().enumerate() {
        let camera = &bundle.cameras[eye];
        for (number, name) in camera.model.names().iter().enumerate() {
            let source = if number == FY && bundle.square_pixels { FX } else { number };
            let (value, sigma) = (camera.numbers[number], sigma_of(camera_numbers(eye) + source));
            parameters.push(Parameter { name: format!("{side}.{name}"), value, sigma });
        }
    }
    for (number, name) in ["rx", "ry", "rz", "tx", "ty", "tz"].into_iter().enumerate() {
        let (value, sigma) = (bundle.rig.0[number], sigma_of(RIG + number));
        parameters.push(Parameter { name: format!("pose.{name}"), value, sigma });
    }
    parameters
}

/// Of the translation's length, by its derivative: the direction of the translation.
fn baseline_sigma(bundle: &Bundle, covariance: &nalgebra::DMatrix<f64>) -> f64 {
    let shift = bundle.rig.translation();
    let along = shift / shift.norm().max(1e-12);
    let position = |axis: usize| bundle.free.iter().position(|&free| free == RIG + 3 + axis);
    let mut variance = 0.0;
    for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
        if let (Some(i), Some(j)) = (position(a), position(b)) {
            variance += along[a] * along[b] * covariance[(i, j)];
        }
    }
    variance.max(0.0).sqrt()
}
