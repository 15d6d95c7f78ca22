//! Near-vertical edges that the left image shows again at equal distances, and the right image at
//! one of these: fences, radiators, printed walls.
//!
//! In: an edge on whole pixels with its disparity, the band that holds its rows. Out: whether it
//! repeats.
//!
//! ```text
//! strips:  four columns from 1 px before the edge on, and as many up to 1 px behind it: what lies
//!          on the other side may differ from one bar to the next
//! right:   minima over the whole range, as low as that at the disparity, or 0.3 of the edge's own
//!          gradients
//! left:    minima as low, up to 96 px away, three of them at one distance from each other, the edge
//!          itself among them
//! repeats: the right image has one at this distance, or twice as far
//! ```
//!
//! # Cost
//! Six rows of strips at all disparities, 2500 instructions for each of the two kinds; where the
//! right image has another minimum, 193 places of the left one as well.

use super::MatchContext;
use super::band::{Band, REPEAT_REACH as REACH, SampledRows};
use super::narrow::take_off;
use crate::curve::{Curve, low_of};
use crate::kernel::{FLAT, STRIP, Strip, sad_curve};
use crate::lines::Line;
use crate::places::Places;
use crate::row_memory::PAD;
use heapless::Vec;

/// Rows that are compared.
const ROWS: i32 = 6;
/// Columns that are compared, and what a strip has beyond them.
const COLUMNS: i32 = 4;
const BEYOND: usize = STRIP - COLUMNS as usize;
/// First columns of the two kinds of strips, relative to the edge.
const FIRST_COLUMNS: [i32; 2] = [-1, 2 - COLUMNS];
/// Nearest place, px: up to there an edge is alike to itself.
const NEAREST: i32 = 4;
/// Places in a row that repeat.
const RUN: i32 = 3;
/// Places in a row that repeat where the left border cuts the range off, so that the right image
/// does not show what is nearer.
const RUN_CUT_OFF: i32 = 4;
/// Deviation from equal distances, px.
const TOLERANCE: i32 = 1;
/// Largest cost of a place that is alike where the match itself costs less, of the edge's own
/// gradients, Q8.
const MOST_Q8: u32 = 77;

/// A strip of each row, in the left image and mirrored for the right one.
struct Strips<'b> {
    left: Rows<'b>,
    right: Rows<'b>,
    /// Sum of their own gradients.
    energy: u32,
}

/// Strips, and where what is beyond them begins.
#[derive(Default)]
struct Rows<'b> {
    strips: Vec<Strip<'b>, { ROWS as usize }>,
    beyond: Vec<&'b [u8], { ROWS as usize }>,
}

/// True where both images repeat an edge over these rows that matches at this disparity.
pub(super) fn repeats(
    line: &Line,
    rows: (i32, i32),
    band: &Band<'_>,
    context: &MatchContext<'_>,
    disparity: i32,
    curve: &mut Curve,
) -> bool {
    let (top, bottom) = (line.at(rows.0), line.at(rows.1));
    FIRST_COLUMNS.into_iter().any(|column| {
        let (left, right) = (top.min(bottom) + column, top.max(bottom) + column);
        let end = band.width() - 2 - STRIP as i32 - right;
        let first = (-REACH).max(2 - left);
        let (smallest, largest) = context.whole_range();
        let range = (smallest.max(-end), largest.min(left - 2));
        let strips = Strips::gather(line, rows, column, band, [first, range.0]);
        strips.right.fill((range.0, range.1 - range.0 + 1), curve);
        let of_match = curve.minimum_near(disparity, 1).cost;
        let most = u32::from(of_match).max((strips.energy * MOST_Q8) >> 8);
        let there = alike(curve, disparity, most);
        let is_cut_off = range.1 < largest;
        if there.is_empty() && !is_cut_off {
            return false;
        }
        strips.left.fill((first, REACH.min(end) - first + 1), curve);
        let here = alike(curve, 0, most);
        let is_there = |distance: i32| {
            let has = |times: i32| there.has(times * distance, TOLERANCE * times.abs());
            [1, -1, 2, -2].into_iter().any(has)
        };
        here.distances(RUN, TOLERANCE).any(is_there)
            || is_cut_off && here.distances(RUN_CUT_OFF, TOLERANCE).next().is_some()
    })
}

impl<'b> Strips<'b> {
    /// Strips from this column beside the line on, which begin with these distances of the left and
    /// of the right image.
    fn gather(
        line: &Line,
        rows: (i32, i32),
        column: i32,
        band: &'b Band<'_>,
        [first_left, first_right]: [i32; 2],
    ) -> Self {
        let mut strips = Self { left: Rows::default(), right: Rows::default(), energy: 0 };
        for y in SampledRows::new(rows, ROWS) {
            let x = line.at(y) + column;
            let Some((left, right)) = band.gradient_rows(y) else { continue };
            let from = |row: &'b [u8], x: i32| row.get(usize::try_from(PAD as i32 + x).ok()?..);
            let mirrored = band.width() - STRIP as i32 - x + first_right;
            if let (Some(own), Some(left), Some(right)) =
                (from(left, x), from(left, x + first_left), from(right, mirrored))
                && let Some(&(mut reference)) = own.first_chunk::<STRIP>()
            {
                if let Some(flat) = reference.last_chunk_mut::<BEYOND>() {
                    *flat = [FLAT; BEYOND];
                }
                strips.energy += reference.iter().map(|g| u32::from(g.abs_diff(FLAT))).sum::<u32>();
                strips.left.push(reference, left, COLUMNS as usize);
                reference.reverse();
                strips.right.push(reference, right, 0);
            }
        }
        strips
    }
}

impl<'b> Rows<'b> {
    fn push(&mut self, reference: [u8; STRIP], other: &'b [u8], beyond: usize) {
        // At most ROWS rows are sampled.
        let _ = self.strips.push(Strip { reference, other });
        let _ = self.beyond.push(other.get(beyond..).unwrap_or(&[]));
    }

    /// The costs of all strips from a first place on, and their number.
    fn fill(&self, range: (i32, i32), curve: &mut Curve) {
        curve.fill(range, |costs| {
            sad_curve(&self.strips, costs);
            take_off(&self.beyond, BEYOND, costs);
        });
    }
}

/// The minima of at most this cost, by their distance from a place.
fn alike(curve: &Curve, place: i32, most: u32) -> Places {
    let mut places = Places::default();
    let Some((first, costs)) = curve.listed() else { return places };
    let around = costs.windows(3).filter_map(|around| around.first_chunk());
    for (around, offset) in around.zip(first + 1 - place..) {
        let &[before, here, after] = around;
        if here <= before && here < after && offset.abs() >= NEAREST && low_of(around) <= most {
            places.add(offset);
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alike_are_low_minima_away_from_the_place() {
        let mut curve = Curve::EMPTY;
        curve.fill((-30, 61), |costs| {
            for (cost, offset) in costs.iter_mut().zip(-30..) {
                *cost = match offset {
                    -20 | -12 | -2 | 4 | 12 => 50,
                    20 => 150,
                    _ => 400,
                };
            }
        });
        let places = alike(&curve, -4, 100);
        assert_eq!(places.distances(3, TOLERANCE).collect::<Vec<_, 4>>(), [8, 16]);
        assert!(alike(&curve, -4, 40).is_empty());
    }
}
