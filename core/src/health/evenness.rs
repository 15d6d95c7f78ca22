//! Difference of rows between the images, region by region, at support points, px.
//!
//! In: the pair and its support points. Out: by how many rows the right image is lower, and how
//! much this differs between parts of the image.
//!
//! ```text
//! sample   a credible point with detail down the rows: 8 x 4 gradients down the rows, left and
//!          right, compared with the right ones moved by -2 ..= 2 rows; sub-pixel minimum
//! offset   median of all samples
//! spread   largest less smallest median of the samples in each of 3 x 3 parts of the image; where
//!          70 % of all agree, of those parts whose samples agree
//! ```
//! A point is matched by texture that the rows need not fit to the pixel, and its depth is still
//! right. Where rows are apart by more, what is matched are look-alikes: the samples of these are
//! anywhere. Median edges of single matches ([`Rows`](super::Rows)) are more exact, but plain
//! scenes have few.
//!
//! # Bounds
//! A gradient is limited to +-32 levels: a cost is at most 4 * 8 * 64 = 2048.
//!
//! # Cost
//! Some 1000 instructions a sample, of which there are at most [`MOST`], and 400 for each of other
//! points without detail.

use crate::image::Gray;
use crate::kernel::{STRIP, limited_steps, row_difference};
use crate::sort::sort_by_key;
use crate::support::{Support, SupportPoint};
use crate::units::{Confidence, quotient};
use heapless::Vec;

/// Most samples.
const MOST: usize = 96;
/// Most points that are looked at for them.
const TRIES: usize = 3 * MOST;
/// Least number of samples of a pair.
const FEWEST: usize = 20;
/// Least number of samples that show that rows are right.
const LEAST_OF_WITNESS: u8 = 48;
/// Samples within so much of the median agree with it, 1/256 px.
const AGREE_Q8: u16 = 128;
/// Least number of samples in a part of the image.
const FEWEST_OF_PART: usize = 7;
/// Parts across and down.
const PARTS: i32 = 3;
/// Least number of parts with so many.
const FEWEST_PARTS: u32 = 3;
/// Points are taken at this step, then those after them: samples are spread over the image.
const STEP: usize = 7;
/// Least probability of a point.
const CREDIBLE: Confidence = Confidence::from_bits(0xc000);
/// Width of the window, px.
const COLUMNS: usize = STRIP;
/// First row of the window's gradients relative to the point; every second one is compared.
const FIRST: i32 = -3;
/// Rows of gradients of the left image: those of the window, and one below each.
const LEFT_ROWS: usize = 8;
/// Largest difference of rows compared, px.
const REACH: usize = 2;
/// Number of differences compared.
const SHIFTS: usize = 2 * REACH + 1;
/// Rows of gradients of the right image.
const RIGHT_ROWS: usize = LEFT_ROWS - 1 + 2 * REACH;
/// Largest gradient down the rows, grey levels in 2 px: one strong edge is not all.
const MOST_STEEP: u8 = 32;
/// Least sum of the differences of gradients one row apart, for a window to say where its rows are.
const LEAST_DETAIL: u16 = 120;

/// Gradients down a row of a window.
type Gradients = [u8; COLUMNS];

/// Difference of rows between the images of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Evenness {
    /// Rows that the right image is lower than where it was matched, 1/256 px.
    pub(super) offset_q8: i16,
    /// Difference between the parts of the image where it is largest and smallest, 1/256 px.
    pub(super) spread_q8: u16,
    /// Number of samples.
    pub(super) samples: u8,
    /// Number of these within half a pixel of the offset.
    pub(super) agree: u8,
}

impl Evenness {
    /// True when the samples show that the pair is matched on the right rows: of look-alikes they
    /// scatter. `docs/experiments.md` says how both lie beside nine tenths.
    pub(super) fn is_witness(self) -> bool {
        self.samples >= LEAST_OF_WITNESS
            && u32::from(self.agree) * 10 >= u32::from(self.samples) * 9
    }

    /// True when most samples agree: 74 to 88 % in dim rooms, at most 60 % in pairs of which one
    /// image is turned by 1.5 degrees or more and few segments match.
    pub(super) fn mostly_agrees(self) -> bool {
        u32::from(self.agree) * 10 >= u32::from(self.samples) * 7
    }
}

/// A sample: part of the image, difference of rows in 1/256 px.
type Sample = (u8, i16);

