//! Kernels of support points: ranks, costs of windows of ranks, paths.
//!
//! In: rows of pixels or ranks, curves of bytes over disparity. Out: ranks, costs, path costs and their sums, four bytes a word.
//!
//! ```text
//! rank    each neighbour is compared with four pixels at once, which leaves a one in each byte where it is darker
//! columns four of them a round
//! costs   four disparities a round, a column of four ranks an instruction; a column is loaded once for all disparities that use it
//! path    two words a round; the entries before and behind four are cut out of three words
//! sums    two words a round
//! ```
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, JUMP_PENALTY, RANK_FLAT, RANK_ROWS, RankColumn, STEP_PENALTY, STRIP};
use super::word;

/// Byte by byte minimum.
#[inline(always)]
fn lower(a: u32, b: u32) -> u32 {
    let result: u32;
    // SAFETY: registers alone; no other code uses the flags between the two instructions.
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

/// See [`portable::rank_row`].
pub fn rank_row(rows: [&[u8]; 3], out: &mut [u8]) {
    let [above, row, below] = rows;
    let width = row.len();
    if width < 8 || above.len() < width || below.len() < width || out.len() < width {
        return portable::rank_row(rows, out);
    }
    let words = (width - 4) / 4;
    let (rows, to) = ([above, row, below].map(<[u8]>::as_ptr), out.as_mut_ptr());
    // SAFETY: words * 4 + 4 pixels of all rows, which are at least as long, are read, from column 0 to the last but `width & 3`; there is a word.
    unsafe {
        rank_words(rows, to, words);
        if !width.is_multiple_of(4) {
            // The rest, and some of those before it again.
            let at = width - 8;
            rank_words(rows.map(|row| row.add(at)), to.add(at), 1);
        }
    }
    for border in [0..2, width - 2..out.len()] {
        if let Some(border) = out.get_mut(border) {
            border.fill(RANK_FLAT);
        }
    }
}

/// Ranks of four pixels each from the third on, `words` times.
///
/// # Safety
/// There is a word at least; `4 * words + 4` bytes can be read from each row, and written.
#[inline(never)]
unsafe fn rank_words([above, row, below]: [*const u8; 3], out: *mut u8, words: usize) {
    // SAFETY: the caller's.
    unsafe {
        asm!(
            "2:",
            "ldr {centre}, [{row}, #2]",
            "ldr {other}, [{row}], #4",
            "usub8 {other}, {other}, {centre}",
            "sel {rank}, {zero}, {ones}",
            "ldr {other}, [{row}]",
            "usub8 {other}, {other}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {rank}, {rank}, {other}",
            "ldr {other}, [{above}], #4",
            "usub8 {other}, {other}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {rank}, {rank}, {other}",
            "ldr {other}, [{below}], #4",
            "usub8 {other}, {other}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {rank}, {rank}, {other}",
            "str {rank}, [{out}], #4",
            "subs {words}, {words}, #1",
            "bne 2b",
            row = inout(reg) row => _,
            above = inout(reg) above.add(2) => _,
            below = inout(reg) below.add(2) => _,
            out = inout(reg) out.add(2) => _,
            words = inout(reg) words => _,
            centre = out(reg) _,
            other = out(reg) _,
            rank = out(reg) _,
            zero = in(reg) 0,
            ones = in(reg) 0x0101_0101,
            options(nostack),
        );
    }
}

/// See [`portable::rank_columns`].
pub fn rank_columns(rows: &[u8], columns: &mut [RankColumn]) {
    let width = columns.len();
    let words = width / 4;
    if words == 0
        || !width.is_multiple_of(4)
        || rows.len() < RANK_ROWS * width
        || !columns.as_ptr().cast::<u32>().is_aligned()
    {
        return portable::rank_columns(rows, columns);
    }
    // SAFETY: `words` words of each of the four rows are read, and four times as many written, at aligned addresses.
    unsafe {
        asm!(
            "2:",
            "ldr {b}, [{row}, {width}]",
            "ldr {c}, [{row}, {width}, lsl #1]",
            "ldr {d}, [{row}, {last}]",
            "ldr {a}, [{row}], #4",
            // The first and third, the second and fourth byte of two rows.
            "uxtb16 {ab}, {a}",
            "uxtb16 {cd}, {b}",
            "orr {ab}, {ab}, {cd}, lsl #8",
            "uxtb16 {a}, {a}, ror #8",
            "uxtb16 {b}, {b}, ror #8",
            "orr {b}, {a}, {b}, lsl #8",
            "uxtb16 {cd}, {c}",
            "uxtb16 {a}, {d}",
            "orr {cd}, {cd}, {a}, lsl #8",
            "uxtb16 {c}, {c}, ror #8",
            "uxtb16 {d}, {d}, ror #8",
            "orr {d}, {c}, {d}, lsl #8",
            "pkhbt {a}, {ab}, {cd}, lsl #16",
            "pkhbt {c}, {b}, {d}, lsl #16",
            "strd {a}, {c}, [{column}], #8",
            "pkhtb {a}, {cd}, {ab}, asr #16",
            "pkhtb {c}, {d}, {b}, asr #16",
            "strd {a}, {c}, [{column}], #8",
            "subs {words}, {words}, #1",
            "bne 2b",
            row = inout(reg) rows.as_ptr() => _,
            column = inout(reg) columns.as_mut_ptr() => _,
            width = in(reg) width,
            last = in(reg) 3 * width,
            words = inout(reg) words => _,
            a = out(reg) _,
            b = out(reg) _,
            c = out(reg) _,
            d = out(reg) _,
            ab = out(reg) _,
            cd = out(reg) _,
            options(nostack),
        );
    }
}

/// See [`portable::rank_costs`].
pub fn rank_costs(window: &[RankColumn; STRIP], columns: &[RankColumn], costs: &mut [u8]) {
    let length = (columns.len() + 1).saturating_sub(STRIP).min(costs.len());
    let (at_window, at_columns) = (window.as_ptr().cast::<u32>(), columns.as_ptr().cast::<u32>());
    let behind = length.checked_sub(4).filter(|_| at_window.is_aligned() && at_columns.is_aligned());
    let Some(behind) = behind else { return rank_costs_by_bytes(window, columns, costs) };
    // SAFETY: whole words; there are `length` costs and seven columns more, of which the fours begin within.
    unsafe {
        fours(at_window, at_columns, costs.as_mut_ptr(), length / 4);
        if !length.is_multiple_of(4) {
            // The rest, and some of those before it again.
            fours(at_window, at_columns.add(behind), costs.as_mut_ptr().add(behind), 1);
        }
    }
}

/// Rank by rank: fewer than four costs, or ranks that are not aligned.
fn rank_costs_by_bytes(window: &[RankColumn; STRIP], columns: &[RankColumn], costs: &mut [u8]) {
    for (cost, columns) in costs.iter_mut().zip(columns.windows(STRIP)) {
        *cost = portable::halved(portable::differences(window, columns));
    }
}

/// Costs of four disparities each, `rounds` times.
///
/// # Safety
/// There is a round at least. The window holds eight words, the columns four a round and seven more; both are aligned. As many costs can be written
/// as there are disparities.
#[inline(never)] // called for whole rounds, and for the rest
unsafe fn fours(window: *const u32, columns: *const u32, costs: *mut u8, rounds: usize) {
    // SAFETY: the caller's. Loads of two words and more are at aligned addresses; those of the last round end seven words behind its four.
    unsafe {
        asm!(
            "push {{r7}}", // the frame pointer, which no operand is given
            "2:",
            "ldm {window}!, {{r1, r2, r3, r4}}",
            "ldrd {a}, {b}, [{columns}]",
            "usad8 {s0}, r1, {a}",
            "usada8 {s0}, r2, {b}, {s0}",
            "usad8 {s1}, r1, {b}",
            "ldrd {a}, {b}, [{columns}, #8]",
            "usada8 {s0}, r3, {a}, {s0}",
            "usada8 {s1}, r2, {a}, {s1}",
            "usad8 {s2}, r1, {a}",
            "usada8 {s0}, r4, {b}, {s0}",
            "usada8 {s1}, r3, {b}, {s1}",
            "usada8 {s2}, r2, {b}, {s2}",
            "usad8 r7, r1, {b}",
            "ldrd {a}, {b}, [{columns}, #16]!",
            "usada8 {s1}, r4, {a}, {s1}",
            "usada8 {s2}, r3, {a}, {s2}",
            "usada8 r7, r2, {a}, r7",
            "usada8 {s2}, r4, {b}, {s2}",
            "usada8 r7, r3, {b}, r7",
            "ldr r1, [{columns}, #8]",
            "usada8 r7, r4, r1, r7",
            "ldm {window}, {{r1, r2, r3, r4}}",
            "sub {window}, {window}, #16",
            "usada8 {s0}, r1, {a}, {s0}",
            "usada8 {s0}, r2, {b}, {s0}",
            "usada8 {s1}, r1, {b}, {s1}",
            "ldrd {a}, {b}, [{columns}, #8]",
            "usada8 {s0}, r3, {a}, {s0}",
            "usada8 {s1}, r2, {a}, {s1}",
            "usada8 {s2}, r1, {a}, {s2}",
            "usada8 {s0}, r4, {b}, {s0}",
            "usada8 {s1}, r3, {b}, {s1}",
            "usada8 {s2}, r2, {b}, {s2}",
            "usada8 r7, r1, {b}, r7",
            "ldrd {a}, {b}, [{columns}, #16]",
            "usada8 {s1}, r4, {a}, {s1}",
            "usada8 {s2}, r3, {a}, {s2}",
            "usada8 r7, r2, {a}, r7",
            "usada8 {s2}, r4, {b}, {s2}",
            "usada8 r7, r3, {b}, r7",
            "ldr {a}, [{columns}, #24]",
            "usada8 r7, r4, {a}, r7",
            // Four sums of eight bits, halved with twice the penalty.
            "bfi {s0}, {s1}, #8, #8",
            "bfi {s2}, r7, #8, #8",
            "pkhbt {s0}, {s0}, {s2}, lsl #16",
            "mov {a}, #{penalty}",
            "uhadd8 {s0}, {s0}, {a}",
            "str {s0}, [{costs}], #4",
            "subs {rounds}, {rounds}, #1",
            "bne 2b",
            "pop {{r7}}",
            window = inout(reg) window => _,
            columns = inout(reg) columns => _,
            costs = inout(reg) costs => _,
            rounds = inout(reg) rounds => _,
            a = out(reg) _,
            b = out(reg) _,
            s0 = out(reg) _,
            s1 = out(reg) _,
            s2 = out(reg) _,
            out("r1") _,
            out("r2") _,
            out("r3") _,
            out("r4") _,
            penalty = const 0x0202_0202_u32 * JUMP_PENALTY as u32,
        );
    }
}

/// True where curves so long and at these addresses are pairs of whole words, as double loads and stores want them.
#[inline(always)]
fn are_pairs_of_words(length: usize, starts: &[*const u8]) -> bool {
    length.is_multiple_of(8) && starts.iter().all(|at| at.cast::<u32>().is_aligned())
}

/// See [`portable::path_step`].
pub fn path_step(costs: &[u8], lowest: u8, path: &mut [u8]) -> u8 {
    let pairs = path.len() / 8;
    if pairs == 0 || costs.len() < path.len() || !are_pairs_of_words(path.len(), &[costs.as_ptr(), path.as_ptr()]) {
        return portable::path_step(costs, lowest, path);
    }
    let all = |byte: u8| u32::from_le_bytes([byte; 4]);
    let mut lows = u32::MAX;
    // SAFETY: both hold so many pairs of words, at aligned addresses. A word is read when the one before it is worked on, the first one before all.
    unsafe {
        asm!(
            "ldr {here}, [{path}]",
            "uqsub8 {here}, {reach}, {here}",
            "2:",
            "ldrd {cost}, {next}, [{costs}], #8",
            "ldr {then}, [{path}, #4]",
            "uqsub8 {then}, {reach}, {then}",
            "orr {near}, {carry}, {here}, lsl #8",
            "lsr {carry}, {here}, #24",
            "lsr {other}, {here}, #8",
            "orr {other}, {other}, {then}, lsl #24",
            "uqsub8 {near}, {near}, {other}",
            "uadd8 {near}, {near}, {other}",
            "uqsub8 {near}, {near}, {step}",
            "uqsub8 {near}, {near}, {here}",
            "uadd8 {near}, {near}, {here}",
            "usub8 {cost}, {cost}, {near}",
            "usub8 {near}, {cost}, {lows}",
            "sel {lows}, {lows}, {cost}",
            "mov {here}, #-1",
            "subs {pairs}, {pairs}, #1",
            "it ne",
            "ldrne {here}, [{path}, #8]",
            "uqsub8 {here}, {reach}, {here}",
            "orr {near}, {carry}, {then}, lsl #8",
            "lsr {carry}, {then}, #24",
            "lsr {other}, {then}, #8",
            "orr {other}, {other}, {here}, lsl #24",
            "uqsub8 {near}, {near}, {other}",
            "uadd8 {near}, {near}, {other}",
            "uqsub8 {near}, {near}, {step}",
            "uqsub8 {near}, {near}, {then}",
            "uadd8 {near}, {near}, {then}",
            "usub8 {next}, {next}, {near}",
            "usub8 {near}, {next}, {lows}",
            "sel {lows}, {lows}, {next}",
            "strd {cost}, {next}, [{path}], #8",
            "bne 2b",
            pairs = inout(reg) pairs => _,
            path = inout(reg) path.as_mut_ptr() => _,
            costs = inout(reg) costs.as_ptr() => _,
            carry = inout(reg) 0 => _,
            cost = out(reg) _,
            next = out(reg) _,
            here = out(reg) _,
            then = out(reg) _,
            near = out(reg) _,
            other = out(reg) _,
            lows = inout(reg) lows,
            reach = in(reg) all(lowest.saturating_add(JUMP_PENALTY)),
            step = in(reg) all(STEP_PENALTY),
            options(nostack),
        );
    }
    lowest_of(lows)
}

/// See [`portable::sum_paths`].
pub fn sum_paths(a: &[u8], b: &[u8], sums: &mut [u8]) -> u8 {
    let (pairs, length) = (sums.len() / 8, sums.len());
    let starts = [a.as_ptr(), b.as_ptr(), sums.as_ptr()];
    if pairs == 0 || a.len() < length || b.len() < length || !are_pairs_of_words(length, &starts) {
        return portable::sum_paths(a, b, sums);
    }
    let mut lows = u32::MAX;
    // SAFETY: all three hold so many pairs of words, at aligned addresses.
    unsafe {
        asm!(
            "2:",
            "ldrd {sum}, {then}, [{sums}]",
            "ldrd {x}, {y}, [{a}], #8",
            "uqadd8 {sum}, {sum}, {x}",
            "uqadd8 {then}, {then}, {y}",
            "ldrd {x}, {y}, [{b}], #8",
            "uqadd8 {sum}, {sum}, {x}",
            "uqadd8 {then}, {then}, {y}",
            "strd {sum}, {then}, [{sums}], #8",
            "usub8 {x}, {sum}, {lows}",
            "sel {lows}, {lows}, {sum}",
            "usub8 {x}, {then}, {lows}",
            "sel {lows}, {lows}, {then}",
            "subs {pairs}, {pairs}, #1",
            "bne 2b",
            a = inout(reg) a.as_ptr() => _,
            b = inout(reg) b.as_ptr() => _,
            sums = inout(reg) sums.as_mut_ptr() => _,
            pairs = inout(reg) pairs => _,
            x = out(reg) _,
            y = out(reg) _,
            sum = out(reg) _,
            then = out(reg) _,
            lows = inout(reg) lows,
            options(nostack),
        );
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

/// See [`portable::place_of_byte`].
pub fn place_of_byte(costs: &[u8], bound: u8) -> Option<usize> {
    let words = costs.len() / 4;
    if words == 0 || !costs.len().is_multiple_of(4) {
        return portable::place_of_byte(costs, bound);
    }
    let mut at = costs.as_ptr();
    let mut found: u32;
    // SAFETY: so many words are read at most.
    unsafe {
        asm!(
            "2:",
            "ldr r3, [{at}], #4",
            "usub8 r3, {bounds}, r3",
            "sel r3, {ones}, {zero}",
            "cbnz r3, 3f",
            "subs {words}, {words}, #1",
            "bne 2b",
            "3:",
            at = inout(reg) at,
            words = inout(reg) words => _,
            out("r3") found, // a low one, as `cbnz` requires
            bounds = in(reg) u32::from_le_bytes([bound; 4]),
            ones = in(reg) 0x0101_0101,
            zero = in(reg) 0,
            options(nostack, readonly),
        );
    }
    (found != 0).then(|| at.addr() - costs.as_ptr().addr() - 4 + found.trailing_zeros() as usize / 8)
}
