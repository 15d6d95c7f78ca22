//! Test support: naive oracles, drawn images, boards.

pub mod board;
pub mod drawn;
pub mod reference;
