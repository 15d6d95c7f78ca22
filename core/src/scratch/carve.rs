//! Working memory of any capacity, carved from memory of the caller: for sizes that are known at
//! run time only.
//!
//! In: words of 64 bits, capacities. Out: a [`ScratchView`] with cleared memory and empty lists.

use super::{
    BAND_ROWS, OBJECT_POINTS, PLANES, RunError, ScratchView, mark_words, most_candidates,
    most_support_points, row_bytes,
};
use crate::bars::{Bar, MOST_BARS};
use crate::image::{Dims, MAX_HEIGHT, MAX_WIDTH};
use crate::lines::{self, Segment};
use crate::matching::consistency::Neighbour;
use crate::matching::{Candidate, Workspace};
use crate::report::Ranked;
use crate::result::Match;
use crate::support::SupportPoint;
use core::mem::MaybeUninit;
use core::ptr::NonNull;
use heapless::Vec;
use heapless::vec::VecView;

/// A word of memory, which everything carved is aligned to.
pub type Word = MaybeUninit<u64>;

/// Capacities of a working memory, as [`scratch!`](crate::scratch!) takes them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacity {
    /// Size of the largest images, px; at most 1280x1280, more counts as that.
    pub dims: Dims,
    /// Number of segments listed in each image, 1 ..= 4096; others count as the nearest of these.
    pub segments: u16,
    /// The smallest [`Params::cell`](crate::Params::cell), px; below 8 counts as 8.
    pub cell: u16,
}

impl Capacity {
    /// Number of words of a memory with these capacities; the same on every machine with pointers
    /// of the same size.
    ///
    /// ```
    /// use linestereo::{Dims, scratch::Capacity};
    /// let qvga = Capacity { dims: Dims { width: 320, height: 240 }, segments: 640, cell: 20 };
    /// assert!(qvga.words() * 8 < 110 * 1024);
    /// ```
    #[must_use]
    pub const fn words(&self) -> usize {
        let Sizes { row, marks, segments, candidates, support } = self.sizes();
        words_of::<u32>(marks)
            + words_of::<u16>(lines::MAX_POSITIONS)
            + words_of::<u8>(lines::MAX_POSITIONS)
            + words_of::<u8>(row * BAND_ROWS * PLANES)
            + 2 * list_words::<Segment>(segments)
            + list_words::<Candidate>(candidates)
            + words_of::<Neighbour>(candidates + OBJECT_POINTS)
            + list_words::<Ranked>(candidates + OBJECT_POINTS)
            + list_words::<SupportPoint>(support)
            + list_words::<Match>(candidates)
            + list_words::<Bar>(MOST_BARS)
            + words_of::<Workspace>(1)
    }

    const fn sizes(&self) -> Sizes {
        let Dims { width, height } = self.dims;
        let dims = Dims {
            width: if width > MAX_WIDTH { MAX_WIDTH } else { width },
            height: if height > MAX_HEIGHT { MAX_HEIGHT } else { height },
        };
        let segments = match self.segments as usize {
            0 => 1,
            more if more > lines::MAX_SEGMENTS => lines::MAX_SEGMENTS,
            segments => segments,
        };
        let candidates = most_candidates(dims, if self.cell < 8 { 8 } else { self.cell });
        // A fine grid of cells would take most of the memory for candidates that images do not
        // have.
        let candidates =
            if candidates > lines::MAX_SEGMENTS { lines::MAX_SEGMENTS } else { candidates };
        Sizes {
            row: row_bytes(dims.width),
            marks: mark_words(dims),
            segments,
            candidates,
            support: most_support_points(dims),
        }
    }
}

/// Capacities as the const parameters of [`Scratch`](super::Scratch).
struct Sizes {
    row: usize,
    marks: usize,
    segments: usize,
    candidates: usize,
    support: usize,
}

const fn words_of<T>(count: usize) -> usize {
    (size_of::<T>() * count).div_ceil(size_of::<Word>())
}

/// Words of a list: those of an empty one, and its elements.
const fn list_words<T>(capacity: usize) -> usize {
    words_of::<Vec<T, 0>>(1) + words_of::<T>(capacity)
}

impl<'a> ScratchView<'a> {
    /// A memory of these capacities, cleared, made of at least [`Capacity::words`]. Results are
    /// those of a [`Scratch`](super::Scratch) that is large enough: an object's hypotheses, points
    /// and segments, have room in any case.
    ///
    /// # Errors
    /// [`RunError::ScratchTooSmall`] with fewer words.
    ///
    /// ```
    /// use core::mem::MaybeUninit;
    /// use linestereo::{Dims, ScratchView, scratch::Capacity};
    /// let capacity = Capacity { dims: Dims { width: 64, height: 48 }, segments: 64, cell: 20 };
    /// let mut words = vec![MaybeUninit::uninit(); capacity.words()];
    /// assert!(ScratchView::carve(&mut words, &capacity).is_ok());
    /// words.pop();
    /// assert!(ScratchView::carve(&mut words, &capacity).is_err());
    /// ```
    pub fn carve(memory: &'a mut [Word], capacity: &Capacity) -> Result<Self, RunError> {
        let given = memory.len();
        let error = RunError::ScratchTooSmall { name: "WORDS", needed: capacity.words(), given };
        Self::carve_from(&mut Rest(memory), &capacity.sizes()).ok_or(error)
    }

