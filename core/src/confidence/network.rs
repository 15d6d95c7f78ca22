//! Evidence -> probability, where single kinds of evidence mean little without the others.
//!
//! ```text
//! unit  = max(0, bias + sum of weight * evidence)
//! score = bias + sum of output * unit          (probability: a table, as of a linear model)
//! ```
//!
//! # Bounds
//! Evidence is limited to 16.0 and weights to 8.0: with 24 kinds of evidence and a bias below 2^27
//! a unit's sum is below 2^30.
//!
//! # Cost
//! [`UNITS`] times `N` multiply-adds.
//!
//! # Source
//! A perceptron with one hidden layer (Rumelhart 1986). The constants are written by
//! `linestereo-lab fit-confidence`.

use super::{NODES, interpolate, score_of};

/// Hidden units.
pub const UNITS: usize = 8;
/// Largest evidence of either sign, Q8.
pub(crate) const MOST_EVIDENCE_Q8: i32 = 16 << 8;

/// One hidden unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unit<const N: usize> {
    /// Its value without evidence, Q18.
    pub bias_q18: i32,
    /// Change of its value per unit of evidence, Q10.
    pub weights_q10: [i16; N],
    /// Log-odds per unit of its value, Q10.
    pub output_q10: i16,
}

/// The model of one kind of hypothesis over `N` kinds of evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Network<const N: usize> {
    /// Hidden units.
    pub units: [Unit<N>; UNITS],
    /// Log-odds where all units are 0, Q10.
    pub bias_q10: i32,
    /// Probability at each node, Q16.
    pub probability_q16: [u16; NODES],
}

impl<const N: usize> Network<N> {
    /// Log-odds of a hypothesis less those at the middle of the table, Q8.
    fn score_q8(&self, evidence: &[i16; N]) -> i32 {
        let mut sum = i64::from(self.bias_q10) << 8;
        for unit in &self.units {
            sum += i64::from(unit.output_q10) * i64::from(unit.value_q8(evidence));
        }
        i32::try_from(sum >> 10).unwrap_or(0)
    }

    /// Probability of a hypothesis, Q16.
    #[must_use]
    pub fn probability_q16(&self, evidence: &[i16; N]) -> u16 {
        interpolate(&self.probability_q16, self.score_q8(evidence))
    }

    /// Probability by the mean of the log-odds here and those of another model, which states this
    /// probability, Q16.
    pub(crate) fn probability_beside_q16(&self, evidence: &[i16; N], other_q16: u16) -> u16 {
        let other_q8 = score_of(&self.probability_q16, other_q16);
        interpolate(&self.probability_q16, (self.score_q8(evidence) + other_q8) >> 1)
    }
}

impl<const N: usize> Unit<N> {
    fn value_q8(&self, evidence: &[i16; N]) -> i32 {
        let mut sum = self.bias_q18;
        for (&weight, &evidence) in self.weights_q10.iter().zip(evidence) {
            sum += i32::from(weight) * i32::from(evidence);
        }
        sum.max(0) >> 10
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Unit<2> = Unit { bias_q18: 0, weights_q10: [0; 2], output_q10: 0 };

    #[test]
    fn units_below_zero_add_nothing() {
        let mut network =
            Network { units: [NONE; UNITS], bias_q10: 512, probability_q16: [0; NODES] };
        network.units[0] = Unit { bias_q18: 0, weights_q10: [1024, -1024], output_q10: 2048 };
        // 0.5, and twice what the first exceeds the second by.
        assert_eq!(network.score_q8(&[256, 0]), 128 + 512);
        assert_eq!(network.score_q8(&[0, 256]), 128);
    }

    #[test]
    fn the_mean_of_two_log_odds_has_a_probability_between_theirs() {
        let mut network = Network {
            units: [NONE; UNITS],
            bias_q10: 2 << 10,
            probability_q16: core::array::from_fn(|node| node as u16 * 1000 + 7),
        };
        let mut beside = |score: i32, other_q16| {
            network.bias_q10 = score << 10;
            network.probability_beside_q16(&[0; 2], other_q16)
        };
        // Nodes are half a unit apart, the middle one is the 17th.
        assert_eq!(beside(2, 20_007), 20_007);
        assert_eq!(beside(2, 16_007), 18_007);
        assert_eq!(beside(-1, 16_507), 15_257);
        // A probability that the table does not reach counts as its end.
        assert_eq!(beside(0, u16::MAX), 24_007);
        assert_eq!(beside(0, 0), 8007);
    }

    #[test]
    fn a_table_and_its_inverse_agree() {
        let table = &crate::support::FITTED_SUPPORT.context.probability_q16;
        for score_q8 in -8 << 8..8 << 8 {
            let value = interpolate(table, score_q8);
            assert_eq!(interpolate(table, score_of(table, value)), value, "{score_q8}");
        }
        // A level one has none.
        assert_eq!(score_of(&[9; NODES], 9), 15 << 7);
    }

    #[test]
    fn the_largest_evidence_stays_within_the_sums() {
        const KINDS: usize = 24;
        let unit =
            Unit { bias_q18: (1 << 27) - 1, weights_q10: [8 << 10; KINDS], output_q10: i16::MAX };
        let most = [MOST_EVIDENCE_Q8 as i16; KINDS];
        // 511 and 24 * 8 * 16.
        assert_eq!(unit.value_q8(&most), ((1 << 27) - 1 + KINDS as i32 * (1 << 25)) >> 10);
        let network = Network { units: [unit; UNITS], bias_q10: 0, probability_q16: [1; NODES] };
        assert!(network.score_q8(&most) > 0);
    }
}
