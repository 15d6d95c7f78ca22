//! Left segments -> candidates: disparities with their evidence.
//!
//! In: the prominent segments of the left image, support points, a moving band of rows of both
//! images. Out: per segment a [`Candidate`], or the test that it failed as a [`Rejection`].
//!
//! A near-vertical segment is matched as a whole (`near_vertical`), a near-horizontal one by
//! windows above and below it (`near_horizontal`); both use the same curves of cost over disparity
//! (`curve`), strips of a band of rows (`band`) and margin between techniques (`aggregate`).
//!
//! # Cost
//! One segment of each square of the image is matched, so that their number is bounded by the area:
//! 192 at QVGA and 20 px, at most 24 000 instructions each at 64 disparities, 3.6 M in all. A
//! picture in which every segment passes every test takes the most; [`FullSearches`] limits those
//! of the whole range.

pub(crate) mod aggregate;
pub(crate) mod band;
pub(crate) mod codes;
pub(crate) mod consistency;
mod curves;
pub(crate) mod feature;
pub(crate) mod near_horizontal;
pub(crate) mod near_vertical;
pub(crate) mod repetition;
pub(crate) mod row_offset;
pub(crate) mod surroundings;

pub use curves::{CurveKind, SegmentCurves};

use crate::area::Area;
use crate::confidence::Models;
use crate::curve::{CURVES, Curve};
use crate::evidence::{NearbyEvidence, SegmentEvidence, SegmentKind};
use crate::image::Dims;
use crate::kernel::LANES;
use crate::lines::Segment;
use crate::params::Params;
use crate::result::Rejection;
use crate::support::Support;
use crate::units::{Confidence, narrow};
use aggregate::Agreement;
use band::Band;

// The hard tests are loose: they drop hypotheses that no other evidence can make credible; the
// confidence model rates the rest.

/// Least number of disparities compared: with fewer there is no second-best.
pub(crate) const MIN_RANGE: i32 = 8;
/// Margin of the search range on both sides of the disparities of support points nearby, px.
const AROUND: i32 = 3;
/// Largest uniqueness ratio, best / second-best, of the segment's window, Q8.
pub const MAX_WINDOW_RATIO_Q8: i32 = 230;
/// Largest uniqueness ratio, best / second-best, of census, Q8.
pub const MAX_CENSUS_RATIO_Q8: i32 = 240;
/// Largest uniqueness ratio, best / second-best, of a side's own window, Q8.
pub const MAX_SIDE_RATIO_Q8: i32 = 230;
/// Largest difference between the disparities of two sides, summed over both ends, for them to be
/// one surface, 1/64 px.
const ONE_SURFACE_Q6: i32 = 2 * 64;
/// Distance from an edge to the middle of the window of a side, px.
pub(crate) const WINDOW_MIDDLE: i32 = 4;
/// Largest difference between the disparities of both ends, 1/64 px.
pub const MAX_SLANT_Q6: i32 = 6 << 6;

/// A segment that passed every hard test, with a hypothesis for one or both of its sides.
#[derive(Clone, Debug, Hash)]
pub struct Candidate {
    /// The left segment.
    pub segment: Segment,
    /// The sides that carry a disparity: left and right of it, or above and below.
    pub sides: [Option<Side>; 2],
    /// Disparity by the window of the segment (near-horizontal: of its better side), 1/64 px.
    pub window_q6: i16,
    /// Disparity by census, 1/64 px.
    pub census_q6: i16,
    /// Disparity by the edge in the right image, 1/64 px; `None` where there is none.
    pub feature_q6: Option<i16>,
    /// True when a more probable hypothesis explains the same position in the right image.
    pub(crate) violates_uniqueness: bool,
    /// Index in the list of matches.
    pub(crate) listed: Option<u16>,
}

impl Candidate {
    pub(crate) fn new(
        segment: Segment,
        sides: [Option<Side>; 2],
        window_q6: i32,
        census_q6: i32,
        feature_q6: Option<i32>,
    ) -> Self {
        Self {
            segment,
            sides,
            window_q6: narrow(window_q6),
            census_q6: narrow(census_q6),
            feature_q6: feature_q6.map(narrow),
            violates_uniqueness: false,
            listed: None,
        }
    }

