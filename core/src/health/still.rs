//! Likeness of both images at the same pixel, per thousand: one camera delivered twice, the pattern
//! of a sensor, dirt on a common window, overlaid text.
//!
//! In: the pair and its support points. Out: the share of points without parallax, and the likeness
//! of both images where the scene has some.
//!
//! ```text
//! still:    share of the credible points whose disparity is below 0.75 px
//! pattern:  of points with a disparity of at least 3 px, 8 gradients along the row, left and right
//!           at the same pixels:
//!           sum(left * right(x)) / energy - max over lags of 4 and 6 px to either side of |sum(left * right(x + lag))| / energy
//!           once as they are (strong and sparse: dirt, text), once limited to 12 grey levels
//!               (weak and everywhere: noise of columns); the larger
//! ```
//! Images wider than 450 px are compared by means of two pixels, and 3 px grow in proportion to the
//! width. A scene has no reason to look alike at the same pixel where its parallax is larger; a
//! periodic texture, which may, is alike at other lags too. `docs/experiments.md` has what damaged
//! and undamaged pairs show.
//!
//! A pair that a board or the PC has rectified is looked at as rectified: what is at the same pixel
//! of both sensors is not at the same pixel then.
//!
//! # Bounds
//! Gradients are at most 255: 8 products 520 200, sums of both energies of 256 points 2.7e8.
//!
//! # Cost
//! At most some [`POINTS`] points, 500 instructions each on a Cortex-M7, 400 of them the kernel.

use crate::image::Gray;
use crate::kernel::{LAGS, Products, add_products};
use crate::support::{Support, SupportPoint};
use crate::units::Confidence;

/// Number of points that are looked at, about.
const POINTS: usize = 256;
/// Least number of points for either measurement.
const MIN_POINTS: u32 = 24;
/// Largest disparity of a point without parallax, 1/64 px.
const STILL_Q6: u16 = 48;
/// Least disparity of a point with parallax in QVGA images, 1/64 px.
const PARALLAX_Q6: i32 = 3 << 6;
/// Least probability of a point that counts as still or not.
const CREDIBLE: Confidence = Confidence::from_bits(0xc000);
/// First pixel of a point's gradients in the left image, relative to the point, px.
const FIRST: i32 = -4;
/// First pixel in the right image: gradients at lag 0 are at the same pixels.
const RIGHT_FIRST: i32 = FIRST - LAGS[0] as i32;

/// Likeness of both images at the same pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Still {
    /// Share of the credible support points without parallax, per thousand.
    pub still_permille: u16,
    /// Likeness beyond what the scene explains, per thousand of the images' own energy; 0 with too
    /// few points to say.
    pub pattern_permille: i16,
}

/// Excess of the product at lag 0 over the others, per thousand of the mean energy.
fn excess_permille(sums: &Products) -> i16 {
    let [own, others @ ..] = sums.at_lags;
    let excess = own - others.iter().fold(0, |most, product| most.max(product.abs()));
    let permille = (2000 * i64::from(excess)).checked_div(sums.energy.into()).unwrap_or(0);
    i16::try_from(permille.clamp(-1000, 1000)).unwrap_or(0)
}

