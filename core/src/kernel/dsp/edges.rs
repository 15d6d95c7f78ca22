//! Steps along a row or column, gradients where an edge crosses two of them, and second
//! differences.
//!
//! In: pixels of an image, the first one's index, the distance from one to the next. Out: the
//! largest step; the strongest of three positions.
//!
//! ```text
//! step:     size above, distance from the end below, in one word: the first of equals is the
//!           largest
//! crossing: two gradients from each pair of words (rows); sums of two adjacent pixels in an
//!           instruction (columns)
//! second:   four columns of nine words: what counts once or four times less twice what counts
//!           twice
//! ```
//!
//! # Cost
//! Instructions under QEMU, and those of the portable version: step over 8 pixels 131 (211),
//! crossing of columns 137 (171); inlined, where most are strongest in the middle, some 50.
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, Crossing, Crossings, LargestStep, RUN_PIXELS, strongest};
use super::{two_operands, word};

two_operands!(
    /// Absolute difference of two bytes.
    absolute_difference,
    "usad8 {r}, {a}, {b}"
);
two_operands!(
    /// Half words of the bytes 0 and 2, added.
    add_even_bytes,
    "uxtab16 {r}, {a}, {b}"
);
two_operands!(
    /// Half words of the bytes 1 and 3, added.
    add_odd_bytes,
    "uxtab16 {r}, {a}, {b}, ror #8"
);
two_operands!(
    /// Half word by half word; sets the GE flags.
    pub(super) dual_difference,
    "ssub16 {r}, {a}, {b}",
);
two_operands!(
    /// Sum of both products of signed half words.
    dual_products,
    "smuad {r}, {a}, {b}"
);

/// Half words of the bytes 0 and 2.
#[inline(always)]
pub(super) fn even_bytes(word: u32) -> u32 {
    word & 0x00ff_00ff // `uxtb16`
}

/// Half words of the bytes 1 and 3.
#[inline(always)]
pub(super) fn odd_bytes(word: u32) -> u32 {
    word >> 8 & 0x00ff_00ff
}

/// See [`portable::largest_step`].
#[inline]
pub fn largest_step(pixels: &[u8], stride: usize, count: usize) -> LargestStep {
    let there = count
        .checked_sub(1)
        .and_then(|last| last.checked_mul(stride))
        .is_some_and(|last| last < pixels.len());
    if !there || !(2..0xffff).contains(&count) {
        return portable::largest_step(pixels, stride, count);
    }
    let mut best = 0;
    // SAFETY: the last of `count` pixels was just found to exist: those read are the first, and
    // `count - 1` further ones each `stride` after the one before. `left` is 1 ..= count - 1, so
    // `place` and the pixel after it are among them.
    unsafe {
        let mut at = pixels.as_ptr();
        let mut before = u32::from(*at);
        for left in (1..count as u32).rev() {
            at = at.wrapping_add(stride);
            let after = u32::from(*at);
            // Size above, distance from the end below: the first of equals is the largest.
            best = best.max(absolute_difference(after, before) << 16 | left);
            before = after;
        }
        if best >> 16 == 0 {
            return LargestStep { place: 0, step: 0 };
        }
        let place = count - 1 - (best & 0xffff) as usize;
        let first = pixels.as_ptr().add(place * stride);
        LargestStep { place: place as i32, step: i32::from(*first.add(stride)) - i32::from(*first) }
    }
}

/// See [`portable::crossing`].
#[inline]
pub fn crossing(crossings: &Crossings<'_>, first: usize, sign: i32) -> Option<Crossing> {
    if first >= crossings.firsts {
        return None;
    }
    // SAFETY: two rows of seven pixels, or seven rows of two, are within the pixels from `first`
    // on, as constructors of `Crossings` see to.
    unsafe {
        let first = crossings.pixels.as_ptr().add(first);
        Some(if crossings.are_rows {
            crossing_of_rows(first, crossings.stride, sign)
        } else {
            crossing_of_columns(first, crossings.stride, sign)
        })
    }
}

