//! Difference of rows between the two images, measured at matches.
//!
//! In: the pair and its matches. Out: the vertical difference right - left, its spread, and the number of matches measured.
//!
//! ```text
//! for each credible match that runs along the columns (|dx| >= 2 |dy|), most credible first:
//!     at 8 columns x: rows around the edge of the left image at x, of the right image at x - disparity(x); mean over the columns
//!     gradients down the rows of both means; normalised correlation of the left one with the right one moved by -5 .. 5 px
//!     one clear peak of at least 0.83; the right gradients there correlated with the left ones moved by -1 and 1 px as well, so that texture
//!     beside the edge gives no bias: equal images differ by 0 exactly
//!     the vertex of the means of both correlations is a sample
//! median of the samples; mean of those near it; spread = median distance from the median
//! ```
//! The disparity of an edge along the columns follows from the texture beside it and does not depend on its row, so the remaining difference is
//! that of rows. Matching moves windows by whole rows only, which does not change the difference.
//!
//! Horizontal stripes with a period below 10 px give several peaks and no sample; with larger periods the difference within 5 px is measured. A
//! pair without edges along the columns gives no measurement.
//!
//! # Bounds
//! Levels Q6: 16 320; gradients (with weights 1 2 -2 -1 over 3) the same; 7 of them squared: 1.9e9. Correlation by Cauchy and Schwarz.
//! Disparity and position in 1/64 px below 2^17; slopes at most 0.5 and 1, Q12, times an extent of 24 px in 1/32 px: 2^22.
//!
//! # Cost
//! Per match at most 8 * 34 pixels and 13 * 7 products; at most [`MOST_MEASURED`] matches. 48 samples at 12 columns each cost 0.5 M instructions a
//! pair; the largest error against known offsets was 0.062 px then, and is 0.078 px now.
//!
//! # Source
//! Normalised correlation with a sub-pixel vertex is standard. A parabola's vertex is biased towards whole pixels (a shift of 0.3 px is measured
//! as 0.275), a Gaussian's away from them (0.316), both on 14 captured pairs moved by a windowed sinc; the function used lies between.

use crate::image::Gray;
use crate::result::Match;
use crate::sort::sort_by_key;
use crate::units::quotient;
use heapless::Vec;

/// Most samples of a pair.
const MOST: usize = 24;
/// Most matches measured for them: captured pairs need up to 37, horizontal stripes have 157 that give none.
const MOST_MEASURED: usize = 48;
/// Number of gradients compared on each side of the edge.
const HALF: i32 = 3;
/// Largest vertical difference compared, px; the peak lies inside.
const REACH: i32 = 5;
/// Least extent along the columns, px, and least number of columns evaluated.
const MIN_COLUMNS: i32 = 5;
/// Most columns evaluated.
const MAX_COLUMNS: i32 = 8;
/// Number of gradients of a window.
const TAPS: usize = 2 * HALF as usize + 1;
/// Number of gradients of three windows of the left image.
const LEFT_TAPS: usize = TAPS + 2;
/// Number of shifts compared.
const SHIFTS: usize = 2 * REACH as usize + 1;
/// Number of gradients of all windows of the right image.
const RIGHT_TAPS: usize = TAPS + SHIFTS - 1;
/// Rows of the left profile: a gradient takes two more at each end.
const LEFT_ROWS: usize = LEFT_TAPS + 4;
/// Rows of the right profile.
const RIGHT_ROWS: usize = RIGHT_TAPS + 4;
/// Rows from the first of the left profile to the edge.
const LEFT_FIRST: i32 = HALF + 3;
/// Rows from the first of the right profile to the edge.
const RIGHT_FIRST: i32 = HALF + 2 + REACH;
/// Least root of the sum of squared gradients: three of 8 grey levels a row.
const MIN_ROOT: u32 = 887;
/// Least correlation of a peak, Q12: 0.83.
const MIN_PEAK_Q12: i32 = 3400;
/// Largest ratio of another peak to it, Q8.
const MAX_SECOND_PEAK_Q8: i32 = 200;
/// Largest distance from the median of samples that are averaged, 1/256 px, or three times the spread.
const NEAR_Q8: i16 = 32;

/// Difference of rows of one pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Rows {
    /// Row in the right image minus row in the left image, 1/256 px: positive when the right image is too low.
    pub offset_q8: i16,
    /// Median distance of a sample from the median, 1/256 px.
    pub spread_q8: u16,
    /// Number of matches measured.
    pub samples: u8,
}

