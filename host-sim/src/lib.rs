//! The linestereo core on a PC: captured frames, synthetic scenes, evaluation, pictures.
//!
//! Each module uses only those above it, and those of its line:
//!
//! ```text
//! interruption, output, programs   Ctrl-C; files written whole; other programs of this machine
//! registry, scene_folder, engine   pairs that registries carry; rendered ones as files; the core run
//! results, monitor, explain        what a pair gave; what a board reports of it; why a pixel has a
//!                                  depth, or none
//! board, quality, planning         boards driven; depths of a wall; rig planning
//! draw, report, serve              pictures; pages; a page for browsers of this computer, with
//!                                  events
//! commands                         the command line
//! ```

#![allow(
    missing_docs,
    reason = "modules of a program, not an interface: a name that says it all stands alone"
)]
#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests read what they wrote"))]

pub mod board;
pub mod commands;
pub mod draw;
pub mod engine;
pub mod explain;
pub mod interruption;
pub mod monitor;
pub mod output;
pub mod planning;
mod programs;
pub mod quality;
pub mod registry;
pub mod report;
pub mod results;
pub mod scene_folder;
pub mod serve;

pub use linestereo_scenes as scene;

/// The example of the package's page.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
