//! Kernels of support points: ranks, costs of windows of ranks, paths.
//!
//! In: rows of pixels or ranks, curves of bytes over disparity. Out: ranks, costs, path costs and their sums, four bytes a word.
//!
//! ```text
//! rank    each neighbour is compared with four pixels at once, which leaves a one in each byte where it is darker
//! costs   two rows of the window a pass, every fourth disparity in one go, as `curves` does it; sums are bytes
//! path    the entries before and behind four are cut out of three words
//! ```
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, JUMP_PENALTY, RANK_FLAT, RANK_ROWS, STEP_PENALTY, STRIP};
use super::{two_operands, word};
use core::arch::asm;

two_operands!(
    /// Byte by byte sum, saturating.
    add,
    "uqadd8 {r}, {a}, {b}"
);
two_operands!(
    /// Byte by byte difference of what does not underflow.
    subtract,
    "usub8 {r}, {a}, {b}"
);

/// Byte by byte minimum.
#[inline(always)]
fn lower(a: u32, b: u32) -> u32 {
    let result: u32;
    // SAFETY: registers alone; the flags between the two instructions are nobody else's.
    unsafe {
        asm!("usub8 {r}, {a}, {b}", "sel {r}, {b}, {a}", r = out(reg) result, a = in(reg) a, b = in(reg) b,
            options(pure, nomem, nostack));
    }
    result
}

/// The lowest byte of a word.
#[inline(always)]
fn lowest_of(word: u32) -> u8 {
    let pairs = lower(word, word.rotate_left(16));
    lower(pairs, pairs.rotate_right(8)) as u8
}

/// A one in each byte where `a` is less than `b`.
#[inline(always)]
fn is_less(a: u32, b: u32) -> u32 {
    let result: u32;
    // SAFETY: as in `lower`.
    unsafe {
        asm!("usub8 {r}, {a}, {b}", "sel {r}, {zero}, {ones}", r = out(reg) result, a = in(reg) a, b = in(reg) b,
            zero = in(reg) 0, ones = in(reg) 0x0101_0101, options(pure, nomem, nostack));
    }
    result
}

/// See [`portable::rank_row`].
pub fn rank_row(rows: [&[u8]; 3], out: &mut [u8]) {
    let [above, row, below] = rows;
    let width = row.len();
    if width < 8 || above.len() < width || below.len() < width || out.len() < width {
        return portable::rank_row(rows, out);
    }
    let words = (width - 4) / 4;
    // SAFETY: words * 4 + 4 pixels of all rows, which are at least as long, are read, from column 0 to the last but `width & 3`.
    unsafe {
        for i in 0..words {
            let at = 4 * i;
            let centre = word(row.as_ptr().add(at + 2));
            let sides = is_less(word(row.as_ptr().add(at)), centre) + is_less(word(row.as_ptr().add(at + 4)), centre);
            let others =
                is_less(word(above.as_ptr().add(at + 2)), centre) + is_less(word(below.as_ptr().add(at + 2)), centre);
            out.as_mut_ptr().add(at + 2).cast::<u32>().write_unaligned(sides + others);
        }
    }
    // What is left: the border, and a few pixels before it.
    if let Some(border) = out.get_mut(..2) {
        border.fill(RANK_FLAT);
    }
    let done = 4 * words;
    let tail = |row: &[u8]| -> [u8; 8] {
        let mut tail = [0; 8];
        tail.iter_mut().zip(row.get(done..width).unwrap_or(&[])).for_each(|(tail, &pixel)| *tail = pixel);
        tail
    };
    let (tails, mut ranks) = ([above, row, below].map(tail), [RANK_FLAT; 8]);
    let [above, row, below] = tails.each_ref().map(|tail| tail.get(..width - done).unwrap_or(&[]));
    portable::rank_row([above, row, below], &mut ranks);
    if let Some(out) = out.get_mut(done + 2..) {
        out.fill(RANK_FLAT);
        out.iter_mut().zip(ranks.get(2..width - done).unwrap_or(&[])).for_each(|(out, &rank)| *out = rank);
    }
}

