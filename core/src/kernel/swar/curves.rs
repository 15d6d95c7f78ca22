//! Curves of costs over disparity.
//!
//! In: eight pixels or a census code, and the row in which they are searched. Out: sums per
//! disparity.
//!
//! # Bounds
//! Bytes of two words are summed, of pixels up to 127, and of four words of pixels up to 63; strips
//! with larger pixels go the portable way.
//!
//! # Cost
//! 64 disparities: 12 strips 25 300 (55 500), 12 points 7700 (14 700).
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, LANES, STRIP, Strip};
use super::{HALVES, HIGH, copy_words, four, scaled};

/// Longest curve.
const LONGEST: usize = 256;
/// Words of a row in which a strip is searched.
const WORDS: usize = (LONGEST + STRIP) / 4 + 1;

/// A strip in whole words.
struct Words {
    /// The reference with the highest bit of each byte set.
    reference: [u32; 2],
    other: [u32; WORDS],
}

/// See [`portable::sad_curve`].
pub fn sad_curve(strips: &[Strip<'_>], curve: &mut [u16]) {
    let needed = curve.len() + STRIP - 1;
    let whole = curve.as_chunks_mut::<LANES>().0.as_flattened_mut();
    if whole.len() > LONGEST {
        return portable::sad_curve(strips, curve);
    }
    let mut words = [const { Words { reference: [0; 2], other: [0; WORDS] } }; 2];
    let [first, second] = &mut words;
    let used = whole.len() / 4 + 2;
    // Pixels of the strips that wait for others.
    let mut waiting = None;
    for strip in strips.iter().filter(|strip| strip.other.len() >= needed) {
        let place = if waiting.is_some() { &mut *second } else { &mut *first };
        let Some(other) = place.other.get_mut(..used) else { continue };
        copy_words(strip.other.get(..needed).unwrap_or_default(), other);
        let [a, b, c, d, e, f, g, h] = strip.reference;
        let reference = [u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h])];
        let all = other.iter().fold(reference[0] | reference[1], |all, word| all | word);
        if all & HIGH != 0 {
            portable::sad_curve(core::slice::from_ref(strip), whole);
            continue;
        }
        place.reference = reference.map(|word| word | HIGH);
        waiting = match waiting {
            None => Some(all),
            Some(before) if (all | before) & HIGH >> 1 == 0 => {
                add_strips::<_, true>([first, second], whole);
                None
            }
            Some(_) => {
                add_strips::<_, false>([first, second], whole);
                None
            }
        };
    }
    if waiting.is_some() {
        add_strips::<_, false>([first], whole);
    }
}

/// Adds one strip or two; both together where their pixels are `SMALL`, below 64.
#[inline(never)]
fn add_strips<const N: usize, const SMALL: bool>(strips: [&Words; N], curve: &mut [u16]) {
    add_strips_from::<0, N, SMALL>(strips, curve);
    add_strips_from::<1, N, SMALL>(strips, curve);
    add_strips_from::<2, N, SMALL>(strips, curve);
    add_strips_from::<3, N, SMALL>(strips, curve);
}

/// Adds to every fourth disparity from `PHASE` on.
#[inline(always)]
fn add_strips_from<const PHASE: u32, const N: usize, const SMALL: bool>(
    strips: [&Words; N],
    curve: &mut [u16],
) {
    let shifted = |low: u32, high: u32| {
        if PHASE == 0 { low } else { low >> (8 * PHASE) | high << (32 - 8 * PHASE) }
    };
    let mut states = strips.map(|strip| {
        let [low, high, next @ ..] = &strip.other;
        (strip.reference, shifted(*low, *high), *high, next.iter())
    });
    let halves = |sum: u32| (sum & HALVES) + (sum >> 8 & HALVES);
    for costs in curve.as_chunks_mut::<4>().0 {
        let (mut sum, mut sums) = (0_u32, 0);
        for ([first, second], low, high, next) in &mut states {
            let Some(&next) = next.next() else { return };
            let after = shifted(*high, next);
            // What both words are too small by.
            sum = sum.wrapping_add(HIGH << 1);
            sum = sum_less_differences(sum_less_differences(sum, *first, *low), *second, after);
            (*low, *high) = (after, next);
            if !SMALL {
                sums += halves(core::mem::take(&mut sum));
            }
        }
        if SMALL {
            sums = halves(sum);
        }
        let Some(cost) = costs.get_mut(PHASE as usize) else { return };
        *cost = cost.wrapping_add((sums.wrapping_mul(0x0001_0001) >> 16) as u16);
    }
}

/// A sum less 128 - |difference| of bytes below 128 each; the reference's have the highest bit set.
/// Bytes may borrow from each other until all are summed.
#[inline(always)]
fn sum_less_differences(sum: u32, reference: u32, other: u32) -> u32 {
    let difference = reference - other;
    // Seven bits where it is not negative, of 128 and more: all of it is subtracted from 255, 127
    // too much.
    let bits = scaled(difference & HIGH, 0x7f << 25);
    sum.wrapping_sub(difference ^ bits).wrapping_add(bits)
}

/// See [`portable::hamming_curve`].
pub fn hamming_curve(points: &[(u8, &[u8])], curve: &mut [u16]) {
    let blocks = curve.as_chunks_mut::<LANES>().0;
    if points.len() > 31 || blocks.len() > LONGEST / LANES {
        return portable::hamming_curve(points, curve);
    }
    let mut sums = [0_u32; LONGEST / 4];
    let mut words = [0; LONGEST / 4 + 1];
    for &(reference, other) in points {
        let used = blocks.len().min(other.len() / LANES) * LANES;
        let Some(words) = words.get_mut(..used / 4) else { continue };
        copy_words(other.get(..used).unwrap_or_default(), words);
        for (sum, word) in sums.iter_mut().zip(words) {
            let mut bits = *word ^ four(reference);
            bits -= (bits >> 1) & four(0x55);
            bits = (bits & four(0x33)) + ((bits >> 2) & four(0x33));
            *sum += (bits + (bits >> 4)) & four(0x0f);
        }
    }
    for (costs, sum) in blocks.as_flattened_mut().as_chunks_mut::<4>().0.iter_mut().zip(sums) {
        for (cost, sum) in costs.iter_mut().zip(sum.to_le_bytes()) {
            *cost = cost.wrapping_add(u16::from(sum));
        }
    }
}
