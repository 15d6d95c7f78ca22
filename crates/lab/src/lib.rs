//! Tools that judge the method: scores against truth, damaged pairs, other matchers on the same
//! frames, and the fits of confidence.
//!
//! ```text
//! evaluate   scores of results against ground truth
//! faults     damaged pairs, and what is answered of them
//! opencv     OpenCV's dense methods on a pair
//! rivals     the core beside OpenCV on the same frames
//! thin       poles pasted into pairs, and what is said of them
//! fitting    the confidence models, fitted on scores
//! bench      every data set of a folder, beside OpenCV, and against the last run
//! commands   the command line
//! ```

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests read what they wrote"))]

mod bench;
pub mod commands;
pub mod evaluate;
pub mod faults;
pub mod fitting;
mod opencv;
mod rivals;
mod thin;
