//! Bars: poles, legs and stands 2 to 14 px wide, whose two edges are matched as one feature.
//!
//! In: all segments of the left image that run down the rows, both images, support points.
//! Out: [`Bar`]s, each with one line of disparity and its probability: in front of the support
//! points around them, or level with them, as a stripe is, or a pole whose disparity the windows of
//! these points took. The former are told as bars. The pixels of these and of long level ones are
//! points; of short level ones the middle of each row is.
//!
//! ```text
//! edges:       beside a segment, along its rows, an edge 2 to 14 px off: width and two signs
//! keep:        the strongest ones, each once
//! repeating:   areas in which five and more of them stand at equal distances
//! cost:        the bar and 1 px beyond both edges, at every disparity, its halves up to 2 px apart
//! repetition:  the same bar elsewhere in the left image: refused
//! place:       support points that do not see the bar lie behind it, on both sides
//! rating:      evidence -> probability
//! grow:        along the bar's line while both edges stand in the left image and match
//! ```
//! A window is as wide as the bar: those of support points and of segments are wider than what is
//! thin, and see the surface behind it.
//!
//! # Bounds
//! At most [`MOST_BARS`] bars of a pair, 24 bytes each; [`MOST_MATCHED`] of them are matched.
//! Positions Q5 below 2^16, slopes at most 2 in Q12. Eight rows of at most 24 columns of gradients
//! that differ by at most 62: a cost is below 2^14.
//!
//! # Cost
//! Some 13 % of the instructions of a QVGA pair: half of them to find bars, most others to match
//! them.
//!
//! # Source
//! Opposite edges as one feature: antiparallel lines (Nevatia, Babu 1980). Its own.

mod cost;
mod edges;
pub(crate) mod evidence;
mod fitted;
mod grow;
mod keep;
mod mask;
mod place;
mod points;
mod region;
mod repeating;
mod repetition;

pub use fitted::{FITTED_BAR, FITTED_LEVEL_BAR};
pub(crate) use grow::grow;
pub(crate) use mask::MaskMatcher;
pub(crate) use points::take_points;
pub(crate) use region::{depth_of, most_pixels};
pub(crate) use repeating::Repeating;

use crate::area::Area;
use crate::confidence::SigmaModel;
use crate::cores::Cores;
use crate::image::{Dims, Gray};
use crate::lines::Segment;
use crate::list::List;
use crate::matching::band::Band;
use crate::matching::{MatchContext, Workspace};
use crate::result::{ImagePosition, Point, Source};
use crate::sort::sort_by_key;
use crate::support::Support;
use crate::units::{Confidence, Disparity, Position, disparity_from_q6, narrow, quotient};
use evidence::BarEvidence;
use keep::{Found as _, Kept};

/// Least probability of a bar that is told, whatever that of points is: it goes before these. 0.9.
pub const LEAST_BAR: Confidence = Confidence::from_bits(0xe666);

/// Most bars of a pair: of those found, and later of those matched with the parts by which they are
/// grown.
pub const MOST_BARS: usize = 48;
/// Most bars that are matched, the strongest ones: about as many as of 32 are no doubles.
const MOST_MATCHED: usize = 28;

/// The pixels right of the left edge are the brighter ones.
const LEFT_RISING: u8 = 1;
/// The pixels right of the right edge are the brighter ones.
const RIGHT_RISING: u8 = 2;
/// It has a disparity.
const MATCHED: u8 = 4;
/// It is left out.
const DROPPED: u8 = 8;
/// A part that others were grown by.
const GROWN: u8 = 16;
/// It is in front of the support points around it.
const FRONT: u8 = 32;
/// It lies where bars repeat.
const AMID: u8 = 64;

/// Width, 1/32 px, up to which all pixels between the edges are the bar's.
const NARROW_Q5: i32 = 80;
/// Distance from both edges of the pixels of a wider one, 1/32 px.
const INNER_Q5: i32 = 13;
/// Width, 1/32 px, from which on that distance is [`WIDE_INNER_Q5`].
const WIDE_Q5: i32 = 128;
/// Distance from both edges where a bar has pixels to spare, 1/32 px.
const WIDE_INNER_Q5: i32 = 24;

