//! Penalised logistic regression by Newton's method.

use super::sample::Sample;
use nalgebra::{DMatrix, DVector};

const STEPS: usize = 25;
/// Newton stops when no coefficient moves more than this.
const SETTLED: f64 = 1e-7;

/// A fitted line over standardised evidence.
#[derive(Clone, Debug)]
pub(super) struct Line {
    standard: Standard,
    /// One per evidence, then the bias.
    weights: DVector<f64>,
}

impl Line {
    /// Fits the samples, with this penalty on standardised coefficients; `start` gives the
    /// standardisation and the first guess.
    pub(super) fn fit(samples: &[&Sample], penalty: f64, start: Option<&Line>) -> Self {
        let mut line = start.cloned().unwrap_or_else(|| {
            let standard = Standard::new(samples);
            let weights = DVector::zeros(standard.kinds() + 1);
            Self { standard, weights }
        });
        let mut rows = Rows::new(line.weights.len());
        for sample in samples {
            rows.push(line.inputs(sample), sample.outcome());
        }
        line.weights = newton(&rows, line.weights.clone(), penalty);
        line
    }

    /// Standardised evidence, and the constant.
    fn inputs(&self, sample: &Sample) -> impl Iterator<Item = f64> {
        self.standard.of(sample).chain([1.0])
    }

    /// Log-odds of a sample.
    pub(super) fn score(&self, sample: &Sample) -> f64 {
        self.inputs(sample).zip(self.weights.iter()).map(|(input, weight)| input * weight).sum()
    }

    /// Bias and coefficients of the raw evidence.
    pub(super) fn raw(&self) -> (f64, Vec<f64>) {
        self.standard.raw(self.weights.as_slice())
    }
}

/// Mean and spread of each kind of evidence.
#[derive(Clone, Debug)]
pub(super) struct Standard {
    mean: Vec<f64>,
    scale: Vec<f64>,
}

impl Standard {
    pub(super) fn new(samples: &[&Sample]) -> Self {
        let kinds = samples.first().map_or(0, |sample| sample.evidence.len());
        let (mut mean, mut scale) = (vec![0.0; kinds], vec![1.0; kinds]);
        let count = samples.len().max(1) as f64;
        for i in 0..kinds {
            mean[i] = samples.iter().map(|s| s.evidence[i]).sum::<f64>() / count;
            let variance =
                samples.iter().map(|s| (s.evidence[i] - mean[i]).powi(2)).sum::<f64>() / count;
            // Evidence that never varies says nothing; a unit scale leaves its coefficient at zero.
            scale[i] = if variance > 1e-12 { variance.sqrt() } else { 1.0 };
        }
        Self { mean, scale }
    }

    /// Kinds of evidence.
    pub(super) fn kinds(&self) -> usize {
        self.mean.len()
    }

    /// The evidence of a sample, standardised.
    pub(super) fn of(&self, sample: &Sample) -> impl Iterator<Item = f64> {
        let standard = sample.evidence.iter().zip(self.mean.iter().zip(&self.scale));
        standard.map(|(value, (mean, scale))| (value - mean) / scale)
    }

    /// Bias and weights for raw evidence, of weights for standardised one with the bias behind.
    pub(super) fn raw(&self, weights: &[f64]) -> (f64, Vec<f64>) {
        let raw: Vec<f64> =
            weights.iter().zip(&self.scale).map(|(weight, scale)| weight / scale).collect();
        let moved: f64 = raw.iter().zip(&self.mean).map(|(weight, mean)| weight * mean).sum();
        (weights[raw.len()] - moved, raw)
    }
}

/// Inputs of equal number, with how often each was right and wrong.
pub(super) struct Rows {
    width: usize,
    inputs: Vec<f64>,
    outcomes: Vec<(f64, f64)>,
}

impl Rows {
    pub(super) fn new(width: usize) -> Self {
        Self { width, inputs: Vec::new(), outcomes: Vec::new() }
    }

    pub(super) fn push(&mut self, inputs: impl IntoIterator<Item = f64>, outcome: (f64, f64)) {
        self.inputs.extend(inputs);
        self.outcomes.push(outcome);
    }
}

/// Maximises the penalised likelihood; the last input is the constant and is not penalised.
pub(super) fn newton(rows: &Rows, start: DVector<f64>, penalty: f64) -> DVector<f64> {
    let size = start.len();
    let mut weights = start;
    for _ in 0..STEPS {
        let mut gradient = DVector::zeros(size);
        let mut curvature = vec![0.0; size * size]; // lower triangle, row by row
        for (inputs, &(right, wrong)) in rows.inputs.chunks_exact(rows.width).zip(&rows.outcomes) {
            let p = logistic(
                inputs.iter().zip(weights.iter()).map(|(input, weight)| input * weight).sum(),
            );
            let (error, weight) = (right - (right + wrong) * p, (right + wrong) * p * (1.0 - p));
            for (i, (&input, row)) in
                inputs.iter().zip(curvature.chunks_exact_mut(size)).enumerate()
            {
                gradient[i] += error * input;
                let scaled = weight * input;
                row[..=i].iter_mut().zip(inputs).for_each(|(sum, other)| *sum += scaled * other);
            }
        }
        let mut curvature = DMatrix::from_row_slice(size, size, &curvature);
        for i in 0..size - 1 {
            gradient[i] -= penalty * weights[i];
            curvature[(i, i)] += penalty;
        }
        curvature[(size - 1, size - 1)] += 1e-9;
        // The Cholesky decomposition reads the lower triangle alone.
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
        let mut rows = Rows::new(2);
        rows.push([0.0, 1.0], (30.0, 10.0));
        rows.push([1.0, 1.0], (90.0, 10.0));
        let weights = newton(&rows, DVector::zeros(2), 0.0);
        assert!((weights[1] - 3_f64.ln()).abs() < 1e-6, "{weights}");
        assert!((weights[0] - 3_f64.ln()).abs() < 1e-6, "{weights}");
    }
}
