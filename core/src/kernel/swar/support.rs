//! Kernels of support points: costs of windows of codes, paths. Codes are in
//! [`codes`](super::codes).
//!
//! In: codes, curves of bytes over disparity. Out: costs, path costs.
//!
//! # Cost
//! 64 disparities: costs COST, path COST.
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, CodeColumn, JUMP_PENALTY, STEP_PENALTY, STRIP};
use super::{HALVES, HIGH, four, whole_words, whole_words_mut};

/// A bit above each half's byte.
const ABOVE: u32 = HALVES + 0x0001_0001;

/// See [`portable::code_costs`].
pub fn code_costs(window: &[CodeColumn; STRIP], columns: &[CodeColumn], costs: &mut [u8]) {
    let ([], columns_of_words, []) = whole_words(columns.as_flattened()) else {
        return portable::code_costs(window, columns, costs);
    };
    let window = window.map(|column| {
        let codes = u32::from_ne_bytes(column);
        [codes & HALVES | ABOVE, codes >> 8 & HALVES | ABOVE]
    });
    let length = (columns.len() + 1).saturating_sub(STRIP).min(costs.len());
    let (twos, last) = costs.get_mut(..length).unwrap_or_default().as_chunks_mut::<2>();
    for (two, columns) in twos.iter_mut().zip(columns_of_words.windows(STRIP + 1).step_by(2)) {
        if let Some(columns) = columns.first_chunk() {
            *two = two_costs(&window, columns);
        }
    }
    let rest = columns_of_words.get(2 * twos.len()..).and_then(<[u32]>::first_chunk);
    if let ([cost], Some(&[a, b, c, d, e, f, g, h])) = (last, rest) {
        [*cost, _] = two_costs(&window, &[a, b, c, d, e, f, g, h, h]);
    }
}

/// Costs of a window at two disparities.
#[inline(always)]
fn two_costs(window: &[[u32; 2]; STRIP], columns: &[u32; STRIP + 1]) -> [u8; 2] {
    let halves = |column: u32| [column & HALVES, column >> 8 & HALVES];
    let [first, rest @ ..] = columns;
    let mut here = halves(*first);
    let mut sums = [2 * STRIP as u32 * 0x0001_0001; 2];
    for (window, &column) in window.iter().zip(rest) {
        let next = halves(column);
        let [a, b] = sums;
        sums = [add_differences(a, window, here), add_differences(b, window, next)];
        here = next;
    }
    // Both halves of a sum, of which 1/64 is kept.
    sums.map(|sum| ((sum.wrapping_add(sum << 16)) >> 22) as u8 + JUMP_PENALTY)
}

/// Adds the absolute differences of two half words each; those of the window have a bit above.
#[inline(always)]
fn add_differences(sum: u32, window: &[u32; 2], codes: [u32; 2]) -> u32 {
    window.iter().zip(codes).fold(sum, |sum, (window, code)| {
        let difference = window.wrapping_sub(code);
        // 256 where it is not negative: 256 of the difference go, else it is 255 less the size,
        // and one is missing.
        let bits = (difference & ABOVE) >> 8;
        (difference ^ (bits + HALVES)).wrapping_add(sum).wrapping_sub(bits)
    })
}

/// See [`portable::path_step`].
pub fn path_step(costs: &[u8], lowest: u8, path: &mut [u8]) -> u8 {
    let length = path.len().min(costs.len());
    let reach = lowest.saturating_add(JUMP_PENALTY);
    let ([], costs_of_words, []) = whole_words(costs.get(..length).unwrap_or_default()) else {
        return portable::path_step(costs, lowest, path);
    };
    let whole = path.get_mut(..length).unwrap_or_default();
    let ([], words, []) = whole_words_mut(whole) else {
        return portable::path_step(costs, lowest, path);
    };
    // Seven bits hold all below `reach`, and the step penalty above.
    if reach > 127 - STEP_PENALTY {
        return portable::path_step(costs, lowest, path);
    }
    let reaches = four(reach) | HIGH;
    // What is left to `reach`, at least 0.
    let left = |word: u32| {
        let left = reaches - (word & !HIGH);
        let is_below = left & HIGH & !word;
        left & (is_below - (is_below >> 7))
    };
    let (mut low, mut lows) = (127, four(127));
    let mut before = 0;
    let mut here = words.first().map_or(0, |&first| left(first));
    for (i, &cost) in costs_of_words.iter().enumerate() {
        let after = words.get(i + 1).map_or(0, |&after| left(after));
        let (earlier, later) = (here << 8 | before >> 24, here >> 8 | after << 24);
        let new = if earlier | here | later == 0 {
            cost
        } else {
            let near = larger(earlier, later);
            let most = larger(near, here + four(STEP_PENALTY)) - four(STEP_PENALTY);
            ((cost | HIGH) - most) ^ (!cost & HIGH)
        };
        if let Some(word) = words.get_mut(i) {
            *word = new;
        }
        if !(((new | HIGH) - lows) | new) & HIGH != 0 {
            low = new.to_ne_bytes().into_iter().fold(low, u8::min);
            lows = four(low);
        }
        (before, here) = (here, after);
    }
    if low < 127 { low } else { portable::lowest_byte(path.get(..length).unwrap_or_default()) }
}

/// Byte by byte maximum of bytes below 128.
#[inline(always)]
fn larger(a: u32, b: u32) -> u32 {
    let difference = (a | HIGH) - b;
    let is_larger = difference & HIGH;
    b + (difference & (is_larger - (is_larger >> 7)))
}
