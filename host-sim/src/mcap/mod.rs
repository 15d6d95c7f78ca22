//! MCAP files, the container of ROS 2 and Foxglove: records in, messages out, and back.
//!
//! ```text
//! Reader   schemas, channels and messages in the order of the file, chunks unpacked; a message again by its place
//! Writer   chunks with indexes and a summary, so that players seek without a scan
//! ```
//!
//! A record is a kind, a length and its fields: some 500 lines here. The package `mcap` does the same and more, and made a first build 9 % longer
//! (198 instead of 182 s of a processor), most of it for its derive macros.
//!
//! # Bounds
//! A chunk, or a message outside of one, has at most [`RECORD_BYTES`], stored and unpacked; [`Reader`] keeps two chunks of up to half of that.
//!
//! # Source
//! <https://mcap.dev/spec>, version 0.

mod read;
mod write;

pub use read::{Item, McapFault, Place, Reader};
pub use write::Writer;

/// Most bytes of a chunk or message, stored and unpacked. Recorders close a chunk behind 1 to 4 MiB; a colour image of 8 million pixels fits.
pub const RECORD_BYTES: u64 = 32 << 20;

/// First and last bytes of a file.
const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// Kinds of records.
mod kind {
    pub(super) const HEADER: u8 = 0x01;
    pub(super) const FOOTER: u8 = 0x02;
    pub(super) const SCHEMA: u8 = 0x03;
    pub(super) const CHANNEL: u8 = 0x04;
    pub(super) const MESSAGE: u8 = 0x05;
    pub(super) const CHUNK: u8 = 0x06;
    pub(super) const MESSAGE_INDEX: u8 = 0x07;
    pub(super) const CHUNK_INDEX: u8 = 0x08;
    pub(super) const STATISTICS: u8 = 0x0b;
    pub(super) const SUMMARY_OFFSET: u8 = 0x0e;
    pub(super) const DATA_END: u8 = 0x0f;
}
