//! Other programs of this machine: run with a time limit, installed from Debian where they are
//! missing.

pub(crate) mod packages;
pub(crate) mod process;
