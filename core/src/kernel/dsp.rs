//! Kernels for cores with the Armv7E-M DSP extension: four bytes per instruction.
//!
//! In and out as the [`portable`](super::portable) versions, the same bits.
//!
//! # Cost
//! Instructions as counted under QEMU, against the portable version as compiled for the same core: see `docs/design.md`.
//!
//! # Source
//! Armv7-M Architecture Reference Manual, A7.7: USADA8, USUB8, SEL, UHADD8, UQADD8, UQSUB8.

use super::portable::{self, Crossing, FLAT, LANES, LargestStep, STRIP, Strip};
use core::arch::asm;

macro_rules! two_operands {
    ($name:ident, $instruction:literal) => {
        #[inline(always)]
        fn $name(a: u32, b: u32) -> u32 {
            let result: u32;
            // SAFETY: the instruction reads and writes registers alone; every core this module is compiled for has it.
            unsafe {
                asm!($instruction, r = lateout(reg) result, a = in(reg) a, b = in(reg) b,
                    options(pure, nomem, nostack, preserves_flags));
            }
            result
        }
    };
}

two_operands!(halving_add, "uhadd8 {r}, {a}, {b}");
/// The four bytes from `at` on.
///
/// # Safety
/// `at + 4 <= bytes.len()`.
#[inline(always)]
unsafe fn word(bytes: *const u8, at: usize) -> u32 {
    // SAFETY: the caller's.
    unsafe { bytes.add(at).cast::<u32>().read_unaligned() }
}

/// Four gradients at a time, `count` times, at least once; `here` is the mean of the first four columns.
///
/// # Safety
/// `4 * count + 4` bytes can be read from each row, `4 * count` written.
#[inline(always)]
unsafe fn gradient_words(rows: [*const u8; 3], out: *mut u8, here: u32, count: usize) {
    const CLIP: u32 = 0xe0e0_e0e0; // 255 - 31
    const ZERO: u32 = u32::from_ne_bytes([FLAT; 4]);
    let [above, row, below] = rows;
    // SAFETY: the caller's.
    unsafe {
        asm!(
            "2:",
            "ldr {next}, [{above}, #4]!",
            "ldr {t}, [{below}, #4]!",
            "uhadd8 {next}, {next}, {t}",
            "ldr {t}, [{row}, #4]!",
            "uhadd8 {next}, {next}, {t}",
            // Pixels x + 1 ..= x + 4: their left neighbours are `here`, their right ones two bytes further on.
            "lsr {right}, {here}, #16",
            "orr {right}, {right}, {next}, lsl #16",
            "uqsub8 {t}, {right}, {here}",
            "uqsub8 {right}, {here}, {right}",
            "uqadd8 {t}, {t}, {clip}",
            "uqadd8 {right}, {right}, {clip}",
            // At most one of the two differs from CLIP, so no byte of the result leaves 1 ..= 63.
            "sub {t}, {t}, {right}",
            "add {t}, {t}, {zero}",
            "mov {here}, {next}",
            "str {t}, [{out}], #4",
            "subs {count}, {count}, #1",
            "bne 2b",
            above = inout(reg) above => _,
            row = inout(reg) row => _,
            below = inout(reg) below => _,
            out = inout(reg) out => _,
            here = inout(reg) here => _,
            count = inout(reg) count => _,
            next = out(reg) _,
            right = out(reg) _,
            t = out(reg) _,
            clip = in(reg) CLIP,
            zero = in(reg) ZERO,
            options(nostack),
        );
    }
}

/// See [`portable::gradient_row`].
pub fn gradient_row(above: &[u8], row: &[u8], below: &[u8], out: &mut [u8]) {
    let width = row.len();
    if width < 12 || above.len() < width || below.len() < width || out.len() < width {
        return portable::gradient_row(above, row, below, out);
    }
    let (a, r, b, g) = (above.as_ptr(), row.as_ptr(), below.as_ptr(), out.as_mut_ptr());
    // SAFETY: reads end at `x + 8 <= width`, writes at `x + 5 <= width`; all four slices are that long.
    unsafe {
        let mean =
            |a: *const u8, r: *const u8, b: *const u8| halving_add(halving_add(word(a, 0), word(b, 0)), word(r, 0));
        gradient_words([a, r, b], g.add(1), mean(a, r, b), (width - 4) / 4);
    }
    // What is left of the row: fewer than eight pixels, once more from a few pixels before.
    let done = (width - 8) / 4 * 4 + 4;
    let tail = |row: &[u8]| row.get(done..width).map_or(([0; 8], 0), |rest| (first_eight(rest), rest.len()));
    let ((ta, count), (tr, _), (tb, _)) = (tail(above), tail(row), tail(below));
    let mut last = [FLAT; 8];
    if let (Some(ta), Some(tr), Some(tb), Some(last)) =
        (ta.get(..count), tr.get(..count), tb.get(..count), last.get_mut(..count))
    {
        portable::gradient_row(ta, tr, tb, last);
    }
    if let (Some(out), Some(last)) = (out.get_mut(done + 1..width), last.get(1..count)) {
        out.copy_from_slice(last);
    }
    if let Some(first) = out.first_mut() {
        *first = FLAT;
    }
}

