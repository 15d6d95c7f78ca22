//! End of the disparities searched: of a scene file, by the nearest distance, or where nobody says.

use crate::output::note;
use crate::planning::{LEAST_RANGE, MAX_RANGE};
use anyhow::{Context, Result, bail};
use linestereo::{Dims, Params, Rig};
use linestereo_frames::scaled_max_disparity;
use std::path::Path;

/// The largest range that images of this size have room for.
fn largest(dims: Dims) -> u16 {
    (dims.width - 1).min(MAX_RANGE)
}

/// That of a scene file, for images reduced by `scale` to this size.
pub(super) fn of_scene(path: &Path, range: f64, scale: f64, dims: Dims) -> Result<u16> {
    let scaled = if scale < 1.0 && range > 0.0 {
        f64::from(scaled_max_disparity(range, scale))
    } else {
        range
    };
    let most = largest(dims);
    if !(f64::from(LEAST_RANGE)..=f64::from(most)).contains(&scaled) {
        bail!(
            "{}: max_disparity is {range}, but images of {dims} have disparity ranges of \
             {LEAST_RANGE} to {most} px; correct it, or give --max-disparity",
            path.display()
        );
    }
    Ok(scaled as u16)
}

/// End of the disparities searched where nobody says how far; a note where images of this size have
/// no room for the usual one.
pub(super) fn default_range(dims: Dims) -> u16 {
    let most = Params::default_max_disparity(dims.width).max(LEAST_RANGE);
    if most < Params::DEFAULT.max_disparity {
        note(&format!(
            "disparities below {most} are searched, as images of {dims} have no more; \
             --max-disparity sets a smaller range"
        ));
    }
    most
}

/// End of the disparities searched so that nothing at least `nearest` metres away is beyond them.
pub(super) fn range_to(nearest: f64, rig: Option<&Rig>, dims: Dims) -> Result<u16> {
    let Some(rig) = rig else {
        bail!("--nearest needs a rig: give --focal-px and --baseline-m, --fb, --scene, or --rig")
    };
    if !(0.01..=1000.0).contains(&nearest) {
        bail!("--nearest is {nearest}; give 0.01 to 1000 metres");
    }
    let most = largest(dims);
    let limit = |range: u16| rig.depth(Params::largest_disparity(range)).to_num::<f64>();
    (LEAST_RANGE..=most).find(|&range| limit(range) <= nearest).with_context(|| {
        let least = (100.0 * limit(most)).ceil() / 100.0;
        format!(
            "--nearest {nearest} needs more than {most} disparities; give {least:.2} or more, or \
             reduce the images with --width, or --size with --rig"
        )
    })
}
