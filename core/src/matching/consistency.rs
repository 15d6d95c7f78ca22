//! Agreement and contradiction among the hypotheses of segments.
//!
//! In: position and disparity of every hypothesis. Out: evidence of agreement for each; the pairs
//! that match the same position in the right image with different disparities, of which at most one
//! is right.
//!
//! ```text
//! agreement = log2(1 + sum of weight * nearness over the neighbours that agree)
//! ```
//! A neighbour agrees when its disparity differs by at most 1 px plus 0.06 px per px of distance:
//! surfaces that slant up to that much. This evidence matters most for objects too thin for support
//! points: both edges of a pole, piece by piece.
//!
//! # Bounds
//! Weight is at most 256, nearness 40: 320 a neighbour; sums of 16 bits saturate beyond 200
//! neighbours at distance 0.
//!
//! # Cost
//! Some 10 instructions for every two candidates within [`TOPS_REACH`] rows, 100 where they are
//! neighbours, each with at most [`MOST_NEIGHBOURS`] after it. A candidate has a square of its own:
//! with squares of 20 px at most 80 are within those rows of 320 px, 20 within reach; captured
//! pairs have 54 and 9.

use super::{Candidate, Side, WINDOW_MIDDLE};
use crate::evidence::log2_mean_q8;
use crate::lines::MAX_ROWS;
use crate::units::{about_length, narrow};

/// Distance from which a neighbour has no weight, px.
const REACH: i32 = 40;
/// Rows between the tops of two segments beyond which their hypotheses are out of [`REACH`]: half
/// of the taller one on top.
const TOPS_REACH: i32 = REACH + MAX_ROWS / 2;
/// Most neighbours that follow a candidate in the list and are weighed: three times as many as
/// captured pairs have.
const MOST_NEIGHBOURS: u16 = 32;
/// Agreement of a neighbour at distance 0 with full weight.
const FULL: i32 = (256 * REACH) >> 5;
/// Largest difference of rows at which two hypotheses match the same position, px.
const SAME_ROWS: i32 = 6;
/// Largest difference of right columns at which two hypotheses match the same position, 1/64 px.
const SAME_COLUMNS_Q6: i32 = 2 << 6;
/// Difference of disparity above which they contradict each other, 1/64 px.
const OTHER_SURFACE_Q6: i32 = 2 << 6;

/// A candidate reduced to its middle, px, and the hypotheses of its sides, as its neighbours use
/// it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Neighbour {
    pub(crate) x: i16,
    pub(crate) y: i16,
    /// First row of the segment, px.
    top: i16,
    near_horizontal: bool,
    pub(crate) hypotheses: [SideHypothesis; 2],
}

/// Disparity and weight of a side's hypothesis, and its support by neighbours.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SideHypothesis {
    /// Disparity at the middle, 1/64 px.
    pub(crate) d_q6: i16,
    /// Weight as a neighbour, Q8; 0 = no hypothesis.
    pub(crate) weight_q8: u16,
    /// Support by the neighbours that agree: sum of weight times nearness, 320 for one at distance
    /// 0 with full weight. In a region (`objects`): the weight by which the surface is selected,
    /// which falls to the border of a box.
    pub(crate) support: u16,
}

impl Neighbour {
    #[cfg(test)]
    pub(crate) const EMPTY: Self =
        Self { x: 0, y: 0, top: 0, near_horizontal: false, hypotheses: [SideHypothesis::EMPTY; 2] };

    pub(crate) fn new(candidate: &Candidate) -> Self {
        let (x0, y0, x1, y1) = candidate.segment.ends_q5();
        let hypothesis =
            |side: &Option<Side>| side.as_ref().map_or(SideHypothesis::EMPTY, SideHypothesis::new);
        let [left, right] = &candidate.sides;
        Self {
            x: narrow((x0 + x1) >> 6),
            y: narrow((y0 + y1) >> 6),
            top: narrow(y0.min(y1) >> 5),
            near_horizontal: candidate.segment.near_horizontal,
            hypotheses: [hypothesis(left), hypothesis(right)],
        }
    }

