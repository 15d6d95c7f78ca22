//! Sending: what a board needs to put a result on its port.
//!
//! In: records, or a head and the core's matches, and a function that writes bytes. Out: one call
//! of it per packet.
//!
//! # Cost
//! [`MAX_PACKET`] bytes and one list of segments on the stack.

use crate::frame::{FrameHead, POINTS_PER_PACKET, Points, SEGMENTS_PER_PACKET, Segments};
use crate::message::{MAX_PACKET, Message};
use crate::object::{OBJECTS_PER_PACKET, ObjectRecord, Objects};
use crate::packet::{EncodeError, Record, encode};
use crate::sector::{SectorRecord, Sectors};
use linestereo::obstacles::{ObstaclePlan, Obstacles};
use linestereo::results::{Match, Point};

/// Why something was not sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SendError<E> {
    /// It is no packet; cannot happen with the records of this crate.
    #[error("{0}")]
    Encode(EncodeError),
    /// The port failed.
    #[error("{0}")]
    Port(E),
}

/// Sends one record.
#[inline(never)] // its packet is on the stack only while it sends
pub fn send<T: Record, E>(
    record: &T,
    write: &mut impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<(), SendError<E>> {
    let mut buffer = [0; MAX_PACKET];
    write(encode(record, &mut buffer).map_err(SendError::Encode)?).map_err(SendError::Port)
}

/// Sends a whole frame: its head, with the number of these matches in it, and the matches. Stops at
/// the first failure of the port.
///
/// ```
/// # let (counts, matches) = (linestereo::results::Counts::default(), []);
/// # let dims = linestereo::Dims { width: 320, height: 240 };
/// # let mut port = Vec::new();
/// use linestereo_wire::{FrameHead, Health, send_frame};
/// let head = FrameHead::new(1, 33_000, dims, Health::GOOD, &counts);
/// let sent = send_frame(&head, &matches, &mut |packet| {
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
            let _ = list.push(*found); // a piece fits; collecting could panic
        }
        send(&Message::Segments(Segments { sequence: head.sequence, first, list }), write)?;
        first = first.saturating_add(SEGMENTS_PER_PACKET as u16);
    }
    Ok(())
}

/// The points of a frame as they are made, after [`send_frame`]: a packet whenever enough are
/// together, the rest by [`PointStream::finish`].
#[derive(Clone, Debug)]
pub struct PointStream {
    points: Points,
}

impl PointStream {
    /// Of the frame with this number.
    #[must_use]
    pub const fn new(sequence: u32) -> Self {
        Self { points: Points { sequence, first: 0, list: heapless::Vec::new() } }
    }

    /// Adds a point.
    pub fn push<E>(
        &mut self,
        point: &Point,
        write: &mut impl FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), SendError<E>> {
        let _ = self.points.list.push(*point); // never full here
        if self.points.list.is_full() { self.flush(write) } else { Ok(()) }
    }

    /// Sends what is left.
    pub fn finish<E>(
        mut self,
        write: &mut impl FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), SendError<E>> {
        if self.points.list.is_empty() { Ok(()) } else { self.flush(write) }
    }

    #[inline(never)]
    fn flush<E>(
        &mut self,
        write: &mut impl FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), SendError<E>> {
        let Points { sequence, first, .. } = self.points;
        let next = Points {
            sequence,
            first: first.saturating_add(POINTS_PER_PACKET as u32),
            list: heapless::Vec::new(),
        };
        let points = core::mem::replace(&mut self.points, next);
        send(&Message::Points(points), write)
    }
}

/// Sends the depths of a frame's objects, after [`send_frame`].
#[inline(never)]
pub fn send_objects<E>(
    sequence: u32,
    objects: &[ObjectRecord],
    write: &mut impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<(), SendError<E>> {
    for piece in objects.chunks(OBJECTS_PER_PACKET) {
        let mut list = heapless::Vec::new();
        let _ = list.extend_from_slice(piece); // it fits
        send(&Message::Objects(Objects { sequence, list }), write)?;
    }
    Ok(())
}

/// Sends what is known of each direction at the capture of a frame's pair, `time_us` of the clock
/// that [`Obstacles::update`] got, after [`send_frame`].
#[inline(never)]
pub fn send_sectors<E>(
    sequence: u32,
    plan: &ObstaclePlan,
    obstacles: &Obstacles,
    time_us: u64,
    write: &mut impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<(), SendError<E>> {
    let turn = plan.sectors();
    let mut known = obstacles.sectors(plan, time_us).zip(0..).filter_map(|(sector, index)| {
        SectorRecord::new(index, sector, obstacles.drop_off(plan, index, time_us))
    });
    loop {
        let mut list = heapless::Vec::new();
        while !list.is_full()
            && let Some(record) = known.next()
        {
            let _ = list.push(record); // it fits
        }
        let is_last = !list.is_full();
        send(&Message::Sectors(Sectors { sequence, turn, list }), write)?;
        if is_last {
            return Ok(());
        }
    }
}
