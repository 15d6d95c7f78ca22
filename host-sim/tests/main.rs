//! Tests of the program, a module a topic: `cargo test -p linestereo-sim TOPIC`.

#![allow(clippy::disallowed_methods, reason = "tests read what they wrote")]

mod bench_board;
mod calibrate;
mod calibration;
mod calibration_gate;
mod command_line;
mod documented;
mod explain;
mod first_hour;
mod flash_image;
mod formats;
#[cfg(unix)]
mod frames_get;
#[cfg(target_os = "linux")]
mod hostile_recordings;
mod interchange;
mod layouts;
mod marked_boards;
mod monitor;
mod photograph;
mod plan_rig;
mod quality;
mod recordings;
mod rectify;
mod region_files;
mod registry;
mod report_page;
mod rig_commands;
mod room;
mod run;
mod scene;
mod support;
mod synthetic;
#[cfg(unix)]
mod untrusted;
mod video;
#[cfg(target_os = "linux")]
mod view;
