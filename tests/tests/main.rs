//! End-to-end and oracle tests, a module a topic, linked once: `cargo test -p linestereo-tests TOPIC`.

mod baselines;
mod block_matching;
mod board;
mod board_objects;
mod determinism;
mod edges;
mod extremes;
mod focus;
mod frames;
mod hardware;
mod health;
mod kernels;
mod layers;
mod lines;
mod no_panic;
mod objects;
mod obstacles;
mod opencv;
mod pitfalls;
mod query;
mod rectify;
mod rig;
mod rig_image;
mod units;
mod usable;
mod view;
