//! Block matching for a microcontroller: the rival of the core, with the same care.
//!
//! In: a rectified pair. Out: rows of disparities in 1/16 px.
//!
//! ```text
//! values     Sobel along the row, clipped
//! costs      sums of absolute differences of the values over a window, at every disparity
//! texture    windows with little of it have none
//! decision   unique lowest cost, parabola, the right image's word
//!
//! dense      every pixel, windows of 15 x 15: OpenCV's StereoBM number for number
//! grid       every fourth pixel of every fourth row, windows of 16 x 16 out of blocks of 4 x 4
//! portable   the kernels: the definition; dsp: the same for boards, which have to be Cortex-M4 or
//!            M7
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

#![cfg_attr(not(test), no_std)]
#![deny(missing_debug_implementations)]

mod decision;
mod dense;
#[cfg(all(target_arch = "arm", target_os = "none"))]
mod dsp;
mod grid;
#[cfg_attr(
    all(target_arch = "arm", target_os = "none"),
    allow(dead_code, reason = "on a board `dsp` takes the place of some of it")
)]
mod portable;

pub use decision::{MOST_UNIQUE, NO_DISPARITY};
pub use dense::{DenseMemory, dense_groups};
pub use grid::{GridMemory, grid_groups};

use core::fmt;
use linestereo::Dims;

/// The kernels of this machine.
mod kernel {
    #[cfg(all(target_arch = "arm", target_os = "none"))]
    pub(crate) use crate::dsp::{
        add_block, add_column, block_costs, columns_of_four, groups_within, places_within,
        slide_windows, sobel_row,
    };
    pub(crate) use crate::portable::{Blocks, CAP, Column, Group, Windows};
    #[cfg(not(all(target_arch = "arm", target_os = "none")))]
    pub(crate) use crate::portable::{
        add_block, add_column, block_costs, columns_of_four, groups_within, places_within,
        slide_windows, sobel_row,
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
    /// Least sum of `abs(value - CAP)` over 15 x 15 px; over 16 x 16 px as much more as they are
    /// more.
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
            return Err(Misfit::Disparities(count));
        }
        let needed = [count - 1 + side, side].map(|least| least.max(8));
        let given = [dims.width, dims.height].map(usize::from);
        if given[0] < needed[0] || given[1] < needed[1] {
            Err(Misfit::Size(dims))
        } else {
            Ok(count / 4)
        }
    }
}

/// Why a pair cannot be matched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Misfit {
    /// This number of disparities cannot be searched.
    Disparities(usize),
    /// Images are too small for a window at every disparity or too large for this memory, or differ
    /// in size.
    Size(Dims),
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Disparities(count) => {
                write!(f, "{count} disparities cannot be searched; give 16, 32, 48 or 64")
            }
            Self::Size(dims) => {
                write!(
                    f,
                    "a pair of {dims} does not fit; give images of one size that the memory was \
                     made for"
                )
            }
        }
    }
}

impl core::error::Error for Misfit {}

/// The rows that the Sobel of row `y` looks at, as in OpenCV: the borders are mirrored. None for an
/// odd last row, which OpenCV leaves alone.
fn sobel_rows(y: usize, height: usize) -> Option<[usize; 3]> {
    (y < height & !1)
        .then(|| [if y > 0 { y - 1 } else { 1 }, y, if y + 1 < height { y + 1 } else { y - 1 }])
}

/// The values of row `y` of an image.
fn values(image: linestereo::Gray<'_>, y: usize, out: &mut [u8]) {
    let rows = sobel_rows(y, image.dims().height.into())
        .map(|rows| rows.map(|y| image.row(y).unwrap_or_default()));
    match rows {
        Some([above, row, below]) => kernel::sobel_row(above, row, below, out),
        None => out.fill(kernel::CAP),
    }
}
