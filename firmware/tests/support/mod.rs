//! What test files share.
#![allow(dead_code, reason = "each test file uses its part")]

pub(crate) mod random;
pub(crate) mod sensor;
