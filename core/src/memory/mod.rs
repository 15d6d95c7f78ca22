//! Working memory of a run: words of the caller, cut into slices and lists.
//!
//! In: words, the size of the images, the number of segments. Out: the buffers of every stage.
//!
//! ```text
//! words   | head | marks | chain | strengths | rows | segments | candidates | ... |
//! head    the number of segments, the last layout, the lengths of the lists that results are in
//! ```
//!
//! # Cost
//! Some 300 instructions a run. Words are cleared before the first run and where the size of the
//! images, or [`Params::cell`], changes: an instruction for each.

#[allow(unsafe_code, reason = "slices and lists in words of the caller")]
mod carve;

use crate::bars::Bar;
use crate::image::{Dims, MAX_HEIGHT, MAX_WIDTH};
use crate::lines::{self, LineScratch, Segment};
use crate::list::List;
use crate::matching::consistency::Neighbour;
use crate::matching::{Candidate, Search, Workspace};
use crate::params::Params;
use crate::report::Ranked;
use crate::result::Match;
use crate::support::SupportPoint;
pub use carve::MemorySlice;
use carve::{Layout, Limits, Word};
use core::fmt;
use core::mem::MaybeUninit;
use core::ops::{Deref, DerefMut};

/// A pair that cannot be matched as planned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RunError {
    /// An image has another size than planned.
    #[error("planned for {planned}, the frame is {given}")]
    SizeMismatch {
        /// Size planned for.
        planned: Dims,
        /// Size given.
        given: Dims,
    },
    /// The working memory was made for smaller images or fewer segments.
    #[error("the memory has {given} words, these images need {needed}")]
    MemoryTooSmall {
        /// Words needed ([`Capacity::words`]).
        needed: usize,
        /// Words given.
        given: usize,
    },
}

/// Most support points among the hypotheses of an object.
pub(crate) const OBJECT_POINTS: usize = 24;

/// Segments listed in each image by default.
const DEFAULT_SEGMENTS: usize = 640;

/// Largest images (px), numbers of segments and squares of a working memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacity {
    /// Size of the largest images, px; at most 1280x1280, more counts as that.
    pub dims: Dims,
    /// Number of segments listed in each image, 1 ..= 4096; others count as the nearest of these.
    pub segments: u16,
    /// The smallest [`Params::cell`], px; below 8 counts as 8. With a smaller one the squares grow
    /// until their segments fit.
    pub cell: u16,
    /// With memory for a second core, so that [`Matcher::run_on`](crate::Matcher::run_on) matches
    /// segments on both: at QVGA 48 KB more.
    pub two_cores: bool,
}

impl Capacity {
    /// Room for images of this size, 640 segments in each, and the default [`Params::cell`].
    #[must_use]
    pub const fn new(dims: Dims) -> Self {
        Self {
            dims,
            segments: DEFAULT_SEGMENTS as u16,
            cell: Params::DEFAULT.cell,
            two_cores: false,
        }
    }

    /// Number of words of a memory with this capacity, the same on every machine.
    ///
    /// ```
    /// use linestereo::{Capacity, Dims};
    /// let qvga = Capacity::new(Dims { width: 320, height: 240 });
    /// assert!(qvga.words() * 8 < 110 * 1024);
    /// ```
    #[must_use]
    pub const fn words(&self) -> usize {
        self.layout().words()
    }

    /// Largest number of segments matched: one per square of `cell`, at most 4096.
    #[must_use]
    pub const fn candidates(&self) -> usize {
        self.layout().candidates as usize
    }

    const fn layout(&self) -> Layout {
        let Dims { width, height } = self.dims;
        let dims = Dims {
            width: if width > MAX_WIDTH { MAX_WIDTH } else { width },
            height: if height > MAX_HEIGHT { MAX_HEIGHT } else { height },
        };
        let most = lines::MAX_SEGMENTS as u16;
        let segments = match self.segments {
            0 => 1,
            segments if segments > most => most,
            segments => segments,
        };
        let cell = if self.cell < 8 { 8 } else { self.cell };
        // One per square. A fine grid of squares would take most of the memory for candidates that
        // images do not have.
        let squares = dims.width.div_ceil(cell) as u32 * dims.height.div_ceil(cell) as u32;
        let candidates = if squares > most as u32 { most } else { squares as u16 };
        Layout { dims, segments, candidates, two_cores: self.two_cores }
    }
}

impl Layout {
    /// The layout of a run; the number of words needed if there are fewer.
    fn of_run(dims: Dims, cell: u16, limits: Limits, words: usize) -> Result<Self, usize> {
        let layout = |cell| {
            let segments = limits.segments;
            let layout = Capacity { dims, segments, cell, two_cores: false }.layout();
            Self { candidates: layout.candidates.min(limits.candidates), ..layout }
        };
        let (mut found, least) = (layout(cell), layout(cell.max(Params::DEFAULT.cell)));
        while let Some(missing) = found.words().checked_sub(words).filter(|&missing| missing > 0) {
            if found.candidates <= least.candidates {
                return Err(least.words());
            }
            // Never too many: what is rounded up to words is less than a candidate.
            let dropped = (missing * size_of::<Word>() / CANDIDATE_BYTES).max(1);
            found.candidates =
                found.candidates.saturating_sub(dropped as u16).max(least.candidates);
        }
        let both = Self { two_cores: true, ..found };
        Ok(if both.words() <= words { both } else { found })
    }
}

