//! Which numbers are estimated, and what is believed of them beforehand.

use super::super::bundle::{Belief, RIG, camera_numbers};
use super::super::model::{FX, FY, Intrinsics, K1, SKEW};
use crate::interchange::LensModel;
use linestereo::Dims;

/// Prior standard deviation of k1, k2, k3 (k1 to k4 of a fisheye) and p1, p2, as the share of the
/// radius by which they move a corner of the image, and the error of a corner that this is weighed
/// against, px.
const BELIEFS: ([f64; 4], f64) = ([1.0, 0.5, 0.2, 0.2], 0.02);
const BELIEF_ERROR: f64 = 0.15;

/// Free parameters of the estimate.
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

/// Shared numbers that are estimated.
pub(super) fn shared_numbers(options: &Options, both: bool) -> Vec<usize> {
    let names = options.lens.names();
    let held = |number: usize| {
        (number == SKEW && !options.skew)
            || (number == FY && options.square_pixels)
            || (options.fix_k3 && ["k3", "k4"].contains(&names[number]))
    };
    let camera: Vec<usize> = (0..names.len()).filter(|&number| !held(number)).collect();
    let eyes = if both { 0..2 } else { 0..1 };
    let cameras =
        eyes.flat_map(|eye| camera.iter().map(move |number| camera_numbers(eye) + number));
    cameras.chain(if both { RIG..RIG + 6 } else { 0..0 }).collect()
}

/// Priors of the lens coefficients, by the radius that the image reaches.
pub(super) fn beliefs(cameras: &[Intrinsics; 2], dims: Dims) -> Vec<Belief> {
    let (radial, tangential) = BELIEFS;
    let corner = f64::from(dims.width).hypot(f64::from(dims.height)) / 2.0;
    let of = |eye: usize| {
        let camera = cameras[eye];
        let reach = corner / camera.numbers[FX];
        // Of a fisheye, the radius in the image is nearly the angle, which is what its terms are
        // powers of.
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
