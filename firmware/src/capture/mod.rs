//! Rows that two cameras leave in memory -> whole pairs; or what went wrong, by kind.
//!
//! In: of each camera a ring of raw rows that its hardware fills, and [`Signal`]s of its interrupts
//! ([`RowRing`], one per board). Out: rows for the rectifiers, one by one while the next ones
//! arrive ([`RowSink`]), and a [`Report`] for every pair and every fault.
//!
//! ```text
//! signal  -> Tracker, of each camera: is the frame as long as it should be, row for row, and does
//!         it start and end where it should?
//! rows    -> copied out of the ring; then: has the hardware come round meanwhile?  only then they
//!         go on
//! frame   -> Capture: is there one of the other camera that started at the same time?  whole,
//!         both: a pair, with both times
//! fault   -> this camera's frame is left, wherever it was; it is looked at again from its next
//!         start of frame
//! ```
//! A pair is reported only after both frames have ended as they should, so no matcher ever sees a
//! frame that is stale, torn or of two exposures. A frame that is not fetched in time because the
//! last pair is still worked on is skipped, and counted.
//!
//! Nothing here knows a peripheral; `firmware/tests/capture.rs` drives it with a fake that is
//! stricter than one. It has not run on hardware yet.
//!
//! # Bounds
//! Rows are numbered from the start and wrap at 2^32; differences are taken modulo that. Times do
//! not wrap.
//!
//! # Cost
//! One copy of every raw row; less than 300 bytes.

mod bands;
mod pairing;
mod shared;
mod sinks;
mod source;
mod tracker;

pub use bands::{Bands, Dma, Events, RingLayout};
pub use pairing::{Capture, Report};
pub use shared::{CamerasInTurn, Half, InTurn, SideBySide, Stream, Switch, Turn};
pub use sinks::{FrameRows, MemoryRows};
pub use source::{CameraSource, FreeCameras};

use crate::memory::of;
use linestereo::Dims;
use linestereo_rig::{CameraSide, RowError};
use linestereo_wire::CaptureReport;

/// Event of a camera's interrupts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    /// VSYNC: a frame starts.
    FrameStart {
        /// When, microseconds of the clock of both cameras.
        time_us: u64,
        /// Number of its first row in the ring.
        row: u32,
    },
    /// More rows are complete: one (HREF), or a band of them (DMA).
    Rows {
        /// Number of the row after the last one.
        end: u32,
        /// Bytes that came since the last such signal or the start of the frame.
        bytes: u32,
        /// When.
        time_us: u64,
    },
    /// The peripheral lost bytes of this frame.
    Overrun {
        /// When.
        time_us: u64,
    },
    /// Signals were lost, because nobody fetched them.
    Lost,
}

impl Signal {
    const fn time_us(&self) -> u64 {
        match self {
            Self::FrameStart { time_us, .. }
            | Self::Rows { time_us, .. }
            | Self::Overrun { time_us } => *time_us,
            Self::Lost => 0,
        }
    }
}

/// The capture hardware of one camera: a DMA that writes rows into a ring, over the oldest, and its
/// interrupts.
///
/// A board sets the DMA to the start of a row at every start of a frame: what a short line has
/// shifted must not reach the next one.
pub trait RowRing {
    /// Rows that the ring holds: a power of two, so that the number of a row says where it lies.
    fn rows(&self) -> u32;

    /// Events of the interrupts since the last call, oldest first.
    fn next_signal(&mut self) -> Option<Signal>;

    /// Rows that are complete now, whether their signal was fetched or not: the hardware is writing
    /// row number `written`.
    fn written(&self) -> u32;

    /// Copies the grey levels of a row out of the ring, whatever lies there by now.
    fn copy(&self, row: u32, into: &mut [u8]);

    /// The clock of the signals, microseconds.
    fn now_us(&self) -> u64;

    /// Sleeps until there may be a signal, of this camera or the other one, for at most some
    /// milliseconds. Called when there was none.
    fn rest(&self) {}
}

/// Where raw rows go.
pub trait RowSink {
    /// The next row of this camera is the first of a frame.
    fn restart(&mut self, eye: CameraSide);

    /// Where the next row of this camera has to be put, as long as a row is; empty when none is
    /// taken.
    fn row(&mut self, eye: CameraSide) -> &mut [u8];

    /// Takes the row that was put there.
    fn push(&mut self, eye: CameraSide) -> Result<(), RowError>;

    /// Size of the frames that lie there; `None` as long as they are not complete.
    fn complete(&self) -> Option<Dims>;
}

/// Limits that every frame has to meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Rows of a raw frame.
    pub rows: u16,
    /// Bytes of a raw row, as the sensor sends them.
    pub row_bytes: u16,
    /// Longest time between two signals of rows of a frame, microseconds; less than the pause
    /// between frames.
    pub row_gap_us: u32,
    /// Longest time from the start of a frame to its end, microseconds.
    pub readout_us: u32,
    /// A camera that is silent for so long has stopped, microseconds; more than a frame takes.
    pub silence_us: u32,
    /// Frames that start at most so far apart are a pair, microseconds: less than half a period.
    /// The health check limits it further.
    pub pair_us: u32,
}

/// Fault of a camera's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// The peripheral lost bytes.
    #[error("the peripheral lost bytes: its DMA needs a higher priority")]
    Overrun,
    /// Rows came after the end of a frame without the start of another one.
    #[error("a frame did not start where it should: check VSYNC")]
    MissingVsync,
    /// A frame started before the last one was complete.
    #[error("a frame started before the last one was complete: check VSYNC and the number of rows")]
    EarlyVsync,
    /// A row is not as long as it should be.
    #[error("a row has the wrong length: check HREF, the pixel clock and the width")]
    ShortLine,
    /// A frame paused in the middle: what follows is of another one.
    #[error("a frame paused in the middle: check power and clock of the camera")]
    TornFrame,
    /// The camera sends nothing.
    #[error("the camera has stopped: start it again")]
    Stopped,
    /// Rows were overwritten, or signals lost, before they were fetched.
    #[error(
        "rows were overwritten before they were fetched: the ring is too small, or the frame \
         rate too high"
    )]
    TooSlow,
}

impl Fault {
    /// Every kind.
    pub const ALL: [Self; 7] = [
        Self::Overrun,
        Self::MissingVsync,
        Self::EarlyVsync,
        Self::ShortLine,
        Self::TornFrame,
        Self::Stopped,
        Self::TooSlow,
    ];

    /// Counts this fault of a camera.
    fn count(self, eye: CameraSide, losses: &mut CaptureReport) {
        if let Some(count) = of(eye, &mut losses.faults).get_mut(self as usize) {
            *count = count.saturating_add(1);
        }
    }
}

const _: () = assert!(Fault::ALL.len() == CaptureReport::KINDS.len());