    fn carve_from(rest: &mut Rest<'a>, sizes: &Sizes) -> Option<Self> {
        Some(Self {
            marks: rest.zeros(sizes.marks)?,
            chain: rest.zeros(lines::MAX_POSITIONS)?,
            strengths: rest.zeros(lines::MAX_POSITIONS)?,
            rows: rest.zeros(sizes.row * BAND_ROWS * PLANES)?,
            left: rest.list(sizes.segments)?,
            right: rest.list(sizes.segments)?,
            candidates: rest.list(sizes.candidates)?,
            neighbours: rest.filled(sizes.candidates + OBJECT_POINTS, Neighbour::EMPTY)?,
            order: rest.list(sizes.candidates + OBJECT_POINTS)?,
            support: rest.list(sizes.support)?,
            matches: rest.list(sizes.candidates)?,
            bars: rest.list(MOST_BARS)?,
            work: rest.one(Workspace::EMPTY)?,
        })
    }
}

/// Integers, which are 0 where all bits are.
trait Integer: Copy {}

impl Integer for u8 {}
impl Integer for u16 {}
impl Integer for u32 {}

/// Memory that is not carved yet.
struct Rest<'a>(&'a mut [Word]);

impl<'a> Rest<'a> {
    /// The next words, which are nobody else's; `None` beyond the memory.
    #[inline(never)] // a dozen calls
    fn take(&mut self, words: usize) -> Option<NonNull<Word>> {
        let (taken, rest) = core::mem::take(&mut self.0).split_at_mut_checked(words)?;
        self.0 = rest;
        Some(NonNull::from(taken).cast())
    }

    /// The next words, all bits 0.
    #[inline(never)] // as `take`
    fn cleared(&mut self, words: usize) -> Option<NonNull<Word>> {
        let start = self.take(words)?;
        // SAFETY: so many words lie there, which nobody else has.
        unsafe { start.cast::<[u32; 2]>().write_bytes(0, words) };
        Some(start)
    }

    /// The next `count` integers, each 0; `None` beyond the memory.
    fn zeros<T: Integer>(&mut self, count: usize) -> Option<&'a mut [T]> {
        const { assert!(align_of::<T>() <= align_of::<Word>()) };
        let start: *mut T = self.cleared(words_of::<T>(count))?.as_ptr().cast();
        // SAFETY: `words_of` has room for `count` of them, aligned as the assertion says, of
        // cleared memory that nobody else has.
        Some(unsafe { core::slice::from_raw_parts_mut(start, count) })
    }

    /// The next `count` values, each `value`; `None` beyond the memory.
    fn filled<T: Copy>(&mut self, count: usize, value: T) -> Option<&'a mut [T]> {
        const { assert!(align_of::<T>() <= align_of::<Word>()) };
        let start: *mut T = self.take(words_of::<T>(count))?.as_ptr().cast();
        for index in 0..count {
            // SAFETY: `words_of` has room for `count` of them, aligned as the assertion says, and
            // nobody else has this memory.
            unsafe { start.add(index).write(value) };
        }
        // SAFETY: as above, and all of them are written.
        Some(unsafe { core::slice::from_raw_parts_mut(start, count) })
    }

    fn one<T>(&mut self, value: T) -> Option<&'a mut T> {
        const { assert!(align_of::<T>() <= align_of::<Word>()) };
        let start: *mut T = self.take(words_of::<T>(1))?.as_ptr().cast();
        // SAFETY: there is room for one, aligned as the assertion says, and nobody else has this
        // memory.
        unsafe { start.write(value) };
        // SAFETY: as above, and it is written.
        Some(unsafe { &mut *start })
    }

    /// An empty list.
    #[inline(always)] // shorter where it is called than a call
    fn list<T>(&mut self, capacity: usize) -> Option<&'a mut VecView<T>> {
        let start: *mut Vec<T, 0> = self.take(list_words::<T>(capacity))?.as_ptr().cast();
        const { assert!(align_of::<Vec<T, 0>>() <= align_of::<Word>()) };
        // SAFETY: there is room for an empty list, aligned as the assertion says, and nobody else
        // has this memory.
        unsafe { start.write(Vec::new()) };
        let list =
            core::ptr::slice_from_raw_parts_mut(start.cast::<()>(), capacity) as *mut VecView<T>;
        // SAFETY: what coercion makes of a `Vec<T, N>` is its address and `N`: the length of every
        // such list is where that of an empty one is, and the elements follow. There is room for
        // `capacity` of them, which need not be written.
        Some(unsafe { &mut *list })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec;

    /// The layout that [`Rest::list`] relies on.
    #[test]
    fn lists_have_the_size_and_the_length_of_those_with_a_constant_capacity() {
        fn check<T: Clone, const N: usize>(value: &T) {
            let mut constant = Vec::<T, N>::new();
            let view: &mut VecView<T> = &mut constant;
            assert!(size_of_val(view) <= list_words::<T>(N) * 8);
            let mut words = vec![MaybeUninit::new(u64::MAX); list_words::<T>(N)];
            let list = Rest(&mut words).list::<T>(N).unwrap();
            assert_eq!((list.len(), list.capacity(), size_of_val(list)), (0, N, size_of_val(view)));
            while list.push(value.clone()).is_ok() {}
            assert_eq!(list.len(), N);
            let offset = |list: &VecView<T>| {
                list.as_ptr().addr() - core::ptr::from_ref(list).cast::<u8>().addr()
            };
            assert_eq!(offset(list), offset(view));
        }
        check::<u8, 7>(&3);
        check::<[u16; 3], 33>(&[1, 2, 3]);
        check::<u64, 5>(&9);
        check::<Segment, 19>(&Segment {
            ends: [crate::ImagePosition::default(); 2],
            rising: true,
            contrast: 3,
            near_horizontal: false,
        });
    }
}
