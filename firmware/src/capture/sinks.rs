//! Where captured rows go: into frames as they are, or through the rectifiers of a board's memory.

use super::RowSink;
use crate::memory::{Memory, of};
use linestereo::Dims;
use linestereo_rig::{CameraSide, RowError};

/// Two frames of raw rows, without padding.
#[derive(Debug)]
pub struct FrameRows<'a> {
    frames: [&'a mut [u8]; 2],
    dims: Dims,
    /// Rows that each has.
    rows: [u16; 2],
}

impl<'a> FrameRows<'a> {
    /// Empty frames of this size.
    pub const fn new(frames: [&'a mut [u8]; 2], dims: Dims) -> Self {
        Self { frames, dims, rows: [0; 2] }
    }

    fn of(&mut self, eye: CameraSide) -> (&mut [u8], &mut u16) {
        let frame = of(eye, &mut self.frames);
        (frame, of(eye, &mut self.rows))
    }
}

impl RowSink for FrameRows<'_> {
    fn restart(&mut self, eye: CameraSide) {
        *self.of(eye).1 = 0;
    }

    fn row(&mut self, eye: CameraSide) -> &mut [u8] {
        let Dims { width, height } = self.dims;
        let (frame, rows) = self.of(eye);
        let frame = if *rows < height { frame } else { &mut [] };
        frame.chunks_exact_mut(usize::from(width).max(1)).nth((*rows).into()).unwrap_or_default()
    }

    fn push(&mut self, eye: CameraSide) -> Result<(), RowError> {
        let Dims { width, height } = self.dims;
        let (frame, rows) = self.of(eye);
        let (needed, given) = (usize::from(width) * usize::from(height), frame.len());
        if given < needed {
            return Err(RowError::Frame { needed, given });
        }
        if *rows >= height {
            return Err(RowError::TooMany);
        }
        *rows += 1;
        Ok(())
    }

    fn complete(&self) -> Option<Dims> {
        (self.rows == [self.dims.height; 2]).then_some(self.dims)
    }
}

/// A board's memory that has a rig: rows are rectified as they come.
#[derive(Debug)]
pub struct MemoryRows<'a, M> {
    memory: &'a mut M,
    dims: Dims,
}

impl<'a, M: Memory> MemoryRows<'a, M> {
    /// With the size of the rectified images of the memory's rig.
    pub const fn new(memory: &'a mut M, dims: Dims) -> Self {
        Self { memory, dims }
    }
}

impl<M: Memory> RowSink for MemoryRows<'_, M> {
    fn restart(&mut self, eye: CameraSide) {
        self.memory.restart_camera(eye);
    }

    fn row(&mut self, _: CameraSide) -> &mut [u8] {
        self.memory.raw_row()
    }

    fn push(&mut self, eye: CameraSide) -> Result<(), RowError> {
        self.memory.push_row(eye)
    }

    fn complete(&self) -> Option<Dims> {
        self.memory.is_rectified().then_some(self.dims)
    }
}
