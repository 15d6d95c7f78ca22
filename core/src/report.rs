//! Candidates -> lists of results: matches with depth, and points, each pixel at most once.
//!
//! ```text
//! rating:     probability of every side, with the evidence by neighbours
//! uniqueness: of two sides that match the same position in the right image with different
//!             disparities the less probable one is rejected
//! matches:    segments whose edge itself has one side's disparity with enough probability, most
//!             probable first
//! points:     support points, pixels of bars, pixels beside sides, most probable side first; each
//!             pixel once
//! ```
//!
//! # Cost
//! A candidate: some 300 instructions, a sort of them (`2 n log2 n` comparisons), 20 for every two
//! within the rows of a contradiction. Points: one test a pixel of each side, at most 2 * reach *
//! 32 a candidate, and one a support point.

use crate::bars::{Bar, Edge};
use crate::confidence::{Model, Models, Network};
use crate::evidence::{NearbyEvidence, SegmentKind};
use crate::lines::Segment;
use crate::list::List;
use crate::matching::consistency::{Neighbour, for_each_contradiction};
use crate::matching::{Candidate, Side};
use crate::params::Params;
use crate::result::{Counts, Match, Owner, Point, Rejection, Source, Techniques};
use crate::side_pixels::{SidePixels, ValidPixels};
use crate::sort::sort_by_key;
use crate::support::context::{CONTEXT_EVIDENCE, Listing};
use crate::support::{Likeness, Support};
use crate::units::{Confidence, Disparity, disparity_from_q6, narrow};
use core::ops::Range;

/// Least probability, Q16, of the less probable side of a segment that belongs to both: 0.98. Below
/// it the other side's surface may end at the edge.
const BOTH_SIDES_Q16: u16 = 64_225;

/// Probability below which a side's pixels are right less often than its model says, Q16: 0.9.
/// Pixels that more probable sides and support points have as well are listed as theirs.
const LEFT_OVER_Q16: u16 = 58_982;

/// Entry of an order: a sort key and the index of a candidate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ranked {
    pub(crate) probability_q16: u16,
    pub(crate) candidate: u16,
}

/// Rates and rejects candidates, lists matches, generates points. `order` has an entry per
/// candidate, `marks` a bit per pixel.
pub(crate) struct Report<'a> {
    pub(crate) params: &'a Params,
    pub(crate) models: &'a Models,
    pub(crate) views: ValidPixels<'a>,
    pub(crate) candidates: &'a mut [Candidate],
    pub(crate) neighbours: &'a [Neighbour],
    pub(crate) order: List<'a, Ranked>,
    pub(crate) support: Support<'a>,
    pub(crate) marks: &'a mut [u32],
    pub(crate) bars: &'a [Bar],
}

impl<'r> Report<'r> {
    pub(crate) fn run(&mut self, matches: &mut List<'_, Match>, counts: &mut Counts) {
        for candidate in self.candidates.iter_mut() {
            rate(candidate, self.models);
        }
        self.apply_uniqueness();
        self.give_edges_to_bars();
        self.list_matches(matches, counts);
    }

    fn least(&self) -> u16 {
        self.params.min_confidence.to_bits()
    }

    /// Uniqueness constraint: rejects sides that are not probable enough, and the less probable of
    /// two that contradict each other.
    fn apply_uniqueness(&mut self) {
        let least = self.least();
        for side in
            self.candidates.iter_mut().flat_map(|candidate| candidate.sides.iter_mut().flatten())
        {
            side.rejected = side.probability_q16 < least;
        }
        // Probabilities stay as they are while hypotheses are rejected, so the order of the pairs
        // does not matter.
        let candidates = &mut *self.candidates;
        for_each_contradiction(self.neighbours, candidates.len(), |a, b| {
            let probability = |(i, side): (usize, usize)| {
                let sides = candidates.get(i).map(|c: &Candidate| &c.sides);
                sides
                    .and_then(|sides| sides.get(side))
                    .and_then(Option::as_ref)
                    .map_or(0, |side| side.probability_q16)
            };
            let (pa, pb) = (probability(a), probability(b));
            let (i, side) = if pa < pb { a } else { b };
            if pa != pb
                && let Some(candidate) = candidates.get_mut(i)
            {
                candidate.violates_uniqueness = true;
                if let Some(Some(hypothesis)) = candidate.sides.get_mut(side) {
                    hypothesis.rejected = true;
                }
            }
        });
    }

