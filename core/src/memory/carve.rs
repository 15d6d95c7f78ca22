//! Cutting words into slices and lists.
//!
//! The head of a memory says what was cut from its words last. It is cleared with a memory, and
//! only written here: what it says are values is values.

use super::{Buffers, OBJECT_POINTS, RunError, SECOND_BARS, Scratch, Second};
use crate::bars::{Bar, MOST_BARS};
use crate::image::Dims;
use crate::lines::{self, Segment, mark_words};
use crate::list::List;
use crate::matching::consistency::Neighbour;
use crate::matching::{Candidate, Search, Workspace};
use crate::report::Ranked;
use crate::result::Match;
use crate::row_memory::{BAND_ROWS, PLANES, row_bytes};
use crate::support::{SupportPoint, most_support_points};
use core::fmt;
use core::mem::MaybeUninit;

/// A word of memory, which everything in it is aligned to.
pub(crate) type Word = MaybeUninit<u64>;

/// Capacities of the lists of segments, and the most candidates.
#[derive(Clone, Copy, Default)]
pub(super) struct Limits {
    pub(super) segments: u16,
    pub(super) candidates: u16,
}

/// Capacities of a memory, and the last layout of the words behind it.
#[derive(Clone, Copy)]
#[repr(C)]
struct Head {
    limits: Limits,
    layout: Layout,
}

/// Numbers of elements; all 0 in words that nothing was cut from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) dims: Dims,
    pub(super) segments: u16,
    pub(super) candidates: u16,
    pub(super) two_cores: bool,
}

impl Layout {
    /// Words of all that [`MemorySlice::cut_as`] takes, and of the head.
    pub(super) const fn words(&self) -> usize {
        let Self { dims, segments, candidates, two_cores } = *self;
        let (segments, candidates) = (segments as usize, candidates as usize);
        let scratch = words_of::<u32>(mark_words(dims))
            + words_of::<u16>(lines::MAX_POSITIONS)
            + words_of::<u8>(lines::MAX_POSITIONS)
            + words_of::<u8>(row_bytes(dims.width) * BAND_ROWS * PLANES)
            + words_of::<Workspace>(1);
        let second = if two_cores {
            scratch + words_of::<Search>(candidates) + words_of::<Bar>(SECOND_BARS)
        } else {
            0
        };
        HEAD + scratch
            + second
            + 2 * words_of::<Segment>(segments)
            + words_of::<Candidate>(candidates)
            + words_of::<Neighbour>(candidates + OBJECT_POINTS)
            + words_of::<Ranked>(candidates + OBJECT_POINTS)
            + words_of::<SupportPoint>(most_support_points(dims))
            + words_of::<Match>(candidates)
            + words_of::<Bar>(MOST_BARS)
    }
}

const fn words_of<T>(count: usize) -> usize {
    (size_of::<T>() * count).div_ceil(size_of::<Word>())
}

/// Words of the head.
pub(super) const HEAD: usize = words_of::<Head>(1);
const _: () = assert!(align_of::<Head>() <= align_of::<Word>());

/// Working memory of any size: what a [`Memory`](crate::Memory) is without its size.
// The first words, if there are enough of them, are a `Head`, or all 0, which is one too. All other
// bits are 0 or were written by `cut`'s slices and lists, if the layout is not all 0.
#[repr(transparent)]
pub struct MemorySlice([Word]);

impl MemorySlice {
    /// Memory of these words, cleared; `segments` as in [`Capacity`](crate::Capacity). With fewer
    /// than [`Capacity::words`](crate::Capacity::words) runs fail.
    ///
    /// ```
    /// use core::mem::MaybeUninit;
    /// use linestereo::{Capacity, Dims, MemorySlice};
    /// let capacity = Capacity { segments: 64, ..Capacity::new(Dims { width: 64, height: 48 }) };
    /// let mut words = vec![MaybeUninit::uninit(); capacity.words()];
    /// let memory = MemorySlice::new(&mut words, capacity.segments);
    /// ```
    pub fn new(words: &mut [MaybeUninit<u64>], segments: u16) -> &mut Self {
        words.iter_mut().take(HEAD).for_each(|word| *word = MaybeUninit::new(0));
        Self::of_mut(words, Limits { segments, candidates: lines::MAX_SEGMENTS as u16 })
    }