/// Fewest rows of a bar level with what is around it, for all of its pixels to be points and for it
/// to be grown; `docs/experiments.md` has others.
const LEAST_LEVEL_ROWS: i32 = 14;

/// A thin thing of the left image, between two edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Bar {
    /// Left edge at the first row, 1/32 px.
    x_q5: u16,
    /// First and last row.
    rows: [u16; 2],
    /// dx/dy of both edges, Q12.
    slope_q12: i16,
    /// From the left to the right edge, along a row, 1/32 px.
    width_q5: u16,
    /// At the first and the last row, 1/64 px.
    disparity_q6: [i16; 2],
    /// Log-odds of a bar in front, and of one level with what is around it, Q8.
    scores_q8: [i16; 2],
    probability_q16: u16,
    /// Mean gradients of the edge that it was found at and of the other one, 1/8.
    strengths_q3: [u8; 2],
    /// Sum of the other edge's gradients against that of their magnitudes, Q8.
    coherence_q8: u8,
    flags: u8,
}

/// One of the two edges of a bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Edge {
    Left,
    Right,
}

impl Bar {
    /// Ends of its left edge, top first.
    #[must_use]
    pub fn ends(&self) -> [ImagePosition; 2] {
        self.rows.map(|row| {
            let x = u16::try_from(self.x_at_q5(row.into())).unwrap_or(0);
            ImagePosition { x: Position::from_bits(x), y: Position::from_bits(row << 5) }
        })
    }

    /// Its middle at the first, the middle and the last row.
    pub(crate) fn three_points(&self) -> [Point; 3] {
        let [first, last] = self.rows;
        [first, u16::midpoint(first, last), last].map(|y| {
            let columns = self.columns(y);
            Point {
                x: u16::midpoint(columns.start, columns.end),
                y,
                disparity: disparity_from_q6(self.disparity_at_q6(y.into())),
                confidence: self.confidence(),
                source: Source::Side,
            }
        })
    }

    /// From its left to its right edge, along a row, px.
    #[must_use]
    pub fn width(&self) -> Position {
        Position::from_bits(self.width_q5)
    }

    /// First and last row, px.
    #[must_use]
    pub fn rows(&self) -> [u16; 2] {
        self.rows
    }

    /// Disparity at its first and at its last row, px.
    #[must_use]
    pub fn disparity(&self) -> [Disparity; 2] {
        self.disparity_q6.map(Disparity::from_bits)
    }

    /// Probability that the disparity is within 1 px.
    #[must_use]
    pub fn confidence(&self) -> Confidence {
        Confidence::from_bits(self.probability_q16)
    }

    /// Standard deviation of the disparity, px.
    #[must_use]
    pub fn sigma(&self) -> Disparity {
        let [front, level] = self.scores_q8;
        let (model, score) =
            if self.is_in_front() { (&FITTED_BAR, front) } else { (&FITTED_LEVEL_BAR, level) };
        disparity_from_q6(model.sigma_q6(score.into()).into())
    }

    /// True when it is in front of the support points around it.
    #[must_use]
    pub fn is_in_front(&self) -> bool {
        self.is(FRONT)
    }

    /// True when all of its pixels are points, and it is grown: in front of what is around it, or
    /// long.
    fn is_prominent(&self) -> bool {
        self.is_in_front() || self.height() >= LEAST_LEVEL_ROWS
    }

    /// Columns of its pixels at a row.
    #[must_use]
    pub fn columns(&self, y: u16) -> core::ops::Range<u16> {
        let y = i32::from(y);
        let [first, last] = self.first_and_last();
        if !(first..=last).contains(&y) {
            return 0..0;
        }
        let (x, width) = (self.x_at_q5(y), i32::from(self.width_q5));
        let inner = match width {
            ..=NARROW_Q5 => 0,
            WIDE_Q5.. => WIDE_INNER_Q5,
            _ => INNER_Q5,
        };
        let start = (x + inner + 31) >> 5;
        let end = ((x + width - inner) >> 5).max(start) + 1;
        let column = |at: i32| u16::try_from(at).unwrap_or(0);
        column(start)..column(end)
    }

