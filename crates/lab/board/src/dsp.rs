//! Kernels of block matching for cores with the Armv7E-M DSP extension, equal to the
//! [`portable`](crate::portable) ones bit for bit.
//!
//! ```text
//! sobel         four columns at a time: sums of three rows in half words, clipped by USAT16,
//!               UQSUB8 and UQADD8
//! block_costs   four pixels of a column in a word: USADA8; the words of the right image move on in
//!               registers, one load a disparity
//! add_block     sums in pairs of half words
//! ```
//!
//! The rest of a loop (groups that are no multiple of four, slices of other lengths) goes to the
//! portable kernel.
//!
//! # Cost
//! Instructions for four disparities: 23 for the costs of a block, 20 for its window.

use crate::portable::{self, Blocks, CAP, Group};
use core::arch::asm;

/// Groups of one turn of the loops over costs.
const UNROLLED: usize = 4;

/// See [`portable::sobel_row`].
pub(crate) fn sobel_row(above: &[u8], row: &[u8], below: &[u8], out: &mut [u8]) {
    let width = row.len();
    if width < 8 || above.len() != width || below.len() != width || out.len() != width {
        return portable::sobel_row(above, row, below, out);
    }
    let steps = (width - 4) / 4;
    // SAFETY: all slices hold `width` bytes. n steps read 4 n + 4 <= width bytes and write 4 n <=
    // width - 4 from the second on.
    unsafe {
        sobel_words([above.as_ptr(), row.as_ptr(), below.as_ptr()], out.as_mut_ptr().add(1), steps)
    };
    // The columns that are left; their neighbour before is written again.
    let from = 4 * steps;
    let mut rest = [CAP; 8];
    if let (Some(above), Some(row), Some(below)) =
        (above.get(from..), row.get(from..), below.get(from..))
        && let (Some(rest), Some(out)) = (rest.get_mut(..width - from), out.get_mut(from + 1..))
    {
        portable::sobel_row(above, row, below, rest);
        out.iter_mut().zip(rest.iter().skip(1)).for_each(|(out, value)| *out = *value);
    }
    if let Some(first) = out.first_mut() {
        *first = CAP;
    }
}

/// Four values at a time, `count` times, at least once.
///
/// # Safety
/// `4 * count + 4` bytes can be read from each row, `4 * count` written.
#[inline(never)]
unsafe fn sobel_words(rows: [*const u8; 3], out: *mut u8, count: usize) {
    let [above, row, below] = rows;
    // SAFETY: the caller's. Sums of columns are in two words, of even columns (r5) and of odd ones
    // (r8); the next four in r9 and r10. The two registers that cannot be named are kept on the
    // stack.
    unsafe {
        asm!(
            "push {{r6, r7}}",
            "mov r6, #0x61616161", // 128 - CAP
            "mov r7, #0xc1c1c1c1", // 255 - 2 CAP
            "ldr r11, [r0]",
            "ldr lr, [r2]",
            "uxtb16 r5, r11",
            "uxtb16 r8, r11, ror #8",
            "uxtab16 r5, r5, lr",
            "uxtab16 r8, r8, lr, ror #8",
            "ldr r11, [r1]",
            "uxtb16 lr, r11",
            "add r5, r5, lr, lsl #1",
            "uxtb16 lr, r11, ror #8",
            "add r8, r8, lr, lsl #1",
            "2:",
            "ldr r11, [r0, #4]!",
            "ldr lr, [r2, #4]!",
            "uxtb16 r9, r11",
            "uxtb16 r10, r11, ror #8",
            "uxtab16 r9, r9, lr",
            "uxtab16 r10, r10, lr, ror #8",
            "ldr r11, [r1, #4]!",
            "uxtb16 lr, r11",
            "add r9, r9, lr, lsl #1",
            "uxtb16 lr, r11, ror #8",
            "add r10, r10, lr, lsl #1",
            // The second and fourth column minus the first and third, plus 128, in bytes.
            "lsr r11, r5, #16",
            "orr r11, r11, r9, lsl #16",
            "usub16 r11, r11, r5",
            "uadd16 r11, r11, r12",
            "usat16 r11, #8, r11",
            "lsr lr, r8, #16",
            "orr lr, lr, r10, lsl #16",
            "usub16 lr, lr, r8",
            "uadd16 lr, lr, r12",
            "usat16 lr, #8, lr",
            "orr r11, r11, lr, lsl #8",
            "uqsub8 r11, r11, r6",
            "uqadd8 r11, r11, r7",
            "sub r11, r11, r7",
            "str r11, [r3], #4",
            "mov r5, r9",
            "mov r8, r10",
            "subs r4, r4, #1",
            "bne 2b",
            "pop {{r6, r7}}",
            inout("r0") above => _,
            inout("r1") row => _,
            inout("r2") below => _,
            inout("r3") out => _,
            inout("r4") count => _,
            out("r5") _, out("r8") _, out("r9") _, out("r10") _, out("r11") _,
            inout("r12") 0x0080_0080 => _,
            out("lr") _,
        );
    }
}

