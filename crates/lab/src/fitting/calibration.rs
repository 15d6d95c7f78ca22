//! Held-out scores -> tables of probability and spread.
//!
//! The probability at a node is the share of right pixels around that score, scene by scene: the
//! mean of the scenes less one standard error between them, so that what is said of a new scene is
//! rather too little than too much; then made to rise from node to node (pool adjacent violators,
//! Ayer 1955).

use super::sample::Sample;
use linestereo::unstable::NODES;

/// Half the width of the score interval around a node: whose pixels make its probability, and their
/// errors its spread.
const REACH: f64 = 0.75;
/// Fewest pixels of a scene that count at a node.
const FEWEST_PIXELS: f64 = 3.0;
/// Fewest scenes at a node.
const FEWEST_SCENES: usize = 5;
/// Fewest pixels from which a spread is taken.
const SPREAD_PIXELS: usize = 300;
/// Share of errors within one standard deviation.
const ONE_SIGMA: f64 = 0.683;

/// A table is never level: the order of answers stays that of their scores.
pub(super) struct Rise {
    /// Least difference between a node and the one before.
    step: f64,
    /// Largest probability of the first node; that of each one behind is a step larger.
    most: f64,
}

/// Of a line's scores, which seldom reach the last nodes.
pub(super) const OF_LINES: Rise = Rise { step: 0.00003, most: 0.999 };
/// Of a network's, which often do.
pub(super) const OF_NETWORKS: Rise = Rise { step: 0.0001, most: 0.9965 };

/// The two tables of a model.
pub(super) struct Tables {
    pub(super) probability_q16: [u16; NODES],
    pub(super) sigma_q6: [u16; NODES],
}

/// The tables of these scores, those of each scene together.
pub(super) fn tables(scenes: &[Vec<(f64, &Sample)>], rise: &Rise) -> Tables {
    let held_out = scenes.concat();
    let mut tables = Tables { probability_q16: [0; NODES], sigma_q6: [0; NODES] };
    let found =
        rising((0..NODES).filter_map(|node| Some((node, share_right(scenes, node_score(node))?))));
    let mut floor = 0.0_f64;
    for (node, probability) in tables.probability_q16.iter_mut().enumerate() {
        // Below the first node that scenes have, evenly up to it.
        let (first, least) = found.first().copied().unwrap_or((NODES, 1.0));
        let before = least * (node + 1) as f64 / (first + 1) as f64;
        let here = found.iter().rfind(|(at, _)| *at <= node).map_or(before, |(_, share)| *share);
        floor = here.clamp(0.0, rise.most + rise.step * node as f64).max(floor + rise.step);
        *probability = (floor * 65536.0).round() as u16;
    }
    let mut ceiling = f64::INFINITY;
    for (node, sigma) in tables.sigma_q6.iter_mut().enumerate() {
        ceiling = spread(&held_out, node_score(node)).unwrap_or(ceiling).min(ceiling);
        let widest = 64.0 * 8.0;
        *sigma = (ceiling * 64.0).clamp(1.0, widest).round() as u16;
    }
    tables
}

/// Share of right pixels around a score and its weight: the mean over scenes less its standard
/// error. A scene counts by its pixels, up to twice the median.
fn share_right(scenes: &[Vec<(f64, &Sample)>], centre: f64) -> Option<[f64; 2]> {
    let of = |scene: &Vec<(f64, &Sample)>| {
        let (mut right, mut all) = (0.0, 0.0);
        for (score, sample) in scene {
            let weight = (1.0 - (score - centre).abs() / REACH).max(0.0);
            let (r, w) = sample.outcome();
            (right, all) = (right + weight * r, all + weight * (r + w));
        }
        (all > FEWEST_PIXELS).then(|| [right / all, all])
    };
    let mut shares: Vec<[f64; 2]> = scenes.iter().filter_map(of).collect();
    if shares.len() < FEWEST_SCENES.min(scenes.len()).max(1) {
        return None;
    }
    shares.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let most = 2.0 * shares[shares.len() / 2][1];
    shares.iter_mut().for_each(|share| share[1] = share[1].min(most));
    let all: f64 = shares.iter().map(|[_, pixels]| pixels).sum();
    let mean = shares.iter().map(|[share, pixels]| share * pixels).sum::<f64>() / all;
    let variance: f64 =
        shares.iter().map(|[share, pixels]| (pixels * (share - mean)).powi(2)).sum();
    Some([mean - variance.sqrt() / all, all])
}

/// The shares, each with the mean of its neighbours where they would fall.
fn rising(nodes: impl Iterator<Item = (usize, [f64; 2])>) -> Vec<(usize, f64)> {
    let mut pools: Vec<(Vec<usize>, [f64; 2])> = Vec::new();
    for (node, share) in nodes {
        let (mut at, mut pool) = (vec![node], share);
        while let Some((before, lower)) = pools.pop_if(|(_, [share, _])| *share >= pool[0]) {
            let all = lower[1] + pool[1];
            pool = [(lower[0] * lower[1] + pool[0] * pool[1]) / all, all];
            at = [before, at].concat();
        }
        pools.push((at, pool));
    }
    pools
        .into_iter()
        .flat_map(|(nodes, [share, _])| nodes.into_iter().map(move |node| (node, share)))
        .collect()
}

fn node_score(node: usize) -> f64 {
    node as f64 / 2.0 - 8.0
}

/// Error that 68.3 % of the pixels around a score stay below.
fn spread(held_out: &[(f64, &Sample)], centre: f64) -> Option<f64> {
    let near = held_out.iter().filter(|(score, _)| (score - centre).abs() <= REACH);
    let mut errors: Vec<f32> = near.flat_map(|(_, sample)| sample.errors.iter().copied()).collect();
    if errors.len() < SPREAD_PIXELS {
        return None;
    }
    errors.sort_by(f32::total_cmp);
    errors.get((errors.len() as f64 * ONE_SIGMA) as usize).map(|&error| f64::from(error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_that_fall_are_pooled() {
        let shares =
            [0.2, 0.5, 0.3, 0.9].into_iter().enumerate().map(|(node, share)| (node, [share, 1.0]));
        assert_eq!(rising(shares), [(0, 0.2), (1, 0.4), (2, 0.4), (3, 0.9)]);
        let weighed = [(3, [0.75, 2.0]), (5, [0.25, 2.0])];
        assert_eq!(rising(weighed.into_iter()), [(3, 0.5), (5, 0.5)]);
    }
}
