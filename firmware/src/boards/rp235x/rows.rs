//! Bytes written by the DMA -> numbers of rows and [`Signal`]s, without the hardware.
//!
//! In: at every interrupt of a camera, what its DMA channels and its flags say ([`Seen`]). Out:
//! signals, oldest first, and when the DMA has to be set to the start of a row again.
//!
//! ```text
//! memory   a ring of rows, each of its pixels and a word with its length (program.rs); a row has a
//!          slot, its number modulo the ring
//! data     DMA channel: one row from the PIO's queue to its slot, then an interrupt and `next`
//! next     DMA channel: the address of the next slot, out of a table that wraps -> data
//! rows done = those whose slot is before the one that `next` has loaded last
//!
//! start of a frame   the number of its first row that is kept, reported when the border above it
//!                    is complete
//! rows               of each: does the word behind it say the right length?  those of the border
//!                    are only reported if not; the last row that is kept is reported when the
//!                    border below it is complete
//! end of a frame     a row that has begun is a short line; then the DMA goes to the start of a
//!                    row: that takes effect long before the next start, while the sensor sends
//!                    nothing
//! both, or a queue that is full   signals are lost, and it says so
//! ```
//!
//! # Bounds
//! Rows are counted right as long as fewer of them than the ring holds come between two looks; a
//! row ends every 125 us, the ring holds 16 ms. After a longer time the flags of frames have come
//! as well, and signals count as lost.

use super::program;
use crate::capture::Signal;
use heapless::Deque;
use linestereo::Dims;

/// Pixels that the sensor sends on each side of those that are kept.
pub const BORDER: u32 = 2;
/// Rows of a ring.
pub const RING_ROWS: usize = 128;
/// Bytes of a row with its border.
pub const ROW_BYTES: usize = 324;
/// Rows of a frame with its border.
pub const FRAME_ROWS: usize = 244;
/// Size of the images that are kept.
pub const DIMS: Dims = Dims {
    width: ROW_BYTES as u16 - 2 * BORDER as u16,
    height: FRAME_ROWS as u16 - 2 * BORDER as u16,
};
/// Words of a row with that of its length.
pub const SLOT_WORDS: usize = ROW_BYTES / 4 + 1;
/// Signals that are kept: those of all rows of the ring and of the frames that they are of. More
/// would be of rows that are overwritten.
const SIGNALS: usize = RING_ROWS + 8;

/// Cause of a camera's interrupt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// The flag: a frame has started.
    pub is_started: bool,
    /// The flag: a frame has ended.
    pub is_ended: bool,
    /// The PIO's queue was full: bits are lost.
    pub is_overrun: bool,
    /// Place in the table that `next` reads next time.
    pub next_slot: u32,
    /// Something of the row that is being written has come, in memory or in the PIO's queue.
    pub is_begun: bool,
    /// When, microseconds.
    pub time_us: u64,
}

/// The signals of one camera.
#[derive(Debug, Default)]
pub struct RowCounter {
    /// Number of the row that was being written.
    row: u32,
    /// Rows of this frame so far.
    of_frame: u32,
    /// Start of a frame that is not reported yet.
    started_us: Option<u64>,
    /// Reported already, of this frame.
    is_overrun: bool,
    signals: Deque<Signal, SIGNALS>,
}

impl RowCounter {
    /// Row 0 is being written. All zero: it takes no flash.
    pub const fn new() -> Self {
        Self { row: 0, of_frame: 0, started_us: None, is_overrun: false, signals: Deque::new() }
    }

    /// The row that is being written now: so many are complete.
    pub const fn written(&self, next_slot: u32) -> u32 {
        let rows = next_slot.wrapping_sub(1).wrapping_sub(self.row) % RING_ROWS as u32;
        self.row.wrapping_add(rows)
    }

    /// Takes what an interrupt has found; frames have so many rows with their border, and
    /// `length_word` is the word behind the row of a slot. `Some`: the DMA has to be set to the
    /// start of this slot now, whatever it was doing.
    pub fn take(
        &mut self,
        frame_rows: u32,
        seen: &Seen,
        length_word: impl Fn(u32) -> u32,
    ) -> Option<u32> {
        let Seen { time_us, .. } = *seen;
        if seen.is_started && seen.is_ended {
            // Which came first nobody knows any more.
            self.row = self.written(seen.next_slot);
            self.lose();
            return None;
        }
        if seen.is_started {
            // Between frames there are no rows: all that are new are of this one.
            (self.of_frame, self.started_us) = (0, Some(time_us));
        }
        if seen.is_overrun && !self.is_overrun {
            self.is_overrun = true;
            self.push_after_start(Signal::Overrun { time_us });
        }
        let written = self.written(seen.next_slot);
        while self.row != written {
            let bytes = bytes(program::nibbles(length_word(self.row % RING_ROWS as u32)));
            self.end_row(frame_rows, bytes, time_us);
        }
        if !seen.is_ended {
            return None;
        }
        if seen.is_begun {
            self.push_after_start(Signal::Rows { end: self.row, bytes: 1, time_us });
        }
        self.push_start();
        self.is_overrun = false;
        Some(self.row % RING_ROWS as u32)
    }

    /// The oldest signal.
    pub fn next_signal(&mut self) -> Option<Signal> {
        self.signals.pop_front()
    }

    /// A row that is as it should be is reported if it is kept; the last of these when the border
    /// below it is complete as well, so that a frame with a row too few is never whole.
    fn end_row(&mut self, frame_rows: u32, bytes: u32, time_us: u64) {
        self.row = self.row.wrapping_add(1);
        let index = self.of_frame;
        self.of_frame = index.saturating_add(1);
        let (is_good, first, last) = (bytes == ROW_BYTES as u32, BORDER, frame_rows - BORDER - 1);
        if !is_good || index >= frame_rows || (first..last).contains(&index) {
            self.push_after_start(Signal::Rows { end: self.row, bytes, time_us });
        } else if self.of_frame == first {
            self.push_start();
        } else if self.of_frame == frame_rows {
            self.push_after_start(Signal::Rows {
                end: self.row.wrapping_sub(BORDER),
                bytes,
                time_us,
            });
        }
    }

    /// Events of a frame come after its start.
    fn push_after_start(&mut self, signal: Signal) {
        self.push_start();
        self.push(signal);
    }

    fn push_start(&mut self) {
        if let Some(time_us) = self.started_us.take() {
            self.push(Signal::FrameStart { time_us, row: self.row });
        }
    }

    fn push(&mut self, signal: Signal) {
        if self.signals.push_back(signal).is_err() {
            self.lose();
        }
    }

    fn lose(&mut self) {
        self.started_us = None;
        self.signals.clear();
        let _ = self.signals.push_back(Signal::Lost); // there is room
    }
}

/// Bytes of a row of so many nibbles. Of one that is not as long as it should be they are no
/// multiple of what they should be either, whatever lies where its length should.
fn bytes(nibbles: u32) -> u32 {
    let bytes = nibbles / 2;
    let is_other = nibbles != 2 * ROW_BYTES as u32 && bytes.is_multiple_of(ROW_BYTES as u32);
    bytes + u32::from(is_other)
}
