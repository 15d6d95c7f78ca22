//! Sparse grid of support points, matched semi-globally: the surfaces between edges, and the
//! disparities at which segments are searched.
//!
//! In: both images, a row offset, a range of disparities. Out: for each point of the grid a
//! disparity, 1/64 px, and the probability of being within 1 px.
//!
//! ```text
//! noise:   its deviation, and where it was removed, by the flattest runs of pixels of both images
//!          (noise)
//! codes:   of each two rows, the changes to the right and downward, in units of the noise  (codes)
//! costs:   1/64 of the sum of |code - code| over 8 columns of four rows of codes, at each
//!          disparity
//! paths:   L(p, d) = C(p, d) + min(L(p', d), L(p', d +- 1) + P1, min L(p') + P2) - min L(p')  from
//!          the left, from the right, from above (paths)
//! result:  the lowest sum of the three; sub-pixel by the window's own cost; evidence  (evidence)
//! place:   the middle of the window's texture, which was matched  (place)
//! fine:    images wider than 450 px are matched at half of their size, then around what is known
//!          from it  (fine)
//! rating:  probability, with the evidence by the eight neighbours and by segments nearby
//! unique:  in these images, of two points that match one place the nearer is rejected, unless it is
//!          clearly more probable  (unique)
//! list:    2 px off the texture where that is the border of the surface  (listed), with a
//!          probability among what the neighbours' log-odds are  (context), and by how alike both
//!          images are there  (likeness)
//! ```
//!
//! # Bounds
//! Codes are bytes: a cost is at most 32 * 255 / 64 = 127, a path 127 + P2 = 147: bytes; the sum of
//! three saturates at 255.
//!
//! # Cost
//! Linear in the points and in the disparities. Of the cost volume one row of points is held, three
//! planes.
//!
//! # Source
//! Hirschmueller 2008 (semi-global matching); codes are differences as of Sobel 1968, limited as in
//! Birchfield, Tomasi 1998.

mod codes;
pub(crate) mod context;
pub(crate) mod evidence;
mod fine;
mod fitted;
mod grid;
mod likeness;
mod listed;
mod nearer;
mod noise;
mod paths;
mod place;
mod plane;
mod points;
mod row;
mod unique;

pub use fitted::FITTED_SUPPORT;
pub(crate) use grid::{Grid, most_support_points};
pub(crate) use likeness::Likeness;
pub use nearer::RangeCheck;
pub use noise::Noise;
pub use points::Support;

use crate::area::Area;
use crate::confidence::{Model, Network};
use crate::cores::{Cores, lend};
use crate::ground::GroundPlane;
use crate::image::{Gray, Span};
use crate::kernel::JUMP_PENALTY;
use crate::list::List;
use crate::units::{Confidence, Disparity, narrow};
use codes::{BORDER, CodeRows, WINDOW_COLUMNS};
use context::CONTEXT_EVIDENCE;
use core::ops::Range;
use evidence::{Found, SUPPORT_EVIDENCE, SupportEvidence, TYPICAL_DETAIL_Q8, nearby};
use paths::{MAX_COLUMNS, Paths, PointCosts};
use place::Place;
use plane::PlaneLabels;
use row::{Row, RowPart, Sums};

/// Distance from one support point to the next, across and down, px.
pub const SUPPORT_PITCH: u16 = 8;
/// Cost where the window leaves the valid part of the right image: a quarter of the largest, and P2
/// as all costs.
const OUTSIDE: u8 = 32 + JUMP_PENALTY;
/// Least [`SupportPoint::uniqueness_q8`] of a point that guides the search of segments, log2 in Q8.
const UNIQUE_Q8: u8 = 32;
/// Distance from a segment up to which points guide its search, px.
const GUIDE_REACH: i32 = 12;
/// Distance from a segment within which half of the points have to reach that uniqueness, px.
const UNIQUE_REACH: i32 = 6;
/// Distance around an area in which points are matched with it, px: those within it say whether an
/// object's surface is its own.
pub(crate) const SURROUNDINGS: u16 = 24;
/// Least number of disparities compared at a point: with fewer there is no second-best.
const MIN_RANGE: usize = 8;

