//! Depth of a pixel that lies on no segment: by features and support points nearby, and by a match
//! on demand around it.
//!
//! In: a run's candidates, support points and pair, a pixel, the region that it belongs to, if one
//! is known. Out: a [`PixelDepth`] or a [`PixelRejection`].
//!
//! ```text
//! prior:  disparities of segments' sides and support points nearby, of the same region if it is known              (prior)
//! patch:  gradients and census codes of the rows around the pixel, in the columns that the search reads            (patch)
//! local:  windows around the pixel, not centred on it, and census, over every disparity; left-right check          (local)
//! answer: evidence -> probability of being within 1 px and standard deviation, by a fitted linear
//!         model and its tables (evidence, fitted)
//! ```
//! Prior and match fail for different reasons: features nearby may be of another surface, a match
//! may be a repetition of the texture. Their agreement is strong evidence.
//!
//! # Cost
//! The memory of the run's band and curves. At 64 disparities 40 000 to 53 000 instructions a pixel
//! on a Cortex-M7 (means of the built-in pairs, QEMU), at most 65 000 where segments are dense;
//! 6000 where there is no texture.
//!
//! # Source
//! The chapter's future work: a pixel described by the closest features, dislocated kernels.

mod bars;
mod evidence;
mod fitted;
mod local;
mod patch;
mod prior;

use crate::area::Area;
use crate::evidence::log2_mean_q8;
use crate::image::{Dims, Gray};
use crate::matching::{Candidate, MIN_RANGE, Workspace};
use crate::named::named_enum;
use crate::objects::Region;
use crate::params::Params;
use crate::rig::Rig;
use crate::row_memory::row_bytes;
use crate::support::Support;
use crate::units::{Confidence, Depth, Disparity, disparity_from_q6};
pub(crate) use bars::on_bars;
pub use evidence::{PIXEL_EVIDENCE, PixelEvidence, PixelKind};
pub use fitted::FITTED_PIXEL;
use patch::{COLUMNS_REACH, Patch};
use prior::DisparityPrior;

/// Distance up to which support points show a pattern, px.
const PATTERN_REACH: i32 = 12;
/// Twice the mean gradient around a pixel (half a grey level per px) below which there is nothing
/// to match.
const BLANK: u32 = 1;
/// Texture below which a low confidence is reported as [`PixelRejection::NoTexture`], log2(1 + mean
/// gradient) in Q8.
const LITTLE_TEXTURE_Q8: i32 = 256;
/// Gap of the left-right check above which it has failed, px in Q8.
pub const LEFT_RIGHT_GAP_Q8: i32 = 384;
/// Uniqueness ratio, best / second-best, above which the answer is not unique, Q8.
pub const SECOND_BEST_Q8: i32 = 205;

/// The depth of one pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PixelDepth {
    /// Disparity of the surface seen at the pixel, px.
    pub disparity: Disparity,
    /// Standard deviation of the disparity, px.
    pub sigma: Disparity,
    /// Probability that the disparity is within 1 px.
    pub confidence: Confidence,
    /// Depth, m; `None` without a rig.
    pub depth: Option<Depth>,
    /// Standard deviation of depth, m; `None` without a rig.
    pub depth_sigma: Option<Depth>,
}

impl PixelDepth {
    fn new(
        disparity: Disparity,
        sigma: Disparity,
        confidence: Confidence,
        rig: Option<Rig>,
    ) -> Self {
        let depth = rig.map(|rig| rig.depth(disparity));
        let depth_sigma = rig.map(|rig| rig.depth_sigma(disparity, sigma));
        Self { disparity, sigma, confidence, depth, depth_sigma }
    }
}

named_enum! {
    /// Reason why a pixel has no depth.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, thiserror::Error)]
    #[cfg_attr(feature = "defmt", derive(defmt::Format))]
    #[non_exhaustive]
    pub enum PixelRejection {
        /// The pixel lies outside of the image, or of its valid part.
        #[error("the pixel lies outside of the valid image")]
        Outside = "outside",
        /// The pixel does not belong to the region given.
        #[error("the pixel does not belong to the region")]
        OutsideRegion = "outside_region",
        /// Too close to the border to compare enough disparities.
        #[error("too close to the border to compare disparities")]
        NearBorder = "near_border",
        /// There is nothing to match around the pixel.
        #[error("nothing to match around the pixel")]
        NoTexture = "no_texture",
        /// The left-right check fails: most likely the surface is occluded in the right image.
        #[error("hidden in the right image, most likely")]
        LeftRight = "left_right",
        /// Another disparity matches nearly as well.
        #[error("another disparity matches nearly as well")]
        NotUnique = "not_unique",
        /// The probability by all evidence is below [`Params::min_confidence`].
        #[error("not credible enough")]
        LowConfidence = "low_confidence",
        /// The pair was refused.
        #[error("the pair is not fit to be used")]
        UnhealthyPair = "unhealthy_pair",
    }

    /// Every reason.
    const ALL;

    /// The reason in snake case, as in JSON and tables.
    fn name;
}

