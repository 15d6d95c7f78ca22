//! Kernels of support points: ranks, costs of windows of ranks, paths.
//!
//! In: rows of pixels or ranks, curves of bytes over disparity. Out: ranks, costs, path costs and their sums, four bytes a word.
//!
//! ```text
//! ranks   four columns of four rows a round: each neighbour is compared with four pixels at once, which leaves a one in each byte where it is darker
//! costs   four disparities a round, a column of four ranks an instruction; a column is loaded once for all disparities that use it
//! path    four words a round; the entries before and behind four are words at odd addresses
//! sums    four words a round
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

/// See [`portable::rank_columns`].
pub fn rank_columns(rows: [&[u8]; RANK_ROWS + 2], columns: &mut [RankColumn]) {
    let width = columns.len();
    let [above, inner @ .., below] = rows.map(<[u8]>::as_ptr);
    let [first, second, third, fourth] = inner.map(|row| row.addr());
    let stride = second.wrapping_sub(first);
    // Rows that the border of an image repeats are above and below the inner ones alone.
    let are_even = third.wrapping_sub(second) == stride && fourth.wrapping_sub(third) == stride;
    let are_whole = rows.iter().all(|row| row.len() >= width);
    if width < 8 || !width.is_multiple_of(4) || !are_even || !are_whole || !columns.as_ptr().cast::<u32>().is_aligned()
    {
        return portable::rank_columns(rows, columns);
    }
    // SAFETY: words * 4 + 4 pixels are read of the four inner rows, which are as long, as many but for the first two of the others; words * 4
    // columns are written from the third on, at aligned addresses. There is a word.
    unsafe { rank_words([above.add(2), inner[0], below.add(2)], stride, columns.as_mut_ptr().add(2), (width - 4) / 4) }
    for border in [0..2, width - 2..width] {
        if let Some(border) = columns.get_mut(border) {
            border.fill([RANK_FLAT; RANK_ROWS]);
        }
    }
}

/// Adds ones to ranks where the neighbours at an address are darker than the centres.
#[rustfmt::skip] // an instruction a line
macro_rules! add_neighbour {
    ($neighbour:literal, $address:literal, $centre:literal, $rank:literal) => {
        concat!(
            "ldr {", $neighbour, "}, ", $address, "\n",
            "usub8 {", $neighbour, "}, {", $neighbour, "}, {", $centre, "}\n",
            "sel {", $neighbour, "}, {zero}, {ones}\n",
            "add {", $rank, "}, {", $rank, "}, {", $neighbour, "}\n",
        )
    };
}