/// At most eight bytes, padded.
fn first_eight(bytes: &[u8]) -> [u8; 8] {
    let mut eight = [0; 8];
    for (to, from) in eight.iter_mut().zip(bytes) {
        *to = *from;
    }
    eight
}

/// Four codes at a time, `count` times, at least once.
///
/// # Safety
/// `4 * count + 4` bytes can be read from each row, `4 * count` written.
#[inline(always)]
unsafe fn census_words(rows: [*const u8; 3], out: *mut u8, count: usize) {
    let [top, row, bottom] = rows;
    // SAFETY: the caller's; the flags between two instructions are nobody else's.
    unsafe {
        asm!(
            "2:",
            "ldr {centre}, [{row}, #2]",
            "ldr {other}, [{bottom}, #4]",
            "usub8 {other}, {other}, {centre}",
            "sel {code}, {zero}, {ones}",
            "ldr {other}, [{bottom}, #2]",
            "usub8 {other}, {other}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {other}, {code}, lsl #1",
            "ldr {other}, [{bottom}], #4",
            "usub8 {other}, {other}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {other}, {code}, lsl #1",
            "ldr {other}, [{row}, #4]",
            "usub8 {other}, {other}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {other}, {code}, lsl #1",
            "ldr {other}, [{row}], #4",
            "usub8 {other}, {other}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {other}, {code}, lsl #1",
            "ldr {other}, [{top}, #4]",
            "usub8 {other}, {other}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {other}, {code}, lsl #1",
            "ldr {other}, [{top}, #2]",
            "usub8 {other}, {other}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {other}, {code}, lsl #1",
            "ldr {other}, [{top}], #4",
            "usub8 {other}, {other}, {centre}",
            "sel {other}, {zero}, {ones}",
            "add {code}, {other}, {code}, lsl #1",
            "str {code}, [{out}], #4",
            "subs {count}, {count}, #1",
            "bne 2b",
            top = inout(reg) top => _,
            row = inout(reg) row => _,
            bottom = inout(reg) bottom => _,
            out = inout(reg) out => _,
            count = inout(reg) count => _,
            centre = out(reg) _,
            other = out(reg) _,
            code = out(reg) _,
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
    if width < 8 || top.len() < width || bottom.len() < width || out.len() < width {
        return portable::census_row(rows, out);
    }
    // SAFETY: reads end at `x + 8 <= width`, writes at `x + 6 <= width`, and all slices are that long.
    unsafe {
        let mut codes = |x: usize, count: usize| {
            census_words(
                [top.as_ptr().add(x), row.as_ptr().add(x), bottom.as_ptr().add(x)],
                out.as_mut_ptr().add(x + 2),
                count,
            );
        };
        codes(0, (width - 4) / 4);
        // The last pixels, some of them twice.
        codes(width - 8, 1);
    }
    for range in [0..2, width - 2..width] {
        if let Some(edge) = out.get_mut(range) {
            edge.fill(0);
        }
    }
}

/// See [`portable::sad_curve`].
pub fn sad_curve(strips: &[Strip<'_>], curve: &mut [u16]) {
    let needed = curve.len() + STRIP - 1;
    let mut long = strips.iter().filter(|strip| strip.other.len() >= needed);
    let whole = curve.as_chunks_mut::<LANES>().0.as_flattened_mut();
    loop {
        match (long.next(), long.next()) {
            (Some(a), Some(b)) => add_two_strips(a, b, whole),
            (Some(a), None) => return add_strip(a, whole),
            _ => return,
        }
    }
}

/// The two words of a strip's reference.
#[inline(always)]
fn halves(strip: &Strip<'_>) -> (u32, u32) {
    let [a, b, c, d, e, f, g, h] = strip.reference;
    (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]))
}

/// Adds two strips whose `other`s hold at least `curve.len() + 7` pixels; the curve is a multiple of eight long.
///
/// Every fourth disparity in one go: the second word read for one is the first word of the next.
#[inline]
fn add_two_strips(a: &Strip<'_>, b: &Strip<'_>, curve: &mut [u16]) {
    let ((a0, a1), (b0, b1)) = (halves(a), halves(b));
    let rounds = curve.len() / 8;
    if rounds == 0 {
        return;
    }
    for phase in 0..4 {
        // SAFETY: rounds * 2 disparities from `phase` on, every fourth: the last one is below `curve.len()`, and reads 8 pixels from there.
        unsafe {
            let (at_a, at_b) = (a.other.as_ptr().add(phase), b.other.as_ptr().add(phase));
            asm!(
                "2:",
                "ldrh {sum}, [{cost}]",
                "ldr {na}, [{pa}, #4]!",
                "ldr {nb}, [{pb}, #4]!",
                "usada8 {sum}, {oa}, {a0}, {sum}",
                "usada8 {sum}, {ob}, {b0}, {sum}",
                "usada8 {sum}, {na}, {a1}, {sum}",
                "usada8 {sum}, {nb}, {b1}, {sum}",
                "strh {sum}, [{cost}], #8",
                "ldrh {sum}, [{cost}]",
                "ldr {oa}, [{pa}, #4]!",
                "ldr {ob}, [{pb}, #4]!",
                "usada8 {sum}, {na}, {a0}, {sum}",
                "usada8 {sum}, {nb}, {b0}, {sum}",
                "usada8 {sum}, {oa}, {a1}, {sum}",
                "usada8 {sum}, {ob}, {b1}, {sum}",
                "strh {sum}, [{cost}], #8",
                "subs {rounds}, {rounds}, #1",
                "bne 2b",
                cost = inout(reg) curve.as_mut_ptr().add(phase) => _,
                pa = inout(reg) at_a => _,
                pb = inout(reg) at_b => _,
                oa = inout(reg) word(at_a, 0) => _,
                ob = inout(reg) word(at_b, 0) => _,
                na = out(reg) _,
                nb = out(reg) _,
                a0 = in(reg) a0,
                a1 = in(reg) a1,
                b0 = in(reg) b0,
                b1 = in(reg) b1,
                sum = out(reg) _,
                rounds = inout(reg) rounds => _,
                options(nostack),
            );
        }
    }
}

/// Adds one strip: see [`add_two_strips`].
#[inline]
fn add_strip(strip: &Strip<'_>, curve: &mut [u16]) {
    let (a0, a1) = halves(strip);
    let rounds = curve.len() / 8;
    if rounds == 0 {
        return;
    }
    for phase in 0..4 {
        // SAFETY: as above.
        unsafe {
            let at = strip.other.as_ptr().add(phase);
            asm!(
                "2:",
                "ldrh {sum}, [{cost}]",
                "ldr {na}, [{pa}, #4]!",
                "usada8 {sum}, {oa}, {a0}, {sum}",
                "usada8 {sum}, {na}, {a1}, {sum}",
                "strh {sum}, [{cost}], #8",
                "ldrh {sum}, [{cost}]",
                "ldr {oa}, [{pa}, #4]!",
                "usada8 {sum}, {na}, {a0}, {sum}",
                "usada8 {sum}, {oa}, {a1}, {sum}",
                "strh {sum}, [{cost}], #8",
                "subs {rounds}, {rounds}, #1",
                "bne 2b",
                cost = inout(reg) curve.as_mut_ptr().add(phase) => _,
                pa = inout(reg) at => _,
                oa = inout(reg) word(at, 0) => _,
                na = out(reg) _,
                a0 = in(reg) a0,
                a1 = in(reg) a1,
                sum = out(reg) _,
                rounds = inout(reg) rounds => _,
                options(nostack),
            );
        }
    }
}

/// Counts the bits of each nibble.
#[inline(always)]
fn nibble_counts(mut bits: u32) -> u32 {
    bits -= (bits >> 1) & 0x5555_5555;
    (bits & 0x3333_3333) + ((bits >> 2) & 0x3333_3333)
}

/// See [`portable::hamming_curve`].
pub fn hamming_curve(points: &[(u8, &[u8])], curve: &mut [u16]) {
    let whole = curve.as_chunks_mut::<LANES>().0.as_flattened_mut();
    let len = whole.len();
    let mut long = points.iter().filter(|(_, other)| other.len() >= len);
    let code = |reference: u8| u32::from(reference).wrapping_mul(0x0101_0101);
    // A byte per disparity holds the sum of all points; a nibble that of three.
    let mut sums = [0_u32; MAX_WORDS];
    let Some(sums) = sums.get_mut(..len / 4) else { return portable::hamming_curve(points, curve) };
    loop {
        let Some(&(reference_a, a)) = long.next() else { break };
        let Some(&(reference_b, b)) = long.next() else {
            add_codes(sums, |d| {
                // SAFETY: `a` is as long as the curve.
                nibble_counts(unsafe { word(a.as_ptr(), d) } ^ code(reference_a))
            });
            break;
        };
        let Some(&(reference_c, c)) = long.next() else {
            add_codes(sums, |d| {
                // SAFETY: `a` and `b` are as long as the curve.
                unsafe {
                    nibble_counts(word(a.as_ptr(), d) ^ code(reference_a))
                        + nibble_counts(word(b.as_ptr(), d) ^ code(reference_b))
                }
            });
            break;
        };
        add_codes(sums, |d| {
            // SAFETY: all three are as long as the curve.
            unsafe {
                nibble_counts(word(a.as_ptr(), d) ^ code(reference_a))
                    + nibble_counts(word(b.as_ptr(), d) ^ code(reference_b))
                    + nibble_counts(word(c.as_ptr(), d) ^ code(reference_c))
            }
        });
    }
    for (four, &mut sum) in whole.as_chunks_mut::<4>().0.iter_mut().zip(sums) {
        for (cost, sum) in four.iter_mut().zip(sum.to_le_bytes()) {
            *cost = cost.wrapping_add(u16::from(sum));
        }
    }
}

/// Words of the longest curve's bytes.
const MAX_WORDS: usize = 64;

/// Adds nibble counts to the bytes of four disparities at a time.
#[inline(always)]
fn add_codes(sums: &mut [u32], counts: impl Fn(usize) -> u32) {
    for (i, sum) in sums.iter_mut().enumerate() {
        let nibbles = counts(4 * i);
        *sum = sum.wrapping_add((nibbles & 0x0f0f_0f0f) + ((nibbles >> 4) & 0x0f0f_0f0f));
    }
}

/// Half word by half word sum, saturating.
#[inline(always)]
fn saturating_add_16(a: u32, b: u32) -> u32 {
    let result: u32;
    // SAFETY: as above.
    unsafe {
        asm!("uqadd16 {r}, {a}, {b}", r = lateout(reg) result, a = in(reg) a, b = in(reg) b,
            options(pure, nomem, nostack, preserves_flags));
    }
    result
}

/// Half word by half word minimum.
#[inline(always)]
fn lower_16(a: u32, b: u32) -> u32 {
    let result: u32;
    // SAFETY: as above; the flags between the two instructions are nobody else's.
    unsafe {
        asm!("usub16 {r}, {a}, {b}", "sel {r}, {b}, {a}", r = out(reg) result, a = in(reg) a, b = in(reg) b,
            options(pure, nomem, nostack));
    }
    result
}

/// Two entries as one word, and back.
#[inline(always)]
fn packed([low, high]: [u16; 2]) -> u32 {
    u32::from(low) | u32::from(high) << 16
}

#[inline(always)]
fn unpacked(word: u32) -> [u16; 2] {
    [word as u16, (word >> 16) as u16]
}

/// See [`portable::sum_curve`].
pub fn sum_curve(a: &[u16], b: &[u16], out: &mut [u16]) {
    let ((a, a1), (b, b1), (out, out1)) = (a.as_chunks(), b.as_chunks(), out.as_chunks_mut());
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = unpacked(saturating_add_16(packed(a), packed(b)));
    }
    portable::sum_curve(a1, b1, out1);
}