/// In place of the disparity of a point whose window repeats, 1/64 px.
const REPEATS_Q6: i16 = i16::MIN;

/// In place of the log-odds of a point that has the disparity of a bar, Q8.
const OF_BAR_Q8: i16 = i16::MAX;
/// Least and largest log-odds of a point, Q8.
const LEAST_Q8: i16 = i16::MIN + 1;
const MOST_Q8: i16 = OF_BAR_Q8 - 1;

/// One point of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SupportPoint {
    /// Disparity, 1/64 px.
    pub(crate) disparity_q6: i16,
    /// Log-odds, Q8: by its own evidence, with that by its neighbours once it is rated;
    /// [`i16::MIN`] when it has no disparity.
    pub(crate) score_q8: i16,
    /// Probability of being within 1 px, Q16, with the evidence by its neighbours.
    pub(crate) probability_q16: u16,
    /// Uniqueness, log2(second-best / best) of the paths' sum or of its own window, the smaller,
    /// Q8, 0 ..= 255: its weight as a neighbour.
    pub(crate) uniqueness_q8: u8,
    /// Where in its square of the grid it stands.
    pub(crate) place: Place,
    /// Weights of the hypotheses of segments around it that agree and that contradict, 0 ..= 255.
    pub(crate) segments: [u8; 2],
}

impl SupportPoint {
    /// A matched point.
    #[cfg(test)]
    pub(crate) const fn matched(disparity_q6: i16, probability_q16: u16) -> Self {
        Self { disparity_q6, score_q8: 0, probability_q16, ..Self::none() }
    }

    /// A point without a disparity.
    #[inline]
    pub(crate) const fn none() -> Self {
        Self {
            disparity_q6: 0,
            score_q8: i16::MIN,
            probability_q16: 0,
            uniqueness_q8: 0,
            place: Place::MIDDLE,
            segments: [0; 2],
        }
    }

    /// True when it has a disparity.
    #[must_use]
    pub fn is_matched(&self) -> bool {
        self.score_q8 > i16::MIN
    }

    /// True when its own window is unique enough to guide others.
    pub(crate) fn is_unique(&self) -> bool {
        self.uniqueness_q8 >= UNIQUE_Q8
    }

    /// Takes the disparity of the bar that it lies on, 1/64 px.
    pub(crate) fn take_bar(&mut self, disparity_q6: i16, confidence: Confidence) {
        self.disparity_q6 = disparity_q6;
        self.score_q8 = OF_BAR_Q8;
        self.probability_q16 = confidence.to_bits();
    }

    /// True when it has the disparity of a bar: its own window says nothing of that.
    #[must_use]
    pub fn is_of_bar(&self) -> bool {
        self.score_q8 == OF_BAR_Q8
    }

    /// True when its disparity was found beside the ground plane, along which its window was moved
    /// row by row.
    #[must_use]
    pub fn is_beside_ground(&self) -> bool {
        self.is_matched() && self.place.is_on_plane()
    }

    /// True when it lies beside the ground plane by its neighbours alone: its own window matches
    /// elsewhere nearly as well. Blank floor is like this, and so is the blank side of a box on it,
    /// which paths cross from the floor on its left to that on its right.
    pub(crate) fn is_ground_by_paths(&self) -> bool {
        self.is_beside_ground() && !self.is_unique() && !self.is_of_bar()
    }

    /// A point without a disparity, since its window matches elsewhere as well.
    pub(crate) const fn repeated() -> Self {
        Self { disparity_q6: REPEATS_Q6, ..Self::none() }
    }

    /// True when it has none because its window matches elsewhere as well.
    #[must_use]
    pub fn repeats(&self) -> bool {
        !self.is_matched() && self.disparity_q6 == REPEATS_Q6
    }

