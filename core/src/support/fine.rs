//! Support points of large images, around what was matched at half of their size.
//!
//! In: points of the halves, the images. Out: a point every 8 px.
//!
//! ```text
//! around   twice the disparity of the point of the halves in whose square a point lies, or of the
//!          one beside or above or below,
//!          whichever is nearer, if its lowest cost is lower by a tenth
//! labels   disparities up to 3 px from there, or labels beside the ground plane
//! paths    from the left, from the right and from below over these labels, moved by the
//!          difference of the points' disparities
//! result   the lowest sum of the three; sub-pixel by the window's own cost
//! ```
//! A match that is unique at half of the size is not at the full one: small windows find their like
//! among twice as many disparities.
//!
//! # Bounds
//! Costs and paths as in [`super`]: bytes.
//!
//! # Cost
//! Codes of every row of points, and some 900 instructions a point.
//!
//! # Source
//! Coarse to fine as in Anandan 1989, with the paths of Hirschmueller 2008 at both sizes.

use super::codes::{BORDER, CodeRows, WINDOW_COLUMNS};
use super::evidence::{Found, SupportEvidence, SupportKind, log2_q8};
use super::paths::MAX_COLUMNS;
use super::plane::PlaneLabels;
use super::{Grid, Matching, REPEATS_Q6, Seen, SupportCurves, SupportPoint};
use crate::area::Area;
use crate::curve::subpixel_q6;
use crate::evidence::log2_mean_q8;
use crate::image::Span;
use crate::kernel::{CodeColumn, JUMP_PENALTY, STEP_PENALTY, code_costs, code_steps};
use crate::list::List;

/// Most px from what is known.
const REACH: i32 = 3;
/// Number of labels.
const LABELS: usize = 2 * REACH as usize + 1;
/// Labels beside the best that the second-best leaves out.
const NEIGHBOURHOOD: usize = 1;
/// Columns of points of the widest half.
const MAX_HALF_COLUMNS: usize = MAX_COLUMNS / 2;
/// Largest difference to what is known at half of the size that is told apart, px.
const MOST_MOVED_Q8: i32 = 3 << 8;

/// Costs of the labels of a point, those of paths too; disparities fall.
type Costs = [u8; LABELS];

/// Where labels of a point are.
#[derive(Clone, Copy)]
struct Around {
    is_on_plane: bool,
    /// The label in the middle: a disparity, or one beside the plane, px.
    label: i32,
    /// Known disparity, 1/64 px.
    known_q6: i32,
}

/// A point with labels.
#[derive(Clone, Copy)]
struct Node {
    around: Around,
    costs: Costs,
    /// Of the point of the halves.
    score_q8: i16,
    uniqueness_q8: u8,
}

/// A path at a point.
#[derive(Clone, Copy)]
struct Path {
    around: Around,
    costs: Costs,
}

impl Path {
    /// The path at the next point.
    fn step(before: Option<&Self>, node: &Node) -> Self {
        let Some(before) = before else { return Self { around: node.around, costs: node.costs } };
        let same = before.around.is_on_plane == node.around.is_on_plane;
        let of = |around: &Around| if same { around.label } else { (around.known_q6 + 32) >> 6 };
        let moved = of(&before.around) - of(&node.around);
        let lowest = before.costs.iter().copied().min().unwrap_or(0);
        let mut costs = node.costs;
        for (at, cost) in (moved..).zip(&mut costs) {
            let cost_at =
                |at: i32| usize::try_from(at).ok().and_then(|at| before.costs.get(at)).copied();
            let beside = [at - 1, at + 1]
                .into_iter()
                .filter_map(cost_at)
                .min()
                .map(|cost| cost.saturating_add(STEP_PENALTY));
            let best =
                [cost_at(at), beside].into_iter().flatten().fold(lowest + JUMP_PENALTY, u8::min);
            *cost = cost.saturating_add(best - lowest);
        }
        Self { around: node.around, costs }
    }
}