/// See [`portable::lower_curve`].
pub fn lower_curve(a: &[u16], b: &[u16], out: &mut [u16]) {
    let ((a, a1), (b, b1), (out, out1)) = (a.as_chunks(), b.as_chunks(), out.as_chunks_mut());
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = unpacked(lower_16(packed(a), packed(b)));
    }
    portable::lower_curve(a1, b1, out1);
}

/// See [`portable::lower_sum_curve`].
pub fn lower_sum_curve(a: &[u16], b: &[u16], c: &[u16], out: &mut [u16]) {
    let ((a, a1), (b, b1), (c, c1), (out, out1)) = (a.as_chunks(), b.as_chunks(), c.as_chunks(), out.as_chunks_mut());
    for (((out, &a), &b), &c) in out.iter_mut().zip(a).zip(b).zip(c) {
        *out = unpacked(saturating_add_16(lower_16(packed(a), packed(b)), packed(c)));
    }
    portable::lower_sum_curve(a1, b1, c1, out1);
}

/// See [`portable::lowest`].
pub fn lowest(curve: &[u16]) -> u16 {
    let (blocks, rest) = curve.as_chunks::<8>();
    let mut lowest = u32::MAX;
    for &[a, b, c, d, e, f, g, h] in blocks {
        for pair in [[a, b], [c, d], [e, f], [g, h]] {
            lowest = lower_16(lowest, packed(pair));
        }
    }
    let [low, high] = unpacked(lowest);
    low.min(high).min(portable::lowest(rest))
}

