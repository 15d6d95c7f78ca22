//! Rotations and rigid motions between cameras, from the matrices of files to the quaternion of a
//! [`Calibration`] and back.
//!
//! A [`Pose`] takes a point of one frame to another: `X_to = R X_from + t`. What "from" and "to"
//! are differs by format and is said there.

use super::error::{Fault, Place, Problem};
use super::node::Matrix;
use linestereo_frames::Unfit;
use linestereo_rig::{Calibration, CalibrationError, Camera, rotation_matrix};
use nalgebra::{Matrix3, Vector3};

/// A matrix by rows.
pub(super) type Rows = [[f64; 3]; 3];

/// How far from perpendicular unit vectors the rows of a rotation may be: files carry 5 digits and
/// more.
const ROTATION_TOLERANCE: f64 = 1e-3;

#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub(super) rotation: Matrix3<f64>,
    pub(super) translation: Vector3<f64>,
}

impl Pose {
    /// Nothing moves.
    pub(super) const IDENTITY: Self = Self {
        rotation: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        translation: Vector3::new(0.0, 0.0, 0.0),
    };

    /// From left to right.
    pub(super) fn of(calibration: &Calibration) -> Self {
        let rotation = rotation_matrix(calibration.rotation());
        Self { rotation, translation: Vector3::from(calibration.translation()) }
    }

    /// From a 4x4 matrix that acts on `(X, 1)`.
    pub(super) fn from_matrix(matrix: &Matrix) -> Result<Self, Fault> {
        let [a, b, c, tx, d, e, f, ty, g, h, i, tz, last @ ..] = matrix.shaped::<16>(4, 4)?;
        if last != [0.0, 0.0, 0.0, 1.0] {
            let found = format!("a matrix with last row {last:?}");
            let expected = "a rigid motion (last row 0 0 0 1)".to_owned();
            return Err(
                Problem::Shape { name: matrix.name().to_owned(), expected, found }.at(matrix.place)
            );
        }
        let rotation = checked(Matrix3::new(a, b, c, d, e, f, g, h, i), matrix)?;
        Ok(Self { rotation, translation: Vector3::new(tx, ty, tz) })
    }

    pub(super) fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// This motion after another.
    pub(super) fn after(&self, first: &Self) -> Self {
        Self {
            rotation: self.rotation * first.rotation,
            translation: self.rotation * first.translation + self.translation,
        }
    }

    /// The pair of two cameras with this pose from the first to the second; `swap`: the second is
    /// the left one.
    pub(super) fn pair(
        &self,
        [first, second]: [Camera; 2],
        swap: bool,
        place: Option<Place>,
    ) -> Result<Calibration, Fault> {
        let (left, right, pose) =
            if swap { (second, first, self.inverse()) } else { (first, second, *self) };
        Calibration::new(left, right, quaternion(&pose.rotation), pose.translation.into()).map_err(
            |error| {
                let problem = match error {
                    CalibrationError::Swapped if swap => Problem::NotSwapped,
                    CalibrationError::Swapped => Problem::Swapped,
                    other => Problem::Pair(other),
                };
                Fault { place, problem }
            },
        )
    }
}

/// A 3x3 rotation, checked.
pub(super) fn rotation(matrix: &Matrix) -> Result<Matrix3<f64>, Fault> {
    checked(Matrix3::from_row_slice(&matrix.shaped::<9>(3, 3)?), matrix)
}

fn checked(rotation: Matrix3<f64>, matrix: &Matrix) -> Result<Matrix3<f64>, Fault> {
    let off = (rotation.transpose() * rotation - Matrix3::identity()).abs().max();
    // Not "off > tolerance": huge values make it infinite minus infinite.
    let good = off <= ROTATION_TOLERANCE && rotation.determinant() > 0.0;
    if good {
        Ok(rotation)
    } else {
        Err(Problem::NoRotation(matrix.name().to_owned()).at(matrix.place))
    }
}

/// Unit quaternion `[w, x, y, z]` of a rotation: the largest component from the diagonal, the
/// others from it (Shepperd, 1978).
pub(super) fn quaternion(m: &Matrix3<f64>) -> [f64; 4] {
    let squares = [
        1.0 + m[(0, 0)] + m[(1, 1)] + m[(2, 2)],
        1.0 + m[(0, 0)] - m[(1, 1)] - m[(2, 2)],
        1.0 - m[(0, 0)] + m[(1, 1)] - m[(2, 2)],
        1.0 - m[(0, 0)] - m[(1, 1)] + m[(2, 2)],
    ];
    let [wx, wy, wz] = [m[(2, 1)] - m[(1, 2)], m[(0, 2)] - m[(2, 0)], m[(1, 0)] - m[(0, 1)]];
    let [xy, xz, yz] = [m[(0, 1)] + m[(1, 0)], m[(0, 2)] + m[(2, 0)], m[(1, 2)] + m[(2, 1)]];
    let products = [
        [squares[0], wx, wy, wz],
        [wx, squares[1], xy, xz],
        [wy, xy, squares[2], yz],
        [wz, xz, yz, squares[3]],
    ];
    let largest = (0..4).max_by(|&a, &b| squares[a].total_cmp(&squares[b])).unwrap_or(0);
    let row = products[largest];
    let length = libm::sqrt(row.iter().map(|v| v * v).sum());
    row.map(|v| v / length)
}

pub(super) fn rows(matrix: &Matrix3<f64>) -> Rows {
    matrix.transpose().into()
}

/// The pose from left to right that rectifying rotations `R1`, `R2` and projections `P1`, `P2`
/// imply (3x3 and 3x4).
///
/// `R1` and `R2` turn both cameras into the same directions, so `R = R2^T R1`. In these the right
/// camera lies on the x axis: `P2[0][3] = focal * t_x`, with `t_x = -baseline` (OpenCV
/// `stereoRectify`; ROS `sensor_msgs/CameraInfo`), so `t = R2^T (t_x, 0, 0)`.
pub(super) fn from_rectification(
    rotations: [&Matrix3<f64>; 2],
    [left, right]: [&Matrix; 2],
) -> Result<Pose, Fault> {
    let (p1, p2) = (left.shaped::<12>(3, 4)?, right.shaped::<12>(3, 4)?);
    let wrong =
        |what: &str, matrix: &Matrix| Err(Problem::Projection(what.to_owned()).at(matrix.place));
    if p2[0] <= 0.0 || p1[0] <= 0.0 {
        return wrong(
            "the focal length of the projection is not above 0; calibrate as a stereo pair",
            right,
        );
    }
    if p1[3] != 0.0 {
        return wrong(
            "the projection of the first camera has a baseline: exchange the files",
            left,
        );
    }
    if p2[7].abs() > 1e-9 * p2[0] {
        return wrong("the projection puts the cameras above each other, not side by side", right);
    }
    if p2[3] == 0.0 {
        return wrong(
            "the projection of the right camera has no baseline; calibrate as a stereo pair",
            right,
        );
    }
    if (p1[0] - p2[0]).abs() > 0.01 * p2[0] {
        return wrong(&Unfit::FocalsDiffer(p1[0], p2[0]).to_string(), right);
    }
    let [r1, r2] = rotations;
    let along = Vector3::new(p2[3] / p2[0], 0.0, 0.0);
    Ok(Pose { rotation: r2.transpose() * r1, translation: r2.transpose() * along })
}
