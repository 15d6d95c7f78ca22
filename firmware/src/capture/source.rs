//! Two cameras as the source of a program's pairs.
//!
//! ```text
//! shoot   a trigger for both, or nothing where they run free; a sensor that failed is started
//!         again first
//! let go  when both frames have started, or will not: a trigger that is held is lowered
//! turn    rows to the rectifiers as they come, or to the frames as they are, until both frames are
//!         whole; sleep in between
//! fault   of triggered frames: no pair comes of this shot; its last rows are waited for, and the
//!         next call shoots again
//! follow  what the left sensor chose is given to the right one; when the middle of the next
//!         exposure will be. Without a pair as well: frames of triggered sensors start after their
//!         exposure, and if these differ by too much there is no pair before they are alike
//! ```

use super::{Capture, Fault, FrameRows, MemoryRows, Report, RowRing, RowSink};
use crate::memory::Memory;
use crate::ports::{Cameras, CapturedPair, PairSource};
use linestereo::Dims;
use linestereo_wire::CaptureReport;

/// Cameras that somebody else has started, and that run free.
#[derive(Clone, Copy, Debug, Default)]
pub struct FreeCameras;

impl Cameras for FreeCameras {
    fn shoot(&mut self) -> bool {
        true
    }

    fn follow(&mut self) -> Option<[i32; 2]> {
        None
    }

    fn stopped(&mut self) {}
}

/// Waits for the next pair, for a while.
#[derive(Debug)]
pub struct CameraSource<R, C = FreeCameras> {
    rings: [R; 2],
    cameras: C,
    /// Its losses name why there was no pair.
    pub capture: Capture,
    dims: Dims,
    patience_us: u32,
    still_us: Option<u32>,
}

impl<R: RowRing, C: Cameras> CameraSource<R, C> {
    /// Raw images of this size; no pair for so many microseconds, at least two periods, is a pair
    /// that is missing.
    pub const fn new(
        rings: [R; 2],
        cameras: C,
        capture: Capture,
        dims: Dims,
        patience_us: u32,
    ) -> Self {
        Self { rings, cameras, capture, dims, patience_us, still_us: None }
    }

    /// The scene is known to stand still: images may be captured so far apart, microseconds.
    #[must_use]
    pub fn still(self, skew_us: u32) -> Self {
        Self { still_us: Some(skew_us), ..self }
    }

    /// The next pair, into this sink.
    fn fetch(&mut self, rows: &mut impl RowSink) -> Option<CapturedPair> {
        self.capture.request(self.now_us());
        let is_shot = self.cameras.shoot();
        let pair = self.receive(is_shot, rows);
        self.cameras.let_go();
        if is_shot && let Some(middle_us) = self.cameras.follow() {
            self.capture.set_middle_us(middle_us);
        }
        pair
    }

    /// The pair that was triggered, or that will not come.
    fn receive(&mut self, is_shot: bool, rows: &mut impl RowSink) -> Option<CapturedPair> {
        let from_us = self.now_us();
        self.capture.shot(from_us);
        let mut until_us = from_us.saturating_add(self.patience_us.into());
        loop {
            match self.capture.turn(&mut self.rings, rows) {
                Some(Report::Pair(pair)) if is_shot => return Some(pair),
                Some(Report::Started) => self.cameras.let_go(),
                Some(Report::Fault(_, Fault::Stopped)) => {
                    self.cameras.let_go();
                    self.cameras.stopped();
                }
                // Known at the start of a frame: it is the last one's.
                Some(Report::Pair(_) | Report::Fault(_, Fault::EarlyVsync)) => {}
                Some(Report::Fault(..) | Report::Refused(..) | Report::Incomplete) => {
                    until_us = self
                        .capture
                        .end_of_shot(self.now_us())
                        .map_or(until_us, |end_us| end_us.min(until_us));
                }
                None if self.capture.has_failed(self.now_us()) => return None,
                None => {
                    let [left, _] = &self.rings;
                    left.rest();
                }
            }
            if self.now_us() > until_us {
                return None;
            }
        }
    }

    fn now_us(&self) -> u64 {
        let [left, _] = &self.rings;
        left.now_us()
    }
}

impl<R: RowRing, C: Cameras> PairSource for CameraSource<R, C> {
    fn next_pair(
        &mut self,
        memory: &mut impl Memory,
        rectified: Option<Dims>,
    ) -> Option<CapturedPair> {
        match rectified {
            Some(dims) => self.fetch(&mut MemoryRows::new(memory, dims)),
            None => {
                let dims = self.dims;
                self.fetch(&mut FrameRows::new(memory.frames(), dims))
            }
        }
    }

    fn raw_dims(&self) -> Option<Dims> {
        Some(self.dims)
    }

    fn clock_us(&self) -> Option<u64> {
        Some(self.now_us())
    }

    fn still_us(&self) -> Option<u32> {
        self.still_us
    }

    fn losses(&self) -> Option<CaptureReport> {
        Some(CaptureReport { sensors: self.cameras.failures(), ..*self.capture.losses() })
    }
}