/// See [`portable::reverse_row`].
pub fn reverse_row(row: &mut [u8]) {
    let (words, rest) = row.as_chunks_mut::<4>();
    if !rest.is_empty() {
        return portable::reverse_row(row);
    }
    let (head, tail) = words.split_at_mut(words.len() / 2);
    for (a, b) in head.iter_mut().zip(tail.iter_mut().rev()) {
        let (from_head, from_tail) = (u32::from_le_bytes(*a), u32::from_le_bytes(*b));
        *a = from_tail.swap_bytes().to_le_bytes();
        *b = from_head.swap_bytes().to_le_bytes();
    }
    // The middle of an odd number of words.
    if tail.len() > head.len()
        && let Some(middle) = tail.first_mut()
    {
        middle.reverse();
    }
}

/// See [`portable::largest_step`].
#[inline]
pub fn largest_step(pixels: &[u8], stride: usize, count: usize) -> LargestStep {
    let there = count.checked_sub(1).and_then(|last| last.checked_mul(stride)).is_some_and(|last| last < pixels.len());
    if !there || !(2..0xffff).contains(&count) {
        return portable::largest_step(pixels, stride, count);
    }
    let mut best = 0;
    // SAFETY: the last of `count` pixels was just found to exist; `at` stays on pixels before it.
    unsafe {
        let mut at = pixels.as_ptr();
        let mut before = u32::from(*at);
        for left in (1..count as u32).rev() {
            at = at.wrapping_add(stride);
            let after = u32::from(*at);
            // Size above, distance from the end below: the first of equals is the largest.
            best = best.max(absolute_difference(after, before) << 16 | left);
            before = after;
        }
        if best >> 16 == 0 {
            return LargestStep { place: 0, step: 0 };
        }
        let place = count - 1 - (best & 0xffff) as usize;
        let first = pixels.as_ptr().add(place * stride);
        LargestStep { place: place as i32, step: i32::from(*first.add(stride)) - i32::from(*first) }
    }
}