    /// Gives the segments along the edges of bars that their sides lie behind to the nearest of
    /// these bars.
    fn give_edges_to_bars(&mut self) {
        for candidate in self.candidates.iter_mut() {
            let segment = candidate.segment;
            let (_, y0, _, y1) = segment.ends_q5();
            let middle = (y0 + y1) >> 6;
            let nearest = self
                .bars
                .iter()
                .filter_map(|bar| Some((bar, bar.edge_of(&segment)?)))
                .max_by_key(|(bar, _)| bar.disparity_at_q6(middle));
            let Some((bar, edge)) = nearest else { continue };
            let mut sides = candidate.sides.iter().flatten();
            if sides.all(|side| bar.hides(middle, side.sum_q6() / 2)) {
                let ends_q6 = [y0, y1].map(|y| narrow(bar.disparity_at_q6(y >> 5)));
                candidate.become_edge(bar, edge, ends_q6);
            }
        }
    }

    /// Most probable first.
    #[inline(never)]
    fn sort_order(&mut self) {
        sort_by_key(&mut self.order, |r| (u16::MAX - r.probability_q16, r.candidate));
    }

    fn list_matches(&mut self, matches: &mut List<'_, Match>, counts: &mut Counts) {
        let least = self.least();
        self.order.clear();
        for (candidate, i) in self.candidates.iter().zip(0..) {
            match candidate.edge_side() {
                Some(side) if side.edge_rating() >= least => {
                    // One entry per candidate: it fits.
                    let _ = self
                        .order
                        .push(Ranked { probability_q16: side.edge_probability_q16, candidate: i });
                }
                Some(_) => counts.reject(Rejection::EdgeUnclear),
                None if candidate.violates_uniqueness => counts.reject(Rejection::NotUnique),
                None => counts.reject(Rejection::LowConfidence),
            }
        }
        self.sort_order();
        for (rank, ranked) in (0..).zip(self.order.iter()) {
            let Some(candidate) = self.candidates.get_mut(usize::from(ranked.candidate)) else {
                continue;
            };
            let Some(found) = to_match(candidate, self.params, self.models) else { continue };
            candidate.listed = Some(rank);
            let _ = matches.push(found); // its capacity is that of the candidates
        }
        counts.matched = u16::try_from(matches.len()).unwrap_or(u16::MAX);
    }

    /// Every point of a pair that is fit, in the order of [`Matched::points`](crate::Matched).
    pub(crate) fn points(
        mut self,
        is_fit: bool,
        likeness: Likeness<'r>,
        network: &'r Network<CONTEXT_EVIDENCE>,
    ) -> Points<'r> {
        self.order.clear();
        for (candidate, i) in self.candidates.iter().zip(0..) {
            if let Some(side) = candidate.best(|side| side.probability_q16) {
                let _ =
                    self.order.push(Ranked { probability_q16: side.probability_q16, candidate: i });
            }
        }
        self.sort_order();
        self.marks.fill(0);
        let least = self.least();
        let Self { params, models, views, candidates, order, support, marks, bars, .. } = self;
        Points {
            reach: params.reach,
            least,
            models,
            views,
            listing: Listing { support, likeness, network },
            marks,
            index: if is_fit { 0 } else { usize::MAX },
            bars: if is_fit { bars } else { &[] },
            y: 0,
            columns: 0..0,
            row_q6: 0,
            candidates,
            order: if is_fit { order.into_slice() } else { &[] },
            side: 0,
            distance: 0,
            pixels: SidePixels::NONE,
            probability: 0,
        }
    }
}

/// The points of a pair, made one by one: it is small, and compiled here once.
#[derive(Debug)]
pub(crate) struct Points<'a> {
    reach: u16,
    least: u16,
    models: &'a Models,
    views: ValidPixels<'a>,
    listing: Listing<'a>,
    /// A bit for each pixel that is listed.
    marks: &'a mut [u32],
    /// The next support point.
    index: usize,
    /// Bars that are not listed yet; row of the first of them, the columns left there, and their
    /// disparity, 1/64 px.
    bars: &'a [Bar],
    y: u16,
    columns: Range<u16>,
    row_q6: i32,
    candidates: &'a [Candidate],
    /// Candidates that are not listed yet; side and distance of the first of them, the pixels left
    /// there, and their probability.
    order: &'a [Ranked],
    side: usize,
    distance: u16,
    pixels: SidePixels,
    probability: u16,
}

