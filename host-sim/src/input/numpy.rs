//! NumPy's array files (`.npy`): shape and values, as far as an array can be an image.
//!
//! In: a file's bytes. Out: its size, and its values as floats, row-major.
//!
//! ```text
//! \x93NUMPY, major, minor version, length of the header: 2 bytes in version 1, 4 in later ones
//! {'descr': '<f4', 'fortran_order': False, 'shape': (20, 48), }          then the values
//! ```
//!
//! # Cost
//! Memory only for what the file holds: its length is compared with the header before any is taken.
//!
//! # Source
//! NumPy enhancement proposal 1. The header is read here and not by a library: the ones at hand bring a parser of all Python literals, and
//! take memory for what a header states.

use super::error::DisparityFault;
use linestereo::Dims;

/// Longer headers are no plain array's; NumPy itself reads no longer ones.
const MAX_HEADER_BYTES: usize = 10_000;

/// Reads an array of two dimensions, or of three of which one is 1.
pub(super) fn array(bytes: &[u8]) -> Result<(Dims, Vec<f32>), DisparityFault> {
    let (text, data) = split(bytes)?;
    let (width, height) = sides(shape(&text)?)?;
    let by_columns =
        match value(&text, "fortran_order").map(|order| order.split([',', '}']).next().unwrap_or("").trim()) {
            Some("False") => false,
            Some("True") => true,
            _ => return Err(broken("its header tells no fortran_order")),
        };
    let kind = value(&text, "descr").ok_or_else(|| broken("its header tells no descr"))?;
    let Some(kind) = quoted(kind) else { return Err(DisparityFault::ElementType("records".to_owned())) };
    let count = usize::from(width) * usize::from(height);
    let values = elements(kind, data, count, bytes.len())?;
    let values = if by_columns {
        let (width, height) = (usize::from(width), usize::from(height));
        (0..count).map(|i| values[i % width * height + i / width]).collect()
    } else {
        values
    };
    Ok((Dims { width, height }, values))
}

fn broken(what: &str) -> DisparityFault {
    DisparityFault::Array(what.to_owned())
}

/// The header's text, and what follows it.
fn split(bytes: &[u8]) -> Result<(String, &[u8]), DisparityFault> {
    let cut_off = || broken("its header is cut off");
    let (first, length) = match bytes.get(6..12).ok_or_else(cut_off)? {
        [1, _, low, high, ..] => (10, usize::from(u16::from_le_bytes([*low, *high]))),
        [_, _, length @ ..] => (12, length.iter().rev().fold(0, |sum, &byte| sum << 8 | usize::from(byte))),
        _ => return Err(cut_off()),
    };
    if length > MAX_HEADER_BYTES {
        return Err(DisparityFault::Array(format!("its header has {length} bytes")));
    }
    let (header, data) = bytes.get(first..).and_then(|rest| rest.split_at_checked(length)).ok_or_else(cut_off)?;
    Ok((String::from_utf8_lossy(header).into_owned(), data))
}

/// Text after a key and its colon; `None` where the header has no such key.
fn value<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let after = header.split_once(key)?.1.strip_prefix(['\'', '"'])?;
    Some(after.trim_start().strip_prefix(':')?.trim_start())
}

/// The text between quotes at the start.
fn quoted(text: &str) -> Option<&str> {
    let quote = text.chars().next().filter(|first| ['\'', '"'].contains(first))?;
    text[1..].split_once(quote).map(|(inner, _)| inner)
}

/// Lengths along each dimension.
fn shape(header: &str) -> Result<Vec<u64>, DisparityFault> {
    let list = value(header, "shape").and_then(|text| text.strip_prefix('(')?.split_once(')'));
    let (list, _) = list.ok_or_else(|| broken("its header tells no shape"))?;
    let numbers = list.split(',').map(str::trim).filter(|number| !number.is_empty());
    // What is no number is no length that an image has.
    Ok(numbers.map(|number| number.parse().unwrap_or(u64::MAX)).collect())
}

/// Width and height.
fn sides(shape: Vec<u64>) -> Result<(u16, u16), DisparityFault> {
    let long: Vec<u64> = match shape.len() {
        3 => shape.iter().copied().filter(|&side| side != 1).collect(),
        _ => shape.clone(),
    };
    let side = |side: u64| u16::try_from(side).ok().filter(|&side| side > 0);
    match long[..] {
        [height, width] => side(width).zip(side(height)).ok_or(DisparityFault::Shape(shape)),
        _ => Err(DisparityFault::Shape(shape)),
    }
}