    /// Columns of a row that are listed as points: its pixels; the middle one of a short bar level
    /// with what is around it.
    pub(crate) fn listed_columns(&self, y: u16) -> core::ops::Range<u16> {
        let columns = self.columns(y);
        if self.is_prominent() || columns.is_empty() {
            return columns;
        }
        let middle = u16::midpoint(columns.start, columns.end);
        middle..middle + 1
    }

    /// Disparity at a row, on its line, 1/64 px.
    pub(crate) fn disparity_at_q6(&self, y: i32) -> i32 {
        let [from, to] = self.disparity_q6.map(i32::from);
        let [first, last] = self.first_and_last();
        from + quotient((to - from) * (y - first), last - first)
    }

    /// Disparity at the nearest of its rows, 1/64 px.
    fn disparity_nearest_q6(&self, y: i32) -> i32 {
        let [first, last] = self.first_and_last();
        self.disparity_at_q6(y.max(first).min(last))
    }

    /// True when a disparity at this row, 1/64 px, lies more than 1 px behind it.
    pub(crate) fn hides(&self, y: i32, d_q6: i32) -> bool {
        d_q6 < self.disparity_at_q6(y) - 64
    }

    /// Column of the left edge at a row, 1/32 px.
    pub(crate) fn x_at_q5(&self, y: i32) -> i32 {
        i32::from(self.x_q5)
            + (((y - i32::from(self.rows[0])) * i32::from(self.slope_q12) + 64) >> 7)
    }

    /// Nearest column to the left edge at a row.
    fn column(&self, y: i32) -> i32 {
        (self.x_at_q5(y) + 16) >> 5
    }

    fn first_and_last(&self) -> [i32; 2] {
        self.rows.map(i32::from)
    }

    fn middle_row(&self) -> i32 {
        let [first, last] = self.first_and_last();
        (first + last) >> 1
    }

    /// Disparity at its middle row, 1/64 px.
    fn middle_q6(&self) -> i32 {
        self.disparity_at_q6(self.middle_row())
    }

    /// Number of rows.
    fn height(&self) -> i32 {
        let [first, last] = self.first_and_last();
        last - first + 1
    }

    /// Smallest and largest column of its left edge.
    fn reach(&self) -> (i32, i32) {
        let [a, b] = self.first_and_last().map(|y| self.column(y));
        (a.min(b), a.max(b))
    }

    /// Signs of the left and of the right edge.
    fn signs(&self) -> [i32; 2] {
        [LEFT_RISING, RIGHT_RISING].map(|bit| if self.flags & bit != 0 { 1 } else { -1 })
    }

    /// True when it could be compared: it has a disparity, credible or not.
    fn is_compared(&self) -> bool {
        self.disparity_q6 != [0; 2]
    }

    fn is(&self, flag: u8) -> bool {
        self.flags & flag != 0
    }

    /// Extent times the weaker edge: how prominent it is.
    fn strength(&self) -> u32 {
        let [own, other] = self.strengths_q3;
        self.height().unsigned_abs() * u32::from(own.min(other))
    }

    /// The segment along its left edge, for the band of rows.
    pub(crate) fn edge(&self) -> Segment {
        Segment {
            ends: self.ends(),
            rising: self.is(LEFT_RISING),
            contrast: 0,
            near_horizontal: false,
        }
    }

    /// Bounding box, px.
    fn area(&self) -> Area {
        let (left, right) = self.reach();
        let right = right + ((i32::from(self.width_q5) + 31) >> 5) + 1;
        let [top, last] = self.rows;
        let column = |at: i32| u16::try_from(at).unwrap_or(0);
        Area { left: column(left), top, right: column(right), bottom: last + 1 }
    }

    /// Log-odds in front, Q8.
    pub(crate) fn score_q8(&self) -> i32 {
        self.scores_q8[0].into()
    }