/// Measures the likeness; `None` with too few credible points.
pub(super) fn measure([left, right]: [Gray<'_>; 2], support: Support<'_>) -> Option<Still> {
    let step = support.len().div_ceil(POINTS).max(1);
    let mut sums = [Products::default(); 2];
    let parallax_q6 = super::at_width(PARALLAX_Q6, left.dims().width);
    let is_large = left.dims().is_large();
    let (mut credible, mut still, mut compared) = (0, 0, 0);
    let is_seen = |point: &SupportPoint| point.is_matched() && !point.is_of_bar();
    for ((x, y), point) in support.every(0, step).filter(|(_, point)| is_seen(point)) {
        let disparity_q6 = point.disparity().to_bits();
        if point.confidence() >= CREDIBLE {
            credible += 1;
            still += u32::from(disparity_q6.unsigned_abs() < STILL_Q6);
        }
        if i32::from(disparity_q6) >= parallax_q6
            && let Some(left) = pixels(left, (x, y), FIRST, is_large)
            && let Some(right) = pixels(right, (x, y), RIGHT_FIRST, is_large)
        {
            compared += 1;
            add_products(&left, &right, &mut sums);
        }
    }
    (credible >= MIN_POINTS).then(|| Still {
        still_permille: u16::try_from((1000 * still).checked_div(credible).unwrap_or(0))
            .unwrap_or(0),
        pattern_permille: if compared < MIN_POINTS {
            0
        } else {
            let [raw, weak] = sums.each_ref().map(excess_permille);
            raw.max(weak)
        },
    })
}

/// Pixels of a row from `first` px beside a point on, or means of two; `None` where one is not
/// valid.
fn pixels<const N: usize>(
    image: Gray<'_>,
    (x, y): (u16, u16),
    first: i32,
    by_two: bool,
) -> Option<[u8; N]> {
    let scale = if by_two { 2 } else { 1 };
    let x = usize::try_from(i32::from(x) + scale as i32 * first).ok()?;
    let valid = image.valid_columns(y.into());
    let is_valid = x >= usize::from(valid.start) && x + scale * N <= usize::from(valid.end);
    let row = image.row(y.into()).filter(|_| is_valid)?.get(x..)?;
    if !by_two {
        return row.first_chunk().copied();
    }
    let mut means = [0; N];
    for (mean, &[a, b]) in means.iter_mut().zip(row.as_chunks::<2>().0) {
        *mean = ((u16::from(a) + u16::from(b) + 1) >> 1) as u8;
    }
    Some(means)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::health::HealthLimits;
    use crate::image::{Dims, Span};
    use crate::params::Params;

    pub(in crate::health) const DIMS: Dims = Dims { width: 128, height: 96 };
    /// As many as of images of this size.
    pub(in crate::health) const GRID: usize = 16 * 12;

    #[test]
    fn the_excess_is_what_no_other_lag_explains() {
        let excess = |at_lags, energy| excess_permille(&Products { at_lags, energy });
        assert_eq!(excess([400, 50, -100, 20, 0], 1000), 600);
        assert_eq!(excess([100, 0, 0, 400, 0], 1000), -600);
        // Both sides alike: all of the mean energy.
        assert_eq!(excess([500, 0, 0, 0, 0], 1000), 1000);
        assert_eq!(excess([0; 5], 0), 0);
    }

    #[test]
    fn all_pixels_of_a_window_are_valid() {
        let pixels: [u8; 16 * 16] = core::array::from_fn(|i| i as u8);
        let image = Gray::new(&pixels, Dims { width: 16, height: 16 }, 16).unwrap();
        let at = |image, x: i32| self::pixels::<3>(image, (0, 2), x, false);
        assert_eq!(
            [-1, 0, 13, 14].map(|x| at(image, x)),
            [None, Some([32, 33, 34]), Some([45, 46, 47]), None]
        );
        let spans = [Span { start: 4, end: 9 }; 16];
        let image = image.with_valid(&spans).unwrap();
        assert_eq!([3, 4, 6, 7].map(|x| at(image, x).is_some()), [false, true, true, false]);
        // Means of two, from twice as far.
        let by_two = |x| self::pixels::<2>(image, (0, 2), x, true);
        assert_eq!([1, 2, 3].map(by_two), [None, Some([37, 39]), None]);
    }

    pub(in crate::health) fn noise(seed: u32) -> [u8; 128 * 96] {
        let mut state = seed;
        [(); 128 * 96].map(|()| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            100 + (state >> 27) as u8
        })
    }

    /// Points of a disparity, the first ones without parallax.
    fn measured(
        images: [&[u8; 128 * 96]; 2],
        disparity_q6: i16,
        still: usize,
        probability_q16: u16,
    ) -> Option<Still> {
        let point = |disparity_q6| SupportPoint::matched(disparity_q6, probability_q16);
        let points: [_; GRID] =
            core::array::from_fn(|i| point(if i < still { 47 } else { disparity_q6 }));
        let support = Support::new(&Params::default(), DIMS, &points, 0);
        measure(images.map(|pixels| Gray::new(pixels, DIMS, 128).unwrap()), support)
    }

    #[test]
    fn what_is_alike_at_the_same_pixel_is_no_scene_with_parallax() {
        let (one, other, limit) = (noise(1), noise(2), HealthLimits::DEFAULT.pattern_permille);
        let pattern = |images, disparity_q6| {
            measured(images, disparity_q6, 0, 0xffff).unwrap().pattern_permille
        };
        // All of the energy, less what noise has in common with itself at other lags.
        let alike = pattern([&one, &one], 10 << 6);
        assert!((900..=1000).contains(&alike), "{alike}");
        assert!(pattern([&one, &other], 10 << 6).abs() <= limit);
        // From 3 px of disparity on.
        assert_eq!(
            [PARALLAX_Q6 - 1, PARALLAX_Q6].map(|d_q6| pattern([&one, &one], d_q6 as i16) > 0),
            [false, true]
        );
        // Weak noise on a strong edge that is elsewhere in the other image.
        let with_edge = |pixels: &[u8; 128 * 96], at: usize| -> [u8; 128 * 96] {
            core::array::from_fn(|i| if i % 32 < at { pixels[i] / 8 } else { 200 + pixels[i] / 8 })
        };
        assert!(pattern([&with_edge(&one, 10), &with_edge(&one, 17)], 10 << 6) > limit);
    }

    #[test]
    fn still_points_are_counted_among_the_credible() {
        let image = noise(1);
        let still = |still, probability_q16| {
            measured([&image; 2], 48, still, probability_q16).map(|found| found.still_permille)
        };
        assert_eq!(
            [0, GRID / 4, GRID].map(|count| still(count, 0xc000)),
            [Some(0), Some(250), Some(1000)]
        );
        assert_eq!(still(GRID, 0xbfff), None, "none is credible");
    }
}
