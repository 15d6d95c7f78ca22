//! A board's results as they arrive: bytes from a file, a connection or a serial port, to frames,
//! lines of a table and counts.
//!
//! ```text
//! port      bytes, or silence, or the end
//! (wire)    bytes -> messages, and counts of what is damaged
//! frames    messages -> frames; which are incomplete, which are lost
//! photo     messages -> photographs
//! requests  words of the command line -> commands
//! link      bytes -> frames, photographs, depths of objects and notes; commands -> answers
//! text      frames and counts -> lines, JSON, summary
//! ```

pub mod frames;
pub mod link;
pub mod photo;
pub mod port;
pub mod requests;
pub mod text;
