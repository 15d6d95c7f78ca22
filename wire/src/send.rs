//! Sending: what a board needs to put a result on its port.
//!
//! In: records, or a head and the core's matches, and a function that writes bytes. Out: one call of it per packet.
//!
//! # Cost
//! [`MAX_PACKET`] bytes and one list of segments on the stack.

use crate::frame::{FrameHead, PointRecord, Points, Segment, Segments};
use crate::message::Message;
use crate::packet::{EncodeError, MAX_PACKET, Record, encode};
use crate::{POINTS_PER_PACKET, SEGMENTS_PER_PACKET};
use core::fmt;
use linestereo::{Match, PointClaim};

/// Why something was not sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SendError<E> {
    /// It is no packet; cannot happen with the records of this crate.
    Encode(EncodeError),
    /// The port failed.
    Port(E),
}

impl<E: fmt::Display> fmt::Display for SendError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Encode(error) => error.fmt(f),
            Self::Port(error) => error.fmt(f),
        }
    }
}

impl<E: core::error::Error> core::error::Error for SendError<E> {}

/// Sends one record.
#[inline(never)] // its packet is on the stack only while it sends
pub fn send<T: Record, E>(record: &T, write: &mut impl FnMut(&[u8]) -> Result<(), E>) -> Result<(), SendError<E>> {
    let mut buffer = [0; MAX_PACKET];
    write(encode(record, &mut buffer).map_err(SendError::Encode)?).map_err(SendError::Port)
}

/// Sends a whole frame: its head, with the number of these matches in it, and the matches. Stops at the first failure of the port.
///
/// ```
/// # let output: linestereo::Output<8, 8> = linestereo::Output::new();
/// # let dims = linestereo::Dims { width: 320, height: 240 };
/// # let mut port = Vec::new();
/// use linestereo_wire::{FrameHead, Health, send_frame};
/// let head = FrameHead::new(1, 33_000, dims, Health::GOOD, &output.counts);
/// let sent = send_frame(&head, &output.matches, &mut |packet| {
///     port.extend_from_slice(packet);
///     Ok::<(), ()>(())
/// });
/// assert_eq!(sent, Ok(()));
/// ```
#[inline(never)]
pub fn send_frame<E>(
    head: &FrameHead,
    matches: &[Match],
    write: &mut impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<(), SendError<E>> {
    let segments = u16::try_from(matches.len()).unwrap_or(u16::MAX);
    send(&Message::Frame(FrameHead { segments, ..*head }), write)?;
    let mut first = 0_u16;
    for piece in matches.get(..segments.into()).unwrap_or(matches).chunks(SEGMENTS_PER_PACKET) {
        let mut list = heapless::Vec::new();
        for found in piece {
            let _ = list.push(Segment::from(found)); // a piece fits; collecting could panic
        }
        send(&Message::Segments(Segments { sequence: head.sequence, first, list }), write)?;
        first = first.saturating_add(SEGMENTS_PER_PACKET as u16);
    }
    Ok(())
}

/// Sends the points of a frame, after [`send_frame`]. Stops at the first failure of the port.
#[inline(never)]
pub fn send_points<E>(
    sequence: u32,
    points: &[PointClaim],
    write: &mut impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<(), SendError<E>> {
    let mut first = 0_u32;
    for piece in points.chunks(POINTS_PER_PACKET) {
        let mut list = heapless::Vec::new();
        for point in piece {
            let _ = list.push(PointRecord::from(point)); // a piece fits; collecting could panic
        }
        send(&Message::Points(Points { sequence, first, list }), write)?;
        first = first.saturating_add(POINTS_PER_PACKET as u32);
    }
    Ok(())
}
