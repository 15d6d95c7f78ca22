//! Kernels for cores with Arm's DSP extension: bilinear interpolation between the pixels of two
//! rows, weighted sums of knots.
//!
//! In and out as the [`portable`] versions, the same bits for every input: they do what a loop here
//! cannot.
//!
//! ```text
//! two pixels of either row -> left ones in one word, right ones in another
//! both + (right - left) * fraction, in one multiplication: a row in each half of the word
//! SMLAD weighs both rows and rounds; USAT clamps the column
//! ```
//!
//! # Bounds
//! The halves of a packed word hold 255 * 2^7 at most; what the lower half borrows for a negative
//! difference returns with the sum, which is not negative. Words are read and written at any
//! address, as by the core's kernels for these cores.
//!
//! # Cost
//! Instructions under QEMU: 16.5 a pixel. Runs: 8 to check one and 18 to start it. Cells: 28 for
//! each, 42 for each of its parts that lies between the same two rows, 12 where they change.
//!
//! # Source
//! Armv7-M Architecture Reference Manual, A7.7: SMLAD, SMMLA, SMMUL, USAT, UXTB16.

use super::portable::{self, Knot, Ring, Run};

/// `asm!` for a processor with the extension, also where the crate is compiled for Armv8-M without
/// one by name.
#[cfg(armv8m)]
macro_rules! asm {
    ($($arguments:tt)*) => { core::arch::asm!(".cpu cortex-m33", $($arguments)*) };
}
#[cfg(not(armv8m))]
use core::arch::asm;

/// See [`portable::bilinear_runs`].
#[inline]
pub fn bilinear_runs(rows: &[u8], width: usize, runs: &[Run], out: &mut [u8]) {
    let columns = portable::columns(width.min(1 << 15));
    let (mut total, mut last_start, mut none_empty) = (0_u32, 0, true);
    for run in runs {
        last_start = run.top.max(run.bottom).max(last_start);
        total = total.saturating_add(run.length);
        none_empty &= run.length != 0;
    }
    let is_held =
        rows.len().checked_sub(columns + 1).is_some_and(|last| last_start as usize <= last);
    let is_known = columns <= 4096 && is_held;
    if !(is_known && none_empty && total > 0 && total as usize <= out.len()) {
        return portable::bilinear_runs(rows, width, runs, out);
    }
    let (rows, out) = (rows.as_ptr(), out.as_mut_ptr());
    // SAFETY: every run has a pixel, and together they have no more than `out`. From each start on
    // there are as many bytes in `rows` as there are columns, and one more.
    unsafe {
        match columns {
            512 => pixels::<9>(rows, runs, out),
            1024 => pixels::<10>(rows, runs, out),
            _ => pixels::<12>(rows, runs, out),
        }
    }
}

/// One pixel: sixteen instructions. Column (r4), its step (r5) and the weights (r8) move on; r0, r1
/// and r11 are free.
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

/// The pixels of a run, r10 of them and at least one: four at a time, then one, then two.
macro_rules! pixels_of_run {
    () => {
        concat!(
            "subs r10, #4\nblo 6f\n5:\n",
            pixel!(),
            "\n",
            pixel!(),
            "\n",
            pixel!(),
            "\n",
            pixel!(),
            "\nsubs r10, #4\nbhs 5b\n6:\nlsls r0, r10, #31\nbeq 7f\n",
            pixel!(),
            "\n7:\nlsls r0, r10, #30\nbpl 8f\n",
            pixel!(),
            "\n",
            pixel!(),
            "\n8:"
        )
    };
}

/// # Safety
/// There is a run, and every one has a pixel. From both starts of every run on, 2^`BITS` bytes and
/// one more can be read, and as many bytes written as all runs have pixels.
#[inline(never)]
unsafe fn pixels<const BITS: usize>(rows: *const u8, runs: &[Run], out: *mut u8) {
    // SAFETY: the caller's: USAT clamps a column to 0 ..= 2^BITS - 1. The end of the list, and
    // while a run lasts the list and the rows, are on the stack, below what is kept of the two
    // registers that cannot be named.
    unsafe {
        asm!(
            "push {{r6, r7}}",
            "push {{r2}}",
            "2:",
            "ldmia r0!, {{r2, r3, r4, r5, r6, r8, r9, r10}}",
            "push {{r0, r1}}",
            "add r2, r2, r1",
            "add r3, r3, r1",
            // The weight of the upper row below, that of the lower one above; both move in one
            // addition.
            "movw r11, #0xffff",
            "mov r0, #0x4000",
            "mla r8, r8, r11, r0",
            "mul r9, r9, r11",
            pixels_of_run!(),
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
            out("r3") _, out("r4") _, out("r5") _, out("r8") _, out("r9") _, out("r10") _,
            out("r11") _,
            inout("r12") 1 << 20 => _,
            inout("lr") out => _,
        );
    }
}

