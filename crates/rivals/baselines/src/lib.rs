//! The classic methods of the chapter's background, as rivals on the same frames: slow or fast, they are made with care.
//!
//! In: a rectified pair and how many disparities to search. Out: a [`DisparityMap`].
//!
//! ```text
//! cost      SSD, SAD, NCC, both on normalised patches, rank, census, gradient          CostKind, one trait
//! window    any odd size, rectangle or cross, by sliding sums                          Window, for_each_row
//! method    block matching           BlockMatcher, StereoBm (OpenCV's, number for number)
//!           dynamic programming      ScanLineMatcher
//!           semi-global              SemiGlobalMatcher, 4 or 8 paths
//!           one disparity            PushbroomMatcher
//!           peaks of the gradient    SparseBlockMatcher
//! reading   fraction, uniqueness, left-right check                                     Acceptance
//! after     gradient descent, median, speckles, filling of gaps                        AfterStep
//! ```
//! All of them answer only where the whole range of disparities lies inside the right image, as OpenCV does: a pixel with half a range
//! looks more unique than it is.
//!
//! A package of its own, so that it can be compiled as one unit, like the core: in pieces that do not see into each other these loops
//! take two to ten times as long, and a comparison would flatter us.

mod after;
mod block;
mod cost;
mod curve;
mod map;
mod method;
mod pushbroom;
mod scan_line;
mod search;
mod semi_global;
mod sparse_block;
mod stereo_bm;
mod sums;
mod window;

pub use after::{AfterStep, descend, fill_from_neighbours, fill_surfaces, median, remove_speckles};
pub use block::BlockMatcher;
pub use cost::{Cost, CostKind};
pub use curve::{Acceptance, Fraction, Minimum};
pub use map::DisparityMap;
pub use method::{Matcher, Method};
pub use pushbroom::PushbroomMatcher;
pub use scan_line::ScanLineMatcher;
pub use search::Search;
pub use semi_global::{Paths, SemiGlobalMatcher};
pub use sparse_block::SparseBlockMatcher;
pub use stereo_bm::{StereoBm, StereoBmError};
pub use sums::{CurveRow, for_each_row};
pub use window::{Shape, Window};