    pub(super) fn of(words: &[Word]) -> &Self {
        // SAFETY: it has the layout of a slice of words, as it is transparent.
        unsafe { &*(core::ptr::from_ref(words) as *const Self) }
    }

    /// Memory of words whose head is one.
    #[inline]
    pub(super) fn of_mut(words: &mut [Word], limits: Limits) -> &mut Self {
        // SAFETY: as above.
        let memory = unsafe { &mut *(core::ptr::from_mut(words) as *mut Self) };
        if let Some((head, _)) = memory.split() {
            head.limits = limits;
        }
        memory
    }

    fn split(&mut self) -> Option<(&mut Head, &mut [Word])> {
        let (head, rest) = self.0.split_at_mut_checked(HEAD)?;
        // SAFETY: there is room for a head, aligned as asserted above, and it is one.
        Some((unsafe { &mut *head.as_mut_ptr().cast() }, rest))
    }

    /// The buffers of a run on images of this size, with empty lists.
    pub(crate) fn cut(&mut self, dims: Dims, cell: u16) -> Result<Buffers<'_>, RunError> {
        let given = self.0.len();
        let error = |needed| RunError::MemoryTooSmall { needed, given };
        let limits = self.split().map_or(Limits::default(), |(head, _)| head.limits);
        let layout = Layout::of_run(dims, cell, limits, given).map_err(error)?;
        self.cut_as(&layout).ok_or(error(layout.words()))
    }

    fn cut_as(&mut self, layout: &Layout) -> Option<Buffers<'_>> {
        let (head, words) = self.split()?;
        let words = words.get_mut(..layout.words().checked_sub(HEAD)?)?;
        if head.layout != *layout {
            words.fill(MaybeUninit::new(0));
            head.layout = *layout;
        }
        let Layout { dims, segments, candidates: most, two_cores } = *layout;
        let (segments, most) = (segments.into(), most.into());
        let mut rest = Rest(words);
        // SAFETY: the words are 0, or were cut into the same before.
        unsafe {
            Some(Buffers {
                scratch: rest.scratch(dims)?,
                second: if two_cores {
                    let scratch = rest.scratch(dims)?;
                    let (searches, bars) = (rest.list(most)?, rest.list(SECOND_BARS)?);
                    Some(Second { scratch, searches, bars })
                } else {
                    None
                },
                left: rest.list(segments)?,
                right: rest.list(segments)?,
                candidates: rest.list(most)?,
                neighbours: rest.values(most + OBJECT_POINTS)?,
                order: rest.list(most + OBJECT_POINTS)?,
                support: rest.list(most_support_points(dims))?,
                matches: rest.list(most)?,
                bars: rest.list(MOST_BARS)?,
            })
        }
    }
}

impl fmt::Debug for MemorySlice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "memory of {} words", self.0.len())
    }
}

/// # Safety
/// All bits 0 are a value, and no alignment is larger than that of a [`Word`].
unsafe trait Zeroed {}

// SAFETY: integers.
unsafe impl Zeroed for u8 {}
// SAFETY: as above.
unsafe impl Zeroed for u16 {}
// SAFETY: as above.
unsafe impl Zeroed for u32 {}
// SAFETY: integers and a bool.
unsafe impl Zeroed for Neighbour {}
// SAFETY: integers.
unsafe impl Zeroed for Workspace {}

/// Words that are not cut yet.
struct Rest<'a>(&'a mut [Word]);

