//! The laboratory as a researcher calls it, a module a topic, linked once.

mod compare;
mod faults;
mod named;
mod support;
mod thin;
