//! Tasks that need little of what the PC's program is made of.

pub mod results;
pub mod web;
