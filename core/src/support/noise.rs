//! The noise of a pair, by its flattest runs of pixels: it sets the full scale of the codes, and
//! what a window has to show where compression removed the noise.
//!
//! In: both images. Out: for each the standard deviation and the share of runs without any noise.
//!
//! ```text
//! sample   24 rows x 8 runs of 8 pixels, spread over the image; runs with pixels near black or
//!          white are left out
//! L        sum over a run of |second difference across of the second difference down|, of pixels
//!          1 and 2 px apart
//! noise    L of the run at 20 % / 30.6; the larger of the two distances and of the two images
//! hidden   windows of little contrast whose codes change by less than 3 per thousandth of the runs
//!          with L = 0 of pixels 1 px apart, the larger of the two images, at most by 800
//! ```
//! The second differences of a plane are zero: what is left on flat and evenly shaded surfaces is
//! noise. Pixels 2 px apart also show the noise of a camera that smooths it.
//!
//! A sensor leaves no run without noise. Compression and few grey levels turn blank surfaces into
//! steps instead, which lie at the same pixels of both images or move with the light: they match,
//! but not at the depth of the surface. Such windows are not matched.
//!
//! # Cost
//! 384 runs an image.
//!
//! # Source
//! Immerkaer 1996 (fast noise variance estimation: the mask), by a quantile of runs instead of the
//! mean of all pixels.

use super::codes::CodeRows;
use crate::cores::{Cores, join};
use crate::image::Gray;
use crate::kernel::{RUN_PIXELS, STRIP, second_differences};
use crate::units::quotient;

/// Rows with runs.
const ROWS: i32 = 24;
/// Runs in a row.
const RUNS: i32 = 8;
/// Grey levels at either end of the scale that a run's pixels do not have: they are cut off by the
/// sensor's range.
const CUT_OFF: u8 = 3;
/// Least number of runs for an estimate.
const FEWEST: u32 = 12;
/// Sums of runs per step of their histogram.
const STEP: u32 = 4;
/// Steps of the histogram: up to 8.4 grey levels.
const STEPS: usize = 64;

/// Sum of second differences of a run per grey level of standard deviation, 1/10.
const TENTHS_PER_LEVEL: u32 = 306;
/// Changes of codes along a window below which it may show steps alone, per thousandth of the runs
/// that are without noise. With less blank surfaces still match, with more textured ones do not.
const CHANGES_PER_PERMILLE: u16 = 3;
/// The most of these changes.
const MOST_CHANGES: u16 = 800;
/// Grey levels by which a window differs where an edge is seen, whatever the noise: steps that
/// compression makes are smaller.
const EDGE: u8 = 48;

/// Noise of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Noise {
    /// Standard deviation, 1/16 grey level, up to 8.4 levels.
    pub deviation_q4: u8,
    /// Runs of pixels without any noise, per thousand. A sensor leaves none: in a picture with
    /// many, compression or few grey levels removed the noise, and with it the texture of blank
    /// surfaces.
    pub noiseless_permille: u16,
}

