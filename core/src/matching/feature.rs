//! Directed feature matching: the edge with the same properties in the right image, at the
//! disparity of the window.
//!
//! In: the line of a left segment, the disparity of its window, the band of rows. Out: the
//! disparity by the edge itself, sub-pixel. Evidence, not a requirement: an edge between two
//! surfaces may have another gradient in the right image.
//!
//! A strip narrower than a side's window is a requirement: what the window matches may lie behind
//! it. Both edges of the strip are in the right image, as far apart, or the side does not have the
//! disparity.
//!
//! # Cost
//! Some 130 instructions a row, at most [`FEATURE_ROWS`] a segment; as many for each side that is
//! tested for a strip.

use super::band::{Band, SampledRows};
use crate::kernel::{FLAT, STRIP};
use crate::lines::Line;
use crate::units::quotient;

/// Most rows of the band that are evaluated.
const FEATURE_ROWS: i32 = 4;
/// Search range on both sides of the expected column, px.
const FEATURE_REACH: usize = 2;

/// Disparity, 1/64 px, mean of the rows, of the edge in the right image that corresponds to the
/// left one: within [`FEATURE_REACH`] of `disparity`, with the same sign and at least half of the
/// gradient, in at least half of the rows. `None` where there is none.
pub(crate) fn find(line: &Line, rising: bool, disparity: i32, band: &Band<'_>) -> Option<i32> {
    let rows = SampledRows::new(line.extent(), FEATURE_ROWS);
    let sign = |gradient: u8| {
        let gradient = i32::from(gradient) - i32::from(FLAT);
        if rising { gradient } else { -gradient }
    };
    let (mut sum_q6, mut found) = (0, 0);
    for y in rows {
        // The strip's middle is the edge; the expected edge of the other row lies in the middle of
        // the search range.
        let x = line.at(y);
        let Some(strip) = band.strip(x - 4, y, disparity - FEATURE_REACH as i32) else { continue };
        let [_, _, _, left, ..] = strip.reference;
        let Some(near) = strip.other.get(2..).and_then(|other| other.first_chunk::<7>()) else {
            continue;
        };
        let near = near.map(sign);
        let mut best = (0, 0, 0);
        for (window, index) in near.windows(3).zip(0..) {
            if let &[before, here, after] = window
                && here > best.0
            {
                // A parabola through three gradients.
                let shift_q6 =
                    quotient((after - before) << 5, 2 * here - before - after).clamp(-32, 32);
                best = (here, index, shift_q6);
            }
        }
        let (gradient, index, shift_q6) = best;
        if gradient > 2 && 2 * gradient >= sign(left) {
            let off_q6 = ((index - FEATURE_REACH as i32) << 6) + shift_q6;
            // Distance of the left edge's line from its whole column.
            let own_q6 = (line.at_q5(y << 5) << 1) - (x << 6);
            sum_q6 += own_q6 + off_q6;
            found += 1;
        }
    }
    (2 * found >= rows.count() && found > 0).then(|| (disparity << 6) + quotient(sum_q6, found))
}

/// Distances from the edge at which a strip may end, px: nearer the gradient of the edge itself
/// reaches, farther a window shows the strip alone.
const STRIP_ENDS: core::ops::Range<usize> = 2..6;

/// True when a strip begins at the edge on this side (`sign` -1 or 1) whose other edge is missing
/// in the right image at the disparities `line_q6` of the first and the last row, 1/64 px: an edge
/// of the other sign with a third of the gradient in the left image, but not half of that in the
/// right.
pub(crate) fn lacks_other_edge(
    line: &Line,
    rising: bool,
    sign: i32,
    line_q6: [i32; 2],
    band: &Band<'_>,
) -> bool {
    let other_sign = |gradient: u8| {
        let gradient = i32::from(gradient) - i32::from(FLAT);
        if rising { -gradient } else { gradient }
    };
    let (first, last) = line.extent();
    let [from_q6, to_q6] = line_q6;
    let mut own = 0;
    // At each distance: left, and right at one disparity less, the same, one more.
    let mut ends = [[0; 4]; STRIP_ENDS.end];
    for y in SampledRows::new((first, last), FEATURE_ROWS) {
        let x = line.at(y);
        let d_q6 = from_q6 + quotient((to_q6 - from_q6) * (y - first), last - first);
        let start = if sign < 0 { x - STRIP as i32 + 1 } else { x };
        let Some(strip) = band.strip(start, y, ((d_q6 + 32) >> 6) - 1) else { continue };
        // Strips are mirrored: the edge is their last pixel on the right side, their first on the
        // left one.
        let place = |distance: usize| if sign < 0 { distance } else { STRIP - 1 - distance };
        own -= strip.reference.get(place(0)).map_or(0, |&gradient| other_sign(gradient));
        for (distance, [left, right @ ..]) in ends.iter_mut().enumerate().skip(STRIP_ENDS.start) {
            let at = place(distance);
            *left += strip.reference.get(at).map_or(0, |&gradient| other_sign(gradient));
            for (sum, &gradient) in right.iter_mut().zip(strip.other.get(at..).unwrap_or(&[])) {
                *sum += other_sign(gradient);
            }
        }
    }
    let strongest = ends.iter().max_by_key(|[left, ..]| *left);
    strongest.is_some_and(|&[left, a, b, c]| 3 * left > own.max(1) && 2 * a.max(b).max(c) < left)
}
