//! A page for browsers of this computer, and events that it is sent as they happen.
//!
//! ```text
//! request    bytes of a connection -> what is wanted, or a refusal
//! visitors   events -> a bounded queue for each visitor
//! server     connections, each on a thread of its own
//! ```
//!
//! # Bounds
//! It listens on 127.0.0.1 alone. A request has at most 8 KiB of head and 1 KiB of body and is
//! there within 5 s; 24 connections and 8 visitors are served at once. 64 events or 16 MiB wait for
//! a visitor: who is slower loses the oldest, and is told how many. Who takes nothing for 10 s is
//! let go.
//!
//! # Source
//! HTTP/1.1 (RFC 9112) by the crate `httparse`, one request a connection; server-sent events (HTML
//! Living Standard, 9.2). No blocking server on crates.io keeps these bounds: `tiny_http` and
//! `touche` read a head of any length, and `tiny_http` waits for ever for who sends or takes
//! nothing; `oxhttp` holds events back until there are 1024 bytes of them. `hyper` needs a runtime,
//! for one page and eight visitors.

mod request;
mod server;
mod visitors;

pub use server::{Event, Server};

/// A rectangle of pixels that visitors ask for: left, top, right and bottom, the last two
/// exclusive.
pub type AskedBox = [u16; 4];
