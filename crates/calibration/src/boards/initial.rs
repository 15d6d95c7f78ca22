//! First guesses: the focal length, and where a board stands.
//!
//! In: corners of boards in one camera. Out: a camera without distortion and a pose for each board,
//! good enough to refine.
//!
//! ```text
//! for focal lengths from a quarter to four times the image's width, centre in the middle:
//!     each view: corners -> normalised plane -> homography from the board -> pose
//!     sum of squared reprojection errors, large ones counted as 20 px
//! the least sum wins
//! ```
//!
//! # Source
//! The homography as pose: Zhang, 2000, section 3.1. His closed form for the focal length takes
//! roots of numbers that a strongly distorted image makes negative, and knows no fisheye; a search
//! over one number has neither trouble.

use super::model::{Intrinsics, Pose, Sighting};
use crate::interchange::LensModel;
use linestereo::Dims;
use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, SymmetricEigen, Vector3};

/// Focal lengths tried, in widths of the image, and how many.
const FOCALS: (f64, f64) = (0.25, 4.0);
const TRIED: u32 = 33;
/// A homography has eight numbers; a few more points than that needs.
pub(super) const LEAST_POINTS: usize = 8;
/// Errors above this say only "wrong", px.
const FAR_OFF: f64 = 20.0;

/// Corners of one board in one image.
pub(super) type Sightings = Vec<Sighting>;

/// Focal lengths in px, the most promising first.
pub(super) fn focals(model: LensModel, dims: Dims, views: &[Sightings]) -> Vec<f64> {
    let step = |i: u32| FOCALS.0 * (FOCALS.1 / FOCALS.0).powf(f64::from(i) / f64::from(TRIED - 1));
    let score = |focal: f64| {
        let camera = Intrinsics::plain(model, dims, focal);
        views
            .iter()
            .map(|view| {
                pose(&camera, dims, view)
                    .map_or(FAR_OFF * FAR_OFF, |pose| error(&camera, &pose, view))
            })
            .sum()
    };
    let mut tried: Vec<(f64, f64)> = (0..TRIED)
        .map(|i| step(i) * f64::from(dims.width))
        .map(|focal| (score(focal), focal))
        .collect();
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    tried.into_iter().map(|(_, focal)| focal).collect()
}

/// Mean of squared distances, each of them limited.
fn error(camera: &Intrinsics, pose: &Pose, view: &Sightings) -> f64 {
    let squared = |[x, y]: [f64; 2]| (x.powi(2) + y.powi(2)).min(FAR_OFF * FAR_OFF);
    camera.errors(*pose, view).map(squared).sum::<f64>() / view.len().max(1) as f64
}

/// Where the board stands, in the camera's coordinates.
pub(super) fn pose(camera: &Intrinsics, dims: Dims, view: &Sightings) -> Option<Pose> {
    let lens = camera.camera(dims).ok()?;
    let pairs: Vec<_> =
        view.iter().filter_map(|&(place, at)| Some((place, lens.unproject(at)?))).collect();
    if pairs.len() < LEAST_POINTS {
        return None;
    }
    let h = homography(&pairs)?;
    let [a, b, c] = [0, 1, 2].map(|i| h.column(i).into_owned());
    let scale = 2.0 / (a.norm() + b.norm());
    let scale = if c.z < 0.0 { -scale } else { scale };
    let (a, b, shift) = (a * scale, b * scale, c * scale);
    let svd = Matrix3::from_columns(&[a, b, a.cross(&b)]).svd(true, true);
    let turn = svd.u? * svd.v_t?;
    (turn.determinant() > 0.0 && shift.z > 0.0)
        .then(|| Pose::new(Rotation3::from_matrix_unchecked(turn), shift))
}

/// A board parallel to the image, as far away as its size says.
pub(super) fn facing(camera: &Intrinsics, view: &Sightings) -> Pose {
    let [fx, fy, cx, cy, ..] = camera.numbers;
    let mean = |pick: &dyn Fn(&Sighting) -> f64| {
        view.iter().map(pick).sum::<f64>() / view.len().max(1) as f64
    };
    let [x, y] = [0, 1].map(|axis| mean(&|pair| pair.0[axis]));
    let [u, v] = [0, 1].map(|axis| mean(&|pair| pair.1[axis]));
    let on_board = mean(&|pair| (pair.0[0] - x).hypot(pair.0[1] - y));
    let in_image = mean(&|pair| (pair.1[0] - u).hypot(pair.1[1] - v)).max(1.0);
    let z = fx * on_board / in_image;
    Pose::new(Rotation3::identity(), Vector3::new((u - cx) * z / fx - x, (v - cy) * z / fy - y, z))
}

/// The plane-to-plane map, by the least eigenvector of normalised equations.
pub(super) fn homography(pairs: &[Sighting]) -> Option<Matrix3<f64>> {
    let from = normaliser(pairs.iter().map(|pair| pair.0))?;
    let to = normaliser(pairs.iter().map(|pair| pair.1))?;
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    for (place, at) in pairs {
        let p = from * Vector3::new(place[0], place[1], 1.0);
        let q = to * Vector3::new(at[0], at[1], 1.0);
        let rows = [
            [p.x, p.y, 1.0, 0.0, 0.0, 0.0, -q.x * p.x, -q.x * p.y, -q.x],
            [0.0, 0.0, 0.0, p.x, p.y, 1.0, -q.y * p.x, -q.y * p.y, -q.y],
        ];
        for row in rows.map(SVector::<f64, 9>::from) {
            normal += row * row.transpose();
        }
    }
    let eigen = SymmetricEigen::new(normal);
    let h = eigen.eigenvectors.column(eigen.eigenvalues.imin());
    let h = Matrix3::from_row_slice(h.into_owned().as_slice());
    Some(to.try_inverse()? * h * from)
}

/// Moves points to their middle and to a mean distance of about 1.
fn normaliser(points: impl Iterator<Item = [f64; 2]> + Clone) -> Option<Matrix3<f64>> {
    let count = points.clone().count() as f64;
    let mean = |axis: usize| points.clone().map(|point| point[axis]).sum::<f64>() / count;
    let [x, y] = [mean(0), mean(1)];
    let spread = points.map(|point| (point[0] - x).hypot(point[1] - y)).sum::<f64>() / count;
    let scale = 1.0 / spread;
    scale
        .is_finite()
        .then(|| Matrix3::new(scale, 0.0, -x * scale, 0.0, scale, -y * scale, 0.0, 0.0, 1.0))
}
