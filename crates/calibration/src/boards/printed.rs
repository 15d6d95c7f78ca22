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
                let squares =
                    (0..=self.rows()).flat_map(|row| (0..=self.cols()).map(move |col| [col, row]));
                squares.filter(|&square| !self.is_black(square)).collect()
            }
            Pattern::AprilGrid { .. } => {
                let (cols, rows) = (self.cols() / 2, self.rows() / 2);
                (0..rows).rev().flat_map(|row| (0..cols).map(move |col| [col, row])).collect()
            }
        }
    }

    /// Is this square, column and row from the upper left, one of the black ones?
    fn is_black(&self, [col, row]: [usize; 2]) -> bool {
        // Squares are one more than corners.
        let from_white =
            matches!(self.pattern(), Pattern::Charuco { legacy: true, .. }) && self.rows() % 2 == 1;
        (col + row + usize::from(from_white)).is_multiple_of(2)
    }

    /// The printed board, without a white rim: left, top, width, height in m from the first corner.
    #[must_use]
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
    #[must_use]
    pub fn black(&self) -> Vec<Rectangle> {
        let side = self.square();
        let place = |at: usize| (at as f64 - 1.0) * side;
        let squares =
            (0..=self.rows()).flat_map(|row| (0..=self.cols()).map(move |col| [col, row]));
        let squares = squares.filter(|&square| self.is_black(square));
        let squares = squares.map(|[col, row]| [place(col), place(row), side, side]);
        let marked = |markers: &mut dyn Iterator<Item = Vec<Rectangle>>| {
            markers.flatten().collect::<Vec<_>>()
        };
        let markers = self.markers().into_iter().enumerate();
        match self.pattern() {
            Pattern::Chessboard => squares.collect(),
            Pattern::Charuco { dictionary, marker, .. } => {
                let rim = side * (1.0 - marker) / 2.0;
                let drawn = |(id, [col, row]): (usize, [usize; 2])| {
                    marker_cells(
                        dictionary,
                        id,
                        RIMS[0],
                        false,
                        [place(col) + rim, place(row) + rim],
                        marker * side,
                    )
                };
                squares.chain(marked(&mut markers.map(drawn))).collect()
            }
            Pattern::AprilGrid { spacing } => {
                let Some(dictionary) = self.pattern().dictionary() else { return Vec::new() };
                let (gap, step) = (spacing * side, (1.0 + spacing) * side);
                let drawn = |(id, [col, row]): (usize, [usize; 2])| {
                    marker_cells(
                        dictionary,
                        id,
                        RIMS[1],
                        true,
                        [col as f64 * step, row as f64 * step],
                        side,
                    )
                };
                let corner = |i: usize| i as f64 * step - gap;
                let between = (0..=self.rows() / 2)
                    .flat_map(|row| (0..=self.cols() / 2).map(move |col| (col, row)));
                let between = between.map(|(col, row)| [corner(col), corner(row), gap, gap]);
                between.chain(marked(&mut markers.map(drawn))).collect()
            }
        }
    }
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
