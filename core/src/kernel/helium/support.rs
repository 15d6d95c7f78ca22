//! Kernels of support points: costs of windows of codes, paths. Codes are in
//! [`codes`](super::codes).
//!
//! In: codes, curves of bytes over disparity. Out: costs, path costs and their sums.
//!
//! ```text
//! costs   a window is two vectors; four disparities a round, and what the second vector meets is
//!         what the first one meets four disparities later
//! path    entries before come by a shift of the vector, those behind by a load
//! ```
//!
//! # Cost
//! 64 disparities: costs 432 (853), path 94 (267), sums 62 (143), lowest 28 (91), place 50 (128).
//!
//! # Source
//! See [`super`].

use super::super::dsp;
use super::super::portable::{CodeColumn, JUMP_PENALTY, STEP_PENALTY, STRIP};
use super::VECTOR;

/// See [`portable::code_costs`](super::super::portable::code_costs).
pub fn code_costs(window: &[CodeColumn; STRIP], columns: &[CodeColumn], costs: &mut [u8]) {
    let length = (columns.len() + 1).saturating_sub(STRIP).min(costs.len());
    let Some(behind) = length.checked_sub(4) else {
        return dsp::code_costs(window, columns, costs);
    };
    let (window, columns, costs) =
        (window.as_ptr().cast(), columns.as_ptr().cast::<u8>(), costs.as_mut_ptr());
    // SAFETY: there are `length` costs and seven columns more, of which the fours begin within.
    unsafe {
        fours(window, columns, costs, length / 4);
        if !length.is_multiple_of(4) {
            // The rest, and some of those before it again.
            fours(window, columns.add(4 * behind), costs.add(behind), 1);
        }
    }
}

/// Costs of four disparities each, `rounds` times.
///
/// # Safety
/// There is a round at least. The window holds eight columns; there are four columns a round and
/// seven more. As many costs can be written as there are disparities.
#[inline(never)]
unsafe fn fours(window: *const u8, columns: *const u8, costs: *mut u8, rounds: usize) {
    // SAFETY: the caller's. The last load of the last round ends seven columns behind its four.
    unsafe {
        asm!(
            "msr APSR_g, {s0}",
            "vldrb.u8 q0, [{window}]",
            "vldrb.u8 q1, [{window}, #16]",
            "vldrb.u8 q2, [{columns}]",
            "vldrb.u8 q3, [{columns}, #4]",
            "vldrb.u8 q4, [{columns}, #8]",
            "vldrb.u8 q5, [{columns}, #12]",
            "2:",
            "mov {s0}, #0",
            "vabav.u8 {s0}, q0, q2",
            "vldrb.u8 q2, [{columns}, #16]!",
            "mov {s1}, #0",
            "vabav.u8 {s1}, q0, q3",
            "vldrb.u8 q3, [{columns}, #4]",
            "mov {s2}, #0",
            "vabav.u8 {s2}, q0, q4",
            "vldrb.u8 q4, [{columns}, #8]",
            "mov {s3}, #0",
            "vabav.u8 {s3}, q0, q5",
            "vldrb.u8 q5, [{columns}, #12]",
            "vabav.u8 {s0}, q1, q2",
            "vabav.u8 {s1}, q1, q3",
            "vabav.u8 {s2}, q1, q4",
            "vabav.u8 {s3}, q1, q5",
            // Four sums of 13 bits, of which the upper seven are kept.
            "pkhbt {s0}, {s0}, {s2}, lsl #16",
            "pkhbt {s1}, {s1}, {s3}, lsl #16",
            "lsr {s0}, {s0}, #6",
            "lsl {s1}, {s1}, #2",
            "sel {s0}, {s1}, {s0}",
            "add {s0}, {s0}, #{penalty}",
            "str {s0}, [{costs}], #4",
            "le lr, 2b",
            window = in(reg) window,
            columns = inout(reg) columns => _,
            costs = inout(reg) costs => _,
            inout("lr") rounds => _,
            s0 = inout(reg) 0xa << 16 => _, // `sel` takes every second byte from the first operand
            s1 = out(reg) _, s2 = out(reg) _, s3 = out(reg) _,
            penalty = const 0x0101_0101_u32 * JUMP_PENALTY as u32,
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            out("d4") _, out("d5") _, out("d6") _, out("d7") _,
            out("d8") _, out("d9") _, out("d10") _, out("d11") _,
            options(nostack),
        );
    }
}

/// The next costs of sixteen entries of a path, from these (q0), and from those that begin an entry
/// later (q2).
#[rustfmt::skip] // an instruction a line
macro_rules! path_vector {
    () => {
        concat!(
            "vmov q1, q0\n",
            "vshlc q1, {before}, #8\n",
            "vmin.u8 q2, q2, q1\n",
            "vqadd.u8 q2, q2, {step}\n",
            "vmin.u8 q2, q2, q0\n",
            // What is left to `reach`, at least 0.
            "vmvn q2, q2\n",
            "vqsub.u8 q2, q2, {beyond}\n",
            "vldrb.u8 q1, [{costs}], #16\n",
            "vsub.i8 q1, q1, q2\n",
            "vmin.u8 q3, q3, q1\n",
            "vstrb.u8 q1, [{path}], #16\n",
        )
    };
}

