//! Kernels of support points: costs of windows of codes, paths. Codes are in
//! [`codes`](super::codes).
//!
//! In: codes, curves of bytes over disparity. Out: costs, path costs and their sums.
//!
//! ```text
//! costs   what three codes of the window are above three others, by a bit above each difference
//!         that says which are negative; sums of codes give the rest
//! path    what is left to `reach` in seven bits a byte; words without any keep the costs
//! lowest  a word is looked at byte by byte where one of them is below the lowest so far
//! ```
//!
//! # Cost
//! 64 disparities: costs 7840 (21 400), in spread columns 5900; path 600 to 900 (1400), sums 720
//! (1100), lowest 190 (520).
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, CodeColumn, JUMP_PENALTY, STEP_PENALTY, STRIP};
use super::{HALVES, HIGH, four, scaled, whole_words, whole_words_mut};
use core::cell::Cell;
use core::mem::MaybeUninit;

/// Most disparities at a time.
const BLOCK: usize = 64;
/// Columns that their windows reach.
const REACH: usize = BLOCK + STRIP - 1;
/// A bit above each of three codes, which lie ten bits apart.
const ABOVE: u32 = 1 << 8 | 1 << 18 | 1 << 28;
/// The second of three sums.
const MIDDLE: u32 = 0x3ff << 10;

/// A column of codes of those in which a window is searched.
#[repr(C)]
struct Column {
    /// Its first three codes.
    three: u32,
    /// The fourth of the two columns before and of this one.
    fourths: u32,
    /// Sum of all codes of the columns up to this one.
    sum: u32,
}

impl Column {
    /// Sum of all codes of the columns before this one.
    fn before(&self) -> u32 {
        let codes = |three: u32| (three & 0x3ff) + (three >> 10 & 0x3ff) + (three >> 20);
        self.sum - codes(self.three) - (self.fourths >> 20)
    }
}

/// A window, with the bits [`ABOVE`].
struct Window {
    threes: [u32; STRIP],
    fourths: [u32; 3],
    sum: u32,
}

/// See [`portable::code_costs`].
pub fn code_costs(window: &[CodeColumn; STRIP], columns: &[CodeColumn], costs: &mut [u8]) {
    let length = (columns.len() + 1).saturating_sub(STRIP).min(costs.len());
    let words = [window, columns].map(|columns| whole_words(columns.as_flattened()));
    let [([], of_window, []), ([], mut columns, [])] = words else {
        return portable::code_costs(window, columns, costs);
    };
    let Some(window) = of_window.first_chunk().map(Window::new) else { return };
    let mut memory = [const { MaybeUninit::uninit() }; REACH];
    for costs in costs.get_mut(..length).unwrap_or_default().chunks_mut(BLOCK) {
        let reached = columns.get(..costs.len() + STRIP - 1).unwrap_or_default();
        window.search(spread(reached.iter().copied(), &mut memory), costs);
        columns = columns.get(BLOCK..).unwrap_or_default();
    }
}

/// Bytes in which so many columns are spread, for [`code_costs_in`].
pub const fn spread_bytes(columns: usize) -> usize {
    size_of::<Column>() * columns + align_of::<Column>() - 1
}

/// Spreads columns of codes, once for all windows that are searched in them.
pub fn spread_codes(columns: &[CodeColumn], memory: &mut [u8]) {
    // SAFETY: columns are words without padding, written whole.
    let (_, memory, _) = unsafe { memory.align_to_mut::<MaybeUninit<Column>>() };
    match whole_words(columns.as_flattened()) {
        ([], words, []) => spread(words.iter().copied(), memory),
        _ => spread(columns.iter().map(|&column| u32::from_ne_bytes(column)), memory),
    };
}

/// [`code_costs`] along the columns from `first` on, of those spread in this memory, if it holds
/// any.
pub fn code_costs_in(
    window: &[CodeColumn; STRIP],
    columns: &[CodeColumn],
    first: usize,
    memory: &[u8],
    costs: &mut [u8],
) {
    let from = columns.get(first..).unwrap_or_default();
    // SAFETY: any bytes are words.
    let (_, spread, _) = unsafe { memory.align_to::<Column>() };
    let ([], of_window, []) = whole_words(window.as_flattened()) else {
        return code_costs(window, from, costs);
    };
    match (spread.get(first..columns.len()), of_window.first_chunk()) {
        (Some(spread), Some(codes)) => Window::new(codes).search(spread, costs),
        _ => code_costs(window, from, costs),
    }
}

/// The first three codes of a column, ten bits apart.
#[inline(always)]
fn three(codes: u32) -> u32 {
    codes & 0xff | (codes & 0xff00) << 2 | (codes & 0x00ff_0000) << 4
}

