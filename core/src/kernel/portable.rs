//! Portable kernels: horizontal gradient and census of a row; cost curves over disparity.
//!
//! # Bounds
//! Gradients are 1 ..= 127, so an absolute difference is at most 126 and two of them fit in `u8`. A curve sums at most 32 strips of 8:
//! 32 * 8 * 126 = 32 256, and callers add at most two curves: fits `u16`. Hamming distances are at most 8 per point, and at most
//! 31 points are summed per curve before widening: 248 fits `u8`.

/// Value of a zero gradient.
pub const FLAT: u8 = 32;
/// Disparities that one step of a curve advances.
pub const LANES: usize = 16;
/// Pixels of a strip.
pub const STRIP: usize = 8;

/// Eight neighbouring pixels of one image and the row of the other in which they are sought: at disparity index i, reference pixel k
/// meets `other[i + k]`.
#[derive(Clone, Copy, Debug)]
pub struct Strip<'a> {
    /// Pixels of the reference image.
    pub reference: [u8; STRIP],
    /// Pixels of the other image, from the first candidate on.
    pub other: &'a [u8],
}

/// Sobel x of the middle of three rows, halved, clipped to +-63 and shifted by [`FLAT`]: 1 ..= 127. A
/// brightness offset between the cameras cancels. The first and last pixel are flat.
pub fn gradient_row(above: &[u8], row: &[u8], below: &[u8], out: &mut [u8]) {
    let width = row.len();
    out.fill(FLAT);
    let (Some(a1), Some(r1), Some(b1)) = (above.get(2..), row.get(2..), below.get(2..)) else { return };
    let Some(inner) = width.checked_sub(1).and_then(|end| out.get_mut(1..end)) else { return };
    let left = above.iter().zip(row).zip(below);
    let right = a1.iter().zip(r1).zip(b1);
    for ((((a0, r0), b0), ((a2, r2), b2)), g) in left.zip(right).zip(inner) {
        let mean = |a: u8, r: u8, b: u8| (((i16::from(a) + i16::from(b)) >> 1) + i16::from(r)) >> 1;
        let step = mean(*a2, *r2, *b2) - mean(*a0, *r0, *b0);
        *g = (step.clamp(-31, 31) + i16::from(FLAT)) as u8;
    }
}

/// Census of the middle one of three rows, each two below the one before: one bit per neighbour at distance 2 (eight directions), set where the neighbour is darker.
/// The first and last two pixels are 0.
pub fn census_row(rows: [&[u8]; 3], out: &mut [u8]) {
    out.fill(0);
    let [top, row, bottom] = rows;
    let Some(inner) = row.len().checked_sub(2).and_then(|end| out.get_mut(2..end)) else { return };
    let centre = from(row, 2).iter();
    let upper = top.iter().zip(from(top, 2)).zip(from(top, 4));
    let middle = row.iter().zip(from(row, 4));
    let lower = bottom.iter().zip(from(bottom, 2)).zip(from(bottom, 4));
    for ((((c, ((a, b), d)), (e, f)), ((g, h), i)), code) in centre.zip(upper).zip(middle).zip(lower).zip(inner) {
        let darker = |neighbour: &u8, bit: u8| u8::from(neighbour < c) << bit;
        *code = darker(a, 0)
            | darker(b, 1)
            | darker(d, 2)
            | darker(e, 3)
            | darker(f, 4)
            | darker(g, 5)
            | darker(h, 6)
            | darker(i, 7);
    }
}

fn from(row: &[u8], start: usize) -> &[u8] {
    row.get(start..).unwrap_or(&[])
}

/// Adds the sum of absolute differences of all strips to each entry of `curve` (a multiple of [`LANES`] long; every strip's `other` holds
/// `curve.len() + STRIP - 1` pixels, a shorter one counts nothing).
pub fn sad_curve(strips: &[Strip<'_>], curve: &mut [u16]) {
    let needed = curve.len() + STRIP - 1;
    for (block, costs) in curve.chunks_exact_mut(LANES).enumerate() {
        let start = block * LANES;
        let mut sums = [0_u16; LANES];
        for strip in strips.iter().filter(|strip| strip.other.len() >= needed) {
            let Some(others) = strip.other.get(start..).and_then(|o| o.first_chunk::<{ LANES + STRIP - 1 }>()) else {
                continue;
            };
            for (k, &[r0, r1]) in (0..).step_by(2).zip(strip.reference.as_chunks::<2>().0) {
                let (Some(o0), Some(o1)) = (others.get(k..k + LANES), others.get(k + 1..k + 1 + LANES)) else {
                    continue;
                };
                for ((sum, &p), &q) in sums.iter_mut().zip(o0).zip(o1) {
                    // max - min vectorises where `abs_diff` widens to 32 bits; two differences fit in eight bits.
                    let (a, b) = (p.max(r0) - p.min(r0), q.max(r1) - q.min(r1));
                    *sum = sum.wrapping_add(u16::from(a.wrapping_add(b)));
                }
            }
        }
        for (cost, sum) in costs.iter_mut().zip(sums) {
            *cost = cost.wrapping_add(sum);
        }
    }
}

/// Adds the Hamming distances between each reference code and `other[i]` to each entry of `curve` (at most 31 points).
pub fn hamming_curve(points: &[(u8, &[u8])], curve: &mut [u16]) {
    for (block, costs) in curve.chunks_exact_mut(LANES).enumerate() {
        let start = block * LANES;
        let mut sums = [0_u8; LANES];
        for (reference, other) in points {
            let Some(others) = other.get(start..).and_then(|o| o.first_chunk::<LANES>()) else { continue };
            for (sum, &o) in sums.iter_mut().zip(others) {
                let mut bits = o ^ reference;
                bits -= (bits >> 1) & 0x55;
                bits = (bits & 0x33) + ((bits >> 2) & 0x33);
                *sum = sum.wrapping_add((bits + (bits >> 4)) & 0x0f);
            }
        }
        for (cost, sum) in costs.iter_mut().zip(sums) {
            *cost = cost.wrapping_add(u16::from(sum));
        }
    }
}

/// Entry by entry sum, saturating. All curves are equally long.
pub fn sum_curve(a: &[u16], b: &[u16], out: &mut [u16]) {
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = a.saturating_add(b);
    }
}

