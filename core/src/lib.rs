//! Sparse stereo depth from line segments and support points, for microcontrollers: `no_std`, no allocation, integer arithmetic per frame.
//!
//! Dense stereo computes every pixel, and many of its disparities are wrong. Line segments are few and prominent; a sparse grid of support
//! points, matched semi-globally, covers the surfaces between them and limits the disparities at which segments are searched. Each segment is
//! matched by a window and by census, which have to agree, and by the edge itself in the right image, which is evidence. Every disparity has a
//! probability; those below a limit are not reported.
//!
//! ```text
//! Params -> plan -> Plan            once: every check, every float
//!
//! left, right                       per pair, rectified (the package `linestereo-rig` does that): integers only, memory is the caller's
//!   health      faults of the images and the rig, before and after matching
//!   focus       the whole frame, or areas given by a detector
//!   lines       edge drawing, straight runs with sub-pixel ends; the most prominent of each square; row offset of the pair
//!   support     a grid of points: ranks, windows, three paths; their disparities limit the search range of segments
//!   matching    per segment: window, census, halves, the edge in the right image near that disparity, owners;
//!               margin between the techniques (Eq. 13); evidence between segments and support points nearby
//!   confidence  evidence -> probability of being within 1 px
//!   report      uniqueness constraint; matches with depth in metres (Eqs. 5, 12), and points, one value a pixel
//! on demand                         from the candidates and support points of the last pair
//!   objects     the depth of boxes and masks
//!   query       the depth of one pixel
//!   obstacles   the nearest obstacle of each direction, kept over pairs
//! ```
//!
//! ```
#![doc = include_str!("../examples/drawn_pair.rs")]
//! ```
//!
//! # Conventions
//! Left is the reference image; disparity is `x_left - x_right`, 0 or more in front of the rig; x grows right, y down, z forward; whole
//! positions are pixel centres. Names of plain integers with a fraction carry its bits: `cost_q8`, `slope_q12`, `d_q6` (1/64 px).
//!
//! # Same bits everywhere
//! The result depends on the pixels, the parameters and the capacities of the lists alone: not on the machine, the profile, the stride, or the
//! previous content of the memory.
//! # Features
//! - `dsp`: the kernels for Cortex-M33 and above.
//! - `defmt`: parameters, errors, health, depths and results implement `defmt::Format`.
//! - `serde`: matches, points, numbers of health, margins and parts can be serialized.
//!
//! None of them changes a number.
#![no_std]
#![deny(unsafe_code)]
#![deny(missing_debug_implementations)]
#![warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "a test may fail"))]

mod area;
mod confidence;
mod curve;
mod evidence;
mod fnv;
mod focus;
pub mod ground;
pub mod health;
pub mod image;
#[doc(hidden)] // re-exported in `diagnostics`
pub mod kernel;
#[doc(hidden)] // re-exported in `diagnostics`
pub mod lines;
mod matched;
mod matcher;
mod matching;
pub mod objects;
mod observe;
pub mod obstacles;
mod params;
mod pipeline;
mod plan;
mod query;
mod report;
mod result;
mod rig;
mod row_memory;
pub mod scratch;
mod side_pixels;
mod sort;
mod support;
mod units;

pub use area::Area;
pub use focus::Focus;
pub use ground::{GroundPlane, GroundSearch};
pub use health::{HealthFlags, HealthLimits, PairHealth};
pub use image::{Dims, Gray, Span};
pub use kernel::KERNELS;
pub use matched::{Matched, Summary};
pub use matcher::{Matcher, Pair};
pub use objects::{NoDepth, ObjectDepth, Region, RegionError};
pub use params::{Margin, ParamError, Params, Parts};
pub use plan::Plan;
pub use query::{PixelDepth, PixelRejection};
pub use result::{Counts, ImagePosition, Match, Owner, Point, Rejection, Source};
pub use rig::{Rig, RigError};
pub use scratch::{RunError, Scratch, ScratchView};
pub use support::{Support, SupportPoint};
pub use units::{Confidence, Depth, Disparity, INFINITE_DEPTH, Position};

/// Evidence, models, stages of a run and inner loops, for fitting, tests and comparisons.
pub mod diagnostics {
    pub use crate::confidence::{FITTED, Model, Models, NODES};
    pub use crate::evidence::{SEGMENT_EVIDENCE, SegmentEvidence, SegmentKind};
    pub use crate::fnv::Fnv;
    pub use crate::lines::Segment;
    pub use crate::matching::{
        Candidate, CurveKind, MAX_CENSUS_RATIO_Q8, MAX_SIDE_RATIO_Q8, MAX_SLANT_Q6, MAX_WINDOW_RATIO_Q8, SegmentCurves,
        Side,
    };
    pub use crate::observe::{Observer, Stage, StageDigests, StageEvent};
    pub use crate::query::{FITTED_PIXEL, LEFT_RIGHT_GAP_Q8, PIXEL_EVIDENCE, PixelEvidence, PixelKind, SECOND_BEST_Q8};
    pub use crate::result::Techniques;
    pub use crate::side_pixels::ValidPixels;
    pub use crate::support::SupportModels;
    pub use crate::support::evidence::{SUPPORT_EVIDENCE, SupportEvidence, SupportKind};
    pub use crate::support::{FITTED_SUPPORT, SUPPORT_PITCH, SupportCurves};
    pub use crate::{kernel, lines};
}
