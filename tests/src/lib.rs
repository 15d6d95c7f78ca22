//! Test support: naive oracles and drawn images.
