//! A photo -> the corners of a ChArUco board that are seen.
//!
//! ```text
//! grids of X-junctions (finder) -> the markers in their squares (reader)
//! each marker: the turn and the shift from the grid to the board -> the one that most agree with
//!              numbers the corners
//! ```

use super::board::{Board, BoardCorners};
use super::corner;
use super::grid::{Grid, NotFound, more_telling};
use super::markers::{Dictionary, RIMS};
use super::reader::Reader;
use linestereo_frames::GrayImage;
use std::collections::BTreeMap;

/// Markers that agree, at least, and their share of all that were read: of 1450 corners in drawn
/// and worn pictures none was numbered by a misread one.
const LEAST_MARKERS: usize = 2;
const LEAST_SHARE: f64 = 0.9;

/// From places of a grid to places of the board: both in half squares.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Placement {
    /// Images of the two unit vectors.
    axes: [[i32; 2]; 2],
    shift: [i32; 2],
}

impl Placement {
    fn apply(&self, [x, y]: [i32; 2]) -> [i32; 2] {
        [0, 1].map(|i| self.axes[0][i] * x + self.axes[1][i] * y + self.shift[i])
    }
}

/// The corners of the largest part of the board among these grids, and of all parts that agree with
/// it.
pub(super) fn numbered(
    image: &GrayImage,
    board: &Board,
    (dictionary, marker): (Dictionary, f64),
    grids: &[Grid],
) -> Result<BoardCorners, NotFound> {
    let reader = Reader::new(image, dictionary, RIMS[0], marker);
    let mut why = NotFound::Nothing;
    let mut parts = Vec::new();
    for grid in grids {
        let grid = grid.clockwise();
        match placed(board, &reader, &grid) {
            Ok(placement) => parts.push(corners(image, board, &grid, &placement, marker)),
            Err(other) => why = more_telling(why, other),
        }
    }
    parts.sort_by_key(|part| core::cmp::Reverse(part.len()));
    let mut all = BTreeMap::new();
    for (number, at) in parts.into_iter().flatten() {
        all.entry(number).or_insert(at);
    }
    if all.is_empty() { Err(why) } else { Ok(BoardCorners::numbered(board, all)) }
}

/// Where the grid lies on the board.
fn placed(board: &Board, reader: &Reader, grid: &Grid) -> Result<Placement, NotFound> {
    let squares = board.markers();
    let mut votes: Vec<(Placement, usize)> = Vec::new();
    let (mut read, mut unknown) = (0, 0);
    for &(u, v) in grid.at.keys() {
        let around =
            [(u, v), (u + 1, v), (u + 1, v + 1), (u, v + 1)].map(|key| grid.at.get(&key).copied());
        let [Some(a), Some(b), Some(c), Some(d)] = around else { continue };
        let Some(marker) = reader.read([a, b, c, d]) else { continue };
        read += 1;
        let Some(square) = squares.get(marker.id) else {
            unknown += 1;
            continue;
        };
        let axes = [marker.upright([1, 0]), marker.upright([0, 1])];
        let turn = Placement { axes, shift: [0, 0] };
        // The middle of the square, here and there.
        let [x, y] = turn.apply([2 * u + 1, 2 * v + 1]);
        let shift = [2 * square[0] as i32 + 1 - x, 2 * square[1] as i32 + 1 - y];
        let placement = Placement { axes, shift };
        match votes.iter_mut().find(|(other, _)| *other == placement) {
            Some((_, count)) => *count += 1,
            None => votes.push((placement, 1)),
        }
    }
    let no_markers = NotFound::NoMarkers(grid.at.len());
    let Some(&(placement, agree)) = votes.iter().max_by_key(|(_, count)| count) else {
        return Err(if unknown > 0 { NotFound::OtherLayout } else { no_markers });
    };
    if agree as f64 >= LEAST_SHARE * f64::from(read) && agree >= LEAST_MARKERS {
        return Ok(placement);
    }
    Err(if read as usize > LEAST_MARKERS { NotFound::OtherLayout } else { no_markers })
}

/// The grid's corners by their numbers on the board.
fn corners(
    image: &GrayImage,
    board: &Board,
    grid: &Grid,
    placement: &Placement,
    marker: f64,
) -> BTreeMap<usize, [f64; 2]> {
    let (cols, rows) = (board.cols() as i32, board.rows() as i32);
    let numbered = |(&(u, v), &at): (&(i32, i32), &[f64; 2])| {
        let [x, y] = placement.apply([2 * u, 2 * v]);
        let (col, row) = (x / 2 - 1, y / 2 - 1);
        if !(0..cols).contains(&col) || !(0..rows).contains(&row) {
            return None;
        }
        let next = [(u - 1, v), (u + 1, v), (u, v - 1), (u, v + 1)];
        let apart = next
            .iter()
            .filter_map(|key| grid.at.get(key))
            .map(|next| (next[0] - at[0]).hypot(next[1] - at[1]));
        let spacing = apart.fold(f64::MAX, f64::min);
        // The detector's own place is nearer to the truth (0.04 px for 0.10), but a marker's corner
        // that it took for one of the board's is not: inside the rim nothing is seen there.
        corner::refine_within(image, at, (1.0 - marker) / 2.0 * spacing)?;
        Some(((row * cols + col) as usize, at))
    };
    grid.at.iter().filter_map(numbered).collect()
}
