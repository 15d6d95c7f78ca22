//! Likeness of both images at the same pixel, per thousand: one camera delivered twice, the pattern of a sensor, dirt on a common window, overlaid text.
//!
//! In: the pair and its support points. Out: the share of points without parallax, and the likeness of both images where the scene has some.
//!
//! ```text
//! still:    share of the credible points whose disparity is below 0.75 px
//! pattern:  of points with a disparity of at least 3 px, 8 gradients along the row, left and right at the same pixels:
//!           sum(left * right(x)) / energy - max over lags of 4 and 6 px to either side of |sum(left * right(x + lag))| / energy
//!           once as they are (strong and sparse: dirt, text), once limited to 12 grey levels (weak and everywhere: noise of columns); the larger
//! ```
//! A scene has no reason to look alike at the same pixel where its parallax is larger; a periodic texture, which may, is alike at other lags too.
//! Of 32 undamaged pairs, and 1200 with damages of other kinds, none but periodic textures on most of the picture has a pattern above 0.03.
//! Noise that is the same in both images, of 6 grey levels: 0.12 (median); an offset of each column, of 5: 0.25; text of 4 lines: 0.24.
//!
//! A pair that a board or the PC has rectified is looked at as rectified: what is at the same pixel of both sensors is not at the same pixel then.
//!
//! # Bounds
//! Gradients are at most 255: 8 products 520 200, sums of both energies of 256 points 2.7e8.
//!
//! # Cost
//! At most some [`POINTS`] points, 850 instructions each.

use crate::image::Gray;
use crate::support::Support;
use crate::units::Confidence;

/// Number of points that are looked at, about.
const POINTS: usize = 256;
/// Least number of points for either measurement.
const MIN_POINTS: u32 = 24;
/// Largest disparity of a point without parallax, 1/64 px.
const STILL_Q6: u16 = 48;
/// Least disparity of a point with parallax, 1/64 px.
const PARALLAX_Q6: i16 = 3 << 6;
/// Least probability of a point that counts as still or not.
const CREDIBLE: Confidence = Confidence::from_bits(0xc000);
/// Number of gradients of a point.
const GRADIENTS: usize = 8;
/// First gradient, relative to the point, px.
const FIRST: i32 = -3;
/// Largest lag compared, px.
const LAG: usize = 6;
/// First of the gradients at lags of 0, -6, -4, 4 and 6 px.
const LAGS: [usize; 5] = [LAG, 0, 2, 10, 12];
/// Largest gradient of the limited sums, grey levels.
const WEAK: i32 = 12;

/// Likeness of both images at the same pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Still {
    /// Share of the credible support points without parallax, per thousand.
    pub still_permille: u16,
    /// Likeness beyond what the scene explains, per thousand of the images' own energy; 0 with too few points to say.
    pub pattern_permille: i16,
}

/// Sums of products at each of [`LAGS`], and the energies of both sides.
#[derive(Default)]
struct Sums {
    products: [i32; LAGS.len()],
    energy: i32,
}

impl Sums {
    #[inline(never)] // its variables are in registers
    fn add(&mut self, left: &[i32; GRADIENTS], right: &[i32; GRADIENTS + 2 * LAG]) {
        let product = |a: &[i32; GRADIENTS], b: &[i32; GRADIENTS]| a.iter().zip(b).fold(0, |sum, (a, b)| sum + a * b);
        let at = |lag: usize| right.get(lag..).and_then(<[i32]>::first_chunk).unwrap_or(&[0; GRADIENTS]);
        for (sum, lag) in self.products.iter_mut().zip(LAGS) {
            *sum += product(left, at(lag));
        }
        self.energy += product(left, left) + product(at(LAG), at(LAG));
    }

    /// Excess of the product at lag 0 over the others, per thousand of the mean energy.
    fn excess_permille(&self) -> i16 {
        let [own, others @ ..] = self.products;
        let excess = own - others.iter().fold(0, |most, product| most.max(product.abs()));
        let permille = (2000 * i64::from(excess)).checked_div(self.energy.into()).unwrap_or(0);
        i16::try_from(permille.clamp(-1000, 1000)).unwrap_or(0)
    }
}

/// Measures the likeness; `None` with too few credible points.
pub(super) fn measure([left, right]: [Gray<'_>; 2], support: Support<'_>) -> Option<Still> {
    let step = support.len().div_ceil(POINTS).max(1);
    let (mut raw, mut weak) = (Sums::default(), Sums::default());
    let (mut at_left, mut at_right) = (Gradients::<GRADIENTS>::NONE, Gradients::<{ GRADIENTS + 2 * LAG }>::NONE);
    let (mut credible, mut still, mut compared) = (0, 0, 0);
    for ((x, y), point) in support.iter().step_by(step).filter(|(_, point)| point.is_matched()) {
        let disparity_q6 = point.disparity().to_bits();
        if point.confidence() >= CREDIBLE {
            credible += 1;
            still += u32::from(disparity_q6.unsigned_abs() < STILL_Q6);
        }
        if disparity_q6 >= PARALLAX_Q6
            && at_left.read(left, (x, y), 0).is_some()
            && at_right.read(right, (x, y), LAG).is_some()
        {
            compared += 1;
            raw.add(&at_left.raw, &at_right.raw);
            weak.add(&at_left.weak, &at_right.weak);
        }
    }
    (credible >= MIN_POINTS).then(|| Still {
        still_permille: u16::try_from((1000 * still).checked_div(credible).unwrap_or(0)).unwrap_or(0),
        pattern_permille: if compared < MIN_POINTS { 0 } else { raw.excess_permille().max(weak.excess_permille()) },
    })
}

/// Gradients along the row, as they are and limited.
struct Gradients<const N: usize> {
    raw: [i32; N],
    weak: [i32; N],
}

impl<const N: usize> Gradients<N> {
    const NONE: Self = Self { raw: [0; N], weak: [0; N] };

    /// Reads those around a point, from `before` px further left on; `None` where a pixel is not valid.
    #[inline(never)] // its variables are in registers
    fn read(&mut self, image: Gray<'_>, (x, y): (u16, u16), before: usize) -> Option<()> {
        let first = usize::try_from(i32::from(x) + FIRST - 1 - before as i32).ok()?;
        let valid = image.valid_columns(y.into());
        if first < usize::from(valid.start) || first + N + 2 > usize::from(valid.end) {
            return None;
        }
        let pixels = image.row(y.into())?.get(first..first + N + 2)?;
        let after = pixels.get(2..)?;
        for ((raw, weak), (before, after)) in self.raw.iter_mut().zip(&mut self.weak).zip(pixels.iter().zip(after)) {
            let gradient = i32::from(*after) - i32::from(*before);
            (*raw, *weak) = (gradient, gradient.clamp(-WEAK, WEAK));
        }
        Some(())
    }
}
