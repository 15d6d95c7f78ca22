//! The board that is photographed, and how its corners are numbered.
//!
//! Corners of a board with markers are counted row by row from the upper left of the upright print:
//! the markers tell. Inner corners of a chessboard are counted row by row from a corner chosen so
//! that the numbering runs clockwise in the image (columns, then a right turn, then rows: a board
//! is never seen from behind) and, where the colours tell, so that the first four corners enclose a
//! dark square. A board with an odd and an even number of corners has one such numbering. On others
//! two or four are left: the one whose rows run most to the right is taken, and the right image
//! follows the left one ([`BoardCorners::turned_like`]).

use super::markers::{Dictionary, Pattern};
use core::fmt;
use linestereo_frames::GrayImage;
use std::collections::BTreeMap;

/// Corners along one side: fewer say too little about a lens, more are a slip of the hand.
const SIDE: core::ops::RangeInclusive<u8> = 3..=60;

/// Squares and tags along one side of boards with markers.
const SQUARES: core::ops::RangeInclusive<u8> = 3..=60;
const TAGS: core::ops::RangeInclusive<u8> = 2..=30;
/// Side of a marker as the share of its square: below, it has no pixels left; above, its square has
/// no white rim.
const MARKER: core::ops::RangeInclusive<f64> = 0.3..=0.95;
/// Gap between tags as the share of their side.
const SPACING: core::ops::RangeInclusive<f64> = 0.1..=1.0;

/// A flat board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Board {
    cols: u8,
    rows: u8,
    square_m: f64,
    pattern: Pattern,
}

/// Why there is no such board.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BoardError {
    /// A side has fewer than 3 or more than 60 inner corners.
    #[error("a board has 3 to 60 inner corners along each side, not {0}")]
    Side(u8),
    /// The squares' side is outside 0.0001 ..= 10 m.
    #[error("squares or tags of {} mm are outside 0.1 mm to 10 m", 1e3 * .0)]
    Square(f64),
    /// A side has fewer or more squares than a board with markers may have.
    #[error("a ChArUco board has 3 to 60 squares along each side, not {0}")]
    Squares(u8),
    /// A side has fewer or more tags than a board may have.
    #[error("an AprilGrid has 2 to 30 tags along each side, not {0}")]
    Tags(u8),
    /// A marker's side is outside 0.3 ..= 0.95 of its square's.
    #[error("a marker's side is 0.3 to 0.95 of its square's, not {0:.2}")]
    Marker(f64),
    /// The gap between tags is outside 0.1 ..= 1 of their side.
    #[error("the gap between tags is 0.1 to 1 of their side, not {0}")]
    Spacing(f64),
    /// The board has more markers than the dictionary: needed, there.
    #[error("the board needs {0} markers, the dictionary has {1}")]
    Dictionary(usize, usize),
}

impl Board {
    /// A board from its inner corners (one less than squares) along each side and the side of a
    /// square in metres.
    pub fn new(cols: u8, rows: u8, square_m: f64) -> Result<Self, BoardError> {
        if let Some(side) = [cols, rows].into_iter().find(|side| !SIDE.contains(side)) {
            return Err(BoardError::Side(side));
        }
        Self { cols, rows, square_m, pattern: Pattern::Chessboard }.checked()
    }

    /// A ChArUco board from its squares along each side, as OpenCV counts them, and the sides of a
    /// square and of a marker in metres.
    pub fn charuco(
        [cols, rows]: [u8; 2],
        square_m: f64,
        marker_m: f64,
        dictionary: Dictionary,
        legacy: bool,
    ) -> Result<Self, BoardError> {
        if let Some(side) = [cols, rows].into_iter().find(|side| !SQUARES.contains(side)) {
            return Err(BoardError::Squares(side));
        }
        let marker = marker_m / square_m;
        let pattern = Pattern::Charuco { dictionary, marker, legacy };
        let board = Self { cols: cols - 1, rows: rows - 1, square_m, pattern }.checked()?;
        if !MARKER.contains(&marker) {
            return Err(BoardError::Marker(marker));
        }
        Ok(board)
    }

    /// An AprilGrid from its tags along each side, the side of a tag in metres, and the gap between
    /// tags as a share of it.
    pub fn april_grid([cols, rows]: [u8; 2], tag_m: f64, spacing: f64) -> Result<Self, BoardError> {
        if let Some(side) = [cols, rows].into_iter().find(|side| !TAGS.contains(side)) {
            return Err(BoardError::Tags(side));
        }
        if !SPACING.contains(&spacing) {
            return Err(BoardError::Spacing(spacing));
        }
        let pattern = Pattern::AprilGrid { spacing };
        Self { cols: 2 * cols, rows: 2 * rows, square_m: tag_m, pattern }.checked()
    }

