//! Codes of the texture of twelve rows, sixteen columns at a time.
//!
//! In: rows of pixels. Out: columns of four codes.
//!
//! ```text
//! a block   sums along each row of codes, with those of the column before, doubled as often as the
//!           processor's flags say; sums down the same way, and half of both
//!           four vectors, a row of codes each, are stored in turn: as columns
//! blocks    right to left, fifteen columns further each: the first column has no sum before it,
//!           and is stored again by the next block
//! ```
//! All sums saturate, sixteen bytes an instruction.
//!
//! # Cost
//! A row of 320 columns: 5854 (15 360).
//!
//! # Source
//! See [`super`].

use super::super::dsp;
use super::super::portable::{CODE_FLAT, CODE_ROWS, CodeColumn};
use super::VECTOR;

/// Rows that codes are made of.
const ROWS: usize = 2 * CODE_ROWS + 4;

/// See [`portable::code_columns`](super::super::portable::code_columns).
pub fn code_columns(rows: [&[u8]; ROWS], doublings: u32, columns: &mut [CodeColumn]) {
    let width = columns.len();
    let are_whole = rows.iter().all(|row| row.len() >= width);
    if !are_whole || width < VECTOR + 3 || !(1..=4).contains(&doublings) {
        return dsp::code_columns(rows, doublings, columns);
    }
    // Carry, negative and overflow: whether to double a second, a third and a fourth time.
    let flag = |least: u32, bit: u32| u32::from(doublings >= least) << bit;
    let flags = flag(2, 29) | flag(3, 31) | flag(4, 28);
    let (rows, to) = (rows.map(<[u8]>::as_ptr), columns.as_mut_ptr());
    let mut x = width - 1 - VECTOR;
    loop {
        // SAFETY: rows and columns have `width` entries, and x is 2 to width - 17: pixels x - 2 to
        // x + 15 are read, columns x - 1 to x + 14 written.
        unsafe { block(&rows, x, flags, to.add(x - 1)) };
        if x == 2 {
            break;
        }
        x = x.saturating_sub(VECTOR - 1).max(2);
    }
    for border in [0..2, width - 2..width] {
        if let Some(border) = columns.get_mut(border) {
            border.fill([CODE_FLAT; CODE_ROWS]);
        }
    }
}

/// The sum of two differences of signed bytes: those at `a` and `b` less those at `c` and `d`.
#[rustfmt::skip] // an instruction a line
macro_rules! sum_of_differences {
    ($sum:literal, $t:literal, $u:literal, $a:literal, $c:literal, $b:literal, $d:literal) => {
        concat!(
            "vldrb.u8 ", $sum, ", [", $a, "]\n",
            "vldrb.u8 ", $t, ", [", $c, "]\n",
            "vadd.i8 ", $sum, ", ", $sum, ", {flip}\n",
            "vadd.i8 ", $t, ", ", $t, ", {flip}\n",
            "vqsub.s8 ", $sum, ", ", $sum, ", ", $t, "\n",
            "vldrb.u8 ", $t, ", [", $b, "]\n",
            "vldrb.u8 ", $u, ", [", $d, "]\n",
            "vadd.i8 ", $t, ", ", $t, ", {flip}\n",
            "vadd.i8 ", $u, ", ", $u, ", {flip}\n",
            "vqsub.s8 ", $t, ", ", $t, ", ", $u, "\n",
            "vqadd.s8 ", $sum, ", ", $sum, ", ", $t, "\n",
        )
    };
}

/// Differences to two columns before, of two rows.
#[rustfmt::skip] // an instruction a line
macro_rules! along {
    ($sum:literal, $rows:literal) => {
        concat!(
            "ldrd {a}, {b}, [{rows}, #", $rows, "]\n",
            "add {a}, {a}, {x}\n",
            "add {b}, {b}, {x}\n",
            sum_of_differences!($sum, "q2", "q3", "{a}", "{a}, #-2", "{b}", "{b}, #-2"),
        )
    };
}