/// Progress in a row of cells.
#[repr(C)]
struct Cells {
    knots: *const Knot,
    /// Number of remaining pixels, without those of the current cell.
    pixels: u32,
    bytes: *const u8,
    width: u32,
    rows: u32,
    first: i32,
    /// Rest of the current cell: row and its step, px in Q14, and number of pixels.
    y: i32,
    dy: i32,
    rest: u32,
}

/// See [`portable::bilinear_cells`].
#[inline]
pub fn bilinear_cells(ring: Ring<'_>, knots: &[Knot], out: &mut [u8]) {
    let Ring { bytes, width, rows, first } = ring;
    let columns = portable::columns(width.min(1 << 15));
    let last_start = rows.checked_sub(1).and_then(|last| (last as usize).checked_mul(width));
    let needed = last_start.and_then(|start| start.checked_add(columns + 1));
    let is_held = needed.is_some_and(|needed| needed <= bytes.len());
    let pixels = out.len().min(knots.len().saturating_sub(3).saturating_mul(portable::CELL));
    if !(columns <= 4096 && is_held && pixels > 0) {
        return portable::bilinear_cells(ring, knots, out);
    }
    let (bytes, width, knots) = (bytes.as_ptr(), width as u32, knots.as_ptr());
    let mut cells =
        Cells { knots, pixels: pixels as u32, bytes, width, rows, first, y: 0, dy: 0, rest: 0 };
    let (cells, out) = (&mut cells, out.as_mut_ptr());
    // SAFETY: there is a pixel; there are no more than `out` has, and for each 16 begun four knots.
    // From the start of each row of the ring on there are as many bytes as there are columns, and
    // one more.
    unsafe {
        match columns {
            512 => paint_cells::<9>(cells, out),
            1024 => paint_cells::<10>(cells, out),
            _ => paint_cells::<12>(cells, out),
        }
    }
}