impl<'a> Rest<'a> {
    /// The next `count` places for a `T`.
    #[inline]
    fn slots<T>(&mut self, count: usize) -> Option<&'a mut [MaybeUninit<T>]> {
        const { assert!(align_of::<T>() <= align_of::<Word>()) };
        let taken = self.0.split_off_mut(..words_of::<T>(count))?;
        // SAFETY: there is room for so many, aligned as the assertion says, which nobody else has.
        Some(unsafe { core::slice::from_raw_parts_mut(taken.as_mut_ptr().cast(), count) })
    }

    /// The next values.
    ///
    /// # Safety
    /// The words are 0, or were such values before.
    unsafe fn values<T: Zeroed>(&mut self, count: usize) -> Option<&'a mut [T]> {
        // SAFETY: as the caller says.
        Some(unsafe { self.slots(count)?.assume_init_mut() })
    }

    /// The next buffers of a core.
    ///
    /// # Safety
    /// As of [`Rest::values`].
    unsafe fn scratch(&mut self, dims: Dims) -> Option<Scratch<'a>> {
        // SAFETY: as the caller says.
        unsafe {
            Some(Scratch {
                marks: self.values(mark_words(dims))?,
                chain: self.values(lines::MAX_POSITIONS)?,
                strengths: self.values(lines::MAX_POSITIONS)?,
                rows: self.values(row_bytes(dims.width) * BAND_ROWS * PLANES)?,
                work: self.values(1)?.first_mut()?,
            })
        }
    }

    /// The next list.
    fn list<T>(&mut self, capacity: usize) -> Option<List<'a, T>> {
        self.slots(capacity).map(List::new)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::super::Capacity;
    use super::*;
    use std::vec;

    const DIMS: Dims = Dims { width: 64, height: 48 };

    /// Segments that two cores match in all words but so many.
    fn buffers_of_two(words: &mut [Word], capacity: Capacity, fewer: usize) -> Option<usize> {
        let words = &mut words[..capacity.words() - fewer];
        let buffers = MemorySlice::new(words, capacity.segments);
        let buffers = buffers.cut(capacity.dims, capacity.cell).unwrap();
        assert_eq!(buffers.second.is_some(), capacity.two_cores);
        buffers.second.map(|second| second.searches.capacity())
    }

    #[test]
    fn a_memory_is_cut_into_what_its_capacity_says() {
        let capacity = Capacity { dims: DIMS, segments: 70, cell: 9, two_cores: false };
        let mut words = vec![MaybeUninit::uninit(); capacity.words()];
        let memory = MemorySlice::new(&mut words, 70);
        let buffers = memory.cut(DIMS, 9).unwrap();
        let found = [&buffers.left, &buffers.right].map(|list| list.capacity());
        assert_eq!((found, buffers.candidates.capacity()), ([70, 70], 8 * 6));
        // A word less holds a candidate less, down to those of the default cell.
        let short = words.len() - 1;
        let buffers = MemorySlice::new(&mut words[..short], 70);
        assert_eq!(buffers.cut(DIMS, 9).unwrap().candidates.capacity(), 47);
        let needed = Capacity { cell: 20, ..capacity }.words();
        for (cell, given) in [(9, needed - 1), (20, needed - 1), (20, HEAD)] {
            let error = MemorySlice::new(&mut words[..given], 70).cut(DIMS, cell).err();
            assert_eq!(error, Some(RunError::MemoryTooSmall { needed, given }));
        }
        assert!(buffers_of_two(&mut words, capacity, 1).is_none());
        let both = Capacity { two_cores: true, ..capacity };
        let mut words = vec![MaybeUninit::uninit(); both.words()];
        assert_eq!(buffers_of_two(&mut words, both, 0), Some(8 * 6));
        assert!(MemorySlice::new(&mut words[..HEAD - 1], 70).cut(DIMS, 20).is_err());
        assert!(MemorySlice::new(&mut [], 70).cut(DIMS, 20).is_err());
        let buffers = MemorySlice::new(&mut words[..needed], 70);
        assert_eq!(buffers.cut(DIMS, 9).unwrap().candidates.capacity(), 4 * 3);
    }
}
