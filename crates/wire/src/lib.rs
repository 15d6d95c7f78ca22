//! Results of a board and commands to it, as packets on a byte port.
//!
//! In: [`Message`]s (board to host) and [`Command`]s (host to board). Out: packets of at most
//! [`MAX_PACKET`] bytes, and from any bytes whatsoever the records in them, every other packet
//! being a named [`DecodeError`] and a count in [`Counters`].
//!
//! ```text
//! packet  = COBS(payload, CRC-32 of payload, little endian), 0x00
//! payload = version byte, record in postcard's format
//! ```
//!
//! 0x00 stands nowhere but at the end of a packet, so a reader that lost its place finds it at the
//! next one. Empty packets are nothing: send a [`DELIMITER`] after a pause or a reset, and what was
//! on the line before cannot damage the next packet.
//!
//! A frame is one [`FrameHead`] and as many [`Segments`] as it takes, so that damage costs
//! [`SEGMENTS_PER_PACKET`] segments instead of a frame, and a board needs one small buffer.
//!
//! ```
//! use linestereo_wire::{Decoder, MAX_COMMAND, MAX_PACKET, Message, Answer, Outcome, Command, Request, encode};
//!
//! let mut buffer = [0; MAX_COMMAND];
//! let packet = encode(&Command { id: 7, request: Request::Start }, &mut buffer)?; // the host
//!
//! let mut decoder: Decoder<Command, MAX_COMMAND> = Decoder::new(); // the board
//! let command = packet.iter().find_map(|&byte| decoder.push(byte)).unwrap()?;
//! assert_eq!(command, Command { id: 7, request: Request::Start });
//!
//! let mut buffer = [0; MAX_PACKET];
//! let answer = Message::Answer(Answer { command: command.id, outcome: Outcome::Accepted });
//! assert!(encode(&answer, &mut buffer)?.ends_with(&[0]));
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! # Versions
//! Postcard's bytes carry no names: any change of a record, of a type of the core in it, of the
//! order of fields or of [`linestereo::results::Rejection::ALL`] is another [`VERSION`]. A test
//! holds the bytes of this one.
//!
//! # Bounds
//! Decoding costs a bounded number of steps per byte and one pass per packet. No allocation, no
//! panic path.
//!
//! # Source
//! S. Cheshire, M. Baker, "Consistent Overhead Byte Stuffing", 1999; CRC-32/ISO-HDLC; the postcard
//! wire specification 1.0.
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_debug_implementations)]
#![warn(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod board_state;
mod case;
mod command;
mod frame;
mod health;
mod message;
mod object;
mod packet;
mod rig_fault;
mod sector;
mod send;
mod settings;

pub use board_state::{CaptureReport, Reset, ResetCause, TimeSource};
pub use case::{CaseReport, DIGESTS, MachineReport, Silicon};
pub use command::{
    Command, MAX_COMMAND, Name, PairHead, ParamUpdate, Refusal, Request, RigBytes, RigUpdate, name,
};
pub use frame::{
    Counts, FrameHead, FrameTimes, POINTS_PER_PACKET, Points, SEGMENTS_PER_PACKET, Segments,
};
pub use health::{Health, PairReport, RangeReport};
pub use message::{
    Answer, BoardName, Hello, MAX_PACKET, Message, Outcome, PIXELS_PER_PACKET, Pixels,
};
pub use object::{MAX_REGIONS, OBJECTS_PER_PACKET, ObjectRecord, Objects, RegionBox, Regions};
pub use packet::{Counters, DELIMITER, DecodeError, Decoder, EncodeError, Record, VERSION, encode};
pub use rig_fault::{RigFault, RigInUse, RigReport};
pub use sector::{SECTORS_PER_PACKET, SectorRecord, Sectors, Sighting};
pub use send::{PointStream, SendError, send, send_frame, send_objects, send_sectors};
pub use settings::{KeptReport, SETTINGS, Setting, SettingValue, SettingValues};

/// The example of the package's page.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
