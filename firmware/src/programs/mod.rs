//! The programs, over any board.

pub mod bench;
pub mod case_server;
pub mod cores;
pub mod kernels;
pub mod live;
pub mod pixels;
mod random;
pub mod rectify;
pub mod replay;
pub mod selftest;
