//! The firmware's parts on a PC, with fakes in place of boards, a module a topic: `cargo test -p
//! linestereo-firmware TOPIC`.

mod camera;
mod capacities;
mod capture;
mod frame_times;
mod host_lines;
mod i2c;
mod pio;
mod programs;
mod settings;
mod slot_store;
mod source;
mod stereo;
mod stream;
mod support;
