//! Held-out scores -> tables of probability and spread.
//!
//! Log-odds are a continuous line of the score with a bend at each of [`BENDS`]; the core interpolates it between nodes.

use super::logistic::{Rows, logistic, newton};
use super::sample::Sample;
use linestereo::diagnostics::NODES;
use nalgebra::DVector;

/// Scores at which the slope may change.
const BENDS: [f64; 4] = [1.5, 2.5, 3.5, 4.5];
/// Half the width of the score interval whose errors make a node's spread.
const SPREAD_REACH: f64 = 0.75;
/// Fewest pixels from which a spread is taken.
const SPREAD_PIXELS: usize = 300;
/// Share of errors within one standard deviation.
const ONE_SIGMA: f64 = 0.683;

/// The two tables of a model.
pub(super) struct Tables {
    pub(super) probability_q16: [u16; NODES],
    pub(super) sigma_q6: [u16; NODES],
}

pub(super) fn tables(held_out: &[(f64, &Sample)]) -> Tables {
    let mut rows = Rows::new(BENDS.len() + 2);
    for (score, sample) in held_out {
        rows.push(bent(*score), sample.outcome());
    }
    let weights = newton(&rows, DVector::zeros(BENDS.len() + 2), 1.0);
    let mut tables = Tables { probability_q16: [0; NODES], sigma_q6: [0; NODES] };
    let mut floor = 0.0_f64;
    for (node, probability) in tables.probability_q16.iter_mut().enumerate() {
        // Never certain, and never level: the order of the most credible answers stays that of their scores.
        let cap = 0.999 + 0.00003 * node as f64;
        floor = logistic(bent(node_score(node)).zip(weights.iter()).map(|(input, weight)| input * weight).sum())
            .min(cap)
            .max(floor + 0.00003);
        *probability = (floor * 65536.0).round() as u16;
    }
    let mut ceiling = f64::INFINITY;
    for (node, sigma) in tables.sigma_q6.iter_mut().enumerate() {
        ceiling = spread(held_out, node_score(node)).unwrap_or(ceiling).min(ceiling);
        let widest = 64.0 * 8.0;
        *sigma = (ceiling * 64.0).clamp(1.0, widest).round() as u16;
    }
    tables
}

fn node_score(node: usize) -> f64 {
    node as f64 / 2.0 - 8.0
}

fn bent(score: f64) -> impl Iterator<Item = f64> {
    [score].into_iter().chain(BENDS.map(|bend| (score - bend).max(0.0))).chain([1.0])
}

/// Error that 68.3 % of the pixels around a score stay below.
fn spread(held_out: &[(f64, &Sample)], centre: f64) -> Option<f64> {
    let near = held_out.iter().filter(|(score, _)| (score - centre).abs() <= SPREAD_REACH);
    let mut errors: Vec<f32> = near.flat_map(|(_, sample)| sample.errors.iter().copied()).collect();
    if errors.len() < SPREAD_PIXELS {
        return None;
    }
    errors.sort_by(f32::total_cmp);
    errors.get((errors.len() as f64 * ONE_SIGMA) as usize).map(|&error| f64::from(error))
}