/// The next cell: second difference (r6), first step (r5) and start (r4) of the columns, start (r8)
/// and step (r9) of the rows, and its pixels (r10), which are taken from those that are left.
macro_rules! next_cell {
    () => {
        "ldr r0, [r7]
        ldm r0, {{r1, r2, r3, r4, r5, r6, r8}}
        add r0, #8
        str r0, [r7]
        sub r1, r1, r3
        sub r8, r8, r5
        add r1, r1, r8
        asr r8, r4, #2
        rsb r9, r8, r6, asr #2
        asr r9, r9, #4
        asr r6, r1, #9
        sub r5, r5, r3
        sub r5, r5, r6, lsl #7
        add r5, r5, r6, lsl #3
        asr r5, r5, #4
        add r4, r3, #256
        ldr r0, [r7, #4]
        mov r10, #16
        cmp r0, #16
        it lo
        movlo r10, r0
        sub r0, r0, r10
        str r0, [r7, #4]"
    };
}

/// Starts of the raw row that a position lies in (r2) and of the next one (r3), in the ring.
macro_rules! ring_rows {
    () => {
        "asr r0, r8, #14
        ldrd r1, r2, [r7, #16]
        subs r0, r0, r2
        it mi
        addmi r0, r0, r1
        cmp r0, r1
        it hs
        movhs r0, #0
        ldrd r3, r11, [r7, #8]
        mla r2, r0, r11, r3
        add r0, r0, #1
        cmp r0, r1
        it eq
        moveq r0, #0
        mla r3, r0, r11, r3"
    };
}

/// Leaves in r10 the pixels before the raw row changes; the rest (r11, perhaps none) and where it
/// starts are for later.
macro_rules! split_at_next_row {
    () => {
        "sub r0, r10, #1
        mla r0, r9, r0, r8
        eor r0, r0, r8
        ubfx r1, r8, #0, #14
        mov r11, #0
        asrs r0, r0, #14
        beq 4f
        asr r0, r9, #31
        eor r11, r9, r0
        sub r11, r11, r0
        mvn r0, r0
        ubfx r0, r0, #0, #14
        eor r0, r0, r1
        udiv r0, r0, r11
        add r0, r0, #1
        mla r8, r9, r0, r8
        strd r8, r9, [r7, #24]
        sub r11, r10, r0
        mov r10, r0"
    };
}

/// # Safety
/// There is a pixel, and a row. `out` has room for all pixels, there are knots for all of them, and
/// from the start of every row on 2^`BITS` bytes and one more can be read.
#[inline(never)]
unsafe fn paint_cells<const BITS: usize>(cells: &mut Cells, out: *mut u8) {
    // SAFETY: the caller's: USAT clamps a column to 0 ..= 2^BITS - 1, and a row that is not held is
    // the first one. The two registers that cannot be named are kept on the stack.
    unsafe {
        asm!(
            "push {{r6, r7}}",
            "mov r7, r0",
            "2:",
            next_cell!(),
            "3:",
            ring_rows!(),
            split_at_next_row!(),
            "4:",
            "str r11, [r7, #32]",
            // The weight of the upper row below, that of the lower one above; both move in one
            // addition.
            "rsb r8, r1, r1, lsl #16",
            "add r8, r8, #0x4000",
            "rsb r9, r9, r9, lsl #16",
            pixels_of_run!(),
            "ldr r10, [r7, #32]",
            "cmp r10, #0",
            "beq 9f",
            "ldrd r8, r9, [r7, #24]",
            "b 3b",
            "9:",
            "ldr r0, [r7, #4]",
            "cmp r0, #0",
            "bne 2b",
            "pop {{r6, r7}}",
            bits = const BITS,
            inout("r0") cells => _,
            out("r1") _, out("r2") _, out("r3") _, out("r4") _, out("r5") _, out("r8") _,
            out("r9") _, out("r10") _, out("r11") _,
            inout("r12") 1 << 20 => _,
            inout("lr") out => _,
        );
    }
}

/// See [`portable::weigh_knots`].
#[inline]
pub fn weigh_knots(rows: [&[Knot]; 4], weights: [i32; 4], out: &mut [Knot]) {
    let [a, b, c, d] = rows;
    let count = a.len().min(b.len()).min(c.len()).min(d.len()).min(out.len());
    if count == 0 {
        return;
    }
    // SAFETY: all slices have `count` knots, which is not 0.
    unsafe { weigh(rows.map(<[_]>::as_ptr), &weights, out.as_mut_ptr(), count) }
}

/// # Safety
/// `count` is not 0; there are as many knots in each row, and room for them in `out`.
#[inline(never)]
unsafe fn weigh(rows: [*const Knot; 4], weights: &[i32; 4], out: *mut Knot, count: usize) {
    // SAFETY: the caller's. The register that cannot be named is kept on the stack.
    unsafe {
        asm!(
            "push {{r6}}",
            "ldm r5, {{r5, r6, r8, r9}}",
            "2:",
            "ldrd r10, r12, [r0], #8",
            "smmul r10, r10, r5",
            "smmul r11, r12, r5",
            "ldr r12, [r1], #4",
            "smmla r10, r12, r6, r10",
            "ldr r12, [r1], #4",
            "smmla r11, r12, r6, r11",
            "ldr r12, [r2], #4",
            "smmla r10, r12, r8, r10",
            "ldr r12, [r2], #4",
            "smmla r11, r12, r8, r11",
            "ldr r12, [r3], #4",
            "smmla r10, r12, r9, r10",
            "ldr r12, [r3], #4",
            "smmla r11, r12, r9, r11",
            "mov r12, #8",
            "add r10, r12, r10, lsl #2",
            "add r11, r12, r11, lsl #2",
            "strd r10, r11, [r4], #8",
            "subs lr, lr, #1",
            "bne 2b",
            "pop {{r6}}",
            inout("r0") rows[0] => _,
            inout("r1") rows[1] => _,
            inout("r2") rows[2] => _,
            inout("r3") rows[3] => _,
            inout("r4") out => _,
            inout("r5") weights.as_ptr() => _,
            out("r8") _, out("r9") _, out("r10") _, out("r11") _, out("r12") _,
            inout("lr") count => _,
        );
    }
}
