//! The noise of a pair, by its flattest runs of pixels: it sets the full scale of the codes.
//!
//! In: both images. Out: its standard deviation in grey levels, and how often codes are doubled.
//!
//! ```text
//! sample   24 rows x 8 runs of 8 pixels, spread over the image; runs with pixels near black or
//!          white are left out
//! L        sum over a run of |second difference across of the second difference down|, of pixels
//!          1 and 2 px apart
//! noise    L of the run at 20 % / 30.6; the larger of the two distances and of the two images
//! ```
//! The second differences of a plane are zero: what is left on flat and evenly shaded surfaces is
//! noise. Pixels 2 px apart also show the noise of a camera that smooths it.
//!
//! # Cost
//! 384 runs an image.
//!
//! # Source
//! Immerkaer 1996 (fast noise variance estimation: the mask), by a quantile of runs instead of the
//! mean of all pixels.

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

/// Standard deviation of a pair's noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) struct Noise {
    /// Sum of second differences of the run at 20 %, 30.6 times the deviation in grey levels.
    sum: u16,
}

impl Noise {
    /// The noise of the noisier image.
    pub(crate) fn of(cores: Option<&mut dyn Cores>, [left, right]: [Gray<'_>; 2]) -> Self {
        let of = |image| of_image(image, 1).max(of_image(image, 2));
        let (mut of_left, mut of_right) = (Self::default(), Self::default());
        join(cores, || of_left = of(left), || of_right = of(right));
        of_left.max(of_right)
    }

    /// How often codes are doubled, 1 ..= 4: each halves the difference that fills their scale.
    pub(super) fn doublings(self) -> u32 {
        1 + [144, 72, 36].into_iter().map(|most| u32::from(self.sum < most)).sum::<u32>()
    }

    /// The same of the images' halves, and of the images around what is known from these.
    pub(super) fn doublings_of_two(self) -> [u32; 2] {
        let doublings = self.doublings();
        [doublings.max(2), (doublings - 1).max(1)]
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

/// Noise of an image by pixels `apart` px from each other.
fn of_image<'a>(image: Gray<'a>, apart: usize) -> Noise {
    let dims = image.dims();
    let (width, height, reach) = (i32::from(dims.width), i32::from(dims.height), apart as i32);
    let mut histogram = [0_u16; STEPS];
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
                let step = second_differences([above, here, below], apart) / STEP;
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
    for (step, &count) in (0..).zip(&histogram) {
        match left.checked_sub(count.into()) {
            Some(rest) => left = rest,
            None => return Noise { sum: step * STEP as u16 + STEP as u16 / 2 },
        }
    }
    Noise { sum: STEPS as u16 * STEP as u16 }
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
