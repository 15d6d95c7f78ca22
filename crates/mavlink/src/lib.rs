//! MAVLink 2 to an autopilot: what is known of each direction, as OBSTACLE_DISTANCE and
//! DISTANCE_SENSOR, and a HEARTBEAT. And from it: requests of parameters and of time
//! ([`Receiver`]).
//!
//! In: the core's [`Obstacles`](linestereo::obstacles::Obstacles) and the time. Out: frames of at
//! most [`MAX_FRAME`] bytes, paced by an [`AutopilotStream`]. The bytes are those of the `mavlink`
//! crate with `mav2-message-extensions`, which does not build without std.
//!
//! ```text
//! frame = FD, length of payload, 0, 0, sequence, system, component, message id (3 bytes),
//!     payload, CRC (2 bytes)
//! CRC   = CRC-16/MCRF4XX over all but FD, and the message's own byte behind it
//! ```
//! Numbers are little endian; fields stand in the order of their sizes, extensions as defined
//! behind them; zeros at the end of a payload are cut off, but for its first byte. Frames are not
//! signed.
//!
//! # Bounds
//! No allocation, no panic path; one frame of [`MAX_FRAME`] bytes on the stack.
//!
//! # Source
//! MAVLink 2 serialization (mavlink.io/en/guide/serialization.html), common.xml and minimal.xml.
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_debug_implementations)]
#![warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod frame;
mod messages;
mod pace;
mod receive;
mod stream;

pub use frame::{Fields, MAX_FRAME, Mavlink, Sender};
pub use messages::{DistanceSensor, Heartbeat, ObstacleDistance, SystemStatus, UNKNOWN_CM};
pub use pace::Pace;
pub use receive::{ParamId, ParamValue, Received, Receiver, Timesync};
pub use stream::{AutopilotParams, AutopilotStream, Policy, StreamError};

/// The example of the package's page.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