    /// A neighbour with the hypothesis of a support point.
    pub(crate) fn of_point(x: i32, y: i32, d_q6: i16, weight_q8: u16) -> Self {
        let hypotheses =
            [SideHypothesis { d_q6, weight_q8, ..SideHypothesis::EMPTY }, SideHypothesis::EMPTY];
        Self { x: narrow(x), y: narrow(y), top: narrow(y), near_horizontal: false, hypotheses }
    }

    /// Adds the mutual support of the hypotheses of two segments; false when they are out of reach
    /// of each other.
    fn weigh(&mut self, other: &mut Self) -> bool {
        let dx = i32::from(other.x - self.x);
        if dx.abs() >= REACH {
            return false;
        }
        let distance = about_length(dx, i32::from(other.y - self.y));
        if distance >= REACH {
            return false;
        }
        for own in &mut self.hypotheses {
            for others in &mut other.hypotheses {
                own.weigh(others, distance);
            }
        }
        true
    }

    /// True when one side's hypothesis has a weight.
    fn has(&self, side: usize) -> bool {
        self.hypotheses.get(side).is_some_and(|hypothesis| hypothesis.weight_q8 > 0)
    }

    /// Column in the right image that one side's hypothesis matches, 1/64 px.
    fn right_q6(&self, side: usize, d_q6: i32) -> i32 {
        let off = if self.near_horizontal {
            0
        } else if side == 0 {
            -WINDOW_MIDDLE
        } else {
            WINDOW_MIDDLE
        };
        ((i32::from(self.x) + off) << 6) - d_q6
    }
}

impl SideHypothesis {
    const EMPTY: Self = Self { d_q6: 0, weight_q8: 0, support: 0 };

    fn new(side: &Side) -> Self {
        Self { d_q6: narrow(side.sum_q6() >> 1), weight_q8: side.weight_q8, ..Self::EMPTY }
    }

    fn weigh(&mut self, other: &mut Self, distance: i32) {
        // 0.06 px per px is 4/64.
        if self.weight_q8 == 0
            || other.weight_q8 == 0
            || (i32::from(other.d_q6) - i32::from(self.d_q6)).abs() > 64 + 4 * distance
        {
            return;
        }
        let nearness = (REACH - distance) as u32; // of REACH
        let support = |weight_q8: u16| ((u32::from(weight_q8) * nearness) >> 5) as u16;
        self.support = self.support.saturating_add(support(other.weight_q8));
        other.support = other.support.saturating_add(support(self.weight_q8));
    }
}

/// One neighbour per candidate, in memory for them.
pub(crate) fn neighbours<'n>(
    candidates: &[Candidate],
    memory: &'n mut [Neighbour],
) -> &'n mut [Neighbour] {
    for (candidate, neighbour) in candidates.iter().zip(memory.iter_mut()) {
        *neighbour = Neighbour::new(candidate);
    }
    memory.get_mut(..candidates.len()).unwrap_or(&mut [])
}

/// Sums the support of each hypothesis by its neighbours (in the order of their tops). Returns the
/// number of candidates with [`MOST_NEIGHBOURS`] or more.
pub(crate) fn accumulate_support(neighbours: &mut [Neighbour]) -> u16 {
    let mut cut = 0_u16;
    for i in 0..neighbours.len() {
        let Some((first, after)) = neighbours.get_mut(i..).and_then(<[_]>::split_first_mut) else {
            break;
        };
        let mut weighed = 0;
        for neighbour in after {
            if i32::from(neighbour.top - first.top) > TOPS_REACH {
                break;
            }
            if first.weigh(neighbour) {
                weighed += 1;
                if weighed == MOST_NEIGHBOURS {
                    cut = cut.saturating_add(1);
                    break;
                }
            }
        }
    }
    cut
}

