//! Dense stereo methods as rivals of the core on the same frames.
//!
//! In: a rectified pair and how many disparities to search. Out: a [`DisparityMap`].
//!
//! ```text
//! bm, bm-strict        OpenCV's StereoBM, number for number; the oracle of the boards' block
//!                      matcher
//! census               block matching on census codes
//! sgm8, sgm8-strict    semi-global matching along eight paths on census codes
//! ```
//! All of them answer only where the whole range of disparities lies inside the right image, as
//! OpenCV does: a pixel with half a range looks more unique than it is.
//!
//! This is a package so that it is compiled as one unit, like the core. In pieces these loops take
//! two to ten times as long, and a comparison would flatter us.

mod census;
mod curve;
mod map;
mod method;
mod search;
mod semi_global;
mod stereo_bm;
mod windows;

pub use map::DisparityMap;
pub use method::Method;
pub use search::Search;
pub use stereo_bm::StereoBm;
