//! One camera from the numbers that all formats have in some order.
//!
//! Coefficients of radial-tangential lenses are `k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4 [tau_x
//! tau_y]]]]` in all formats (OpenCV's order), of equidistant ones `k1 k2 k3 k4`. Those beyond `k6`
//! are taken if they are zero.

use super::error::{Fault, Place, Problem};
use super::node::Matrix;
use linestereo::Dims;
use linestereo_rig::{Camera, CameraSide, Lens};

/// Meaning of the coefficients of a lens.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum LensModel {
    /// Radial and tangential (OpenCV's default, `radtan`, `plumb_bob`).
    #[default]
    BrownConrady,
    /// Equidistant (OpenCV's `fisheye`, Kalibr's `equidistant`).
    Fisheye,
}

/// Names of the coefficients beyond `k6`.
const FURTHER: [&str; 6] = ["s1", "s2", "s3", "s4", "tau_x", "tau_y"];

/// No lens model is named: coefficients, if there are any, have to be 0.
pub(super) fn no_lens(coefficients: &Matrix) -> Result<Lens, Fault> {
    if coefficients.vector()?.iter().all(|&value| value == 0.0) {
        return Ok(Lens::NONE);
    }
    let what = "lens coefficients without the name of a lens model, such as plumb_bob".to_owned();
    Err(Problem::Model(what).at(coefficients.place))
}

impl LensModel {
    /// By the names that Kalibr, ROS and EuRoC use; "none" has no coefficients.
    pub(super) fn named(name: &str, place: Place) -> Result<Option<Self>, Fault> {
        match name.trim().to_ascii_lowercase().as_str() {
            "radtan"
            | "radial-tangential"
            | "plumb_bob"
            | "rational_polynomial"
            | "brown-conrady" => Ok(Some(Self::BrownConrady)),
            "equidistant" | "equi" | "fisheye" | "kannala_brandt" => Ok(Some(Self::Fisheye)),
            "none" | "" => Ok(None),
            other => {
                let what = other.chars().take(24).collect::<String>();
                Err(Problem::Model(format!("the lens model \"{what}\" is not known")).at(place))
            }
        }
    }

    pub(super) fn lens(self, coefficients: &Matrix) -> Result<Lens, Fault> {
        let values = coefficients.vector()?;
        let wrong = |expected: &str| {
            let found = format!("a list of {} values", values.len());
            let name = coefficients.name().to_owned();
            Err(Problem::Shape { name, expected: expected.to_owned(), found }
                .at(coefficients.place))
        };
        match (self, values) {
            (Self::BrownConrady, []) => Ok(Lens::NONE),
            (Self::Fisheye, &[k1, k2, k3, k4]) => Ok(Lens::Fisheye { k: [k1, k2, k3, k4] }),
            (Self::Fisheye, _) => wrong("4 coefficients of a fisheye lens"),
            (Self::BrownConrady, &[k1, k2, p1, p2]) => {
                Ok(Lens::BrownConrady { k: [k1, k2, 0.0], p: [p1, p2] })
            }
            (Self::BrownConrady, &[k1, k2, p1, p2, k3]) => {
                Ok(Lens::BrownConrady { k: [k1, k2, k3], p: [p1, p2] })
            }
            (Self::BrownConrady, &[k1, k2, p1, p2, k3, k4, k5, k6, ref further @ ..])
                if [0, 4, 6].contains(&further.len()) =>
            {
                let names: Vec<&str> = FURTHER
                    .into_iter()
                    .zip(further)
                    .filter(|(_, value)| **value != 0.0)
                    .map(|(name, _)| name)
                    .collect();
                if !names.is_empty() {
                    return Err(
                        Problem::Coefficients { names: names.join(", ") }.at(coefficients.place)
                    );
                }
                Ok(if [k4, k5, k6] == [0.0; 3] {
                    Lens::BrownConrady { k: [k1, k2, k3], p: [p1, p2] }
                } else {
                    Lens::Rational { k: [k1, k2, k3, k4, k5, k6], p: [p1, p2] }
                })
            }
            (Self::BrownConrady, _) => wrong("0, 4, 5, 8, 12 or 14 coefficients"),
        }
    }
}

/// Focal lengths, centre and skew of a 3x3 camera matrix `fx s cx, 0 fy cy, 0 0 1`.
pub(super) fn intrinsics(matrix: &Matrix) -> Result<([f64; 2], [f64; 2], f64), Fault> {
    let [fx, skew, cx, below, fy, cy, last @ ..] = matrix.shaped::<9>(3, 3)?;
    if below != 0.0 || last != [0.0, 0.0, 1.0] {
        return Err(Problem::NoCameraMatrix(matrix.name().to_owned()).at(matrix.place));
    }
    Ok(([fx, fy], [cx, cy], skew))
}

/// A checked camera.
pub(super) fn camera(
    (eye, place): (CameraSide, Place),
    dims: Dims,
    (focal, centre, skew): ([f64; 2], [f64; 2], f64),
    lens: Lens,
) -> Result<Camera, Fault> {
    Camera::new(dims, focal, centre, skew, lens)
        .map_err(|error| Problem::Camera(eye, error).at(place))
}

/// A camera matrix by rows.
pub(super) fn matrix(camera: &Camera) -> [f64; 9] {
    let ([fx, fy], [cx, cy]) = (camera.focal(), camera.centre());
    [fx, camera.skew(), cx, 0.0, fy, cy, 0.0, 0.0, 1.0]
}

/// Coefficients in the order of the files; `k3` is left out where `short` and it is zero.
pub(super) fn coefficients(lens: Lens, short: bool) -> Vec<f64> {
    match lens {
        Lens::BrownConrady { k: [k1, k2, k3], p: [p1, p2] } if short && k3 == 0.0 => {
            vec![k1, k2, p1, p2]
        }
        Lens::BrownConrady { k: [k1, k2, k3], p: [p1, p2] } => vec![k1, k2, p1, p2, k3],
        Lens::Rational { k: [k1, k2, k3, k4, k5, k6], p: [p1, p2] } => {
            vec![k1, k2, p1, p2, k3, k4, k5, k6]
        }
        Lens::Fisheye { k } => k.to_vec(),
    }
}
