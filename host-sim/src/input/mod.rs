//! Pairs that package registries carry.

pub mod registry;
