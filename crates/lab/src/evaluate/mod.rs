//! Scores of results against ground truth, in words that mean one thing only.
//!
//! - **point**: one pixel for which a disparity is reported. **bad1 / bad2**: share of points more
//!   than 1 / 2 px off the truth.
//! - **vis**: only points whose true match is visible in the right image. **allGT**: every point
//!   that has truth, so that a value reported for a hidden pixel counts as wrong unless it happens
//!   to be right.
//! - **segprec@1 / @2**: share of reported segments whose median error along the segment is at most
//!   1 / 2 px; the error at a pixel is the distance to the nearest truth within +-1 px across the
//!   edge.
//! - **owned middle**: a segment's disparity at its middle against the surface on the side that
//!   owns it.
//! - **cells**: 16x16 px; a cell counts when at least half of it has visible truth and is covered
//!   when it holds an answer.
//! - **one answer per cell**: as `bench` defines it.
//! - Points and segments without any truth are neither right nor wrong: they are in the yields per
//!   frame and in nothing else.
//!
//! - Objects: `objects` says what is wrong and covered there.
//!
//! [`FrameScore::new`] scores one frame, [`Summary::pool`] any number of them together.

mod frame;
mod objects;
mod owner;
mod pixels;
mod summary;
mod table;

pub use frame::{FrameScore, PointScore};
pub use objects::{ObjectCase, ObjectScore, ObjectSummary, Outline, object_cases, score_objects};
pub use owner::OwnedMiddle;
pub use pixels::{PixelScore, QueriedPixel, query_pixels};
pub use summary::{Answers, BinRow, CellRow, ErrorRates, Summary, YIELDS, YieldRow};
pub(crate) use table::{calibration_table, cell_table, pair};