/// The crossing of two rows.
///
/// # Safety
/// Seven pixels of each can be read.
#[inline(always)]
unsafe fn crossing_of_rows(first: *const u8, stride: usize, sign: i32) -> Crossing {
    // SAFETY: the caller's. Words begin at the fourth pixel at most.
    unsafe {
        let rows = [first, first.add(stride)];
        let words = |at: usize| rows.map(|row| word(row.add(at)));
        let sum = |at: usize| i32::from(*rows[0].add(at)) + i32::from(*rows[1].add(at));
        let ([above, below], [above_next, below_next]) = (words(1), words(2));
        let signs = (sign as u32) << 16 | (-sign & 0xffff) as u32;
        let gradients = [
            dual_products(add_even_bytes(even_bytes(above), below), signs) as i32,
            dual_products(add_odd_bytes(odd_bytes(above), below), signs) as i32,
            dual_products(add_odd_bytes(odd_bytes(above_next), below_next), signs) as i32,
        ];
        strongest(gradients, sign, sum, |shift| {
            let [above, below] = words((2 + shift) as usize);
            let outer =
                dual_products(dual_difference(even_bytes(below), even_bytes(above)), 0x0001_0001);
            let inner = dual_difference(odd_bytes(below), odd_bytes(above));
            (outer as i32).wrapping_add(dual_products(inner, 2) as i32)
        })
    }
}

/// The crossing of two columns.
///
/// # Safety
/// Two pixels of each of seven rows can be read.
#[inline(always)]
unsafe fn crossing_of_columns(first: *const u8, stride: usize, sign: i32) -> Crossing {
    // SAFETY: the caller's.
    unsafe {
        let pair = |at: *const u8| u32::from(at.cast::<u16>().read_unaligned());
        let sum = |u: usize| absolute_difference(pair(first.add(u * stride)), 0) as i32;
        let [b, c, d, e, f] = [1, 2, 3, 4, 5].map(sum);
        strongest([(d - b) * sign, (e - c) * sign, (f - d) * sign], sign, sum, |shift| {
            let from = first.add((2 + shift) as usize * stride);
            let [before, here, after] = [0, 1, 2].map(|u| pair(from.add(u * stride)));
            let outer = before | after << 16;
            let inner = (here >> 8) as i32 - (here & 0xff) as i32;
            dual_products(dual_difference(odd_bytes(outer), even_bytes(outer)), 0x0001_0001) as i32
                + 2 * inner
        })
    }
}

/// The size of the difference of each half word.
#[inline(always)]
fn dual_size(a: u32, b: u32) -> u32 {
    let result: u32;
    // SAFETY: registers alone; no other code uses the flags between two instructions.
    unsafe {
        asm!("ssub16 {t}, {b}, {a}", "ssub16 {r}, {a}, {b}", "sel {r}, {r}, {t}", t = out(reg) _,
            r = out(reg) result, a = in(reg) a, b = in(reg) b, options(pure, nomem, nostack));
    }
    result
}

/// See [`portable::second_differences`].
pub fn second_differences(rows: [&[u8; RUN_PIXELS]; 3], apart: usize) -> u32 {
    if !(1..=2).contains(&apart) {
        return 0;
    }
    let mut sizes = 0;
    for first in [0, 4] {
        // SAFETY: first + 2 * apart + 4 is at most the length of a row.
        let three = |row: &[u8; RUN_PIXELS]| unsafe {
            let at = row.as_ptr().add(first);
            [word(at), word(at.add(apart)), word(at.add(2 * apart))]
        };
        let [[a, b, c], [d, e, f], [g, h, i]] = rows.map(three);
        let sizes_of = |lanes: fn(u32) -> u32, add: fn(u32, u32) -> u32| {
            let once = add(add(add(lanes(a), c), g), i) + 4 * lanes(e);
            let twice = add(add(add(lanes(b), d), f), h);
            dual_size(once, 2 * twice)
        };
        // Each size is at most 8 * 255: sums of four fit half words.
        sizes += sizes_of(even_bytes, add_even_bytes) + sizes_of(odd_bytes, add_odd_bytes);
    }
    (sizes & 0xffff) + (sizes >> 16)
}
