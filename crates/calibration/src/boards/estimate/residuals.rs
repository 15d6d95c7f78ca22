//! How far predicted corners are from those seen.

use super::super::bundle::Bundle;
use linestereo_frames::statistics::upper_median;

/// A view whose error is above this many times the median of all views is dropped.
pub(super) const BAD_VIEW: f64 = 3.0;
/// Rounds of dropping and estimating again.
pub(super) const ROUNDS: usize = 6;

/// Root mean square distance of each view's corners, px.
pub(super) fn view_errors(bundle: &Bundle) -> Vec<f64> {
    bundle.views.iter().map(|view| root_mean_square(&bundle.errors(view))).collect()
}

/// Of distances, from their coordinates one after the other.
pub(super) fn root_mean_square(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / (errors.len() / 2).max(1) as f64).sqrt()
}

pub(super) fn median(values: &[f64]) -> f64 {
    upper_median(values.to_vec(), f64::total_cmp).unwrap_or(f64::INFINITY)
}
