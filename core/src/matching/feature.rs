//! Feature matching: right segments that are structurally the same as a left one vote for a disparity.
//!
//! In: a left segment, the right segments sorted by their top row. Out: the disparity at the middle row by the line of each compatible one.
//! A vote, not a requirement: only about 72 % of visible left segments have their partner among the right segments.

use super::MatchContext;
use crate::lines::{MAX_ROWS, Segment};
use crate::units::quotient;

/// A line x(y) in 1/32 px with its row range.
#[derive(Clone, Copy)]
pub(crate) struct SteepLine {
    x0: i32,
    y0: i32,
    y1: i32,
    /// dx/dy, Q12.
    slope_q12: i32,
}

impl SteepLine {
    pub(crate) fn new(segment: &Segment) -> Self {
        let (mut x0, mut y0, mut x1, mut y1) = segment.ends_q5();
        if y0 > y1 {
            (x0, y0, x1, y1) = (x1, y1, x0, y0);
        }
        let slope_q12 = quotient((x1 - x0) << 12, y1 - y0).clamp(-(8 << 12), 8 << 12);
        Self { x0, y0, y1, slope_q12 }
    }

    pub(crate) fn slope_q12(&self) -> i32 {
        self.slope_q12
    }

    /// First and last whole row.
    pub(crate) fn rows(&self) -> (i32, i32) {
        ((self.y0 + 31) >> 5, self.y1 >> 5)
    }

    /// x at a row given in 1/32 px, in 1/32 px.
    pub(crate) fn x_q5(&self, y_q5: i32) -> i32 {
        self.x0 + (((y_q5 - self.y0) * self.slope_q12 + 2048) >> 12)
    }

    /// Nearest column at a whole row.
    pub(crate) fn column(&self, y: i32) -> i32 {
        (self.x_q5(y << 5) + 16) >> 5
    }
}

/// Calls `vote` with the disparity (1/64 px, at row `middle_q5`) of every right segment that could be the same edge.
pub(crate) fn for_each_partner(
    segment: &Segment,
    context: &MatchContext<'_>,
    middle_q5: i32,
    mut vote: impl FnMut(i32),
) {
    let line = SteepLine::new(segment);
    let right = context.right;
    let first = right.partition_point(|s| top(s) < line.y0 - ((MAX_ROWS + 2) << 5));
    for other in right.get(first..).unwrap_or(&[]) {
        if top(other) > line.y1 {
            break;
        }
        if other.rising != segment.rising
            || other.contrast > segment.contrast.saturating_mul(2).saturating_add(8)
            || segment.contrast > other.contrast.saturating_mul(2).saturating_add(8)
        {
            continue;
        }
        let mut partner = SteepLine::new(other);
        partner.y0 -= context.row_offset_q5;
        partner.y1 -= context.row_offset_q5;
        let (from, to) = (line.y0.max(partner.y0), line.y1.min(partner.y1));
        let shorter = (line.y1 - line.y0).min(partner.y1 - partner.y0);
        if to - from < (shorter / 2).max(3 << 5) {
            continue;
        }
        let d = |y: i32| (line.x_q5(y) - partner.x_q5(y)) << 1;
        let (a, b) = (d(from), d(to));
        let (low, high) = (a.min(b), a.max(b));
        let same_slope = high - low <= (to - from) / 2 + 64;
        if same_slope && context.in_range(low, high) {
            vote(d(middle_q5));
        }
    }
}

fn top(segment: &Segment) -> i32 {
    let (_, y0, _, y1) = segment.ends_q5();
    y0.min(y1)
}