impl Points<'_> {
    /// Index of the word of a pixel's mark, and its bit there.
    fn mark(&self, x: u16, y: u16) -> (usize, u32) {
        let pixel = usize::from(y) * usize::from(self.views.dims().width) + usize::from(x);
        (pixel >> 5, 1 << (pixel & 31))
    }

    fn is_listed(&self, x: u16, y: u16) -> bool {
        let (word, bit) = self.mark(x, y);
        self.marks.get(word).is_some_and(|word| word & bit != 0)
    }

    /// The support point with this index, which is listed at this pixel, if its pixels are valid.
    #[inline(never)] // inlined, 15 % more instructions a list: registers are spilled
    fn support_point(&self, index: usize, (x, y): (u16, u16)) -> Option<Point> {
        let disparity = self.listing.support.points.get(index)?.disparity();
        if !self.views.allow(x.into(), y.into(), disparity.to_bits().into()) {
            return None;
        }
        let confidence = Confidence::from_bits(self.listing.probability_q16(index, (x, y)));
        Some(Point { x, y, disparity, confidence, source: Source::Support })
    }

    /// The next credible support point.
    fn of_grid(&mut self) -> Option<Point> {
        loop {
            let ((x, y), point) = self.listing.support.listed(self.index)?;
            let index = self.index;
            self.index += 1;
            if point.is_matched()
                && let Some(point) = self.support_point(index, (x, y))
                && point.confidence.to_bits() >= self.least
            {
                return Some(point);
            }
        }
    }

    /// The next pixel of a bar that is not listed yet.
    fn of_bar(&mut self) -> Option<Point> {
        loop {
            let (bar, rest) = self.bars.split_first()?;
            let [first, last] = bar.rows();
            let Some(x) = self.columns.next() else {
                // Rows begin at 0 after another bar, and each begins behind the one before.
                let y = self.y.max(first);
                if y > last {
                    (self.bars, self.y) = (rest, 0);
                } else {
                    (self.columns, self.y) = (bar.listed_columns(y), y + 1);
                    self.row_q6 = bar.disparity_at_q6(y.into());
                }
                continue;
            };
            let (y, d_q6) = (self.y - 1, self.row_q6);
            if !self.is_listed(x, y) && self.views.allow(x.into(), y.into(), d_q6) {
                let (disparity, confidence) = (disparity_from_q6(d_q6), bar.confidence());
                return Some(Point { x, y, disparity, confidence, source: Source::Side });
            }
        }
    }

    /// The next pixel beside a segment that is not listed yet and not [taken](Support::is_taken).
    fn of_side(&mut self) -> Option<Point> {
        loop {
            let (ranked, rest) = self.order.split_first()?;
            let candidate = self.candidates.get(usize::from(ranked.candidate))?;
            let Some((x, y, d_q6)) = self.pixels.next(&self.views) else {
                self.distance += 1;
                if self.distance > self.reach {
                    (self.side, self.distance) = (self.side + 1, 0);
                } else {
                    self.begin(candidate);
                }
                if self.side > 1 {
                    (self.order, self.side) = (rest, 0);
                }
                continue;
            };
            if self.is_listed(x, y) || self.listing.support.is_taken((x, y), d_q6, self.probability)
            {
                continue;
            }
            return Some(Point {
                x,
                y,
                disparity: disparity_from_q6(d_q6),
                confidence: Confidence::from_bits(self.probability),
                source: candidate.listed.map_or(Source::Side, Source::Segment),
            });
        }
    }

    /// Begins with the pixels at this distance, if they are probable enough.
    fn begin(&mut self, candidate: &Candidate) {
        let Some(Some(side)) = candidate.sides.get(self.side) else { return };
        let model = self.models.side(candidate.segment.near_horizontal);
        let next_to_edge = self.distance == 1 && !candidate.is_one_surface();
        let score = side.rated_q8(model)
            + model.coefficient_q8(SegmentKind::Distance) * (i32::from(self.distance) - 1)
            + if next_to_edge { model.coefficient_q8(SegmentKind::NextToEdge) } else { 0 };
        self.probability = as_listed(model.probability_q16(score));
        if !side.rejected && self.probability >= self.least {
            self.pixels = candidate.side_pixels(self.side, self.distance);
        }
    }
}

