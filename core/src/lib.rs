#![doc = include_str!("../README.md")]
//!
//! # Parameters
//!
//! [`Params`] holds the disparity range, the rig and the limits of a report. [`Matcher::new`]
//! checks them for an image size and does all floating-point work. [`Rig`] is the focal length, the
//! baseline and the principal point of a *rectified* pair: a point lies on the same row in both
//! images. The package `linestereo-rig` rectifies raw frames.
//!
//! # Matching
//!
//! [`Matcher::run`] takes a memory and two [`Gray`] images and gives a [`Matched`]. A matcher keeps
//! the health of the rig and the row offset from pair to pair. [`Matcher::run_with`] takes
//! [`Options`]: times of capture, areas that are matched, an observer of the stages.
//! [`Matcher::run_on`] shares the work with a second core or a thread ([`Cores`]).
//!
//! # Memory
//!
//! All memory is the caller's: one [`Memory`], an array of words. [`Capacity::words`] is its length
//! for a size of images. [`MemorySlice::new`] takes words whose number is known at run time.
//!
//! # Results
//!
//! - [`Matched::health`]: faults of the pair by name. A pair that is not fit knows no depths.
//! - [`Matched::segments`], most probable first, and [`Matched::points`]: everything credible.
//! - [`Matched::bars`]: poles and legs, in front of what is around them.
//! - [`Matched::object`]: the depth of a box or a mask ([`objects`]).
//! - [`Matched::pixel`]: the depth of one pixel.
//! - [`obstacles`]: the nearest obstacle of each direction, kept over pairs.
//! - [`Matched::ground`]: the floor, where one is seen.
//!
//! # Conventions
//!
//! Left is the reference image; disparity is `x_left - x_right`, 0 or more in front of the rig; x
//! grows right, y down, z forward; whole positions are pixel centres. Names of plain integers with
//! a fraction carry its bits: `cost_q8`, `slope_q12`, `d_q6` (1/64 px).
//!
//! # Same bits everywhere
//!
//! The result depends on the pixels, the parameters and the capacities of the lists alone: not on
//! the machine, the profile, the stride, or the previous content of the memory.
//!
//! # Features
//!
//! - `wide` (default): images wider than 450 px. Without it they are refused, and a program on a
//!   board is 7 KB smaller.
//! - `dsp`: the kernels for Cortex-M33 and above. Cortex-M4 and M7 always have them.
//! - `helium`: those for Cortex-M55 and M85.
//! - `defmt`: parameters, errors, health, depths and results implement `defmt::Format`.
//! - `serde`: matches, points, numbers of health, margins and parts can be serialized.
//! - `unstable`: inner loops, models and stages, for fits, tests and comparisons. What it shows may
//!   change with any version.
//!
//! No feature changes a number.
//!
//! # Stages
//!
//! For readers of the source; the feature `unstable` makes the stages visible to fits and tests.
//!
//! ```text
//! health      faults of the images and the rig, before and after matching
//! focus       the whole frame, or areas given by a detector
//! lines       edge drawing, straight segments; the most prominent of each square; row offset
//! ground      the plane of the floor, from single rows
//! support     a grid of points: codes, windows, three paths; where segments are searched
//! matching    each segment: window, census, edge; margin between them (Eq. 13); owners
//! confidence  evidence -> probability of being within 1 px
//! report      uniqueness constraint; depths (Eqs. 5, 12); points, one value a pixel
//! ```
#![no_std]
#![deny(unsafe_code)]
#![deny(missing_debug_implementations)]
#![warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg_attr(
    not(feature = "unstable"),
    allow(dead_code, unused_imports, unreachable_pub, reason = "only `unstable` shows it")
)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test may fail"))]

mod area;
mod bars;
mod confidence;
mod cores;
mod curve;
mod evidence;
mod fnv;
mod focus;
pub mod ground;
pub mod health;
pub mod image;
mod kernel;
mod lines;
#[allow(unsafe_code, reason = "elements beyond the length are not initialised")]
mod list;
mod matched;
mod matcher;
mod matching;
mod memory;
mod named;
pub mod objects;
mod observe;
pub mod obstacles;
pub mod params;
mod pipeline;
mod places;
mod plan;
mod query;
mod report;
mod result;
mod rig;
mod row_memory;
mod segment_stage;
mod side_pixels;
mod sort;
mod support;
pub mod units;

pub use area::Area;
pub use cores::{Cores, OneCore};
pub use fixed;
pub use image::{Dims, Gray};
pub use matched::Matched;
pub use matcher::{Matcher, Options};
pub use memory::{Capacity, Memory, MemorySlice, RunError};
pub use objects::{NoDepth, ObjectDepth, Region};
pub use params::{Params, Rig};

/// Results of a pair: segments, points, bars, support points, the depth of a pixel, counts.
pub mod results {
    pub use crate::bars::{Bar, MOST_BARS};
    pub use crate::query::{PixelDepth, PixelRejection};
    pub use crate::result::{
        Counts, ImagePosition, Match, Owner, Point, Rejection, Source, Techniques,
    };
    pub use crate::support::{Support, SupportPoint};
}

/// Evidence, models, stages of a run and inner loops, for fitting, tests and comparisons: it may
/// change with any version.
#[cfg(feature = "unstable")]
pub mod unstable {
    pub use crate::bars::evidence::{BAR_EVIDENCE, BarEvidence, BarKind};
    pub use crate::bars::{FITTED_BAR, FITTED_LEVEL_BAR, LEAST_BAR};
    pub use crate::confidence::{FITTED, Model, Models, NODES, Network, SigmaModel, UNITS, Unit};
    pub use crate::evidence::{NearbyEvidence, SEGMENT_EVIDENCE, SegmentEvidence, SegmentKind};
    pub use crate::fnv::Fnv;
    pub use crate::kernel::KERNELS;
    pub use crate::lines::Segment;
    pub use crate::list::List;
    pub use crate::matching::{
        Candidate, CurveKind, MAX_CENSUS_RATIO_Q8, MAX_SIDE_RATIO_Q8, MAX_SLANT_Q6,
        MAX_WINDOW_RATIO_Q8, SegmentCurves, Side,
    };
    pub use crate::observe::{Observer, Stage, StageDigests, StageEvent};
    pub use crate::query::{
        FITTED_PIXEL, LEFT_RIGHT_GAP_Q8, PIXEL_EVIDENCE, PixelEvidence, PixelKind, SECOND_BEST_Q8,
    };
    pub use crate::side_pixels::ValidPixels;
    pub use crate::support::SupportModels;
    pub use crate::support::context::{CONTEXT_EVIDENCE, ContextEvidence, ContextKind};
    pub use crate::support::evidence::{SUPPORT_EVIDENCE, SupportEvidence, SupportKind};
    pub use crate::support::{FITTED_SUPPORT, SUPPORT_PITCH, SupportCurves};

    /// Inner loops, portable and as chosen for this machine.
    pub mod kernel {
        pub use crate::kernel::*;
    }

    /// Edges and straight segments.
    pub mod lines {
        pub use crate::lines::*;
    }
}

/// An example with a pair whose depth is known.
#[cfg(doctest)]
#[doc = concat!("```\n", include_str!("../examples/drawn_pair.rs"), "\n```")]
struct DrawnPair;
