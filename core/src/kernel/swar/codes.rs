//! Codes of the texture of twelve rows, two of them in a word.
//!
//! In: rows of pixels. Out: columns of four codes.
//!
//! ```text
//! pixels    row r and row r + 4 in the halves of a word, r = 0 ..= 7
//! sums      exact, each 128 above its value: any bit above the lowest eight tells that bytes would
//!           be limited here, and the column is computed again byte by byte
//! codes     sums with those of the next column, at full scale by a table, halved
//! ```
//!
//! # Cost
//! A row of 320 columns: 57 000 to 83 000, by how many sums a byte limits (520 000). The table of
//! full scales has 2 KB.
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, CODE_FLAT, CODE_ROWS, CodeColumn};
use super::HALVES;

/// Rows that codes are made of.
const ROWS: usize = 2 * CODE_ROWS + 4;
/// Pairs of rows four apart.
const PAIRS: usize = ROWS - 4;
/// Offset of stored sums, 128 in each half word: none is negative.
const BIAS: u32 = 0x0080_0080;
/// A bit that half words from 0 on have when it is added.
const SIGN: u32 = 0x4000_4000;

/// Sums of a column, each limited to a byte, above [`BIAS`]: of rows of codes 0 and 2, and of 1 and
/// 3; along the row, then down.
type Sums = [u32; 4];

/// See [`portable::code_columns`].
pub fn code_columns(rows: [&[u8]; ROWS], doublings: u32, columns: &mut [CodeColumn]) {
    let width = columns.len();
    let are_whole = rows.iter().all(|row| row.len() >= width);
    let Some(inner) = width.checked_sub(2).and_then(|end| columns.get_mut(2..end)) else {
        return portable::code_columns(rows, doublings, columns);
    };
    let scale = doublings.checked_sub(1).and_then(|index| FULL_SCALE.get(index as usize));
    let Some(scale) = scale.filter(|_| are_whole) else {
        return portable::code_columns(rows, doublings, columns);
    };
    let rows = rows.map(|row| row.get(..width).unwrap_or_default());
    // Of the two columns before, below the bias.
    let mut before = [0, 1].map(|x| pairs(&rows, x).map(|pair| pair.wrapping_sub(BIAS)));
    let [even, odd] = &mut before;
    let mut sums = sums_of(&rows, 2, even);
    for (x, two) in (3..).step_by(2).zip(inner.chunks_mut(2)) {
        let next = sums_of(&rows, x, odd);
        let after = if two.len() == 2 { sums_of(&rows, x + 1, even) } else { next };
        for (column, (sums, next)) in two.iter_mut().zip([(sums, next), (next, after)]) {
            *column = codes(sums, next, scale);
        }
        sums = after;
    }
    for border in [0..2, width - 2..width] {
        if let Some(border) = columns.get_mut(border) {
            border.fill([CODE_FLAT; CODE_ROWS]);
        }
    }
}

/// Pixels of row r and row r + 4.
#[inline(always)]
fn pairs(rows: &[&[u8]; ROWS], x: usize) -> [u32; PAIRS] {
    let pixel = |row: usize| {
        // SAFETY: rows are constants below ROWS, columns below the width that all rows have.
        u32::from(unsafe { *rows.get_unchecked(row).get_unchecked(x) })
    };
    let pair = |row: usize| pixel(row) | pixel(row + 4) << 16;
    [pair(0), pair(1), pair(2), pair(3), pair(4), pair(5), pair(6), pair(7)]
}

/// Sums of column x. `before`: the pixels two columns before, below [`BIAS`]; then those of this
/// one.
#[inline(always)]
fn sums_of(rows: &[&[u8]; ROWS], x: usize, before: &mut [u32; PAIRS]) -> Sums {
    let here = pairs(rows, x);
    let [_, _, c, d, e, f, g, h] = here;
    let [_, _, c0, d0, e0, f0, g0, h0] = *before;
    *before = here.map(|pair| pair.wrapping_sub(BIAS));
    let [a0, b0, c1, d1, ..] = *before;
    let step = |after: u32, before: u32| byte(after.wrapping_sub(before));
    let sum = |a: u32, b: u32| byte(a.wrapping_add(b).wrapping_sub(BIAS));
    let first = sum(step(c, c0), step(d, d0));
    let second = sum(step(e, e0), step(f, f0));
    let third = sum(step(g, g0), step(h, h0));
    let down = sum(step(e, a0), step(f, b0));
    let down1 = sum(step(g, c1), step(h, d1));
    [sum(first, second), sum(second, third), down, down1]
}

/// Half words above [`BIAS`], limited to a byte. Where the lower one borrows from the upper one, it
/// is limited.
#[inline(always)]
fn byte(sums: u32) -> u32 {
    if sums & !HALVES == 0 { sums } else { limited(sums.wrapping_add(SIGN)) }
}

/// Codes of a column, from its sums and the next column's.
#[inline(always)]
fn codes(sums: Sums, next: Sums, scale: &FullScale) -> CodeColumn {
    let [along, along1, down, down1] = sums;
    let [along_next, along1_next, down_next, down1_next] = next;
    let codes = |along: u32, down: u32| {
        let at = |sum: u32| u32::from(*scale.get(sum as usize & (SUMS - 1)).unwrap_or(&0));
        [at(along) + at(down), at(along >> 16) + at(down >> 16)].map(|sum| (sum >> 1) as u8)
    };
    let [a, c] = codes(along + along_next, down + down_next);
    let [b, d] = codes(along1 + along1_next, down1 + down1_next);
    [a, b, c, d]
}

/// Number of sums of two bytes, 256 above their values.
const SUMS: usize = 512;

/// Sums, doubled some times and limited to a byte, 128 above their values.
type FullScale = [u8; SUMS];

/// Of one to four times.
const FULL_SCALE: [FullScale; 4] = [full_scale(1), full_scale(2), full_scale(3), full_scale(4)];

const fn full_scale(doublings: u32) -> FullScale {
    let mut scaled = [0; SUMS];
    let (mut value, mut rest) = (-256, scaled.as_mut_slice());
    while let Some((entry, after)) = rest.split_first_mut() {
        let level = (value << doublings) + 128;
        *entry = if level < 0 {
            0
        } else if level > 255 {
            255
        } else {
            level as u8
        };
        (value, rest) = (value + 1, after);
    }
    scaled
}

/// Half words that are [`SIGN`] above their values, limited to 0 ..= 255.
#[inline]
fn limited(sums: u32) -> u32 {
    let sign = sums & SIGN;
    let sums = sums & (sign - (sign >> 14));
    let over = (sums + (SIGN - 0x0100_0100)) & SIGN;
    (sums | (over - (over >> 14))) & HALVES
}