    /// Disparity of the surface seen there, px.
    #[must_use]
    pub fn disparity(&self) -> Disparity {
        Disparity::from_bits(self.disparity_q6)
    }

    /// Probability of being within 1 px.
    #[must_use]
    pub fn confidence(&self) -> Confidence {
        Confidence::from_bits(self.probability_q16)
    }
}

/// Costs of a support point over disparity. Entries fall from the largest disparity on, 1 px each.
#[derive(Clone, Copy, Debug)]
pub struct SupportCurves<'a> {
    /// Disparity of the first entry, px.
    pub largest: i32,
    /// Costs of the window alone, before aggregation, 0 ..= 127.
    pub window: &'a [u8],
    /// Sums of the three semi-global paths, after aggregation.
    pub paths: &'a [u8],
}

impl<'a> SupportCurves<'a> {
    /// Curves over the indices in `range`, where the window lies on valid pixels; `last` is the
    /// disparity of index 0. The window's entries hold P2 as well ([`OUTSIDE`]).
    fn new(costs: &'a PointCosts<'_>, range: Range<usize>, last: i32) -> Self {
        let largest = last - range.start as i32;
        let of = |costs: &'a [u8]| costs.get(range.clone()).unwrap_or(&[]);
        Self { largest, window: of(costs.costs), paths: of(costs.sums) }
    }
}

/// Costs or evidence of a support point, for observers.
pub(crate) enum Seen<'a> {
    Curves(SupportCurves<'a>),
    Evidence(&'a SupportEvidence),
}

/// Models for the probability of support points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SupportModels {
    /// In pairs without a ground plane.
    pub upright: Model<SUPPORT_EVIDENCE>,
    /// In pairs with one.
    pub ground: Model<SUPPORT_EVIDENCE>,
    /// At the size of images that are matched at half of it first.
    pub fine: Model<SUPPORT_EVIDENCE>,
    /// Of points in the list of points, among neighbours that have log-odds by these. Of points
    /// that are matched at half of the size first only without a ground plane, beside `fine`.
    pub context: Network<CONTEXT_EVIDENCE>,
}

impl SupportModels {
    /// Of points at the only size, or at half of it.
    pub(crate) const fn of(&self, has_plane: bool) -> &Model<SUPPORT_EVIDENCE> {
        if has_plane { &self.ground } else { &self.upright }
    }

    /// Of the points of a grid.
    pub(crate) const fn of_size(
        &self,
        is_large: bool,
        has_plane: bool,
    ) -> &Model<SUPPORT_EVIDENCE> {
        if is_large { &self.fine } else { self.of(has_plane) }
    }
}

/// A pair and the grid of points that is matched in it.
pub(crate) struct Matching<'a> {
    pub(crate) images: [Gray<'a>; 2],
    pub(crate) grid: Grid,
    /// Grid of the halves of the images, where these are matched first.
    pub(crate) half: Option<Grid>,
    /// Row of the right image that matches row 0 of the left one.
    pub(crate) row_offset: i32,
    /// The larger numbers of both images.
    pub(crate) noise: Noise,
    pub(crate) plane: Option<GroundPlane>,
    pub(crate) models: &'a SupportModels,
    /// Costs are watched as well.
    pub(crate) wants_curves: bool,
}

/// Found over all points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Overall {
    /// Detail of the left image, [`SupportKind::Detail`](evidence::SupportKind::Detail), Q8.
    pub(crate) detail_q8: i16,
    /// Windows that match beyond the range.
    pub(crate) range: RangeCheck,
}

