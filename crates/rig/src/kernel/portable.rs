//! Portable kernels: the definitions.
//!
//! # Bounds
//! See [`bilinear`] and [`weigh_knots`]. Positions and steps wrap; what they then lead to is
//! clamped.
//!
//! # Cost
//! A pass over the pixels or knots given.

/// Consecutive pixels between two rows: their columns by a polynomial of the second degree, their
/// rows on a straight line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Run {
    /// Index at which the upper row starts.
    pub top: u32,
    /// Index at which the lower row starts.
    pub bottom: u32,
    /// Column of the first pixel, px in Q16; the fraction counts down to 1/128.
    pub x_q16: i32,
    /// Step from the first pixel to the second, px in Q16.
    pub dx_q16: i32,
    /// Change from each step to the next, px in Q16.
    pub ddx_q16: i32,
    /// Distance of the first pixel below the upper row, px in Q14: 0 ..= 16 384, as for all pixels.
    pub fy_q14: i32,
    /// Step of that distance from pixel to pixel, px in Q14.
    pub dfy_q14: i32,
    /// Number of pixels.
    pub length: u32,
}

/// Rows of pixels in a ring: row `first` lies at the start, those before it at the end.
#[derive(Clone, Copy, Debug)]
pub struct Ring<'a> {
    /// The rows, and the bytes that may be read behind the last one: see [`columns`].
    pub bytes: &'a [u8],
    /// Width of a row, px.
    pub width: usize,
    /// Number of rows.
    pub rows: u32,
    /// Row at the start.
    pub first: i32,
}

impl Ring<'_> {
    /// Indices at which a row and the next one start. For a row that is not held, those of the row
    /// at the start.
    #[inline(always)] // as [`bilinear`]
    fn starts(&self, row: i32) -> [u32; 2] {
        let index = row.wrapping_sub(self.first);
        let index = (if index < 0 { index.wrapping_add(self.rows as i32) } else { index }) as u32;
        let index = if index < self.rows { index } else { 0 };
        let next = index.wrapping_add(1);
        [index, if next == self.rows { 0 } else { next }]
            .map(|index| index.wrapping_mul(self.width as u32))
    }
}

/// Distance between two knots, px.
pub const CELL: usize = 16;

/// Position in rows of pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Knot {
    /// Column, px in Q16.
    pub x: i32,
    /// Row, px in Q16.
    pub y: i32,
}

/// Weighted sums of four knots each, weights in Q30 with a sum of 1, by the upper halves of
/// products, one instruction on most cores. Each product is rounded down, by half of 2^-14 px on
/// average. As many sums as the shortest slice has knots.
pub fn weigh_knots(rows: [&[Knot]; 4], weights: [i32; 4], out: &mut [Knot]) {
    let ([a, b, c, d], [wa, wb, wc, wd]) = (rows, weights);
    let upper = |v: i32, weight: i32| ((i64::from(v) * i64::from(weight)) >> 32) as i32;
    let sum = |[a, b, c, d]: [i32; 4]| {
        let (a, b, c, d) = (upper(a, wa), upper(b, wb), upper(c, wc), upper(d, wd));
        a.wrapping_add(b).wrapping_add(c).wrapping_add(d).wrapping_add(2) << 2
    };
    for (out, (((a, b), c), d)) in out.iter_mut().zip(a.iter().zip(b).zip(c).zip(d)) {
        *out = Knot { x: sum([a.x, b.x, c.x, d.x]), y: sum([a.y, b.y, c.y, d.y]) };
    }
}

/// Half of the step of a column's fraction, Q16.
pub const X_ROUNDING: i32 = 1 << 8;

/// A grey level between four pixels, rounded to nearest: `fx_q7` 0 ..= 128 from left to right,
/// `fy_q14` 0 ..= 16 384 from top to bottom.
#[must_use]
#[inline(always)] // at level `s` it would be a call for each pixel
pub fn bilinear(top: [u8; 2], bottom: [u8; 2], fx_q7: i32, fy_q14: i32) -> u8 {
    // At most 255 * 2^7: fits `i16`. The sum is at most 255 * 2^21 + 2^20.
    let across = |[a, b]: [u8; 2]| i32::from(a) * (128 - fx_q7) + i32::from(b) * fx_q7;
    // Two weights in one word, as in `dsp`, so that other fractions give the same bits as
    // well.
    let weights = fy_q14.wrapping_mul(0xffff).wrapping_add(1 << 14);
    let (upper, lower) = (i32::from(weights as i16), i32::from((weights >> 16) as i16));
    let sum = (across(top) * upper).wrapping_add(across(bottom) * lower).wrapping_add(1 << 20);
    (sum as u32 >> 21) as u8
}

