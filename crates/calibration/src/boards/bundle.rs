//! Bundle adjustment: all cameras, the pose between them and all boards' poses at once.
//!
//! In: sightings and first guesses. Out: the numbers at the least sum of squared reprojection
//! errors, and their covariance.
//!
//! ```text
//! numbers   one or two cameras, the pose from left to right, then a pose for each board (in the
//!           left camera's coordinates)
//! errors    px, both cameras; and weak beliefs about the lens, each as one more error
//! each view: its 4n errors depend on at most 32 numbers: their derivatives, by central
//!     differences, are turned by a QR
//!            decomposition into at most 33 rows with the same sums of squares; the solver sees
//!                only those
//! covariance = sigma^2 (J'J)^-1,  sigma^2 = sum of squares / (errors - numbers)
//! ```
//!
//! # Cost
//! For 28 views of 54 corners about 10 ms per step.
//!
//! # Source
//! The solver is the crate `levenberg-marquardt`, MINPACK's method (Moré, 1978).

use super::model::{FY, Intrinsics, NUMBERS, Pose, Sighting};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, U1, VecStorage};

/// Numbers of a pose.
const POSE: usize = 6;
/// Numbers that all views share, at most.
const SHARED: usize = 2 * NUMBERS + POSE;
/// Relative change of sums of squares and of numbers that ends the search.
const CONVERGED: f64 = 1e-10;
/// Evaluations per number, at most.
const PATIENCE: usize = 3;

/// One board in one or two cameras.
#[derive(Clone, Debug)]
pub(super) struct BoardView {
    /// By each camera.
    pub(super) seen: [Vec<Sighting>; 2],
    /// In the left camera's coordinates (or the only one's).
    pub(super) pose: Pose,
}

/// A belief held before looking: this shared number is 0, give or take.
#[derive(Clone, Copy, Debug)]
pub(super) struct Belief {
    pub(super) number: usize,
    /// Error in px per unit of the number.
    pub(super) weight: f64,
}

/// Everything that is estimated together.
#[derive(Clone, Debug)]
pub(super) struct Bundle {
    pub(super) cameras: [Intrinsics; 2],
    /// From left to right coordinates.
    pub(super) rig: Pose,
    pub(super) views: Vec<BoardView>,
    /// Which of the shared numbers (left camera, right camera, rig) are estimated.
    pub(super) free: Vec<usize>,
    /// Pixels are square: `fy` follows `fx`.
    pub(super) square_pixels: bool,
    pub(super) beliefs: Vec<Belief>,
}

/// Estimates and their uncertainty.
#[derive(Clone, Debug)]
pub(super) struct Spread {
    /// Standard deviation of one coordinate of a corner, px.
    pub(super) sigma: f64,
    /// Covariance of the free shared numbers, in their order.
    pub(super) covariance: DMatrix<f64>,
}

/// First of a camera's shared numbers.
pub(super) fn camera_numbers(eye: usize) -> usize {
    eye * NUMBERS
}

/// First of the rig's shared numbers.
pub(super) const RIG: usize = 2 * NUMBERS;

impl Bundle {
    /// Moves all numbers to the least sum of squares nearby. False when the solver gives up.
    pub(super) fn solve(&mut self) -> bool {
        let start = Problem::new(self.clone());
        let method = LevenbergMarquardt::new()
            .with_ftol(CONVERGED)
            .with_xtol(CONVERGED)
            .with_gtol(1e-12)
            .with_patience(PATIENCE);
        let (end, report) = method.minimize(start);
        *self = end.bundle;
        report.termination.was_successful() || report.objective_function.is_finite()
    }

    /// Errors of one view, px, left camera first: x and y of each corner.
    pub(super) fn errors(&self, view: &BoardView) -> Vec<f64> {
        let mut errors = Vec::with_capacity(2 * (view.seen[0].len() + view.seen[1].len()));
        let in_right = if view.seen[1].is_empty() { view.pose } else { view.pose.then(&self.rig) };
        for ((camera, seen), pose) in self.cameras.iter().zip(&view.seen).zip([view.pose, in_right])
        {
            errors.extend(camera.errors(pose, seen).flatten());
        }
        errors
    }

    /// Uncertainty of the shared numbers; `None` when the data do not fix them.
    pub(super) fn spread(&self) -> Option<Spread> {
        let rows = self.linearised();
        let errors: usize =
            self.views.iter().map(|view| 2 * (view.seen[0].len() + view.seen[1].len())).sum();
        let numbers = self.free.len() + POSE * self.views.len();
        let squares: f64 =
            self.views.iter().flat_map(|view| self.errors(view)).map(|e| e * e).sum();
        let sigma = (squares / errors.checked_sub(numbers).filter(|&rest| rest > 0)? as f64).sqrt();
        let information = rows.jacobian.tr_mul(&rows.jacobian);
        let scale =
            DVector::from_iterator(numbers, information.diagonal().iter().map(|d| 1.0 / d.sqrt()));
        if scale.iter().any(|s| !s.is_finite()) {
            return None;
        }
        let scaled =
            DMatrix::from_fn(numbers, numbers, |i, j| information[(i, j)] * scale[i] * scale[j]);
        let inverse = scaled.cholesky()?.inverse();
        let shared = self.free.len();
        let covariance = DMatrix::from_fn(shared, shared, |i, j| {
            inverse[(i, j)] * scale[i] * scale[j] * sigma * sigma
        });
        Some(Spread { sigma, covariance })
    }

