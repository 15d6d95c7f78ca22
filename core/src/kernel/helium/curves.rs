//! Curves of costs over disparity.
//!
//! In: eight pixels, and the row in which they are searched. Out: sums per disparity.
//!
//! ```text
//! sad   eight pixels are widened to a vector; four strips a pass
//! ```
//!
//! # Cost
//! 12 strips over 64 disparities: 2323 (4091).
//!
//! # Source
//! See [`super`].

use super::super::portable::{LANES, STRIP, Strip};

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
            if let [Some(a), Some(b), Some(c), Some(d)] = four {
                add_four_strips([a, b, c, d], whole);
            } else {
                return four.into_iter().flatten().for_each(|strip| add_strip(strip, whole));
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
            "subs {rounds}, {rounds}, #1",
            "bne 2b",
            inout("r0") a => _,
            inout("r1") b => _,
            inout("r2") c => _,
            inout("r3") d => _,
            in("r4") references.as_ptr(),
            cost = inout(reg) curve.as_mut_ptr() => _,
            rounds = inout(reg) curve.len() / 4 => _,
            sum = out(reg) _,
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            out("d4") _, out("d5") _, out("d6") _, out("d7") _,
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
            "subs {rounds}, {rounds}, #1",
            "bne 2b",
            inout("r0") strip.other.as_ptr() => _,
            in("r1") strip.reference.as_ptr(),
            cost = inout(reg) curve.as_mut_ptr() => _,
            rounds = inout(reg) curve.len() / 4 => _,
            sum = out(reg) _,
            out("d0") _, out("d1") _, out("d8") _, out("d9") _,
            options(nostack),
        );
    }
}
