//! Working memory of a run, with its capacities as constants and without.

#[allow(unsafe_code, reason = "lists of a capacity that is known at run time only")]
mod carve;

use crate::bars::{Bar, MOST_BARS};
use crate::image::Dims;
use crate::lines::{self, Segment};
use crate::matching::consistency::Neighbour;
use crate::matching::{Candidate, Workspace};
use crate::report::Ranked;
use crate::result::Match;
pub use crate::row_memory::row_bytes;
use crate::row_memory::{BAND_ROWS, PLANES};
use crate::support::SupportPoint;
pub use crate::support::most_support_points;
pub use carve::{Capacity, Word};
use heapless::Vec;
use heapless::vec::VecView;

/// A pair that cannot be matched as planned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RunError {
    /// An image has another size than planned.
    #[error("planned for {planned}, the frame is {given}")]
    SizeMismatch {
        /// Size planned for.
        planned: Dims,
        /// Size given.
        given: Dims,
    },
    /// The working memory was made for smaller images.
    #[error("{name} of the scratch memory holds {given}, these images need {needed}")]
    ScratchTooSmall {
        /// Capacity of [`Scratch`] that is too small.
        name: &'static str,
        /// Capacity needed.
        needed: usize,
        /// Capacity given.
        given: usize,
    },
}

/// Most support points among the hypotheses of an object.
pub(crate) const OBJECT_POINTS: usize = 24;

/// Number of 32-bit words of marks for images of this size, a bit per pixel.
#[must_use]
pub const fn mark_words(dims: Dims) -> usize {
    (dims.width as usize * dims.height as usize).div_ceil(32)
}

/// Largest number of segments matched in images of this size: one per square of `cell` px.
#[must_use]
pub const fn most_candidates(dims: Dims, cell: u16) -> usize {
    (dims.width as usize).div_ceil(cell as usize) * (dims.height as usize).div_ceil(cell as usize)
}

/// Type of the [`Scratch`] for images of at most this size and so many segments in each image, 1
/// ..= 4096; `cell` is the smallest [`Params::cell`](crate::Params::cell) in px, the default one
/// without.
///
/// ```
/// type Memory = linestereo::scratch!(linestereo::Dims { width: 320, height: 240 }, 640);
/// let mut scratch = Memory::new(); // or in a static
/// assert!(Memory::BYTES < 110 * 1024 && size_of_val(&scratch.view()) <= 200);
/// ```
#[macro_export]
macro_rules! scratch {
    ($dims:expr, $segments:expr) => {
        $crate::scratch!($dims, $segments, cell: $crate::Params::DEFAULT.cell)
    };
    ($dims:expr, $segments:expr, cell: $cell:expr) => {
        $crate::Scratch<
            { $crate::scratch::row_bytes($dims.width) },
            { $crate::scratch::mark_words($dims) },
            { $segments },
            { $crate::scratch::most_candidates($dims, $cell) },
            { $crate::scratch::most_support_points($dims) },
        >
    };
}

/// Working memory of a run, made by the caller, in a static or on the heap:
/// [`scratch!`](crate::scratch!) names its type. Its content before a run does not influence a
/// result.
///
/// `ROW` is [`row_bytes`] of the widest image, `MARKS` is [`mark_words`] of the largest, `SEGMENTS`
/// bounds each list of segments as detected, `CANDIDATES` the left ones that are matched:
/// [`most_candidates`] is always enough. `SUPPORT` is [`most_support_points`] of the largest.
#[derive(Debug)]
pub struct Scratch<
    const ROW: usize,
    const MARKS: usize,
    const SEGMENTS: usize,
    const CANDIDATES: usize,
    const SUPPORT: usize,
> {
    marks: [u32; MARKS],
    chain: [u16; lines::MAX_POSITIONS],
    strengths: [u8; lines::MAX_POSITIONS],
    rows: Words<[[[u8; ROW]; BAND_ROWS]; PLANES]>,
    left: Vec<Segment, SEGMENTS>,
    right: Vec<Segment, SEGMENTS>,
    candidates: Vec<Candidate, CANDIDATES>,
    neighbours: [Neighbour; CANDIDATES],
    order: Vec<Ranked, CANDIDATES>,
    support: Vec<SupportPoint, SUPPORT>,
    matches: Vec<Match, CANDIDATES>,
    bars: Vec<Bar, MOST_BARS>,
    work: Workspace,
}