    fn shared(&self) -> [f64; SHARED] {
        let mut numbers = [0.0; SHARED];
        numbers[..NUMBERS].copy_from_slice(&self.cameras[0].numbers);
        numbers[NUMBERS..RIG].copy_from_slice(&self.cameras[1].numbers);
        numbers[RIG..].copy_from_slice(&self.rig.0);
        numbers
    }

    fn set_shared(&mut self, index: usize, value: f64) {
        match index {
            RIG.. => self.rig.0[index - RIG] = value,
            _ => {
                let (eye, number) = (index / NUMBERS, index % NUMBERS);
                self.cameras[eye].numbers[number] = value;
                if self.square_pixels && number + 1 == FY {
                    self.cameras[eye].numbers[FY] = value;
                }
            }
        }
    }

    fn numbers(&self) -> Vec<f64> {
        let shared = self.shared();
        let free = self.free.iter().map(|&index| shared[index]);
        free.chain(self.views.iter().flat_map(|view| view.pose.0)).collect()
    }

    /// Changes one of [`Bundle::numbers`].
    fn set_number(&mut self, position: usize, value: f64) {
        match position.checked_sub(self.free.len()) {
            None => self.set_shared(self.free[position], value),
            Some(rest) => self.views[rest / POSE].pose.0[rest % POSE] = value,
        }
    }

    fn linearised(&self) -> Rows {
        let shared = self.free.len();
        let columns = shared + POSE * self.views.len();
        let blocks: Vec<Rows> = self.views.iter().map(|view| self.block(view)).collect();
        let height =
            blocks.iter().map(|block| block.error.len()).sum::<usize>() + self.beliefs.len();
        let (mut jacobian, mut error) = (DMatrix::zeros(height, columns), DVector::zeros(height));
        let mut row = 0;
        for (index, block) in blocks.iter().enumerate() {
            let rows = block.error.len();
            jacobian
                .view_mut((row, 0), (rows, shared))
                .copy_from(&block.jacobian.columns(0, shared));
            let own = shared + POSE * index;
            jacobian
                .view_mut((row, own), (rows, POSE))
                .copy_from(&block.jacobian.columns(shared, POSE));
            error.rows_mut(row, rows).copy_from(&block.error);
            row += rows;
        }
        let numbers = self.shared();
        for belief in &self.beliefs {
            if let Some(column) = self.free.iter().position(|&index| index == belief.number) {
                jacobian[(row, column)] = belief.weight;
            }
            error[row] = belief.weight * numbers[belief.number];
            row += 1;
        }
        Rows { jacobian, error }
    }

    /// One view's derivatives and errors, turned into as few rows as there are columns.
    fn block(&self, view: &BoardView) -> Rows {
        let error = self.errors(view);
        let columns = self.free.len() + POSE;
        let mut whole = DMatrix::zeros(error.len(), columns + 1);
        let (views, free) = (vec![view.clone()], self.free.clone());
        let mut moved = Self { views, free, beliefs: Vec::new(), ..*self };
        for (column, number) in moved.numbers().into_iter().enumerate() {
            let step = step(number);
            let mut errors_at = |number: f64| {
                moved.set_number(column, number);
                moved.errors(&moved.views[0])
            };
            let (above, below) = (errors_at(number + step), errors_at(number - step));
            moved.set_number(column, number);
            for (row, (above, below)) in above.iter().zip(below).enumerate() {
                whole[(row, column)] = (above - below) / (2.0 * step);
            }
        }
        whole.column_mut(columns).copy_from_slice(&error);
        let turned = if whole.nrows() > whole.ncols() { whole.qr().r() } else { whole };
        let jacobian = turned.columns(0, columns).into_owned();
        Rows { jacobian, error: turned.column(columns).into_owned() }
    }
}

/// Step of a central difference: its own error and that of rounding are both far below what
/// matters.
fn step(value: f64) -> f64 {
    1e-6 * value.abs().max(1.0)
}

/// Errors, and their derivatives by the numbers that are estimated.
struct Rows {
    jacobian: DMatrix<f64>,
    error: DVector<f64>,
}

/// The bundle as the solver sees it.
struct Problem {
    bundle: Bundle,
    rows: Rows,
}

impl Problem {
    fn new(bundle: Bundle) -> Self {
        let rows = bundle.linearised();
        Self { bundle, rows }
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem {
    type ResidualStorage = VecStorage<f64, Dyn, U1>;
    type JacobianStorage = VecStorage<f64, Dyn, Dyn>;
    type ParameterStorage = VecStorage<f64, Dyn, U1>;

    fn set_params(&mut self, numbers: &DVector<f64>) {
        for (position, &number) in numbers.iter().enumerate() {
            self.bundle.set_number(position, number);
        }
        self.rows = self.bundle.linearised();
    }

    fn params(&self) -> DVector<f64> {
        DVector::from_vec(self.bundle.numbers())
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.rows.error.iter().all(|e| e.is_finite()).then(|| self.rows.error.clone())
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        Some(self.rows.jacobian.clone())
    }
}