/// Differences of two rows to those four rows above.
#[rustfmt::skip] // an instruction a line
macro_rules! down {
    ($rows:literal, $above:literal) => {
        concat!(
            "ldrd {a}, {b}, [{rows}, #", $rows, "]\n",
            "add {a}, {a}, {x}\n",
            "add {b}, {b}, {x}\n",
            "ldrd {c}, {d}, [{rows}, #", $above, "]\n",
            "add {c}, {c}, {x}\n",
            "add {d}, {d}, {x}\n",
            sum_of_differences!("q0", "q2", "q3", "{a}", "{c}", "{b}", "{d}"),
        )
    };
}

/// Sums with those of the column before, at full scale.
#[rustfmt::skip] // an instruction a line
macro_rules! full_scale {
    ($sum:literal) => {
        concat!(
            "vmov q2, ", $sum, "\n",
            "vshlc q2, {a}, #8\n",
            "vqadd.s8 ", $sum, ", ", $sum, ", q2\n",
            "vqadd.s8 ", $sum, ", ", $sum, ", ", $sum, "\n",
            "bcc 3f\n",
            "vqadd.s8 ", $sum, ", ", $sum, ", ", $sum, "\n",
            "bpl 3f\n",
            "vqadd.s8 ", $sum, ", ", $sum, ", ", $sum, "\n",
            "bvc 3f\n",
            "vqadd.s8 ", $sum, ", ", $sum, ", ", $sum, "\n",
            "3:\n",
        )
    };
}

/// Codes of the sixteen columns that begin a column before `x`; of the first one something else.
///
/// # Safety
/// Pixels of each row from `x - 2` to `x + 15` can be read, sixteen columns written.
#[inline(never)]
unsafe fn block(rows: &[*const u8; ROWS], x: usize, flags: u32, columns: *mut CodeColumn) {
    // SAFETY: the caller's; offsets are those of rows. No instruction between changes the flags.
    unsafe {
        asm!(
            "msr APSR_nzcvq, {flags}",
            along!("q0", "8"),
            along!("q1", "16"),
            "vqadd.s8 q4, q0, q1",
            full_scale!("q4"),
            along!("q0", "24"),
            "vqadd.s8 q5, q1, q0",
            full_scale!("q5"),
            along!("q1", "32"),
            "vqadd.s8 q6, q0, q1",
            full_scale!("q6"),
            along!("q0", "40"),
            "vqadd.s8 q7, q1, q0",
            full_scale!("q7"),
            down!("16", "0"),
            full_scale!("q0"),
            "vhadd.s8 q4, q4, q0",
            down!("24", "8"),
            full_scale!("q0"),
            "vhadd.s8 q5, q5, q0",
            down!("32", "16"),
            full_scale!("q0"),
            "vhadd.s8 q6, q6, q0",
            down!("40", "24"),
            full_scale!("q0"),
            "vhadd.s8 q7, q7, q0",
            "vadd.i8 q4, q4, {flip}",
            "vadd.i8 q5, q5, {flip}",
            "vadd.i8 q6, q6, {flip}",
            "vadd.i8 q7, q7, {flip}",
            "vst40.8 {{q4, q5, q6, q7}}, [{columns}]",
            "vst41.8 {{q4, q5, q6, q7}}, [{columns}]",
            "vst42.8 {{q4, q5, q6, q7}}, [{columns}]",
            "vst43.8 {{q4, q5, q6, q7}}, [{columns}]",
            rows = in(reg) rows,
            x = in(reg) x,
            flags = in(reg) flags,
            columns = in(reg) columns,
            flip = in(reg) 0x80,
            a = out(reg) _, b = out(reg) _, c = out(reg) _, d = out(reg) _,
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            out("d4") _, out("d5") _, out("d6") _, out("d7") _,
            out("d8") _, out("d9") _, out("d10") _, out("d11") _,
            out("d12") _, out("d13") _, out("d14") _, out("d15") _,
            options(nostack),
        );
    }
}