/// Sum of four codes.
#[inline(always)]
fn sum_of(codes: u32) -> u32 {
    let halves = (codes & HALVES) + (codes >> 8 & HALVES);
    halves.wrapping_mul(0x0001_0001) >> 16
}

/// Spreads columns of codes; as many as the memory holds.
#[inline(always)]
fn spread(
    columns: impl ExactSizeIterator<Item = u32>,
    memory: &mut [MaybeUninit<Column>],
) -> &[Column] {
    let count = columns.len().min(memory.len());
    let (mut fourths, mut sum) = (0, 0);
    for (column, codes) in memory.iter_mut().zip(columns) {
        sum += sum_of(codes);
        fourths = fourths >> 10 | codes >> 24 << 20;
        column.write(Column { three: three(codes), fourths, sum });
    }
    // SAFETY: so many have been written.
    unsafe { memory.get_unchecked(..count).assume_init_ref() }
}

/// Excess of three codes of the window over those at an offset, at least 0.
#[cfg(target_arch = "riscv32")]
#[rustfmt::skip] // an instruction a line
macro_rules! excess {
    ($sum:literal = $window:literal, $column:literal) => {
        concat!(
            "lw {x}, ", $column, "({columns})\n",
            "sub {x}, {", $window, "}, {x}\n",
            "and {y}, {x}, {above}\n",
            "mulhu {y}, {y}, {mask}\n",
            "and {", $sum, "}, {x}, {y}\n",
        )
    };
    ($sum:literal += $window:literal, $column:literal) => {
        concat!(
            excess!("x" = $window, $column),
            "add {", $sum, "}, {", $sum, "}, {x}\n",
        )
    };
}

impl Window {
    fn new(codes: &[u32; STRIP]) -> Self {
        let [a, b, c, d, e, f, g, h] = codes.map(|column| column >> 24);
        let fourths = |a: u32, b: u32, c: u32| a | b << 10 | c << 20 | ABOVE;
        Self {
            threes: codes.map(|column| three(column) | ABOVE),
            // Nothing is below 0: the last three columns are those of two codes.
            fourths: [fourths(a, b, c), fourths(d, e, f), fourths(0, g, h)],
            sum: codes.map(sum_of).into_iter().sum(),
        }
    }

    /// Costs along the columns: twice what the window's codes are above those there, and what these
    /// are more in all.
    #[cfg(not(target_arch = "riscv32"))]
    fn search(&self, columns: &[Column], costs: &mut [u8]) {
        let [a, b, c, d, e, f, g, h] = self.threes;
        let [i, j, k] = self.fourths;
        let mut before = self.sum + columns.first().map_or(0, Column::before);
        for (cost, columns) in costs.iter_mut().zip(columns.windows(STRIP)) {
            let Some([c0, c1, c2, c3, c4, c5, c6, c7]) = columns.first_chunk() else { return };
            let first = (excess(a, c0.three) + excess(b, c1.three))
                + (excess(c, c2.three) + excess(d, c3.three));
            let second = (excess(e, c4.three) + excess(f, c5.three))
                + (excess(g, c6.three) + excess(h, c7.three));
            let third = excess(i, c2.fourths) + excess(j, c5.fourths) + excess(k, c7.fourths);
            let middle = (first & MIDDLE) + (second & MIDDLE) + (third & MIDDLE);
            let outer = first + second + third - middle;
            // Sums are below 2^14; what the upper bits of `outer` add is cut off.
            let above = outer + (outer >> 20) + (middle >> 10);
            let sum = (above << 1).wrapping_add(c7.sum).wrapping_sub(before);
            *cost = (sum >> 6) as u8 + JUMP_PENALTY;
            before = c0.sum + self.sum;
        }
    }