    /// The edge that this segment runs along, if it is one of them.
    pub(crate) fn edge_of(&self, segment: &Segment) -> Option<Edge> {
        let (x0, y0, x1, y1) = segment.ends_q5();
        let [first, last] = self.first_and_last();
        if !(first..=last).contains(&((y0 + y1) >> 6)) {
            return None;
        }
        let off = |x: i32, y: i32, at: i32| (x - self.x_at_q5(y >> 5) - at).abs() <= EDGE_Q5;
        let is_along = |at: i32| off(x0, y0, at) && off(x1, y1, at);
        if is_along(0) {
            Some(Edge::Left)
        } else if is_along(self.width_q5.into()) {
            Some(Edge::Right)
        } else {
            None
        }
    }
}

/// Largest distance of a segment's ends from an edge that it is, 1/32 px.
const EDGE_Q5: i32 = 48;

/// Finds the bars beside all segments of the left image: the strongest ones, by their first row.
/// Returns where they repeat.
#[inline(never)] // its variables are on the stack only while it runs
pub(crate) fn find(image: Gray<'_>, segments: &[Segment], bars: &mut List<'_, Bar>) -> Repeating {
    let mut kept = Kept::new(bars);
    let least = edges::least_strength(segments);
    for segment in segments.iter().filter(|segment| edges::strength(segment) >= least) {
        edges::keep_beside(image, segment, &mut kept);
    }
    settle(bars, image.dims())
}

/// As [`find`], while a second core does its `other` work; after that it finds the bars beside some
/// of the last segments, in `spare`.
pub(crate) fn find_on(
    cores: &mut dyn Cores,
    image: Gray<'_>,
    segments: &[Segment],
    bars: &mut List<'_, Bar>,
    spare: &mut List<'_, Bar>,
    mut other: impl FnMut() + Send,
) -> Repeating {
    let least = edges::least_strength(segments);
    let is_strong = |segment: &&Segment| edges::strength(segment) >= least;
    let (strong, flat) = segments.iter().fold((0, 0), |(strong, flat), segment| {
        (strong + i32::from(is_strong(&segment)), flat + i32::from(segment.near_horizontal))
    });
    // Its other work is in proportion to the edges along the columns.
    let share = ((strong - SCANS - quotient(flat, FLAT_FOR_STRONG)) / 2).max(0) as usize;
    let first = segments.iter().enumerate().rev().filter(|(_, segment)| is_strong(segment));
    let at = first.take(share).last().map_or(segments.len(), |(index, _)| index);
    let (here, there) = segments.split_at_checked(at).unwrap_or((segments, &[]));
    let mut kept = Kept::new(bars);
    spare.clear();
    let mut seen = 0;
    cores.join(
        &mut || {
            for segment in here.iter().filter(is_strong) {
                edges::keep_beside(image, segment, &mut kept);
            }
        },
        &mut || {
            other();
            for segment in there {
                if spare.capacity() - spare.len() < edges::MOST_BESIDE {
                    break;
                }
                if is_strong(&segment) {
                    edges::keep_beside(image, segment, spare);
                }
                seen += 1;
            }
        },
    );
    for &bar in spare.iter() {
        kept.insert(bar);
    }
    for segment in there.iter().skip(seen).filter(is_strong) {
        edges::keep_beside(image, segment, &mut kept);
    }
    settle(bars, image.dims())
}

/// Leaves the strongest bars, sorted by the first row; returns where those found repeat.
fn settle(bars: &mut List<'_, Bar>, dims: Dims) -> Repeating {
    keep::leave_out_doubles(bars);
    let repeating = Repeating::mark(bars, dims);
    bars.truncate(MOST_MATCHED);
    sort_by_key(bars, |bar| (bar.rows[0], bar.x_q5, bar.width_q5));
    repeating
}

/// Segments along the columns, whose edges cost as much in the right image as the bars beside a
/// strong one.
const FLAT_FOR_STRONG: i32 = 5;
/// Strong segments for the scans of that image.
const SCANS: i32 = 15;

