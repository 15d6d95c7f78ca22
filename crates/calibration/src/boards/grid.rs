//! Numbered junctions of a board in a photo, and why they are not the board's.

use calib_targets_chessboard::ChessboardDetection;
use std::collections::BTreeMap;

/// A line of the grid beside the board may hold this share of false corners; with more, the board
/// is larger than said.
const FALSE_SHARE: f64 = 0.5;

/// Why a board is not found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotFound {
    /// Nothing that looks like a board.
    #[error("no board")]
    Nothing,
    /// A part of a board: so many corners of it.
    #[error("only {0} corners of the board")]
    Part(usize),
    /// A whole board of another size: inner corners along the longer and the shorter side.
    #[error("a board of {0}x{1} inner corners")]
    OtherSize(usize, usize),
    /// A part of a board without markers of the dictionary: so many corners of it.
    #[error("{0} corners, but no markers of the dictionary")]
    NoMarkers(usize),
    /// Markers of the dictionary, but not where they are on the board.
    #[error("markers that are not those of the board")]
    OtherLayout,
}

/// A whole board of another size says most, then the largest part of one.
pub(super) fn more_telling(one: NotFound, other: NotFound) -> NotFound {
    let rank = |why: NotFound| match why {
        NotFound::Nothing => (0, 0),
        NotFound::Part(corners) => (1, corners),
        NotFound::NoMarkers(corners) => (2, corners),
        NotFound::OtherLayout => (3, 0),
        NotFound::OtherSize(cols, rows) => (4, cols * rows),
    };
    if rank(other) > rank(one) { other } else { one }
}

pub(super) struct Grid {
    pub(super) at: BTreeMap<(i32, i32), [f64; 2]>,
    pub(super) cols: i32,
    pub(super) rows: i32,
}

impl Grid {
    pub(super) fn new(detection: &ChessboardDetection) -> Self {
        let place = |corner: &calib_targets_chessboard::ChessboardCorner| {
            (
                (corner.grid.u, corner.grid.v),
                [f64::from(corner.position.x), f64::from(corner.position.y)],
            )
        };
        let at: BTreeMap<_, _> = detection.corners.iter().map(place).collect();
        let cols = at.keys().map(|key| key.0 + 1).max().unwrap_or(0);
        let rows = at.keys().map(|key| key.1 + 1).max().unwrap_or(0);
        Self { at, cols, rows }
    }

    /// Rows follow columns clockwise, as in a board that is seen from the front.
    pub(super) fn clockwise(&self) -> Self {
        let side = |from: (i32, i32), to: (i32, i32)| {
            let [from, to] = [self.at.get(&from)?, self.at.get(&to)?];
            Some([to[0] - from[0], to[1] - from[1]])
        };
        let turn = self.at.keys().filter_map(|&(u, v)| {
            let [right, down] = [side((u, v), (u + 1, v))?, side((u, v), (u, v + 1))?];
            Some(right[0] * down[1] - right[1] * down[0])
        });
        if turn.sum::<f64>() < 0.0 {
            self.transposed()
        } else {
            Self { at: self.at.clone(), ..*self }
        }
    }

    pub(super) fn transposed(&self) -> Self {
        let at = self.at.iter().map(|(&(u, v), &place)| ((v, u), place)).collect();
        Self { at, cols: self.rows, rows: self.cols }
    }

    /// Share of the junctions of this rectangle that are there.
    pub(super) fn filled(&self, left: i32, top: i32, cols: i32, rows: i32) -> f64 {
        let there = (top..top + rows).flat_map(|v| (left..left + cols).map(move |u| (u, v)));
        there.filter(|key| self.at.contains_key(key)).count() as f64 / f64::from(cols * rows)
    }

    /// The rectangle without border lines that are mostly empty.
    pub(super) fn trimmed(&self) -> (i32, i32, i32, i32) {
        let (mut left, mut top, mut cols, mut rows) = (0, 0, self.cols, self.rows);
        loop {
            if cols <= 1 || rows <= 1 {
                return (left, top, cols, rows);
            }
            let borders = [
                self.filled(left, top, 1, rows),
                self.filled(left + cols - 1, top, 1, rows),
                self.filled(left, top, cols, 1),
                self.filled(left, top + rows - 1, cols, 1),
            ];
            let Some(empty) = (0..4)
                .filter(|&i| borders[i] <= FALSE_SHARE)
                .min_by(|&a, &b| borders[a].total_cmp(&borders[b]))
            else {
                return (left, top, cols, rows);
            };
            match empty {
                0 => (left, cols) = (left + 1, cols - 1),
                1 => cols -= 1,
                2 => (top, rows) = (top + 1, rows - 1),
                _ => rows -= 1,
            }
        }
    }
}
