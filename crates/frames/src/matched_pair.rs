//! A matched pair that owns its images and its memory.
//!
//! In: a matcher, images. Out: what [`Matched`] answers, for callers that cannot keep a borrow: a
//! loop whose questions come later, another language.

use crate::GrayImage;
use core::fmt;
use core::mem::MaybeUninit;
use linestereo::image::{Span, ViewError};
use linestereo::{Capacity, Dims, Gray, Matched, Matcher, MemorySlice, Options, RunError};
use self_cell::{MutBorrow, self_cell};

/// Segments listed in each image: as many as the core can number.
const SEGMENTS: u16 = 4096;

/// Both images of a pair and the memory that it is matched in.
#[derive(Debug, Default)]
pub struct PairBuffers {
    /// Left and right.
    pub images: [GrayImage; 2],
    /// Their usable pixels, row by row; none where all are.
    pub usable: [Vec<Span>; 2],
    words: Vec<MaybeUninit<u64>>,
}

impl PairBuffers {
    /// Buffers for these images.
    pub fn new(images: [GrayImage; 2], usable: [Vec<Span>; 2]) -> Self {
        Self { images, usable, words: Vec::new() }
    }

    /// Copies images into the buffers.
    pub fn copy(&mut self, pair: [Gray<'_>; 2]) {
        for ((image, usable), view) in self.images.iter_mut().zip(&mut self.usable).zip(pair) {
            image.dims = view.dims();
            image.pixels.clear();
            let rows = (0..usize::from(view.dims().height)).filter_map(|y| view.row(y));
            rows.for_each(|row| image.pixels.extend_from_slice(row));
            usable.clear();
            usable.extend_from_slice(view.valid());
        }
    }

    fn run(
        &mut self,
        matcher: &mut Matcher,
        options: Options<'_>,
    ) -> Result<Matched<'_>, MatchError> {
        let view = |eye: usize| {
            let view = self.images[eye].view()?;
            if self.usable[eye].is_empty() { Ok(view) } else { view.with_valid(&self.usable[eye]) }
        };
        let (left, right) = (view(0)?, view(1)?);
        let memory = memory(&mut self.words, matcher.dims());
        Ok(matcher.run_with(memory, left, right, options)?)
    }
}

/// Memory for images of this size with any parameters, in these words.
pub fn memory(words: &mut Vec<MaybeUninit<u64>>, dims: Dims) -> &mut MemorySlice {
    // The finest squares that there are.
    let capacity = Capacity { dims, segments: SEGMENTS, cell: 8, two_cores: false };
    words.resize(capacity.words(), MaybeUninit::uninit());
    MemorySlice::new(words, SEGMENTS)
}

/// A pair that cannot be matched.
#[derive(Debug, thiserror::Error)]
pub enum MatchError {
    /// Pixels or a size that are no image.
    #[error(transparent)]
    View(#[from] ViewError),
    /// It is not of the planned size.
    #[error(transparent)]
    Run(#[from] RunError),
}

self_cell!(
    struct Cell {
        owner: MutBorrow<PairBuffers>,
        #[covariant]
        dependent: Matched,
    }
);

/// A matched pair with its images and its memory.
pub struct MatchedPair(Cell);

impl MatchedPair {
    /// Matches a pair.
    ///
    /// # Errors
    /// Pixels that are no image, or one that is not of the matcher's size.
    pub fn run(
        matcher: &mut Matcher,
        buffers: PairBuffers,
        options: Options<'_>,
    ) -> Result<Self, MatchError> {
        let buffers = MutBorrow::new(buffers);
        Cell::try_new(buffers, |buffers| buffers.borrow_mut().run(matcher, options)).map(Self)
    }

    /// The results of the pair.
    pub fn get(&self) -> &Matched<'_> {
        self.0.borrow_dependent()
    }

    /// Asks what needs the memory.
    pub fn ask<T>(&mut self, ask: impl FnOnce(&mut Matched<'_>) -> T) -> T {
        self.0.with_dependent_mut(|_, matched| ask(matched))
    }

    /// The buffers, for the next pair.
    #[must_use]
    pub fn into_buffers(self) -> PairBuffers {
        self.0.into_owner().into_inner()
    }
}

impl fmt::Debug for MatchedPair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.get().fmt(f)
    }
}
