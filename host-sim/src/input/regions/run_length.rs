//! COCO's run lengths: column by column, runs of background and object in turns, starting with background.
//!
//! Compressed they are a string: six bits per character from '0' on, five of them value, one "there is more", the last value bit of a number
//! its sign; from the third on a number is the difference to the one two before.
//!
//! # Source
//! `rleFrString` and `rleDecode` of the COCO API (`maskApi.c`).

use super::Why;
use linestereo::Dims;

/// A number has at most so many characters: values are below 2^32.
const MOST_CHARACTERS: u32 = 7;

/// The numbers of a compressed string.
pub(super) fn decompressed(text: &str) -> Result<Vec<u64>, Why> {
    let mut counts: Vec<u64> = Vec::new();
    let mut bytes = text.bytes();
    while let Some(first) = bytes.next() {
        let (mut value, mut next, mut characters) = (0_i64, Some(first), 0);
        loop {
            let bits = next.and_then(|byte| byte.checked_sub(b'0')).filter(|bits| *bits < 64).ok_or(Why::BrokenMask)?;
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

/// A bit per pixel, row by row.
pub(super) fn bits(counts: &[u64], dims: Dims) -> Result<Vec<bool>, Why> {
    let (width, height) = (usize::from(dims.width), usize::from(dims.height));
    let mut bits = vec![false; width * height];
    let (mut position, mut inside) = (0_usize, false);
    for &count in counts {
        let end = usize::try_from(count).ok().and_then(|count| position.checked_add(count));
        let end = end.filter(|end| *end <= bits.len()).ok_or(Why::BrokenMask)?;
        if inside {
            (position..end).for_each(|index| bits[index % height * width + index / height] = true);
        }
        (position, inside) = (end, !inside);
    }
    if position == bits.len() { Ok(bits) } else { Err(Why::BrokenMask) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_come_before_rows() {
        let dims = Dims { width: 3, height: 2 };
        // Background 1, object 3, background 2: the lower left pixel, the middle column.
        let drawn: String =
            bits(&[1, 3, 2], dims).unwrap().iter().map(|&inside| if inside { '#' } else { '.' }).collect();
        assert_eq!(drawn, ".#.##.");
        assert_eq!(bits(&[1, 3], dims), Err(Why::BrokenMask));
        assert_eq!(bits(&[1, 3, 3], dims), Err(Why::BrokenMask));
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
