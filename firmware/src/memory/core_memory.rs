//! The core's memory, whatever its capacities are.

use linestereo::scratch::{mark_words, most_support_points, row_bytes};
use linestereo::{Dims, Scratch, ScratchView};

/// A [`Scratch`] without its capacities.
pub trait CoreMemory {
    /// Cleared, all zero.
    const CLEARED: Self;

    /// Do images of this size fit?
    fn fits(&self, dims: Dims) -> bool;

    /// For a run.
    fn view(&mut self) -> ScratchView<'_>;
}

impl<
    const ROW: usize,
    const MARKS: usize,
    const SEGMENTS: usize,
    const CANDIDATES: usize,
    const SUPPORT: usize,
> CoreMemory for Scratch<ROW, MARKS, SEGMENTS, CANDIDATES, SUPPORT>
{
    const CLEARED: Self = Self::new();

    fn fits(&self, dims: Dims) -> bool {
        row_bytes(dims.width) <= ROW
            && mark_words(dims) <= MARKS
            && most_support_points(dims) <= SUPPORT
    }

    fn view(&mut self) -> ScratchView<'_> {
        self.view()
    }
}
