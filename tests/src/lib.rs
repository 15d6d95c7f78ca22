//! Test support: naive oracles and drawn images.

pub mod drawn;
pub mod reference;
