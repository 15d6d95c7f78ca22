//! Support points on bars: what lies more than 1 px behind a bar on its own pixels has the bar's
//! disparity.
//!
//! In: the grid of points, the bars that are told. Out: the points.

use super::Bar;
use crate::support::{Grid, SupportPoint};
use crate::units::narrow;

/// Points on the pixels of bars that lie behind these, or have no disparity, take that of the bar.
pub(crate) fn take_points(points: &mut [SupportPoint], grid: Grid, bars: &[Bar]) {
    for (index, point) in points.iter_mut().enumerate().filter(|_| !bars.is_empty()) {
        let (x, y) = grid.pixel(index, point.place);
        let Some(bar) = bars.iter().find(|bar| bar.columns(y).contains(&x)) else {
            continue;
        };
        if !point.is_matched() || bar.hides(y.into(), point.disparity_q6.into()) {
            point.take_bar(narrow(bar.disparity_at_q6(y.into())), bar.confidence());
        }
    }
}