/// Two consecutive pixels from a column of the row that starts at `start`; 0 behind the end.
#[inline(always)] // as [`bilinear`]
fn two(rows: &[u8], start: u32, column: usize) -> [u8; 2] {
    let index = (start as usize).checked_add(column);
    let pixels = index.and_then(|index| rows.get(index..)).unwrap_or(&[]);
    [pixels.first().copied().unwrap_or(0), pixels.get(1).copied().unwrap_or(0)]
}

/// Number of columns that may be read in rows of this width: 512, 1024, 4096 or the next power of
/// two. Pixels behind a row may be read, but none beyond that. Few sizes, because a kernel holds
/// its code once for each.
#[must_use]
pub const fn columns(width: usize) -> usize {
    match width {
        0..=512 => 512,
        513..=1024 => 1024,
        1025..=4096 => 4096,
        _ => width.next_power_of_two(),
    }
}

/// [`bilinear`] at [`CELL`] pixels between the inner two of each four consecutive knots: columns by
/// the parabola whose second difference is the mean of those at both knots, rows on a straight
/// line. Columns are clamped to 0 .. [`columns`]; pixels behind the end of the ring are 0. Entries
/// of `out` beyond the cells stay.
pub fn bilinear_cells(ring: Ring<'_>, knots: &[Knot], out: &mut [u8]) {
    let last = i32::try_from(columns(ring.width.min(1 << 15)) - 1).unwrap_or(0);
    let fours = knots.windows(4).filter_map(|four| four.first_chunk::<4>());
    for (&[before, from, to, behind], out) in fours.zip(out.chunks_mut(CELL)) {
        let bend = before.x.wrapping_sub(from.x).wrapping_sub(to.x).wrapping_add(behind.x);
        let ddx_q16 = bend >> 9;
        let (mut x_q16, mut y_q14) = (from.x.wrapping_add(X_ROUNDING), from.y >> 2);
        // First step: the mean one minus the mean growth of the steps.
        let mut dx_q16 = to.x.wrapping_sub(from.x).wrapping_sub(ddx_q16.wrapping_mul(120)) >> 4;
        let dy_q14 = ((to.y >> 2) - y_q14) >> 4;
        for out in out {
            let column = (x_q16 >> 16).max(0).min(last) as usize;
            let [top, bottom] = ring.starts(y_q14 >> 14);
            let (top, bottom) = (two(ring.bytes, top, column), two(ring.bytes, bottom, column));
            *out = bilinear(top, bottom, x_q16 >> 9 & 127, y_q14 & 0x3fff);
            x_q16 = x_q16.wrapping_add(dx_q16);
            dx_q16 = dx_q16.wrapping_add(ddx_q16);
            y_q14 = y_q14.wrapping_add(dy_q14);
        }
    }
}

/// [`bilinear`] at each pixel of consecutive runs, between rows of `width` pixels that lie anywhere
/// in `rows`. Columns are clamped to 0 .. [`columns`]; pixels behind the end of `rows` are 0.
/// Entries of `out` beyond the runs stay.
pub fn bilinear_runs(rows: &[u8], width: usize, runs: &[Run], out: &mut [u8]) {
    let last = i32::try_from(columns(width.min(1 << 15)) - 1).unwrap_or(0);
    let mut left = out;
    for run in runs {
        let length = left.len().min(run.length as usize);
        let Some((out, behind)) = core::mem::take(&mut left).split_at_mut_checked(length) else {
            return;
        };
        left = behind;
        let Run { top, bottom, mut x_q16, mut dx_q16, ddx_q16, mut fy_q14, dfy_q14, .. } = *run;
        for out in out {
            let column = (x_q16 >> 16).max(0).min(last) as usize;
            let (top, bottom) = (two(rows, top, column), two(rows, bottom, column));
            *out = bilinear(top, bottom, x_q16 >> 9 & 127, fy_q14);
            x_q16 = x_q16.wrapping_add(dx_q16);
            dx_q16 = dx_q16.wrapping_add(ddx_q16);
            fy_q14 = fy_q14.wrapping_add(dfy_q14);
        }
    }
}
