//! Statistics of one image of a pair on a coarse grid: level, saturation, detail, and a digest to
//! detect repeated images.
//!
//! # Bounds
//! At most [`COLUMNS`] x [`ROWS`] samples of 8 bits: every sum is below 2^19; times 1000, 2^21.
//! Pixels of at most 32 rows: times 1000, 2^26.
//!
//! # Cost
//! Some 14 instructions a sample, 1536 samples an image; 4 for each four pixels of the rows.

use crate::fnv::Fnv;
use crate::image::Gray;
use crate::units::quotient;

/// Most samples along a row.
const COLUMNS: u16 = 48;
/// Most rows with samples.
const ROWS: u16 = 32;
/// Largest level of a black pixel.
const BLACK: u32 = 2;
/// Least level of a white pixel.
const WHITE: u32 = 253;

/// Statistics of one camera's image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CameraHealth {
    /// Mean grey level, 0 ..= 255.
    pub level: u8,
    /// Mean grey step between adjacent samples of a row, 1/16 grey level: texture and noise.
    pub detail_q4: u16,
    /// Samples at 0 ..= 2 per thousand.
    pub black_permille: u16,
    /// Samples at 253 ..= 255 per thousand.
    pub white_permille: u16,
    /// Valid pixels ([`Gray::with_valid`]) per thousand: 1000 for images without a restriction. The
    /// other numbers refer to valid pixels.
    pub view_permille: u16,
}

/// Result of one image's check.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CameraCheck {
    pub(super) health: CameraHealth,
    /// True when the brightest and the darkest sample differ by no more than the limit.
    pub(super) is_flat: bool,
    /// Digest of all valid pixels of the sampled rows: equal for different ones with a probability
    /// of 2^-32.
    pub(super) digest: u32,
}

/// Sums over samples.
#[derive(Default)]
struct Samples {
    count: u32,
    sum: u32,
    /// Sum of the grey steps between adjacent samples of a row.
    steps: u32,
    black: u32,
    white: u32,
}

impl Samples {
    /// With every `step`-th of a row's pixels.
    #[inline(never)] // its sums are in registers
    fn and(self, pixels: &[u8], step: usize) -> Self {
        let Self { mut count, mut sum, mut steps, mut black, mut white } = self;
        let mut before = pixels.first().copied().unwrap_or(0).into();
        let mut x = 0;
        while let Some(&level) = pixels.get(x) {
            let level = u32::from(level);
            count += 1;
            sum += level;
            steps += level.abs_diff(before);
            before = level;
            if !(BLACK + 1..WHITE).contains(&level) {
                black += u32::from(level <= BLACK);
                white += u32::from(level >= WHITE);
            }
            x += step;
        }
        Self { count, sum, steps, black, white }
    }
}

/// Computes the statistics of an image; one whose samples differ by at most `flat` grey levels is
/// flat.
pub(super) fn check(image: Gray<'_>, flat: u8) -> CameraCheck {
    let dims = image.dims();
    // At least 1: an iterator with steps of 0 panics.
    let step = |side: u16, most: u16| usize::from(side.div_ceil(most).max(1));
    let (across, down) = (step(dims.width, COLUMNS), step(dims.height, ROWS));
    let rows = (down / 2..dims.height.into()).step_by(down).filter_map(|y| {
        let span = image.valid_columns(y as i32);
        image.row(y)?.get(usize::from(span.start)..usize::from(span.end))
    });
    let (mut samples, mut digest) = (Samples::default(), Fnv::EMPTY);
    let (mut valid, mut all) = (0_u32, 0_u32);
    for row in rows.clone() {
        valid += row.len() as u32;
        all += u32::from(dims.width);
        digest = with_row(digest, row);
        samples = samples.and(row.get(across / 2..).unwrap_or(&[]), across);
    }
    let Samples { count, sum, steps, black, white } = samples;
    let share = |sum: u32, of: i32| quotient(sum as i32 * of, count as i32);
    let health = CameraHealth {
        level: share(sum, 1) as u8,
        detail_q4: share(steps, 16) as u16,
        black_permille: share(black, 1000) as u16,
        white_permille: share(white, 1000) as u16,
        view_permille: quotient(valid as i32 * 1000, all as i32) as u16,
    };
    // No step is larger than the difference of the extremes, which few images need to be searched
    // for.
    let may_be_flat = steps <= count * u32::from(flat);
    let is_flat = may_be_flat && {
        let levels = rows.flat_map(|row| row.iter().skip(across / 2).step_by(across));
        let (low, high) =
            levels.fold((u8::MAX, 0), |(low, high), &level| (level.min(low), level.max(high)));
        high.saturating_sub(low) <= flat
    };
    CameraCheck { health, is_flat, digest: digest.value() }
}