/// Bytes aligned to 4, since kernels load several words at a time.
#[derive(Debug)]
#[repr(align(4))]
struct Words<T>(T);

impl<
    const ROW: usize,
    const MARKS: usize,
    const SEGMENTS: usize,
    const CANDIDATES: usize,
    const SUPPORT: usize,
> Scratch<ROW, MARKS, SEGMENTS, CANDIDATES, SUPPORT>
{
    /// Size, bytes.
    pub const BYTES: usize = size_of::<Self>();

    /// Cleared memory.
    #[must_use]
    pub const fn new() -> Self {
        const {
            assert!(SEGMENTS <= lines::MAX_SEGMENTS, "a scratch memory lists at most 4096 segments")
        };
        Self {
            marks: [0; MARKS],
            chain: [0; lines::MAX_POSITIONS],
            strengths: [0; lines::MAX_POSITIONS],
            rows: Words([[[0; ROW]; BAND_ROWS]; PLANES]),
            left: Vec::new(),
            right: Vec::new(),
            candidates: Vec::new(),
            neighbours: [Neighbour::EMPTY; CANDIDATES],
            order: Vec::new(),
            support: Vec::new(),
            matches: Vec::new(),
            bars: Vec::new(),
            work: Workspace::EMPTY,
        }
    }

    /// The memory without its capacities, for a run.
    pub fn view(&mut self) -> ScratchView<'_> {
        ScratchView {
            marks: &mut self.marks,
            chain: &mut self.chain,
            strengths: &mut self.strengths,
            rows: self.rows.0.as_flattened_mut().as_flattened_mut(),
            left: &mut self.left,
            right: &mut self.right,
            candidates: &mut self.candidates,
            neighbours: &mut self.neighbours,
            order: &mut self.order,
            support: &mut self.support,
            matches: &mut self.matches,
            bars: &mut self.bars,
            work: &mut self.work,
        }
    }
}

impl<
    const ROW: usize,
    const MARKS: usize,
    const SEGMENTS: usize,
    const CANDIDATES: usize,
    const SUPPORT: usize,
> Default for Scratch<ROW, MARKS, SEGMENTS, CANDIDATES, SUPPORT>
{
    fn default() -> Self {
        Self::new()
    }
}

/// A [`Scratch`] without its capacities, for runs of any size.
#[derive(Debug)]
pub struct ScratchView<'a> {
    pub(crate) marks: &'a mut [u32],
    pub(crate) chain: &'a mut [u16],
    pub(crate) strengths: &'a mut [u8],
    pub(crate) rows: &'a mut [u8],
    pub(crate) left: &'a mut VecView<Segment>,
    pub(crate) right: &'a mut VecView<Segment>,
    pub(crate) candidates: &'a mut VecView<Candidate>,
    pub(crate) neighbours: &'a mut [Neighbour],
    pub(crate) order: &'a mut VecView<Ranked>,
    pub(crate) support: &'a mut VecView<SupportPoint>,
    pub(crate) matches: &'a mut VecView<Match>,
    pub(crate) bars: &'a mut VecView<Bar>,
    pub(crate) work: &'a mut Workspace,
}

impl ScratchView<'_> {
    /// The same memory for a shorter time.
    pub fn reborrow(&mut self) -> ScratchView<'_> {
        ScratchView {
            marks: self.marks,
            chain: self.chain,
            strengths: self.strengths,
            rows: self.rows,
            left: self.left,
            right: self.right,
            candidates: self.candidates,
            neighbours: self.neighbours,
            order: self.order,
            support: self.support,
            matches: self.matches,
            bars: self.bars,
            work: self.work,
        }
    }

    /// Checks that it is large enough for images of this size.
    pub(crate) fn check(&self, dims: Dims) -> Result<(), RunError> {
        let needed = [row_bytes(dims.width), mark_words(dims), most_support_points(dims)];
        let row = self.rows.len() / (BAND_ROWS * PLANES);
        let there =
            [("ROW", row), ("MARKS", self.marks.len()), ("SUPPORT", self.support.capacity())];
        match there.into_iter().zip(needed).find(|((_, given), needed)| given < needed) {
            Some(((name, given), needed)) => Err(RunError::ScratchTooSmall { name, needed, given }),
            None => Ok(()),
        }
    }

    /// Clears all lists.
    pub(crate) fn clear(&mut self) {
        self.left.clear();
        self.right.clear();
        self.support.clear();
        self.candidates.clear();
        self.matches.clear();
        self.bars.clear();
    }
}
