//! The evidence of a hypothesis: plain numbers in Q8 that a linear model weighs.
//!
//! In: sums, counts and disparities of the matching. Out: one signed 16-bit number per kind, +-128 with a step of 1/256.

/// Kinds of evidence for a hypothesis, in the order of the model's coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Kind {
    /// This side's window: cost at the disparity / best cost elsewhere.
    SideRatio,
    /// log2(1 + that cost per pixel).
    SideCost,
    /// log2(1 + how much worse elsewhere is, per pixel).
    SideMargin,
    /// Segment window: best cost / best elsewhere.
    WindowRatio,
    /// log2(1 + its cost per pixel).
    WindowCost,
    /// Census: best cost / best elsewhere.
    CensusRatio,
    /// log2(1 + its cost per point).
    CensusCost,
    /// This side's census: cost at the disparity / best elsewhere.
    CensusSideRatio,
    /// |window - census|, px.
    CensusGap,
    /// |difference of the halves' disparities| per row or column.
    Slant,
    /// log2(1 + rows or columns).
    Length,
    /// The other side's window ratio.
    OtherRatio,
    /// 1 if the other side prefers another disparity.
    OtherDiffers,
    /// 1 if this side alone prefers another disparity.
    SideDiffers,
    /// 1 if the right image has no such edge there.
    NoFeature,
    /// |the edge in the right image - halves|, px, at most 2.
    FeatureGap,
    /// -1 left of or above the edge, +1 right or below.
    WhichSide,
    /// Slope against its direction, px per px.
    Lean,
    /// log2(1 + disparities compared).
    Range,
    /// log2(1 + grey step).
    Contrast,
    /// [`SupportKind::Detail`](crate::diagnostics::SupportKind::Detail) of the left image.
    Detail,
    /// log2(1 + support points nearby that agree).
    SupportAgreeing,
    /// Share of those that are farther: the hypothesis may be of something thin before a surface.
    SupportFarther,
    /// Share of those that are nearer.
    SupportNearer,
    /// log2(1 + segments nearby that agree).
    SegmentsAgreeing,
    /// The edge itself: cost at the disparity / best elsewhere.
    EdgeRatio,
    /// Distance of the pixel from the edge, px.
    Distance,
    /// 1 for the pixels next to an edge whose two sides are not known to be one surface.
    NextToEdge,
}

impl Kind {
    /// Meaning and unit of each entry, in the model's order.
    pub const NAMES: [&'static str; EVIDENCE] = [
        "this side's window: cost at the disparity / best cost elsewhere",
        "log2(1 + that cost per pixel)",
        "log2(1 + how much worse elsewhere is, per pixel)",
        "segment window: best cost / best elsewhere",
        "log2(1 + its cost per pixel)",
        "census: best cost / best elsewhere",
        "log2(1 + its cost per point)",
        "this side's census: cost at the disparity / best elsewhere",
        "|window - census|, px",
        "|difference of the halves' disparities| per row or column",
        "log2(1 + rows or columns)",
        "the other side's window ratio",
        "1 if the other side prefers another disparity",
        "1 if this side alone prefers another disparity",
        "1 if the right image has no such edge there",
        "|the edge in the right image - halves|, px",
        "-1 left of or above the edge, +1 right or below",
        "slope against its direction, px per px",
        "log2(1 + disparities compared)",
        "log2(1 + grey step)",
        "log2(1 + ranks that change along a window of the image, on average)",
        "log2(1 + support points nearby that agree)",
        "share of those that are farther",
        "share of those that are nearer",
        "log2(1 + segments nearby that agree)",
        "the edge itself: cost at the disparity / best elsewhere",
        "distance of the pixel from the edge, px",
        "1 for the pixels next to an edge whose two sides are not known to be one surface",
    ];
}

/// Evidence by support points, known when all segments are matched.
pub(crate) const HEARD: [Kind; 4] =
    [Kind::SupportAgreeing, Kind::SupportFarther, Kind::SupportNearer, Kind::SegmentsAgreeing];

/// Number of entries.
pub const EVIDENCE: usize = Kind::NextToEdge as usize + 1;

/// One number per [`Kind`], Q8.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Evidence(pub [i16; EVIDENCE]);

impl Evidence {
    pub(crate) const fn new() -> Self {
        Self([0; EVIDENCE])
    }

    pub(crate) fn set(&mut self, kind: Kind, value_q8: i32) {
        if let Some(slot) = self.0.get_mut(kind as usize) {
            *slot = i16::try_from(value_q8.clamp(-32767, 32767)).unwrap_or(0);
        }
    }

    /// The same evidence with what others say.
    #[must_use]
    pub fn with_heard(mut self, heard_q8: [i16; 4]) -> Self {
        for (kind, value) in HEARD.into_iter().zip(heard_q8) {
            self.set(kind, value.into());
        }
        self
    }

    /// The same evidence with one entry changed.
    pub(crate) fn with(mut self, kind: Kind, value_q8: i32) -> Self {
        self.set(kind, value_q8);
        self
    }

    pub(crate) fn get(&self, kind: Kind) -> i32 {
        self.0.get(kind as usize).copied().unwrap_or(0).into()
    }
}

/// `log2(1 + sum / count)` in Q8, by the leading bit and a straight line between powers of two (error below 0.09).
#[inline]
pub(crate) fn log2_mean_q8(sum: u32, count: i32) -> i32 {
    let mean_q4 = u32::try_from(count).ok().and_then(|count| (sum << 4).checked_div(count)).unwrap_or(0);
    let x_q4 = mean_q4 + 16;
    let whole = x_q4.checked_ilog2().unwrap_or(4);
    let part_q8 = ((x_q4 << 8) >> whole) as i32 - 256;
    ((whole as i32 - 4) << 8) + part_q8
}
