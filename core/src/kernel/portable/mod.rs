//! Portable kernels: horizontal gradient and census of a row; cost curves over disparity and
//! operations on them; codes and paths of support points; edges; products of gradients.
//!
//! # Bounds
//! Gradients are 1 ..= 63, so an absolute difference is at most 62. A curve sums at most 32 strips
//! of 8: 32 * 8 * 62 = 15 872, and callers add at most two curves: fits `u16`; larger inputs wrap.
//! Hamming distances are at most 8 per point, and at most 31 points are summed per curve before
//! widening: 248 fits `u8`; more points wrap.
//!
//! # Cost
//! A pass over the slice given, whatever is in it; `programs/kernels` counts each on boards,
//! `xtask/board-numbers.toml` lists them.

pub(super) mod support;

pub use support::{
    CODE_FLAT, CODE_ROWS, CodeColumn, CodeMoments, JUMP_PENALTY, RUN_PIXELS, STEP_PENALTY,
    code_columns, code_costs, code_moments, code_steps, limited_steps, lowest_byte, path_step,
    place_of_byte, row_difference, second_differences, sum_paths,
};

/// Value of a zero gradient.
pub const FLAT: u8 = 32;
/// Disparities of a block of a curve.
pub const LANES: usize = 16;
/// Number of pixels of a strip.
pub const STRIP: usize = 8;

/// Eight adjacent pixels of one image and the row of the other in which they are searched: at
/// disparity index i, reference pixel k is compared with `other[i + k]`.
#[derive(Clone, Copy, Debug)]
pub struct Strip<'a> {
    /// Pixels of the reference image.
    pub reference: [u8; STRIP],
    /// Pixels of the other image, from the first candidate on.
    pub other: &'a [u8],
}

/// A quarter of Sobel x of the middle of three rows, clipped to +-31 and shifted by [`FLAT`]: 1 ..=
/// 63. A brightness offset between the cameras cancels. The first and last pixel are flat, and so
/// are entries of `out` beyond the row.
pub fn gradient_row(above: &[u8], row: &[u8], below: &[u8], out: &mut [u8]) {
    let width = row.len();
    out.fill(FLAT);
    let (Some(a1), Some(r1), Some(b1)) = (above.get(2..), row.get(2..), below.get(2..)) else {
        return;
    };
    let Some(inner) = width.checked_sub(1).and_then(|end| out.get_mut(1..end)) else { return };
    let left = above.iter().zip(row).zip(below);
    let right = a1.iter().zip(r1).zip(b1);
    for ((((a0, r0), b0), ((a2, r2), b2)), g) in left.zip(right).zip(inner) {
        let mean = |a: u8, r: u8, b: u8| (((i16::from(a) + i16::from(b)) >> 1) + i16::from(r)) >> 1;
        let step = mean(*a2, *r2, *b2) - mean(*a0, *r0, *b0);
        *g = (step.clamp(-31, 31) + i16::from(FLAT)) as u8;
    }
}

/// Census of the middle one of three rows, each two below the one before: one bit per neighbour at
/// distance 2 (eight directions), set where the neighbour is darker. The first and last two pixels
/// are 0, and so are entries of `out` beyond the row.
pub fn census_row(rows: [&[u8]; 3], out: &mut [u8]) {
    out.fill(0);
    let [top, row, bottom] = rows;
    let Some(inner) = row.len().checked_sub(2).and_then(|end| out.get_mut(2..end)) else { return };
    for (((t, r), b), code) in top.windows(5).zip(row.windows(5)).zip(bottom.windows(5)).zip(inner)
    {
        if let (Some(t), Some(r), Some(b)) = (t.first_chunk(), r.first_chunk(), b.first_chunk()) {
            *code = census_of(t, r, b);
        }
    }
}

/// Census of one pixel, two columns right of and two rows below `first`; rows are `stride` bytes
/// apart.
#[must_use]
pub fn census_code(pixels: &[u8], first: usize, stride: usize) -> Option<u8> {
    let row =
        |k: usize| pixels.get(stride.checked_mul(k)?.checked_add(first)?..)?.first_chunk::<5>();
    Some(census_of(row(0)?, row(2)?, row(4)?))
}

#[inline(always)]
pub(super) fn census_of(
    &[a, _, b, _, c]: &[u8; 5],
    &[d, _, centre, _, e]: &[u8; 5],
    &[f, _, g, _, h]: &[u8; 5],
) -> u8 {
    // Bit by bit: a loop is not unrolled where code is to be small, and takes twice as long.
    let bit = |neighbour: u8, place: u32| u8::from(neighbour < centre) << place;
    bit(a, 0) | bit(b, 1) | bit(c, 2) | bit(d, 3) | bit(e, 4) | bit(f, 5) | bit(g, 6) | bit(h, 7)
}

