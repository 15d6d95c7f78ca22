//! The evidence of a hypothesis: plain numbers in Q8 that a linear model weighs.
//!
//! In: sums, counts and disparities of the matching. Out: one signed 16-bit number per kind, +-128
//! with a step of 1/256.

/// Defines the kinds of evidence of a model in the order of its coefficients, their number, and the
/// values of one hypothesis in Q8.
macro_rules! define_evidence {
    ($(#[$kind_doc:meta])* $SegmentKind:ident; $(#[$values_doc:meta])* $Values:ident; $COUNT:ident; $($Entry:ident: $meaning:literal,)+) => {
        $(#[$kind_doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(usize)]
        pub enum $SegmentKind {
            $(#[doc = $meaning] $Entry,)+
        }

        /// Number of kinds.
        pub const $COUNT: usize = [$($SegmentKind::$Entry),+].len();

        $(#[$values_doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub struct $Values(pub [i16; $COUNT]);

        #[allow(dead_code, reason = "not every model reads single kinds")]
        impl $Values {
            pub(crate) const fn new() -> Self {
                Self([0; $COUNT])
            }

            pub(crate) fn set(&mut self, kind: $SegmentKind, value_q8: i32) {
                if let Some(slot) = self.0.get_mut(kind as usize) {
                    *slot = crate::units::narrow(value_q8);
                }
            }

            pub(crate) fn get(&self, kind: $SegmentKind) -> i32 {
                self.0.get(kind as usize).copied().unwrap_or(0).into()
            }

            /// The evidence with these values of a kind and of those after it, Q8.
            pub(crate) fn with_from<const M: usize>(
                mut self,
                first: $SegmentKind,
                values_q8: [i16; M],
            ) -> Self {
                let slots = self.0.iter_mut().skip(first as usize);
                slots.zip(values_q8).for_each(|(slot, value_q8)| *slot = value_q8);
                self
            }
        }
    };
}
pub(crate) use define_evidence;

define_evidence! {
    /// Kinds of evidence for a hypothesis, in the order of the model's coefficients.
    SegmentKind;
    /// One number per [`SegmentKind`], Q8.
    SegmentEvidence;
    SEGMENT_EVIDENCE;
    SideRatio: "this side's window: cost at the disparity / best cost elsewhere",
    SideCost: "log2(1 + that cost per pixel)",
    SideMargin: "log2(1 + how much worse elsewhere is, per pixel)",
    WindowRatio: "segment window: best cost / best elsewhere",
    WindowCost: "log2(1 + its cost per pixel)",
    CensusRatio: "census: best cost / best elsewhere",
    CensusCost: "log2(1 + its cost per point)",
    CensusSideRatio: "this side's census: cost at the disparity / best elsewhere",
    CensusGap: "|window - census|, px",
    Slant: "|difference of the halves' disparities| per row or column",
    Length: "log2(1 + rows or columns)",
    OtherRatio: "the other side's window ratio",
    OtherDiffers: "1 if the other side prefers another disparity",
    SideDiffers: "1 if this side alone prefers another disparity",
    NoFeature: "1 if the right image has no such edge there",
    FeatureGap: "|the edge in the right image - halves|, px",
    WhichSide: "-1 left of or above the edge, +1 right or below",
    Lean: "slope against its direction, px per px",
    Range: "log2(1 + disparities compared)",
    Contrast: "log2(1 + grey step)",
    Detail: "log2(1 + how much codes change along a window of the image, on average)",
    SupportAgreeing: "log2(1 + support points nearby that agree)",
    SupportFarther: "share of those that are farther",
    SupportNearer: "share of those that are nearer",
    SegmentsAgreeing: "log2(1 + segments nearby that agree)",
    EdgeRatio: "the edge itself, or the row next to it: cost at the disparity / best elsewhere",
    HalfRatio: "the less unique half: cost at the disparity / best elsewhere",
    OtherNearer: "how unique the other side is at a nearer disparity, 0 ..= 1",
    Distance: "distance of the pixel from the edge, px",
    NextToEdge: "1 for the pixels next to an edge whose two sides are not known to be one surface",
}

/// Evidence by support points and other segments, known when all segments are matched, Q8.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct NearbyEvidence {
    /// [`SegmentKind::SupportAgreeing`].
    pub agreeing: i16,
    /// [`SegmentKind::SupportFarther`].
    pub farther: i16,
    /// [`SegmentKind::SupportNearer`].
    pub nearer: i16,
    /// [`SegmentKind::SegmentsAgreeing`].
    pub segments: i16,
}

impl NearbyEvidence {
    /// The first of its kinds; the others follow.
    pub(crate) const FIRST: SegmentKind = SegmentKind::SupportAgreeing;

    /// In the order of kinds.
    pub(crate) fn values(self) -> [i16; 4] {
        [self.agreeing, self.farther, self.nearer, self.segments]
    }
}

impl SegmentEvidence {
    /// The evidence completed with that by support points and segments nearby.
    #[must_use]
    pub fn with_nearby(self, nearby: NearbyEvidence) -> Self {
        self.with_from(NearbyEvidence::FIRST, nearby.values())
    }
}

/// `log2(1 + sum / count)` in Q8, by the leading bit and a straight line between powers of two
/// (error below 0.09).
#[inline]
pub(crate) fn log2_mean_q8(sum: u32, count: i32) -> i32 {
    let mean_q4 =
        u32::try_from(count).ok().and_then(|count| (sum << 4).checked_div(count)).unwrap_or(0);
    let x_q4 = mean_q4 + 16;
    let whole = x_q4.checked_ilog2().unwrap_or(4);
    let part_q8 = ((x_q4 << 8) >> whole) as i32 - 256;
    ((whole as i32 - 4) << 8) + part_q8
}
