//! What is printed on a board: squares, and markers that number its corners.
//!
//! ```text
//! ChArUco     OpenCV's: markers in the white squares, numbered row by row. The upper left square is black, but white in the legacy pattern
//!             (before OpenCV 4.6) of boards with an even number of rows
//! AprilGrid   Kalibr's: tags of the family 36h11 with a black rim of two cells, numbered row by row from the lower left, and a black
//!             square at each of their corners, so that these are corners of a chessboard
//! ```
//!
//! # Source
//! The dictionaries are those of the crate `calib-targets-aruco`: OpenCV's.

use super::board::Board;
use calib_targets_aruco::builtins::BUILTIN_DICTIONARY_NAMES;

/// Cells of the black rim around a marker's bits: of ArUco, and of Kalibr's tags.
pub(super) const RIMS: [usize; 2] = [1, 2];
/// The family of an AprilGrid's tags.
const TAGS: &str = "DICT_APRILTAG_36h11";

/// A set of markers, known by OpenCV's name.
#[derive(Clone, Copy, Debug)]
pub struct Dictionary(calib_targets_aruco::Dictionary);

impl Dictionary {
    /// By its name, `DICT_5X5_100` or `5X5_100`; `None` where there is no such.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        calib_targets_aruco::resolve_dictionary(name).map(Self)
    }

    /// All names.
    #[must_use]
    pub fn names() -> &'static [&'static str] {
        BUILTIN_DICTIONARY_NAMES
    }

    /// OpenCV's name.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.0.name()
    }

    /// Markers in it.
    pub(super) fn len(&self) -> usize {
        self.0.codes().len()
    }

    pub(super) fn inner(&self) -> calib_targets_aruco::Dictionary {
        self.0
    }

    /// Cells along a side without the rim.
    fn side(&self) -> usize {
        self.0.marker_size()
    }

    fn is_dark(&self, id: usize, col: usize, row: usize) -> bool {
        self.0.codes()[id] >> (row * self.side() + col) & 1 == 1
    }
}

impl PartialEq for Dictionary {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// Kind of a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pattern {
    /// Squares alone.
    Chessboard,
    /// A chessboard with markers in its white squares.
    Charuco {
        /// Where the markers are from.
        dictionary: Dictionary,
        /// Side of a marker as the share of a square's.
        marker: f64,
        /// The pattern of OpenCV before 4.6.
        legacy: bool,
    },
    /// Tags with a black square at each corner.
    AprilGrid {
        /// Gap between tags as the share of their side.
        spacing: f64,
    },
}

impl Pattern {
    /// Where its markers are from.
    pub(super) fn dictionary(&self) -> Option<Dictionary> {
        match self {
            Self::Chessboard => None,
            Self::Charuco { dictionary, .. } => Some(*dictionary),
            Self::AprilGrid { .. } => Dictionary::named(TAGS),
        }
    }
}

/// Left, top, width, height, m, from the first corner.
pub type Rectangle = [f64; 4];

impl Board {
    /// Square (of an AprilGrid tag) of each marker, column and row from the upper left, by its number.
    pub(super) fn markers(&self) -> Vec<[usize; 2]> {
        match self.pattern() {
            Pattern::Chessboard => Vec::new(),
            Pattern::Charuco { .. } => {
                let squares = (0..=self.rows()).flat_map(|row| (0..=self.cols()).map(move |col| [col, row]));
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
        let from_white = matches!(self.pattern(), Pattern::Charuco { legacy: true, .. }) && self.rows() % 2 == 1;
        (col + row + usize::from(from_white)).is_multiple_of(2)
    }

    /// The printed board, without a white rim: left, top, width, height in m from the first corner.
    #[must_use]
    pub fn extent(&self) -> Rectangle {
        let side = self.square();
        match self.pattern() {
            Pattern::AprilGrid { spacing } => {
                let length = |corners: usize| side * ((corners / 2) as f64 * (1.0 + spacing) + spacing);
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
        let squares = (0..=self.rows()).flat_map(|row| (0..=self.cols()).map(move |col| [col, row]));
        let squares = squares.filter(|&square| self.is_black(square));
        let squares = squares.map(|[col, row]| [place(col), place(row), side, side]);
        let marked = |markers: &mut dyn Iterator<Item = Vec<Rectangle>>| markers.flatten().collect::<Vec<_>>();
        let markers = self.markers().into_iter().enumerate();
        match self.pattern() {
            Pattern::Chessboard => squares.collect(),
            Pattern::Charuco { dictionary, marker, .. } => {
                let rim = side * (1.0 - marker) / 2.0;
                let drawn = |(id, [col, row]): (usize, [usize; 2])| {
                    marker_cells(dictionary, id, RIMS[0], false, [place(col) + rim, place(row) + rim], marker * side)
                };
                squares.chain(marked(&mut markers.map(drawn))).collect()
            }
            Pattern::AprilGrid { spacing } => {
                let Some(dictionary) = self.pattern().dictionary() else { return Vec::new() };
                let (gap, step) = (spacing * side, (1.0 + spacing) * side);
                let drawn = |(id, [col, row]): (usize, [usize; 2])| {
                    marker_cells(dictionary, id, RIMS[1], true, [col as f64 * step, row as f64 * step], side)
                };
                let corner = |i: usize| i as f64 * step - gap;
                let between = (0..=self.rows() / 2).flat_map(|row| (0..=self.cols() / 2).map(move |col| (col, row)));
                let between = between.map(|(col, row)| [corner(col), corner(row), gap, gap]);
                between.chain(marked(&mut markers.map(drawn))).collect()
            }
        }
    }
}

/// A marker's black cells, neighbours in a row as one; `turned` by half a turn, as Kalibr prints tags.
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
                black.push([left + col as f64 * cell, top + row as f64 * cell, run as f64 * cell, cell]);
            }
            col += run + 1;
        }
    }
    black
}
