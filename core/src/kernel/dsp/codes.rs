//! Codes of the texture of twelve rows, four columns at a time.
//!
//! In: rows of pixels. Out: columns of four codes; sums of their changes.
//!
//! ```text
//! a round, right to left    for each two rows: differences to the left and upward, summed over
//!                           four rows; sums with those of the next column, doubled as often as
//!                           the processor's flags say, halved and added
//!                           four words, a row each, become four columns: bytes of two rows are
//!                           selected by flags
//! ```
//! All sums saturate, four bytes an instruction.
//!
//! # Cost
//! 156 to 187 instructions for 16 codes; some 120 for the moments of a window.
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, CODE_FLAT, CODE_ROWS, CodeColumn, CodeMoments, STRIP};
use super::edges::{dual_difference, even_bytes, odd_bytes};

/// Rows that codes are made of.
const ROWS: usize = 2 * CODE_ROWS + 4;

/// Words that do not fit the registers, at the offsets that the instructions below name.
#[repr(C)]
struct State {
    /// H and V of each row of codes, at the four columns to the right.
    sums: [[u32; 2]; CODE_ROWS],
    /// Codes of all rows but the last.
    codes: [u32; CODE_ROWS - 1],
    /// Pixels of each row at the last columns of a call.
    rows: [*const u8; ROWS],
}

/// See [`portable::code_columns`].
pub fn code_columns(rows: [&[u8]; ROWS], doublings: u32, columns: &mut [CodeColumn]) {
    let width = columns.len();
    let are_whole = rows.iter().all(|row| row.len() >= width);
    let are_words =
        width >= 8 && width.is_multiple_of(4) && columns.as_ptr().cast::<u32>().is_aligned();
    if !are_whole || !are_words || !(1..=4).contains(&doublings) {
        return portable::code_columns(rows, doublings, columns);
    }
    // Carry, negative and overflow: whether to double a second, a third and a fourth time. GE:
    // every second byte of a word is taken from the next row's.
    let flag = |least: u32, bit: u32| u32::from(doublings >= least) << bit;
    let flags = flag(2, 29) | flag(3, 31) | flag(4, 28) | 0xa << 16;
    let rows_from = |x: usize| rows.map(|row| row.as_ptr().wrapping_add(x));
    let mut state =
        State { sums: [[0; 2]; CODE_ROWS], codes: [0; CODE_ROWS - 1], rows: rows_from(width - 4) };
    // SAFETY: rows and columns have `width` entries, 8 at least and a multiple of 4. The first call
    // reads and writes columns width - 4 to width - 1, and two pixels before; the second one
    // columns 2 to width - 3.
    unsafe {
        // A code needs the sums of the next column: those of column width - 2 first.
        words_of_codes(&mut state, flags, columns.as_mut_ptr().add(width - 4), 0);
        state.sums = state.sums.map(|row| row.map(|sums| sums >> 16));
        state.rows = rows_from(2);
        words_of_codes(&mut state, flags, columns.as_mut_ptr().add(width - 6), width - 8);
    }
    for border in [0..2, width - 2..width] {
        if let Some(border) = columns.get_mut(border) {
            border.fill([CODE_FLAT; CODE_ROWS]);
        }
    }
}

/// The pixels of two rows at four columns, as signed bytes, and their differences to those two
/// columns to the left, summed.
#[rustfmt::skip] // an instruction a line
macro_rules! two_rows {
    ($rows:literal, $first:literal, $second:literal, $sum:literal) => {
        concat!(
            "ldrd {", $sum, "}, r7, [{state}, #", $rows, "]\n",
            "ldr {", $first, "}, [{", $sum, "}, {x}]\n",
            "ldr {", $second, "}, [r7, {x}]\n",
            "ldr {", $sum, "}, [{", $sum, "}, {left}]\n",
            "ldr r7, [r7, {left}]\n",
            "eor {", $first, "}, {", $first, "}, #0x80808080\n",
            "eor {", $second, "}, {", $second, "}, #0x80808080\n",
            "eor {", $sum, "}, {", $sum, "}, #0x80808080\n",
            "eor r7, r7, #0x80808080\n",
            "qsub8 {", $sum, "}, {", $first, "}, {", $sum, "}\n",
            "qsub8 r7, {", $second, "}, r7\n",
            "qadd8 {", $sum, "}, {", $sum, "}, r7\n",
        )
    };
}

