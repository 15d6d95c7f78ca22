//! Difference of rows between the two images, measured at matches.
//!
//! In: the pair and its matches. Out: the vertical difference right - left, its spread, and the
//! number of matches measured.
//!
//! ```text
//! for each credible match that runs along the columns (|dx| >= 2 |dy|), most credible first:
//!     at 8 columns x: rows around the edge of the left image at x, of the right image at x -
//!                     disparity(x); mean over the columns
//!     gradients down the rows of both means; normalised correlation of the left one with the
//!         right one moved by -5 .. 5 px
//!     one clear peak of at least 0.83; the right gradients there correlated with the left ones
//!         moved by -1 and 1 px as well, so that texture
//!     beside the edge gives no bias: equal images differ by 0 exactly
//!     the vertex of the means of both correlations is a sample
//! median of the samples; mean of those near it; spread = median distance from the median
//! ```
//! The disparity of an edge along the columns follows from the texture beside it and does not
//! depend on its row, so the remaining difference is that of rows. Matching moves windows by whole
//! rows only, which does not change the difference.
//!
//! Horizontal stripes with a period below 10 px give several peaks and no sample; with larger
//! periods the difference within 5 px is measured. A pair without edges along the columns gives no
//! measurement.
//!
//! # Bounds
//! Levels Q6: 16 320; gradients (with weights 1 2 -2 -1 over 3) the same; 7 of them squared: 1.9e9.
//! Correlation by Cauchy and Schwarz. Disparity and position in 1/64 px below 2^17; slopes at most
//! 0.5 and 1, Q12, times an extent of 24 px in 1/32 px: 2^22.
//!
//! # Cost
//! Per match at most 8 * 34 pixels and 13 * 7 products; at most [`MOST_MEASURED`] matches.
//!
//! # Source
//! Normalised correlation with a sub-pixel vertex is standard. A parabola's vertex is biased
//! towards whole pixels, a Gaussian's away from them; the function used lies between.

use crate::image::Gray;
use crate::result::Match;
use crate::sort::sort_by_key;
use crate::units::quotient;
use heapless::Vec;

/// Most samples of a pair.
const MOST: usize = 24;
/// Most matches measured for them: captured pairs need up to 37, horizontal stripes have 157 that
/// give none.
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
/// Largest distance from the median of samples that are averaged, 1/256 px, or three times the
/// spread.
const NEAR_Q8: i16 = 32;

/// Difference of rows of one pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Rows {
    /// Row in the right image minus row in the left image, 1/256 px: positive when the right image
    /// is too low.
    pub offset_q8: i16,
    /// Median distance of a sample from the median, 1/256 px.
    pub spread_q8: u16,
    /// Number of matches measured.
    pub samples: u8,
}

/// Measures the difference of rows; `None` without a match that allows it.
pub(crate) fn measure(left: Gray<'_>, right: Gray<'_>, matches: &[Match]) -> Option<Rows> {
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
        let end = |point: crate::result::ImagePosition| {
            (i32::from(point.x.to_bits()), i32::from(point.y.to_bits()))
        };
        let ([a, b], [d0, d1]) =
            (found.ends.map(end), found.disparity.map(|d| i32::from(d.to_bits())));
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
        let (left, right): ([i32; LEFT_TAPS], [i32; RIGHT_TAPS]) =
            (gradients(&left), gradients(&right));
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
        // The mean with the reverse correlation may be higher beside the peak: then there is no
        // vertex.
        if peak <= low || peak <= high {
            return None;
        }
        i16::try_from((shift << 8) + vertex_q8(low, peak, high)).ok()
    }

    /// Mean levels (Q6) of the rows around the edge, in both images.
    fn profiles(
        &self,
        left: Gray<'_>,
        right: Gray<'_>,
    ) -> Option<([i32; LEFT_ROWS], [i32; RIGHT_ROWS])> {
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
                    || [y - reach, y + reach]
                        .into_iter()
                        .all(|y| image.valid_columns(y).contains(x))
            };
            let is_valid =
                is_usable(left, x, LEFT_FIRST) && is_usable(right, u_q6 >> 6, RIGHT_FIRST);
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