impl Iterator for Points<'_> {
    type Item = Point;

    #[inline(never)] // for each point, in whatever crate it is used
    fn next(&mut self) -> Option<Point> {
        let point = self.of_grid().or_else(|| self.of_bar()).or_else(|| self.of_side())?;
        let (word, bit) = self.mark(point.x, point.y);
        if let Some(word) = self.marks.get_mut(word) {
            *word |= bit;
        }
        Some(point)
    }
}

/// Probability of a pixel that is listed as a side's: that of the side, or, below
/// [`LEFT_OVER_Q16`], half as far again below it; `docs/experiments.md` says how often they are
/// right.
fn as_listed(probability_q16: u16) -> u16 {
    probability_q16.saturating_sub(LEFT_OVER_Q16.saturating_sub(probability_q16) / 2)
}

/// Sets the probability of every side, at its first pixel, and of the edge itself.
fn rate(candidate: &mut Candidate, models: &Models) {
    let near_horizontal = candidate.segment.near_horizontal;
    let (model, edge_model) = (models.side(near_horizontal), &models.edge(near_horizontal).model);
    for side in candidate.sides.iter_mut().flatten() {
        side.probability_q16 = model.probability_q16(side.rated_q8(model));
        side.edge_probability_q16 = edge_model.probability_q16(side.edge_rated_q8(edge_model));
    }
}

impl Side {
    /// The ends and the middle of its segment, with its disparity.
    pub(crate) fn three_points(&self, segment: &Segment) -> [Point; 3] {
        let (x0, y0, x1, y1) = segment.ends_q5();
        let [d0, d1] = self.disparity_q6.map(i32::from);
        let of = |x_q5: i32, y_q5: i32, d_q6: i32| {
            let whole = |q5: i32| u16::try_from(q5 >> 5).unwrap_or(0);
            Point {
                x: whole(x_q5),
                y: whole(y_q5),
                disparity: disparity_from_q6(d_q6),
                confidence: Confidence::from_bits(self.probability_q16),
                source: Source::Side,
            }
        };
        let middle = of((x0 + x1) / 2, (y0 + y1) / 2, (d0 + d1) / 2);
        [of(x0, y0, d0), middle, of(x1, y1, d1)]
    }

    /// Log-odds of its first pixel, neighbours included, Q8.
    fn rated_q8(&self, model: &Model) -> i32 {
        let score = model.with_nearby_q8(self.score_q8, self.nearby);
        narrow(score + model.coefficient_q8(SegmentKind::Distance)).into()
    }

    /// Probability that the edge itself has this side's disparity, Q16; 0 where the other side is
    /// nearer.
    fn edge_rating(&self) -> u16 {
        if self.is_behind { 0 } else { self.edge_probability_q16 }
    }

    /// Log-odds of the edge itself, neighbours included, Q8.
    fn edge_rated_q8(&self, edge_model: &Model) -> i32 {
        narrow(edge_model.with_nearby_q8(self.edge_score_q8, self.nearby)).into()
    }
}

fn to_match(candidate: &Candidate, params: &Params, models: &Models) -> Option<Match> {
    let side = candidate.edge_side()?;
    let disparity_q6 = side.disparity_q6;
    let edge_model = models.edge(candidate.segment.near_horizontal);
    let score_q8 = side.edge_rated_q8(&edge_model.model);
    let sigma = disparity_from_q6(edge_model.sigma_q6(score_q8).into());
    let mut found = Match {
        ends: candidate.segment.ends,
        disparity: disparity_q6.map(Disparity::from_bits),
        sigma,
        confidence: Confidence::from_bits(side.edge_probability_q16),
        owner: candidate.owner()?,
        depth: None,
        depth_sigma: None,
        techniques: Techniques {
            feature: candidate.feature_q6.map(Disparity::from_bits),
            window: Disparity::from_bits(candidate.window_q6),
            census: Disparity::from_bits(candidate.census_q6),
        },
    };
    orient(&mut found, candidate.segment.near_horizontal);
    if let Some(rig) = params.rig {
        found.depth = Some(found.disparity.map(|d| rig.depth(d)));
        found.depth_sigma = Some(found.disparity.map(|d| rig.depth_sigma(d, sigma)));
    }
    Some(found)
}

