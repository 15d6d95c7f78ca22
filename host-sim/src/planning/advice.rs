//! The smallest baseline for a wanted range, and what to change where that is not enough.

use super::{MAX_RANGE, RigPlan};
use anyhow::{Result, bail};
use core::ops::RangeInclusive;
use linestereo::{Dims, Params};

/// Baselines above this bend and do not fit robots, m.
const LONG: f64 = 0.3;
/// Lenses do not stand closer than this, m.
const SHORT: f64 = 0.02;
/// Baselines of rigs, m: those that [`linestereo::Rig`] takes.
const BASELINES: RangeInclusive<f64> = 0.0001..=10.0;
/// Less common view than this at the nearest distance is worth a word.
const LEAST_OVERLAP: f64 = 0.5;
/// Ranges are suggested in steps of this.
const RANGE_STEP: u16 = 8;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// Nearest distance to be measured, m.
    pub near: f64,
    /// Farthest, m.
    pub far: f64,
    /// Largest error there, one standard deviation as a share of the distance.
    pub error: f64,
}

/// A baseline for a wish.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Suggestion {
    /// Smallest baseline that reaches the error at the farthest distance, m.
    pub baseline_m: f64,
    /// Disparity that the nearest distance then has, px.
    pub disparity_near_px: f64,
    /// Does the disparity range hold it?
    pub within_range: bool,
    /// Percent of the width that both cameras see at the nearest distance.
    pub overlap_near_percent: f64,
    pub advice: Vec<String>,
}

/// The smallest baseline for a wish, for cameras of this focal length (px) and a disparity range.
pub fn suggest(
    focal: f64,
    dims: Dims,
    max_disparity: u16,
    sigma: f64,
    wish: &Wish,
) -> Result<Suggestion> {
    let Wish { near, far, error } = *wish;
    if !(near > 0.0 && near < far && far.is_finite()) {
        bail!("the distances are not above 0 and rising; give --range as 0.5..4");
    }
    if !(error > 0.0 && error < 1.0) {
        bail!("an error of {} % is not between 0 and 100", 100.0 * error);
    }
    let baseline = far * sigma / (focal * error);
    if !BASELINES.contains(&baseline) {
        bail!(
            "{:.2} % at {far} m needs a baseline of {baseline:.5} m, and rigs have {} to {} m; \
             change --error, FAR or the focal length",
            100.0 * error,
            BASELINES.start(),
            BASELINES.end()
        );
    }
    let plan = RigPlan::new(focal, dims, baseline, max_disparity, sigma)?;
    let needed = plan.disparity(near);
    // A hair above the range is rounding, not a wish that fails.
    let within_range = needed <= plan.largest_disparity() * (1.0 + 1e-9);
    let mut advice = Vec::new();
    if !within_range {
        advice.extend(beyond_range(&plan, wish, needed));
    }
    if plan.overlap(near) < LEAST_OVERLAP {
        advice.push(format!(
            "at {near} m the views share {:.0} % of their width: take cameras with more pixels across (a wider lens alone does not help)",
            100.0 * plan.overlap(near)
        ));
    }
    if plan.baseline > LONG {
        advice.push(format!(
            "a baseline of {:.2} m is hard to keep rigid: twice the resolution, or a lens of twice the focal length, halves it",
            plan.baseline
        ));
    }
    if plan.baseline < SHORT {
        advice.push(format!(
            "{:.0} mm is closer than most lenses stand: with {:.0} mm the error at {far} m is {:.1} %, and the near limit {:.2} m",
            1e3 * plan.baseline,
            1e3 * SHORT,
            100.0 * error * plan.baseline / SHORT,
            plan.near_limit() * SHORT / plan.baseline
        ));
    }
    Ok(Suggestion {
        baseline_m: plan.baseline,
        disparity_near_px: needed,
        within_range,
        overlap_near_percent: 100.0 * plan.overlap(near),
        advice,
    })
}

/// The nearest distance has a larger disparity than is found: what would help.
fn beyond_range(plan: &RigPlan, wish: &Wish, needed: f64) -> [String; 2] {
    let Wish { near, far, error } = *wish;
    let found = plan.largest_disparity();
    let width = plan.dims.width;
    let reaches = |range: &u16| Params::largest_disparity(*range).to_num::<f64>() >= needed;
    let range = (RANGE_STEP..=MAX_RANGE).step_by(RANGE_STEP.into()).find(reaches);
    let mut ways = Vec::new();
    let is_narrow = range.is_some_and(|range| range >= width);
    ways.extend(range.map(|range| {
        if is_narrow {
            format!("take more pixels across than the {width} of these images")
        } else {
            format!("search {range} disparities (--max-disparity {range}; time grows with it)")
        }
    }));
    // Rounded to the side on which they do.
    let percent = (1000.0 * far * plan.sigma / (near * found)).ceil() / 10.0;
    if percent < 100.0 {
        ways.push(format!("allow {percent:.1} % at {far} m"));
    }
    let nearer = (100.0 * near * found * error / plan.sigma).floor() / 100.0;
    if nearer > near {
        ways.push(format!("measure only {near} to {nearer:.2} m"));
    }
    let no_help = if is_narrow { "" } else { ". Another lens or resolution does not change this" };
    [
        format!(
            "{near} m needs a disparity of {needed:.0} px, and --max-disparity {} finds up to \
             {found} px: nothing nearer than {:.2} m",
            plan.max_disparity,
            plan.near_limit()
        ),
        ways.join("; or ") + no_help,
    ]
}
