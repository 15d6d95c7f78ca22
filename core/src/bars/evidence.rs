//! The evidence for a bar's disparity: plain numbers in Q8 that a linear model weighs.
//!
//! In: costs, edges of both images. Out: one signed 16-bit number per kind.
//!
//! # Cost
//! Both edges: eight rows of 12 gradients; some 1500 instructions a bar.

use super::Bar;
use super::cost::{Found, rows};
use crate::confidence::Model;
use crate::evidence::{define_evidence, log2_mean_q8};
use crate::kernel::FLAT;
use crate::matching::band::Band;
use crate::row_memory::PAD;
use crate::units::{Confidence, quotient};

define_evidence! {
    /// Kinds of evidence of a bar, in the order of the model's coefficients.
    BarKind;
    /// One number per [`BarKind`], Q8.
    BarEvidence;
    BAR_EVIDENCE;
    Uniqueness: "log2 of the lowest cost elsewhere / the cost",
    Second: "the lowest cost elsewhere / the bar's own gradients",
    Cost: "the cost / the bar's own gradients",
    LeftEdge: "share of rows with the left edge in the right image",
    RightEdge: "share of rows with the right edge in the right image",
    LesserEdge: "the lesser of both",
    Alike: "the cost of the most similar place of the left image / the bar's own gradients",
    Width: "log2(1 + width)",
    Rows: "log2(1 + rows)",
    Contrast: "log2(1 + gradient of the weaker edge)",
    Coherence: "sum of the second edge's gradients / sum of their magnitudes",
    Slant: "|difference of the halves' disparities|, px",
    SameSign: "1 if both edges have the same sign",
    Range: "log2(1 + disparities compared)",
    SupportAgrees: "share of the support points around it that agree",
    SupportBehind: "share of those that are farther",
    SupportNearer: "share of those that are nearer",
    NoSupport: "1 if there is none",
}

/// Largest [`BarKind::Second`], Q8: 1.2.
const MOST_SECOND_Q8: i32 = 307;
/// Largest [`BarKind::Alike`], Q8.
pub(super) const MOST_ALIKE_Q8: i32 = 307;
/// Largest [`BarKind::Cost`], Q8.
const MOST_COST_Q8: i32 = 512;
/// Largest [`BarKind::Uniqueness`], log2 in Q8.
const MOST_UNIQUE_Q8: i32 = 1024;
/// Largest [`BarKind::Slant`], 1/64 px.
const MOST_SLANT_Q6: i32 = 512;

/// A part of a whole in Q8, at most `most`.
pub(super) fn part_q8(part: u32, whole: u32, most: i32) -> i32 {
    let part = (part << 8).checked_div(whole).unwrap_or(0);
    i32::try_from(part).unwrap_or(most).min(most)
}

/// Evidence by the costs, and by what was found in the left image.
pub(super) fn of_cost(bar: &Bar, found: &Found, evidence: &mut BarEvidence) {
    let floor = found.energy / 20;
    let log = |cost: u32| log2_mean_q8(cost + floor, 1);
    let unique = (log(found.second) - log(found.best)).clamp(0, MOST_UNIQUE_Q8);
    let [upper, lower] = found.halves_q6;
    let [own, other] = bar.strengths_q3;
    let [left, right] = bar.signs();
    evidence.set(BarKind::Uniqueness, unique);
    evidence.set(BarKind::Second, part_q8(found.second, found.energy, MOST_SECOND_Q8));
    evidence.set(BarKind::Cost, part_q8(found.best, found.energy, MOST_COST_Q8));
    evidence.set(BarKind::Width, log2_mean_q8(bar.width_q5.into(), 32));
    evidence.set(BarKind::Rows, log2_mean_q8(bar.height().unsigned_abs(), 1));
    evidence.set(BarKind::Contrast, log2_mean_q8(own.min(other).into(), 8));
    evidence.set(BarKind::Coherence, bar.coherence_q8.into());
    evidence.set(BarKind::Slant, (upper - lower).abs().min(MOST_SLANT_Q6) << 2);
    evidence.set(BarKind::SameSign, i32::from(left == right) << 8);
    evidence.set(BarKind::Range, log2_mean_q8(found.range.unsigned_abs(), 1));
}