/// Of two bytes.
#[inline(always)]
fn absolute_difference(a: u32, b: u32) -> u32 {
    let result: u32;
    // SAFETY: as above.
    unsafe {
        asm!("usad8 {r}, {a}, {b}", r = lateout(reg) result, a = in(reg) a, b = in(reg) b,
            options(pure, nomem, nostack, preserves_flags));
    }
    result
}

/// See [`portable::crossing_of_rows`].
#[inline]
pub fn crossing_of_rows(pixels: &[u8], first: usize, stride: usize, sign: i32) -> Option<Crossing> {
    if first.checked_add(stride)?.checked_add(7)? > pixels.len() {
        return None;
    }
    // SAFETY: the last of seven pixels of the second row was just found to exist.
    unsafe {
        let above = pixels.as_ptr().add(first);
        let below = above.add(stride);
        Some(portable::crossing(|u| *above.add(u), |u| *below.add(u), sign))
    }
}

/// See [`portable::crossing_of_columns`].
#[inline]
pub fn crossing_of_columns(pixels: &[u8], first: usize, stride: usize, sign: i32) -> Option<Crossing> {
    if stride.checked_mul(6)?.checked_add(first)?.checked_add(2)? > pixels.len() {
        return None;
    }
    // SAFETY: the last of the pairs in seven rows was just found to exist.
    unsafe {
        let at = pixels.as_ptr().add(first);
        Some(portable::crossing(|u| *at.add(u * stride), |u| *at.add(u * stride + 1), sign))
    }
}