/// The code of row k at four columns (`h`), from its first two rows of pixels, the sum along its
/// middle two and its last two rows. Leaves those sums of its last two.
#[rustfmt::skip] // an instruction a line
macro_rules! row_of_codes {
    (
        $rows:literal, $sums:literal, $a0:literal, $a1:literal, $c0:literal, $c1:literal,
        $h:literal, $next:literal
    ) => {
        concat!(
            two_rows!($rows, $c0, $c1, $next),
            "qadd8 {", $h, "}, {", $h, "}, {", $next, "}\n",
            "qsub8 {", $a0, "}, {", $c0, "}, {", $a0, "}\n",
            "qsub8 {", $a1, "}, {", $c1, "}, {", $a1, "}\n",
            "qadd8 {", $a0, "}, {", $a0, "}, {", $a1, "}\n",
            // With the next column.
            "ldrd {", $a1, "}, r7, [{state}, #", $sums, "]\n",
            "strd {", $h, "}, {", $a0, "}, [{state}, #", $sums, "]\n",
            "lsl {", $a1, "}, {", $a1, "}, #24\n",
            "lsl r7, r7, #24\n",
            "orr {", $a1, "}, {", $a1, "}, {", $h, "}, lsr #8\n",
            "orr r7, r7, {", $a0, "}, lsr #8\n",
            "qadd8 {", $h, "}, {", $h, "}, {", $a1, "}\n",
            "qadd8 {", $a0, "}, {", $a0, "}, r7\n",
            // Full scale.
            "qadd8 {", $h, "}, {", $h, "}, {", $h, "}\n",
            "qadd8 {", $a0, "}, {", $a0, "}, {", $a0, "}\n",
            "bcc 3f\n",
            "qadd8 {", $h, "}, {", $h, "}, {", $h, "}\n",
            "qadd8 {", $a0, "}, {", $a0, "}, {", $a0, "}\n",
            "bpl 3f\n",
            "qadd8 {", $h, "}, {", $h, "}, {", $h, "}\n",
            "qadd8 {", $a0, "}, {", $a0, "}, {", $a0, "}\n",
            "bvc 3f\n",
            "qadd8 {", $h, "}, {", $h, "}, {", $h, "}\n",
            "qadd8 {", $a0, "}, {", $a0, "}, {", $a0, "}\n",
            "3:\n",
            "shadd8 {", $h, "}, {", $h, "}, {", $a0, "}\n",
            "eor {", $h, "}, {", $h, "}, #0x80808080\n",
        )
    };
}

/// Codes of four columns from `x` on after those that the rows begin at, then of those to the left
/// of them, down to 0.
///
/// # Safety
/// Rows hold pixels -2 to `x + 3` from there on; columns can be written from `x` before the pointer
/// to four from there on, at aligned addresses; `x` is a multiple of 4.
#[inline(never)]
unsafe fn words_of_codes(state: &mut State, flags: u32, columns: *mut CodeColumn, x: usize) {
    // SAFETY: the caller's; offsets are those of the fields of `State`.
    unsafe {
        asm!(
            "push {{r7}}", // the frame pointer, which no operand is given
            "2:",
            "sub {left}, {x}, #2",
            "msr APSR_nzcvqg, {flags}",
            "ldrd {a0}, {a1}, [{state}, #44]",
            "ldr {a0}, [{a0}, {x}]",
            "ldr {a1}, [{a1}, {x}]",
            "eor {a0}, {a0}, #0x80808080",
            "eor {a1}, {a1}, #0x80808080",
            two_rows!("52", "b0", "b1", "p"),
            row_of_codes!("60", "0", "a0", "a1", "c0", "c1", "p", "q"),
            "str {p}, [{state}, #32]",
            row_of_codes!("68", "8", "b0", "b1", "a0", "a1", "q", "p"),
            "str {q}, [{state}, #36]",
            row_of_codes!("76", "16", "c0", "c1", "b0", "b1", "p", "q"),
            "str {p}, [{state}, #40]",
            row_of_codes!("84", "24", "a0", "a1", "c0", "c1", "q", "p"),
            // The first and third, the second and fourth byte of two rows.
            "ldrd {a0}, {a1}, [{state}, #32]",
            "ldr {b0}, [{state}, #40]",
            "lsl {c0}, {a1}, #8",
            "lsr {b1}, {a0}, #8",
            "sel {c0}, {c0}, {a0}",
            "sel {a1}, {a1}, {b1}",
            "lsl {c1}, {q}, #8",
            "lsr {b1}, {b0}, #8",
            "sel {c1}, {c1}, {b0}",
            "sel {q}, {q}, {b1}",
            "pkhtb {a0}, {c1}, {c0}, asr #16",
            "pkhtb {b0}, {q}, {a1}, asr #16",
            "strd {a0}, {b0}, [{columns}, #8]",
            "pkhbt {a0}, {c0}, {c1}, lsl #16",
            "pkhbt {b0}, {a1}, {q}, lsl #16",
            "strd {a0}, {b0}, [{columns}], #-16",
            "subs {x}, {x}, #4",
            "bge 2b",
            "pop {{r7}}",
            state = in(reg) state,
            x = inout(reg) x => _,
            left = out(reg) _,
            columns = inout(reg) columns => _,
            flags = in(reg) flags,
            a0 = out(reg) _, a1 = out(reg) _, b0 = out(reg) _, b1 = out(reg) _, c0 = out(reg) _,
            c1 = out(reg) _, p = out(reg) _, q = out(reg) _,
        );
    }
}

