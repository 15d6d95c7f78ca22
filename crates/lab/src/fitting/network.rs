//! A network of one hidden layer, by stochastic gradient descent with moments (Adam, Kingma and Ba
//! 2015).

use super::logistic::{Standard, logistic};
use super::sample::Sample;
use linestereo::unstable::{NODES, Network, UNITS, Unit};
use linestereo_frames::SplitMix64;
use rayon::prelude::*;

/// First weights that are tried, and passes over the samples with each: some end in a worse
/// minimum.
const STARTS: u64 = 8;
const EPOCHS_OF_A_START: usize = 4;
/// Passes over all samples from the best of them.
const EPOCHS: usize = 16;
/// Samples of a step.
const BATCH: usize = 512;
/// Length of the first step; it falls to 0 evenly.
const FIRST_STEP: f64 = 0.006;
/// Decay of the means of gradients and of their squares.
const MOMENTS: [f64; 2] = [0.9, 0.999];
/// Log-odds at the middle of the table: the most probable have more than 10, and below -4 the
/// probability hardly changes.
const CENTRE: f64 = 4.0;
/// Largest weight: evidence up to 16.0 and 20 kinds of it stay within the core's sums.
const MOST_WEIGHT: f64 = 8.0;

/// A fitted network over standardised evidence.
#[derive(Clone, Debug)]
pub(super) struct Layers {
    standard: Standard,
    /// Of each unit its weights, its bias and its output; then the bias of the sum.
    values: Vec<f64>,
}

/// The start from which descent ends lowest.
pub(super) fn best_start(samples: &[&Sample]) -> u64 {
    let losses: Vec<f64> = (0..STARTS)
        .into_par_iter()
        .map(|start| Layers::descend(samples, start, EPOCHS_OF_A_START).loss(samples))
        .collect();
    let best = (0..STARTS).zip(losses).min_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or(0, |(start, _)| start)
}

impl Layers {
    pub(super) fn fit(samples: &[&Sample], start: u64) -> Self {
        Self::descend(samples, start, EPOCHS)
    }

    fn descend(samples: &[&Sample], start: u64, epochs: usize) -> Self {
        let standard = Standard::new(samples);
        let kinds = standard.kinds();
        let mut random = SplitMix64(start);
        let bound = (6.0 / (kinds + 1) as f64).sqrt();
        let size = UNITS * (kinds + 2) + 1;
        let values = (0..size).map(|_| (2.0 * random.uniform() - 1.0) * bound).collect();
        let inputs: Vec<f64> = samples.iter().flat_map(|sample| standard.of(sample)).collect();
        let mut layers = Self { standard, values };
        let mut order: Vec<usize> = (0..samples.len()).collect();
        let steps = epochs * samples.len().div_ceil(BATCH);
        let mut moments = vec![[0.0; 2]; size];
        let mut done = 0;
        for _ in 0..epochs {
            for i in (1..order.len()).rev() {
                order.swap(i, (random.bits() % (i as u64 + 1)) as usize);
            }
            for batch in order.chunks(BATCH) {
                let mut gradient = vec![0.0; size];
                for &i in batch {
                    let inputs = &inputs[i * kinds..][..kinds];
                    layers.add_gradient(inputs, samples[i].outcome(), &mut gradient);
                }
                done += 1;
                let step = FIRST_STEP * (1.0 - done as f64 / (steps + 1) as f64);
                let unbiased = MOMENTS.map(|decay| 1.0 - decay.powi(done));
                for ((value, moments), sum) in
                    layers.values.iter_mut().zip(&mut moments).zip(gradient)
                {
                    let gradient = sum / batch.len() as f64;
                    let [first, second] = [0, 1].map(|k| {
                        let new = [gradient, gradient * gradient][k];
                        moments[k] = MOMENTS[k] * moments[k] + (1.0 - MOMENTS[k]) * new;
                        moments[k] / unbiased[k]
                    });
                    *value -= step * first / (second.sqrt() + 1e-8);
                }
            }
        }
        layers
    }

    fn units(&self) -> impl Iterator<Item = &[f64]> {
        self.values.chunks_exact(self.standard.kinds() + 2)
    }

    /// Adds the gradient of the negative log-likelihood of a sample.
    fn add_gradient(&self, inputs: &[f64], (right, wrong): (f64, f64), gradient: &mut [f64]) {
        let kinds = inputs.len();
        let error = (right + wrong) * logistic(self.log_odds(inputs)) - right;
        *gradient.last_mut().expect("the bias of the sum") += error;
        for (unit, gradient) in self.units().zip(gradient.chunks_exact_mut(kinds + 2)) {
            let value = value_of(unit, inputs);
            if value > 0.0 {
                let back = error * unit[kinds + 1];
                gradient[kinds] += back;
                gradient[kinds + 1] += error * value;
                gradient.iter_mut().zip(inputs).for_each(|(sum, input)| *sum += back * input);
            }
        }
    }

    fn log_odds(&self, inputs: &[f64]) -> f64 {
        let bias = self.values.last().expect("the bias of the sum");
        let output = |unit: &[f64]| unit[inputs.len() + 1] * value_of(unit, inputs).max(0.0);
        bias + self.units().map(output).sum::<f64>()
    }

    /// Mean negative log-likelihood.
    fn loss(&self, samples: &[&Sample]) -> f64 {
        let of = |sample: &&Sample| {
            let p = logistic(self.score(sample) + CENTRE);
            let (right, wrong) = sample.outcome();
            -right * p.ln() - wrong * (1.0 - p).ln()
        };
        samples.iter().map(of).sum::<f64>() / samples.len() as f64
    }

    /// Log-odds of a sample, less those at the middle of the table.
    pub(super) fn score(&self, sample: &Sample) -> f64 {
        self.log_odds(&self.standard.of(sample).collect::<Vec<_>>()) - CENTRE
    }

    /// The network in the core's integers, with this table.
    pub(super) fn raw<const N: usize>(&self, probability_q16: [u16; NODES]) -> Network<N> {
        let mut units = [Unit { bias_q18: 0, weights_q10: [0; N], output_q10: 0 }; UNITS];
        for (to, unit) in units.iter_mut().zip(self.units()) {
            let (bias, weights) = self.standard.raw(unit);
            // The output gains the factor that the weights lose.
            let largest = weights.iter().fold(MOST_WEIGHT, |most, weight| most.max(weight.abs()));
            let factor = MOST_WEIGHT / largest;
            to.bias_q18 = q(bias * factor, 18);
            to.output_q10 = q(unit[N + 1] / factor, 10) as i16;
            for (to, weight) in to.weights_q10.iter_mut().zip(weights) {
                *to = q(weight * factor, 10) as i16;
            }
        }
        let bias = self.values.last().expect("the bias of the sum") - CENTRE;
        Network { units, bias_q10: q(bias, 10), probability_q16 }
    }
}

fn value_of(unit: &[f64], inputs: &[f64]) -> f64 {
    unit[inputs.len()] + unit.iter().zip(inputs).map(|(weight, input)| weight * input).sum::<f64>()
}

/// With so many bits behind the point, within what the core's sums are proved for.
fn q(value: f64, bits: u32) -> i32 {
    let most = if bits > 10 { f64::from(1 << 27) } else { f64::from(i16::MAX) };
    (value * f64::from(1 << bits)).round().clamp(-most, most) as i32
}
