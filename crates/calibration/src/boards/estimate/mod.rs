//! Corners of a board in pairs of photos -> two cameras and the pose between them, with what they
//! are worth.
//!
//! In: [`BoardPair`]s, found by [`finder`](super::finder) or made up by a test. Out: an
//! [`Estimate`]: a [`Calibration`](linestereo_rig::Calibration), every number with its standard
//! deviation, what was dropped and why, all errors.
//!
//! ```text
//! each camera alone (single): focal length by search -> focal length and k1 -> everything; views
//!                             that do not fit are dropped
//! the pose between the cameras as each view sees it (agreement) -> the one most others agree
//!     with; views that disagree are dropped
//! all at once, by bundle adjustment (joint); corners and views that do not fit are dropped;
//!     again, until none is
//! ```
//!
//! Free parameters: focal lengths (both, as the pixels of cheap sensors after scaling are not
//! always square), centre, all of the lens. Skew is 0 unless asked for: no sensor of today has any.
//! The lens terms carry a weak belief (`BELIEFS`): photos that reach the corners of the image
//! outweigh it a hundredfold; where they do not, it keeps k2 and k3 from cancelling each other out
//! with large values that fit these boards and no others.
//!
//! # Source
//! Zhang, 2000, for the plan; Triggs and others, 2000, for bundle adjustment, dropping what does
//! not fit, and the covariance.

mod agreement;
mod free;
mod joint;
mod outcome;
mod report;
mod single;

pub use free::Options;
pub use outcome::{
    BoardPair, CornerError, Dropped, Estimate, EstimateError, LEAST_CORNERS, LEAST_VIEWS,
    Parameter, ViewReport,
};

use super::board::Board;
use super::bundle::Bundle;
use super::initial::Sightings;
use agreement::agreed_rig;
use free::{beliefs, shared_numbers};
use joint::robust;
use linestereo::Dims;
use linestereo_frames::statistics::upper_median;
use linestereo_rig::CameraSide;
use report::report;
use single::single;
use std::thread;

/// A view whose error is above this many times the median of all views is dropped.
const BAD_VIEW: f64 = 3.0;
/// Rounds of dropping and estimating again.
const ROUNDS: usize = 6;

/// Estimates both cameras and their pose from boards that both saw.
pub fn estimate(
    board: &Board,
    dims: Dims,
    pairs: &[BoardPair],
    options: &Options,
) -> Result<Estimate, EstimateError> {
    if pairs.len() < LEAST_VIEWS {
        return Err(EstimateError::TooFew(pairs.len(), pairs.len()));
    }
    let places = board.points();
    let seen = |eye: usize| -> Vec<Sightings> {
        let sightings = |pair: &BoardPair| {
            let seen = pair.numbers[eye].iter().map(|&number| places[number]);
            seen.zip(pair.corners[eye].iter().copied()).collect()
        };
        pairs.iter().map(sightings).collect()
    };
    let sightings = [seen(0), seen(1)];
    let (left, right) = thread::scope(|scope| {
        let right = scope.spawn(|| single(dims, &sightings[1], options));
        (single(dims, &sightings[0], options), right.join())
    });
    let left = left.ok_or(EstimateError::NoFit(CameraSide::Left))?;
    let right = right.ok().flatten().ok_or(EstimateError::NoFit(CameraSide::Right))?;

    let mut dropped: Vec<Option<Dropped>> =
        left.dropped.iter().zip(&right.dropped).map(|(left, right)| left.or(*right)).collect();
    let rig = agreed_rig(board, dims, &sightings, [&left, &right], &mut dropped)?;
    let cameras = [left.bundle.cameras[0], right.bundle.cameras[0]];
    let mut views = left.bundle.views;
    let [_, seen_right] = sightings;
    views.iter_mut().zip(seen_right).for_each(|(view, right)| view.seen[1] = right);
    let joint = Bundle {
        cameras,
        rig,
        views,
        free: shared_numbers(options, true),
        square_pixels: options.square_pixels,
        beliefs: beliefs(&cameras, dims),
    };
    let (bundle, used) = robust(joint, &mut dropped)?;
    report(dims, &places, pairs, &bundle, &used, &dropped)
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
