//! Kernels of support points: costs of windows of codes, paths. Codes are in
//! [`codes`](super::codes).
//!
//! In: codes, curves of bytes over disparity. Out: costs, path costs and their sums.
//!
//! ```text
//! costs   four disparities a round; differences of half words, and a bit above them that says
//!         which are negative
//! path    what is left to `reach` in seven bits a byte; words without any keep the costs
//! lowest  a word is looked at byte by byte where one of them is below the lowest so far
//! ```
//!
//! # Cost
//! 64 disparities: costs 9984 (21 400), path 650 to 900 (1400), sums 750 (1100), lowest 190 (520).
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, CodeColumn, JUMP_PENALTY, STEP_PENALTY, STRIP};
use super::{HALVES, HIGH, four, whole_words, whole_words_mut};

/// Disparities at a time.
const BLOCK: usize = 4;
/// Columns that their windows reach.
const REACH: usize = BLOCK + STRIP - 1;
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
    let mut from = columns_of_words;
    let (blocks, rest) = costs.get_mut(..length).unwrap_or_default().as_chunks_mut();
    for block in blocks {
        let Some(columns) = from.first_chunk() else { return };
        *block = costs_of(&window, columns);
        from = from.get(BLOCK..).unwrap_or_default();
    }
    if !rest.is_empty() {
        let mut columns = [0; REACH];
        columns.iter_mut().zip(from).for_each(|(column, &codes)| *column = codes);
        rest.iter_mut().zip(costs_of(&window, &columns)).for_each(|(cost, of)| *cost = of);
    }
}

/// Costs of a window at a block of disparities.
#[inline(always)]
fn costs_of(window: &[[u32; 2]; STRIP], columns: &[u32; REACH]) -> [u8; BLOCK] {
    let halves = |column: u32| [column & HALVES, column >> 8 & HALVES];
    let [first, second, third, rest @ ..] = columns;
    let mut here = [halves(*first), halves(*second), halves(*third)];
    let mut sums = [2 * STRIP as u32 * 0x0001_0001; BLOCK];
    for (window, &column) in window.iter().zip(rest) {
        let ([a, b, c, d], [e, f, g], h) = (sums, here, halves(column));
        let add = |sum: u32, codes: [u32; 2]| add_differences(sum, window, codes);
        (sums, here) = ([add(a, e), add(b, f), add(c, g), add(d, h)], [f, g, h]);
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
    let mut low = Lowest::START;
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
        low.note(new);
        (before, here) = (here, after);
    }
    low.lowest().unwrap_or_else(|| portable::lowest_byte(path.get(..length).unwrap_or_default()))
}

/// Byte by byte maximum of bytes below 128.
#[inline(always)]
fn larger(a: u32, b: u32) -> u32 {
    let difference = (a | HIGH) - b;
    let is_larger = difference & HIGH;
    b + (difference & (is_larger - (is_larger >> 7)))
}

/// See [`portable::sum_paths`].
pub fn sum_paths(a: &[u8], b: &[u8], sums: &mut [u8]) -> u8 {
    let length = sums.len();
    let (Some(a), Some(b)) = (a.get(..length), b.get(..length)) else {
        return portable::sum_paths(a, b, sums);
    };
    let (([], a, []), ([], b, []), ([], words, [])) =
        (whole_words(a), whole_words(b), whole_words_mut(sums))
    else {
        return portable::sum_paths(a, b, sums);
    };
    let mut low = Lowest::START;
    for ((sum, &a), &b) in words.iter_mut().zip(a).zip(b) {
        let of = |word: u32| [word & HALVES, word >> 8 & HALVES];
        let ([a, c], [b, d], [e, f]) = (of(a), of(b), of(*sum));
        *sum = limited(a + b + e) | limited(c + d + f) << 8;
        low.note(*sum);
    }
    low.lowest().unwrap_or_else(|| portable::lowest_byte(sums))
}

/// Half words below 1024, at most 255.
#[inline(always)]
fn limited(sums: u32) -> u32 {
    let over = (sums + (0x0400_0400 - ABOVE)) & 0x0400_0400;
    (sums | (over - (over >> 8)) >> 2) & HALVES
}

/// See [`portable::lowest_byte`].
pub fn lowest_byte(costs: &[u8]) -> u8 {
    let (head, words, tail) = whole_words(costs);
    let mut low = Lowest::START;
    words.iter().for_each(|&word| low.note(word));
    match low.lowest() {
        Some(low) => head.iter().chain(tail).fold(low, |low, &cost| low.min(cost)),
        None => portable::lowest_byte(costs),
    }
}

/// The lowest byte of words, where it is below 127.
struct Lowest {
    low: u8,
    lows: u32,
}

impl Lowest {
    const START: Self = Self { low: 127, lows: four(127) };

    #[inline(always)]
    fn note(&mut self, word: u32) {
        if !(((word | HIGH) - self.lows) | word) & HIGH != 0 {
            self.low = word.to_ne_bytes().into_iter().fold(self.low, u8::min);
            self.lows = four(self.low);
        }
    }

    fn lowest(self) -> Option<u8> {
        (self.low < 127).then_some(self.low)
    }
}
