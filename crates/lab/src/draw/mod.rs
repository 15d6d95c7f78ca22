//! Pictures of evaluations.

mod faults;

pub use faults::faults;
