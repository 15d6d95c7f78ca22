//! Steps along a row or column, and gradients where an edge crosses two of them.
//!
//! In: pixels of an image, the first one's index, the distance from one to the next. Out: the largest step; the strongest of three positions.
//!
//! ```text
//! step:     size above, distance from the end below, in one word: the first of equals is the largest
//! crossing: one check for all pixels instead of one each, the rest is portable
//! ```
//!
//! # Cost
//! Instructions under QEMU, and those of the portable version: step over 8 pixels 116 (185), crossing of rows 76 (80), of columns 99 (134).
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, Crossing, LargestStep};
use super::two_operands;

two_operands!(
    /// Absolute difference of two bytes.
    absolute_difference,
    "usad8 {r}, {a}, {b}"
);

/// See [`portable::largest_step`].
#[inline]
pub fn largest_step(pixels: &[u8], stride: usize, count: usize) -> LargestStep {
    let there = count.checked_sub(1).and_then(|last| last.checked_mul(stride)).is_some_and(|last| last < pixels.len());
    if !there || !(2..0xffff).contains(&count) {
        return portable::largest_step(pixels, stride, count);
    }
    let mut best = 0;
    // SAFETY: the last of `count` pixels was just found to exist: those read are the first, and `count - 1` further ones each `stride`
    // after the one before. `left` is 1 ..= count - 1, so `place` and the pixel after it are among them.
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

/// See [`portable::crossing_of_rows`].
#[inline]
pub fn crossing_of_rows(pixels: &[u8], first: usize, stride: usize, sign: i32) -> Option<Crossing> {
    if first.checked_add(stride)?.checked_add(7)? > pixels.len() {
        return None;
    }
    // SAFETY: the seventh pixel of the second row was just found to exist, and is behind all others; `crossing` reads seven.
    unsafe {
        let above = pixels.as_ptr().add(first);
        let below = above.add(stride);
        Some(portable::crossing(|u| *above.add(u), |u| *below.add(u), sign))
    }
}

/// See [`portable::crossing_of_columns`].
#[inline]
pub fn crossing_of_columns(pixels: &[u8], first: usize, stride: usize, sign: i32) -> Option<Crossing> {
    if stride.checked_mul(6)?.checked_add(first)?.checked_add(2)? > pixels.len() {
        return None;
    }
    // SAFETY: the second pixel of the seventh row was just found to exist, and is behind all others; `crossing` reads seven rows.
    unsafe {
        let at = pixels.as_ptr().add(first);
        Some(portable::crossing(|u| *at.add(u * stride), |u| *at.add(u * stride + 1), sign))
    }
}
