//! The evidence for the disparity of a pixel: plain numbers in Q8 that a linear model weighs.
//!
//! In: cost curves of the local match, the disparity prior. Out: one signed 16-bit number per kind,
//! +-128 with a step of 1/256.

use crate::evidence::define_evidence;

define_evidence! {
    /// Kinds of evidence for a pixel's disparity, in the order of the model's coefficients.
    PixelKind;
    /// One number per [`PixelKind`], Q8.
    PixelEvidence;
    PIXEL_EVIDENCE;
    CensusRatio: "census: cost at the disparity / best cost elsewhere",
    JointRatio: "windows and census together: cost at the disparity / best cost elsewhere",
    GuidedRatio: "the same, elsewhere being what features nearby allow",
    LeftRightGap: "|searched back - answer|, px",
    Texture: "log2(1 + mean gradient around the pixel)",
    Support: "log2(1 + features nearby that agree)",
    Across: "log2(1 + surfaces that end at an edge before the pixel and agree)",
    Outside: "outside of what features nearby span, px",
    PointsAgreeing: "log2(1 + support points nearby that agree)",
    PointsConflicting: "share of support points nearby that contradict",
}