/// See [`portable::path_step`](super::super::portable::path_step).
pub fn path_step(costs: &[u8], lowest: u8, path: &mut [u8]) -> u8 {
    if costs.len() < path.len() || !are_vectors(path.len()) {
        return dsp::path_step(costs, lowest, path);
    }
    let reach = lowest.saturating_add(JUMP_PENALTY);
    let mut low = u32::from(u8::MAX);
    // SAFETY: both hold so many vectors. Entries behind are within the path: those of the last
    // vector are loaded from there on, and moved by one, the largest cost behind them. A vector is
    // stored when its neighbours have been loaded.
    unsafe {
        asm!(
            "vdup.8 q3, {low}",
            "mov {before}, {low}",
            "subs lr, lr, #1",
            "beq 3f",
            "2:",
            "vldrb.u8 q0, [{path}]",
            "vldrb.u8 q2, [{path}, #1]",
            path_vector!(),
            "le lr, 2b",
            "3:",
            "vctp.8 {last}",
            "vldrb.u8 q0, [{path}]",
            "vpst",
            "vldrbt.u8 q2, [{path}, #1]",
            "vmov.8 q2[15], {low}",
            path_vector!(),
            "vminv.u8 {low}, q3",
            inout("lr") path.len() / VECTOR => _,
            path = inout(reg) path.as_mut_ptr() => _,
            costs = inout(reg) costs.as_ptr() => _,
            before = out(reg) _,
            low = inout(reg) low,
            last = in(reg) VECTOR - 1,
            step = in(reg) u32::from(STEP_PENALTY),
            beyond = in(reg) u32::from(u8::MAX - reach),
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            out("d4") _, out("d5") _, out("d6") _, out("d7") _,
            options(nostack),
        );
    }
    low as u8
}

/// True where a curve is one vector or more, without a rest.
#[inline(always)]
fn are_vectors(length: usize) -> bool {
    length > 0 && length.is_multiple_of(VECTOR)
}

/// See [`portable::sum_paths`](super::super::portable::sum_paths).
pub fn sum_paths(a: &[u8], b: &[u8], sums: &mut [u8]) -> u8 {
    let length = sums.len();
    if a.len() < length || b.len() < length || !are_vectors(length) {
        return dsp::sum_paths(a, b, sums);
    }
    let mut low = u32::from(u8::MAX);
    // SAFETY: all three hold so many vectors.
    unsafe {
        asm!(
            "vdup.8 q3, {low}",
            "2:",
            "vldrb.u8 q0, [{sums}]",
            "vldrb.u8 q1, [{a}], #16",
            "vldrb.u8 q2, [{b}], #16",
            "vqadd.u8 q0, q0, q1",
            "vqadd.u8 q0, q0, q2",
            "vmin.u8 q3, q3, q0",
            "vstrb.u8 q0, [{sums}], #16",
            "le lr, 2b",
            "vminv.u8 {low}, q3",
            a = inout(reg) a.as_ptr() => _,
            b = inout(reg) b.as_ptr() => _,
            sums = inout(reg) sums.as_mut_ptr() => _,
            inout("lr") length / VECTOR => _,
            low = inout(reg) low,
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            out("d4") _, out("d5") _, out("d6") _, out("d7") _,
            options(nostack),
        );
    }
    low as u8
}

/// See [`portable::lowest_byte`](super::super::portable::lowest_byte).
pub fn lowest_byte(costs: &[u8]) -> u8 {
    if !are_vectors(costs.len()) {
        return dsp::lowest_byte(costs);
    }
    let mut low = u32::from(u8::MAX);
    // SAFETY: there are so many vectors.
    unsafe {
        asm!(
            "2:",
            "vldrb.u8 q0, [{at}], #16",
            "vminv.u8 {low}, q0",
            "le lr, 2b",
            at = inout(reg) costs.as_ptr() => _,
            inout("lr") costs.len() / VECTOR => _,
            low = inout(reg) low,
            out("d0") _, out("d1") _,
            options(readonly, nostack),
        );
    }
    low as u8
}

/// See [`portable::place_of_byte`](super::super::portable::place_of_byte).
pub fn place_of_byte(costs: &[u8], bound: u8) -> Option<usize> {
    if !are_vectors(costs.len()) {
        return dsp::place_of_byte(costs, bound);
    }
    let mut at = costs.as_ptr();
    let mut found: u32;
    // SAFETY: so many vectors are read at most.
    unsafe {
        asm!(
            "vdup.8 q1, {bound}",
            "2:",
            "vldrb.u8 q0, [{at}], #16",
            "vcmp.u8 cs, q1, q0",
            "vmrs {found}, p0",
            "cmp {found}, #0",
            "bne 3f",
            "le lr, 2b",
            "3:",
            at = inout(reg) at,
            inout("lr") costs.len() / VECTOR => _,
            found = out(reg) found,
            bound = in(reg) u32::from(bound),
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            options(readonly, nostack),
        );
    }
    let behind = at.addr() - costs.as_ptr().addr();
    (found != 0).then(|| behind - VECTOR + found.trailing_zeros() as usize)
}
