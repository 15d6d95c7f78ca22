//! Rows of gradients, census codes and steps, sixteen pixels at a time.
//!
//! In: the rows around one row of an image, or two rows. Out: a byte for each of its pixels.
//!
//! ```text
//! gradient  mean of three rows, halving twice; the difference two columns apart saturates at the
//!           clip from either side
//! census    half the difference to the centre is negative where the neighbour is darker: its
//!           highest bit is shifted into its place
//! steps     as gradients
//! ```
//!
//! # Cost
//! A row of 320 pixels: gradient 413 (1298), census 576 (2657), steps 239 (941).
//!
//! # Source
//! See [`super`].

use super::super::dsp;
use super::super::portable::FLAT;
use super::VECTOR;

/// See [`portable::gradient_row`](super::super::portable::gradient_row).
pub fn gradient_row(above: &[u8], row: &[u8], below: &[u8], out: &mut [u8]) {
    let width = row.len();
    if width < VECTOR + 2 || above.len() < width || below.len() < width || out.len() != width {
        return dsp::gradient_row(above, row, below, out);
    }
    let (rows, to) = ([above, row, below].map(<[u8]>::as_ptr), out.as_mut_ptr());
    let last = width - 2 - VECTOR;
    // SAFETY: all four slices hold at least `width` bytes. From a first column x on, at most
    // `last`, the rows are read up to x + 2 + 16 <= width, and x + 1 to x + 16 are written.
    unsafe {
        gradient_vectors(rows, to.add(1), (width - 2) / VECTOR);
        if !(width - 2).is_multiple_of(VECTOR) {
            // The last pixels, some of them twice.
            gradient_vectors(rows.map(|row| row.add(last)), to.add(1 + last), 1);
        }
    }
    for edge in [0, width - 1] {
        if let Some(edge) = out.get_mut(edge) {
            *edge = FLAT;
        }
    }
}

/// Sixteen gradients at a time, `count` times, at least once.
///
/// # Safety
/// `16 * count + 2` bytes can be read from each row, `16 * count` written.
#[inline(always)]
unsafe fn gradient_vectors(rows: [*const u8; 3], out: *mut u8, count: usize) {
    let [above, row, below] = rows;
    // SAFETY: the caller's.
    unsafe {
        asm!(
            "2:",
            "vldrb.u8 q1, [{above}, #2]",
            "vldrb.u8 q0, [{above}], #16",
            "vldrb.u8 q3, [{below}, #2]",
            "vldrb.u8 q2, [{below}], #16",
            "vhadd.u8 q1, q1, q3",
            "vldrb.u8 q3, [{row}, #2]",
            "vhadd.u8 q0, q0, q2",
            "vldrb.u8 q2, [{row}], #16",
            "vhadd.u8 q1, q1, q3",
            "vhadd.u8 q0, q0, q2",
            "vqsub.u8 q2, q1, q0",
            "vqsub.u8 q3, q0, q1",
            "vqadd.u8 q2, q2, {clip}",
            "vqadd.u8 q3, q3, {clip}",
            "vsub.i8 q2, q2, q3",
            "vadd.i8 q2, q2, {flat}",
            "vstrb.u8 q2, [{out}], #16",
            "le lr, 2b",
            above = inout(reg) above => _,
            row = inout(reg) row => _,
            below = inout(reg) below => _,
            out = inout(reg) out => _,
            inout("lr") count => _,
            clip = in(reg) 255_u32 - 31, // saturates when more than 31 is added
            flat = in(reg) u32::from(FLAT),
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            out("d4") _, out("d5") _, out("d6") _, out("d7") _,
            options(nostack),
        );
    }
}

/// See [`portable::census_row`](super::super::portable::census_row).
pub fn census_row(rows: [&[u8]; 3], out: &mut [u8]) {
    let [top, row, bottom] = rows;
    let width = row.len();
    if width < VECTOR + 4 || top.len() < width || bottom.len() < width || out.len() != width {
        return dsp::census_row(rows, out);
    }
    let (from, to) = (rows.map(<[u8]>::as_ptr), out.as_mut_ptr());
    let last = width - 4 - VECTOR;
    // SAFETY: all four slices hold at least `width` bytes. From a first column x on, at most
    // `last`, the rows are read up to x + 4 + 16 <= width, and x + 2 to x + 17 are written.
    unsafe {
        census_vectors(from, to.add(2), (width - 4) / VECTOR);
        if !(width - 4).is_multiple_of(VECTOR) {
            census_vectors(from.map(|row| row.add(last)), to.add(2 + last), 1);
        }
    }
    for range in [0..2, width - 2..width] {
        if let Some(edge) = out.get_mut(range) {
            edge.fill(0);
        }
    }
}