    /// Difference between the two sides' disparities, summed over both ends, 1/64 px; `None`
    /// without both.
    pub(crate) fn sides_apart_q6(&self) -> Option<i32> {
        let [Some(a), Some(b)] = &self.sides else { return None };
        Some((a.sum_q6() - b.sum_q6()).abs())
    }

    /// True when both sides have a hypothesis and agree.
    #[must_use]
    pub fn is_one_surface(&self) -> bool {
        self.sides_apart_q6().is_some_and(|apart| apart <= ONE_SURFACE_Q6)
    }

    /// True when the ends of every side's line lie at valid columns of the right image.
    fn ends_where_valid(&self, band: &Band<'_>) -> bool {
        let (x0, y0, x1, y1) = self.segment.ends_q5();
        self.sides.iter().flatten().all(|side| {
            let [d0, d1] = side.disparity_q6.map(i32::from);
            [(x0, y0, d0), (x1, y1, d1)].into_iter().all(|(x, y, d)| {
                let (from, to) = band.right_columns(y >> 5);
                let column = ((x << 1) - d + 32) >> 6;
                !band.is_restricted() || (from..to).contains(&column)
            })
        })
    }
}

/// Hypothesis of one side of a segment.
#[derive(Clone, Debug, Hash)]
pub struct Side {
    /// Disparity at the two ends, 1/64 px.
    pub disparity_q6: [i16; 2],
    /// Change of the disparity per pixel away from the edge, 1/1024 px; 0 unless both sides are one
    /// surface.
    pub across_q10: i16,
    /// Evidence by support points and other segments.
    pub nearby: NearbyEvidence,
    /// Weight of this side as a neighbour, Q8, 1 ..= 256.
    pub(crate) weight_q8: u16,
    /// Log-odds of the side without neighbours, Q8.
    pub(crate) score_q8: i16,
    /// Log-odds of the edge without neighbours, Q8.
    pub(crate) edge_score_q8: i16,
    /// Probability that the pixels next to the edge have this side's disparity, Q16.
    pub(crate) probability_q16: u16,
    /// Probability that the edge itself has this side's disparity, Q16.
    pub(crate) edge_probability_q16: u16,
    pub(crate) rejected: bool,
    /// True when the other side of a near-horizontal segment is nearer: an edge between two
    /// surfaces belongs to the nearer one.
    pub(crate) is_behind: bool,
}

/// [`SegmentKind::OtherNearer`] above which the other side is nearer, Q8. Near-vertical segments
/// are matched by the edge itself as well.
const NEARER_Q8: i32 = 144;

impl Side {
    pub(crate) fn new(
        [d0, d1]: [i32; 2],
        evidence: &SegmentEvidence,
        models: &Models,
        near_horizontal: bool,
    ) -> Self {
        // A side whose second-best costs less than best / 0.8 has the least weight as a neighbour.
        let weight = 256 - evidence.get(SegmentKind::SideRatio) * 5 / 4;
        Self {
            disparity_q6: [narrow(d0), narrow(d1)],
            across_q10: 0,
            nearby: NearbyEvidence::default(),
            weight_q8: weight.clamp(1, 256) as u16,
            score_q8: narrow(models.side(near_horizontal).score_q8(&evidence.0)),
            edge_score_q8: narrow(models.edge(near_horizontal).model.score_q8(&evidence.0)),
            probability_q16: 0,
            edge_probability_q16: 0,
            rejected: false,
            is_behind: false,
        }
    }

    /// Sum of the disparities of both ends, 1/64 px.
    pub(crate) fn sum_q6(&self) -> i32 {
        let [d0, d1] = self.disparity_q6;
        i32::from(d0) + i32::from(d1)
    }

    /// Probability that the disparity of the pixels next to the edge is within 1 px, neighbours
    /// included; 0 before a run has ended.
    #[must_use]
    pub fn confidence(&self) -> Confidence {
        Confidence::from_bits(self.probability_q16)
    }
}