impl Matching<'_> {
    /// Matches all points, or those in and around these areas, in `memory` of [`Grid::bytes`].
    /// Fills `points` with one per point of the grid, row by row; calls `watch` with the index and
    /// the costs of each, then with the evidence, neighbours left out, of each that has a
    /// disparity.
    pub(crate) fn run(
        &self,
        areas: Option<&[Area]>,
        mut cores: Option<&mut dyn Cores>,
        memory: &mut [u8],
        points: &mut List<'_, SupportPoint>,
        mut watch: impl FnMut(usize, Seen<'_>),
    ) -> Overall {
        points.clear();
        let Grid { columns, rows, .. } = self.grid;
        if columns * rows > points.capacity() {
            return Overall { detail_q8: TYPICAL_DETAIL_Q8, range: RangeCheck::default() };
        }
        for _ in 0..columns * rows {
            let _ = points.push(SupportPoint::none()); // they fit
        }
        let whole = [Area::of(self.images[0].dims())];
        let areas = areas.unwrap_or(&whole);
        let mut sums = Sums::new(self.half.unwrap_or(self.grid));
        let Some(half) = self.half else {
            for &area in areas {
                self.match_area(
                    self.grid.within(area),
                    lend(&mut cores),
                    memory,
                    points,
                    &mut sums,
                    &mut watch,
                );
            }
            return Overall { detail_q8: sums.detail.mean_q8(), range: sums.nearer.check };
        };
        let plane = self.plane.map(GroundPlane::halved);
        let grid = if plane.is_some() { half.with_plane(memory.len()) } else { half };
        let halves = Matching { grid, half: None, plane, ..*self };
        for &area in areas {
            halves.match_area(
                half.within(area.halved()),
                lend(&mut cores),
                memory,
                points,
                &mut sums,
                &mut |_, _| (),
            );
        }
        let detail_q8 = sums.detail.mean_q8();
        if let Some(points) = points.get_mut(..half.columns * half.rows) {
            rate(None, points, half, detail_q8, plane, self.models.of(plane.is_some()));
        }
        fine::Fine { matching: self, half }.run(areas, memory, points, watch);
        Overall { detail_q8, range: sums.nearer.check.doubled() }
    }

    /// Matches the points in these columns and rows of the grid, on two cores half of the columns
    /// each.
    fn match_area(
        &self,
        area: Area,
        mut cores: Option<&mut dyn Cores>, // no part of a tuple, which hides that it is `None`
        memory: &mut [u8],
        points: &mut [SupportPoint],
        sums: &mut Sums,
        watch: &mut dyn FnMut(usize, Seen<'_>), // compiled once, for both sizes
    ) {
        let Some([codes, paths, labels, spare]) = self.grid.split(memory) else { return };
        let mut labels = self
            .plane
            .filter(|_| self.grid.has_plane)
            .and_then(|plane| PlaneLabels::new(plane, self.grid, labels));
        let (images, row_offset) = (self.images, self.row_offset);
        let [of_half, _] = self.noise.doublings_of_two();
        let is_half = self.grid.is_half;
        let doublings = if is_half { of_half } else { self.noise.doublings() };
        let codes = CodeRows::new(images, row_offset, doublings, is_half, codes, spare);
        let Some(mut codes) = codes else { return };
        let Some(mut paths) = Paths::new(self.grid.labels(), self.grid.columns, paths) else {
            return;
        };
        paths.restart();
        let columns = usize::from(area.left)..usize::from(area.right);
        let mut ranges = [Span::default(); MAX_COLUMNS];
        let mut steps = [0; MAX_COLUMNS];
        let mut valid_before = None;
        for row in area.top..area.bottom {
            let y = Grid::y(row.into());
            codes.code(y, lend(&mut cores));
            let valid = codes.valid(y);
            if valid_before.replace(valid) != Some(valid) {
                for (range, column) in ranges.iter_mut().zip(0..self.grid.columns) {
                    *range = self.range(column, valid).unwrap_or_default();
                }
            }
            if let Some(labels) = &mut labels {
                labels.measure(y, self.grid, &codes, valid[1]);
            }
            let first = usize::from(row) * self.grid.columns;
            let Some(points) = points.get_mut(first..first + self.grid.columns) else { return };
            let row = Row {
                matching: self,
                codes: &codes,
                labels: labels.as_ref(),
                ranges: &ranges,
                right_start: valid[1].start.into(),
                row: row.into(),
            };
            match lend(&mut cores) {
                None => paths.pass(
                    columns.clone(),
                    &mut RowPart {
                        row: &row,
                        first: 0,
                        points,
                        steps: &mut steps,
                        sums,
                        watch: &mut *watch,
                    },
                ),
                Some(cores) => {
                    row.pass_on(cores, &mut paths, columns.clone(), points, &mut steps, sums);
                }
            }
        }
    }

    /// The point in a column that was found in a row with these codes.
    fn to_point(
        &self,
        found: &Found,
        column: usize,
        codes: &CodeRows<'_>,
        model: &Model<SUPPORT_EVIDENCE>,
    ) -> SupportPoint {
        let start = self.grid.window(column);
        let place = codes
            .around_window(start)
            .map_or(Place::MIDDLE, |around| Place::of(around, start - self.grid.x(column)));
        // Beside the plane the disparity changes from its place in the grid as the plane does.
        let (place, moved_q6) = match self.plane.filter(|_| found.is_on_plane) {
            Some(plane) => (place.on_plane(), plane.change_q6(place.dx(), place.dy())),
            None => (place, 0),
        };
        SupportPoint {
            disparity_q6: narrow(found.disparity_q6 + moved_q6),
            score_q8: narrow(model.score_q8(&found.evidence.0)).clamp(LEAST_Q8, MOST_Q8),
            probability_q16: 0,
            uniqueness_q8: found.uniqueness_q8,
            place,
            segments: [0; 2],
        }
    }

    /// Indices of the disparities that a point can have, if any: its window has to lie on valid
    /// pixels of both images.
    fn range(&self, column: usize, [left, right]: [Span; 2]) -> Option<Span> {
        let width = WINDOW_COLUMNS as i32;
        let x = self.grid.window(column);
        if x < i32::from(left.start) || x + width > i32::from(left.end) {
            return None;
        }
        let at_first = x - self.grid.last();
        let first = (i32::from(right.start).max(BORDER) - at_first).max(0);
        let end = (i32::from(right.end).min(self.grid.border()) - width - at_first + 1)
            .min(self.grid.disparities as i32);
        let range = Span { start: u16::try_from(first).ok()?, end: u16::try_from(end).ok()? };
        (indices(Some(&range)).len() >= MIN_RANGE).then_some(range)
    }
}

/// Indices of disparities; none without.
#[inline]
fn indices(range: Option<&Span>) -> Range<usize> {
    range.map_or(0..0, |range| range.start.into()..range.end.into())
}

/// Completes the log-odds of every point with the evidence by its neighbours and by segments, and
/// sets its probability. Of large images rejects those that match what a farther one matches.
pub(crate) fn rate(
    cores: Option<&mut dyn Cores>,
    points: &mut [SupportPoint],
    grid: Grid,
    detail_q8: i16,
    plane: Option<GroundPlane>,
    model: &Model<SUPPORT_EVIDENCE>,
) {
    let rate = |points: &mut [SupportPoint], indices: Range<usize>| {
        for index in indices {
            let nearby = nearby(points, grid, detail_q8, plane, index);
            if let Some(point) = points.get_mut(index)
                && point.is_matched()
            {
                let score = i32::from(point.score_q8) + evidence::nearby_score_q8(nearby, model);
                point.score_q8 = narrow(score).clamp(LEAST_Q8, MOST_Q8);
                point.probability_q16 = model.probability_q16(score);
            }
        }
    };
    let (row, border) = (grid.columns, grid.rows / 2 * grid.columns);
    let all = points.len();
    if let Some(cores) = cores
        && border > 0
        && let Some((above, below)) = points.split_at_mut_checked(border)
    {
        // The rows at the border have neighbours of both halves.
        let (last, rest) = (border - row, below.len());
        cores.join(&mut || rate(above, 0..last), &mut || rate(below, row..rest));
        rate(points, last..border + row);
    } else {
        rate(points, 0..all);
    }
    if grid.is_fine() {
        unique::reject(points, grid);
    }
}
