//! Records, packets and MAVLink, a module a topic: `cargo test -p linestereo-wire TOPIC`.

mod autopilots;
mod damage;
mod mavlink;
mod records;
mod support;
