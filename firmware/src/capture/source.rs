//! Two cameras as the source of a program's pairs, with frames as the sensors deliver them.

use super::{Capture, FrameRows, Report, RowRing};
use crate::ports::{CapturedPair, PairSource};
use linestereo::Dims;

/// Waits for the next pair, for a while.
#[derive(Debug)]
pub struct CameraSource<R> {
    rings: [R; 2],
    /// Its losses say why there was no pair.
    pub capture: Capture,
    dims: Dims,
    patience_us: u32,
}

impl<R: RowRing> CameraSource<R> {
    /// Images of this size; no pair for so many microseconds, at least two periods, is a pair that is missing.
    pub const fn new(rings: [R; 2], capture: Capture, dims: Dims, patience_us: u32) -> Self {
        Self { rings, capture, dims, patience_us }
    }
}

impl<R: RowRing> PairSource for CameraSource<R> {
    fn next_pair(&mut self, frames: [&mut [u8]; 2]) -> Option<CapturedPair> {
        let [left, _] = &self.rings;
        let until_us = left.now_us().saturating_add(self.patience_us.into());
        self.capture.leave();
        let mut rows = FrameRows::new(frames, self.dims);
        loop {
            if let Some(Report::Pair(pair)) = self.capture.turn(&mut self.rings, &mut rows) {
                return Some(pair);
            }
            let [left, _] = &self.rings;
            if left.now_us() > until_us {
                return None;
            }
        }
    }
}