    fn checked(self) -> Result<Self, BoardError> {
        if !(1e-4..=10.0).contains(&self.square_m) {
            return Err(BoardError::Square(self.square_m));
        }
        let needed = self.markers().len();
        match self.pattern.dictionary() {
            Some(dictionary) if dictionary.len() < needed => {
                Err(BoardError::Dictionary(needed, dictionary.len()))
            }
            _ => Ok(self),
        }
    }

    /// Squares and markers that are printed on it.
    pub fn pattern(&self) -> Pattern {
        self.pattern
    }

    /// Side of a square, of an AprilGrid of a tag, m.
    pub fn square(&self) -> f64 {
        self.square_m
    }

    /// Corners in a row.
    pub fn cols(&self) -> usize {
        self.cols.into()
    }

    /// Corners in a column.
    pub fn rows(&self) -> usize {
        self.rows.into()
    }

    /// All corners.
    pub fn corners(&self) -> usize {
        self.cols() * self.rows()
    }

    /// Places of the corners on the board, row by row, in metres from the first.
    pub fn points(&self) -> Vec<[f64; 2]> {
        let steps = |step: usize| match self.pattern {
            Pattern::AprilGrid { spacing } => {
                (step / 2) as f64 * (1.0 + spacing) + (step % 2) as f64
            }
            _ => step as f64,
        };
        let place = |index: usize| {
            [index % self.cols(), index / self.cols()].map(|step| steps(step) * self.square_m)
        };
        (0..self.corners()).map(place).collect()
    }
}

/// As the command line takes it.
impl fmt::Display for Board {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.pattern {
            Pattern::Chessboard => write!(f, "{}x{}", self.cols, self.rows),
            Pattern::Charuco { .. } => write!(f, "charuco:{}x{}", self.cols + 1, self.rows + 1),
            Pattern::AprilGrid { .. } => write!(f, "aprilgrid:{}x{}", self.cols / 2, self.rows / 2),
        }
    }
}

/// Corners of a board in one image, px: all of a chessboard's, row by row; of a board with markers
/// those that are seen.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardCorners {
    cols: usize,
    rows: usize,
    corners: Vec<[f64; 2]>,
    /// Their numbers on the board, ascending, where markers tell.
    numbers: Option<Vec<usize>>,
}

impl BoardCorners {
    /// Corners of a board in any of its numberings, as they stand in `image`; `None` unless there
    /// are `cols * rows` of them.
    pub fn new(
        image: &GrayImage,
        cols: usize,
        rows: usize,
        corners: Vec<[f64; 2]>,
    ) -> Option<Self> {
        if cols < 2 || rows < 2 || corners.len() != cols * rows {
            return None;
        }
        let mut found = Self { cols, rows, corners, numbers: None };
        if found.area() < 0.0 {
            found = found.mirrored();
        }
        let options = found.turns();
        let dark: Vec<Self> =
            options.iter().filter(|option| option.starts_dark(image)).cloned().collect();
        let rightmost = |a: &&Self, b: &&Self| a.direction()[0].total_cmp(&b.direction()[0]);
        let chosen = if dark.is_empty() { &options } else { &dark };
        chosen.iter().max_by(rightmost).cloned()
    }

    /// Numbered corners of a board with markers.
    pub(super) fn numbered(board: &Board, corners: BTreeMap<usize, [f64; 2]>) -> Self {
        let (numbers, corners) = corners.into_iter().unzip();
        Self { cols: board.cols(), rows: board.rows(), corners, numbers: Some(numbers) }
    }

    /// Corners that are seen.
    #[expect(clippy::len_without_is_empty, reason = "without corners there are none of these")]
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// The numbering nearest to that of the other image among those the board's own symmetry leaves
    /// open.
    #[must_use]
    pub fn turned_like(self, other: &Self) -> Self {
        if (self.cols + self.rows) % 2 == 1 || self.numbers.is_some() {
            return self; // the colours or the markers have told
        }
        let [x, y] = other.direction();
        let along = |option: &Self| option.direction()[0] * x + option.direction()[1] * y;
        let half = self.turns().into_iter().filter(|option| option.cols == other.cols);
        // A quarter turn of a square board of odd sides exchanges the colours; half a turn never
        // does.
        let quarter = self.cols.is_multiple_of(2);
        let allowed =
            half.enumerate().filter(|(turn, _)| quarter || turn % 2 == 0 || self.cols != self.rows);
        allowed
            .map(|(_, option)| option)
            .max_by(|a, b| along(a).total_cmp(&along(b)))
            .unwrap_or(self)
    }

    /// Numbers of the corners on the board, ascending, and the corners.
    #[must_use]
    pub fn into_inner(self) -> (Vec<usize>, Vec<[f64; 2]>) {
        (self.numbers.unwrap_or_else(|| (0..self.corners.len()).collect()), self.corners)
    }

