//! Pixels between pixels.
//!
//! In: two rows, positions on a line between them. Out: a grey level each.
//!
//! ```text
//! two pixels of either row -> left ones in one word, right ones in another
//! both + (right - left) * fraction, in one multiplication: a row in each half of the word
//! SMLAD weighs both rows and rounds
//! ```
//!
//! # Bounds
//! The halves of a packed word hold 255 * 2^7 at most; what the lower half borrows for a negative difference comes back with the sum, which
//! is none.
//!
//! # Cost
//! Instructions under QEMU: 15.5 a pixel; for each run 55 to check it and 18 to start it.
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, Run};
use core::arch::asm;

/// One less than the longest run that is done here.
const LONGEST: i32 = 1023;
/// One row, Q14.
const ONE: i32 = 1 << 14;

/// See [`portable::bilinear_runs`].
pub fn bilinear_runs(rows: &[u8], width: usize, runs: &[Run], out: &mut [u8]) {
    let last_start = rows.len().checked_sub(width).and_then(|last| i32::try_from(last).ok());
    let Some(last_start) = last_start.filter(|_| (2..=4096).contains(&width)) else {
        return portable::bilinear_runs(rows, width, runs, out);
    };
    // Below 2^28.
    let end = (width as i32 - 1) << 16;
    // A check holds if its number is not negative: all of them are gathered in the sign of one.
    let (mut signs, mut total) = (0, 0_u32);
    for &Run { top, bottom, x_q16, dx_q16, fy_q14, dfy_q14, length } in runs {
        let steps = (length as i32).wrapping_sub(1);
        let last_x = i64::from(x_q16) + i64::from(dx_q16) * i64::from(steps);
        let last_fy = i64::from(fy_q14) + i64::from(dfy_q14) * i64::from(steps);
        // Both words of a sum in 64 bits: the upper one is 0, or the sum is negative or too large.
        let (low_x, low_fy) = (last_x as i32, last_fy as i32);
        let upper = (last_x >> 32) as i32 | (last_fy >> 32) as i32;
        signs |= upper | upper.wrapping_neg() | steps | LONGEST.wrapping_sub(steps) | top as i32 | bottom as i32;
        signs |= last_start.wrapping_sub(top as i32) | last_start.wrapping_sub(bottom as i32);
        signs |= x_q16 | low_x | (end - 1).wrapping_sub(x_q16) | (end - 1).wrapping_sub(low_x);
        signs |= fy_q14 | low_fy | ONE.wrapping_sub(fy_q14) | ONE.wrapping_sub(low_fy);
        total = length.wrapping_add(total);
    }
    if signs < 0 || total == 0 || total as usize > out.len() {
        return portable::bilinear_runs(rows, width, runs, out);
    }
    // SAFETY: every run has a pixel, and together they have no more than `out`. `width` bytes from `top` and `bottom` on are in `rows`.
    // Positions move evenly, and the last one was computed without loss: all of a run lie between its first and its last one, in columns
    // from 0 to before the last one of a row. `length` is at most 1024, so no two errors of `total` make up for each other.
    unsafe { pixels(rows.as_ptr(), runs, out.as_mut_ptr()) }
}

/// One pixel: fifteen instructions. Position (r4) and weights (r8) move on; r0, r1 and r11 are free.
macro_rules! pixel {
    () => {
        "asr r0, r4, #16
        ldrh r1, [r3, r0]
        ldrh r0, [r2, r0]
        ubfx r11, r4, #9, #7
        add r4, r4, r5
        orr r0, r0, r1, lsl #16
        uxtb16 r1, r0
        uxtb16 r0, r0, ror #8
        sub r0, r0, r1
        lsl r1, r1, #7
        mla r0, r0, r11, r1
        smlad r0, r0, r8, r12
        add r8, r8, r9
        lsr r0, r0, #21
        strb r0, [lr], #1"
    };
}

/// # Safety
/// There is a run, and every one has a pixel. Two bytes can be read from each pixel's column on in both rows of its run, and as many bytes
/// written as all runs have pixels.
unsafe fn pixels(rows: *const u8, runs: &[Run], out: *mut u8) {
    // SAFETY: the caller's. The end of the list, and while a run lasts the list and the rows, are on the stack.
    unsafe {
        asm!(
            "push {{r2}}",
            "2:",
            "ldmia r0!, {{r2, r3, r4, r5, r8, r9, r10}}",
            "push {{r0, r1}}",
            "add r2, r2, r1",
            "add r3, r3, r1",
            // The weight of the upper row below, that of the lower one above; both move in one addition.
            "movw r11, #0xffff",
            "mov r0, #0x4000",
            "mla r8, r8, r11, r0",
            "mul r9, r9, r11",
            "subs r10, #4",
            "blo 4f",
            "3:",
            pixel!(),
            pixel!(),
            pixel!(),
            pixel!(),
            "subs r10, #4",
            "bhs 3b",
            "4:",
            "lsls r0, r10, #31",
            "beq 5f",
            pixel!(),
            "5:",
            "lsls r0, r10, #30",
            "bpl 6f",
            pixel!(),
            pixel!(),
            "6:",
            "pop {{r0, r1}}",
            "ldr r2, [sp]",
            "cmp r0, r2",
            "bne 2b",
            "add sp, #4",
            inout("r0") runs.as_ptr() => _,
            inout("r1") rows => _,
            inout("r2") runs.as_ptr_range().end => _,
            out("r3") _,
            out("r4") _,
            out("r5") _,
            out("r8") _,
            out("r9") _,
            out("r10") _,
            out("r11") _,
            inout("r12") 1 << 20 => _,
            inout("lr") out => _,
        );
    }
}
