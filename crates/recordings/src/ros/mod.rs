//! Messages of ROS 2 and of Foxglove: their definitions, and the bytes that stand for them.
//!
//! ```text
//! messages  those of ROS 2, field by field
//! cdr       their bytes, both ways
//! foxglove  the same in Foxglove's own schemas, as protobuf
//! kind      which of both a message is
//! sent      point clouds, markers, disparities, diagnostics, images and calibrations of results
//! schema    the definitions of what is sent, with all that they refer to
//! ```

pub mod cdr;
mod foxglove;
pub mod kind;
pub mod messages;
pub mod schema;
pub mod sent;
