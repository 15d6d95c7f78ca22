//! Codes of the texture of twelve rows, four columns at a time.
//!
//! In: rows of pixels. Out: columns of four codes; sums of their changes.
//!
//! ```text
//! a round, right to left    for each two rows: differences to the left and upward, summed over
//!                           four rows; sums with those of the next column, doubled as often as
//!                           the processor's flags say, halved and added
//!                           four words, a row each, become four columns
//! ```
//! All sums saturate, four bytes an instruction.
//!
//! # Cost
//! 199 instructions for 16 codes.
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, CODE_FLAT, CODE_ROWS, CodeColumn, STRIP};

/// Rows that codes are made of.
const ROWS: usize = 2 * CODE_ROWS + 4;

/// Words that do not fit the registers, at the offsets that the instructions below name.
#[repr(C)]
struct State {
    /// H and V of each row of codes, at the four columns to the right.
    sums: [[u32; 2]; CODE_ROWS],
    codes: [u32; CODE_ROWS],
    flags: u32,
    rows: [*const u8; ROWS],
}

/// See [`portable::code_columns`].
pub fn code_columns(rows: [&[u8]; ROWS], doublings: u32, columns: &mut [CodeColumn]) {
    let width = columns.len();
    let are_whole = rows.iter().all(|row| row.len() >= width);
    let are_words = width >= 8 && width.is_multiple_of(4) && columns.as_ptr().cast::<u32>().is_aligned();
    if !are_whole || !are_words || !(1..=4).contains(&doublings) {
        return portable::code_columns(rows, doublings, columns);
    }
    // Carry, negative and overflow: whether to double a second, a third and a fourth time.
    let flag = |least: u32, bit: u32| u32::from(doublings >= least) << bit;
    let flags = flag(2, 29) | flag(3, 31) | flag(4, 28);
    let mut state = State { sums: [[0; 2]; CODE_ROWS], codes: [0; CODE_ROWS], flags, rows: rows.map(<[u8]>::as_ptr) };
    // SAFETY: rows and columns have `width` entries, 8 at least and a multiple of 4. The first call
    // reads and writes columns width - 4 to width - 1, and two pixels before; the second one
    // columns 2 to width - 3.
    unsafe {
        // A code needs the sums of the next column: those of column width - 2 first.
        words_of_codes(&mut state, width - 4, columns.as_mut_ptr().add(width - 4), 0);
        state.sums = state.sums.map(|row| row.map(|sums| sums >> 16));
        words_of_codes(&mut state, width - 6, columns.as_mut_ptr().add(width - 6), width - 8);
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
    ($upper:literal, $lower:literal, $first:literal, $second:literal, $sum:literal) => {
        concat!(
            "ldr {", $sum, "}, [{state}, #", $upper, "]\n",
            "ldr r7, [{state}, #", $lower, "]\n",
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

/// The code of row k at four columns, from its first two rows of pixels, the sum along its middle
/// two and its last two rows. Leaves those sums of its last two.
#[rustfmt::skip] // an instruction a line
macro_rules! row_of_codes {
    ($upper:literal, $lower:literal, $sums:literal, $code:literal, $a0:literal, $a1:literal, $c0:literal, $c1:literal, $h:literal, $next:literal) => {
        concat!(
            two_rows!($upper, $lower, $c0, $c1, $next),
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
            "itt cs\n",
            "qadd8cs {", $h, "}, {", $h, "}, {", $h, "}\n",
            "qadd8cs {", $a0, "}, {", $a0, "}, {", $a0, "}\n",
            "itt mi\n",
            "qadd8mi {", $h, "}, {", $h, "}, {", $h, "}\n",
            "qadd8mi {", $a0, "}, {", $a0, "}, {", $a0, "}\n",
            "itt vs\n",
            "qadd8vs {", $h, "}, {", $h, "}, {", $h, "}\n",
            "qadd8vs {", $a0, "}, {", $a0, "}, {", $a0, "}\n",
            "shadd8 {", $h, "}, {", $h, "}, {", $a0, "}\n",
            "eor {", $h, "}, {", $h, "}, #0x80808080\n",
            "str {", $h, "}, [{state}, #", $code, "]\n",
        )
    };
}

/// Codes of four columns from `x` on, then of those to the left of them, while the first of the
/// pixels two to the left is not below 0: `x - 2 - left` is 0 for one word.
///
/// # Safety
/// Rows hold pixels `x - 2 - left` to `x + 3`; columns can be written from `left` before the
/// pointer to four from there on, at aligned addresses; `left` is a multiple of 4.
#[inline(never)]
unsafe fn words_of_codes(state: &mut State, x: usize, columns: *mut CodeColumn, left: usize) {
    // SAFETY: the caller's; offsets are those of the fields of `State`.
    unsafe {
        asm!(
            "push {{r7}}", // the frame pointer, which no operand is given
            "2:",
            "sub {left}, {x}, #2",
            "ldr {a0}, [{state}, #48]",
            "msr APSR_nzcvq, {a0}",
            "ldr {a0}, [{state}, #52]",
            "ldr {a1}, [{state}, #56]",
            "ldr {a0}, [{a0}, {x}]",
            "ldr {a1}, [{a1}, {x}]",
            "eor {a0}, {a0}, #0x80808080",
            "eor {a1}, {a1}, #0x80808080",
            two_rows!("60", "64", "b0", "b1", "p"),
            row_of_codes!("68", "72", "0", "32", "a0", "a1", "c0", "c1", "p", "q"),
            row_of_codes!("76", "80", "8", "36", "b0", "b1", "a0", "a1", "q", "p"),
            row_of_codes!("84", "88", "16", "40", "c0", "c1", "b0", "b1", "p", "q"),
            row_of_codes!("92", "96", "24", "44", "a0", "a1", "c0", "c1", "q", "p"),
            "ldrd {a0}, {a1}, [{state}, #32]",
            "ldrd {b0}, {b1}, [{state}, #40]",
            // The first and third, the second and fourth byte of two rows.
            "uxtb16 {c0}, {a0}",
            "uxtb16 {c1}, {a1}",
            "orr {c0}, {c0}, {c1}, lsl #8",
            "uxtb16 {a0}, {a0}, ror #8",
            "uxtb16 {a1}, {a1}, ror #8",
            "orr {a1}, {a0}, {a1}, lsl #8",
            "uxtb16 {c1}, {b0}",
            "uxtb16 {a0}, {b1}",
            "orr {c1}, {c1}, {a0}, lsl #8",
            "uxtb16 {b0}, {b0}, ror #8",
            "uxtb16 {b1}, {b1}, ror #8",
            "orr {b1}, {b0}, {b1}, lsl #8",
            "pkhbt {a0}, {c0}, {c1}, lsl #16",
            "pkhbt {b0}, {a1}, {b1}, lsl #16",
            "strd {a0}, {b0}, [{columns}]",
            "pkhtb {a0}, {c1}, {c0}, asr #16",
            "pkhtb {b0}, {b1}, {a1}, asr #16",
            "strd {a0}, {b0}, [{columns}, #8]",
            "sub {columns}, {columns}, #16",
            "sub {x}, {x}, #4",
            "cmp {x}, {end}",
            "bge 2b",
            "pop {{r7}}",
            state = in(reg) state,
            x = inout(reg) x => _,
            left = out(reg) _,
            columns = inout(reg) columns => _,
            end = in(reg) x - left,
            a0 = out(reg) _,
            a1 = out(reg) _,
            b0 = out(reg) _,
            b1 = out(reg) _,
            c0 = out(reg) _,
            c1 = out(reg) _,
            p = out(reg) _,
            q = out(reg) _,
        );
    }
}

/// See [`portable::code_steps`].
pub fn code_steps(window: &[CodeColumn; STRIP]) -> u16 {
    let &[a, b, c, d, e, f, g, h] = window;
    let word = u32::from_ne_bytes;
    let pairs = [(a, b), (b, c), (c, d), (d, e), (e, f), (f, g), (g, h)];
    pairs.into_iter().fold(0, |sum, (before, after)| differences(word(before), word(after), sum)) as u16
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
