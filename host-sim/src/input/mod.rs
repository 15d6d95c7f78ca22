//! Pairs of whatever a command is given, and pairs that package registries carry.

mod fault;
mod filmed;
mod footage;
mod recorded;
pub mod recording;
pub mod registry;
pub mod video;

pub use footage::Footage;
