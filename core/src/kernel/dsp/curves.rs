//! Curves of costs over disparity.
//!
//! In: eight pixels or a census code, and the row in which they are searched; or curves. Out: sums
//! per disparity; or one curve of several.
//!
//! ```text
//! sad:     every fourth disparity in one pass: the second word read for one is the first of the
//!          next; two strips a pass
//! hamming: four disparities a word; bits are counted in nibbles, which hold three points, then in
//!          bytes, which hold 31
//! others:  two entries a word
//! ```
//!
//! # Bounds
//! A nibble counts 3 * 4 = 12 at most, a byte 31 * 8 = 248. Sums of absolute differences wrap at
//! 2^16 as the portable ones do.
//!
//! # Cost
//! 64 disparities, instructions under QEMU, and those of the portable version: 12 strips 4029 (40
//! 064), 12 points 2989 (10 418), sum 219 (385), lower 252 (514), lower and sum 328 (671), lowest
//! 147 (344).
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, LANES, STRIP, Strip};
use super::{two_operands, word};

/// See [`portable::sad_curve`].
pub fn sad_curve(strips: &[Strip<'_>], curve: &mut [u16]) {
    let needed = curve.len() + STRIP - 1;
    let mut long = strips.iter().filter(|strip| strip.other.len() >= needed);
    let whole = curve.as_chunks_mut::<LANES>().0.as_flattened_mut();
    loop {
        // SAFETY: `whole` is a multiple of 16 long and at most as long as the curve, of which the
        // strips left over are known to hold as many pixels and seven more.
        unsafe {
            match (long.next(), long.next()) {
                (Some(a), Some(b)) => add_two_strips(a, b, whole),
                (Some(a), None) => return add_strip(a, whole),
                _ => return,
            }
        }
    }
}

/// The two words of a strip's reference.
#[inline(always)]
fn halves(strip: &Strip<'_>) -> (u32, u32) {
    let [a, b, c, d, e, f, g, h] = strip.reference;
    (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]))
}

/// Adds two strips.
///
/// # Safety
/// The curve is a multiple of eight long, and each `other` holds at least `curve.len() + 7` pixels.
#[inline]
unsafe fn add_two_strips(a: &Strip<'_>, b: &Strip<'_>, curve: &mut [u16]) {
    let rounds = curve.len() / 8;
    if rounds == 0 {
        return;
    }
    // SAFETY: the caller's. Four calls, as a loop would cost a tenth.
    unsafe {
        add_two_strips_from(0, rounds, a, b, curve);
        add_two_strips_from(1, rounds, a, b, curve);
        add_two_strips_from(2, rounds, a, b, curve);
        add_two_strips_from(3, rounds, a, b, curve);
    }
}

/// Adds to every fourth disparity from `phase` on.
///
/// # Safety
/// As [`add_two_strips`], with `rounds` = `curve.len() / 8` above 0.
#[inline(always)]
unsafe fn add_two_strips_from(
    phase: usize,
    rounds: usize,
    a: &Strip<'_>,
    b: &Strip<'_>,
    curve: &mut [u16],
) {
    let ((a0, a1), (b0, b1)) = (halves(a), halves(b));
    // SAFETY: rounds * 2 disparities from `phase` on, every fourth: the last one is phase + len - 4
    // < len. It meets the eight pixels from there on, which end at phase + len + 4 <= len + 7;
    // before the first round, four are read.
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
            oa = inout(reg) word(at_a) => _,
            ob = inout(reg) word(at_b) => _,
            na = out(reg) _, nb = out(reg) _,
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

/// Adds one strip.
///
/// # Safety
/// As [`add_two_strips`].
#[inline]
unsafe fn add_strip(strip: &Strip<'_>, curve: &mut [u16]) {
    let rounds = curve.len() / 8;
    if rounds == 0 {
        return;
    }
    // SAFETY: the caller's.
    unsafe {
        add_strip_from(0, rounds, strip, curve);
        add_strip_from(1, rounds, strip, curve);
        add_strip_from(2, rounds, strip, curve);
        add_strip_from(3, rounds, strip, curve);
    }
}

/// Adds to every fourth disparity from `phase` on.
///
/// # Safety
/// As [`add_two_strips_from`].
#[inline(always)]
unsafe fn add_strip_from(phase: usize, rounds: usize, strip: &Strip<'_>, curve: &mut [u16]) {
    let (a0, a1) = halves(strip);
    // SAFETY: as in `add_two_strips_from`.
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
            oa = inout(reg) word(at) => _,
            na = out(reg) _,
            a0 = in(reg) a0,
            a1 = in(reg) a1,
            sum = out(reg) _,
            rounds = inout(reg) rounds => _,
            options(nostack),
        );
    }
}

/// Counts the bits of each nibble.
#[inline(always)]
fn nibble_counts(mut bits: u32) -> u32 {
    bits -= (bits >> 1) & 0x5555_5555;
    (bits & 0x3333_3333) + ((bits >> 2) & 0x3333_3333)
}

/// Disparities whose sums are held at a time, a byte each: those of most searches.
const BLOCK: usize = 64;
/// Points whose distances a byte holds.
const MAX_POINTS: usize = 31;

