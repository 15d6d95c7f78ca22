//! Row offset of a pair, by the near-horizontal segments of both images.
//!
//! In: the segments of both images. Out: offset to add to a left row for the matching right row,
//! 1/32 px.
//!
//! ```text
//! for every left and right near-horizontal segment that could be the same edge: a vote for the
//!     difference of their rows
//! the offset is the largest cluster of votes within +-2 px, if it has enough of them; else it is
//! not known
//! ```
//! Votes of true pairs agree, those of false ones spread evenly over the interval. No pixels are
//! read.
//!
//! # Cost
//! Some 20 instructions a comparison of a left segment with a right one on its rows; one in
//! [`PIXELS_A_COMPARISON`] px at most, half of them from the start, the rest evenly over the left
//! segments. Captured pairs make up to 0.7 of those, gratings had three times as many.

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

/// Row offset of the right image against the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RowOffset {
    /// 1/32 px; `None` when the votes do not determine it.
    pub(crate) offset_q5: Option<i16>,
    /// Left segments that were not compared, because an image of its size had enough of them.
    pub(crate) cut: u16,
}

/// Estimates the row offset, in images of so many pixels.
pub(crate) fn estimate(
    left: &[Segment],
    right: &[Segment],
    disparities: (i32, i32),
    pixels: u32,
) -> RowOffset {
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
        let first = right
            .partition_point(|s| s.ends_q5().1.min(s.ends_q5().3) < y0.min(y1) - limit_q5 - 32);
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
    RowOffset { offset_q5: peak(&votes).map(crate::units::narrow), cut }
}

/// Mean of the 5 adjacent bins with the most votes, 1/32 px, if they have at least 1.5 times the
/// votes of an even spread.
fn peak(votes: &[u32; BINS]) -> Option<i32> {
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
    (weight >= MIN_VOTES && weight * BINS as u32 >= total * 5 * 3 / 2).then_some(centre_q5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::ImagePosition;
    use crate::units::Position;

    #[test]
    fn votes_that_agree_are_an_offset_and_spread_ones_are_none() {
        assert_eq!(peak(&[3; BINS]), None);
        for (middle, offset_q5) in [(25, 36), (7, -36)] {
            let mut votes = [1; BINS];
            votes
                .iter_mut()
                .skip(middle - 2)
                .zip([2, 6, 9, 6, 2])
                .for_each(|(slot, count)| *slot = count);
            assert_eq!(peak(&votes), Some(offset_q5));
        }
        let alone = |count| peak(&core::array::from_fn(|bin| if bin == 20 { count } else { 0 }));
        assert_eq!([MIN_VOTES - 1, MIN_VOTES].map(alone), [None, Some(16)]);
    }

    /// From `x` on, px; the row in 1/32 px.
    fn flat(x: u16, row_q5: u16, length: u16) -> Segment {
        let end = |x| ImagePosition { x: Position::from_num(x), y: Position::from_bits(row_q5) };
        Segment {
            ends: [end(x), end(x + length)],
            rising: true,
            contrast: 40,
            near_horizontal: true,
        }
    }

    #[test]
    fn edges_vote_for_their_rows_and_what_is_another_edge_does_not() {
        const EDGES: usize = 10;
        let rows: [u16; EDGES] = core::array::from_fn(|i| 320 * (i as u16 + 1));
        let left = rows.map(|row| flat(100, row, 20));
        for moved_q5 in [-32, 0, 32] {
            // Each true edge has two companions a row further that differ from it in one thing.
            let edge = |row: u16, by: i16| flat(90, row.saturating_add_signed(moved_q5 + by), 20);
            let others: [fn(Segment) -> Segment; 5] = [
                |edge| Segment { rising: false, ..edge },
                |edge| Segment { near_horizontal: false, ..edge },
                |edge| Segment { contrast: 60, ..edge },
                |edge| flat(20, edge.ends[0].y.to_bits(), 20), // beyond the range
                |edge| flat(90, edge.ends[0].y.to_bits(), 26),
            ];
            for other in others {
                let mut right = [flat(0, 0, 1); 3 * EDGES];
                for (three, row) in right.chunks_exact_mut(3).zip(rows) {
                    let another = other(edge(row, 32));
                    three.copy_from_slice(&[edge(row, 0), another, another]);
                }
                right.sort_unstable_by_key(|segment| segment.ends_q5().1);
                let found = RowOffset { offset_q5: Some(moved_q5), cut: 0 };
                assert_eq!(estimate(&left, &right, (0, 64), 320 * 240), found);
            }
        }
    }
}