/// Bytes of a candidate in all buffers that have one each.
const CANDIDATE_BYTES: usize =
    size_of::<Candidate>() + size_of::<Neighbour>() + size_of::<Ranked>() + size_of::<Match>();

/// Working memory of a run, in a static or on the heap, of [`Capacity::words`]. `SEGMENTS` is
/// [`Capacity::segments`]; no more than `CANDIDATES` of them are matched. Its content before a run
/// does not influence a result.
///
/// ```
/// use linestereo::{Capacity, Dims};
///
/// const DIMS: Dims = Dims { width: 320, height: 240 };
/// type Memory = linestereo::Memory<{ Capacity::new(DIMS).words() }>;
/// static MEMORY: Memory = Memory::new(); // all zero: it takes no flash
///
/// const MANY: Capacity = Capacity { segments: 1024, ..Capacity::new(DIMS) };
/// type Larger = linestereo::Memory<{ MANY.words() }, 1024>;
/// assert!(size_of::<Larger>() > size_of::<Memory>());
/// ```
#[repr(transparent)]
pub struct Memory<
    const WORDS: usize,
    const SEGMENTS: usize = { DEFAULT_SEGMENTS },
    const CANDIDATES: usize = { lines::MAX_SEGMENTS },
>([Word; WORDS]);

impl<const WORDS: usize, const SEGMENTS: usize, const CANDIDATES: usize>
    Memory<WORDS, SEGMENTS, CANDIDATES>
{
    /// Size, bytes.
    pub const BYTES: usize = size_of::<Self>();

    /// Cleared memory.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(0 < SEGMENTS && SEGMENTS <= lines::MAX_SEGMENTS, "1 to 4096 segments") };
        const { assert!(CANDIDATES <= lines::MAX_SEGMENTS, "at most 4096 candidates") };
        Self([MaybeUninit::new(0); WORDS])
    }
}

impl<const WORDS: usize, const SEGMENTS: usize, const CANDIDATES: usize> Default
    for Memory<WORDS, SEGMENTS, CANDIDATES>
{
    fn default() -> Self {
        Self::new()
    }
}

impl<const WORDS: usize, const SEGMENTS: usize, const CANDIDATES: usize> fmt::Debug
    for Memory<WORDS, SEGMENTS, CANDIDATES>
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

impl<const WORDS: usize, const SEGMENTS: usize, const CANDIDATES: usize> Deref
    for Memory<WORDS, SEGMENTS, CANDIDATES>
{
    type Target = MemorySlice;

    fn deref(&self) -> &MemorySlice {
        MemorySlice::of(&self.0)
    }
}

impl<const WORDS: usize, const SEGMENTS: usize, const CANDIDATES: usize> DerefMut
    for Memory<WORDS, SEGMENTS, CANDIDATES>
{
    fn deref_mut(&mut self) -> &mut MemorySlice {
        let (segments, candidates) = (SEGMENTS as u16, CANDIDATES as u16);
        MemorySlice::of_mut(&mut self.0, Limits { segments, candidates })
    }
}

/// The buffers of a run; all lists are empty before it.
#[derive(Debug)]
pub(crate) struct Buffers<'a> {
    pub(crate) scratch: Scratch<'a>,
    pub(crate) second: Option<Second<'a>>,
    pub(crate) left: List<'a, Segment>,
    pub(crate) right: List<'a, Segment>,
    pub(crate) candidates: List<'a, Candidate>,
    pub(crate) neighbours: &'a mut [Neighbour],
    pub(crate) order: List<'a, Ranked>,
    pub(crate) support: List<'a, SupportPoint>,
    pub(crate) matches: List<'a, Match>,
    pub(crate) bars: List<'a, Bar>,
}

/// Buffers of a second core, and those that only two need.
#[derive(Debug)]
pub(crate) struct Second<'a> {
    pub(crate) scratch: Scratch<'a>,
    /// Where each segment is searched.
    pub(crate) searches: List<'a, Search>,
    /// Bars that the second core has found.
    pub(crate) bars: List<'a, Bar>,
}

/// Most bars that the second core finds.
const SECOND_BARS: usize = 96;

/// Buffers that each core has its own of.
#[derive(Debug)]
pub(crate) struct Scratch<'a> {
    pub(crate) marks: &'a mut [u32],
    pub(crate) chain: &'a mut [u16],
    pub(crate) strengths: &'a mut [u8],
    pub(crate) rows: &'a mut [u8],
    pub(crate) work: &'a mut Workspace,
}

impl Scratch<'_> {
    /// Those for the lines of an image.
    pub(crate) fn lines(&mut self) -> LineScratch<'_> {
        LineScratch { marks: self.marks, chain: self.chain, strengths: self.strengths }
    }
}
