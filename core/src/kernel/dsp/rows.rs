//! Rows of gradients and census codes, four pixels at a time; reversal of a row.
//!
//! In: the rows around one row of an image. Out: a byte for each of its pixels.
//!
//! ```text
//! gradient: mean of three rows, halving twice; the difference two columns apart saturates at the
//!           clip from either side
//! census:   centre with each of eight neighbours: USUB8 leaves in flags which are darker, SEL
//!           makes bits of them
//! ```
//!
//! # Cost
//! A row of 320 pixels, instructions under QEMU, and those of the portable version: gradient 1297
//! (7476), census 2638 (13 430), reversal 336 (973).
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, FLAT};
use super::{two_operands, word};

two_operands!(
    /// Byte by byte mean, rounded down.
    halving_add,
    "uhadd8 {r}, {a}, {b}"
);
two_operands!(
    /// Byte by byte sum, at most 255.
    saturating_add,
    "uqadd8 {r}, {a}, {b}"
);
two_operands!(
    /// Byte by byte difference, at least 0.
    saturating_sub,
    "uqsub8 {r}, {a}, {b}"
);

/// 255 - 31: a byte that saturates when more than 31 is added.
const CLIP: u32 = 0xe0e0_e0e0;
const ZERO: u32 = u32::from_ne_bytes([FLAT; 4]);

/// Mean of four columns of three rows, the middle one counting twice.
///
/// # Safety
/// Four bytes can be read from each row.
#[inline(always)]
unsafe fn mean([above, row, below]: [*const u8; 3]) -> u32 {
    // SAFETY: the caller's.
    unsafe { halving_add(halving_add(word(above), word(below)), word(row)) }
}

/// Eight gradients at a time, `count` times, at least once; `here` is the mean of the first four
/// columns.
///
/// # Safety
/// `8 * count + 4` bytes can be read from each row, `8 * count` written.
#[inline(always)]
unsafe fn gradient_words(rows: [*const u8; 3], out: *mut u8, here: u32, count: usize) {
    let [above, row, below] = rows;
    // SAFETY: the caller's. Step i reads eight bytes from 8 i + 4 on and writes eight from 8 i on.
    unsafe {
        asm!(
            "2:",
            "ldr {next}, [{above}, #4]!",
            "ldr {t}, [{below}, #4]!",
            "uhadd8 {next}, {next}, {t}",
            "ldr {t}, [{row}, #4]!",
            "uhadd8 {next}, {next}, {t}",
            // Pixels x + 1 ..= x + 4: their left neighbours are `here`, their right ones two bytes
            // further on.
            "lsr {right}, {here}, #16",
            "orr {right}, {right}, {next}, lsl #16",
            "uqsub8 {t}, {right}, {here}",
            "uqsub8 {right}, {here}, {right}",
            "uqadd8 {t}, {t}, {clip}",
            "uqadd8 {right}, {right}, {clip}",
            // At most one of the two differs from CLIP, so no byte of the result leaves 1 ..= 63.
            "sub {t}, {t}, {right}",
            "add {t}, {t}, {zero}",
            "str {t}, [{out}], #4",
            "ldr {here}, [{above}, #4]!",
            "ldr {t}, [{below}, #4]!",
            "uhadd8 {here}, {here}, {t}",
            "ldr {t}, [{row}, #4]!",
            "uhadd8 {here}, {here}, {t}",
            "lsr {right}, {next}, #16",
            "orr {right}, {right}, {here}, lsl #16",
            "uqsub8 {t}, {right}, {next}",
            "uqsub8 {right}, {next}, {right}",
            "uqadd8 {t}, {t}, {clip}",
            "uqadd8 {right}, {right}, {clip}",
            "sub {t}, {t}, {right}",
            "add {t}, {t}, {zero}",
            "str {t}, [{out}], #4",
            "subs {count}, {count}, #1",
            "bne 2b",
            above = inout(reg) above => _,
            row = inout(reg) row => _,
            below = inout(reg) below => _,
            out = inout(reg) out => _,
            here = inout(reg) here => _,
            count = inout(reg) count => _,
            next = out(reg) _, right = out(reg) _, t = out(reg) _,
            clip = in(reg) CLIP,
            zero = in(reg) ZERO,
            options(nostack),
        );
    }
}

/// The gradients of the four columns from the second one on.
///
/// # Safety
/// Six bytes can be read from each row.
#[inline(always)]
unsafe fn gradient_word(rows: [*const u8; 3]) -> u32 {
    // SAFETY: the caller's.
    let (left, right) = unsafe { (mean(rows), mean(rows.map(|row| row.add(2)))) };
    let rise = saturating_add(saturating_sub(right, left), CLIP);
    let fall = saturating_add(saturating_sub(left, right), CLIP);
    // As in the loop above: no byte leaves 1 ..= 63, so none borrows from the next.
    rise.wrapping_sub(fall).wrapping_add(ZERO)
}

