//! Products of gradients along two rows, at several lags.
//!
//! In: pixels of both rows. Out: sums of products at several lags.
//!
//! ```text
//! gradients  four a round, two in each word; as they are, and limited
//! products   two an instruction; all lags are even, so that pairs meet pairs
//! ```
//!
//! # Cost
//! 400 instructions under QEMU with the call.
//!
//! # Source
//! See [`super`].

use super::super::portable::{GRADIENTS, LAGS, Products, RIGHT_GRADIENTS, WEAK};

/// Products of both half words, added to `sum`.
#[inline(always)]
fn multiply_add(sum: i32, (a, b): (&u32, &u32)) -> i32 {
    let result: i32;
    // SAFETY: registers alone, and the flag of an overflow.
    unsafe {
        asm!("smlad {r}, {a}, {b}, {sum}", r = lateout(reg) result, a = in(reg) *a, b = in(reg) *b, sum = in(reg) sum,
            options(pure, nomem, nostack));
    }
    result
}

/// See [`portable::add_products`](super::super::portable::add_products).
pub fn add_products(
    left: &[u8; GRADIENTS + 2],
    right: &[u8; RIGHT_GRADIENTS + 2],
    sums: &mut [Products; 2],
) {
    let mut of_left = [[0; GRADIENTS / 2]; 2];
    let mut of_right = [[0; RIGHT_GRADIENTS / 2]; 2];
    // SAFETY: each has two pixels more than gradients, and memory for all of them twice.
    unsafe {
        gradients(left.as_ptr(), of_left.as_mut_ptr().cast(), GRADIENTS / 4);
        gradients(right.as_ptr(), of_right.as_mut_ptr().cast(), RIGHT_GRADIENTS / 4);
    }
    for ((sums, left), right) in sums.iter_mut().zip(&of_left).zip(&of_right) {
        multiply(left, right, sums);
    }
}

/// Gradients of four pixels each, `rounds` times: as they are, and behind all of these limited to
/// [`WEAK`].
///
/// # Safety
/// There is a round at least; `4 * rounds + 2` pixels can be read, and `4 * rounds` words written.
#[inline(never)]
unsafe fn gradients(pixels: *const u8, out: *mut u32, rounds: usize) {
    // SAFETY: the caller's.
    unsafe {
        asm!(
            "2:",
            "ldr {b}, [{pixels}, #2]",
            "ldr {a}, [{pixels}], #4",
            "uxtb16 {d}, {b}",
            "uxtb16 {c}, {a}",
            "ssub16 {c}, {d}, {c}", // the first and third
            "uxtb16 {b}, {b}, ror #8",
            "uxtb16 {a}, {a}, ror #8",
            "ssub16 {b}, {b}, {a}", // the second and fourth
            "pkhbt {a}, {c}, {b}, lsl #16",
            "pkhtb {b}, {b}, {c}, asr #16",
            "strd {a}, {b}, [{raw}], #8",
            "ssub16 {c}, {most}, {a}",
            "sel {a}, {a}, {most}",
            "ssub16 {c}, {a}, {least}",
            "sel {a}, {a}, {least}",
            "ssub16 {c}, {most}, {b}",
            "sel {b}, {b}, {most}",
            "ssub16 {c}, {b}, {least}",
            "sel {b}, {b}, {least}",
            "strd {a}, {b}, [{weak}], #8",
            "subs {rounds}, {rounds}, #1",
            "bne 2b",
            pixels = inout(reg) pixels => _,
            raw = inout(reg) out => _,
            weak = inout(reg) out.add(2 * rounds) => _,
            rounds = inout(reg) rounds => _,
            a = out(reg) _, b = out(reg) _, c = out(reg) _, d = out(reg) _,
            most = in(reg) (WEAK as u32) << 16 | WEAK as u32,
            least = in(reg) (-WEAK as u32) << 16 | (-WEAK as u32 & 0xffff),
            options(nostack),
        );
    }
}

/// Adds the products of gradients, two in each word.
#[inline(never)]
fn multiply(left: &[u32; GRADIENTS / 2], right: &[u32; RIGHT_GRADIENTS / 2], sums: &mut Products) {
    let from = |lag: usize| {
        right.get(lag / 2..).and_then(<[u32]>::first_chunk).unwrap_or(&[0; GRADIENTS / 2])
    };
    let add = |sum: i32, a: &[u32; GRADIENTS / 2], b: &[u32; GRADIENTS / 2]| {
        a.iter().zip(b).fold(sum, multiply_add)
    };
    const { assert!((LAGS[0] | LAGS[1] | LAGS[2] | LAGS[3] | LAGS[4]) & 1 == 0, "pairs meet pairs") }
    // Lag by lag: a loop reads them from memory, twice as many instructions.
    let [own, a, b, c, d] = LAGS.map(from);
    let of = sums.at_lags;
    sums.at_lags = [
        add(of[0], left, own),
        add(of[1], left, a),
        add(of[2], left, b),
        add(of[3], left, c),
        add(of[4], left, d),
    ];
    sums.energy = add(add(sums.energy, left, left), own, own);
}