    fn at(&self, col: usize, row: usize) -> [f64; 2] {
        self.corners[row * self.cols + col]
    }

    /// Unit vector along the rows, from the first column to the last.
    fn direction(&self) -> [f64; 2] {
        let sum = |col: usize, axis: usize| {
            (0..self.rows).map(|row| self.at(col, row)[axis]).sum::<f64>()
        };
        let [x, y] = [0, 1].map(|axis| sum(self.cols - 1, axis) - sum(0, axis));
        let length = x.hypot(y).max(1e-9);
        [x / length, y / length]
    }

    /// Twice the area of the outer quadrilateral, positive when rows follow columns clockwise.
    fn area(&self) -> f64 {
        let (c, r) = (self.cols - 1, self.rows - 1);
        let round = [self.at(0, 0), self.at(c, 0), self.at(c, r), self.at(0, r)];
        (0..4).map(|i| (round[i], round[(i + 1) % 4])).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
    }

    fn mirrored(&self) -> Self {
        let corners = (0..self.corners.len())
            .map(|i| self.at(self.cols - 1 - i % self.cols, i / self.cols))
            .collect();
        Self { corners, numbers: None, ..*self }
    }

    fn quarter_turn(&self) -> Self {
        let (cols, rows) = (self.rows, self.cols);
        let corners =
            (0..cols * rows).map(|i| self.at(i / cols, self.rows - 1 - i % cols)).collect();
        Self { cols, rows, corners, numbers: None }
    }

    /// This numbering and those a quarter, a half and three quarters of a turn away, as far as they
    /// keep the sides.
    fn turns(&self) -> Vec<Self> {
        let quarter = self.quarter_turn();
        let half = quarter.quarter_turn();
        let last = half.quarter_turn();
        if self.cols == self.rows {
            vec![self.clone(), quarter, half, last]
        } else {
            vec![self.clone(), half]
        }
    }

    /// Is the square between the first four corners one of the dark ones?
    fn starts_dark(&self, image: &GrayImage) -> bool {
        let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
        for row in 0..self.rows - 1 {
            for col in 0..self.cols - 1 {
                let around =
                    [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| self.at(col + i, row + j));
                let [x, y] =
                    [0, 1].map(|axis| around.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0);
                let parity = (row + col) % 2;
                if let Some(grey) = grey_at(image, x, y) {
                    sums[parity] += grey;
                    counts[parity] += 1.0;
                }
            }
        }
        sums[0] * f64::max(counts[1], 1.0) < sums[1] * f64::max(counts[0], 1.0)
    }
}

/// Mean of the 3x3 pixels around the nearest pixel.
fn grey_at(image: &GrayImage, x: f64, y: f64) -> Option<f64> {
    let (width, height) = (usize::from(image.dims.width), usize::from(image.dims.height));
    let inside =
        |v: f64, side: usize| (v >= 1.0 && v < side as f64 - 2.0).then_some(v.round() as usize);
    let (x, y) = (inside(x, width)?, inside(y, height)?);
    let rows =
        (y - 1..=y + 1).flat_map(|row| &image.pixels[row * width + x - 1..=row * width + x + 1]);
    Some(rows.map(|&pixel| f64::from(pixel)).sum::<f64>() / 9.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use linestereo::Dims;

    /// A board of 10-px squares, the first dark, whose first inner corner is at (30, 30), and its
    /// corners.
    fn drawn(cols: usize, rows: usize) -> (GrayImage, Vec<[f64; 2]>) {
        let dims = Dims { width: 160, height: 160 };
        let dark = |x: usize, y: usize| (x / 10 + y / 10).is_multiple_of(2);
        let pixels =
            (0..160 * 160).map(|i| if dark(i % 160, i / 160) { 20 } else { 230 }).collect();
        let corners = (0..cols * rows)
            .map(|i| [29.5 + 10.0 * (i % cols) as f64, 29.5 + 10.0 * (i / cols) as f64]);
        (GrayImage { dims, pixels }, corners.collect())
    }

    #[test]
    fn every_numbering_becomes_the_same() {
        for (cols, rows) in [(9, 6), (6, 9), (7, 7), (8, 6), (6, 6), (7, 5)] {
            let (image, corners) = drawn(cols, rows);
            let right = BoardCorners::new(&image, cols, rows, corners.clone()).unwrap();
            assert_eq!(right.corners, corners, "{cols}x{rows}");
            let mut turned = right.clone();
            for _ in 0..4 {
                for given in [turned.clone(), turned.mirrored()] {
                    if (given.cols, given.rows) == (cols, rows) {
                        let found = BoardCorners::new(&image, cols, rows, given.corners).unwrap();
                        assert_eq!(found, right, "{cols}x{rows}");
                        assert_eq!(found.turned_like(&right), right, "{cols}x{rows}");
                    }
                }
                turned = turned.quarter_turn();
            }
        }
    }
}
