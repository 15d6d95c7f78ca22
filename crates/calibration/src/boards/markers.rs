//! Kinds of boards, and the dictionaries of the markers that number their corners.
//!
//! ```text
//! ChArUco     OpenCV's: markers in the white squares, numbered row by row. The upper left square
//!             is black, but white in the legacy pattern (before OpenCV 4.6) of boards with an even
//!             number of rows
//! AprilGrid   Kalibr's: tags of the family 36h11 with a black rim of two cells, numbered row by
//!             row from the lower left, and a black square at each of their corners, so that these
//!             are corners of a chessboard
//! ```
//!
//! # Source
//! The dictionaries are those of the crate `calib-targets-aruco`: OpenCV's.

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
    pub fn named(name: &str) -> Option<Self> {
        calib_targets_aruco::resolve_dictionary(name).map(Self)
    }

    /// All names.
    pub fn names() -> &'static [&'static str] {
        BUILTIN_DICTIONARY_NAMES
    }

    /// OpenCV's name.
    pub fn name(&self) -> &'static str {
        self.0.name()
    }

    pub(super) fn len(&self) -> usize {
        self.0.codes().len()
    }

    pub(super) fn inner(&self) -> calib_targets_aruco::Dictionary {
        self.0
    }

    /// Cells along a side without the rim.
    pub(super) fn side(&self) -> usize {
        self.0.marker_size()
    }

    pub(super) fn is_dark(&self, id: usize, col: usize, row: usize) -> bool {
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
    pub(super) fn dictionary(&self) -> Option<Dictionary> {
        match self {
            Self::Chessboard => None,
            Self::Charuco { dictionary, .. } => Some(*dictionary),
            Self::AprilGrid { .. } => Dictionary::named(TAGS),
        }
    }
}