/// See [`portable::limited_steps`].
#[inline]
pub fn limited_steps(before: &[u8], after: &[u8], most: u8, out: &mut [u8]) {
    let most = most.min(127);
    let [clip, zero] = [u8::MAX - most, most].map(|byte| u32::from_ne_bytes([byte; 4]));
    let length = out.len().min(before.len()).min(after.len());
    let (before, after, out) = (before.get(..length), after.get(..length), out.get_mut(..length));
    let (Some(before), Some(after), Some(out)) = (before, after, out) else { return };
    let ((before, rest_before), (after, rest_after)) = (before.as_chunks(), after.as_chunks());
    let (out, rest) = out.as_chunks_mut();
    for (out, (&before, &after)) in out.iter_mut().zip(before.iter().zip(after)) {
        let [before, after] = [before, after].map(u32::from_le_bytes);
        let rise = saturating_add(saturating_sub(after, before), clip);
        let fall = saturating_add(saturating_sub(before, after), clip);
        // At most one of both differs from `clip`: no byte leaves 0 ..= 2 `most`.
        *out = rise.wrapping_sub(fall).wrapping_add(zero).to_le_bytes();
    }
    portable::limited_steps(rest_before, rest_after, most, rest);
}

/// See [`portable::gradient_row`].
pub fn gradient_row(above: &[u8], row: &[u8], below: &[u8], out: &mut [u8]) {
    let width = row.len();
    if width < 14 || above.len() < width || below.len() < width || out.len() != width {
        return portable::gradient_row(above, row, below, out);
    }
    let (rows, to) = ([above, row, below].map(<[u8]>::as_ptr), out.as_mut_ptr());
    // SAFETY: all four slices hold at least `width` bytes. The loop takes n = (width - 4) / 8
    // steps: it reads 8 n + 4 <= width bytes and writes 8 n <= width - 4 from the second on. The
    // last words read the six bytes from `at` on and write four from `at + 1` on, where at + 6 <=
    // width.
    unsafe {
        gradient_words(rows, to.add(1), mean(rows), (width - 4) / 8);
        // Of the 2 to 9 columns that are left, and some of those before.
        let [above, row, below] = rows;
        for at in [width - 14, width - 10, width - 6] {
            let word = gradient_word([above.add(at), row.add(at), below.add(at)]);
            to.add(at + 1).cast::<u32>().write_unaligned(word);
        }
    }
    for edge in [0, width - 1] {
        if let Some(edge) = out.get_mut(edge) {
            *edge = FLAT;
        }
    }
}

/// Four codes at a time, `count` times, at least once.
///
/// # Safety
/// `4 * count + 4` bytes can be read from each row, `4 * count` written.
#[inline(always)]
unsafe fn census_words(rows: [*const u8; 3], out: *mut u8, count: usize) {
    let [top, row, bottom] = rows;
    // SAFETY: the caller's. Step i reads from 4 i to 4 i + 8 and writes four bytes from 4 i on; no
    // other code uses the flags between two instructions.
    unsafe {
        asm!(
            "2:",
            "ldr {centre}, [{row}, #2]",
            "usub8 {other}, {top_left}, {centre}",
            "sel {code}, {zero}, {ones}",
            "ldr {other}, [{top}, #2]",
            "usub8 {other}, {other}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {code}, {other}, lsl #1",
            "ldr {top_left}, [{top}, #4]!", // the left one of the next four
            "usub8 {other}, {top_left}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {code}, {other}, lsl #2",
            "usub8 {other}, {left}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {code}, {other}, lsl #3",
            "ldr {left}, [{row}, #4]!",
            "usub8 {other}, {left}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {code}, {other}, lsl #4",
            "usub8 {other}, {bottom_left}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {code}, {other}, lsl #5",
            "ldr {other}, [{bottom}, #2]",
            "usub8 {other}, {other}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {code}, {other}, lsl #6",
            "ldr {bottom_left}, [{bottom}, #4]!",
            "usub8 {other}, {bottom_left}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {code}, {other}, lsl #7",
            "str {code}, [{out}], #4",
            "subs {count}, {count}, #1",
            "bne 2b",
            top = inout(reg) top => _,
            row = inout(reg) row => _,
            bottom = inout(reg) bottom => _,
            out = inout(reg) out => _,
            count = inout(reg) count => _,
            top_left = inout(reg) word(top) => _,
            left = inout(reg) word(row) => _,
            bottom_left = inout(reg) word(bottom) => _,
            centre = out(reg) _, other = out(reg) _, code = out(reg) _,
            zero = in(reg) 0_u32,
            ones = in(reg) 0x0101_0101_u32,
            options(nostack),
        );
    }
}