/// Adds the sum of absolute differences of all strips to each entry of `curve` (whole blocks of
/// [`LANES`], entries beyond stay; every strip's `other` holds `curve.len() + STRIP - 1` pixels,
/// strips with fewer are left out).
pub fn sad_curve(strips: &[Strip<'_>], curve: &mut [u16]) {
    let needed = curve.len() + STRIP - 1;
    for (block, costs) in curve.chunks_exact_mut(LANES).enumerate() {
        let start = block * LANES;
        let mut sums = [0_u16; LANES];
        for strip in strips.iter().filter(|strip| strip.other.len() >= needed) {
            let Some(others) =
                strip.other.get(start..).and_then(|o| o.first_chunk::<{ LANES + STRIP - 1 }>())
            else {
                continue;
            };
            for (k, &[r0, r1]) in (0..).step_by(2).zip(strip.reference.as_chunks::<2>().0) {
                let (Some(o0), Some(o1)) =
                    (others.get(k..k + LANES), others.get(k + 1..k + 1 + LANES))
                else {
                    continue;
                };
                for ((sum, &p), &q) in sums.iter_mut().zip(o0).zip(o1) {
                    // max - min vectorises where `abs_diff` widens to 32 bits.
                    let (a, b) = (p.max(r0) - p.min(r0), q.max(r1) - q.min(r1));
                    *sum = sum.wrapping_add(u16::from(a) + u16::from(b));
                }
            }
        }
        for (cost, sum) in costs.iter_mut().zip(sums) {
            *cost = cost.wrapping_add(sum);
        }
    }
}

/// Adds the Hamming distances between each reference code and `other[i]` to each entry of `curve`
/// (whole blocks of [`LANES`], entries beyond stay; at most 31 points; a point counts in the blocks
/// that its slice covers).
pub fn hamming_curve(points: &[(u8, &[u8])], curve: &mut [u16]) {
    for (block, costs) in curve.chunks_exact_mut(LANES).enumerate() {
        let start = block * LANES;
        let mut sums = [0_u8; LANES];
        for (reference, other) in points {
            let Some(others) = other.get(start..).and_then(|o| o.first_chunk::<LANES>()) else {
                continue;
            };
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

/// Entry by entry sum, saturating, over the length of the shortest curve.
pub fn sum_curve(a: &[u16], b: &[u16], out: &mut [u16]) {
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = a.saturating_add(b);
    }
}

/// Entry by entry minimum, over the length of the shortest curve.
pub fn lower_curve(a: &[u16], b: &[u16], out: &mut [u16]) {
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = a.min(b);
    }
}

/// Entry by entry minimum of `a` and `b`, plus `c`, saturating, over the length of the shortest
/// curve.
pub fn lower_sum_curve(a: &[u16], b: &[u16], c: &[u16], out: &mut [u16]) {
    for (((out, &a), &b), &c) in out.iter_mut().zip(a).zip(b).zip(c) {
        *out = a.min(b).saturating_add(c);
    }
}

/// Reverses a row.
pub fn reverse_row(row: &mut [u8]) {
    row.reverse();
}

/// The lowest entry; [`u16::MAX`] without entries.
#[must_use]
pub fn lowest(curve: &[u16]) -> u16 {
    curve.iter().fold(u16::MAX, |lowest, &cost| lowest.min(cost))
}

/// The largest difference between two consecutive pixels of a sequence; the first of equals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LargestStep {
    /// Index of the first of the two in the sequence.
    pub place: i32,
    /// The second minus the first.
    pub step: i32,
}

/// The largest step of a sequence of `count` pixels, `stride` bytes apart; a shorter slice ends the
/// sequence.
#[must_use]
pub fn largest_step(pixels: &[u8], stride: usize, count: usize) -> LargestStep {
    let mut best = LargestStep { place: 0, step: 0 };
    for (place, i) in (0..).zip(1..count) {
        let (Some(&after), Some(&before)) =
            (pixels.get(i.wrapping_mul(stride)), pixels.get((i - 1).wrapping_mul(stride)))
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

/// Gradients of an edge in two adjacent rows (columns), summed, at the strongest of three positions
/// across it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crossing {
    /// Position of the strongest gradient, px: -1, 0 or 1.
    pub shift: i32,
    /// Gradients before the strongest position, there and after it, times `sign`: four times grey
    /// levels per pixel.
    pub gradients: [i32; 3],
    /// Gradient along the edge, weighted `[1 2 1]` across it, in the same unit.
    pub along: i32,
}

/// Pixels in which edges cross two adjacent rows (columns).
#[derive(Clone, Copy, Debug)]
pub struct Crossings<'a> {
    pub(super) pixels: &'a [u8],
    pub(super) stride: usize,
    pub(super) are_rows: bool,
    /// A crossing is within the pixels when its first one is below this index.
    pub(super) firsts: usize,
}

impl<'a> Crossings<'a> {
    /// Of rows `y` and `y + 1`, `stride` bytes apart: a crossing next to column `x` begins at `(x -
    /// 3, y)`.
    #[must_use]
    pub const fn of_rows(pixels: &'a [u8], stride: usize) -> Self {
        let firsts = pixels.len().saturating_sub(stride.saturating_add(6));
        Self { pixels, stride, are_rows: true, firsts }
    }

    /// Of columns `x` and `x + 1` of rows `stride` bytes apart: a crossing next to row `y` begins
    /// at `(x, y - 3)`.
    #[must_use]
    pub const fn of_columns(pixels: &'a [u8], stride: usize) -> Self {
        let firsts = pixels.len().saturating_sub(stride.saturating_mul(6).saturating_add(1));
        Self { pixels, stride, are_rows: false, firsts }
    }

    /// All pixels.
    #[must_use]
    pub const fn pixels(&self) -> &'a [u8] {
        self.pixels
    }
}

