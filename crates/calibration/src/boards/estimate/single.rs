//! One camera from its own photos: a focal length by search, then everything; views that do not fit
//! are dropped.

use super::super::bundle::{BoardView, Bundle};
use super::super::initial::{self, Sightings};
use super::super::model::{FX, Intrinsics, K1, Pose};
use super::free::{Options, beliefs, shared_numbers};
use super::outcome::{Dropped, LEAST_VIEWS};
use super::{BAD_VIEW, ROUNDS, median, view_errors};
use linestereo::Dims;

/// An error above which a first guess was a wrong one, px.
const LOST: f64 = 3.0;

pub(super) struct Single {
    pub(super) bundle: Bundle,
    pub(super) dropped: Vec<Option<Dropped>>,
}

pub(super) fn single(dims: Dims, sightings: &[Sightings], options: &Options) -> Option<Single> {
    let searched = initial::focals(options.lens, dims, sightings);
    let width = f64::from(dims.width);
    let starts =
        searched.first().copied().into_iter().chain([0.6, 1.0, 1.8].map(|widths| widths * width));
    let mut best: Option<(f64, Bundle)> = None;
    for start in starts {
        let Some(bundle) = refined(dims, sightings, options, start) else { continue };
        let error = median(&view_errors(&bundle));
        if error.is_finite() && best.as_ref().is_none_or(|(least, _)| error < *least) {
            best = Some((error, bundle));
        }
        if best.as_ref().is_some_and(|(least, _)| *least < LOST) {
            break;
        }
    }
    let (_, mut bundle) = best?;
    let mut dropped = vec![None; sightings.len()];
    // Views that do not fit pull the others off: estimate without them, then pose them again for
    // the report.
    for _ in 0..ROUNDS {
        let kept: Vec<usize> = (0..dropped.len()).filter(|&view| dropped[view].is_none()).collect();
        let errors = view_errors(&bundle);
        let limit = BAD_VIEW * median(&kept.iter().map(|&view| errors[view]).collect::<Vec<_>>());
        let bad: Vec<usize> = kept.iter().copied().filter(|&view| errors[view] > limit).collect();
        if bad.is_empty() || kept.len() - bad.len() < LEAST_VIEWS {
            break;
        }
        for view in bad {
            dropped[view] = Some(Dropped::Error(errors[view]));
        }
        let mut views = bundle.views.clone();
        let good: Vec<usize> = kept.into_iter().filter(|&view| dropped[view].is_none()).collect();
        bundle.views = good.iter().map(|&view| views[view].clone()).collect();
        bundle.solve();
        good.into_iter().zip(bundle.views).for_each(|(view, solved)| views[view] = solved);
        bundle.views = views;
    }
    Some(Single { bundle, dropped })
}

/// Refined from one focal length.
fn refined(dims: Dims, sightings: &[Sightings], options: &Options, focal: f64) -> Option<Bundle> {
    let camera = Intrinsics::plain(options.lens, dims, focal);
    // A view whose first pose fails must not cost the others: the solver finds it from a board face
    // to face, or it is dropped.
    let view = |seen: &Sightings| {
        let pose =
            initial::pose(&camera, dims, seen).unwrap_or_else(|| initial::facing(&camera, seen));
        BoardView { seen: [seen.clone(), Vec::new()], pose }
    };
    let views = sightings.iter().map(view).collect();
    let mut bundle = Bundle {
        cameras: [camera; 2],
        rig: Pose([0.0; 6]),
        views,
        free: vec![FX, K1],
        square_pixels: true,
        beliefs: beliefs(&[camera; 2], dims),
    };
    bundle.solve();
    bundle.free = shared_numbers(options, false);
    bundle.square_pixels = options.square_pixels;
    bundle.beliefs = beliefs(&bundle.cameras, dims);
    bundle.solve().then_some(bundle)
}