/// The digest with a row's words, four at a time, and the bytes after the last one.
fn with_row(digest: Fnv, row: &[u8]) -> Fnv {
    let (words, rest) = row.as_chunks();
    let (fours, words) = words.as_chunks();
    let mixed = |digest: Fnv, &word: &[u8; 4]| digest.mixed(u32::from_le_bytes(word));
    let digest = fours
        .iter()
        .fold(digest, |digest, [a, b, c, d]| [a, b, c, d].into_iter().fold(digest, mixed));
    let digest = words.iter().fold(digest, mixed);
    rest.iter().fold(digest, |digest, &level| digest.mixed(level.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Dims, Span};

    const SMALL: Dims = Dims { width: 20, height: 16 };

    fn small(pixels: &[u8; 20 * 16]) -> Gray<'_> {
        Gray::new(pixels, SMALL, 20).unwrap()
    }

    #[test]
    fn statistics_of_a_small_image_are_those_of_all_of_its_pixels() {
        // Of each row of 20: two black, one white, two of 252, the others 70.
        let levels = [70, 0, 70, 2, 3, 70, 253, 70, 252, 252];
        let pixels = core::array::from_fn(|i| levels.get(i % 20).copied().unwrap_or(70));
        let sum = 14 * 70 + 2 + 3 + 253 + 2 * 252;
        let steps = 70 + 70 + 68 + 1 + 67 + 183 + 183 + 182 + 182;
        let health = CameraHealth {
            level: (sum / 20) as u8,
            detail_q4: (16 * steps / 20) as u16,
            black_permille: 100,
            white_permille: 50,
            view_permille: 1000,
        };
        assert_eq!(check(small(&pixels), 2).health, health);
        // Every other row and column alone, in the middle.
        let spans = core::array::from_fn::<_, 16, _>(|y| {
            if y % 2 == 0 { Span { start: 10, end: 20 } } else { Span::default() }
        });
        let inner = check(small(&pixels).with_valid(&spans).unwrap(), 2).health;
        assert_eq!(
            inner,
            CameraHealth { level: 70, view_permille: 250, ..CameraHealth::default() }
        );
    }

    #[test]
    fn a_large_image_is_sampled_in_the_middle_of_its_cells() {
        // Cells of 7 x 8 px: columns 3, 10 .. and rows 4, 12 ..
        let is_sample = |i: usize| i % 320 % 7 == 3 && i / 320 % 8 == 4;
        let image = |sample: u8, other: u8| -> [u8; 320 * 240] {
            core::array::from_fn(|i| if is_sample(i) { sample } else { other })
        };
        let of = |pixels: &[u8; 320 * 240]| {
            check(Gray::new(pixels, Dims { width: 320, height: 240 }, 320).unwrap(), 2)
        };
        let (plain, other) = (of(&image(90, 10)), of(&image(90, 11)));
        assert_eq!(
            plain.health,
            CameraHealth { level: 90, view_permille: 1000, ..CameraHealth::default() }
        );
        assert!(plain.is_flat && other.is_flat && plain.digest != other.digest);
        let mut with_a_light = image(90, 10);
        with_a_light[(4 + 8 * 5) * 320 + 3 + 7 * 10] = 120;
        assert!(!of(&with_a_light).is_flat);
    }

    #[test]
    fn an_image_is_flat_up_to_the_limit() {
        let with = |high: u8| {
            check(small(&core::array::from_fn(|i| if i == 77 { high } else { 50 })), 2).is_flat
        };
        assert_eq!([48, 47, 52, 53].map(with), [true, false, true, false]);
    }

    #[test]
    fn every_pixel_of_a_sampled_row_is_in_the_digest() {
        let digest = |changed: usize| {
            check(small(&core::array::from_fn(|i| u8::from(i == changed))), 2).digest
        };
        let same = digest(usize::MAX);
        assert!((0..320).all(|changed| digest(changed) != same));
        // Bytes behind the last word as well, and in order.
        let row = |row: &[u8]| with_row(Fnv::EMPTY, row);
        for length in 0..40 {
            let mut pixels = [7; 40];
            let (plain, at) = (row(&pixels[..length]), length.saturating_sub(1));
            pixels[at] = 8;
            assert_eq!(row(&pixels[..length]) == plain, length == 0, "{length}");
        }
        assert_ne!(row(&[1, 2, 3, 4, 5, 6, 7, 8]), row(&[5, 6, 7, 8, 1, 2, 3, 4]));
    }
}