/// Sets every side's agreement with other segments.
pub(crate) fn take_support(candidates: &mut [Candidate], neighbours: &mut [Neighbour]) {
    for (candidate, neighbour) in candidates.iter_mut().zip(neighbours) {
        for (side, hypothesis) in candidate.sides.iter_mut().zip(&mut neighbour.hypotheses) {
            if let Some(side) = side {
                side.nearby.segments = narrow(log2_mean_q8(hypothesis.support.into(), FULL));
            }
            hypothesis.support = 0;
        }
    }
}

/// Rows between the tops of two segments beyond which their hypotheses cannot contradict each
/// other.
const CONTRADICTION_REACH: i32 = SAME_ROWS + MAX_ROWS / 2;

/// Calls `found` with the hypotheses `(candidate, side)` of every two of the first `count` that
/// match the same position in the right image with different disparities: at most one of them is
/// right.
pub(crate) fn for_each_contradiction(
    neighbours: &[Neighbour],
    count: usize,
    mut found: impl FnMut((usize, usize), (usize, usize)),
) {
    let neighbours = neighbours.get(..count).unwrap_or(&[]);
    for (i, neighbour) in neighbours.iter().enumerate() {
        for (other, j) in neighbours.get(i + 1..).unwrap_or(&[]).iter().zip(i + 1..) {
            if i32::from(other.top - neighbour.top) > CONTRADICTION_REACH {
                break;
            }
            if i32::from(other.y - neighbour.y).abs() > SAME_ROWS {
                continue;
            }
            for side in (0..2).filter(|&side| neighbour.has(side)) {
                for other_side in (0..2).filter(|&side| other.has(side)) {
                    if contradict(neighbour, side, other, other_side) {
                        found((i, side), (j, other_side));
                    }
                }
            }
        }
    }
}

fn contradict(a: &Neighbour, a_side: usize, b: &Neighbour, b_side: usize) -> bool {
    let (Some(hypothesis_a), Some(hypothesis_b)) =
        (a.hypotheses.get(a_side), b.hypotheses.get(b_side))
    else {
        return false;
    };
    let (da, db) = (i32::from(hypothesis_a.d_q6), i32::from(hypothesis_b.d_q6));
    (a.right_q6(a_side, da) - b.right_q6(b_side, db)).abs() <= SAME_COLUMNS_Q6
        && (da - db).abs() > OTHER_SURFACE_Q6
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Middle of an upright segment, with a hypothesis of its right side alone.
    fn neighbour(x: i16, y: i16, disparity: i16, weight_q8: u16) -> Neighbour {
        let right = SideHypothesis { d_q6: disparity << 6, weight_q8, support: 0 };
        Neighbour {
            x,
            y,
            top: y - 4,
            near_horizontal: false,
            hypotheses: [SideHypothesis::EMPTY, right],
        }
    }

    #[test]
    fn one_position_cannot_have_two_disparities() {
        let contradicts = |other: Neighbour| {
            let mut found = heapless::Vec::<_, 4>::new();
            for_each_contradiction(&[neighbour(100, 50, 10, 256), other], 2, |a, b| {
                found.push((a, b)).unwrap()
            });
            assert!(found.is_empty() || found == [((0, 1), (1, 1))], "{found:?}");
            !found.is_empty()
        };
        assert!(contradicts(neighbour(105, 50, 15, 256)));
        assert!(!contradicts(neighbour(105, 50, 15, 0)), "nothing is said");
        // Of the disparity, of the column in the right image, of the row.
        let at_and_beyond_limits = [
            (neighbour(103, 50, 13, 256), neighbour(102, 50, 12, 256)),
            (neighbour(107, 50, 15, 256), neighbour(108, 50, 15, 256)),
            (neighbour(103, 50, 15, 256), neighbour(102, 50, 15, 256)),
            (neighbour(105, 56, 15, 256), neighbour(105, 57, 15, 256)),
        ];
        for (within, beyond) in at_and_beyond_limits {
            assert_eq!([within, beyond].map(contradicts), [true, false], "{within:?}");
        }
    }
}
