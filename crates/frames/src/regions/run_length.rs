//! COCO's run lengths: column by column, runs of background and object in turns, starting with
//! background.
//!
//! Compressed they are a string: six bits per character from '0' on, five of them value, one "there
//! is more", the last value bit of a number its sign; from the third on a number is the difference
//! to the one two before.
//!
//! # Source
//! `rleFrString` and `rleDecode` of the COCO API (`maskApi.c`).

use super::Why;
use core::ops::Range;
use linestereo::{Dims, image::Span, objects::Run};

/// A number has at most so many characters: values are below 2^32.
const MOST_CHARACTERS: u32 = 7;

/// The numbers of a compressed string.
pub(crate) fn decompressed(text: &str) -> Result<Vec<u64>, Why> {
    let mut counts: Vec<u64> = Vec::new();
    let mut bytes = text.bytes();
    while let Some(first) = bytes.next() {
        let (mut value, mut next, mut characters) = (0_i64, Some(first), 0);
        loop {
            let bits = next
                .and_then(|byte| byte.checked_sub(b'0'))
                .filter(|bits| *bits < 64)
                .ok_or(Why::BrokenMask)?;
            value |= i64::from(bits & 0x1f) << (5 * characters);
            characters += 1;
            if bits & 0x20 == 0 {
                if bits & 0x10 != 0 {
                    value |= -1 << (5 * characters);
                }
                break;
            }
            if characters == MOST_CHARACTERS {
                return Err(Why::BrokenMask);
            }
            next = bytes.next();
        }
        let before = if counts.len() > 2 { counts[counts.len() - 2] as i64 } else { 0 };
        counts.push(u64::try_from(before + value).map_err(|_| Why::BrokenMask)?);
    }
    Ok(counts)
}

/// The rows' runs of an image of this size, with label 1; an error also where they are more than
/// `most`.
///
/// # Cost
/// A step for each number and column, and one for each row at which a column differs from the one
/// before it: nothing for each pixel.
pub(crate) fn runs(counts: &[u64], dims: Dims, most: usize) -> Result<Vec<Run>, Why> {
    let (width, height) = (usize::from(dims.width), usize::from(dims.height));
    let mut outline = Outline { starts: vec![None; height], runs: Vec::new(), most };
    // Rows of the column at hand that are inside, and of the one before it.
    let (mut rows, mut before): (Vec<Range<usize>>, Vec<Range<usize>>) = (Vec::new(), Vec::new());
    let (mut position, mut inside, mut column) = (0_usize, false, 0_u16);
    for &count in counts {
        let end = usize::try_from(count).ok().and_then(|count| position.checked_add(count));
        let end = end.filter(|end| *end <= width * height).ok_or(Why::BrokenMask)?;
        while position < end {
            let top = usize::from(column) * height;
            let part = position - top..end.min(top + height) - top;
            position = top + part.end;
            let is_last = part.end == height;
            match rows.last_mut() {
                _ if !inside => {}
                Some(last) if last.end == part.start => last.end = part.end,
                _ => rows.push(part),
            }
            if is_last {
                outline.next(column, &before, &rows)?;
                (before, rows) = (rows, before);
                rows.clear();
                column += 1;
            }
        }
        inside = !inside;
    }
    if position != width * height {
        return Err(Why::BrokenMask);
    }
    outline.next(dims.width, &before, &[])?;
    outline.runs.sort_unstable_by_key(|run| (run.y, run.span.start));
    Ok(outline.runs)
}

/// Runs by row, of columns that come one after the other.
struct Outline {
    /// Where the run that is open begins, of each row.
    starts: Vec<Option<u16>>,
    runs: Vec<Run>,
    most: usize,
}

impl Outline {
    /// The next column: rows of one of the two alone begin or end a run.
    fn next(
        &mut self,
        column: u16,
        before: &[Range<usize>],
        rows: &[Range<usize>],
    ) -> Result<(), Why> {
        let mut ends: Vec<usize> =
            before.iter().chain(rows).flat_map(|part| [part.start, part.end]).collect();
        ends.sort_unstable();
        for pair in ends.as_chunks().0 {
            let [from, to]: [usize; 2] = *pair;
            for (start, y) in self.starts[from..to].iter_mut().zip(from as u16..) {
                match start.take() {
                    None => *start = Some(column),
                    Some(start) => {
                        self.runs.push(Run { label: 1, y, span: Span { start, end: column } })
                    }
                }
            }
            if self.runs.len() > self.most {
                return Err(Why::TooMuch);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mask_is_drawn_as_it_is_read() {
        let dims = Dims { width: 5, height: 4 };
        for bits in 0..1_u32 << 20 {
            // Some thousands of all the masks there are.
            if bits.wrapping_mul(0x9e37_79b9) >> 24 != 7 {
                continue;
            }
            let is_set = |index: usize| bits >> index & 1 == 1;
            let mut counts = vec![0_u64];
            for index in 0..20 {
                if is_set(index) == counts.len().is_multiple_of(2) {
                    *counts.last_mut().unwrap() += 1;
                } else {
                    counts.push(1);
                }
            }
            let found = runs(&counts, dims, 20).unwrap();
            if let Some(fewer) = found.len().checked_sub(1) {
                assert_eq!(runs(&counts, dims, fewer), Err(Why::TooMuch), "{counts:?}");
            }
            for wrong in [&counts[1..], &[&counts[..], &[1]].concat()] {
                let is_whole = wrong.iter().sum::<u64>() == 20; // without a background at first
                assert_eq!(runs(wrong, dims, 20).is_ok(), is_whole, "{wrong:?}");
            }
            let mut drawn = 0;
            for run in found {
                (run.span.start..run.span.end).for_each(|x| drawn |= 1 << (x * 4 + run.y));
            }
            assert_eq!(drawn, bits, "{counts:?}");
        }
    }

    /// Written by pycocotools 2.0.
    #[test]
    fn strings_are_those_of_the_coco_api() {
        assert_eq!(decompressed("032NO30N0000").unwrap(), [0, 3, 2, 1, 1, 4, 1, 2, 1, 2, 1, 2]);
        assert_eq!(decompressed("n^g0Z5V2000").unwrap(), [24030, 170, 70, 170, 70, 170]);
        for broken in ["0 ", "n", "\u{7f}", "oooooooooo", "1N0O"] {
            assert_eq!(decompressed(broken), Err(Why::BrokenMask), "{broken}");
        }
    }
}
