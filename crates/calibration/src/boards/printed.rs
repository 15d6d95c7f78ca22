//! A board as it is printed: its markers and all that is black on it.

use super::board::Board;
use super::markers::{Dictionary, Pattern, RIMS};

/// Left, top, width, height, m, from the first corner.
pub type Rectangle = [f64; 4];

impl Board {
    /// Square (of an AprilGrid tag) of each marker, column and row from the upper left, by its
    /// number.
    pub(super) fn markers(&self) -> Vec<[usize; 2]> {
        match self.pattern() {
            Pattern::Chessboard => Vec::new(),
            Pattern::Charuco { .. } => {
                self.squares().filter(|&square| !self.is_black(square)).collect()
            }
            Pattern::AprilGrid { .. } => {
                let (cols, rows) = (self.cols() / 2, self.rows() / 2);
                (0..rows).rev().flat_map(|row| (0..cols).map(move |col| [col, row])).collect()
            }
        }
    }

    /// All squares of a chessboard, column and row from the upper left: one more than corners.
    fn squares(&self) -> impl Iterator<Item = [usize; 2]> {
        grid(self.cols() + 1, self.rows() + 1)
    }

    /// Is this square, column and row from the upper left, one of the black ones?
    fn is_black(&self, [col, row]: [usize; 2]) -> bool {
        let from_white =
            matches!(self.pattern(), Pattern::Charuco { legacy: true, .. }) && self.rows() % 2 == 1;
        (col + row + usize::from(from_white)).is_multiple_of(2)
    }

    /// The printed board, without a white rim: left, top, width, height in m from the first corner.
    pub fn extent(&self) -> Rectangle {
        let side = self.square();
        match self.pattern() {
            Pattern::AprilGrid { spacing } => {
                let length =
                    |corners: usize| side * ((corners / 2) as f64 * (1.0 + spacing) + spacing);
                [-side * spacing, -side * spacing, length(self.cols()), length(self.rows())]
            }
            _ => [-side, -side, side * (self.cols() + 1) as f64, side * (self.rows() + 1) as f64],
        }
    }

    /// Everything black on it; rectangles touch, and do not overlap.
    pub fn black(&self) -> Vec<Rectangle> {
        let side = self.square();
        let place = |at: usize| (at as f64 - 1.0) * side;
        let squares = self.squares().filter(|&square| self.is_black(square));
        let squares = squares.map(|[col, row]| [place(col), place(row), side, side]);
        let markers = self.markers().into_iter().enumerate();
        match self.pattern() {
            Pattern::Chessboard => squares.collect(),
            Pattern::Charuco { dictionary, marker, .. } => {
                let rim = side * (1.0 - marker) / 2.0;
                let drawn = |(id, [col, row]): (usize, [usize; 2])| {
                    let origin = [place(col) + rim, place(row) + rim];
                    marker_cells(dictionary, id, RIMS[0], false, origin, marker * side)
                };
                squares.chain(markers.flat_map(drawn)).collect()
            }
            Pattern::AprilGrid { spacing } => {
                let Some(dictionary) = self.pattern().dictionary() else { return Vec::new() };
                let (gap, step) = (spacing * side, (1.0 + spacing) * side);
                let drawn = |(id, [col, row]): (usize, [usize; 2])| {
                    let origin = [col as f64 * step, row as f64 * step];
                    marker_cells(dictionary, id, RIMS[1], true, origin, side)
                };
                let corner = |i: usize| i as f64 * step - gap;
                let between = grid(self.cols() / 2 + 1, self.rows() / 2 + 1)
                    .map(|[col, row]| [corner(col), corner(row), gap, gap]);
                between.chain(markers.flat_map(drawn)).collect()
            }
        }
    }
}

/// Columns and rows of a rectangle, row by row.
fn grid(cols: usize, rows: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..rows).flat_map(move |row| (0..cols).map(move |col| [col, row]))
}

/// A marker's black cells, neighbours in a row as one; `turned` by half a turn, as Kalibr prints
/// tags.
fn marker_cells(
    dictionary: Dictionary,
    id: usize,
    rim: usize,
    turned: bool,
    [left, top]: [f64; 2],
    side: f64,
) -> Vec<Rectangle> {
    let cells = dictionary.side() + 2 * rim;
    let cell = side / cells as f64;
    let dark = |col: usize, row: usize| {
        let inside = rim..cells - rim;
        if !inside.contains(&col) || !inside.contains(&row) {
            return true;
        }
        let (col, row) = if turned { (cells - 1 - col, cells - 1 - row) } else { (col, row) };
        dictionary.is_dark(id, col - rim, row - rim)
    };
    let mut black = Vec::new();
    for row in 0..cells {
        let mut col = 0;
        while col < cells {
            let run = (col..cells).take_while(|&col| dark(col, row)).count();
            if run > 0 {
                black.push([
                    left + col as f64 * cell,
                    top + row as f64 * cell,
                    run as f64 * cell,
                    cell,
                ]);
            }
            col += run + 1;
        }
    }
    black
}