/// See [`portable::groups_within`].
#[inline]
pub(crate) fn groups_within(costs: &[Group], bound: u16) -> Option<[usize; 2]> {
    if costs.is_empty() || !costs.len().is_multiple_of(UNROLLED) || bound == u16::MAX {
        return portable::groups_within(costs, bound);
    }
    let above = (u32::from(bound) + 1).wrapping_mul(0x0001_0001);
    let (start, turns) = (costs.as_ptr(), costs.len() / UNROLLED);
    let (first, last): (*const Group, *const Group);
    // SAFETY: there is a turn, and four groups for each. Either loop ends at a group that has such
    // a cost, or after the last one; both point one group further on.
    unsafe {
        asm!(
            "2:",
            ".rept 4",
            "ldrd {a}, {b}, [{at}], #8",
            "uqsub16 {a}, {above}, {a}",
            "uqsub16 {b}, {above}, {b}",
            "orrs {a}, {a}, {b}",
            "bne 3f",
            ".endr",
            "subs {turns}, {turns}, #1",
            "bne 2b",
            "mov {at}, #0",
            "3:",
            at = inout(reg) start => first,
            turns = inout(reg) turns => _,
            above = in(reg) above,
            a = out(reg) _, b = out(reg) _,
            options(nostack, readonly),
        );
        if first.is_null() {
            return None;
        }
        asm!(
            "2:",
            "ldrd {a}, {b}, [{at}, #-8]!",
            "uqsub16 {a}, {above}, {a}",
            "uqsub16 {b}, {above}, {b}",
            "orrs {a}, {a}, {b}",
            "beq 2b",
            at = inout(reg) costs.as_ptr_range().end => last,
            above = in(reg) above,
            a = out(reg) _, b = out(reg) _,
            options(nostack, readonly),
        );
    }
    let place = |at: *const Group| at.addr().wrapping_sub(start.addr()) / size_of::<Group>();
    Some([place(first).wrapping_sub(1), place(last)])
}

/// See [`portable::places_within`].
#[inline]
pub(crate) fn places_within(group: Group, bound: u16) -> u32 {
    let Group([a, c, b, d]) = group;
    let places: u32;
    // SAFETY: registers alone; the flags between two instructions are nobody else's.
    unsafe {
        asm!(
            "usub16 {low}, {bound}, {low}",
            "sel {low}, {bits}, {zero}",
            "usub16 {high}, {bound}, {high}",
            "sel {high}, {bits}, {zero}",
            "orr {low}, {low}, {high}, lsl #1",
            "orr {low}, {low}, {low}, lsr #14",
            low = inout(reg) u32::from(a) | u32::from(c) << 16 => places,
            high = inout(reg) u32::from(b) | u32::from(d) << 16 => _,
            bound = in(reg) u32::from(bound) | u32::from(bound) << 16,
            bits = in(reg) 0x0001_0001,
            zero = in(reg) 0,
            options(pure, nomem, nostack),
        );
    }
    places & 0xf
}

/// See [`portable::columns_of_four`].
pub(crate) fn columns_of_four(rows: [&[u8]; 4], out: &mut [u32]) {
    let width = out.len();
    if width < 4 || !width.is_multiple_of(4) || rows.iter().any(|row| row.len() != width) {
        return portable::columns_of_four(rows, out);
    }
    let [a, b, c, d] = rows.map(<[u8]>::as_ptr);
    // SAFETY: four bytes of each row and four words of `out` for each turn, of which there is one.
    // The register that cannot be named is kept on the stack.
    unsafe {
        asm!(
            "push {{r6, r7}}",
            "mov r7, lr",
            "2:",
            "ldr r5, [r0], #4",
            "ldr r8, [r1], #4",
            "ldr r9, [r2], #4",
            "ldr r10, [r3], #4",
            // First and third column (r11, r12: upper two rows; r5, r9: lower two), then second and
            // fourth.
            "uxtb16 r11, r5",
            "uxtb16 lr, r8",
            "orr r11, r11, lr, lsl #8",
            "uxtb16 r12, r9",
            "uxtb16 lr, r10",
            "orr r12, r12, lr, lsl #8",
            "uxtb16 r5, r5, ror #8",
            "uxtb16 r8, r8, ror #8",
            "orr r5, r5, r8, lsl #8",
            "uxtb16 r9, r9, ror #8",
            "uxtb16 r10, r10, ror #8",
            "orr r9, r9, r10, lsl #8",
            "pkhbt r8, r11, r12, lsl #16",
            "pkhbt r10, r5, r9, lsl #16",
            "strd r8, r10, [r4], #8",
            "pkhtb r8, r12, r11, asr #16",
            "pkhtb r10, r9, r5, asr #16",
            "strd r8, r10, [r4], #8",
            "subs r7, r7, #1",
            "bne 2b",
            "pop {{r6, r7}}",
            inout("r0") a => _,
            inout("r1") b => _,
            inout("r2") c => _,
            inout("r3") d => _,
            inout("r4") out.as_mut_ptr() => _,
            out("r5") _, out("r8") _, out("r9") _, out("r10") _, out("r11") _, out("r12") _,
            inout("lr") width / 4 => _,
        );
    }
}

