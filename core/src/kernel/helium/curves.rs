//! Curves of costs over disparity.
//!
//! In: eight pixels, and the row in which they are searched; or a curve. Out: sums per disparity;
//! or the lowest entry.
//!
//! ```text
//! sad     eight pixels are widened to a vector; four strips a pass, then two, then one
//! lowest  eight entries an instruction
//! ```
//!
//! # Cost
//! 64 disparities: 12 strips 2279 (4091), lowest 41 (181).
//!
//! # Source
//! See [`super`].

use super::super::dsp;
use super::super::portable::{LANES, STRIP, Strip};

/// Entries of a vector.
const ENTRIES: usize = 8;

/// See [`portable::sad_curve`](super::super::portable::sad_curve).
pub fn sad_curve(strips: &[Strip<'_>], curve: &mut [u16]) {
    let needed = curve.len() + STRIP - 1;
    let mut long = strips.iter().filter(|strip| strip.other.len() >= needed);
    let whole = curve.as_chunks_mut::<LANES>().0.as_flattened_mut();
    if whole.is_empty() {
        return;
    }
    loop {
        let four = [long.next(), long.next(), long.next(), long.next()];
        // SAFETY: `whole` is a multiple of 16 long and at most as long as the curve, of which the
        // strips left over are known to hold as many pixels and seven more.
        unsafe {
            match four {
                [Some(a), Some(b), Some(c), Some(d)] => add_four_strips([a, b, c, d], whole),
                [Some(a), Some(b), last, _] => {
                    add_two_strips([a, b], whole);
                    return last.into_iter().for_each(|strip| add_strip(strip, whole));
                }
                [last, ..] => return last.into_iter().for_each(|strip| add_strip(strip, whole)),
            }
        }
    }
}

/// The differences of a disparity, added to {sum}; then the next one.
macro_rules! add_differences {
    ($pixels:literal, $reference:literal) => {
        concat!("vldrb.u16 q4, [", $pixels, "], #1\n", "vabav.u16 {sum}, q4, ", $reference, "\n")
    };
}

/// A disparity of four strips.
macro_rules! disparity_of_four {
    () => {
        concat!(
            "ldrh {sum}, [{cost}]\n",
            add_differences!("r0", "q0"),
            add_differences!("r1", "q1"),
            add_differences!("r2", "q2"),
            add_differences!("r3", "q3"),
            "strh {sum}, [{cost}], #2\n",
        )
    };
}

/// Adds four strips.
///
/// # Safety
/// The curve is a multiple of 16 long and not empty, and each `other` holds at least
/// `curve.len() + 7` pixels.
#[inline(never)]
unsafe fn add_four_strips(strips: [&Strip<'_>; 4], curve: &mut [u16]) {
    let [a, b, c, d] = strips.map(|strip| strip.other.as_ptr());
    let references = strips.map(|strip| strip.reference);
    // SAFETY: the caller's; eight pixels are read from each disparity on.
    unsafe {
        asm!(
            "vldrb.u16 q0, [r4]",
            "vldrb.u16 q1, [r4, #8]",
            "vldrb.u16 q2, [r4, #16]",
            "vldrb.u16 q3, [r4, #24]",
            "2:",
            disparity_of_four!(),
            disparity_of_four!(),
            disparity_of_four!(),
            disparity_of_four!(),
            "le lr, 2b",
            inout("r0") a => _,
            inout("r1") b => _,
            inout("r2") c => _,
            inout("r3") d => _,
            in("r4") references.as_ptr(),
            cost = inout(reg) curve.as_mut_ptr() => _,
            inout("lr") curve.len() / 4 => _,
            sum = out(reg) _,
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            out("d4") _, out("d5") _, out("d6") _, out("d7") _,
            out("d8") _, out("d9") _,
            options(nostack),
        );
    }
}

/// A disparity of two strips.
macro_rules! disparity_of_two {
    () => {
        concat!(
            "ldrh {sum}, [{cost}]\n",
            add_differences!("r0", "q0"),
            add_differences!("r1", "q1"),
            "strh {sum}, [{cost}], #2\n",
        )
    };
}

/// Adds two strips.
///
/// # Safety
/// As [`add_four_strips`].
#[inline(never)]
unsafe fn add_two_strips(strips: [&Strip<'_>; 2], curve: &mut [u16]) {
    let [a, b] = strips.map(|strip| strip.other.as_ptr());
    let [first, second] = strips.map(|strip| strip.reference.as_ptr());
    // SAFETY: the caller's; eight pixels are read from each disparity on.
    unsafe {
        asm!(
            "vldrb.u16 q0, [r2]",
            "vldrb.u16 q1, [r3]",
            "2:",
            disparity_of_two!(),
            disparity_of_two!(),
            disparity_of_two!(),
            disparity_of_two!(),
            "le lr, 2b",
            inout("r0") a => _,
            inout("r1") b => _,
            in("r2") first,
            in("r3") second,
            cost = inout(reg) curve.as_mut_ptr() => _,
            inout("lr") curve.len() / 4 => _,
            sum = out(reg) _,
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            out("d8") _, out("d9") _,
            options(nostack),
        );
    }
}

/// A disparity of one strip.
macro_rules! disparity_of_one {
    () => {
        concat!(
            "ldrh {sum}, [{cost}]\n",
            add_differences!("r0", "q0"),
            "strh {sum}, [{cost}], #2\n",
        )
    };
}

/// Adds one strip.
///
/// # Safety
/// As [`add_four_strips`].
#[inline(never)]
unsafe fn add_strip(strip: &Strip<'_>, curve: &mut [u16]) {
    // SAFETY: the caller's; eight pixels are read from each disparity on.
    unsafe {
        asm!(
            "vldrb.u16 q0, [r1]",
            "2:",
            disparity_of_one!(),
            disparity_of_one!(),
            disparity_of_one!(),
            disparity_of_one!(),
            "le lr, 2b",
            inout("r0") strip.other.as_ptr() => _,
            in("r1") strip.reference.as_ptr(),
            cost = inout(reg) curve.as_mut_ptr() => _,
            inout("lr") curve.len() / 4 => _,
            sum = out(reg) _,
            out("d0") _, out("d1") _, out("d8") _, out("d9") _,
            options(nostack),
        );
    }
}

/// See [`portable::lowest`](super::super::portable::lowest).
pub fn lowest(curve: &[u16]) -> u16 {
    let Some(last) = curve.last_chunk::<ENTRIES>() else { return dsp::lowest(curve) };
    let mut low = u32::from(u16::MAX);
    // SAFETY: there are so many vectors; the last one holds the rest, and some of those before it
    // again.
    unsafe {
        asm!(
            "vldrh.u16 q0, [{last}]",
            "2:",
            "vminv.u16 {low}, q0",
            "vldrh.u16 q0, [{at}], #16",
            "le lr, 2b",
            "vminv.u16 {low}, q0",
            at = inout(reg) curve.as_ptr() => _,
            last = in(reg) last.as_ptr(),
            inout("lr") curve.len() / ENTRIES => _,
            low = inout(reg) low,
            out("d0") _, out("d1") _,
            options(readonly, nostack),
        );
    }
    low as u16
}
