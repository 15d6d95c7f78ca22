//! Sparse stereo depth from line segments.
#![no_std]

mod image;
mod kernel;
mod lines;
mod matching;
mod pipeline;
mod result;
mod rig;
mod units;

pub use image::{Dims, Gray, MAX_HEIGHT, MAX_WIDTH, MIN_SIDE, ViewError};
pub use lines::Segment;
pub use matching::evidence::{EVIDENCE, Evidence, Kind};
pub use matching::{Candidate, Side};
pub use pipeline::{Output, ParamError, Params, Plan, Scratch, SizeMismatch};
pub use result::{Counts, Match, Owner, Point, PointClaim, Rejection, Techniques};
pub use rig::{Rig, RigError};
pub use units::{Confidence, Depth, Disparity, INFINITE_DEPTH, Position};