/// See [`portable::hamming_curve`].
pub fn hamming_curve(points: &[(u8, &[u8])], curve: &mut [u16]) {
    let whole = curve.as_chunks_mut::<LANES>().0.as_flattened_mut();
    let len = whole.len();
    if points.len() > MAX_POINTS || points.iter().any(|(_, other)| other.len() < len) {
        return portable::hamming_curve(points, curve);
    }
    let (threes, rest) = points.as_chunks::<3>();
    for (first, block) in (0..).step_by(BLOCK).zip(whole.chunks_mut(BLOCK)) {
        let mut all = [0_u32; BLOCK / 4];
        let sums = all.get_mut(..block.len() / 4).unwrap_or(&mut []);
        // SAFETY: every point's slice holds at least `len` bytes, four for each of the sums from
        // `first` on.
        unsafe {
            for three in threes {
                add_points(sums, three, first);
            }
            match rest.first_chunk::<2>() {
                Some(two) => add_points(sums, two, first),
                None => rest.as_chunks::<1>().0.iter().for_each(|one| add_points(sums, one, first)),
            }
        }
        for (four, &mut sum) in block.as_chunks_mut::<4>().0.iter_mut().zip(sums) {
            let ([a, b, c, d], of) = (four, sum.to_le_bytes());
            *a = a.wrapping_add(of[0].into());
            *b = b.wrapping_add(of[1].into());
            *c = c.wrapping_add(of[2].into());
            *d = d.wrapping_add(of[3].into());
        }
    }
}

/// Adds the distances of at most three points to the bytes of four disparities at a time, from
/// disparity `first` on.
///
/// # Safety
/// Four bytes of each point's slice can be read from there on for every sum.
#[inline(never)] // one loop of each kind, without the others' conditions
unsafe fn add_points<const N: usize>(sums: &mut [u32], points: &[(u8, &[u8]); N], first: usize) {
    const { assert!(N <= 3) }
    for (i, sum) in sums.iter_mut().enumerate() {
        let counts = |place: usize| {
            points.get(place).map_or(0, |&(code, other)| {
                // SAFETY: the caller's.
                let codes = unsafe { word(other.as_ptr().add(first + 4 * i)) };
                nibble_counts(codes ^ u32::from(code).wrapping_mul(0x0101_0101))
            })
        };
        let nibbles = counts(0) + counts(1) + counts(2);
        *sum = sum.wrapping_add((nibbles & 0x0f0f_0f0f) + ((nibbles >> 4) & 0x0f0f_0f0f));
    }
}

two_operands!(
    /// Half word by half word sum, saturating.
    saturating_add,
    "uqadd16 {r}, {a}, {b}"
);

/// Half word by half word minimum.
#[inline(always)]
fn lower(a: u32, b: u32) -> u32 {
    let result: u32;
    // SAFETY: registers alone, as in `two_operands`; no other code uses the flags between the two
    // instructions.
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
    if a.len() != out.len() || b.len() != out.len() {
        return portable::sum_curve(a, b, out);
    }
    let ((a, a1), (b, b1), (out, out1)) = (a.as_chunks(), b.as_chunks(), out.as_chunks_mut());
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = unpacked(saturating_add(packed(a), packed(b)));
    }
    portable::sum_curve(a1, b1, out1);
}

/// See [`portable::lower_curve`].
pub fn lower_curve(a: &[u16], b: &[u16], out: &mut [u16]) {
    if a.len() != out.len() || b.len() != out.len() {
        return portable::lower_curve(a, b, out);
    }
    let ((a, a1), (b, b1), (out, out1)) = (a.as_chunks(), b.as_chunks(), out.as_chunks_mut());
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = unpacked(lower(packed(a), packed(b)));
    }
    portable::lower_curve(a1, b1, out1);
}

/// See [`portable::lower_sum_curve`].
pub fn lower_sum_curve(a: &[u16], b: &[u16], c: &[u16], out: &mut [u16]) {
    if a.len() != out.len() || b.len() != out.len() || c.len() != out.len() {
        return portable::lower_sum_curve(a, b, c, out);
    }
    let ((a, a1), (b, b1), (c, c1), (out, out1)) =
        (a.as_chunks(), b.as_chunks(), c.as_chunks(), out.as_chunks_mut());
    for (((out, &a), &b), &c) in out.iter_mut().zip(a).zip(b).zip(c) {
        *out = unpacked(saturating_add(lower(packed(a), packed(b)), packed(c)));
    }
    portable::lower_sum_curve(a1, b1, c1, out1);
}

/// See [`portable::lowest`].
pub fn lowest(curve: &[u16]) -> u16 {
    let (blocks, rest) = curve.as_chunks::<8>();
    let Some(last) = curve.last_chunk::<8>() else { return lowest_of_few(curve) };
    // The rest, and some of those before it again. Pairs are written out, as the compiler does not
    // unroll a loop over them.
    let rest: &[_] = if rest.is_empty() { &[] } else { core::slice::from_ref(last) };
    let mut lowest = u32::MAX;
    for &[a, b, c, d, e, f, g, h] in blocks.iter().chain(rest) {
        lowest = lower(lowest, packed([a, b]));
        lowest = lower(lowest, packed([c, d]));
        lowest = lower(lowest, packed([e, f]));
        lowest = lower(lowest, packed([g, h]));
    }
    let [low, high] = unpacked(lowest);
    low.min(high)
}

/// The lowest entry of a curve of a few.
#[inline(always)]
fn lowest_of_few(curve: &[u16]) -> u16 {
    let (pairs, rest) = curve.as_chunks::<2>();
    let of_rest = rest.first().copied().unwrap_or(u16::MAX);
    let lows = pairs.iter().fold(packed([of_rest; 2]), |lows, &pair| lower(lows, packed(pair)));
    let [low, high] = unpacked(lows);
    low.min(high)
}
