//! Near-vertical edges that the left image shows again at equal distances along the same rows:
//! fences, radiators, stripes, printed walls.
//!
//! In: an edge on whole pixels, the band that holds its rows. Out: whether it repeats.
//!
//! ```text
//! cost of eight columns around the edge at three of its rows, everywhere up to 96 px away
//! alike: a minimum of at most 0.4 of the edge's own gradients; a little alike: of at most 0.8
//! places in a row at one distance from each other, the edge itself among them: it repeats where
//! four of them are alike, or six a little alike
//! ```
//!
//! The right image cannot tell which of them is which: where the true disparity lies between two
//! pixels and a wrong one on a whole pixel, the wrong one costs less.
//!
//! # Cost
//! Three strips over 193 places, and runs among them: 7000 instructions.

use super::band::{Band, REPEAT_REACH as REACH, SampledRows};
use crate::curve::{Curve, low_of};
use crate::kernel::{FLAT, STRIP, Strip, sad_curve};
use crate::lines::Line;
use crate::places::Places;
use crate::row_memory::PAD;
use heapless::Vec;

/// Nearest place, px: up to there an edge is alike to itself.
const NEAREST: i32 = 4;
/// Rows that are compared.
const ROWS: i32 = 3;
/// First column compared, relative to the edge.
const FIRST_COLUMN: i32 = -4;
/// Largest cost of a place that is alike, of the edge's own gradients, Q8, and the number of these
/// places at equal distances that repeat: bars whose edges are alike, and bars before texture that
/// differs from gap to gap. `docs/experiments.md` has others.
const REPEATING: [(u32, i32); 2] = [(102, 4), (204, 6)];
/// Deviation from equal distances, px.
const TOLERANCE: i32 = 2;

/// True where the left image repeats an edge over these rows.
pub(super) fn repeats(line: &Line, rows: (i32, i32), band: &Band<'_>, curve: &mut Curve) -> bool {
    let (top, bottom) = (line.at(rows.0), line.at(rows.1));
    let (left, right) = (top.min(bottom) + FIRST_COLUMN, top.max(bottom) + FIRST_COLUMN);
    let first = (-REACH).max(2 - left);
    let last = REACH.min(band.width() - 2 - STRIP as i32 - right);
    let mut strips: Vec<Strip<'_>, { ROWS as usize }> = Vec::new();
    let mut energy = 0;
    for y in SampledRows::new(rows, ROWS) {
        if let Some(strip) = strip(line.at(y) + FIRST_COLUMN, y, first, band) {
            energy += strip.reference.iter().map(|g| u32::from(g.abs_diff(FLAT))).sum::<u32>();
            let _ = strips.push(strip); // at most ROWS rows are sampled
        }
    }
    curve.fill((first, last - first + 1), |costs| sad_curve(&strips, costs));
    let places = alike(curve, REPEATING.map(|(alike_q8, _)| (energy * alike_q8) >> 8));
    let mut kinds = places.into_iter().zip(REPEATING);
    kinds.any(|(places, (_, run))| places.distance(run, TOLERANCE).is_some())
}

/// Eight gradients of the left image at `x..x + 8` of row `y`, and its row from there on, `first`
/// columns away.
pub(crate) fn strip<'b>(x: i32, y: i32, first: i32, band: &'b Band<'_>) -> Option<Strip<'b>> {
    let (left, _) = band.gradient_rows(y)?;
    let at = |x: i32| left.get(usize::try_from(PAD as i32 + x).ok()?..);
    Some(Strip { reference: *at(x)?.first_chunk()?, other: at(x + first)? })
}

/// The minima of at most each of these costs.
fn alike(curve: &Curve, most: [u32; 2]) -> [Places; 2] {
    let mut places = [Places::default(); 2];
    let Some((first, costs)) = curve.listed() else { return places };
    // One test for most minima: the compiler makes a place's bit before it compares.
    let largest = most.into_iter().max().unwrap_or(0);
    let around = costs.windows(3).filter_map(|around| around.first_chunk());
    for (around, offset) in around.zip(first + 1..) {
        let &[before, here, after] = around;
        if here <= before && here < after && offset.abs() >= NEAREST {
            let low = low_of(around);
            if low > largest {
                continue;
            }
            for (places, _) in places.iter_mut().zip(most).filter(|(_, most)| low <= *most) {
                places.add(offset);
            }
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_places_may_be_less_alike() {
        assert!(REPEATING.is_sorted_by(|a, b| a.0 < b.0 && a.1 < b.1));
        let mut curve = Curve::EMPTY;
        curve.fill((-90, 181), |costs| {
            for (cost, offset) in costs.iter_mut().zip(-90..) {
                *cost = if offset % 15 == 0 { 150 } else { 400 };
            }
        });
        let [alike, less] = alike(&curve, [100, 200]);
        let repeat = |places: Places, run| places.distance(run, TOLERANCE).is_some();
        assert!(!repeat(alike, 4) && repeat(less, 6) && !repeat(less, 14));
    }
}
