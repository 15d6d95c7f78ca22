//! From photos of a board to a calibrated pair, and the file that keeps it.
//!
//! ```text
//! folder -> pairs of photos (photos) -> corners of the board (board, finder, corner; of boards with markers: markers, reader, charuco, april)
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
mod initial;
mod markers;
mod model;
mod photos;
mod quality;
mod reader;
mod summary;

pub use board::{Board, BoardCorners, BoardError};
pub use estimate::{
    BoardPair, CornerError, Dropped, Estimate, EstimateError, LEAST_CORNERS, LEAST_VIEWS, Options, Parameter,
    ViewReport, estimate,
};
pub use finder::{BoardFinder, JunctionFinder, NotFound};
pub use markers::{Dictionary, Pattern, Rectangle};
pub use model::LensModel;
pub use photos::{PhotoError, PhotoPair, find_pairs};
pub use quality::{Assessment, Coverage, Finding, Rectified, Verdict, assess};
pub use summary::{json, summary};