/// Ranks of four rows, four columns at a time, `words` times: `row` is the first of the four, at the left neighbours of its first pixels.
///
/// # Safety
/// There is a word at least; `4 * words + 4` bytes can be read from four rows that are `stride` bytes apart, `4 * words` from `above` and `below`;
/// `4 * words` columns can be written, at aligned addresses.
#[inline(never)]
unsafe fn rank_words([above, row, below]: [*const u8; 3], stride: usize, columns: *mut RankColumn, words: usize) {
    // SAFETY: the caller's.
    unsafe {
        asm!(
            "push {{r7}}", // the frame pointer, which no operand is given
            "mov r7, {d}",
            "2:",
            "ldr {x}, [{above}], #4",
            "ldr {y}, [{row}, #2]",
            "usub8 {x}, {x}, {y}",
            "sel {a}, {zero}, {ones}",
            add_neighbour!("x", "[{row}]", "y", "a"),
            add_neighbour!("x", "[{row}, #4]", "y", "a"),
            // From row to row the centres change places: one is below the last row, and the other above this one.
            "add {row}, {row}, {stride}",
            "ldr {x}, [{row}, #2]",
            "usub8 {b}, {x}, {y}",
            "sel {b}, {zero}, {ones}",
            "add {a}, {a}, {b}",
            "usub8 {y}, {y}, {x}",
            "sel {b}, {zero}, {ones}",
            add_neighbour!("y", "[{row}]", "x", "b"),
            add_neighbour!("y", "[{row}, #4]", "x", "b"),
            "add {row}, {row}, {stride}",
            "ldr {y}, [{row}, #2]",
            "usub8 {c}, {y}, {x}",
            "sel {c}, {zero}, {ones}",
            "add {b}, {b}, {c}",
            "usub8 {x}, {x}, {y}",
            "sel {c}, {zero}, {ones}",
            add_neighbour!("x", "[{row}]", "y", "c"),
            add_neighbour!("x", "[{row}, #4]", "y", "c"),
            "add {row}, {row}, {stride}",
            "ldr {x}, [{row}, #2]",
            "usub8 {d}, {x}, {y}",
            "sel {d}, {zero}, {ones}",
            "add {c}, {c}, {d}",
            "usub8 {y}, {y}, {x}",
            "sel {d}, {zero}, {ones}",
            add_neighbour!("y", "[{row}]", "x", "d"),
            add_neighbour!("y", "[{row}, #4]!", "x", "d"),
            "ldr {y}, [{below}], #4",
            "usub8 {y}, {y}, {x}",
            "sel {y}, {zero}, {ones}",
            "add {d}, {d}, {y}",
            "sub {row}, {row}, {stride}, lsl #1",
            "sub {row}, {row}, {stride}",
            // The first and third, the second and fourth byte of two rows.
            "uxtb16 {x}, {a}",
            "uxtb16 {y}, {b}",
            "orr {x}, {x}, {y}, lsl #8",
            "uxtb16 {a}, {a}, ror #8",
            "uxtb16 {b}, {b}, ror #8",
            "orr {b}, {a}, {b}, lsl #8",
            "uxtb16 {y}, {c}",
            "uxtb16 {a}, {d}",
            "orr {y}, {y}, {a}, lsl #8",
            "uxtb16 {c}, {c}, ror #8",
            "uxtb16 {d}, {d}, ror #8",
            "orr {d}, {c}, {d}, lsl #8",
            "pkhbt {a}, {x}, {y}, lsl #16",
            "pkhbt {c}, {b}, {d}, lsl #16",
            "strd {a}, {c}, [{column}], #8",
            "pkhtb {a}, {y}, {x}, asr #16",
            "pkhtb {c}, {d}, {b}, asr #16",
            "strd {a}, {c}, [{column}], #8",
            "subs r7, r7, #1",
            "bne 2b",
            "pop {{r7}}",
            above = inout(reg) above => _,
            row = inout(reg) row => _,
            below = inout(reg) below => _,
            stride = in(reg) stride,
            column = inout(reg) columns => _,
            x = out(reg) _,
            y = out(reg) _,
            a = out(reg) _,
            b = out(reg) _,
            c = out(reg) _,
            d = inout(reg) words => _,
            zero = in(reg) 0,
            ones = in(reg) 0x0101_0101,
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

/// True where curves so long and at these addresses are fours of whole words: double loads and stores want whole words, rounds four of them.
#[inline(always)]
fn are_fours_of_words(length: usize, starts: &[*const u8]) -> bool {
    length > 0 && length.is_multiple_of(16) && starts.iter().all(|at| at.cast::<u32>().is_aligned())
}

/// The next cost of four entries of a path, from these and from the words that begin an entry earlier (`near`) and later (`other`).
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
    if costs.len() < path.len() || !are_fours_of_words(path.len(), &[costs.as_ptr(), path.as_ptr()]) {
        return portable::path_step(costs, lowest, path);
    }
    let all = |byte: u8| u32::from_le_bytes([byte; 4]);
    let mut lows = u32::MAX;
    // SAFETY: both hold fours of words, at aligned addresses for double loads. Words of neighbours are within the path: those that would begin before
    // it or end behind it are shifted ones, with the largest cost beyond the ends. A word is stored when its neighbours have been loaded.
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
            cost = out(reg) _,
            next = out(reg) _,
            here = out(reg) _,
            then = out(reg) _,
            near = out(reg) _,
            other = out(reg) _,
            x = out(reg) _,
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
