//! The grid of support points of a run as later stages read it: by areas, around pixels, all.

use super::evidence::{NEARBY, SupportEvidence, nearby};
use super::{GUIDE_REACH, Grid, SupportPoint, UNIQUE_REACH, place};
use crate::area::Area;
use crate::ground::GroundPlane;
use crate::image::Dims;
use crate::params::Params;
use crate::result::{Point, Source};
use crate::units::Confidence;
use core::ops::Range;

/// Grid of support points of a run, with their pixels.
#[derive(Clone, Copy, Debug)]
pub struct Support<'a> {
    pub(crate) grid: Grid,
    /// [`SupportKind::Detail`](super::evidence::SupportKind::Detail), Q8.
    pub(crate) detail_q8: i16,
    pub(crate) plane: Option<GroundPlane>,
    pub(crate) points: &'a [SupportPoint],
}

impl<'a> Support<'a> {
    pub(crate) fn new(
        params: &Params,
        dims: Dims,
        points: &'a [SupportPoint],
        detail_q8: i16,
    ) -> Self {
        Self { grid: Grid::new(params, dims), detail_q8, plane: None, points }
    }

    /// The same of a pair with a ground plane, if there is one.
    pub(crate) fn with_plane(self, plane: Option<GroundPlane>) -> Self {
        Self { plane, ..self }
    }

    /// True when points were matched at half of the size first.
    #[must_use]
    pub fn is_fine(&self) -> bool {
        self.grid.is_fine()
    }

    /// The ground plane of the pair, if one was found.
    #[must_use]
    pub const fn plane(&self) -> Option<GroundPlane> {
        self.plane
    }

