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
//! # Source
//! See [`super`].

use super::super::portable::{self, Run};
use core::arch::asm;

/// Longest run that is done here.
const LONGEST: u32 = 1024;

/// See [`portable::bilinear_runs`].
pub fn bilinear_runs(rows: &[u8], width: usize, runs: &[Run], out: &mut [u8]) {
    let Some(last_start) = rows.len().checked_sub(width).filter(|_| (2..=4096).contains(&width)) else {
        return portable::bilinear_runs(rows, width, runs, out);
    };
    // Below 2^28.
    let end = (width as u32 - 1) << 16;
    let mut total = 0;
    for &Run { top, bottom, x_q16, dx_q16, fy_q14, dfy_q14, length } in runs {
        let steps = length.wrapping_sub(1);
        let last_x = x_q16.wrapping_add(dx_q16.wrapping_mul(steps as i32)) as u32;
        let last_fy = fy_q14.wrapping_add(dfy_q14.wrapping_mul(steps as i32)) as u32;
        let is_short = steps < LONGEST && dx_q16.unsigned_abs() < 1 << 20 && dfy_q14.unsigned_abs() <= 1 << 14;
        let is_between = (x_q16 as u32).max(last_x) < end && (fy_q14 as u32).max(last_fy) <= 1 << 14;
        if !(is_short && is_between && top.max(bottom) as usize <= last_start) {
            return portable::bilinear_runs(rows, width, runs, out);
        }
        total += length as usize;
    }
    if total == 0 || total > out.len() {
        return portable::bilinear_runs(rows, width, runs, out);
    }
    // SAFETY: every run has a pixel, and together they have no more than `out`. `width` bytes from `top` and `bottom` on are in `rows`.
    // Positions move evenly and neither product above can wrap (2^20 * 2^10 + 2^28 < 2^31), so all of a run lie between its first and its
    // last one: in columns from 0 to before the last one.
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