/// Inputs and working memory for the depth of one pixel.
pub(crate) struct Query<'a> {
    pub(crate) params: &'a Params,
    /// Left and right image.
    pub(crate) images: [Gray<'a>; 2],
    pub(crate) dims: Dims,
    pub(crate) candidates: &'a [Candidate],
    pub(crate) support: Support<'a>,
    /// Row of the right image that matches row 0 of the left one.
    pub(crate) row_offset: i32,
    pub(crate) rows: &'a mut [u8],
    pub(crate) work: &'a mut Workspace,
}

impl Query<'_> {
    #[inline(never)]
    pub(crate) fn answer(
        self,
        pixel: (u16, u16),
        region: Option<&Region<'_>>,
    ) -> Result<PixelDepth, PixelRejection> {
        let params = self.params;
        let (d_q6, evidence) = self.evidence_of(pixel, region)?;
        let score_q8 = FITTED_PIXEL.model.score_q8(&evidence.0);
        let confidence = Confidence::from_bits(FITTED_PIXEL.model.probability_q16(score_q8));
        if confidence < params.min_confidence {
            return Err(rejection_of(&evidence));
        }
        let sigma = disparity_from_q6(FITTED_PIXEL.sigma_q6(score_q8).into());
        Ok(PixelDepth::new(disparity_from_q6(d_q6), sigma, confidence, params.rig))
    }

    /// Disparity, 1/64 px, and its evidence.
    #[inline(never)]
    pub(crate) fn evidence_of(
        self,
        (x, y): (u16, u16),
        region: Option<&Region<'_>>,
    ) -> Result<(i32, PixelEvidence), PixelRejection> {
        let [left, right] = self.images;
        let (x, y) = (i32::from(x), i32::from(y));
        let inside = x < i32::from(self.dims.width) && y < i32::from(self.dims.height);
        if !inside || !left.valid_columns(y).contains(x) {
            return Err(PixelRejection::Outside);
        }
        if region.is_some_and(|region| !region.contains(x, y)) {
            return Err(PixelRejection::OutsideRegion);
        }
        let (least, most) =
            (i32::from(self.params.min_disparity), i32::from(self.params.max_disparity));
        let (valid, right_valid) =
            (left.valid_columns(y), right.valid_columns(y + self.row_offset));
        let (start, end) = (i32::from(valid.start), i32::from(valid.end));
        // Windows stay within the image: its border would match the other image's border, wherever
        // the surface is.
        let middle = x.min(end - 1 - COLUMNS_REACH).max(start + 1 + COLUMNS_REACH);
        let first = least.max(x + 1 - i32::from(right_valid.end));
        let len = most.min(x + 1 - i32::from(right_valid.start)) - first;
        // The second-best is searched where its whole window lies in the right image.
        let whole = middle - COLUMNS_REACH - i32::from(right_valid.start) - first;
        if len.min(whole) < MIN_RANGE {
            return Err(PixelRejection::NearBorder);
        }
        if self.repeats((x, y), region) {
            return Err(PixelRejection::NotUnique);
        }
        let stride = row_bytes(self.dims.width);
        let mut patch = Patch::new([left, right], (middle, y), self.row_offset, self.rows, stride);
        let (sum, count) = patch.gradient_sum();
        if sum * 2 < BLANK * count.unsigned_abs() {
            return Err(PixelRejection::NoTexture);
        }
        let prior = DisparityPrior::new(self.candidates, self.support, (x, y), region);
        let range_back = |at: i32| (least, most.min(end - (middle - at)) - least);
        let (d_q6, mut evidence) =
            local::match_pixel(&mut patch, (first, len), range_back, &prior, &mut self.work.curves);
        evidence.set(PixelKind::Texture, log2_mean_q8(sum, count));
        Ok((d_q6, evidence))
    }

    /// True when more of the support points around a pixel have windows that repeat than a
    /// disparity: it is on a pattern, of which nobody knows which repetition is meant.
    fn repeats(&self, (x, y): (i32, i32), region: Option<&Region<'_>>) -> bool {
        let pixel = |at: i32| u16::try_from(at).unwrap_or(0);
        let area = Area {
            left: pixel(x - PATTERN_REACH),
            top: pixel(y - PATTERN_REACH),
            right: pixel(x + PATTERN_REACH),
            bottom: pixel(y + PATTERN_REACH),
        };
        let contains = |x: i32, y: i32| region.is_none_or(|region| region.contains(x, y));
        let matched = self.support.within(area).filter(|&(x, y, _)| contains(x, y)).count();
        self.support.repeating(area, contains) as usize > matched
    }
}

/// The strongest evidence against a disparity that is not credible.
fn rejection_of(evidence: &PixelEvidence) -> PixelRejection {
    if evidence.get(PixelKind::Texture) < LITTLE_TEXTURE_Q8 {
        PixelRejection::NoTexture
    } else if evidence.get(PixelKind::LeftRightGap) > LEFT_RIGHT_GAP_Q8 {
        PixelRejection::LeftRight
    } else if evidence.get(PixelKind::GuidedRatio) > SECOND_BEST_Q8 {
        PixelRejection::NotUnique
    } else {
        PixelRejection::LowConfidence
    }
}
