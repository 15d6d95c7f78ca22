//! Sparse stereo depth from line segments.
#![no_std]

mod claims;
mod confidence;
mod image;
pub mod kernel;
pub mod lines;
mod matching;
mod params;
mod pipeline;
mod report;
mod result;
mod rig;
mod sort;
mod units;

pub use confidence::{FITTED, Model, Models, NODES};
pub use image::{Dims, Gray, MAX_HEIGHT, MAX_WIDTH, MIN_SIDE, ViewError};
pub use lines::Segment;
pub use matching::band::row_bytes;
pub use matching::evidence::{EVIDENCE, Evidence, Kind};
pub use matching::{Candidate, Side};
pub use params::{Margin, ParamError, Params};
pub use pipeline::{Output, Plan, Scratch, SizeMismatch, mark_words};
pub use result::{Counts, Match, Owner, Point, PointClaim, Rejection, Techniques};
pub use rig::{Rig, RigError};
pub use units::{Confidence, Depth, Disparity, INFINITE_DEPTH, Position};