/// See [`portable::rank_costs`].
pub fn rank_costs(window: &[[u8; STRIP]; RANK_ROWS], rows: &[&[u8]; RANK_ROWS], costs: &mut [u8]) {
    let [a, b, c, d] = rows;
    let long = a.len().min(b.len()).min(c.len()).min(d.len());
    let long = (long + 1).saturating_sub(STRIP).min(costs.len());
    let whole = long & !7;
    let Some(behind) = long.checked_sub(8) else { return portable::rank_costs(window, rows, costs) };
    // SAFETY: a multiple of eight entries; each row holds as many ranks and seven more, from the first of them on.
    unsafe {
        block(window, rows, 0, costs.get_mut(..whole).unwrap_or(&mut []));
        if whole < long {
            // What is left, and some of those before it again.
            block(window, rows, behind, costs.get_mut(behind..long).unwrap_or(&mut []));
        }
    }
}

/// Costs of places from `first` on.
///
/// # Safety
/// There is a multiple of eight, and each row holds as many ranks from `first` on and seven more.
#[inline(always)]
unsafe fn block(window: &[[u8; STRIP]; RANK_ROWS], rows: &[&[u8]; RANK_ROWS], first: usize, costs: &mut [u8]) {
    let [wa, wb, wc, wd] = window;
    // SAFETY: the caller's.
    unsafe {
        let [a, b, c, d] = rows.map(|row| row.as_ptr().add(first));
        two_rows::<true>((wa, a), (wb, b), costs);
        two_rows::<false>((wc, c), (wd, d), costs);
    }
}

/// The two words of eight ranks.
#[inline(always)]
fn halves(&[a, b, c, d, e, f, g, h]: &[u8; STRIP]) -> (u32, u32) {
    (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]))
}

/// Puts down the sums of two rows, or adds those of two more and halves.
///
/// # Safety
/// There is a multiple of eight costs, and each row holds at least as many ranks and seven more.
#[inline(always)]
unsafe fn two_rows<const FIRST: bool>(a: (&[u8; STRIP], *const u8), b: (&[u8; STRIP], *const u8), costs: &mut [u8]) {
    let rounds = costs.len() / 8;
    if rounds == 0 {
        return;
    }
    let ((a0, a1), (b0, b1)) = (halves(a.0), halves(b.0));
    for phase in 0..4 {
        // SAFETY: two entries a round, every fourth from `phase` on: the last one is phase + len - 4. It meets the eight ranks from there on,
        // which end at phase + len + 4 <= len + 7; before the first round, four are read.
        unsafe {
            let (at_a, at_b) = (a.1.add(phase), b.1.add(phase));
            macro_rules! rows {
                ($load:literal, $first:literal, $then:literal, $end:literal) => {
                    asm!(
                        "2:",
                        $load,
                        "ldr {na}, [{pa}, #4]!",
                        "ldr {nb}, [{pb}, #4]!",
                        $first,
                        "usada8 {sum}, {ob}, {b0}, {sum}",
                        "usada8 {sum}, {na}, {a1}, {sum}",
                        "usada8 {sum}, {nb}, {b1}, {sum}",
                        $end,
                        "strb {sum}, [{cost}], #4",
                        $load,
                        "ldr {oa}, [{pa}, #4]!",
                        "ldr {ob}, [{pb}, #4]!",
                        $then,
                        "usada8 {sum}, {nb}, {b0}, {sum}",
                        "usada8 {sum}, {oa}, {a1}, {sum}",
                        "usada8 {sum}, {ob}, {b1}, {sum}",
                        $end,
                        "strb {sum}, [{cost}], #4",
                        "subs {rounds}, {rounds}, #1",
                        "bne 2b",
                        cost = inout(reg) costs.as_mut_ptr().add(phase) => _,
                        pa = inout(reg) at_a => _,
                        pb = inout(reg) at_b => _,
                        oa = inout(reg) word(at_a) => _,
                        ob = inout(reg) word(at_b) => _,
                        na = out(reg) _,
                        nb = out(reg) _,
                        a0 = in(reg) a0,
                        a1 = in(reg) a1,
                        b0 = in(reg) b0,
                        b1 = in(reg) b1,
                        sum = out(reg) _,
                        rounds = inout(reg) rounds => _,
                        options(nostack),
                    )
                };
            }
            if FIRST {
                rows!("", "usad8 {sum}, {oa}, {a0}", "usad8 {sum}, {na}, {a0}", "");
            } else {
                rows!(
                    "ldrb {sum}, [{cost}]",
                    "usada8 {sum}, {oa}, {a0}, {sum}",
                    "usada8 {sum}, {na}, {a0}, {sum}",
                    "ubfx {sum}, {sum}, #1, #7"
                );
            }
        }
    }
}

