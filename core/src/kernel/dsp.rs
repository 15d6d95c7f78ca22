//! Kernels for cores with the Armv7E-M DSP extension: four bytes per instruction.
//!
//! In and out as the [`portable`](super::portable) versions, the same bits.
//!
//! # Cost
//! Instructions as counted under QEMU, against the portable version as compiled for the same core: see `docs/design.md`.
//!
//! # Source
//! Armv7-M Architecture Reference Manual, A7.7: USADA8, USUB8, SEL, UHADD8, UQADD8, UQSUB8.

use super::portable::{self, FLAT, LANES, STRIP, Strip};
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
two_operands!(saturating_add, "uqadd8 {r}, {a}, {b}");
two_operands!(saturating_sub, "uqsub8 {r}, {a}, {b}");

/// `sum` plus the absolute differences of the four bytes.
#[inline(always)]
fn add_differences(a: u32, b: u32, sum: u32) -> u32 {
    let result: u32;
    // SAFETY: as above.
    unsafe {
        asm!("usada8 {r}, {a}, {b}, {c}", r = lateout(reg) result, a = in(reg) a, b = in(reg) b, c = in(reg) sum,
            options(pure, nomem, nostack, preserves_flags));
    }
    result
}

/// In each byte `bits` where `a < b`, else 0.
#[inline(always)]
fn where_less(a: u32, b: u32, bits: u32) -> u32 {
    let result: u32;
    // SAFETY: as above; the flags between the two instructions are nobody else's.
    unsafe {
        asm!("usub8 {r}, {a}, {b}", "sel {r}, {zero}, {bits}", r = out(reg) result, a = in(reg) a, b = in(reg) b,
            zero = in(reg) 0_u32, bits = in(reg) bits, options(pure, nomem, nostack));
    }
    result
}

/// The four bytes from `at` on.
///
/// # Safety
/// `at + 4 <= bytes.len()`.
#[inline(always)]
unsafe fn word(bytes: *const u8, at: usize) -> u32 {
    // SAFETY: the caller's.
    unsafe { bytes.add(at).cast::<u32>().read_unaligned() }
}