/// Sixteen codes at a time, `count` times, at least once.
///
/// # Safety
/// `16 * count + 4` bytes can be read from each row, `16 * count` written.
#[inline(always)]
unsafe fn census_vectors(rows: [*const u8; 3], out: *mut u8, count: usize) {
    let [top, row, bottom] = rows;
    // SAFETY: the caller's.
    unsafe {
        asm!(
            "2:",
            "vldrb.u8 q0, [{row}, #2]",
            "vldrb.u8 q1, [{bottom}, #4]",
            "vhsub.u8 q1, q1, q0",
            "vldrb.u8 q2, [{bottom}, #2]",
            "vhsub.u8 q2, q2, q0",
            "vsri.8 q1, q2, #1",
            "vldrb.u8 q2, [{bottom}], #16",
            "vhsub.u8 q2, q2, q0",
            "vsri.8 q1, q2, #2",
            "vldrb.u8 q2, [{row}, #4]",
            "vhsub.u8 q2, q2, q0",
            "vsri.8 q1, q2, #3",
            "vldrb.u8 q2, [{row}], #16",
            "vhsub.u8 q2, q2, q0",
            "vsri.8 q1, q2, #4",
            "vldrb.u8 q2, [{top}, #4]",
            "vhsub.u8 q2, q2, q0",
            "vsri.8 q1, q2, #5",
            "vldrb.u8 q2, [{top}, #2]",
            "vhsub.u8 q2, q2, q0",
            "vsri.8 q1, q2, #6",
            "vldrb.u8 q2, [{top}], #16",
            "vhsub.u8 q2, q2, q0",
            "vsri.8 q1, q2, #7",
            "vstrb.u8 q1, [{out}], #16",
            "le lr, 2b",
            top = inout(reg) top => _,
            row = inout(reg) row => _,
            bottom = inout(reg) bottom => _,
            out = inout(reg) out => _,
            inout("lr") count => _,
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            out("d4") _, out("d5") _,
            options(nostack),
        );
    }
}

/// See [`portable::limited_steps`](super::super::portable::limited_steps).
pub fn limited_steps(before: &[u8], after: &[u8], most: u8, out: &mut [u8]) {
    let length = out.len().min(before.len()).min(after.len());
    let Some(last) = length.checked_sub(VECTOR) else {
        return dsp::limited_steps(before, after, most, out);
    };
    let (before, after, out) = (before.as_ptr(), after.as_ptr(), out.as_mut_ptr());
    let most = most.min(127);
    // SAFETY: all three slices hold at least `length` bytes; the last sixteen begin at `last`.
    unsafe {
        step_vectors(before, after, most, out, length / VECTOR);
        if !length.is_multiple_of(VECTOR) {
            // The last pixels, some of them twice.
            step_vectors(before.add(last), after.add(last), most, out.add(last), 1);
        }
    }
}

/// Sixteen steps at a time, `count` times, at least once.
///
/// # Safety
/// `16 * count` bytes can be read from both rows, as many written.
#[inline(always)]
unsafe fn step_vectors(before: *const u8, after: *const u8, most: u8, out: *mut u8, count: usize) {
    // SAFETY: the caller's.
    unsafe {
        asm!(
            "2:",
            "vldrb.u8 q0, [{before}], #16",
            "vldrb.u8 q1, [{after}], #16",
            "vqsub.u8 q2, q1, q0",
            "vqsub.u8 q3, q0, q1",
            "vqadd.u8 q2, q2, {clip}",
            "vqadd.u8 q3, q3, {clip}",
            "vsub.i8 q2, q2, q3",
            "vadd.i8 q2, q2, {most}",
            "vstrb.u8 q2, [{out}], #16",
            "le lr, 2b",
            before = inout(reg) before => _,
            after = inout(reg) after => _,
            out = inout(reg) out => _,
            inout("lr") count => _,
            clip = in(reg) u32::from(u8::MAX - most), // saturates when more than `most` is added
            most = in(reg) u32::from(most),
            out("d0") _, out("d1") _, out("d2") _, out("d3") _,
            out("d4") _, out("d5") _, out("d6") _, out("d7") _,
            options(nostack),
        );
    }
}