/// The first `count` values of `data` as floats; their type in NumPy's words, such as `<f4`.
fn elements(kind: &str, data: &[u8], count: usize, file_bytes: usize) -> Result<Vec<f32>, DisparityFault> {
    let (is_big, kind) = match kind.strip_prefix(['<', '|', '=']) {
        Some(plain) => (false, plain),
        None => (kind.starts_with('>'), kind.strip_prefix('>').unwrap_or(kind)),
    };
    macro_rules! read {
        ($number:ty) => {
            floats(data, count, |bytes| {
                (if is_big { <$number>::from_be_bytes(bytes) } else { <$number>::from_le_bytes(bytes) }) as f32
            })
        };
    }
    let found = match kind {
        "f4" => read!(f32),
        "f8" => read!(f64),
        "u1" => read!(u8),
        "u2" => read!(u16),
        "u4" => read!(u32),
        "i2" => read!(i16),
        "i4" => read!(i32),
        "i8" => read!(i64),
        _ => return Err(DisparityFault::ElementType(kind.to_owned())),
    };
    found.map_err(|needed| DisparityFault::Truncated { needed: needed as u64, found: file_bytes as u64 })
}

/// Converts values of `SIZE` bytes; an error is how many bytes are needed.
fn floats<const SIZE: usize>(
    data: &[u8],
    count: usize,
    convert: impl Fn([u8; SIZE]) -> f32,
) -> Result<Vec<f32>, usize> {
    let needed = count.saturating_mul(SIZE);
    let (values, _) = data.get(..needed).ok_or(needed)?.as_chunks();
    Ok(values.iter().map(|&bytes| convert(bytes)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
        let length = header.len() as u32;
        let length = if version == 1 { (length as u16).to_le_bytes().to_vec() } else { length.to_le_bytes().to_vec() };
        [b"\x93NUMPY".as_slice(), &[version, 0], &length, header.as_bytes(), data].concat()
    }

    #[test]
    fn every_type_order_and_version_is_read() {
        let dims = Dims { width: 2, height: 1 };
        let two = |kind: &str, data: &[u8]| {
            file(1, &format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': (1, 2), }}"), data)
        };
        for (kind, data) in [
            ("<f4", [1.0_f32.to_le_bytes(), 3.0_f32.to_le_bytes()].concat()),
            (">f8", [1.0_f64.to_be_bytes(), 3.0_f64.to_be_bytes()].concat()),
            ("|u1", vec![1, 3]),
            (">u2", vec![0, 1, 0, 3]),
            ("<u4", vec![1, 0, 0, 0, 3, 0, 0, 0]),
            ("=i2", vec![1, 0, 3, 0]),
            (">i4", vec![0, 0, 0, 1, 0, 0, 0, 3]),
            ("<i8", [1_i64.to_le_bytes(), 3_i64.to_le_bytes()].concat()),
        ] {
            assert_eq!(array(&two(kind, &data)), Ok((dims, vec![1.0, 3.0])), "{kind}");
            let needed = data.len() as u64;
            let cut = array(&two(kind, &data[1..]));
            assert!(matches!(cut, Err(DisparityFault::Truncated { needed: n, .. }) if n == needed), "{kind}: {cut:?}");
        }
        let columns = file(2, "{\"shape\":(1,2,3),\"fortran_order\":True,\"descr\":\"|u1\"}\n", &[1, 4, 2, 5, 3, 6]);
        assert_eq!(array(&columns), Ok((Dims { width: 3, height: 2 }, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0])));
    }

    #[test]
    fn what_is_no_image_is_named() {
        let of = |header: &str| array(&file(1, header, &[0; 64])).unwrap_err();
        let order = "'fortran_order': False, 'shape': (2, 2)";
        assert!(matches!(of(&format!("{{'descr': [('x', '<f4')], {order}}}")), DisparityFault::ElementType(_)));
        assert_eq!(of(&format!("{{'descr': '<c8', {order}}}")), DisparityFault::ElementType("c8".to_owned()));
        for header in ["{'descr': '<f4', 'shape': (2, 2)}", "{'descr': '<f4', 'fortran_order': 1, 'shape': (2, 2)}"] {
            assert_eq!(of(header), broken("its header tells no fortran_order"));
        }
        assert_eq!(of(&format!("{{{order}}}")), broken("its header tells no descr"));
        assert_eq!(of("{'descr': '<f4', 'fortran_order': False}"), broken("its header tells no shape"));
        assert_eq!(array(b"\x93NUMPY\x01\x00\x40"), Err(broken("its header is cut off")));
        assert_eq!(array(b"\x93NUMPY\x01\x00\x40\x00{'descr'"), Err(broken("its header is cut off")));
    }
}
