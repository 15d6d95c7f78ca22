//! Evidence -> probability that a disparity is within 1 px of the truth, and for answers that carry
//! one its standard deviation.
//!
//! ```text
//! score       = bias + sum of coefficient * evidence                (log-odds, linear: one multiplication per entry)
//! probability = table(score),  sigma = table(score)                 (linear between nodes half a unit apart)
//! ```
//! The tables replace the logistic function: their nodes are fitted on scores of held-out scenes,
//! which calibrates scores that the logistic function would turn into too high probabilities.
//!
//! # Bounds
//! Coefficients Q12 below 2^19, evidence Q8 in 16 bits: 30 products below 2^34 each, summed in
//! `i64`.
//!
//! # Cost
//! 30 multiply-adds and one interpolation per hypothesis.
//!
//! # Source
//! Logistic regression; calibration on held-out scores (Platt 1999), with a piecewise linear curve
//! instead of a second sigmoid. The constants are written by `linestereo-lab fit-confidence`.

mod fitted;
mod network;

pub use fitted::FITTED;
pub(crate) use network::MOST_EVIDENCE_Q8;
pub use network::{Network, UNITS, Unit};

use crate::evidence::{NearbyEvidence, SEGMENT_EVIDENCE, SegmentKind};

/// Number of nodes of the tables, at scores -8, -7.5, ... 8.
pub const NODES: usize = 33;

/// The model of one kind of hypothesis, over `N` kinds of evidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Model<const N: usize = SEGMENT_EVIDENCE> {
    /// Log-odds without evidence, Q12.
    pub bias_q12: i32,
    /// Log-odds per unit of evidence, Q12.
    pub coefficients_q12: [i32; N],
    /// Probability at each node, Q16.
    pub probability_q16: [u16; NODES],
}

/// A model whose answers carry a standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SigmaModel<const N: usize = SEGMENT_EVIDENCE> {
    /// Log-odds and probability.
    pub model: Model<N>,
    /// Standard deviation at each node, 1/64 px.
    pub sigma_q6: [u16; NODES],
}

/// Models for near-vertical and near-horizontal segments: of the pixels beside a side, and of the
/// edge itself, which may belong to the surface on the other side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Models {
    /// A side of a near-vertical segment.
    pub near_vertical: Model,
    /// A side of a near-horizontal segment.
    pub near_horizontal: Model,
    /// The edge of a near-vertical segment, given one side's disparity.
    pub near_vertical_edge: SigmaModel,
    /// The edge of a near-horizontal segment, given one side's disparity.
    pub near_horizontal_edge: SigmaModel,
}

impl Models {
    /// The model of a side for one kind of segment.
    #[must_use]
    pub fn side(&self, near_horizontal: bool) -> &Model {
        if near_horizontal { &self.near_horizontal } else { &self.near_vertical }
    }

    /// The model of the edge for one kind of segment, with its standard deviation.
    #[must_use]
    pub fn edge(&self, near_horizontal: bool) -> &SigmaModel {
        if near_horizontal { &self.near_horizontal_edge } else { &self.near_vertical_edge }
    }
}

impl<const N: usize> SigmaModel<N> {
    /// Standard deviation of a score's disparity, 1/64 px.
    #[must_use]
    pub fn sigma_q6(&self, score_q8: i32) -> u16 {
        interpolate(&self.sigma_q6, score_q8)
    }
}

impl<const N: usize> Model<N> {
    /// Log-odds of a hypothesis, Q8, before calibration.
    #[must_use]
    pub fn score_q8(&self, evidence: &[i16; N]) -> i32 {
        let score = i64::from(self.bias_q12) * 256 + products(&self.coefficients_q12, evidence);
        i32::try_from(score >> 12).unwrap_or(0)
    }

    /// Probability of a score, Q16.
    #[must_use]
    pub fn probability_q16(&self, score_q8: i32) -> u16 {
        interpolate(&self.probability_q16, score_q8)
    }

    /// Log-odds by `M` entries from `first` on alone, given as evidence in Q8, Q8.
    pub(crate) fn part_q8<const M: usize>(&self, first: usize, evidence: &[i16; M]) -> i32 {
        let coefficients = self.coefficients_q12.get(first..).and_then(|part| part.first_chunk());
        let products = coefficients.map_or(0, |coefficients| products(coefficients, evidence));
        i32::try_from(products >> 12).unwrap_or(0)
    }
}

impl Model {
    /// Log-odds with the evidence by support points and segments nearby added, Q8.
    pub(crate) fn with_nearby_q8(&self, score_q8: i16, nearby: NearbyEvidence) -> i32 {
        i32::from(score_q8) + self.part_q8(NearbyEvidence::FIRST as usize, &nearby.values())
    }

    /// Log-odds per unit of one kind of evidence, Q8.
    #[must_use]
    pub fn coefficient_q8(&self, kind: SegmentKind) -> i32 {
        self.coefficients_q12.get(kind as usize).map_or(0, |&c| c >> 4)
    }
}

/// Sum of the products of two lists.
#[inline(always)] // the lengths are constants
fn products<const N: usize>(coefficients: &[i32; N], evidence: &[i16; N]) -> i64 {
    let mut sum = 0;
    let mut add =
        |coefficient: i32, evidence: i16| sum += i64::from(coefficient) * i64::from(evidence);
    let ((c, c_rest), (e, e_rest)) = (coefficients.as_chunks(), evidence.as_chunks());
    // Four at a time: the compiler does not unroll where code is to be small.
    for (&[c0, c1, c2, c3], &[e0, e1, e2, e3]) in c.iter().zip(e) {
        add(c0, e0);
        add(c1, e1);
        add(c2, e2);
        add(c3, e3);
    }
    for (&c, &e) in c_rest.iter().zip(e_rest) {
        add(c, e);
    }
    sum
}

/// The value of a table at a score, between its nodes.
fn interpolate(table: &[u16; NODES], score_q8: i32) -> u16 {
    let position = (score_q8.clamp(-8 << 8, (8 << 8) - 1) + (8 << 8)) as usize; // half a unit is 128
    let (node, part) = (position >> 7, (position & 127) as i32);
    let (Some(&a), Some(&b)) = (table.get(node), table.get(node + 1)) else { return 0 };
    let (a, b) = (i32::from(a), i32::from(b));
    u16::try_from(a + (((b - a) * part) >> 7)).unwrap_or(0)
}

/// The least score at which a table has this value, within its nodes: the inverse of
/// [`interpolate`].
fn score_of(table: &[u16; NODES], value: u16) -> i32 {
    let node = table.partition_point(|&at| at <= value).clamp(1, NODES - 1) - 1;
    let (Some(&a), Some(&b)) = (table.get(node), table.get(node + 1)) else { return 0 };
    let (a, b, value) = (i32::from(a), i32::from(b), i32::from(value));
    // `clamp` would panic in a table that falls.
    let rise = ((value.max(a).min(b) - a) << 7) + (b - a - 1);
    let part = rise.checked_div(b - a).unwrap_or(0);
    ((node as i32) << 7) + part - (8 << 8)
}
