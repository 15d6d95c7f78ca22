//! Test support: naive oracles, drawn images, captured frames, boards.

pub mod board;
pub mod captured;
pub mod drawn;
pub mod fuzz;
pub mod reference;
