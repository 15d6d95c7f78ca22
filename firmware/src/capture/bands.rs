//! Events of a camera interface and its DMA, one stream of rows -> [`Signal`]s, a band of rows
//! each.
//!
//! In: the ends of rows and frames, lost bytes, and how far the DMA has come in its ring at that
//! moment. Out: signals for [`Capture`](super::Capture); whether the DMA has to be set to the start
//! of the ring.
//!
//! ```text
//! frame starts   row number of the offset of the DMA; not at the start of a row: the DMA is set to
//!                the start of the ring first
//! row ends       the DMA has moved by a row: one more row; every `band` rows a signal
//!                by several rows: their interrupts came late, they count all the same
//!                not at all: it was looked at already
//!                by anything else: a signal with the bytes that came, at once, and nothing more of
//!                                  this frame
//! frame ends     the rows of the last band; after a wrong row the DMA is set to the start of the
//!                ring
//! bytes lost     a signal, and the DMA is set to the start of the ring
//! ```
//! Rows of one frame lie behind those of the last one, wherever that is in the ring: nothing is
//! moved while all goes well, so that rows that wait to be fetched stay good. When the DMA is set
//! to the start of the ring, row numbers go on at the next multiple of the ring.
//!
//! # Bounds
//! A ring holds a power of two of rows; a row has 1 to 65535 bytes. Somebody looks before the DMA
//! has gone once round. A row that is too short by as much as the next one is too long is found if
//! its own end is looked at in time.
//!
//! # Cost
//! `QUEUE` signals of 24 bytes and 40 bytes; a few dozen instructions a row.

use super::Signal;
use heapless::Deque;

/// The shape of a ring of rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RingLayout {
    /// Rows that it holds: a power of two.
    pub rows: u32,
    /// Bytes of a row.
    pub row_bytes: u32,
    /// Rows of a signal.
    pub band: u32,
}

impl RingLayout {
    /// Bytes of the ring.
    pub const fn bytes(&self) -> u32 {
        self.rows * self.row_bytes
    }
}

/// Findings of an interrupt of a camera interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Events {
    /// A frame has started.
    pub has_started: bool,
    /// A row has ended, or several, and the next one has not begun when the offset of the DMA is
    /// looked at. A look that comes too late for that is left out: the next one finds its row as
    /// well.
    pub row_ended: bool,
    /// A frame has ended.
    pub frame_ended: bool,
    /// The interface or the DMA has lost bytes.
    pub is_lost: bool,
}

/// Does the DMA go on where it is?
#[must_use]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dma {
    /// It does.
    Goes,
    /// It has to be set to the start of the ring, and the camera interface has to wait for the next
    /// frame.
    Restart,
}

/// The state of a stream of rows. An offset is that of the byte of the ring that the DMA writes
/// next.
#[derive(Debug)]
pub struct Bands<const QUEUE: usize> {
    layout: RingLayout,
    queue: Deque<Signal, QUEUE>,
    is_lost: bool,
    /// Rows that are complete.
    row: u32,
    /// Where the DMA was seen last, and how many bytes that is behind the start of the next row.
    offset: u32,
    ahead: u32,
    /// Number of the row after those that signals were given for.
    reported: u32,
    phase: Phase,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Between frames.
    Pause,
    Frame,
    /// A row of this frame had a wrong length.
    Broken,
}

impl<const QUEUE: usize> Bands<QUEUE> {
    /// A DMA at the start of its ring.
    pub const fn new(layout: RingLayout) -> Self {
        Self {
            layout,
            queue: Deque::new(),
            is_lost: false,
            row: 0,
            offset: 0,
            ahead: 0,
            reported: 0,
            phase: Phase::Pause,
        }
    }

    /// The shape of its ring.
    pub const fn layout(&self) -> RingLayout {
        self.layout
    }

    /// Has a frame started that has not ended?
    pub fn is_in_frame(&self) -> bool {
        self.phase != Phase::Pause
    }