/// Entry by entry minimum.
pub fn lower_curve(a: &[u16], b: &[u16], out: &mut [u16]) {
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = a.min(b);
    }
}

/// Entry by entry minimum of `a` and `b`, plus `c`, saturating.
pub fn lower_sum_curve(a: &[u16], b: &[u16], c: &[u16], out: &mut [u16]) {
    for (((out, &a), &b), &c) in out.iter_mut().zip(a).zip(b).zip(c) {
        *out = a.min(b).saturating_add(c);
    }
}

/// The lowest entry; the largest value where there is none.
#[must_use]
pub fn lowest(curve: &[u16]) -> u16 {
    curve.iter().fold(u16::MAX, |lowest, &cost| lowest.min(cost))
}

/// The largest difference between two neighbours of a pixel: pixels from the second to the last but one, counted from 0; the first of equals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LargestStep {
    /// Which pixel.
    pub place: i32,
    /// The next pixel minus the one before.
    pub step: i32,
}

/// Over `count` pixels, `stride` apart; a slice that ends before them counts as far as it goes.
#[must_use]
pub fn largest_step(pixels: &[u8], stride: usize, count: usize) -> LargestStep {
    let mut best = LargestStep { place: 0, step: 0 };
    for (place, i) in (0..).zip(2..count) {
        let (Some(&after), Some(&before)) =
            (pixels.get(i.wrapping_mul(stride)), pixels.get((i - 2).wrapping_mul(stride)))
        else {
            break;
        };
        let step = i32::from(after) - i32::from(before);
        if step.abs() > best.step.abs() {
            best = LargestStep { place, step };
        }
    }
    best
}

/// `[1 2 1]` along three rows at five neighbouring columns, the first of them at `first`.
#[must_use]
pub fn smooth_rows(pixels: &[u8], first: usize, stride: usize) -> Option<[i32; 5]> {
    let row = |start: usize| pixels.get(start..).and_then(|row| row.first_chunk::<5>());
    let second = first.checked_add(stride)?;
    let (above, here, below) = (row(first)?, row(second)?, row(second.checked_add(stride)?)?);
    let mut sums = [0; 5];
    for (((sum, &a), &b), &c) in sums.iter_mut().zip(above).zip(here).zip(below) {
        *sum = i32::from(a) + 2 * i32::from(b) + i32::from(c);
    }
    Some(sums)
}

/// `[1 2 1]` along three columns at five neighbouring rows, the first of them at `first`.
#[must_use]
pub fn smooth_columns(pixels: &[u8], first: usize, stride: usize) -> Option<[i32; 5]> {
    let mut sums = [0; 5];
    let mut start = first;
    for sum in &mut sums {
        let &[a, b, c] = pixels.get(start..)?.first_chunk::<3>()?;
        *sum = i32::from(a) + 2 * i32::from(b) + i32::from(c);
        start = start.checked_add(stride)?;
    }
    Some(sums)
}

/// Difference between the third and the first of three rows, `[1 2 1]` over three columns from `first` on.
#[must_use]
pub fn across_rows(pixels: &[u8], first: usize, stride: usize) -> Option<i32> {
    let row = |start: usize| pixels.get(start..).and_then(|row| row.first_chunk::<3>()).map(weighted);
    Some(row(stride.checked_mul(2)?.checked_add(first)?)? - row(first)?)
}

/// Difference between the third and the first of three columns, `[1 2 1]` over three rows from `first` on.
#[must_use]
pub fn across_columns(pixels: &[u8], first: usize, stride: usize) -> Option<i32> {
    let mut sum = 0;
    for (k, weight) in [1, 2, 1].into_iter().enumerate() {
        let &[a, _, c] = pixels.get(stride.checked_mul(k)?.checked_add(first)?..)?.first_chunk::<3>()?;
        sum += weight * (i32::from(c) - i32::from(a));
    }
    Some(sum)
}

fn weighted(&[a, b, c]: &[u8; 3]) -> i32 {
    i32::from(a) + 2 * i32::from(b) + i32::from(c)
}