/// See [`portable::path_step`].
pub fn path_step(costs: &[u8], lowest: u8, path: &mut [u8], sums: &mut [u8], first: bool) -> u8 {
    let length = path.len().min(costs.len()).min(sums.len());
    let all = |byte: u8| u32::from_le_bytes([byte; 4]);
    if !length.is_multiple_of(4) || path.len() != length {
        return portable::path_step(costs, lowest, path, sums, first);
    }
    let (step, jump, lowest) = (all(STEP_PENALTY), all(lowest.saturating_add(JUMP_PENALTY)), all(lowest));
    let mut lows = u32::MAX;
    let Some((rounds, last)) = (length / 4).checked_sub(1).map(|rounds| (rounds, 4 * rounds)) else { return u8::MAX };
    let (mut here, mut before) = (0, u32::MAX);
    // SAFETY: all three hold `rounds` words and one more. That one is the last word read here, and worked on below.
    unsafe {
        here |= word(path.as_ptr());
        macro_rules! step {
            ($load:literal, $add:literal) => {
            asm!(
                "2:",
                "lsr {near}, {before}, #24",
                "orr {near}, {near}, {here}, lsl #8",
                "mov {before}, {here}",
                "ldr {here}, [{path}, #4]",
                "lsr {other}, {before}, #8",
                "orr {other}, {other}, {here}, lsl #24",
                "usub8 {flags}, {near}, {other}",
                "sel {near}, {other}, {near}",
                "uqadd8 {near}, {near}, {step}",
                "usub8 {flags}, {near}, {before}",
                "sel {near}, {before}, {near}",
                "usub8 {flags}, {near}, {jump}",
                "sel {near}, {jump}, {near}",
                "usub8 {near}, {near}, {lowest}",
                "ldr {other}, [{costs}], #4",
                "uqadd8 {near}, {near}, {other}",
                "str {near}, [{path}], #4",
                "usub8 {flags}, {near}, {lows}",
                "sel {lows}, {lows}, {near}",
                $load,
                $add,
                "str {other}, [{sums}], #4",
                "subs {rounds}, {rounds}, #1",
                "bne 2b",
                near = out(reg) _,
                other = out(reg) _,
                flags = out(reg) _,
                before = inout(reg) before,
                here = inout(reg) here,
                path = inout(reg) path.as_mut_ptr() => _,
                costs = inout(reg) costs.as_ptr() => _,
                sums = inout(reg) sums.as_mut_ptr() => _,
                step = in(reg) step,
                jump = in(reg) jump,
                lowest = in(reg) lowest,
                lows = inout(reg) lows,
                rounds = inout(reg) rounds => _,
                options(nostack),
            )
            };
        }
        if rounds == 0 {
        } else if first {
            step!("", "mov {other}, {near}");
        } else {
            step!("ldr {other}, [{sums}]", "uqadd8 {other}, {other}, {near}");
        }
    }
    let tails = path.get_mut(last..).zip(costs.get(last..)).zip(sums.get_mut(last..));
    if let Some(((path, costs), sums)) = tails
        && let (Some(path), Some(costs), Some(sums)) =
            (path.first_chunk_mut(), costs.first_chunk(), sums.first_chunk_mut())
    {
        let (left, right) = (here << 8 | before >> 24, here >> 8 | 0xff00_0000);
        let near = lower(lower(add(lower(left, right), step), here), jump);
        let new = add(subtract(near, lowest), u32::from_le_bytes(*costs));
        lows = lower(lows, new);
        *path = new.to_le_bytes();
        *sums = (if first { new } else { add(u32::from_le_bytes(*sums), new) }).to_le_bytes();
    }
    lowest_of(lows)
}

/// See [`portable::lowest_byte`].
pub fn lowest_byte(costs: &[u8]) -> u8 {
    let (blocks, rest) = costs.as_chunks::<16>();
    let mut lows = u32::MAX;
    for block in blocks {
        let at = block.as_ptr();
        // SAFETY: four words are read from sixteen bytes.
        unsafe {
            lows = lower(lower(lows, word(at)), word(at.add(4)));
            lows = lower(lower(lows, word(at.add(8))), word(at.add(12)));
        }
    }
    let (words, rest) = rest.as_chunks::<4>();
    for four in words {
        lows = lower(lows, u32::from_le_bytes(*four));
    }
    rest.iter().fold(lowest_of(lows), |lowest, &cost| lowest.min(cost))
}