    /// The same. The compiler would load all columns first, which leaves no registers for the
    /// window.
    #[cfg(target_arch = "riscv32")]
    fn search(&self, columns: &[Column], costs: &mut [u8]) {
        let length = costs.len().min((columns.len() + 1).saturating_sub(STRIP));
        let Some(first) = columns.first().filter(|_| length > 0) else { return };
        let ([a, b, c, d, e, f, g, h], [i, j, k]) = (self.threes, self.fourths);
        let costs = costs.as_mut_ptr();
        // SAFETY: there are so many costs, and seven columns more than these; offsets are those of
        // `Column`.
        unsafe {
            core::arch::asm!(
                "2:",
                excess!("first" = "a", "0"),
                excess!("first" += "b", "12"),
                excess!("first" += "c", "24"),
                excess!("first" += "d", "36"),
                excess!("second" = "e", "48"),
                excess!("second" += "f", "60"),
                excess!("second" += "g", "72"),
                excess!("second" += "h", "84"),
                "and {third}, {first}, {middle}",
                "add {first}, {first}, {second}",
                "and {second}, {second}, {middle}",
                "add {third}, {third}, {second}",
                excess!("second" = "i", "28"),
                excess!("second" += "j", "64"),
                excess!("second" += "k", "88"),
                "add {first}, {first}, {second}",
                "and {second}, {second}, {middle}",
                "add {third}, {third}, {second}",
                // Sums are below 2^14; what the upper bits of `first` add is not stored.
                "sub {first}, {first}, {third}",
                "srli {x}, {first}, 20",
                "add {first}, {first}, {x}",
                "srli {third}, {third}, 10",
                "add {first}, {first}, {third}",
                "slli {first}, {first}, 1",
                "lw {x}, 92({columns})",
                "sub {x}, {x}, {before}",
                "add {first}, {first}, {x}",
                "srli {first}, {first}, 6",
                "addi {first}, {first}, {penalty}",
                "sb {first}, 0({costs})",
                "lw {before}, 8({columns})",
                "add {before}, {before}, {sum}",
                "addi {columns}, {columns}, 12",
                "addi {costs}, {costs}, 1",
                "bne {costs}, {end}, 2b",
                a = in(reg) a,
                b = in(reg) b,
                c = in(reg) c,
                d = in(reg) d,
                e = in(reg) e,
                f = in(reg) f,
                g = in(reg) g,
                h = in(reg) h,
                i = in(reg) i,
                j = in(reg) j,
                k = in(reg) k,
                columns = inout(reg) columns.as_ptr() => _,
                costs = inout(reg) costs => _,
                end = in(reg) costs.add(length),
                above = in(reg) ABOVE,
                middle = in(reg) MIDDLE,
                mask = in(reg) 0xff << 24,
                sum = in(reg) self.sum,
                before = inout(reg) self.sum + first.before() => _,
                first = out(reg) _, second = out(reg) _, third = out(reg) _, x = out(reg) _,
                y = out(reg) _,
                penalty = const JUMP_PENALTY,
                options(nostack),
            );
        }
    }
}

/// Excess of three codes with the bits [`ABOVE`] over three others, at least 0.
#[cfg(not(target_arch = "riscv32"))]
#[inline(always)]
fn excess(window: u32, codes: u32) -> u32 {
    let difference = window - codes;
    difference & scaled(difference & ABOVE, 0xff << 24)
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
        left & scaled(left & HIGH & !word, 0x7f << 25)
    };
    let mut low = Lowest::START;
    let words = Cell::from_mut(words).as_slice_of_cells();
    let mut following = words.iter().map(|word| left(word.get()));
    let (mut before, mut here) = (0, following.next().unwrap_or(0));
    for (word, &cost) in words.iter().zip(costs_of_words) {
        let after = following.next().unwrap_or(0);
        let (earlier, later) = (here << 8 | before >> 24, here >> 8 | after << 24);
        let new = if earlier | here | later == 0 {
            cost
        } else {
            let near = larger(earlier, later);
            let most = larger(near, here + four(STEP_PENALTY)) - four(STEP_PENALTY);
            ((cost | HIGH) - most) ^ (!cost & HIGH)
        };
        word.set(new);
        low.note(new);
        (before, here) = (here, after);
    }
    low.lowest().unwrap_or_else(|| portable::lowest_byte(path.get(..length).unwrap_or_default()))
}

/// Byte by byte maximum of bytes below 128.
#[inline(always)]
fn larger(a: u32, b: u32) -> u32 {
    let difference = (a | HIGH) - b;
    b + (difference & scaled(difference & HIGH, 0x7f << 25))
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
    let over = (sums + (0x0400_0400 - 0x0100_0100)) & 0x0400_0400;
    (sums | scaled(over, 0xff << 22)) & HALVES
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_in_spread_columns_are_those_in_the_columns() {
        let mut state = 1_u32;
        let mut code = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // A quarter each of the least and the largest.
            ((state >> 22) as i32 - 384).clamp(0, 255) as u8
        };
        let columns: [CodeColumn; 320] = core::array::from_fn(|_| core::array::from_fn(|_| code()));
        let window: [CodeColumn; STRIP] =
            core::array::from_fn(|_| core::array::from_fn(|_| code()));
        let mut memory = [0; spread_bytes(320)];
        spread_codes(&columns, &mut memory);
        for (first, count) in [(0, 313), (1, 64), (7, 200), (2, 1), (250, 63), (300, 30), (320, 5)]
        {
            let (mut costs, mut expected) = ([255; 313], [255; 313]);
            let from = &columns[first..];
            portable::code_costs(&window, from, &mut expected[..count]);
            code_costs_in(&window, &columns, first, &memory, &mut costs[..count]);
            assert_eq!(costs, expected, "{first}, {count}");
            let mut costs = [255; 313];
            code_costs_in(&window, &columns, first, &memory[..80], &mut costs[..count]);
            assert_eq!(costs, expected, "{first}, {count}, without memory");
        }
    }
}
