//! Pixels between pixels.
//!
//! In: two rows, positions on a line between them. Out: a grey level each.
//!
//! ```text
//! two pixels of either row -> left ones in one word, right ones in another
//! both + (right - left) * fraction, in one multiplication: a row in each half of the word
//! SMLAD weighs both rows and rounds; USAT holds the column inside
//! ```
//!
//! # Bounds
//! The halves of a packed word hold 255 * 2^7 at most; what the lower half borrows for a negative difference comes back with the sum, which
//! is none.
//!
//! # Cost
//! Instructions under QEMU: 16.5 a pixel; for each run 8 to check it and 18 to start it.
//!
//! # Source
//! See [`super`].

use super::super::portable::{self, Run};
use core::arch::asm;

/// See [`portable::bilinear_runs`].
pub fn bilinear_runs(rows: &[u8], width: usize, runs: &[Run], out: &mut [u8]) {
    let columns = portable::columns(width.min(1 << 15));
    let (mut total, mut last_start, mut none_empty) = (0_u32, 0, true);
    for run in runs {
        last_start = run.top.max(run.bottom).max(last_start);
        total = total.saturating_add(run.length);
        none_empty &= run.length != 0;
    }
    let is_held = rows.len().checked_sub(columns + 1).is_some_and(|last| last_start as usize <= last);
    let is_known = columns <= 4096 && is_held;
    if !(is_known && none_empty && total > 0 && total as usize <= out.len()) {
        return portable::bilinear_runs(rows, width, runs, out);
    }
    let (rows, out) = (rows.as_ptr(), out.as_mut_ptr());
    // SAFETY: every run has a pixel, and together they have no more than `out`. From each start on there are as many bytes in `rows` as
    // there are columns, and one more.
    unsafe {
        match columns {
            256 => pixels::<8>(rows, runs, out),
            512 => pixels::<9>(rows, runs, out),
            1024 => pixels::<10>(rows, runs, out),
            2048 => pixels::<11>(rows, runs, out),
            _ => pixels::<12>(rows, runs, out),
        }
    }
}

/// One pixel: sixteen instructions. Column (r4), its step (r5) and the weights (r8) move on; r0, r1 and r11 are free.
macro_rules! pixel {
    () => {
        "usat r0, #{bits}, r4, asr #16
        ldrh r1, [r3, r0]
        ldrh r0, [r2, r0]
        ubfx r11, r4, #9, #7
        add r4, r4, r5
        add r5, r5, r6
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
/// There is a run, and every one has a pixel. From both starts of every run on, 2^`BITS` bytes and one more can be read, and as many bytes
/// written as all runs have pixels.
#[inline(never)]
unsafe fn pixels<const BITS: usize>(rows: *const u8, runs: &[Run], out: *mut u8) {
    // SAFETY: the caller's: USAT holds a column between 0 and 2^BITS - 1. The end of the list, and while a run lasts the list and the rows,
    // are on the stack, below what is kept of the two registers that cannot be named.
    unsafe {
        asm!(
            "push {{r6, r7}}",
            "push {{r2}}",
            "2:",
            "ldmia r0!, {{r2, r3, r4, r5, r6, r8, r9, r10}}",
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
            "pop {{r6, r7}}",
            bits = const BITS,
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