/// Evidence by both edges in the right image.
pub(super) fn of_edges(bar: &Bar, band: &Band<'_>, evidence: &mut BarEvidence) {
    let [left_sign, right_sign] = bar.signs();
    let left = share_q8(bar, band, 0, left_sign);
    let right = share_q8(bar, band, bar.width_q5.into(), right_sign);
    evidence.set(BarKind::LeftEdge, left);
    evidence.set(BarKind::RightEdge, right);
    evidence.set(BarKind::LesserEdge, left.min(right));
}

/// Least [`BarKind::LesserEdge`] and largest [`BarKind::Cost`] for a bar to be credible, Q8.
const PROMISING_Q8: (i32, i32) = (102, 180);

/// True when what is known so far does not rule a bar out: with nothing alike in the left image,
/// and the support points that speak most for it, one of these models believes it.
pub(super) fn is_promising(
    evidence: &BarEvidence,
    models: [&Model<BAR_EVIDENCE>; 2],
    least: Confidence,
) -> bool {
    let (edge, cost) = PROMISING_Q8;
    if evidence.get(BarKind::LesserEdge) < edge || evidence.get(BarKind::Cost) > cost {
        return false;
    }
    let mut unlike = *evidence;
    unlike.set(BarKind::Alike, MOST_ALIKE_Q8);
    models.into_iter().any(|model| {
        // Shares of one whole: one of them is all.
        let nearby = [[256, 0, 0, 0], [0, 256, 0, 0], [0, 0, 256, 0], [0, 0, 0, 256]]
            .map(|nearby_q8| score_nearby_q8(model, nearby_q8));
        let most = nearby.into_iter().fold(0, i32::max);
        model.probability_q16(model.score_q8(&unlike.0) + most) >= least.to_bits()
    })
}

/// Share of the rows, Q8, in which the right image has the edge so far from the left one (1/32 px),
/// with its sign and half of its gradient, at the bar's disparity. Rows in which the left image has
/// none do not count.
fn share_q8(bar: &Bar, band: &Band<'_>, offset_q5: i32, sign: i32) -> i32 {
    let (mut found, mut all) = (0, 0);
    for &y in &rows(bar) {
        let Some((left, right)) = band.gradient_rows(y) else { continue };
        let x_q5 = bar.x_at_q5(y) + offset_q5;
        let there = ((x_q5 << 1) - bar.disparity_at_q6(y) + 32) >> 6;
        let strongest = |row: &[u8], centre: i32| {
            let near =
                usize::try_from(PAD as i32 + centre - 1).ok().and_then(|at| row.get(at..at + 3));
            let signed = |&g: &u8| (i32::from(g) - i32::from(FLAT)) * sign;
            near.unwrap_or(&[]).iter().map(signed).max().unwrap_or(0)
        };
        let own = strongest(left, (x_q5 + 16) >> 5);
        let other = strongest(right, band.width() - 1 - there);
        if own >= 3 {
            all += 1;
            found += i32::from(other >= 2 && 2 * other >= own);
        }
    }
    if all < 2 { 0 } else { quotient(found << 8, all) }
}

/// Log-odds by the evidence of support points alone, Q8.
pub(super) fn score_nearby_q8(model: &Model<BAR_EVIDENCE>, evidence_q8: [i16; 4]) -> i32 {
    model.part_q8(BarKind::SupportAgrees as usize, &evidence_q8)
}

impl BarEvidence {
    /// The evidence completed with that by support points, Q8.
    #[must_use]
    pub fn with_nearby(self, nearby_q8: [i16; 4]) -> Self {
        self.with_from(BarKind::SupportAgrees, nearby_q8)
    }
}