/// Working memory for one segment.
#[derive(Debug)]
pub(crate) struct Workspace {
    pub(crate) curves: [Curve; CURVES],
    /// Evidence of the sides of the last candidate.
    pub(crate) evidence: [SegmentEvidence; 2],
}

impl Workspace {
    /// Leaves no curve of the segment before.
    pub(crate) fn clear_curves(&mut self) {
        self.curves.iter_mut().for_each(Curve::clear);
    }

    /// The sides with their log-odds; keeps their evidence for observers.
    #[inline(never)]
    fn rate(
        &mut self,
        evidence: &[Option<SegmentEvidence>; 2],
        lines_q6: [[i32; 2]; 2],
        models: &Models,
        near_horizontal: bool,
    ) -> [Option<Side>; 2] {
        let mut sides = [None, None];
        let kept = self.evidence.iter_mut().zip(evidence);
        for ((side, line_q6), (kept, evidence)) in sides.iter_mut().zip(lines_q6).zip(kept) {
            *side = evidence
                .as_ref()
                .map(|evidence| Side::new(line_q6, evidence, models, near_horizontal));
            kept.clone_from(evidence.as_ref().unwrap_or(const { &SegmentEvidence::new() }));
        }
        sides
    }
}

/// Context of a frame's segments, with the disparities at which they are searched, px.
#[derive(Clone, Copy)]
pub(crate) struct MatchContext<'a> {
    width: i32,
    min_disparity: i32,
    max_disparity: i32,
    /// The smallest and the largest disparity of the whole range.
    smallest: i32,
    largest: i32,
    pub(crate) support: Support<'a>,
    /// Areas in which bars repeat.
    repeating: &'a [Area],
    pub(crate) agreement: Agreement,
    pub(crate) models: &'a Models,
}

impl<'a> MatchContext<'a> {
    pub(crate) fn new(
        params: &Params,
        models: &'a Models,
        dims: Dims,
        support: Support<'a>,
    ) -> Self {
        Self {
            width: dims.width.into(),
            min_disparity: params.min_disparity.into(),
            max_disparity: params.max_disparity.into(),
            smallest: params.min_disparity.into(),
            largest: i32::from(params.max_disparity) - 1,
            support,
            repeating: &[],
            agreement: Agreement::new(params),
            models,
        }
    }

    /// The same, without searches for segments in areas in which bars repeat.
    pub(crate) fn outside(self, repeating: &'a [Area]) -> Self {
        Self { repeating, ..self }
    }

    /// Where a segment is searched: the disparities of the support points around it and [`AROUND`]
    /// on both sides, or everywhere where the points give no range.
    pub(crate) fn search(&self, segment: &Segment) -> Search {
        let (x0, y0, x1, y1) = segment.ends_q5();
        if self.repeating.iter().any(|area| area.contains((x0 + x1) >> 6, (y0 + y1) >> 6)) {
            return Search::Repeats;
        }
        let Some((low, high)) = self.support.range_around(segment.area()) else {
            return Search::Full;
        };
        let (low, high) = (low - AROUND, high + 1 + AROUND);
        // Whole blocks of disparities cost no more than partial ones.
        let more = LANES as i32 - 1 - ((high - low - 1) & (LANES as i32 - 1));
        let (low, high) = (low - more / 2, high + more - more / 2);
        let (first, end) = (low.max(self.min_disparity), high.min(self.max_disparity));
        if end - first < MIN_RANGE {
            return Search::Full;
        }
        Search::Directed(first as i16, end as i16)
    }

    /// First disparity and the one after the last, px.
    pub(crate) fn disparities(&self) -> (i32, i32) {
        (self.min_disparity, self.max_disparity)
    }

    /// True at the largest disparity of the whole range: a minimum may lie beyond.
    pub(crate) fn is_last(&self, disparity: i32) -> bool {
        disparity >= self.largest
    }

    /// True where a minimum may lie beyond the disparities compared, a first one and their number:
    /// at the largest, and at the smallest unless nothing is farther.
    pub(crate) fn is_end(&self, disparity: i32, (first, len): (i32, i32)) -> bool {
        self.is_last(disparity)
            || disparity >= first + len - 1
            || disparity <= first && first > self.smallest
    }

