//! Row offset of a pair, by the near-horizontal segments of both images.
//!
//! In: the segments of both images. Out: offset to add to a left row for the matching right row, 1/32 px.
//!
//! ```text
//! for every left and right near-horizontal segment that could be the same edge: a vote for the difference of their rows
//! the offset is the largest cluster of votes within +-2 px, if it has enough of them; else 0
//! ```
//! Votes of true pairs agree, those of false ones spread evenly over the interval. No pixels are read.
//!
//! # Cost
//! Some 20 instructions a comparison of a left segment with a right one on its rows; one in [`PIXELS_A_COMPARISON`] px at most, half of them from the
//! start, the rest evenly over the left segments. Captured pairs make up to 0.7 of those, gratings had three times as many.

use crate::lines::Segment;
use crate::units::quotient;

/// Number of bins of 1/8 px, -2 ..= 2 px.
const BINS: usize = 33;
/// Largest offset, 1/32 px.
pub(crate) const LIMIT_Q5: i16 = 64;
/// Pixels of the image for each comparison.
const PIXELS_A_COMPARISON: u32 = 6;
/// Least votes in the cluster.
const MIN_VOTES: u32 = 8;

/// Row offset of the right image against the left, 1/32 px, 0 when the votes do not determine it; and the number of left segments that were not
/// compared, because an image of so many `pixels` had enough of them.
pub(crate) fn estimate(left: &[Segment], right: &[Segment], disparities: (i32, i32), pixels: u32) -> (i16, u16) {
    let limit_q5 = i32::from(LIMIT_Q5);
    let mut votes = [0_u32; BINS];
    let flat = || left.iter().filter(|s| s.near_horizontal);
    let half = i32::try_from(pixels / PIXELS_A_COMPARISON / 2).unwrap_or(0);
    let share = quotient(half, flat().count() as i32);
    let (mut comparisons, mut cut) = (half, 0_u16);
    for segment in flat() {
        comparisons += share;
        if comparisons <= 0 {
            cut = cut.saturating_add(1);
            continue;
        }
        let (x0, y0, x1, y1) = segment.ends_q5();
        let first = right.partition_point(|s| s.ends_q5().1.min(s.ends_q5().3) < y0.min(y1) - limit_q5 - 32);
        for other in right.get(first..).unwrap_or(&[]) {
            let (u0, v0, u1, v1) = other.ends_q5();
            if v0.min(v1) > y0.min(y1) + limit_q5 + 32 {
                break;
            }
            comparisons -= 1;
            let disparity = (x0 + x1 - u0 - u1) / 2;
            let same = other.near_horizontal
                && other.rising == segment.rising
                && ((x1 - x0) - (u1 - u0)).abs() <= 64
                && ((y1 - y0) - (v1 - v0)).abs() <= 16
                && ((disparities.0 << 5) - 32..=disparities.1 << 5).contains(&disparity)
                && other.contrast.abs_diff(segment.contrast) <= segment.contrast / 4;
            let bin = ((v0 + v1 - y0 - y1) / 2 + limit_q5 + 2) >> 2;
            if same && let Some(count) = usize::try_from(bin).ok().and_then(|b| votes.get_mut(b)) {
                *count += 1;
            }
        }
    }
    (crate::units::narrow(peak(&votes)), cut)
}

/// Mean of the 5 adjacent bins with the most votes, 1/32 px, if they have at least 1.5 times the votes of an even spread; else 0.
fn peak(votes: &[u32; BINS]) -> i32 {
    let total: u32 = votes.iter().sum();
    let mut best = (0, 0_i32);
    for (window, start) in votes.windows(5).zip(0_i32..) {
        let weight: u32 = window.iter().sum();
        if weight > best.0 {
            let moment: i32 = window.iter().zip(start..).map(|(&v, bin)| v as i32 * bin).sum();
            best = (weight, quotient(moment << 2, weight as i32) - i32::from(LIMIT_Q5));
        }
    }
    let (weight, centre_q5) = best;
    if weight >= MIN_VOTES && weight * BINS as u32 >= total * 5 * 3 / 2 { centre_q5 } else { 0 }
}