/// Measures the difference of rows; `None` without a match that allows it.
pub(super) fn measure(left: Gray<'_>, right: Gray<'_>, matches: &[Match]) -> Option<Rows> {
    let mut offsets: Vec<i16, MOST> = Vec::new();
    for edge in matches.iter().filter_map(Edge::of).take(MOST_MEASURED) {
        if let Some(offset) = edge.offset_q8(left, right)
            && offsets.push(offset).is_ok()
            && offsets.is_full()
        {
            break;
        }
    }
    let median = median(&mut offsets)?;
    let mut distances = offsets.clone();
    distances.iter_mut().for_each(|offset| *offset = (*offset - median).abs());
    let spread = self::median(&mut distances)?;
    let near = NEAR_Q8.max(3 * spread);
    let (mut sum, mut count) = (0, 0);
    for &offset in offsets.iter().filter(|&&offset| (offset - median).abs() <= near) {
        sum += i32::from(offset);
        count += 1;
    }
    Some(Rows {
        offset_q8: quotient(2 * sum + count * sum.signum(), 2 * count) as i16,
        spread_q8: spread.unsigned_abs(),
        samples: offsets.len() as u8,
    })
}

fn median(values: &mut [i16]) -> Option<i16> {
    sort_by_key(values, |&value| value);
    values.get(values.len() / 2).copied()
}

/// A matched edge along the columns, left end first.
#[derive(Clone, Copy)]
struct Edge {
    x0: i32,
    y0: i32,
    x1: i32,
    slope_q12: i32,
    d_q6: i32,
    /// Change of the disparity (1/64 px) per 1/32 px, Q12.
    d_slope_q12: i32,
}

impl Edge {
    fn of(found: &Match) -> Option<Self> {
        let end = |point: crate::result::ImagePosition| (i32::from(point.x.to_bits()), i32::from(point.y.to_bits()));
        let ([a, b], [d0, d1]) = (found.ends.map(end), found.disparity.map(|d| i32::from(d.to_bits())));
        let ((x0, y0), (x1, y1), d0, d1) = if a.0 <= b.0 { (a, b, d0, d1) } else { (b, a, d1, d0) };
        let (dx, dy) = (x1 - x0, y1 - y0);
        if dx < 2 * dy.abs() || dx < MIN_COLUMNS << 5 {
            return None;
        }
        Some(Self {
            x0,
            y0,
            x1,
            slope_q12: quotient(dy << 12, dx),
            d_q6: d0,
            d_slope_q12: quotient((d1 - d0) << 12, dx).clamp(-(1 << 13), 1 << 13),
        })
    }

    /// Nearest row and disparity, 1/64 px, at a column.
    fn at(&self, x: i32) -> (i32, i32) {
        let along = (x << 5) - self.x0;
        let line = |start: i32, slope_q12: i32| start + ((along * slope_q12 + 2048) >> 12);
        ((line(self.y0, self.slope_q12) + 16) >> 5, line(self.d_q6, self.d_slope_q12))
    }

    /// Vertical difference at this edge, 1/256 px.
    fn offset_q8(&self, left: Gray<'_>, right: Gray<'_>) -> Option<i16> {
        let (left, right) = self.profiles(left, right)?;
        let (left, right): ([i32; LEFT_TAPS], [i32; RIGHT_TAPS]) = (gradients(&left), gradients(&right));
        let centre = Window::at(&left, 1)?;
        if centre.root < MIN_ROOT {
            return None;
        }
        let mut scores = [0; SHIFTS];
        for (score, from) in scores.iter_mut().zip(0..) {
            *score = centre.correlation_q12(&Window::at(&right, from)?);
        }
        let (shift, [low, peak, high]) = only_peak(&scores)?;
        // The right image one row lower is the left one a row higher.
        let found = Window::at(&right, usize::try_from(shift + REACH).ok()?)?;
        let back = |from: usize| Some(Window::at(&left, from)?.correlation_q12(&found));
        let (low, high) = ((low + back(2)?) >> 1, (high + back(0)?) >> 1);
        // The mean with the reverse correlation may be higher beside the peak: then there is no vertex.
        if peak <= low || peak <= high {
            return None;
        }
        i16::try_from((shift << 8) + vertex_q8(low, peak, high)).ok()
    }

    /// Mean levels (Q6) of the rows around the edge, in both images.
    fn profiles(&self, left: Gray<'_>, right: Gray<'_>) -> Option<([i32; LEFT_ROWS], [i32; RIGHT_ROWS])> {
        let height = i32::from(left.dims().height);
        let (mut sums, mut right_sums) = ([0; LEFT_ROWS], [0; RIGHT_ROWS]);
        let (mut x, last) = ((self.x0 + 31) >> 5, self.x1 >> 5);
        let step = quotient(last - x + MAX_COLUMNS, MAX_COLUMNS).max(1);
        let mut columns = 0;
        while x <= last {
            let (y, d_q6) = self.at(x);
            let u_q6 = (x << 6) - d_q6;
            // Pixels of a rectified image that are not valid have no content.
            let is_usable = |image: Gray<'_>, x: i32, reach: i32| {
                image.valid().is_empty()
                    || [y - reach, y + reach].into_iter().all(|y| image.valid_columns(y).contains(x))
            };
            let is_valid = is_usable(left, x, LEFT_FIRST) && is_usable(right, u_q6 >> 6, RIGHT_FIRST);
            if is_valid && y >= RIGHT_FIRST && y + RIGHT_FIRST < height && u_q6 >= 0 {
                add_column(left, (x << 6, y - LEFT_FIRST), &mut sums)?;
                add_column(right, (u_q6, y - RIGHT_FIRST), &mut right_sums)?;
                columns += 1;
            }
            x += step;
        }
        if columns < MIN_COLUMNS {
            return None;
        }
        sums.iter_mut().chain(&mut right_sums).for_each(|sum| *sum = quotient(*sum, columns));
        Some((sums, right_sums))
    }
}

