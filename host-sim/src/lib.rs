//! The linestereo core on a PC: captured frames, synthetic scenes, evaluation, pictures.
//!
//! Each module uses only those above it, and those of its line:
//!
//! ```text
//! untrusted                 files of others: how much of one is read
//! interruption, output      Ctrl-C; files written whole
//! mcap, ros                 recordings: the container; the messages of ROS 2
//! video                     frames of videos and cameras
//! programs                  other programs of this machine
//! statistics                middles and shares of lists
//! input, scene, engine      frames, rigs and objects read; scenes rendered; the core run
//! results, monitor          what a pair gave, as JSON, text and files; what a board reports of it
//! explain                   why a pixel has a depth, or none
//! board, evaluate           boards driven; scores against truth
//! faults                    damaged pairs, and what is answered of them
//! rivals, fitting           other methods on the same frames; the confidence models fitted
//! calibration, planning     rigs from photos; rigs from wishes
//! draw, report              pictures; pages
//! serve                     a page for browsers of this computer, with events
//! commands                  the command line
//! ```

#![allow(missing_docs, reason = "modules of a program, not an interface: a name that says it all stands alone")]
#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests read what they wrote"))]

pub mod board;
pub mod commands;
pub mod draw;
pub mod engine;
pub mod explain;
pub mod input;
pub mod interruption;
pub mod mcap;
pub mod monitor;
pub mod output;
pub mod planning;
mod programs;
pub mod quality;
pub mod report;
pub mod results;
pub mod ros;
pub mod scene;
pub mod serve;
pub mod video;
