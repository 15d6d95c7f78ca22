//! Penalised logistic regression by Newton's method.

use super::sample::Sample;
use nalgebra::{DMatrix, DVector};

/// Penalty on standardised coefficients. Neighbouring pixels and distances of one side are no independent witnesses: a hundred of them
/// weigh about as much as one claim.
const PENALTY: f64 = 100.0;
const STEPS: usize = 25;
/// Newton stops when no coefficient moves more than this.
const SETTLED: f64 = 1e-7;

/// A fitted line over standardised evidence.
#[derive(Clone, Debug)]
pub(super) struct Line {
    mean: Vec<f64>,
    scale: Vec<f64>,
    /// One per evidence, then the bias.
    weights: DVector<f64>,
}

impl Line {
    /// Fits the samples; `start` gives the standardisation and the first guess.
    pub(super) fn fit(samples: &[&Sample], start: Option<&Line>) -> Self {
        let mut line = start.cloned().unwrap_or_else(|| Self::standardised(samples));
        let rows: Vec<(DVector<f64>, f64, f64)> = samples
            .iter()
            .map(|sample| {
                let (right, wrong) = sample.outcome();
                (line.standardise(&sample.evidence), right, wrong)
            })
            .collect();
        line.weights = newton(&rows, line.weights.clone(), PENALTY);
        line
    }

    fn standardised(samples: &[&Sample]) -> Self {
        let kinds = samples.first().map_or(0, |sample| sample.evidence.len());
        let (mut mean, mut scale) = (vec![0.0; kinds], vec![1.0; kinds]);
        let count = samples.len().max(1) as f64;
        for i in 0..kinds {
            mean[i] = samples.iter().map(|s| s.evidence[i]).sum::<f64>() / count;
            let variance = samples.iter().map(|s| (s.evidence[i] - mean[i]).powi(2)).sum::<f64>() / count;
            // Evidence that never varies says nothing; a unit scale leaves its coefficient at zero.
            scale[i] = if variance > 1e-12 { variance.sqrt() } else { 1.0 };
        }
        Self { mean, scale, weights: DVector::zeros(kinds + 1) }
    }

    fn standardise(&self, evidence: &[f64]) -> DVector<f64> {
        let standard = evidence.iter().zip(self.mean.iter().zip(&self.scale));
        let inputs = standard.map(|(value, (mean, scale))| (value - mean) / scale).chain([1.0]);
        DVector::from_vec(inputs.collect())
    }

    /// Log-odds of a sample.
    pub(super) fn score(&self, sample: &Sample) -> f64 {
        self.standardise(&sample.evidence).dot(&self.weights)
    }

    /// Bias and coefficients of the raw evidence.
    pub(super) fn raw(&self) -> (f64, Vec<f64>) {
        let coefficients: Vec<f64> =
            self.weights.iter().zip(&self.scale).map(|(weight, scale)| weight / scale).collect();
        let moved: f64 = coefficients.iter().zip(&self.mean).map(|(c, mean)| c * mean).sum();
        (self.weights[coefficients.len()] - moved, coefficients)
    }
}

/// Maximises the penalised likelihood of `(inputs, right, wrong)`; the last input is the constant and is not penalised.
pub(super) fn newton(rows: &[(DVector<f64>, f64, f64)], start: DVector<f64>, penalty: f64) -> DVector<f64> {
    let size = start.len();
    let mut weights = start;
    for _ in 0..STEPS {
        let mut gradient = DVector::zeros(size);
        let mut curvature = DMatrix::zeros(size, size);
        for (inputs, right, wrong) in rows {
            let p = logistic(inputs.dot(&weights));
            gradient.axpy(right - (right + wrong) * p, inputs, 1.0);
            curvature.syger((right + wrong) * p * (1.0 - p), inputs, inputs, 1.0);
        }
        for i in 0..size - 1 {
            gradient[i] -= penalty * weights[i];
            curvature[(i, i)] += penalty;
        }
        curvature[(size - 1, size - 1)] += 1e-9;
        // `syger` fills the lower triangle, which is what the Cholesky decomposition reads.
        let Some(decomposition) = curvature.cholesky() else { break };
        let step = decomposition.solve(&gradient);
        weights += &step;
        if step.amax() < SETTLED {
            break;
        }
    }
    weights
}

pub(super) fn logistic(score: f64) -> f64 {
    1.0 / (1.0 + (-score.clamp(-30.0, 30.0)).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newton_finds_the_log_odds_of_two_groups() {
        // 30 of 40 right without the input, 90 of 100 with it: log-odds ln 3 and ln 9.
        let rows = [(DVector::from_vec(vec![0.0, 1.0]), 30.0, 10.0), (DVector::from_vec(vec![1.0, 1.0]), 90.0, 10.0)];
        let weights = newton(&rows, DVector::zeros(2), 0.0);
        assert!((weights[1] - 3_f64.ln()).abs() < 1e-6, "{weights}");
        assert!((weights[0] - 3_f64.ln()).abs() < 1e-6, "{weights}");
    }
}