    /// Serves the events of an interrupt, perhaps late, with the offset of the DMA in the ring,
    /// bytes.
    pub fn serve(&mut self, events: Events, offset: u32, time_us: u64) -> Dma {
        if events.is_lost {
            return self.bytes_lost(time_us);
        }
        (self.ahead, self.offset) = (self.distance(offset), offset);
        // Between frames a start comes first; in a frame, what is left of it.
        let is_first = events.has_started && self.phase == Phase::Pause;
        if is_first {
            let _ = self.frame_starts(time_us); // goes on
        }
        if events.row_ended || events.frame_ended {
            self.row_ends(time_us);
        }
        if events.frame_ended && self.frame_ends(time_us) == Dma::Restart {
            return Dma::Restart;
        }
        if events.has_started && !is_first { self.frame_starts(time_us) } else { Dma::Goes }
    }

    /// Between frames the DMA stands still: bytes that it has moved already are of this frame,
    /// whose start is reported late.
    fn frame_starts(&mut self, time_us: u64) -> Dma {
        let goes = match self.phase {
            Phase::Pause => true,
            Phase::Frame => self.count_rows(), // its end was not reported
            Phase::Broken => false,
        };
        if !goes {
            self.phase = Phase::Pause; // this frame is lost as well
            return self.restart();
        }
        (self.reported, self.phase) = (self.row, Phase::Frame);
        self.push(Signal::FrameStart { time_us, row: self.row });
        Dma::Goes
    }

    fn row_ends(&mut self, time_us: u64) {
        let bytes = self.ahead;
        // Without bytes: a row that was looked at already, or one that is not delivered, before the
        // first frame and after a restart.
        if self.phase == Phase::Broken || bytes == 0 {
            return;
        }
        if !self.count_rows() {
            let reported_bytes = self.row.wrapping_sub(self.reported) * self.layout.row_bytes;
            let rows = (bytes / self.layout.row_bytes).max(1);
            self.row = self.row.wrapping_add(rows);
            self.phase = Phase::Broken;
            self.push_rows(reported_bytes + bytes, time_us);
            return;
        }
        let rows = self.row.wrapping_sub(self.reported);
        if rows >= self.layout.band {
            self.push_rows(rows * self.layout.row_bytes, time_us);
        }
    }

    fn frame_ends(&mut self, time_us: u64) -> Dma {
        let rows = self.row.wrapping_sub(self.reported);
        if self.phase == Phase::Frame && rows > 0 {
            self.push_rows(rows * self.layout.row_bytes, time_us);
        }
        let was_broken = self.phase == Phase::Broken;
        self.phase = Phase::Pause;
        if was_broken { self.restart() } else { Dma::Goes }
    }

    fn bytes_lost(&mut self, time_us: u64) -> Dma {
        self.push(Signal::Overrun { time_us });
        self.phase = Phase::Pause;
        self.restart()
    }

    /// The next signal, oldest first.
    pub fn next_signal(&mut self) -> Option<Signal> {
        let lost = (self.queue.is_empty() && self.is_lost).then_some(Signal::Lost);
        self.is_lost &= lost.is_none();
        self.queue.pop_front().or(lost)
    }

    /// Number of the row that a DMA at this offset is writing.
    pub fn written(&self, offset: u32) -> u32 {
        self.row.wrapping_add(self.distance(offset) / self.layout.row_bytes)
    }

    /// From the start of the next row to an offset, bytes.
    fn distance(&self, offset: u32) -> u32 {
        let bytes = self.layout.bytes();
        self.ahead.wrapping_add((offset + bytes - self.offset) % bytes)
    }

    /// Counts the rows up to where the DMA was seen; not when that is no start of a row.
    fn count_rows(&mut self) -> bool {
        let is_start = self.ahead.is_multiple_of(self.layout.row_bytes);
        if is_start {
            self.row = self.row.wrapping_add(self.ahead / self.layout.row_bytes);
            self.ahead = 0;
        }
        is_start
    }

    /// Row numbers go on at the start of the ring.
    fn restart(&mut self) -> Dma {
        self.row = (self.row | (self.layout.rows - 1)).wrapping_add(1);
        (self.offset, self.ahead, self.reported) = (0, 0, self.row);
        Dma::Restart
    }

    fn push_rows(&mut self, bytes: u32, time_us: u64) {
        self.reported = self.row;
        self.push(Signal::Rows { end: self.row, bytes, time_us });
    }

    /// After a signal is lost none is kept until that is known: what follows would be taken for
    /// part of an older frame.
    fn push(&mut self, signal: Signal) {
        if self.is_lost || self.queue.push_back(signal).is_err() {
            self.is_lost = true;
        }
    }
}
