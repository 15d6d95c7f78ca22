//! The command line and what stands behind it, a module a topic: `cargo test -p linestereo-sim TOPIC`.

mod calibrate;
mod command_line;
mod compare;
mod flash_image;
#[cfg(unix)]
mod frames_get;
mod monitor;
mod on_board;
mod photograph;
mod rectify;
mod rig_commands;
mod run;
mod scale;
mod support;
mod synthetic;