/// See [`portable::gradient_row`].
pub fn gradient_row(above: &[u8], row: &[u8], below: &[u8], out: &mut [u8]) {
    const CLIP: u32 = 0xe0e0_e0e0; // 255 - 31
    const ZERO: u32 = u32::from_ne_bytes([FLAT; 4]);
    let width = row.len();
    if width < 12 || above.len() < width || below.len() < width || out.len() < width {
        return portable::gradient_row(above, row, below, out);
    }
    let (a, r, b, g) = (above.as_ptr(), row.as_ptr(), below.as_ptr(), out.as_mut_ptr());
    // SAFETY: reads end at `x + 8 <= width`, writes at `x + 5 <= width`; all four slices are that long.
    unsafe {
        let mean = |x: usize| halving_add(halving_add(word(a, x), word(b, x)), word(r, x));
        let mut x = 0;
        let mut here = mean(0);
        while x + 8 <= width {
            let next = mean(x + 4);
            // Pixels x + 1 ..= x + 4: their left neighbours are `here`, their right ones two bytes further on.
            let right = (here >> 16) | (next << 16);
            let rising = saturating_add(saturating_sub(right, here), CLIP);
            let falling = saturating_add(saturating_sub(here, right), CLIP);
            // At most one of the two differs from CLIP, so no byte of the result leaves 1 ..= 63.
            let gradients = rising.wrapping_sub(falling).wrapping_add(ZERO);
            g.add(x + 1).cast::<u32>().write_unaligned(gradients);
            here = next;
            x += 4;
        }
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

/// See [`portable::census_row`].
pub fn census_row(rows: [&[u8]; 3], out: &mut [u8]) {
    let [top, row, bottom] = rows;
    let width = row.len();
    if width < 8 || top.len() < width || bottom.len() < width || out.len() < width {
        return portable::census_row(rows, out);
    }
    // SAFETY: every read ends at `x + 8 <= width`, every write at `x + 6 <= width`, and all slices are that long.
    unsafe {
        let codes = |x: usize| {
            let (t, r, b) = (top.as_ptr(), row.as_ptr(), bottom.as_ptr());
            let centre = word(r, x + 2);
            let darker = |bytes: *const u8, at: usize| where_less(word(bytes, at), centre, 0x0101_0101);
            let mut code = darker(b, x + 4);
            for (bytes, at) in [(b, x + 2), (b, x), (r, x + 4), (r, x), (t, x + 4), (t, x + 2), (t, x)] {
                code = darker(bytes, at).wrapping_add(code << 1);
            }
            code
        };
        let mut x = 0;
        while x + 8 <= width {
            out.as_mut_ptr().add(x + 2).cast::<u32>().write_unaligned(codes(x));
            x += 4;
        }
        // The last pixels, some of them twice.
        out.as_mut_ptr().add(width - 6).cast::<u32>().write_unaligned(codes(width - 8));
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
    loop {
        match (long.next(), long.next(), long.next()) {
            (Some(a), Some(b), Some(c)) => add_strips([a, b, c], curve),
            (Some(a), Some(b), None) => return add_strips([a, b], curve),
            (Some(a), None, _) => return add_strips([a], curve),
            _ => return,
        }
    }
}

/// Adds strips whose `other` holds at least `curve.len() + STRIP - 1` pixels.
#[inline(always)]
fn add_strips<const N: usize>(strips: [&Strip<'_>; N], curve: &mut [u16]) {
    const UNROLLED: usize = 4;
    let half = |strip: &Strip<'_>, from: usize| {
        let [a, b, c, d] = strip.reference.get(from..).and_then(|r| r.first_chunk()).copied().unwrap_or([0; 4]);
        u32::from_le_bytes([a, b, c, d])
    };
    let first = strips.map(|strip| half(strip, 0));
    let second = strips.map(|strip| half(strip, 4));
    let mut others = strips.map(|strip| strip.other.as_ptr());
    for costs in curve.as_chunks_mut::<UNROLLED>().0 {
        for (d, cost) in costs.iter_mut().enumerate() {
            let mut sum = u32::from(*cost);
            for ((&other, &first), &second) in others.iter().zip(&first).zip(&second) {
                // SAFETY: disparity d reads 8 pixels from d on; all `other`s are longer than the curve by 7.
                unsafe {
                    sum = add_differences(first, word(other, d), sum);
                    sum = add_differences(second, word(other, d + 4), sum);
                }
            }
            *cost = sum as u16;
        }
        for other in &mut others {
            // SAFETY: at most the curve's length further on.
            *other = unsafe { other.add(UNROLLED) };
        }
    }
}

/// See [`portable::hamming_curve`].
pub fn hamming_curve(points: &[(u8, &[u8])], curve: &mut [u16]) {
    for (block, costs) in curve.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
        let start = block * LANES;
        for (quad, four) in costs.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let mut sums = 0_u32; // a byte per disparity: at most 31 points of 8 bits
            for (reference, other) in points {
                if other.len() < start + LANES {
                    continue;
                }
                // SAFETY: four bytes inside the block that was just found to exist.
                let others = unsafe { word(other.as_ptr(), start + quad * 4) };
                let mut bits = others ^ u32::from(*reference).wrapping_mul(0x0101_0101);
                bits -= (bits >> 1) & 0x5555_5555;
                bits = (bits & 0x3333_3333) + ((bits >> 2) & 0x3333_3333);
                sums = sums.wrapping_add((bits + (bits >> 4)) & 0x0f0f_0f0f);
            }
            for (cost, sum) in four.iter_mut().zip(sums.to_le_bytes()) {
                *cost = cost.wrapping_add(u16::from(sum));
            }
        }
    }
}