/// See [`portable::block_costs`].
#[inline]
pub(crate) fn block_costs(left: &[u32; 4], right: &[u32], out: &mut [Group]) {
    let count = 4 * out.len();
    if count == 0 || right.len() != count + 3 {
        return portable::block_costs(left, right, out);
    }
    // SAFETY: of count + 3 words the last three are read, then one for each disparity down to the
    // first. `out` has a group for each turn, of which there is one. The two registers that cannot
    // be named are kept on the stack.
    unsafe {
        let last = right.as_ptr().add(count + 2);
        asm!(
            "push {{r6, r7}}",
            "ldm r3, {{r3, r4, r5, r8}}",
            "ldr r11, [r0], #-4",
            "ldr r10, [r0], #-4",
            "ldr r9, [r0], #-4",
            "2:",
            "ldr r12, [r0], #-4",
            "usad8 lr, r3, r12",
            "usada8 lr, r4, r9, lr",
            "usada8 lr, r5, r10, lr",
            "usada8 lr, r8, r11, lr",
            "ldr r11, [r0], #-4",
            "usad8 r6, r3, r11",
            "usada8 r6, r4, r12, r6",
            "usada8 r6, r5, r9, r6",
            "usada8 r6, r8, r10, r6",
            "ldr r10, [r0], #-4",
            "usad8 r7, r3, r10",
            "usada8 r7, r4, r11, r7",
            "usada8 r7, r5, r12, r7",
            "usada8 r7, r8, r9, r7",
            "orr lr, lr, r7, lsl #16",
            "ldr r9, [r0], #-4",
            "usad8 r7, r3, r9",
            "usada8 r7, r4, r10, r7",
            "usada8 r7, r5, r11, r7",
            "usada8 r7, r8, r12, r7",
            "orr r6, r6, r7, lsl #16",
            "strd lr, r6, [r1], #8",
            "subs r2, r2, #1",
            "bne 2b",
            "pop {{r6, r7}}",
            inout("r0") last => _,
            inout("r1") out.as_mut_ptr() => _,
            inout("r2") out.len() => _,
            inout("r3") left.as_ptr() => _,
            out("r4") _, out("r5") _, out("r8") _, out("r9") _, out("r10") _, out("r11") _,
            out("r12") _, out("lr") _,
        );
    }
}

/// See [`portable::add_block`].
#[inline]
pub(crate) fn add_block(blocks: &mut Blocks<'_>, costs: &mut [Group]) -> Group {
    let count = costs.len();
    let is_same = blocks.enters.len() == count
        && blocks.leaves.len() == count
        && blocks.row.len() == count
        && blocks.kept.len() == count;
    if !is_same || count == 0 || !count.is_multiple_of(UNROLLED) {
        return portable::add_block(blocks, costs);
    }
    let (mut low, mut high) = (u32::MAX, u32::MAX);
    // SAFETY: all have four groups for each turn, of which there is one.
    unsafe {
        asm!(
            "2:",
            ".rept 4",
            "ldrd r9, r10, [r0], #8",
            "ldrd r11, r12, [r1], #8",
            "usub16 r9, r9, r11",
            "usub16 r10, r10, r12",
            "ldrd r11, r12, [r2]",
            "uadd16 r9, r9, r11",
            "uadd16 r10, r10, r12",
            "strd r9, r10, [r2], #8",
            "ldrd r11, r12, [r3]",
            "strd r9, r10, [r3], #8",
            "usub16 r9, r9, r11",
            "usub16 r10, r10, r12",
            "ldrd r11, r12, [r4]",
            "uadd16 r9, r9, r11",
            "uadd16 r10, r10, r12",
            "strd r9, r10, [r4], #8",
            "usub16 r11, r9, r5",
            "sel r5, r5, r9",
            "usub16 r11, r10, r8",
            "sel r8, r8, r10",
            ".endr",
            "subs lr, lr, #1",
            "bne 2b",
            inout("r0") blocks.enters.as_ptr() => _,
            inout("r1") blocks.leaves.as_ptr() => _,
            inout("r2") blocks.row.as_mut_ptr() => _,
            inout("r3") blocks.kept.as_mut_ptr() => _,
            inout("r4") costs.as_mut_ptr() => _,
            inout("r5") low,
            inout("r8") high,
            out("r9") _, out("r10") _, out("r11") _, out("r12") _,
            inout("lr") count / UNROLLED => _,
            options(nostack),
        );
    }
    let half = |word: u32| [word as u16, (word >> 16) as u16];
    let ([a, c], [b, d]) = (half(low), half(high));
    Group([a, c, b, d])
}
