//! NumPy's array files (`.npy`): shape and values, as far as an array can be an image.
//!
//! In: a file from its beginning. Out: its size, and its values as floats, row-major.
//!
//! ```text
//! \x93NUMPY, major, minor version, length of the header: 2 bytes in version 1, 4 in later ones
//! {'descr': '<f4', 'fortran_order': False, 'shape': (20, 48), }          then the values
//! ```
//!
//! # Cost
//! Memory only for what the file holds: values become floats as they are read, and none is where
//! the header states more than is allowed.
//!
//! # Source
//! NumPy enhancement proposal 1. The header is read here and not by a library: the ones at hand
//! bring a parser of all Python literals, and take memory for what a header states.

use super::error::DisparityFault;
use crate::untrusted::{IMAGE_BYTES, PIXELS};
use linestereo::Dims;
use std::io::{self, BufReader, ErrorKind, Read};

/// Longer headers are no plain array's; NumPy itself reads no longer ones.
const MAX_HEADER_BYTES: usize = 10_000;

/// Reads an array of two dimensions, or of three of which one is 1.
pub(crate) fn array(file: impl Read) -> Result<(Dims, Vec<f32>), DisparityFault> {
    let mut file = BufReader::new(file);
    let text = header(&mut file)?;
    let (width, height) = sides(shape(&text)?)?;
    let by_columns = match value(&text, "fortran_order")
        .map(|order| order.split([',', '}']).next().unwrap_or("").trim())
    {
        Some("False") => false,
        Some("True") => true,
        _ => return Err(broken("its header tells no fortran_order")),
    };
    let kind = value(&text, "descr").ok_or_else(|| broken("its header tells no descr"))?;
    let Some(kind) = quoted(kind) else {
        return Err(DisparityFault::ElementType("records".to_owned()));
    };
    let count = usize::from(width) * usize::from(height);
    let values = elements(kind, &mut file, [height.into(), width.into()])?;
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

/// The header's text; behind it stand the values.
fn header(file: &mut impl Read) -> Result<String, DisparityFault> {
    let cut_off = |_: io::Error| broken("its header is cut off");
    let mut first = [0; 10];
    file.read_exact(&mut first).map_err(cut_off)?;
    let [.., version, _, low, high] = first;
    let mut length = usize::from(u16::from_le_bytes([low, high]));
    if version > 1 {
        let mut upper = [0; 2];
        file.read_exact(&mut upper).map_err(cut_off)?;
        length |= usize::from(u16::from_le_bytes(upper)) << 16;
    }
    if length > MAX_HEADER_BYTES {
        return Err(DisparityFault::Array(format!("its header has {length} bytes")));
    }
    let mut text = vec![0; length];
    file.read_exact(&mut text).map_err(cut_off)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
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
    // A text that is no number is no length of an image.
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

/// The values of an array of this height and width; their type in NumPy's words, such as `<f4`.
fn elements(kind: &str, file: &mut impl Read, sides: [u64; 2]) -> Result<Vec<f32>, DisparityFault> {
    let (is_big, kind) = match kind.strip_prefix(['<', '|', '=']) {
        Some(plain) => (false, plain),
        None => (kind.starts_with('>'), kind.strip_prefix('>').unwrap_or(kind)),
    };
    macro_rules! read {
        ($number:ty) => {
            floats(file, sides, |bytes| {
                (if is_big {
                    <$number>::from_be_bytes(bytes)
                } else {
                    <$number>::from_le_bytes(bytes)
                }) as f32
            })
        };
    }
    match kind {
        "f4" => read!(f32),
        "f8" => read!(f64),
        "u1" => read!(u8),
        "u2" => read!(u16),
        "u4" => read!(u32),
        "i2" => read!(i16),
        "i4" => read!(i32),
        "i8" => read!(i64),
        _ => Err(DisparityFault::ElementType(kind.to_owned())),
    }
}

/// Converts values of `SIZE` bytes each.
fn floats<const SIZE: usize>(
    file: &mut impl Read,
    sides: [u64; 2],
    convert: impl Fn([u8; SIZE]) -> f32,
) -> Result<Vec<f32>, DisparityFault> {
    let count = sides[0] * sides[1];
    let needed = count * SIZE as u64;
    if count > PIXELS || needed > IMAGE_BYTES {
        return Err(DisparityFault::Shape(sides.to_vec()));
    }
    let (mut values, mut bytes) = (Vec::new(), [0; SIZE]);
    for before in 0..count {
        match file.read_exact(&mut bytes) {
            Ok(()) => values.push(convert(bytes)),
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                return Err(DisparityFault::Truncated { needed, found: before * SIZE as u64 });
            }
            Err(error) => return Err(DisparityFault::Array(error.to_string())),
        }
    }
    // An archive tells a wrong checksum at the end of a file alone.
    file.read(&mut [0]).map_err(|error| DisparityFault::Array(error.to_string()))?;
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
        let length = (header.len() as u32).to_le_bytes();
        let length = &length[..if version == 1 { 2 } else { 4 }];
        [b"\x93NUMPY".as_slice(), &[version, 0], length, header.as_bytes(), data].concat()
    }

    #[test]
    fn every_type_order_and_version_is_read() {
        let dims = Dims { width: 2, height: 1 };
        let two = |kind: &str, data: &[u8]| {
            let rest = "'fortran_order': False, 'shape': (1, 2), ";
            file(1, &format!("{{'descr': '{kind}', {rest}}}"), data)
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
            assert_eq!(array(&*two(kind, &data)), Ok((dims, vec![1.0, 3.0])), "{kind}");
            let needed = data.len() as u64;
            let cut = array(&*two(kind, &data[1..]));
            assert!(
                matches!(cut, Err(DisparityFault::Truncated { needed: n, .. }) if n == needed),
                "{kind}: {cut:?}"
            );
        }
        let columns = file(
            2,
            "{\"shape\":(1,2,3),\"fortran_order\":True,\"descr\":\"|u1\"}\n",
            &[1, 4, 2, 5, 3, 6],
        );
        assert_eq!(
            array(&*columns),
            Ok((Dims { width: 3, height: 2 }, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]))
        );
    }

    #[test]
    fn what_is_no_image_is_named() {
        let order = "'fortran_order': False, 'shape': (2, 2)";
        let element = |kind: &str| DisparityFault::ElementType(kind.to_owned());
        for (header, fault) in [
            (&*format!("{{'descr': [('x', '<f4')], {order}}}"), element("records")),
            (&format!("{{'descr': '<c8', {order}}}"), element("c8")),
            ("{'descr': '<f4', 'shape': (2, 2)}", broken("its header tells no fortran_order")),
            (
                "{'descr': '<f4', 'fortran_order': 1, 'shape': (2, 2)}",
                broken("its header tells no fortran_order"),
            ),
            (&format!("{{{order}}}"), broken("its header tells no descr")),
            ("{'descr': '<f4', 'fortran_order': False}", broken("its header tells no shape")),
        ] {
            assert_eq!(array(&*file(1, header, &[0; 64])), Err(fault), "{header}");
        }
        for cut in [&b"\x93NUMPY\x01\x00\x40"[..], b"\x93NUMPY\x01\x00\x40\x00{'descr'"] {
            assert_eq!(array(cut), Err(broken("its header is cut off")));
        }
    }
}