/// See [`portable::census_row`].
pub fn census_row(rows: [&[u8]; 3], out: &mut [u8]) {
    let [top, row, bottom] = rows;
    let width = row.len();
    if width < 8 || top.len() < width || bottom.len() < width || out.len() != width {
        return portable::census_row(rows, out);
    }
    let (from, to) = (rows.map(<[u8]>::as_ptr), out.as_mut_ptr());
    // SAFETY: all four slices hold at least `width` bytes. The loop takes n = (width - 4) / 4
    // steps: it reads 4 n + 4 <= width bytes and writes 4 n <= width - 4 from the third on. The
    // last step reads the last eight bytes and writes four of them from the third on.
    unsafe {
        census_words(from, to.add(2), (width - 4) / 4);
        // The last pixels, some of them twice.
        census_words(from.map(|row| row.add(width - 8)), to.add(width - 6), 1);
    }
    for range in [0..2, width - 2..width] {
        if let Some(edge) = out.get_mut(range) {
            edge.fill(0);
        }
    }
}

/// See [`portable::census_code`].
#[inline(always)] // a call takes half as long again
pub fn census_code(pixels: &[u8], first: usize, stride: usize) -> Option<u8> {
    if stride.checked_mul(4)?.checked_add(first)?.checked_add(5)? > pixels.len() {
        return None;
    }
    let mut lighter = 0_u32;
    // SAFETY: the last of five pixels of the fifth row was just found to exist. The last neighbour
    // comes first: each leaves its bit in the carry, from where it is shifted in.
    unsafe {
        let top = pixels.as_ptr().add(first);
        let (row, bottom) = (top.add(2 * stride), top.add(4 * stride));
        asm!(
            "ldrb {centre}, [{row}, #2]",
            "ldrb {other}, [{bottom}, #4]",
            "cmp {other}, {centre}",
            "adc {code}, {code}, {code}",
            "ldrb {other}, [{bottom}, #2]",
            "cmp {other}, {centre}",
            "adc {code}, {code}, {code}",
            "ldrb {other}, [{bottom}]",
            "cmp {other}, {centre}",
            "adc {code}, {code}, {code}",
            "ldrb {other}, [{row}, #4]",
            "cmp {other}, {centre}",
            "adc {code}, {code}, {code}",
            "ldrb {other}, [{row}]",
            "cmp {other}, {centre}",
            "adc {code}, {code}, {code}",
            "ldrb {other}, [{top}, #4]",
            "cmp {other}, {centre}",
            "adc {code}, {code}, {code}",
            "ldrb {other}, [{top}, #2]",
            "cmp {other}, {centre}",
            "adc {code}, {code}, {code}",
            "ldrb {other}, [{top}]",
            "cmp {other}, {centre}",
            "adc {code}, {code}, {code}",
            top = in(reg) top,
            row = in(reg) row,
            bottom = in(reg) bottom,
            code = inout(reg) lighter,
            centre = out(reg) _, other = out(reg) _,
            options(pure, readonly, nostack),
        );
    }
    Some(!lighter as u8)
}

/// See [`portable::reverse_row`].
pub fn reverse_row(row: &mut [u8]) {
    let (words, rest) = row.as_chunks_mut::<4>();
    let pairs = words.len() / 2;
    if !rest.is_empty() || pairs == 0 {
        return portable::reverse_row(row);
    }
    // SAFETY: so many words from the front and from the back are within, and apart.
    unsafe {
        asm!(
            "2:",
            "ldr {a}, [{head}]",
            "ldr {b}, [{tail}, #-4]!",
            "rev {a}, {a}",
            "rev {b}, {b}",
            "str {b}, [{head}], #4",
            "str {a}, [{tail}]",
            "subs {pairs}, {pairs}, #1",
            "bne 2b",
            head = inout(reg) words.as_mut_ptr() => _,
            tail = inout(reg) words.as_mut_ptr_range().end => _,
            pairs = inout(reg) pairs => _,
            a = out(reg) _, b = out(reg) _,
            options(nostack),
        );
    }
    // The middle of an odd number of words.
    if !words.len().is_multiple_of(2)
        && let Some(middle) = words.get_mut(pairs)
    {
        middle.reverse();
    }
}