/// Measures the rows of a pair that was matched with rows moved by `row_offset`; `None` with too
/// few samples.
#[inline(never)] // its variables are on the stack only while it runs
pub(super) fn measure(
    images: [Gray<'_>; 2],
    support: Support<'_>,
    row_offset: i32,
) -> Option<Evenness> {
    let mut samples: Vec<Sample, MOST> = Vec::new();
    // Beside the ground plane rows of a window have disparities of their own, and so have columns
    // on a bar.
    let fits = |point: &SupportPoint| {
        point.is_matched()
            && !point.is_beside_ground()
            && !point.is_of_bar()
            && point.confidence() >= CREDIBLE
    };
    let points =
        (0..STEP).flat_map(|first| support.every(first, STEP)).filter(|(_, point)| fits(point));
    for ((x, y), point) in points.take(TRIES) {
        if let Some(offset_q8) = offset_q8(images, (x.into(), y.into()), point, row_offset)
            && samples.push((part(images, x, y), offset_q8)).is_err()
        {
            break;
        }
    }
    if samples.len() < FEWEST {
        return None;
    }
    sort_by_key(&mut samples, |&(_, offset_q8)| offset_q8);
    let (offset_q8, _, agree) = median(&samples, None)?;
    let even = |spread_q8| Evenness {
        offset_q8,
        spread_q8,
        samples: samples.len() as u8,
        agree: agree as u8,
    };
    // Samples of look-alikes in one part say nothing of rows that are right elsewhere.
    let needs_agreement = even(0).mostly_agrees();
    let (mut parts, mut least, mut most) = (0, i16::MAX, i16::MIN);
    for part in 0..(PARTS * PARTS) as u8 {
        if let Some((offset_q8, count, agree)) = median(&samples, Some(part))
            && count >= FEWEST_OF_PART
        {
            parts += 1;
            if !needs_agreement || 2 * agree >= count {
                (least, most) = (least.min(offset_q8), most.max(offset_q8));
            }
        }
    }
    (parts >= FEWEST_PARTS).then(|| even(if least > most { 0 } else { most.abs_diff(least) }))
}

/// Median of the samples of a part or of all, in order; their number, and the number of those that
/// agree with it.
fn median(samples: &[Sample], part: Option<u8>) -> Option<(i16, usize, usize)> {
    let of_part = || {
        let is_inside = move |sample: &&Sample| part.is_none_or(|part| sample.0 == part);
        samples.iter().filter(is_inside).map(|sample| sample.1)
    };
    let count = of_part().count();
    let median = of_part().nth(count / 2)?;
    Some((median, count, of_part().filter(|at| at.abs_diff(median) <= AGREE_Q8).count()))
}

/// Part of the image in which a pixel lies.
fn part([left, _]: [Gray<'_>; 2], x: u16, y: u16) -> u8 {
    let dims = left.dims();
    let of = |at: u16, length: u16| quotient(i32::from(at) * PARTS, i32::from(length));
    (of(y, dims.height) * PARTS + of(x, dims.width)) as u8
}

/// Difference of rows at a point, 1/256 px; `None` without detail down the rows.
fn offset_q8(
    [left, right]: [Gray<'_>; 2],
    (x, y): (i32, i32),
    point: &SupportPoint,
    row_offset: i32,
) -> Option<i16> {
    let (x, y) = (x - COLUMNS as i32 / 2, y + FIRST);
    let own: [Gradients; LEFT_ROWS] = gradients(left, x, y)?;
    let detail: u16 = own.as_chunks().0.iter().map(|[row, next]| row_difference(row, next)).sum();
    if detail < LEAST_DETAIL {
        return None;
    }
    let x_right = x - ((i32::from(point.disparity().to_bits()) + 32) >> 6);
    let others: [Gradients; RIGHT_ROWS] = gradients(right, x_right, y + row_offset - REACH as i32)?;
    let mut costs = [0_u16; SHIFTS];
    for (cost, others) in costs.iter_mut().zip(others.windows(LEFT_ROWS - 1)) {
        let rows = own.iter().zip(others).step_by(2);
        *cost = rows.map(|(own, other)| row_difference(own, other)).sum();
    }
    Some(minimum_q8(&costs))
}

/// Gradients down the rows, from this pixel on; `None` where one reads a pixel that is not valid.
fn gradients<const ROWS: usize>(image: Gray<'_>, x: i32, y: i32) -> Option<[Gradients; ROWS]> {
    let (pixels, stride) = image.as_slice();
    let (column, above) = (usize::try_from(x).ok()?, usize::try_from(y - 1).ok()?);
    let is_valid = |y: i32| {
        let valid = image.valid_columns(y);
        x >= i32::from(valid.start) && x + COLUMNS as i32 <= i32::from(valid.end)
    };
    let rows = if image.valid().is_empty() { y..y + 1 } else { y - 1..y + ROWS as i32 + 1 };
    if above + ROWS + 2 > usize::from(image.dims().height) || !rows.into_iter().all(is_valid) {
        return None;
    }
    let pixels = pixels.get(above.wrapping_mul(stride).wrapping_add(column)..)?;
    let mut out = [[0; COLUMNS]; ROWS];
    let mut at = 0;
    for row in &mut out {
        let (above, below) = (pixels.get(at..)?, pixels.get(at + 2 * stride..)?);
        limited_steps(above.get(..COLUMNS)?, below.get(..COLUMNS)?, MOST_STEEP, row);
        at += stride;
    }
    Some(out)
}

/// Sub-pixel place of the lowest cost, 1/256 px, 0 in the middle; at an end it is the end itself or
/// half a pixel before it.
fn minimum_q8(costs: &[u16; SHIFTS]) -> i16 {
    let (mut best, mut lowest) = (REACH, costs.get(REACH).copied().unwrap_or(0));
    for (at, &cost) in costs.iter().enumerate() {
        if cost < lowest {
            (best, lowest) = (at, cost);
        }
    }
    let beside = |at: Option<usize>| at.and_then(|at| costs.get(at)).map_or(lowest, |&cost| cost);
    let [before, after] =
        [best.checked_sub(1), best.checked_add(1)].map(|at| i32::from(beside(at)));
    let depth = before.max(after) - i32::from(lowest);
    (((best as i32 - REACH as i32) << 8) + quotient((before - after) << 7, depth.max(1))) as i16
}

#[cfg(test)]
mod tests {
    use super::super::still::tests::{DIMS, GRID, noise};
    use super::*;
    use crate::Params;

    /// Noise, and the same 10 px to the left with the rows of each column moved by so much.
    fn measured(row_of: impl Fn(usize, usize) -> i32, row_offset: i32) -> Option<Evenness> {
        let left = noise(3);
        let mut right = [100; 128 * 96];
        for (i, pixel) in right.iter_mut().enumerate() {
            let (x, y) = (i % 128, i / 128);
            let from = y as i32 - row_of(x, y);
            if x + 10 < 128 && (0..96).contains(&from) {
                *pixel = left[from as usize * 128 + x + 10];
            }
        }
        let points = [SupportPoint::matched(640, 0xc000); GRID];
        let support = Support::new(&Params::default(), DIMS, &points, 0);
        let images = [&left, &right].map(|pixels| Gray::new(pixels, DIMS, 128).unwrap());
        measure(images, support, row_offset)
    }

    #[test]
    fn a_moved_image_has_an_offset_and_no_spread() {
        for offset in [-2, -1, 0, 1, 2] {
            let found = measured(|_, _| offset, 0).unwrap();
            assert!(
                (i32::from(found.offset_q8) - (offset << 8)).abs() <= 128,
                "{offset}: {found:?}"
            );
            assert!(found.spread_q8 < 128, "{offset}: {found:?}");
        }
        assert!(measured(|_, _| 5, 5).unwrap().offset_q8.abs() < 64, "where it was matched");
    }

    #[test]
    fn parts_of_an_image_that_differ_are_a_spread() {
        let rolled = measured(|x, _| if x < 59 { -1 } else { 1 }, 0).unwrap();
        let magnified = measured(|_, y| if y < 48 { -1 } else { 1 }, 0).unwrap();
        for found in [rolled, magnified] {
            assert!((440..=600).contains(&found.spread_q8), "{found:?}");
        }
    }

    /// Look-alikes in one part, anywhere, beside rows that agree: the part says nothing.
    #[test]
    fn a_part_whose_samples_scatter_is_no_spread() {
        let anywhere = |x: usize, y: usize| [2, 1, -2, 2, 1][((x + 4) / 8 + (y + 4) / 8 * 2) % 5];
        let is_middle = |x, y| (43..85).contains(&x) && (32..64).contains(&y);
        let found = measured(|x, y| if is_middle(x, y) { anywhere(x, y) } else { 0 }, 0).unwrap();
        assert!(found.mostly_agrees() && found.agree < found.samples, "{found:?}");
        assert!(found.spread_q8 < 64, "{found:?}");
    }

    #[test]
    fn without_detail_nothing_is_measured() {
        let flat = [90; 128 * 96];
        let points = [SupportPoint::matched(0, u16::MAX); GRID];
        let support = Support::new(&Params::default(), DIMS, &points, 0);
        assert_eq!(measure([Gray::new(&flat, DIMS, 128).unwrap(); 2], support, 0), None);
    }
}
