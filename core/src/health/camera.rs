//! Statistics of one image of a pair on a coarse grid: level, saturation, detail, and a digest to detect repeated images.
//!
//! # Bounds
//! At most [`COLUMNS`] x [`ROWS`] samples of 8 bits: every sum is below 2^19; times 1000, 2^21. Pixels of at most 32 rows: times 1000, 2^26.
//!
//! # Cost
//! Some 14 instructions a sample, 1536 samples an image.

use crate::fnv::Fnv;
use crate::image::Gray;
use crate::units::quotient;

/// Most samples along a row.
const COLUMNS: u16 = 48;
/// Most rows with samples.
const ROWS: u16 = 32;
/// Largest level of a black pixel.
const BLACK: u8 = 2;
/// Least level of a white pixel.
const WHITE: u8 = 253;

/// Statistics of one camera's image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CameraHealth {
    /// Mean grey level, 0 ..= 255.
    pub level: u8,
    /// Mean grey step between adjacent samples of a row, 1/16 grey level: texture and noise.
    pub detail_q4: u16,
    /// Samples at 0 ..= 2 per thousand.
    pub black_permille: u16,
    /// Samples at 253 ..= 255 per thousand.
    pub white_permille: u16,
    /// Valid pixels ([`Gray::with_valid`]) per thousand: 1000 for images without a restriction. The other numbers refer to valid pixels.
    pub view_permille: u16,
}

/// Result of one image's check.
#[derive(Clone, Copy, Debug)]
pub(super) struct CameraCheck {
    pub(super) health: CameraHealth,
    /// Difference between the brightest and the darkest sample.
    pub(super) range: u8,
    /// Digest of all valid pixels of the sampled rows: equal for different ones with a probability of 2^-32.
    pub(super) digest: u32,
}

/// Computes the statistics of an image.
pub(super) fn check(image: Gray<'_>) -> CameraCheck {
    let dims = image.dims();
    let step = |side: u16, most: u16| usize::from(side.div_ceil(most));
    let (across, down) = (step(dims.width, COLUMNS), step(dims.height, ROWS));
    let (mut samples, mut sum, mut black, mut white, mut steps) = (0_u32, 0_u32, 0_u32, 0_u32, 0_u32);
    let (mut low, mut high, mut digest) = (u8::MAX, 0_u8, Fnv::EMPTY);
    let (mut valid, mut all) = (0_u32, 0_u32);
    let mut y = down / 2;
    while let Some(row) = image.row(y) {
        let span = image.valid_columns(y as i32);
        let row = row.get(usize::from(span.start)..usize::from(span.end)).unwrap_or(&[]);
        valid += row.len() as u32;
        all += u32::from(dims.width);
        let (words, rest) = row.as_chunks();
        let words = words.iter().map(|&word| u32::from_le_bytes(word));
        digest = words.chain(rest.iter().map(|&level| level.into())).fold(digest, Fnv::mixed);
        let mut x = across / 2;
        let mut before = row.get(x).copied().unwrap_or(0);
        while let Some(&level) = row.get(x) {
            samples += 1;
            sum += u32::from(level);
            black += u32::from(level <= BLACK);
            white += u32::from(level >= WHITE);
            steps += u32::from(level.abs_diff(before));
            low = low.min(level);
            high = high.max(level);
            before = level;
            x += across;
        }
        y += down;
    }
    let share = |count: u32, of: i32| quotient(count as i32 * of, samples as i32);
    let health = CameraHealth {
        level: share(sum, 1) as u8,
        detail_q4: share(steps, 16) as u16,
        black_permille: share(black, 1000) as u16,
        white_permille: share(white, 1000) as u16,
        view_permille: quotient(valid as i32 * 1000, all as i32) as u16,
    };
    CameraCheck { health, range: high.saturating_sub(low), digest: digest.value() }
}