/// Context in which a row of points is matched.
struct Row<'a, 'm> {
    /// Rows of the halves around, the nearest first.
    half_rows: [usize; 2],
    y: i32,
    codes: &'a CodeRows<'m>,
    labels: Option<&'a PlaneLabels<'m>>,
    valid: [Span; 2],
}

/// The row or column of points of the halves that is the second nearest to one of the images.
const fn beside(at: usize) -> usize {
    if at.is_multiple_of(2) { (at / 2).saturating_sub(1) } else { at / 2 + 1 }
}

/// A pair whose halves were matched.
pub(super) struct Fine<'a> {
    pub(super) matching: &'a Matching<'a>,
    /// Grid of the halves.
    pub(super) half: Grid,
}

impl Fine<'_> {
    /// Replaces the points of the halves, at the beginning of `points`, by those of the images in
    /// and around these areas.
    #[inline(never)] // its variables are on the stack only while it runs
    pub(super) fn run(
        &self,
        areas: &[Area],
        memory: &mut [u8],
        points: &mut List<'_, SupportPoint>,
        mut watch: impl FnMut(usize, Seen<'_>),
    ) {
        let Matching { images, grid, row_offset, noise, plane, .. } = *self.matching;
        let [_, doublings] = noise.doublings_of_two();
        let Some((codes, labels)) = memory.split_at_mut_checked(super::codes::bytes(grid.width))
        else {
            return;
        };
        let mut labels = plane.and_then(|plane| PlaneLabels::new(plane, grid, labels));
        let codes = CodeRows::new(images, row_offset, doublings, false, codes, &mut []);
        let Some(mut codes) = codes else { return };
        let mut below: [Option<Path>; MAX_COLUMNS] = [None; MAX_COLUMNS];
        // From the last row up: points of the halves are still there when they are needed.
        for row in (0..grid.rows).rev() {
            let half_rows =
                [row / 2, beside(row)].map(|row| row.min(self.half.rows.saturating_sub(1)));
            let halves = half_rows.map(|row| self.half_row(points, row));
            let y = Grid::y(row);
            let first = row * grid.columns;
            let Some(points) = points.get_mut(first..first + grid.columns) else { continue };
            points.fill(SupportPoint::none());
            let is_matched = |column: usize| {
                areas.iter().any(|&area| grid.within(area).contains(column as i32, row as i32))
            };
            if !(0..grid.columns).any(is_matched) {
                below.fill(None);
                continue;
            }
            codes.code(y, None);
            let is_seen = labels.as_mut().is_some_and(|labels| labels.shift(y, &codes));
            let row = Row {
                half_rows,
                y,
                codes: &codes,
                labels: labels.as_ref().filter(|_| is_seen),
                valid: codes.valid(y),
            };
            let mut nodes: [Option<Node>; MAX_COLUMNS] = [None; MAX_COLUMNS];
            for (column, (node, point)) in nodes.iter_mut().zip(&mut *points).enumerate() {
                if is_matched(column) {
                    *node = self.node(&row, column, &halves);
                    let own = halves[0].get(column / 2);
                    if node.is_none() && own.is_some_and(SupportPoint::repeats) {
                        point.disparity_q6 = REPEATS_Q6;
                    }
                }
            }
            let mut left: [Costs; MAX_COLUMNS] = [[0; LABELS]; MAX_COLUMNS];
            let mut along: Option<Path> = None;
            for ((node, below), left) in nodes.iter().zip(&mut below).zip(&mut left) {
                along = node.as_ref().map(|node| Path::step(along.as_ref(), node));
                *below = node.as_ref().map(|node| Path::step(below.as_ref(), node));
                *left = along.map_or([0; LABELS], |path| path.costs);
            }
            along = None;
            let of_row =
                nodes.iter().zip(&below).zip(&left).zip(points.iter_mut()).enumerate().rev();
            for (column, (((node, below), left), point)) in of_row {
                along = node.as_ref().map(|node| Path::step(along.as_ref(), node));
                let (Some(node), Some(along), Some(below)) = (node, &along, below) else {
                    continue;
                };
                let mut sums = [0_u8; LABELS];
                for (sum, ((&a, &b), &c)) in
                    sums.iter_mut().zip(along.costs.iter().zip(&below.costs).zip(left))
                {
                    *sum = a.saturating_add(b).saturating_add(c);
                }
                if let Some(found) =
                    self.point(&row, column, node, &sums, |seen| watch(first + column, seen))
                {
                    *point = found;
                }
            }
        }
    }

    /// A row of points of the halves.
    fn half_row(&self, points: &[SupportPoint], row: usize) -> [SupportPoint; MAX_HALF_COLUMNS] {
        let mut out = [SupportPoint::none(); MAX_HALF_COLUMNS];
        let columns = self.half.columns;
        if let Some(points) = points.get(row * columns..(row + 1) * columns) {
            out.iter_mut().zip(points).for_each(|(out, &point)| *out = point);
        }
        out
    }

    /// The labels of a point around those of the halves that explain its window best.
    fn node(
        &self,
        row: &Row<'_, '_>,
        column: usize,
        halves: &[[SupportPoint; MAX_HALF_COLUMNS]; 2],
    ) -> Option<Node> {
        let ([own_row, other_row], [here, there]) = (row.half_rows, halves);
        let own = column / 2;
        let nearest =
            [(here, own_row, own), (here, own_row, beside(column)), (there, other_row, own)];
        let mut best: Option<(u8, Node)> = None;
        for (points, half_row, half_column) in nearest {
            let point = points
                .get(half_column)
                .filter(|point| point.is_matched() && half_column < self.half.columns);
            let Some(point) = point else { continue };
            let Some(node) = self.labels_around(row, column, point, (half_column, half_row)) else {
                continue;
            };
            let lowest = node.costs.iter().copied().min().unwrap_or(0);
            if best
                .as_ref()
                .is_none_or(|(least, _)| 10 * u16::from(lowest) + 5 < 9 * u16::from(*least))
            {
                best = Some((lowest, node));
            }
        }
        best.map(|(_, node)| node)
    }

    /// Costs of the labels around a point of the halves; `None` where these leave the valid pixels.
    fn labels_around(
        &self,
        row: &Row<'_, '_>,
        column: usize,
        point: &SupportPoint,
        (half_column, half_row): (usize, usize),
    ) -> Option<Node> {
        let grid = self.matching.grid;
        let (x, window_x) = (grid.x(column), grid.window(column));
        let [left, right] = row.valid;
        if window_x < i32::from(left.start)
            || window_x + WINDOW_COLUMNS as i32 > i32::from(left.end)
        {
            return None;
        }
        let is_on_plane = point.place.is_on_plane();
        let mut known_q6 = 2 * i32::from(point.disparity_q6);
        let labels = row.labels.filter(|_| is_on_plane);
        let label_q6 = match (labels, self.matching.plane) {
            (Some(labels), Some(plane)) => {
                // Pixel (2 x + 1/2, 2 y + 1/2) of the image is (x, y) of its half.
                let (half_x, half_y) = (self.half.x(half_column), Grid::y(half_row));
                let dx = 2 * (x - 2 * (half_x + point.place.dx())) - 1;
                let dy = 2 * (row.y - 2 * (half_y + point.place.dy())) - 1;
                known_q6 += (plane.down_q16 * dy + plane.across_q16 * dx) >> 11;
                known_q6 - labels.at_zero_q6(x, row.y)
            }
            _ => known_q6,
        };
        let is_on_plane = labels.is_some();
        // The first column of the right image at a label.
        let column_of = |label: i32| {
            labels.map_or(window_x - label, |labels| labels.column(window_x, x, label))
        };
        let columns: &[CodeColumn] = match labels {
            Some(labels) => labels.columns(),
            None => row.codes.columns_of_right(),
        };
        let first = i32::from(right.start).max(BORDER);
        let end = i32::from(right.end).min(columns.len() as i32 - BORDER) - WINDOW_COLUMNS as i32;
        let wanted = (label_q6 + 32) >> 6;
        // All labels lie in view.
        let most = column_of(0) - first - REACH;
        let least = column_of(0) - end + REACH;
        let label = wanted.min(most).max(least);
        if (label - wanted).abs() > REACH || label > most {
            return None;
        }
        let from = usize::try_from(column_of(label + REACH)).ok()?;
        let mut costs = [0; LABELS];
        code_costs(
            row.codes.window(window_x)?,
            columns.get(from..from + LABELS + WINDOW_COLUMNS - 1)?,
            &mut costs,
        );
        for cost in &mut costs {
            *cost = cost.saturating_sub(JUMP_PENALTY);
        }
        let around = Around { is_on_plane, label, known_q6 };
        Some(Node { around, costs, score_q8: point.score_q8, uniqueness_q8: point.uniqueness_q8 })
    }

    /// The point at the lowest sum, with its evidence; `None` where that is at an end of the
    /// labels.
    fn point(
        &self,
        row: &Row<'_, '_>,
        column: usize,
        node: &Node,
        sums: &Costs,
        mut watch: impl FnMut(Seen<'_>),
    ) -> Option<SupportPoint> {
        let Matching { grid, plane, .. } = *self.matching;
        let Around { is_on_plane, label, known_q6 } = node.around;
        if self.matching.wants_curves {
            watch(Seen::Curves(SupportCurves {
                largest: (known_q6 >> 6) + REACH,
                window: &node.costs,
                paths: sums,
            }));
        }
        let lowest = sums.iter().copied().min()?;
        let best = sums.iter().position(|&sum| sum == lowest)?;
        let cost = |at: usize| node.costs.get(at).copied();
        let (before, here, after) = (cost(best.checked_sub(1)?)?, cost(best)?, cost(best + 1)?);
        let beside = |distance: i32| match distance {
            -1 => before,
            0 => here,
            _ => after,
        };
        let sub_q6 = subpixel_q6(0, |distance| Some(u16::from(beside(distance))));
        let (x, window_x) = (grid.x(column), grid.window(column));
        let zero_q6 =
            row.labels.filter(|_| is_on_plane).map_or(0, |labels| labels.at_zero_q6(x, row.y));
        let disparity_q6 = zero_q6 + ((label + REACH - best as i32) << 6) - sub_q6;
        let (least, most) = (grid.last() - grid.disparities as i32 + 1, grid.last());
        if disparity_q6 < (least << 6) - 32 || !is_on_plane && disparity_q6 > (most << 6) + 32 {
            return None;
        }
        let far = |at: usize| at.abs_diff(best) > NEIGHBOURHOOD;
        let second =
            sums.iter().enumerate().filter(|&(at, _)| far(at)).map(|(_, &sum)| sum).min()?;
        let curvature = (u16::from(before) + u16::from(after))
            .saturating_sub(2 * u16::from(here))
            .min(u8::MAX.into());
        let changes = code_steps(row.codes.window(window_x)?);
        if self.matching.noise.hides(changes, row.codes, (window_x, row.y)) {
            return None;
        }

        let mut evidence = SupportEvidence::new();
        evidence.set(SupportKind::PathsRatio, log2_q8(lowest) - log2_q8(second));
        evidence.set(SupportKind::WindowCost, log2_q8(here));
        evidence.set(SupportKind::Curvature, log2_q8(curvature as u8));
        evidence.set(SupportKind::Changes, log2_mean_q8(changes.into(), 1));
        evidence.set(SupportKind::HalfSize, node.score_q8.into());
        evidence.set(SupportKind::Moved, ((disparity_q6 - known_q6).abs() << 2).min(MOST_MOVED_Q8));
        if let Some(plane) = plane {
            evidence.set_plane(is_on_plane, disparity_q6 - plane.at_q6(x, row.y));
        }
        watch(Seen::Evidence(&evidence));
        let uniqueness_q8 = node.uniqueness_q8;
        let found = Found { disparity_q6, is_on_plane, uniqueness_q8, evidence };
        Some(self.matching.to_point(&found, column, row.codes, &self.matching.models.fine))
    }
}
