//! Block matching for a microcontroller: the rival of the core, with the same care. `ratio` runs
//! both on an emulated board.
//!
//! In: a rectified pair. Out: disparities in 1/16 px, of every fourth pixel of every fourth row.
//!
//! ```text
//! values     Sobel along the row, clipped
//! costs      sums of absolute differences of the values over a window of 16 x 16 px, out of blocks
//!            of 4 x 4, at every disparity
//! texture    windows with little of it have none
//! decision   unique lowest cost, parabola, the right image's word
//!
//! portable   the kernels: the definition; dsp: the same for the board, a Cortex-M7
//! ```
//!
//! # Bounds
//! Disparities 0 .. 16, 32, 48 or 64. Left pixels count that have all of them, as in OpenCV.
//!
//! # Cost
//! In `docs/experiments.md`, beside the core's.
//!
//! # Source
//! OpenCV, `calib3d/stereobm.cpp` (Konolige's block matcher).

#![no_std]
#![deny(missing_debug_implementations)]

mod decision;
#[cfg(all(target_arch = "arm", target_os = "none"))]
mod dsp;
mod file;
mod grid;
#[cfg_attr(
    all(target_arch = "arm", target_os = "none"),
    allow(dead_code, reason = "on a board `dsp` takes the place of some of it")
)]
mod portable;

pub use decision::{MOST_UNIQUE, NO_DISPARITY};
pub use file::{BOARD, METHODS, Matcher};
pub use grid::{GridMemory, grid_groups};

use linestereo::{Dims, Gray};

/// The kernels of this machine.
mod kernel {
    #[cfg(all(target_arch = "arm", target_os = "none"))]
    use crate::dsp as of_machine;
    #[cfg(not(all(target_arch = "arm", target_os = "none")))]
    use crate::portable as of_machine;
    pub(crate) use crate::portable::{Blocks, CAP, Group};
    pub(crate) use of_machine::{
        add_block, block_costs, columns_of_four, groups_within, places_within, sobel_row,
    };
}

/// Most disparities.
pub const MOST_DISPARITIES: usize = 64;
/// Groups of four disparities.
const MOST_GROUPS: usize = MOST_DISPARITIES / 4;
/// Disparities come in whole ones of these.
const STEP: usize = 16;

/// Search range and acceptance tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Number of disparities from 0 on: 16, 32, 48 or 64.
    pub disparities: usize,
    /// Least sum of `abs(value - CAP)` over 15 x 15 px, as in OpenCV; over 16 x 16 px as much more
    /// as they are more.
    pub texture_threshold: u32,
    /// Percent by which every other cost has to be above the lowest, up to [`MOST_UNIQUE`]; one
    /// that is as low is always too many.
    pub uniqueness_ratio: u16,
    /// Largest difference of two left pixels that match the same right one, px; `None`: no limit.
    pub left_right: Option<u16>,
}

impl Settings {
    /// OpenCV's defaults, and a left-right check.
    pub const USUAL: Self =
        Self { disparities: 64, texture_threshold: 10, uniqueness_ratio: 15, left_right: Some(1) };
    /// Strict settings.
    pub const STRICT: Self = Self { texture_threshold: 3000, uniqueness_ratio: 90, ..Self::USUAL };

    /// Groups of four disparities, if the number is one that can be searched in images of this
    /// size.
    fn groups(&self, dims: Dims, side: usize) -> Result<usize, Misfit> {
        let count = self.disparities;
        if count == 0 || count > MOST_DISPARITIES || !count.is_multiple_of(STEP) {
            return Err(Misfit);
        }
        let [width, height] = [dims.width, dims.height].map(usize::from);
        if width < count - 1 + side || height < side { Err(Misfit) } else { Ok(count / 4) }
    }
}

/// A pair that cannot be matched: too small for a window at every disparity, too large for the
/// memory, of two sizes, or with another number of disparities.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a pair does not fit the matcher: its size, or its number of disparities")]
pub struct Misfit;

/// The values of row `y` of an image, as in OpenCV: borders are mirrored, and an odd last row is
/// left alone.
fn values(image: Gray<'_>, y: usize, out: &mut [u8]) {
    let height = usize::from(image.dims().height);
    if y >= height & !1 {
        return out.fill(kernel::CAP);
    }
    let (above, below) =
        (y.checked_sub(1).unwrap_or(1), if y + 1 < height { y + 1 } else { y - 1 });
    let [above, row, below] = [above, y, below].map(|y| image.row(y).unwrap_or_default());
    kernel::sobel_row(above, row, below, out);
}