/// See [`portable::code_steps`].
pub fn code_steps(window: &[CodeColumn; STRIP]) -> u16 {
    let &[a, b, c, d, e, f, g, h] = window;
    let word = u32::from_ne_bytes;
    let pairs = [(a, b), (b, c), (c, d), (d, e), (e, f), (f, g), (g, h)];
    pairs.into_iter().fold(0, |sum, (before, after)| differences(word(before), word(after), sum))
        as u16
}

/// See [`portable::row_difference`].
#[inline]
pub fn row_difference(a: &[u8; STRIP], b: &[u8; STRIP]) -> u16 {
    let (words, word) = (a.as_chunks().0.iter().zip(b.as_chunks().0), u32::from_le_bytes);
    words.fold(0, |sum, (&a, &b)| differences(word(a), word(b), sum)) as u16
}

/// See [`portable::code_moments`].
pub fn code_moments(columns: &[CodeColumn; STRIP + 2]) -> CodeMoments {
    let lanes = |column: CodeColumn| {
        let column = u32::from_le_bytes(column);
        [even_bytes(column), odd_bytes(column)]
    };
    let &[a, b, c, d, e, f, g, h, i, j] = columns;
    let (i, j) = (lanes(i), lanes(j));
    let mut sums = Squares::default();
    // From the right, each column once. Written out: a loop takes half as long again.
    let h = sums.add(lanes(h), j);
    let g = sums.add(lanes(g), i);
    let f = sums.add(lanes(f), h);
    let e = sums.add(lanes(e), g);
    let d = sums.add(lanes(d), f);
    let c = sums.add(lanes(c), e);
    sums.add(lanes(b), d);
    sums.add(lanes(a), c);
    let Squares { all, across, odd, lower } = sums;
    CodeMoments { all, across, down: odd + 2 * lower }
}

/// Sums of squared changes: of all rows, moved on by a column for each that was added since, of
/// rows 1 and 3, of rows 2 and 3.
#[derive(Default)]
struct Squares {
    all: u32,
    across: u32,
    odd: u32,
    lower: u32,
}

impl Squares {
    /// Adds the change from one column, which it gives back, to another: rows 0 and 2, 1 and 3.
    #[inline(always)]
    fn add(&mut self, before: [u32; 2], after: [u32; 2]) -> [u32; 2] {
        let ([even_before, odd_before], [even_after, odd_after]) = (before, after);
        let evens = dual_difference(even_after, even_before);
        let odds = dual_difference(odd_after, odd_before);
        self.across += self.all;
        self.all = add_squares(odds, add_squares(evens, self.all));
        self.odd = add_squares(odds, self.odd);
        self.lower = add_upper_square(odds, add_upper_square(evens, self.lower));
        before
    }
}

/// Sum of the square of the upper signed half word, and a second operand.
#[inline(always)]
fn add_upper_square(pair: u32, sum: u32) -> u32 {
    let result: u32;
    // SAFETY: registers alone.
    unsafe {
        asm!("smlatt {r}, {a}, {a}, {sum}", r = lateout(reg) result, a = in(reg) pair,
            sum = in(reg) sum, options(pure, nomem, nostack, preserves_flags));
    }
    result
}

/// Sum of the squares of both signed half words, and a second operand.
#[inline(always)]
fn add_squares(pair: u32, sum: u32) -> u32 {
    let result: u32;
    // SAFETY: registers alone.
    unsafe {
        asm!("smlad {r}, {a}, {a}, {sum}", r = lateout(reg) result, a = in(reg) pair,
            sum = in(reg) sum, options(pure, nomem, nostack, preserves_flags));
    }
    result
}

/// Sum of the differences of four bytes, and a third operand.
#[inline(always)]
fn differences(a: u32, b: u32, sum: u32) -> u32 {
    let result: u32;
    // SAFETY: registers alone.
    unsafe {
        asm!("usada8 {r}, {a}, {b}, {sum}", r = lateout(reg) result, a = in(reg) a, b = in(reg) b, sum = in(reg) sum,
            options(pure, nomem, nostack, preserves_flags));
    }
    result
}