/// Adds levels (Q6) at a column given in 1/64 px, from row `y` down; `None` beyond the right border.
#[inline(never)] // its variables are in registers
fn add_column(image: Gray<'_>, (x_q6, y): (i32, i32), sums: &mut [i32]) -> Option<()> {
    let (pixels, stride) = image.as_slice();
    let (x, part) = (usize::try_from(x_q6 >> 6).ok()?, x_q6 & 63);
    // The last column has none to its right: it is the second one of its pair.
    let before_last = usize::from(image.dims().width).checked_sub(2)?;
    let (x, part) = match x.checked_sub(before_last) {
        None | Some(0) => (x, part),
        Some(1) => (before_last, 64),
        Some(_) => return None,
    };
    // Slices of one length: an index is checked once for both.
    let pairs = pixels.len().checked_sub(1)?;
    let (own, next) = (pixels.get(..pairs)?, pixels.get(1..)?.get(..pairs)?);
    let mut at = usize::try_from(y).ok()?.wrapping_mul(stride).wrapping_add(x);
    for sum in sums {
        let (a, b) = (i32::from(*own.get(at)?), i32::from(*next.get(at)?));
        *sum += (a << 6) + (b - a) * part;
        at = at.wrapping_add(stride);
    }
    Some(())
}

/// Smoothed gradients, Q6 grey levels per row.
fn gradients<const N: usize>(levels: &[i32]) -> [i32; N] {
    let mut out = [0; N];
    for (gradient, from) in out.iter_mut().zip(0..) {
        if let Some(&[a, b, _, d, e]) = levels.get(from..).and_then(<[i32]>::first_chunk) {
            *gradient = quotient(e + 2 * d - 2 * b - a, 3);
        }
    }
    out
}

/// Consecutive gradients with the root of the sum of their squares.
struct Window<'a> {
    gradients: &'a [i32],
    root: u32,
}

impl<'a> Window<'a> {
    fn at(gradients: &'a [i32], from: usize) -> Option<Self> {
        let gradients = gradients.get(from..)?.get(..TAPS)?;
        let energy: i32 = gradients.iter().map(|g| g * g).sum();
        Some(Self { gradients, root: (energy as u32).isqrt() })
    }

    /// Normalised correlation, Q12.
    fn correlation_q12(&self, other: &Self) -> i32 {
        let product: i32 = self.gradients.iter().zip(other.gradients).map(|(a, b)| a * b).sum();
        quotient(product, ((self.root * other.root) >> 12).max(1) as i32)
    }
}

/// The shift of the only high peak of the correlation, and the scores there and beside it.
fn only_peak(scores: &[i32; SHIFTS]) -> Option<(i32, [i32; 3])> {
    let at = |shift: i32| usize::try_from(shift + REACH).ok().and_then(|i| scores.get(i)).copied();
    let (mut peak, mut best) = (0, 0);
    for (&score, shift) in scores.iter().zip(-REACH..=REACH) {
        if score > peak {
            (peak, best) = (score, shift);
        }
    }
    // A peak at the end of the range is rejected: the true one may lie beyond.
    let (low, high) = (at(best - 1)?, at(best + 1)?);
    let is_second_peak = |shift: i32| {
        let score = at(shift).unwrap_or(i32::MIN);
        let is_top = at(shift - 1) <= Some(score) && at(shift + 1) <= Some(score);
        is_top && (shift - best).abs() >= 2 && score << 8 > peak * MAX_SECOND_PEAK_Q8
    };
    let is_clear = peak >= MIN_PEAK_Q12 && !(-REACH..=REACH).any(is_second_peak);
    is_clear.then_some((best, [low, peak, high]))
}

/// Position of the vertex through three scores relative to the middle one, the highest, 1/256 px.
fn vertex_q8(low: i32, peak: i32, high: i32) -> i32 {
    // Difference to the peak as a share of it, plus a third of its square: see Source.
    let fall = |score: i32| {
        let share = quotient((peak - score) << 12, peak).min(4096);
        share + quotient(share * share, 3 << 12)
    };
    let (low, high) = (fall(low), fall(high));
    quotient((low - high) << 7, low + high)
}