/// The crossing that begins at the pixel with this index; `sign` is 1 or -1.
#[must_use]
pub fn crossing(crossings: &Crossings<'_>, first: usize, sign: i32) -> Option<Crossing> {
    let &Crossings { pixels, stride, are_rows, firsts } = crossings;
    if first >= firsts {
        return None;
    }
    let pixels = pixels.get(first..)?;
    if are_rows {
        let (first, second): (&[u8; 7], &[u8; 7]) =
            (pixels.first_chunk()?, pixels.get(stride..)?.first_chunk()?);
        let pair = |u: usize| first.get(u).zip(second.get(u)).map_or((0, 0), |(&a, &b)| (a, b));
        Some(crossing_of(pair, sign))
    } else {
        let pair = |u: usize| {
            let row = pixels.get(u * stride..).and_then(<[u8]>::first_chunk);
            row.map_or((0, 0), |&[a, b]| (a, b))
        };
        Some(crossing_of(pair, sign))
    }
}

/// The crossing of two rows of seven pixels, given as pairs; the middle one has index 3.
#[inline(always)]
fn crossing_of(pair: impl Fn(usize) -> (u8, u8), sign: i32) -> Crossing {
    let sum_and_step = |u: usize| {
        let (first, second) = pair(u);
        (i32::from(first) + i32::from(second), i32::from(second) - i32::from(first))
    };
    let sum = |u: usize| sum_and_step(u).0;
    let [b, c, d, e, f] = [1, 2, 3, 4, 5].map(sum);
    strongest([(d - b) * sign, (e - c) * sign, (f - d) * sign], sign, sum, |shift| {
        let step = |u: i32| sum_and_step((3 + shift + u) as usize).1;
        step(-1) + 2 * step(0) + step(1)
    })
}

/// The crossing where the gradient is the largest of these three, given sums of two pixels across
/// the edge and the gradient along it.
#[inline(always)]
pub(super) fn strongest(
    [g1, g2, g3]: [i32; 3],
    sign: i32,
    sum: impl Fn(usize) -> i32,
    along: impl Fn(i32) -> i32,
) -> Crossing {
    let (shift, gradients) = if g2 >= g1 && g2 >= g3 {
        (0, [g1, g2, g3])
    } else if g1 >= g3 {
        (-1, [(sum(2) - sum(0)) * sign, g1, g2])
    } else {
        (1, [g2, g3, (sum(6) - sum(4)) * sign])
    };
    Crossing { shift, gradients, along: along(shift) }
}

/// Number of gradients of the left row that are multiplied.
pub const GRADIENTS: usize = 8;
/// First of the gradients of the right row that are multiplied, at lags of 0, -6, -4, 4 and 6 px.
pub const LAGS: [usize; 5] = [6, 0, 2, 10, 12];
/// Number of gradients of the right row.
pub const RIGHT_GRADIENTS: usize = GRADIENTS + 12;
/// Largest size of a limited gradient, grey levels.
pub const WEAK: i32 = 12;

/// Sums of products of gradients along a left and a right row.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Products {
    /// Left times right at each of [`LAGS`].
    pub at_lags: [i32; LAGS.len()],
    /// Squares of both at lag 0.
    pub energy: i32,
}

/// Adds the products of gradients over two pixels, `[-1 0 1]`, wrapping: as they are, and limited
/// to [`WEAK`].
pub fn add_products(
    left: &[u8; GRADIENTS + 2],
    right: &[u8; RIGHT_GRADIENTS + 2],
    sums: &mut [Products; 2],
) {
    for (sums, most) in sums.iter_mut().zip([i32::from(u8::MAX), WEAK]) {
        let gradient = |pixels: &[u8], i: usize| {
            let at = |i: usize| pixels.get(i).copied().map_or(0, i32::from);
            (at(i + 2) - at(i)).max(-most).min(most) // not `clamp`, which panics where bounds are crossed
        };
        let left: [i32; GRADIENTS] = core::array::from_fn(|i| gradient(left, i));
        let right: [i32; RIGHT_GRADIENTS] = core::array::from_fn(|i| gradient(right, i));
        let from =
            |lag: usize| right.get(lag..).and_then(<[i32]>::first_chunk).unwrap_or(&[0; GRADIENTS]);
        let product = |a: &[i32; GRADIENTS], b: &[i32; GRADIENTS]| {
            a.iter().zip(b).fold(0, |sum, (a, b)| sum + a * b)
        };
        for (sum, lag) in sums.at_lags.iter_mut().zip(LAGS) {
            *sum = sum.wrapping_add(product(&left, from(lag)));
        }
        let own = from(LAGS[0]);
        sums.energy = sums.energy.wrapping_add(product(&left, &left) + product(own, own));
    }
}