/// Adds levels (Q6) at a column given in 1/64 px, from row `y` down; `None` beyond the right
/// border.
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::image::{Dims, Span};
    use crate::result::{ImagePosition, Owner, Techniques};
    use crate::units::{Confidence, Disparity, Position};

    const DIMS: Dims = Dims { width: 64, height: 96 };
    pub(in crate::health) type Pixels = [u8; 64 * 96];

    fn painted(level: impl Fn(i32, i32) -> u8) -> Pixels {
        let mut pixels = [0; 64 * 96];
        for (pixel, i) in pixels.iter_mut().zip(0..) {
            *pixel = level(i % 64, i / 64);
        }
        pixels
    }

    pub(in crate::health) fn view(pixels: &Pixels) -> Gray<'_> {
        Gray::new(pixels, DIMS, 64).unwrap()
    }

    /// Ends in 1/32 px, disparities in 1/64 px.
    pub(in crate::health) fn matched(ends_q5: [(u16, u16); 2], disparity_q6: [i16; 2]) -> Match {
        let disparity = disparity_q6.map(Disparity::from_bits);
        Match {
            ends: ends_q5.map(|(x, y)| ImagePosition {
                x: Position::from_bits(x),
                y: Position::from_bits(y),
            }),
            disparity,
            sigma: Disparity::ZERO,
            confidence: Confidence::MAX,
            owner: Owner::Both,
            depth: None,
            depth_sigma: None,
            techniques: Techniques { feature: None, window: disparity[0], census: disparity[0] },
        }
    }

    #[test]
    fn an_edge_is_a_straight_line_with_a_disparity_that_changes_evenly() {
        // From (10.5, 20) to (42.5, 28) px, whose disparity grows from 8 to 10 px.
        let (a, b) = ((336, 640), (1360, 896));
        for edge in [matched([a, b], [512, 640]), matched([b, a], [640, 512])] {
            let edge = Edge::of(&edge).unwrap();
            let rows_q8 = |x: i32| 8 * 640 + 2 * (x * 32 - 336);
            for x in [11, 13, 26, 40, 42] {
                let (y, d_q6) = edge.at(x);
                assert!((256 * y - rows_q8(x)).abs() <= 128 + 8, "column {x}: row {y}");
                let exact_q6 = 512.0 + 4.0 * (f64::from(x) - 10.5);
                assert!(
                    (f64::from(d_q6) - exact_q6).abs() < 0.6,
                    "column {x}: {d_q6} for {exact_q6}"
                );
            }
        }
        // As steep as half a pixel a pixel, and five pixels long.
        let is_edge = |dx: u16, dy: i16| {
            Edge::of(&matched([(320, 640), (320 + dx, 640_u16.wrapping_add_signed(dy))], [0; 2]))
                .is_some()
        };
        assert_eq!(
            [(320, 160), (320, -160), (320, 161), (320, -161)].map(|(dx, dy)| is_edge(dx, dy)),
            [true, true, false, false]
        );
        assert_eq!([160, 159].map(|dx| is_edge(dx, 0)), [true, false]);
    }

    #[test]
    fn a_disparity_changes_by_a_pixel_a_pixel_at_most() {
        for sign in [1, -1] {
            let edge = Edge::of(&matched([(0, 0), (320, 0)], [0, sign * 6400])).unwrap();
            assert_eq!([1, 2, 10].map(|x| edge.at(x).1 * i32::from(sign)), [64, 128, 640]);
        }
    }

    #[test]
    fn a_column_between_two_is_their_weighted_mean() {
        let pixels = painted(|x, y| (3 * x + y / 2) as u8);
        let column = |x_q6: i32, y: i32| {
            let mut sums = [7; 3];
            add_column(view(&pixels), (x_q6, y), &mut sums).map(|()| sums.map(|sum| sum - 7))
        };
        // Three grey levels a column, so 3/64 each 64th of one.
        assert_eq!(column(64 * 10, 20), Some([64 * 40, 64 * 40, 64 * 41]));
        assert_eq!(column(64 * 10 + 16, 21), Some([64 * 40 + 48, 64 * 41 + 48, 64 * 41 + 48]));
        // The last column has no neighbour; there is none behind it, and no row below the last one.
        assert_eq!(column(64 * 62 + 63, 0), Some([64 * 186 + 189, 64 * 186 + 189, 64 * 187 + 189]));
        assert_eq!(
            [64 * 63, 64 * 63 + 40].map(|x_q6| column(x_q6, 0)),
            [Some([64 * 189, 64 * 189, 64 * 190]); 2]
        );
        assert_eq!([column(64 * 64, 0), column(0, 94), column(-64, 0)], [None; 3]);
        assert!(column(0, 93).is_some());
    }

    #[test]
    fn gradients_weigh_four_levels() {
        assert_eq!(
            gradients::<3>(&[6, 12, 18, 24, 30, 36, 42]),
            [16; 3],
            "8/3 of the step of a ramp"
        );
        assert_eq!(gradients::<5>(&[0, 0, 0, 0, 3, 0, 0, 0, 0]), [1, 2, 0, -2, -1]);
    }

    #[test]
    fn the_middle_of_the_sorted_values_is_their_median() {
        assert_eq!(median(&mut [5, -3, 9]), Some(5));
        assert_eq!(median(&mut [4, 1, 3, 2]), Some(3));
        assert_eq!(median(&mut []), None);
    }

    #[test]
    fn a_window_correlates_with_itself_fully() {
        let (window, opposite, other) =
            ([0, 192, -256, 0, 0, 0, 0], [0, -192, 256, 0, 0, 0, 0], [9, 256, 192, 0, 0, 0, 0]);
        let at = |gradients| Window::at(gradients, 0).unwrap();
        assert_eq!(at(&window).root, 320);
        let [own, reverse, none] =
            [&window, &opposite, &other].map(|with| at(&window).correlation_q12(&at(with)));
        assert_eq!([own, reverse, none], [4096, -4096, 0]);
        assert!(Window::at(&window, 1).is_none(), "six are no window");
    }

    /// Scores with this one at a shift, 100 elsewhere.
    fn scores<const N: usize>(high: [(i32, i32); N]) -> [i32; SHIFTS] {
        let mut scores = [100; SHIFTS];
        for (shift, score) in high {
            scores[(shift + REACH) as usize] = score;
        }
        scores
    }

    #[test]
    fn the_peak_is_high_inside_and_alone() {
        assert_eq!(only_peak(&scores([(2, 3400)])), Some((2, [100, 3400, 100])));
        assert_eq!(only_peak(&scores([(2, 3399)])), None, "too low");
        assert_eq!(
            [-5, -4, 4, 5].map(|shift| only_peak(&scores([(shift, 4000)])).is_some()),
            [false, true, true, false]
        );
        assert_eq!(
            only_peak(&scores([(1, 4000), (2, 4000)])),
            Some((1, [100, 4000, 4000])),
            "the first of equals"
        );
        for best in -4..=4_i32 {
            for second in (-5..=5_i32).filter(|second| second.abs_diff(best) >= 2) {
                // 200/256 of the peak is the most.
                let found = [3000, 3001]
                    .map(|score| only_peak(&scores([(best, 3840), (second, score)])).is_some());
                assert_eq!(found, [true, false], "{best} with {second}");
            }
        }
        // A slope is no peak, to whichever side it falls.
        for side in [-1, 1] {
            let slope = scores([(0, 4000), (side, 3900), (2 * side, 3800), (3 * side, 3700)]);
            assert_eq!(only_peak(&slope).map(|(shift, _)| shift), Some(0));
        }
    }

    #[test]
    fn the_vertex_lies_towards_the_higher_neighbour() {
        assert_eq!(vertex_q8(3000, 4096, 3000), 0);
        assert_eq!(
            [(4096, 2000), (2000, 4096)].map(|(low, high)| vertex_q8(low, 4096, high)),
            [-128, 128]
        );
        // Falls of 1/4 and 1/2, with a third of their squares 13/48 and 7/12: 15/82 of a pixel.
        assert_eq!(
            [(3072, 2048), (2048, 3072)].map(|(low, high)| vertex_q8(low, 4096, high)),
            [-46, 46]
        );
    }

    /// Rows at which a drawn step begins, and the levels between them.
    const STEPS: [i32; 4] = [20, 35, 49, 66];

    fn steps(y: i32) -> u8 {
        [60, 140, 40, 180, 90][STEPS.iter().filter(|&&step| y >= step).count()]
    }

    /// Edges that fall by a row in four columns, so that a wrong column is a wrong row as well; the
    /// right image is moved down, from a row on.
    pub(in crate::health) fn falling(moved: i32, from: i32) -> ([Pixels; 2], [Match; STEPS.len()]) {
        let left = painted(|x, y| steps(y - x / 4));
        let right = painted(|x, y| {
            let y = y - (x + 6) / 4;
            steps(if y < from { y } else { y - moved })
        });
        let edges = STEPS.map(|row| {
            let end = |x: u16| (32 * x, 32 * (row as u16 + x / 4));
            matched([end(8), end(56)], [6 << 6; 2])
        });
        ([left, right], edges)
    }

    #[test]
    fn edges_differ_by_the_rows_that_one_image_is_moved_by() {
        for moved in -4..=4 {
            let ([left, right], edges) = falling(moved, -100);
            let found = measure(view(&left), view(&right), &edges);
            assert_eq!(
                found,
                Some(Rows { offset_q8: 256 * moved as i16, spread_q8: 0, samples: 4 })
            );
        }
        let ([left, right], edges) = falling(0, 0);
        let upright = matched([(320, 320), (320, 1280)], [0; 2]);
        assert_eq!(measure(view(&left), view(&right), &[upright]), None);
        assert_eq!(measure(view(&[50; 64 * 96]), view(&right), &edges), None, "no edge there");
    }

    #[test]
    fn a_weak_edge_is_no_sample() {
        // Of a step of s levels the gradients are 64 s / 3 times 1, 3, 3, 1: their root is 95 s,
        // and 887 is asked for.
        let is_sample = |step: u8| {
            let pixels = painted(|_, y| if y < 35 { 100 } else { 100 + step });
            measure(
                view(&pixels),
                view(&pixels),
                &[matched([(320, 35 * 32), (1600, 35 * 32)], [0; 2])],
            )
            .is_some()
        };
        assert_eq!([9, 10].map(is_sample), [false, true]);
    }

    #[test]
    fn pixels_that_are_not_valid_are_not_compared() {
        let edge = |x0: u16, x1: u16, row: u16| {
            matched([(32 * x0, 32 * row), (32 * x1, 32 * row)], [6 << 6; 2])
        };
        let pixels = painted(|_, y| steps(y));
        let with = |spans: [&[Span; 96]; 2], edge: Match| {
            let [left, right] = spans.map(|spans| view(&pixels).with_valid(spans).unwrap());
            measure(left, right, &[edge]).is_some()
        };
        let whole = [Span { start: 0, end: 64 }; 96];
        let above = |rows: usize| {
            core::array::from_fn(|y| if y < rows { whole[y] } else { Span::default() })
        };
        let within = |start: u16, end: u16| [Span { start, end }; 96];
        let around = edge(10, 50, 35);
        assert!(with([&whole; 2], around));
        // The left profile takes six rows to either side, the right one ten.
        assert_eq!([41, 42].map(|rows| with([&above(rows), &whole], around)), [false, true]);
        assert_eq!([45, 46].map(|rows| with([&whole, &above(rows)], around)), [false, true]);
        // Columns 10, 16 .. 46 of the left image are looked at, and those 6 px before them in the
        // right one: five are enough.
        assert_eq!([34, 35].map(|end| with([&within(0, end), &whole], around)), [false, true]);
        assert_eq!([28, 29].map(|end| with([&whole, &within(0, end)], around)), [false, true]);
        // Right of the right image's left border.
        assert_eq!([13, 14].map(|end| with([&whole; 2], edge(0, end, 35))), [false, true]);
        let bordering = |row: u16| {
            let pixels = painted(|_, y| if y < i32::from(row) { 50 } else { 150 });
            measure(view(&pixels), view(&pixels), &[edge(10, 50, row)]).is_some()
        };
        assert_eq!([9, 10, 85, 86].map(bordering), [false, true, true, false]);
    }
}
