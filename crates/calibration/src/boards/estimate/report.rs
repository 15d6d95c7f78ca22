//! From the bundle to what is reported: cameras, numbers with their spread, errors of views and
//! corners.

use super::super::bundle::{Bundle, RIG, camera_numbers};
use super::super::model::{FX, FY};
use super::outcome::{
    BoardPair, CornerError, Dropped, Estimate, EstimateError, Parameter, ViewReport,
};
use super::root_mean_square;
use crate::rig_file::quaternion;
use linestereo::Dims;
use linestereo_rig::{Calibration, CameraSide};
use nalgebra::{DMatrix, Vector3};

/// The bundle as an [`Estimate`]: `used` are the views that it holds.
pub(super) fn report(
    dims: Dims,
    places: &[[f64; 2]],
    pairs: &[BoardPair],
    bundle: &Bundle,
    used: &[usize],
    dropped: &[Option<Dropped>],
) -> Result<Estimate, EstimateError> {
    let camera = |eye: usize, name: CameraSide| {
        bundle.cameras[eye].camera(dims).map_err(|error| EstimateError::Camera(name, error))
    };
    let [rx, ry, rz, shift @ ..] = bundle.rig.0;
    let calibration = Calibration::new(
        camera(0, CameraSide::Left)?,
        camera(1, CameraSide::Right)?,
        quaternion([rx, ry, rz]),
        shift,
    )
    .map_err(EstimateError::Pair)?;
    let spread = bundle.spread().ok_or(EstimateError::Undetermined)?;

    let (views, errors) = view_reports(places, pairs, bundle, used, dropped);
    let distances =
        |eye: usize| errors[eye].iter().flat_map(|corner| corner.error).collect::<Vec<f64>>();
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

/// Every view as given, and the corners of both cameras that are used.
fn view_reports(
    places: &[[f64; 2]],
    pairs: &[BoardPair],
    bundle: &Bundle,
    used: &[usize],
    dropped: &[Option<Dropped>],
) -> (Vec<ViewReport>, [Vec<CornerError>; 2]) {
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
                errors[eye].push(CornerError {
                    view: index,
                    corner,
                    at: *at,
                    error: [error[0], error[1]],
                });
            }
        }
        let given = pairs[index].corners.iter().map(Vec::len).sum::<usize>();
        views[index].bad_corners = given - view.seen[0].len() - view.seen[1].len();
        views[index].tilt =
            (view.pose.rotation() * Vector3::z()).z.clamp(-1.0, 1.0).acos().to_degrees();
    }
    (views, errors)
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
fn baseline_sigma(bundle: &Bundle, covariance: &DMatrix<f64>) -> f64 {
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
