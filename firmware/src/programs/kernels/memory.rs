//! Copying and filling of memory, as the compiler calls for it: on Cortex-M these are the board's
//! own functions (`arch/cortex_m/memory.rs`).
//!
//! In: rooms. Out: comparisons with a loop over the bytes, at every length and alignment of both
//! ends, next to fences.

use super::rooms::{ALIGNMENTS, Contents, ROW, Rooms, UNTOUCHED, range};
use super::{Compared, Trial};

/// Copies and fills slices of equal length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Memory {
    pub(super) copy: fn(&mut [u8], &[u8]),
    pub(super) fill: fn(&mut [u8], u8),
}

impl Memory {
    /// Those that the compiler calls.
    pub(super) const CALLED: Self =
        Self { copy: |to, from| to.copy_from_slice(from), fill: |to, byte| to.fill(byte) };
}

/// Lengths: all short ones, which take every way through rounds and rest, and a row.
fn lengths() -> impl Iterator<Item = usize> {
    (0..=80_usize).chain([320])
}

/// Copies from every alignment to every other.
pub(super) fn copies(memory: Memory, rooms: &mut Rooms) -> Compared {
    let Trial { rooms, mut random, mut compared } = Trial::new("copy", rooms);
    for length in lengths() {
        for combination in 0..4 * ALIGNMENTS * ALIGNMENTS {
            let (distances, at_back) = (
                [combination % ALIGNMENTS, combination / ALIGNMENTS % ALIGNMENTS],
                combination / 16,
            );
            let [source, ..] = &mut rooms.rows;
            Contents::Random.fill(&mut random, &mut source.contents);
            let from = range(ROW, length, distances[0], at_back & 1 != 0);
            let to = range(ROW, length, distances[1], at_back & 2 != 0);
            let (starts, out) = ([from.start, to.start, 0, 0], &mut rooms.out.contents);
            out.fill(UNTOUCHED);
            (memory.copy)(&mut out[to.clone()], &source.contents[from.clone()]);
            let is_right = |(i, &found): (usize, &u8)| {
                found
                    == if to.contains(&i) {
                        source.contents[from.start + i - to.start]
                    } else {
                        UNTOUCHED
                    }
            };
            compared.note(out.iter().enumerate().all(is_right), length, (1, 0), starts);
        }
    }
    compared
}

/// Fills from every alignment on, with zeros and with others.
pub(super) fn fills(memory: Memory, rooms: &mut Rooms) -> Compared {
    let Trial { rooms, mut compared, .. } = Trial::new("fill", rooms);
    let out = &mut rooms.out.contents;
    for length in lengths() {
        for combination in 0..2 * ALIGNMENTS {
            for byte in [0, 0x5a, 0xff] {
                let to = range(ROW, length, combination % ALIGNMENTS, combination >= ALIGNMENTS);
                out.iter_mut().for_each(|out| *out = UNTOUCHED);
                (memory.fill)(&mut out[to.clone()], byte);
                let is_right = |(i, &found): (usize, &u8)| {
                    found == if to.contains(&i) { byte } else { UNTOUCHED }
                };
                compared.note(
                    out.iter().enumerate().all(is_right),
                    length,
                    (1, 0),
                    [to.start, 0, 0, 0],
                );
            }
        }
    }
    compared
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_ones_are_found() {
        let mut rooms = Box::new(Rooms::new());
        let all = [copies(Memory::CALLED, &mut rooms), fills(Memory::CALLED, &mut rooms)];
        assert!(
            all.iter().all(|compared| compared.first.is_none() && compared.comparisons > 1900),
            "{all:?}"
        );
        let wrong = Memory {
            copy: |to, from| {
                let whole = from.len() - usize::from(from.len() == 37);
                to[..whole].copy_from_slice(&from[..whole]);
            },
            fill: |to, byte| {
                to.iter_mut().skip(usize::from(byte == 0xff)).for_each(|to| *to = byte)
            },
        };
        assert_eq!(copies(wrong, &mut rooms).first.map(|at| at.length), Some(37));
        assert_eq!(fills(wrong, &mut rooms).first.map(|at| at.length), Some(1));
    }
}
