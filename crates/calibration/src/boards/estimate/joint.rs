//! Both cameras and their pose at once; corners and views that do not fit are dropped, until none
//! is.

use super::super::bundle::Bundle;
use super::outcome::{Dropped, EstimateError, LEAST_VIEWS};
use super::{BAD_VIEW, ROUNDS, median, view_errors};

/// A corner further off than this many standard deviations, and than this in px, is dropped.
const BAD_CORNER: (f64, f64) = (8.0, 0.5);

/// Estimates all at once, drops what does not fit, and again. Out: the bundle, and which views it
/// holds.
pub(super) fn robust(
    mut bundle: Bundle,
    dropped: &mut [Option<Dropped>],
) -> Result<(Bundle, Vec<usize>), EstimateError> {
    let found = dropped.len();
    let mut used: Vec<usize> = (0..found).filter(|&view| dropped[view].is_none()).collect();
    bundle.views = used.iter().map(|&view| bundle.views[view].clone()).collect();
    for _ in 0..ROUNDS {
        if used.len() < LEAST_VIEWS {
            return Err(EstimateError::TooFew(found, used.len()));
        }
        bundle.solve();
        let bad_corners = drop_corners(&mut bundle);
        let errors = view_errors(&bundle);
        let limit = BAD_VIEW * median(&errors);
        let bad: Vec<bool> = errors.iter().map(|&error| error > limit).collect();
        if bad_corners == 0 && !bad.contains(&true) {
            return Ok((bundle, used));
        }
        for ((&view, &error), _) in used.iter().zip(&errors).zip(&bad).filter(|(_, bad)| **bad) {
            dropped[view] = Some(Dropped::Error(error));
        }
        let mut keep = bad.iter().map(|bad| !bad);
        bundle.views.retain(|_| keep.next().unwrap_or(true));
        used.retain(|&view| dropped[view].is_none());
    }
    bundle.solve();
    Ok((bundle, used))
}

/// Takes corners out that are far off; how many.
fn drop_corners(bundle: &mut Bundle) -> usize {
    let errors: Vec<Vec<f64>> = bundle.views.iter().map(|view| bundle.errors(view)).collect();
    let sizes: Vec<f64> = errors.iter().flatten().map(|error| error.abs()).collect();
    // The median of absolute values of a normal distribution is 0.6745 standard deviations.
    let limit = (BAD_CORNER.0 * median(&sizes) / 0.6745).max(BAD_CORNER.1);
    let mut gone = 0;
    for (view, errors) in bundle.views.iter_mut().zip(&errors) {
        let mut far = errors.chunks_exact(2).map(|error| error[0].hypot(error[1]) > limit);
        for seen in &mut view.seen {
            let before = seen.len();
            seen.retain(|_| !far.next().unwrap_or(false));
            gone += before - seen.len();
        }
    }
    gone
}
