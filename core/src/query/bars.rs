//! The depth of pixels on bars: what lies more than 1 px behind a bar on its own pixels has the
//! disparity of the bar.
//!
//! In: the bars that are told, a pixel, the answer that it has without them. Out: that of the bar
//! where the pixel lies on one that is nearer.

use super::{PixelDepth, PixelRejection};
use crate::bars::Bar;
use crate::rig::Rig;
use crate::units::disparity_from_q6;

/// The answer for a pixel, or that of the nearest bar that it lies on.
pub(crate) fn on_bars(
    bars: &[Bar],
    (x, y): (u16, u16),
    answer: Result<PixelDepth, PixelRejection>,
    rig: Option<Rig>,
) -> Result<PixelDepth, PixelRejection> {
    let on = bars.iter().filter(|bar| bar.columns(y).contains(&x));
    let Some(bar) = on.max_by_key(|bar| bar.disparity_at_q6(y.into())) else { return answer };
    let d_q6 = bar.disparity_at_q6(y.into());
    let is_bars = match answer {
        Ok(depth) => bar.hides(y.into(), depth.disparity.to_bits().into()),
        Err(reason) => !matches!(reason, PixelRejection::Outside | PixelRejection::OutsideRegion),
    };
    if !is_bars {
        return answer;
    }
    Ok(PixelDepth::new(disparity_from_q6(d_q6), bar.sigma(), bar.confidence(), rig))
}