    /// Number of points, matched or not.
    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// Rows of points `apart` rows from each other: pixel row of the upper one, its points, those
    /// of the lower one.
    pub(crate) fn row_pairs(
        &self,
        apart: usize,
    ) -> impl Iterator<Item = (i32, &'a [SupportPoint], &'a [SupportPoint])> + use<'a> {
        let (points, columns) = (self.points, self.grid.columns);
        (0..self.grid.rows.saturating_sub(apart)).filter_map(move |row| {
            let of_row = |row: usize| points.get(row * columns..(row + 1) * columns);
            Some((Grid::y(row), of_row(row)?, of_row(row + apart)?))
        })
    }

    /// Every point with its pixel `(x, y)`, row by row, matched or not.
    pub fn iter(&self) -> impl Iterator<Item = ((u16, u16), &'a SupportPoint)> + use<'a> {
        let grid = self.grid;
        self.points
            .iter()
            .enumerate()
            .map(move |(index, point)| (grid.pixel(index, point.place), point))
    }

    /// Every `step`-th point of [`Support::iter`], from this one on.
    pub(crate) fn every(
        &self,
        first: usize,
        step: usize,
    ) -> impl Iterator<Item = ((u16, u16), &'a SupportPoint)> + use<'a> {
        let grid = self.grid;
        // The step before the pixel: those between have none worked out.
        self.points
            .iter()
            .enumerate()
            .skip(first)
            .step_by(step)
            .map(move |(index, point)| (grid.pixel(index, point.place), point))
    }

    /// The matched points with at least this probability. The list of points has each pixel once:
    /// there some are replaced by a more probable point of a segment.
    pub fn credible(&self, least: Confidence) -> impl Iterator<Item = Point> + use<'a> {
        self.credible_by(least, Confidence::MAX)
    }

    /// The same; those that [are ground by their neighbours alone] with at most this probability.
    ///
    /// [are ground by their neighbours alone]: SupportPoint::is_ground_by_paths
    pub(crate) fn credible_by(
        &self,
        least: Confidence,
        most_by_paths: Confidence,
    ) -> impl Iterator<Item = Point> + use<'a> {
        let probable =
            self.iter().filter(move |(_, point)| point.confidence() >= least && point.is_matched());
        probable.map(move |((x, y), point)| {
            let most = if point.is_ground_by_paths() { most_by_paths } else { Confidence::MAX };
            let (disparity, confidence) = (point.disparity(), point.confidence().min(most));
            Point { x, y, disparity, confidence, source: Source::Support }
        })
    }

    /// The matched points in an area, with their pixels.
    pub(crate) fn within(
        &self,
        area: Area,
    ) -> impl Iterator<Item = (i32, i32, &'a SupportPoint)> + use<'a> {
        let Area { left, top, right, bottom } = area;
        self.between((left.into(), i32::from(right) - 1), (top.into(), i32::from(bottom) - 1))
    }

    /// The matched points at most `reach` px from a pixel in both directions, with their pixels.
    pub(crate) fn around(
        &self,
        (x, y): (i32, i32),
        reach: i32,
    ) -> impl Iterator<Item = (i32, i32, &'a SupportPoint)> + use<'a> {
        self.between((x - reach, x + reach), (y - reach, y + reach))
    }

    /// Number of points, of those in this area that `contains` holds, whose windows repeat.
    pub(crate) fn repeating(&self, area: Area, contains: impl Fn(i32, i32) -> bool) -> u32 {
        let Area { left, top, right, bottom } = area;
        let columns = self.grid.columns_within(left.into(), i32::from(right) - 1);
        let mut count = 0;
        for row in self.grid.rows_within(top.into(), i32::from(bottom) - 1) {
            for column in columns.clone() {
                let repeats = self
                    .points
                    .get(row * self.grid.columns + column)
                    .is_some_and(SupportPoint::repeats);
                count += u32::from(repeats && contains(self.grid.x(column), Grid::y(row)));
            }
        }
        count
    }

    /// The matched points between two columns and two rows of pixels, all included, with their
    /// pixels.
    pub(crate) fn between(
        &self,
        (left, right): (i32, i32),
        (top, bottom): (i32, i32),
    ) -> impl Iterator<Item = (i32, i32, &'a SupportPoint)> + use<'a> {
        let (grid, points) = (self.grid, self.points);
        let columns = grid.columns_within(left - place::MOST, right - place::LEAST);
        grid.rows_within(top - place::MOST, bottom - place::LEAST).flat_map(move |row| {
            columns.clone().filter_map(move |column| {
                let point =
                    points.get(row * grid.columns + column).filter(|point| point.is_matched())?;
                let (x, y) = (grid.x(column) + point.place.dx(), Grid::y(row) + point.place.dy());
                ((left..=right).contains(&x) && (top..=bottom).contains(&y))
                    .then_some((x, y, point))
            })
        })
    }

    /// Lowest and highest disparity, whole px, of the unique points ([`UNIQUE_Q8`]) within
    /// [`GUIDE_REACH`] of an area; `None` where less than half of those within [`UNIQUE_REACH`] are
    /// unique: the area may show something thin that no point lies on.
    pub(crate) fn range_around(&self, area: Area) -> Option<(i32, i32)> {
        let reach =
            |from: u16, to: u16| (i32::from(from) - GUIDE_REACH, i32::from(to) - 1 + GUIDE_REACH);
        let ((left, right), (top, bottom)) =
            (reach(area.left, area.right), reach(area.top, area.bottom));
        let (farther, columns) =
            (GUIDE_REACH - UNIQUE_REACH, self.grid.columns_within(left, right));
        let near_rows = self.grid.rows_within(top + farther, bottom - farther);
        let near_columns = self.grid.columns_within(left + farther, right - farther);
        let (mut low_q6, mut high_q6) = (i16::MAX, i16::MIN);
        let (mut near, mut near_and_unique) = (0, 0);
        for row in self.grid.rows_within(top, bottom) {
            let start = row * self.grid.columns;
            let points = |columns: &Range<usize>| {
                self.points.get(start + columns.start..start + columns.end).unwrap_or(&[]).iter()
            };
            // A unique point is matched.
            let is_unique = |point: &&SupportPoint| point.is_unique();
            for point in points(&columns).filter(is_unique) {
                (low_q6, high_q6) =
                    (low_q6.min(point.disparity_q6), high_q6.max(point.disparity_q6));
            }
            if near_rows.contains(&row) {
                near += near_columns.len();
                near_and_unique += points(&near_columns).filter(is_unique).count();
            }
        }
        let pixels = |disparity_q6: i16| (i32::from(disparity_q6) + 32) >> 6;
        (low_q6 <= high_q6 && 2 * near_and_unique >= near)
            .then(|| (pixels(low_q6), pixels(high_q6)))
    }

    /// The evidence of the point at `index`, completed with that by its neighbours.
    #[must_use]
    pub fn with_nearby(&self, index: usize, evidence: SupportEvidence) -> SupportEvidence {
        let nearby_q8 = nearby(self.points, self.grid, self.detail_q8, self.plane, index);
        evidence.with_from(NEARBY, nearby_q8)
    }
}