/// Matches a bar whose rows the band holds; it stays without disparity where it cannot be compared
/// or repeats. Returns its evidence, that by support points left out.
#[inline(never)] // its variables are on the stack only while it runs
pub(crate) fn match_bar(
    bar: &mut Bar,
    context: &MatchContext<'_>,
    band: &Band<'_>,
    work: &mut Workspace,
    least: Confidence,
) -> Option<BarEvidence> {
    let found = cost::search(bar, context, band, &mut work.curves)?;
    let mut evidence = BarEvidence::new();
    bar.set_line(&found);
    evidence::of_cost(bar, &found, &mut evidence);
    evidence::of_edges(bar, band, &mut evidence);
    let models = [&FITTED_BAR.model, &FITTED_LEVEL_BAR.model];
    if !evidence::is_promising(&evidence, models, least) {
        return None;
    }
    repetition::look_for(bar, &found, context, band, &mut work.curves, &mut evidence)?;
    bar.scores_q8 = models.map(|model| narrow(model.score_q8(&evidence.0)));
    bar.flags |= MATCHED;
    Some(evidence)
}

/// Steepest line of disparity along a bar, px per row in Q10: 0.12.
const STEEPEST_Q10: i32 = 123;

impl Bar {
    /// The line of disparity through those of its halves.
    fn set_line(&mut self, found: &cost::Found) {
        let [upper, lower] = found.halves_q6;
        let apart = (found.centres_q1[1] - found.centres_q1[0]).max(8);
        let slope_q10 = quotient((lower - upper) << 11, apart) >> 6;
        let slope_q10 =
            if slope_q10.abs() < STEEPEST_Q10 && found.is_straight { slope_q10 } else { 0 };
        let middle = self.middle_row();
        let at = |y: i32| narrow(found.disparity_q6 + (((y - middle) * slope_q10) >> 4));
        self.disparity_q6 = self.first_and_last().map(at);
    }
}

/// Rates every matched bar by its evidence and by the support points around it. Those with at
/// least this probability stay, in front of the points and level with them. Calls `watch` with the
/// index, the bar, and its evidence by support points.
#[inline(never)] // its variables are on the stack only while it runs
pub(crate) fn rate(
    bars: &mut List<'_, Bar>,
    support: Support<'_>,
    least: Confidence,
    mut watch: impl FnMut(usize, &Bar, [i16; 4]),
) {
    for (index, bar) in bars.iter_mut().enumerate().filter(|(_, bar)| bar.is(MATCHED)) {
        if let Some(nearby_q8) = rate_bar(bar, support) {
            watch(index, bar, nearby_q8);
        }
    }
    bars.retain(|bar| bar.is(MATCHED) && bar.probability_q16 >= least.to_bits());
}

/// Rates a matched bar by the support points around it. Returns their evidence; none where the bar
/// lies behind them, and is not rated.
fn rate_bar(bar: &mut Bar, support: Support<'_>) -> Option<[i16; 4]> {
    let around = place::around(bar, support);
    let SigmaModel { model, .. } = if around.is_in_front { &FITTED_BAR } else { &FITTED_LEVEL_BAR };
    bar.scores_q8 = bar.scores_q8.map(|score| {
        narrow(i32::from(score) + evidence::score_nearby_q8(model, around.evidence_q8))
    });
    bar.flags |= if around.is_in_front { FRONT } else { 0 };
    let [front, level] = bar.scores_q8;
    if around.is_behind {
        return None;
    }
    let score = if around.is_in_front { front } else { level };
    bar.probability_q16 = model.probability_q16(score.into());
    Some(around.evidence_q8)
}

/// Sorts bars so that those in front are the first.
pub(crate) fn sort(bars: &mut List<'_, Bar>) {
    sort_by_key(bars, |bar| (!bar.is_in_front(), bar.rows, bar.x_q5, bar.width_q5));
}

/// The bars in front of what is around them, of a sorted list.
pub(crate) fn in_front(bars: &[Bar]) -> &[Bar] {
    bars.get(..bars.partition_point(Bar::is_in_front)).unwrap_or(&[])
}