/// Converts a match to the convention of [`Match`] and [`Owner`], near-horizontal for |dx| > 4
/// |dy|; the matcher's own limit is near |dx| = |dy|.
fn orient(found: &mut Match, drawn_along_columns: bool) {
    let [a, b] = found.ends;
    let dx = i32::from(b.x.to_bits()) - i32::from(a.x.to_bits());
    let dy = i32::from(b.y.to_bits()) - i32::from(a.y.to_bits());
    if !drawn_along_columns || dx.abs() > 4 * dy.abs() {
        return;
    }
    // On a segment that falls to the right, the side above is the side to the right.
    found.owner = match found.owner {
        Owner::Left if dy > 0 => Owner::Right,
        Owner::Right if dy > 0 => Owner::Left,
        owner => owner,
    };
    if dy < 0 {
        found.ends.reverse();
        found.disparity.reverse();
    }
}

impl Candidate {
    /// The side, among those not rejected, with the highest rating.
    fn best(&self, rating: impl Fn(&Side) -> u16) -> Option<&Side> {
        let [left, right] = self.sides.each_ref().map(|side| side.as_ref().filter(|s| !s.rejected));
        match (left, right) {
            (Some(l), Some(r)) => Some(if rating(r) > rating(l) { r } else { l }),
            (one, other) => one.or(other),
        }
    }

    /// Becomes the edge of a bar, whose side owns it. What the other side is stays; the pixels on
    /// the bar are listed as the bar's.
    fn become_edge(&mut self, bar: &Bar, edge: Edge, ends_q6: [i16; 2]) {
        let middle_q6 = narrow((i32::from(ends_q6[0]) + i32::from(ends_q6[1])) >> 1);
        (self.window_q6, self.census_q6) = (middle_q6, middle_q6);
        self.feature_q6 = Some(middle_q6);
        let right = self.segment.right_side();
        let inner = if edge == Edge::Left { right } else { 1 - right };
        let any = self.sides.iter().flatten().next().cloned();
        for (index, side) in self.sides.iter_mut().enumerate() {
            if index == inner {
                let probability_q16 = bar.confidence().to_bits();
                *side = any.clone().map(|any| Side {
                    disparity_q6: ends_q6,
                    score_q8: i16::MIN,
                    edge_score_q8: narrow(bar.score_q8()),
                    nearby: NearbyEvidence::default(),
                    probability_q16,
                    edge_probability_q16: probability_q16,
                    rejected: false,
                    is_behind: false,
                    ..any
                });
            } else if let Some(side) = side {
                side.is_behind = true;
            }
        }
    }

    /// The side whose disparity is the most probable one of the edge itself.
    fn edge_side(&self) -> Option<&Side> {
        self.best(Side::edge_rating)
    }

    /// Reason why its segment has no match in the run that it comes from; `None` when it has one.
    #[must_use]
    pub fn rejection(&self) -> Option<Rejection> {
        match (self.listed, self.edge_side()) {
            (Some(_), _) => None,
            (None, Some(_)) => Some(Rejection::EdgeUnclear),
            (None, None) if self.violates_uniqueness => Some(Rejection::NotUnique),
            (None, None) => Some(Rejection::LowConfidence),
        }
    }

    fn owner(&self) -> Option<Owner> {
        let [left, right] = self.sides.each_ref().map(|side| side.as_ref().filter(|s| !s.rejected));
        match (left, right) {
            (Some(l), Some(r)) => {
                let better =
                    |right: u16, left: u16| if right > left { Owner::Right } else { Owner::Left };
                Some(if !self.is_one_surface() {
                    better(r.edge_rating(), l.edge_rating())
                } else if l.probability_q16.min(r.probability_q16) < BOTH_SIDES_Q16 {
                    better(r.probability_q16, l.probability_q16)
                } else {
                    Owner::Both
                })
            }
            (Some(_), None) => Some(Owner::Left),
            (None, Some(_)) => Some(Owner::Right),
            (None, None) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_that_are_left_over_are_listed_as_less_probable() {
        for (side, listed) in
            [(65_535, 65_535), (58_982, 58_982), (58_980, 58_979), (52_428, 49_151)]
        {
            assert_eq!(as_listed(side), listed);
        }
        // The order of sides stays.
        let listed: [u16; 256] = core::array::from_fn(|i| as_listed(i as u16 * 257));
        assert!(listed.is_sorted() && listed[0] == 0);
    }
}
