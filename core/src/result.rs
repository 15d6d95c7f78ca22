//! Results of a pair: matched segments, points, and counts of rejections.

use crate::named::named_enum;
use crate::units::{Confidence, Depth, Disparity, Position};

/// A sub-pixel image point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ImagePosition {
    /// Pixels right of the first column's centre.
    pub x: Position,
    /// Pixels below the first row's centre.
    pub y: Position,
}

/// The side or sides of a segment whose surface the edge belongs to. On a near-horizontal segment
/// (|dx| > 4 |dy|) `Left` is the side above.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Owner {
    /// Side of smaller x (above, on a near-horizontal segment): the other side is another surface,
    /// or unknown.
    Left,
    /// Side of larger x (below, on a near-horizontal segment).
    Right,
    /// Both sides: texture inside a surface.
    Both,
}

/// Disparity by each of the three techniques, px, at the segment's middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Techniques {
    /// Disparity by the edge in the right image with the same properties; `None` when there is
    /// none.
    pub feature: Option<Disparity>,
    /// Disparity by the window shaped by the segment.
    pub window: Disparity,
    /// Disparity by census along the segment.
    pub census: Disparity,
}

/// A segment of the left image with its disparity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Match {
    /// Ends: top first; left first on a near-horizontal segment (|dx| > 4 |dy|).
    pub ends: [ImagePosition; 2],
    /// Disparity at each end, px.
    pub disparity: [Disparity; 2],
    /// Standard deviation of the disparity, px.
    pub sigma: Disparity,
    /// Probability that the disparity along the edge is within 1 px.
    pub confidence: Confidence,
    /// Side or sides that own the edge.
    pub owner: Owner,
    /// Depth at each end, m; `None` without a rig.
    pub depth: Option<[Depth; 2]>,
    /// Standard deviation of depth at each end, m; `None` without a rig.
    pub depth_sigma: Option<[Depth; 2]>,
    /// Disparities by the three techniques.
    pub techniques: Techniques,
}

/// One pixel of the left image with a disparity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Point {
    /// Column, px.
    pub x: u16,
    /// Row, px.
    pub y: u16,
    /// Disparity of the surface seen at this pixel, px.
    pub disparity: Disparity,
    /// Probability that it is within 1 px.
    pub confidence: Confidence,
    /// Origin of the hypothesis.
    #[cfg_attr(feature = "serde", serde(with = "SerializedSource"))]
    pub source: Source,
}

impl Point {
    /// Position of the pixel's centre.
    #[must_use]
    pub fn position(&self) -> ImagePosition {
        let of = |whole: u16| Position::from_bits(whole << 5);
        ImagePosition { x: of(self.x), y: of(self.y) }
    }
}

/// Origin of a point: a segment or a support point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Source {
    /// A segment, at this index of the list of matches.
    Segment(u16),
    /// A side of a segment that is not in the list of matches, or a bar.
    Side,
    /// A support point.
    Support,
}

/// A [`Source`] in the order of its serialized form.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(remote = "Source")]
enum SerializedSource {
    Side,
    Segment(u16),
    Support,
}

named_enum! {
    /// Reason why a left segment (or one piece of it) has no match.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    #[cfg_attr(feature = "defmt", derive(defmt::Format))]
    #[non_exhaustive]
    pub enum Rejection {
        /// Another segment in the same cell has more extent and contrast, or there were too many to
        /// be searched over the whole range.
        LessProminent = "less_prominent",
        /// Too close to the left or right border to compare enough disparities.
        NearBorder = "near_border",
        /// The window's cost curve has a second minimum that is nearly as low, the left image shows
        /// the edge again at equal distances, or it lies where five equal bars stand at equal
        /// distances.
        WindowNotUnique = "window_not_unique",
        /// The census curve has a second minimum that is nearly as low.
        CensusNotUnique = "census_not_unique",
        /// The techniques lie further apart than the margin (Eq. 13).
        TechniquesDisagree = "techniques_disagree",
        /// The two halves' disparities are too far apart to be one straight edge.
        Slant = "slant",
        /// Neither side's own window is unique at the disparity.
        NoOwner = "no_owner",
        /// A more probable hypothesis matches the same position in the right image.
        NotUnique = "not_unique",
        /// The probability is below [`Params::min_confidence`](crate::Params::min_confidence).
        LowConfidence = "low_confidence",
        /// A side's disparity is credible and its points are listed, but the edge itself may belong
        /// to the surface on the other side.
        EdgeUnclear = "edge_unclear",
    }

    /// Every reason, in the order of the tests.
    const ALL;

    /// The reason in snake case, as in JSON and tables.
    fn name;
}

/// Numbers of segments found, matched, rejected and dropped in one frame:
/// `segments_left = matched + all rejections`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counts {
    /// Segments detected in the left image (long ones count once per piece that is matched on its
    /// own).
    pub segments_left: u16,
    /// Near-horizontal segments detected in the right image, for the row offset.
    pub segments_right: u16,
    /// Left segments beyond the detector's capacity, shortest first.
    pub segments_left_dropped: u16,
    /// Right segments beyond the detector's capacity.
    pub segments_right_dropped: u16,
    /// Edges of both images that were not drawn, because the budget of work was spent: a dense
    /// grating has more than any scene. Counted are the places where one would have started.
    pub edges_cut: u16,
    /// Left segments that were not compared with all others for the same reason: over the whole
    /// range, with right ones for the row offset, or with their neighbours.
    pub comparisons_cut: u16,
    /// Left segments that were searched over the whole disparity range, because support points
    /// nearby gave no narrower one.
    pub searched_fully: u16,
    /// Segments in the list of matches.
    pub matched: u16,
    rejected: [u16; Rejection::ALL.len()],
    pub(crate) edge_units: u32,
}

impl Counts {
    /// Number of left segments rejected for this reason.
    #[must_use]
    pub fn rejected(&self, reason: Rejection) -> u16 {
        self.rejected.get(reason as usize).copied().unwrap_or(0)
    }

    /// A list was full or a budget of work spent: what fits is in the result, not all that the
    /// images have.
    #[must_use]
    pub fn is_cut(&self) -> bool {
        [
            self.segments_left_dropped, self.segments_right_dropped, self.edges_cut,
            self.comparisons_cut,
        ] != [0; 4]
    }

    /// Work of the edges of both images, in units of some 50 instructions of a Cortex-M7: what
    /// [`Counts::edges_cut`] keeps bounded.
    #[must_use]
    pub fn edge_units(&self) -> u32 {
        self.edge_units
    }

    /// Adds the counts of other segments.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.searched_fully = self.searched_fully.saturating_add(other.searched_fully);
        self.comparisons_cut = self.comparisons_cut.saturating_add(other.comparisons_cut);
        for (count, more) in self.rejected.iter_mut().zip(other.rejected) {
            *count = count.saturating_add(more);
        }
    }

    pub(crate) fn reject(&mut self, reason: Rejection) {
        self.reject_many(reason, 1);
    }

    pub(crate) fn reject_many(&mut self, reason: Rejection, segments: u16) {
        if let Some(count) = self.rejected.get_mut(reason as usize) {
            *count = count.saturating_add(segments);
        }
    }
}
