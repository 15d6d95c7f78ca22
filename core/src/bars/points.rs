//! Support points on bars: what lies more than 1 px behind a bar on its own pixels has the bar's
//! disparity.
//!
//! In: the grid of points, the bars that are told. Out: the points.
//!
//! # Cost
//! The points around each bar, some 30 of 30 instructions.

use super::Bar;
use crate::support::{Grid, SupportPoint};
use crate::units::narrow;

/// Points on the pixels of bars that lie behind these, or have no disparity, take that of the
/// first of these bars.
pub(crate) fn take_points(points: &mut [SupportPoint], grid: Grid, bars: &[Bar]) {
    for (index, bar) in bars.iter().enumerate() {
        let earlier = bars.get(..index).unwrap_or(&[]);
        for index in grid.around(bar.area()) {
            let Some(point) = points.get_mut(index) else { continue };
            let (x, y) = grid.pixel(index, point.place);
            let is_on = |bar: &Bar| bar.columns(y).contains(&x);
            let is_behind = !point.is_matched() || bar.hides(y.into(), point.disparity_q6.into());
            if is_behind && is_on(bar) && !earlier.iter().any(is_on) {
                point.take_bar(narrow(bar.disparity_at_q6(y.into())), bar.confidence());
            }
        }
    }
}
