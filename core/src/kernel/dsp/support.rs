//! Kernels of support points: costs of windows of codes, paths. Codes are in
//! [`codes`](super::codes).
//!
//! In: codes, curves of bytes over disparity. Out: costs, path costs and their sums, four bytes a
//! word.
//!
//! ```text
//! costs   four disparities a round, a column of four codes an instruction; a column is loaded once
//!         for all disparities that use it
//! path    four words a round; the entries before and behind four are words at odd addresses
//! sums    four words a round
//! ```
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, CodeColumn, JUMP_PENALTY, STEP_PENALTY, STRIP};
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

/// See [`portable::code_costs`].
pub fn code_costs(window: &[CodeColumn; STRIP], columns: &[CodeColumn], costs: &mut [u8]) {
    let length = (columns.len() + 1).saturating_sub(STRIP).min(costs.len());
    let (at_window, at_columns) = (window.as_ptr().cast::<u32>(), columns.as_ptr().cast::<u32>());
    let behind =
        length.checked_sub(4).filter(|_| at_window.is_aligned() && at_columns.is_aligned());
    let Some(behind) = behind else { return portable::code_costs(window, columns, costs) };
    // SAFETY: whole words; there are `length` costs and seven columns more, of which the fours
    // begin within.
    unsafe {
        fours(at_window, at_columns, costs.as_mut_ptr(), length / 4);
        if !length.is_multiple_of(4) {
            // The rest, and some of those before it again.
            fours(at_window, at_columns.add(behind), costs.as_mut_ptr().add(behind), 1);
        }
    }
}

/// Costs of four disparities each, `rounds` times.
///
/// # Safety
/// There is a round at least. The window holds eight words, the columns four a round and seven
/// more; both are aligned. As many costs can be written as there are disparities.
#[inline(never)] // called for whole rounds, and for the rest
unsafe fn fours(window: *const u32, columns: *const u32, costs: *mut u8, rounds: usize) {
    // SAFETY: the caller's. Loads of two words and more are at aligned addresses; those of the last
    // round end seven words behind its four.
    unsafe {
        asm!(
            "push {{r7}}", // the frame pointer, which no operand is given
            "msr APSR_g, {a}",
            "2:",
            "ldmdb {window}, {{r1, r2, r3, r4}}",
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
            // Four sums of 13 bits, of which the upper seven are kept.
            "pkhbt {s0}, {s0}, {s2}, lsl #16",
            "pkhbt {s1}, {s1}, r7, lsl #16",
            "lsr {s0}, {s0}, #6",
            "lsl {s1}, {s1}, #2",
            "sel {s0}, {s1}, {s0}",
            "add {s0}, {s0}, #{penalty}",
            "str {s0}, [{costs}], #4",
            "subs {rounds}, {rounds}, #1",
            "bne 2b",
            "pop {{r7}}",
            window = in(reg) window.add(4), // its middle
            columns = inout(reg) columns => _,
            costs = inout(reg) costs => _,
            rounds = inout(reg) rounds => _,
            a = inout(reg) 0xa << 16 => _, // `sel` takes every second byte from the first operand
            b = out(reg) _, s0 = out(reg) _, s1 = out(reg) _, s2 = out(reg) _, out("r1") _,
            out("r2") _, out("r3") _, out("r4") _,
            penalty = const 0x0101_0101_u32 * JUMP_PENALTY as u32,
        );
    }
}

/// True where curves so long and at these addresses are fours of whole words: double loads and
/// stores want whole words, rounds four of them.
#[inline(always)]
fn are_fours_of_words(length: usize, starts: &[*const u8]) -> bool {
    length > 0 && length.is_multiple_of(16) && starts.iter().all(|at| at.cast::<u32>().is_aligned())
}

/// The next cost of four entries of a path, from these and from the words that begin an entry
/// earlier (`near`) and later (`other`).
#[rustfmt::skip] // an instruction a line
macro_rules! path_word {
    ($here:literal, $cost:literal) => {
        concat!(
            "usub8 {x}, {near}, {other}\n",
            "sel {near}, {other}, {near}\n",
            "uqadd8 {near}, {near}, {step}\n",
            "usub8 {x}, {near}, {", $here, "}\n",
            "sel {near}, {", $here, "}, {near}\n",
            "uqsub8 {near}, {reach}, {near}\n",
            "usub8 {", $cost, "}, {", $cost, "}, {near}\n",
            "usub8 {x}, {", $cost, "}, {lows}\n",
            "sel {lows}, {lows}, {", $cost, "}\n",
        )
    };
}