    /// Detail of the left image, Q8.
    pub(crate) fn detail_q8(&self) -> i32 {
        self.support.detail_q8.into()
    }

    /// First disparity and number of disparities to compare for a left window at this column, so
    /// that the match lies at columns `from .. to` of the right image, the valid ones.
    pub(crate) fn range_before(
        &self,
        column: i32,
        (from, to): (i32, i32),
    ) -> Result<(i32, i32), Rejection> {
        let first = if to < self.width {
            self.min_disparity.max(column + 1 - to)
        } else {
            self.min_disparity
        };
        let len = self.max_disparity.min(column + 1 - from) - first;
        if len < MIN_RANGE { Err(Rejection::NearBorder) } else { Ok((first, len)) }
    }
}

/// Disparities at which a segment is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Search {
    /// Around those of the support points nearby: the first one, and that after the last, px.
    Directed(i16, i16),
    /// The whole range: support points gave no narrower one.
    Full,
    /// None: the searches of the whole range are used up.
    Cut,
    /// None: it lies where bars repeat.
    Repeats,
}

/// Searches of the whole range that a run may make, evenly down the rows, so that the bottom is not
/// starved.
///
/// A picture in which no support point is credible, and every segment passes every test, would cost
/// 1.4 times the median.
///
/// # Bounds
/// One segment is kept of each square of at most 256 px: those searched, times the pixels of a
/// square, are at most (1320 + 256)^2, 4.0e7 in Q4.
pub(crate) struct FullSearches<'a> {
    areas: Option<&'a [Area]>,
    dims: Dims,
    /// Pixels of a square of which one segment is kept.
    square: i32,
    taken: i32,
}

impl<'a> FullSearches<'a> {
    /// Searches from the start.
    const FIXED: i32 = 4;
    /// Searches per square, 1/16. Captured pairs take up to 0.41, 0.56 where they are not rectified
    /// or the range is too small.
    const PER_SQUARE_Q4: i32 = 10;

    pub(crate) fn new(areas: Option<&'a [Area]>, dims: Dims, cell: u16) -> Self {
        Self { areas, dims, square: i32::from(cell) * i32::from(cell), taken: 0 }
    }

    /// The search of a segment, without one of the whole range where none is left.
    pub(crate) fn allow(&mut self, segment: &Segment, search: Search) -> Search {
        if search == Search::Full && !self.take(segment) { Search::Cut } else { search }
    }

    /// Takes one for a segment, if there is one left at its rows.
    fn take(&mut self, segment: &Segment) -> bool {
        let bottom = segment.area().bottom;
        let above = |area: &Area| Area { bottom: area.bottom.min(bottom), ..*area }.pixels() as i32;
        let whole = above(&Area::of(self.dims));
        let searched =
            self.areas.map_or(whole, |areas| areas.iter().map(above).sum::<i32>().min(whole));
        let is_left =
            ((self.taken - Self::FIXED) * self.square) << 4 < searched * Self::PER_SQUARE_Q4;
        self.taken += i32::from(is_left);
        is_left
    }
}

/// Matches one segment in a band that holds its rows, or returns the test that it fails.
pub(crate) fn match_segment(
    segment: &Segment,
    context: &MatchContext<'_>,
    search: Search,
    band: &Band<'_>,
    work: &mut Workspace,
) -> Result<Candidate, Rejection> {
    let directed;
    let context = match search {
        Search::Directed(first, end) => {
            let (min_disparity, max_disparity) = (first.into(), end.into());
            directed = MatchContext { min_disparity, max_disparity, ..*context };
            &directed
        }
        Search::Full => context,
        Search::Cut => return Err(Rejection::LessProminent),
        Search::Repeats => return Err(Rejection::WindowNotUnique),
    };
    let candidate = if segment.near_horizontal {
        near_horizontal::match_near_horizontal(segment, context, band, work)
    } else {
        near_vertical::match_near_vertical(segment, context, band, work)
    }?;
    if candidate.ends_where_valid(band) { Ok(candidate) } else { Err(Rejection::NearBorder) }
}
