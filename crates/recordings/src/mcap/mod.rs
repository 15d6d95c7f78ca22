//! MCAP files, the container of ROS 2 and Foxglove, by the crate `mcap`: messages read by their
//! places, and written.
//!
//! ```text
//! Reader   schemas, channels and messages in the order of the file, chunks unpacked; a message
//!          again by its place
//! Writer   chunks with indexes and a summary, so that players seek without a scan
//! ```
//!
//! # Bounds
//! A chunk, or a message outside of one, has at most [`RECORD_BYTES`], stored and unpacked.
//! [`Reader`] keeps two chunks of up to half of that.
//!
//! # Source
//! <https://mcap.dev/spec>, version 0.

mod read;
mod write;

pub use ::mcap::records::Record;
pub use read::{McapFault, Place, Reader};
pub use write::Writer;

/// Most bytes of a chunk or message, stored and unpacked. Recorders close a chunk behind 1 to 4
/// MiB; a colour image of 8 million pixels fits.
pub const RECORD_BYTES: u64 = 32 << 20;