impl Noise {
    /// The noise of each image.
    pub(crate) fn of(cores: Option<&mut dyn Cores>, [left, right]: [Gray<'_>; 2]) -> [Self; 2] {
        let of = |image| {
            let near = of_image(image, 1);
            let deviation_q4 = near.deviation_q4.max(of_image(image, 2).deviation_q4);
            Self { deviation_q4, ..near }
        };
        let (mut of_left, mut of_right) = (Self::default(), Self::default());
        join(cores, || of_left = of(left), || of_right = of(right));
        [of_left, of_right]
    }

    /// The larger numbers of two images.
    pub(crate) fn larger([a, b]: [Self; 2]) -> Self {
        Self {
            deviation_q4: a.deviation_q4.max(b.deviation_q4),
            noiseless_permille: a.noiseless_permille.max(b.noiseless_permille),
        }
    }

    /// How often codes are doubled, 1 ..= 4: each halves the difference that fills their scale.
    pub(super) fn doublings(self) -> u32 {
        1 + [75, 37, 18].into_iter().map(|most| u32::from(self.deviation_q4 < most)).sum::<u32>()
    }

    /// The same of the images' halves, and of the images around what is known from these.
    pub(super) fn doublings_of_two(self) -> [u32; 2] {
        let doublings = self.doublings();
        [doublings.max(2), (doublings - 1).max(1)]
    }

    /// True when a window with these changes of codes, at this column of rows that are coded as
    /// `y`, may show nothing but the steps that the removal of noise makes.
    pub(super) fn hides(self, changes: u16, codes: &CodeRows<'_>, (x, y): (i32, i32)) -> bool {
        changes < (CHANGES_PER_PERMILLE * self.noiseless_permille).min(MOST_CHANGES)
            && !codes.has_contrast(y, x, EDGE)
    }
}

/// True when one of four grey levels is cut off.
#[inline]
fn has_cut_off(levels: [u8; 4]) -> bool {
    let (levels, all) = (u32::from_ne_bytes(levels), |byte: u8| u32::from_ne_bytes([byte; 4]));
    // Levels moved round the scale's end, so that those at both ends are the lowest ones.
    let moved = ((levels & all(0x7f)) + all(CUT_OFF)) ^ (levels & all(0x80));
    // The upper bit of a byte: it is below, or one before it.
    moved.wrapping_sub(all(2 * CUT_OFF)) & !moved & all(0x80) != 0
}

/// Noise of an image by pixels `apart` px from each other; the default with too few runs.
fn of_image<'a>(image: Gray<'a>, apart: usize) -> Noise {
    let dims = image.dims();
    let (width, height, reach) = (i32::from(dims.width), i32::from(dims.height), apart as i32);
    let mut histogram = [0_u16; STEPS];
    let mut noiseless = 0_u16;
    for row in 0..ROWS {
        let y = quotient(row * (height - 4 * reach), ROWS) + 2 * reach;
        let line = |y: i32| image.row(y.max(0) as usize).unwrap_or(&[]);
        let lines = [line(y - reach), line(y), line(y + reach)];
        let valid = image.valid_columns(y);
        for run in 0..RUNS {
            let x = quotient(run * (width - 12), RUNS) + 2 * reach;
            let first = x - reach;
            let end = first + (STRIP + 2 * apart) as i32;
            if first < i32::from(valid.start) || end > i32::from(valid.end) {
                continue;
            }
            let from =
                |line: &'a [u8]| line.get(first.max(0) as usize..)?.first_chunk::<RUN_PIXELS>();
            let [Some(above), Some(here), Some(below)] = lines.map(from) else { continue };
            // Only where no pixel is near black or white.
            let is_between = here
                .get(apart..apart + STRIP)
                .is_some_and(|run| !run.as_chunks().0.iter().any(|&four| has_cut_off(four)));
            if is_between {
                let sum = second_differences([above, here, below], apart);
                noiseless += u16::from(sum == 0);
                let step = sum / STEP;
                if let Some(count) = histogram.get_mut(step.min(STEPS as u32 - 1) as usize) {
                    *count += 1;
                }
            }
        }
    }
    let all: u32 = histogram.iter().map(|&count| u32::from(count)).sum();
    if all < FEWEST {
        return Noise::default();
    }
    let mut left = all / 5;
    let at = histogram.iter().position(|&count| match left.checked_sub(count.into()) {
        Some(rest) => {
            left = rest;
            false
        }
        None => true,
    });
    let sum = at.map_or(STEPS as u32 * STEP, |step| step as u32 * STEP + STEP / 2);
    Noise {
        deviation_q4: (16 * 10 * sum / TENTHS_PER_LEVEL) as u8, // at most 133
        noiseless_permille: quotient(1000 * i32::from(noiseless), all as i32) as u16,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_at_both_ends_of_the_scale_are_cut_off() {
        for level in 0..=u8::MAX {
            for place in 0..4 {
                let mut levels = [128, 3, 252, 60];
                levels[place] = level;
                assert_eq!(has_cut_off(levels), !(3..253).contains(&level), "{level} at {place}");
            }
        }
    }
}
