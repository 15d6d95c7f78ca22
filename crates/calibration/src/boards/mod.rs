//! From photos of a board to a calibrated pair, and the file that keeps it.
//!
//! ```text
//! folder -> pairs of photos (photos) -> corners of the board (board, finder, grid, corner; of
//!     boards with markers: markers, reader,
//!                                                      charuco, april; printed)
//!        -> cameras, pose and their spread (initial, model, bundle, estimate)
//!        -> what they are worth (quality) -> a report (summary)
//! ```

mod april;
mod board;
mod bundle;
mod charuco;
mod corner;
mod estimate;
mod finder;
mod grid;
mod initial;
mod markers;
mod model;
mod photos;
mod printed;
mod quality;
mod reader;
mod summary;

pub use crate::interchange::LensModel;
pub use board::{Board, BoardCorners, BoardError};
pub use estimate::{
    BoardPair, CornerError, Dropped, Estimate, EstimateError, LEAST_CORNERS, LEAST_VIEWS, Options,
    Parameter, ViewReport, estimate,
};
pub use finder::{BoardFinder, JunctionFinder};
pub use grid::NotFound;
pub use markers::{Dictionary, Pattern};
pub use photos::{PhotoError, PhotoPair, find_pairs};
pub use printed::Rectangle;
pub use quality::{Assessment, Coverage, Finding, Rectified, Verdict, assess};
pub use summary::{json, summary};
