//! MAVLink, a module a topic: `cargo test -p linestereo-mavlink TOPIC`.

mod autopilots;
mod frames;
