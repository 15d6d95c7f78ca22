//! The evidence for the disparity of a pixel: plain numbers in Q8 that a linear model weighs.
//!
//! In: cost curves of the local match, what features nearby say. Out: one signed 16-bit number per kind, +-128 with a step of 1/256.

/// Kinds of evidence for an answer, in the order of the model's coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum PixelKind {
    /// Census: cost at the disparity / best cost elsewhere.
    CensusRatio,
    /// Dislocated windows and census together: cost at the disparity / best cost elsewhere.
    JointRatio,
    /// The same, elsewhere being only what features nearby allow.
    GuidedRatio,
    /// |searched back - answer|, px, at most 4.
    LeftRightGap,
    /// log2(1 + mean gradient around the pixel).
    Texture,
    /// log2(1 + features nearby that agree).
    Support,
    /// log2(1 + surfaces that end at an edge next to the pixel, which lies beyond, and have this disparity).
    Across,
    /// How far the answer lies outside of what features nearby span, px, at most 4.
    Outside,
    /// log2(1 + support points nearby that agree).
    PointsAgreeing,
    /// Share of support points nearby that contradict.
    PointsConflicting,
}

impl PixelKind {
    /// Meaning and unit of each entry, in the model's order.
    pub const NAMES: [&'static str; PIXEL_EVIDENCE] = [
        "census: cost at the disparity / best cost elsewhere",
        "windows and census together: cost at the disparity / best cost elsewhere",
        "the same, elsewhere being what features nearby allow",
        "|searched back - answer|, px",
        "log2(1 + mean gradient around the pixel)",
        "log2(1 + features nearby that agree)",
        "log2(1 + surfaces that end at an edge before the pixel and agree)",
        "outside of what features nearby span, px",
        "log2(1 + support points nearby that agree)",
        "share of support points nearby that contradict",
    ];
}

/// Number of entries.
pub const PIXEL_EVIDENCE: usize = PixelKind::PointsConflicting as usize + 1;

/// One number per [`PixelKind`], Q8.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PixelEvidence(pub [i16; PIXEL_EVIDENCE]);

impl PixelEvidence {
    pub(super) const fn new() -> Self {
        Self([0; PIXEL_EVIDENCE])
    }

    pub(super) fn set(&mut self, kind: PixelKind, value_q8: i32) {
        if let Some(slot) = self.0.get_mut(kind as usize) {
            *slot = i16::try_from(value_q8.clamp(-32767, 32767)).unwrap_or(0);
        }
    }

    pub(super) fn get(&self, kind: PixelKind) -> i32 {
        self.0.get(kind as usize).copied().unwrap_or(0).into()
    }
}