/// See [`portable::path_step`].
pub fn path_step(costs: &[u8], lowest: u8, path: &mut [u8]) -> u8 {
    if costs.len() < path.len() || !are_fours_of_words(path.len(), &[costs.as_ptr(), path.as_ptr()])
    {
        return portable::path_step(costs, lowest, path);
    }
    let all = |byte: u8| u32::from_le_bytes([byte; 4]);
    let mut lows = u32::MAX;
    // SAFETY: both hold fours of words, at aligned addresses for double loads. Words of neighbours
    // are within the path: those that would begin before it or end behind it are shifted ones, with
    // the largest cost beyond the ends. A word is stored when its neighbours have been loaded.
    unsafe {
        asm!(
            "ldr {near}, [{path}]",
            "lsl {near}, {near}, #8",
            "orr {near}, {near}, #0xff",
            "2:",
            "ldrd {cost}, {next}, [{costs}], #8",
            "ldrd {here}, {then}, [{path}]",
            "ldr {other}, [{path}, #1]",
            path_word!("here", "cost"),
            "ldr {near}, [{path}, #3]",
            "ldr {other}, [{path}, #5]",
            path_word!("then", "next"),
            "ldr {near}, [{path}, #7]",
            "strd {cost}, {next}, [{path}], #8",
            "ldrd {cost}, {next}, [{costs}], #8",
            "ldrd {here}, {then}, [{path}]",
            "ldr {other}, [{path}, #1]",
            path_word!("here", "cost"),
            "ldr {near}, [{path}, #3]",
            "lsr {other}, {then}, #8",
            "orr {other}, {other}, #0xff000000",
            "subs {rounds}, {rounds}, #1",
            "itt ne",
            "ldrne {other}, [{path}, #5]",
            "ldrne {here}, [{path}, #7]",
            path_word!("then", "next"),
            "mov {near}, {here}",
            "strd {cost}, {next}, [{path}], #8",
            "bne 2b",
            rounds = inout(reg) path.len() / 16 => _,
            path = inout(reg) path.as_mut_ptr() => _,
            costs = inout(reg) costs.as_ptr() => _,
            cost = out(reg) _, next = out(reg) _, here = out(reg) _, then = out(reg) _,
            near = out(reg) _, other = out(reg) _, x = out(reg) _,
            lows = inout(reg) lows,
            reach = in(reg) all(lowest.saturating_add(JUMP_PENALTY)),
            step = in(reg) all(STEP_PENALTY),
            options(nostack),
        );
    }
    lowest_of(lows)
}

/// Two words of three paths, and the lowest of their sums.
#[rustfmt::skip] // an instruction a line
macro_rules! sums_of_two_words {
    () => {
        concat!(
            "ldrd {sum}, {then}, [{sums}]\n",
            "ldrd {x}, {y}, [{a}], #8\n",
            "uqadd8 {sum}, {sum}, {x}\n",
            "uqadd8 {then}, {then}, {y}\n",
            "ldrd {x}, {y}, [{b}], #8\n",
            "uqadd8 {sum}, {sum}, {x}\n",
            "uqadd8 {then}, {then}, {y}\n",
            "strd {sum}, {then}, [{sums}], #8\n",
            "usub8 {x}, {sum}, {lows}\n",
            "sel {lows}, {lows}, {sum}\n",
            "usub8 {x}, {then}, {lows}\n",
            "sel {lows}, {lows}, {then}\n",
        )
    };
}

/// See [`portable::sum_paths`].
pub fn sum_paths(a: &[u8], b: &[u8], sums: &mut [u8]) -> u8 {
    let (length, starts) = (sums.len(), [a.as_ptr(), b.as_ptr(), sums.as_ptr()]);
    if a.len() < length || b.len() < length || !are_fours_of_words(length, &starts) {
        return portable::sum_paths(a, b, sums);
    }
    let mut lows = u32::MAX;
    // SAFETY: all three hold fours of words, at aligned addresses.
    unsafe {
        asm!(
            "2:",
            sums_of_two_words!(),
            sums_of_two_words!(),
            "subs {rounds}, {rounds}, #1",
            "bne 2b",
            a = inout(reg) a.as_ptr() => _,
            b = inout(reg) b.as_ptr() => _,
            sums = inout(reg) sums.as_mut_ptr() => _,
            rounds = inout(reg) sums.len() / 16 => _,
            x = out(reg) _, y = out(reg) _, sum = out(reg) _, then = out(reg) _,
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
    (found != 0)
        .then(|| at.addr() - costs.as_ptr().addr() - 4 + found.trailing_zeros() as usize / 8)
}
