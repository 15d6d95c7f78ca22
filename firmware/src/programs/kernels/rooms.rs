//! Memory for what kernels read and write, and what is put there.
//!
//! In: a length, a distance. Out: a range next to a fence at every alignment; pixels of every kind,
//! the same in every run.

use crate::fence::Fence;
use crate::programs::random::Random;
use core::ops::Range;

/// Rooms end where a page does.
const PAGE: usize = Fence::PAGE;

/// Memory for one slice, and the fence before it. The one behind is that of the next room.
#[derive(Debug)]
#[repr(C)]
pub(super) struct Room<T, const N: usize> {
    before: Fence,
    pub(super) contents: [T; N],
}

impl<T: Copy, const N: usize> Room<T, N> {
    const fn new(value: T) -> Self {
        const { assert!(size_of::<Self>().is_multiple_of(PAGE)) };
        Self { before: Fence::NEW, contents: [value; N] }
    }
}

/// Bytes for a row.
pub(super) const ROW: usize = PAGE - Fence::BYTES;
/// Entries for a curve.
pub(super) const CURVE: usize = (2 * PAGE - Fence::BYTES) / 2;
/// Bytes for an image.
pub(super) const IMAGE: usize = 7 * PAGE - Fence::BYTES;
/// Places in a room of which each slice takes every one.
pub(super) const ALIGNMENTS: usize = 4;
/// Of an output that nothing was written to.
pub(super) const UNTOUCHED: u8 = 0xa5;

/// Memory for the inputs and the output of a kernel.
#[derive(Debug)]
#[repr(C, align(1024))]
pub struct Rooms {
    pub(super) rows: [Room<u8, ROW>; 3],
    pub(super) out: Room<u8, ROW>,
    pub(super) curve: Room<u16, CURVE>,
    pub(super) image: Room<u8, IMAGE>,
    behind: Fence,
}

impl Default for Rooms {
    fn default() -> Self {
        Self::new()
    }
}

impl Rooms {
    /// Number of fences.
    pub const FENCES: usize = 7;

    /// Empty rooms.
    pub const fn new() -> Self {
        Self {
            rows: [const { Room::new(0) }; 3],
            out: Room::new(0),
            curve: Room::new(0),
            image: Room::new(0),
            behind: Fence::NEW,
        }
    }

    /// The fences around all rooms.
    pub const fn fences(&self) -> [&Fence; Self::FENCES] {
        let [a, b, c] = &self.rows;
        [
            &a.before, &b.before, &c.before, &self.out.before, &self.curve.before,
            &self.image.before, &self.behind,
        ]
    }
}

/// Pattern of pixels.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Contents {
    Random,
    Black,
    White,
    Alternating,
    /// Black and white, in turn after one to nine pixels.
    Steps,
    /// Five levels next to each other: ties, and gradients that are not clipped.
    Similar,
}

impl Contents {
    pub(super) const ALL: [Self; 6] =
        [Self::Random, Self::Black, Self::White, Self::Alternating, Self::Steps, Self::Similar];

    pub(super) fn fill(self, random: &mut Random, pixels: &mut [u8]) {
        let mut last = 0;
        for pixel in pixels {
            last = match self {
                Self::Random => random.next() as u8,
                Self::Black => 0,
                Self::White => 255,
                Self::Alternating => !last,
                Self::Steps => {
                    if random.below(5) == 0 {
                        !last
                    } else {
                        last
                    }
                }
                Self::Similar => 126 + random.below(5) as u8,
            };
            *pixel = last;
        }
    }
}

/// Do two rooms hold the same? A word at a time: what the compiler calls for it on a board goes
/// byte by byte, and would take most of the time.
pub(super) fn same(a: &[u8], b: &[u8]) -> bool {
    let (words, rest) = a.as_chunks();
    let (other_words, other_rest) = b.as_chunks();
    let word = |bytes: &[u8; 4]| u32::from_ne_bytes(*bytes);
    words.iter().map(word).eq(other_words.iter().map(word)) && rest == other_rest
}

/// Where a slice lies in its room of `room` entries: so far from the front, or from the back.
pub(super) fn range(room: usize, length: usize, distance: usize, at_back: bool) -> Range<usize> {
    let start = if at_back { room - length - distance } else { distance };
    start..start + length
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_meet_fences_at_both_ends() {
        let rooms = Box::new(Rooms::new());
        let ends = |contents: &[u8]| (contents.as_ptr().addr(), contents.as_ptr_range().end.addr());
        let fences = rooms.fences().map(|fence| (&raw const *fence).addr());
        assert!(fences.iter().all(|fence| fence % PAGE == 0));
        let [a, b, c] = &rooms.rows;
        let ranges = [&a.contents[..], &b.contents, &c.contents, &rooms.out.contents].map(ends);
        for (range, fences) in ranges.iter().zip(fences.windows(2)) {
            assert_eq!(*range, (fences[0] + Fence::BYTES, fences[1]));
        }
        assert_eq!(ends(&rooms.image.contents), (fences[5] + Fence::BYTES, fences[6]));
        assert_eq!(rooms.curve.contents.as_ptr_range().end.addr(), fences[5]);
    }
}
