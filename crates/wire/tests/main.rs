//! Records and packets, a module a topic: `cargo test -p linestereo-wire TOPIC`.

mod conversions;
mod damage;
mod records;
mod support;
