//! What test files share.

pub(crate) mod port;
pub(crate) mod random;
pub(crate) mod sensor;
