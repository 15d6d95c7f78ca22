//! A row of points: its costs, then a disparity of each from the sums of the paths.
//!
//! On two cores each fills and evaluates the points of one half of the columns.

use super::codes::CodeRows;
use super::evidence::{Detail, Found, Labels, Unmatched};
use super::nearer::{self, NearerSearch};
use super::paths::{Paths, PointCosts, Points};
use super::plane::PlaneLabels;
use super::{Grid, Matching, OUTSIDE, Seen, SupportCurves, SupportPoint};
use crate::cores::Cores;
use crate::image::Span;
use crate::kernel::code_steps;
use core::ops::Range;

/// Sums over the windows of an area.
pub(super) struct Sums {
    pub(super) detail: Detail,
    pub(super) nearer: NearerSearch,
}

impl Sums {
    pub(super) fn new(grid: Grid) -> Self {
        Self { detail: Detail::default(), nearer: NearerSearch::new(grid) }
    }

    /// Adds those over other windows.
    fn add(&mut self, other: &Self) {
        self.detail.merge(&other.detail);
        self.nearer.check.merge(&other.nearer.check);
    }
}

/// All that is read of a row of points.
pub(super) struct Row<'r, 'a> {
    pub(super) matching: &'r Matching<'a>,
    pub(super) codes: &'r CodeRows<'a>,
    pub(super) labels: Option<&'r PlaneLabels<'a>>,
    /// Indices of the disparities that each point can have.
    pub(super) ranges: &'r [Span],
    /// First valid column of the right image.
    pub(super) right_start: i32,
    /// Its number.
    pub(super) row: usize,
}

/// Points of a row from a column on, with the codes' changes along each window.
pub(super) struct RowPart<'r, 'a, W> {
    pub(super) row: &'r Row<'r, 'a>,
    pub(super) first: usize,
    pub(super) points: &'r mut [SupportPoint],
    pub(super) steps: &'r mut [u16],
    pub(super) sums: &'r mut Sums,
    pub(super) watch: W,
}

impl<W: FnMut(usize, Seen<'_>)> Points for RowPart<'_, '_, W> {
    #[inline]
    fn fill(&mut self, column: usize, costs: &mut [u8]) {
        let Row { matching: Matching { grid, .. }, codes, labels, .. } = *self.row;
        let (costs, beside) = costs.split_at_mut_checked(grid.disparities).unwrap_or_default();
        if let Some((none, beside)) = beside.split_first_mut()
            && let Some(labels) = labels
        {
            *none = u8::MAX;
            labels.fill(column, grid.x(column), beside);
        }
        let range = self.row.range(column);
        if range.len() < costs.len() {
            costs.fill(OUTSIDE);
        }
        let x = grid.window(column);
        let first = x - grid.last() + range.start as i32;
        if let Some(in_range) = costs.get_mut(range)
            && let Some(window) = codes.costs(x, first, in_range)
        {
            let Sums { detail, nearer } = self.sums;
            if !in_range.is_empty() {
                nearer.add((self.row.row, column), costs, codes, self.row.right_start);
            }
            if let Some(steps) = self.steps.get_mut(column - self.first) {
                *steps = code_steps(window);
                detail.add(*steps);
            }
        }
    }

    #[inline]
    fn visit(&mut self, column: usize, costs: PointCosts<'_>) {
        let at = column - self.first;
        if let Some(point) = self.points.get_mut(at)
            && let Some(&steps) = self.steps.get(at)
            && let Some(found) = self.row.evaluate(column, steps, costs, &mut self.watch)
        {
            *point = found;
        }
    }
}

impl<'a> Row<'_, 'a> {
    /// Matches the points on two cores: in two halves, whose border no sample of [`NearerSearch`]
    /// crosses.
    pub(super) fn pass_on(
        &self,
        cores: &mut dyn Cores,
        paths: &mut Paths<'_>,
        columns: Range<usize>,
        points: &mut [SupportPoint],
        steps: &mut [u16],
        sums: &mut Sums,
    ) {
        let middle = nearer::beside_sample(usize::midpoint(columns.start, columns.end) + 1);
        let middle = middle.min(columns.end);
        let (Some((left, right)), Some((left_steps, right_steps))) =
            (points.split_at_mut_checked(middle), steps.split_at_mut_checked(middle))
        else {
            return;
        };
        let mut there = Sums::new(sums.nearer.grid());
        let part = |first, points, steps, sums| RowPart {
            row: self,
            first,
            points,
            steps,
            sums,
            watch: |_: usize, _: Seen<'_>| (),
        };
        let mut parts =
            [part(0, left, left_steps, &mut *sums), part(middle, right, right_steps, &mut there)];
        paths.pass_on(cores, columns, middle, &mut parts);
        sums.add(&there);
    }

    fn range(&self, column: usize) -> Range<usize> {
        super::indices(self.ranges.get(column))
    }

    /// The point at a column, by its costs and the changes of codes along its window; `None` where
    /// it is not compared.
    #[inline(always)]
    fn evaluate(
        &self,
        column: usize,
        steps: u16,
        costs: PointCosts<'_>,
        watch: &mut impl FnMut(usize, Seen<'_>),
    ) -> Option<SupportPoint> {
        let Self { matching, codes, .. } = *self;
        let (grid, range) = (matching.grid, self.range(column));
        if range.is_empty() {
            return None;
        }
        let (index, last) = (self.row * grid.columns + column, grid.last());
        if matching.wants_curves {
            watch(index, Seen::Curves(SupportCurves::new(&costs, range.clone(), last)));
        }
        let window = grid.window(column);
        let in_left = |away: usize, costs: &mut [u8]| codes.costs_in_left(window, away, costs);
        let beside = self.labels.and_then(|labels| labels.label(column, grid, Grid::y(self.row)));
        let labels = Labels { range, disparities: grid.disparities, last, beside };
        Some(match Found::new(costs, &labels, steps, in_left) {
            Ok(_) if matching.noise.hides(steps, codes, (window, Grid::y(self.row))) => {
                SupportPoint::none()
            }
            Ok(found) => {
                watch(index, Seen::Evidence(&found.evidence));
                let model = matching.models.of(matching.plane.is_some());
                matching.to_point(&found, column, codes, model)
            }
            Err(Unmatched::Repeats) => SupportPoint::repeated(),
            Err(Unmatched::Unclear) => SupportPoint::none(),
        })
    }
}
