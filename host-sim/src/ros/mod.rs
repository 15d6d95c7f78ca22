//! Messages of ROS 2 and of Foxglove: their definitions, and the bytes that stand for them.
//!
//! ```text
//! cdr       numbers, texts and lists as bytes, and back
//! foxglove  the same in Foxglove's own schemas, as protobuf
//! received  images and calibrations of recordings
//! kind      which of both a message is
//! sent      point clouds, markers, disparities, diagnostics, images and calibrations
//! schema    the definitions of what is sent, with all that they refer to
//! ```
//!
//! The packages `cdr` and `cdr-encoding` take the bytes of an image one by one through `serde`, into a copy; here they are borrowed.

pub mod cdr;
mod foxglove;
pub mod kind;
pub mod received;
pub mod schema;
pub mod sent;
