//! Pictures of evaluations.

mod faults;
mod maps;

pub use faults::faults;
pub use maps::{SceneMaps, maps};
