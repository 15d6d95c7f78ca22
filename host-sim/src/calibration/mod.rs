//! From photos of a board to a calibrated pair, and the file that keeps it.
//!
//! ```text
//! folder -> pairs of photos (photos) -> corners of the board (board, finder, corner)
//!        -> cameras, pose and their spread (initial, model, bundle, estimate)
//!        -> what they are worth (quality) -> a report (summary)
//! ```

mod board;
mod bundle;
mod corner;
mod estimate;
mod finder;
mod initial;
mod model;
mod photos;
mod quality;
mod summary;

pub use board::{Board, BoardCorners, BoardError};
pub use estimate::{
    BoardPair, CornerError, Dropped, Estimate, EstimateError, LEAST_VIEWS, Options, Parameter, ViewReport, estimate,
};
pub use finder::{BoardFinder, ChessFinder, NotFound};
pub use model::LensModel;
pub use photos::{PhotoError, PhotoPair, find_pairs};
pub use quality::{Assessment, Coverage, Finding, Rectified, Verdict, assess};
pub use summary::{json, summary};
