//! Images and calibrations of Foxglove's own schemas: `foxglove.RawImage`, `CompressedImage` and `CameraCalibration`, in protobuf.
//!
//! Fields of other numbers are passed over, as protobuf asks for; of a field that comes twice the last one counts.
//!
//! # Source
//! <https://protobuf.dev/programming-guides/encoding>, and the schemas of <https://github.com/foxglove/foxglove-sdk>. Not the crate `prost`:
//! it copies the bytes of an image, and these are six kinds of fields.

use super::received::{CameraInfo, CompressedImage, Header, Image};

/// Most doubles of a field: coefficients of a lens, or a matrix.
const MOST_DOUBLES: usize = 64;

/// The value of a field.
#[derive(Clone, Copy)]
enum Value<'a> {
    Varint(u64),
    Fixed64([u8; 8]),
    Bytes(&'a [u8]),
    Fixed32([u8; 4]),
}

impl<'a> Value<'a> {
    fn bytes(self) -> Option<&'a [u8]> {
        if let Self::Bytes(bytes) = self { Some(bytes) } else { None }
    }

    fn text(self) -> Option<&'a str> {
        core::str::from_utf8(self.bytes()?).ok()
    }

    fn u32(self) -> Option<u32> {
        if let Self::Fixed32(bytes) = self { Some(u32::from_le_bytes(bytes)) } else { None }
    }

    /// Appends doubles: one, or a packed list.
    fn doubles(self, list: &mut Vec<f64>) -> Option<()> {
        match self {
            Self::Fixed64(bytes) => list.push(f64::from_le_bytes(bytes)),
            Self::Bytes(bytes) => {
                let (values, rest) = bytes.as_chunks();
                let is_whole = rest.is_empty() && values.len() <= MOST_DOUBLES;
                list.extend(is_whole.then_some(values)?.iter().map(|&value| f64::from_le_bytes(value)));
            }
            Self::Varint(_) | Self::Fixed32(_) => return None,
        }
        (list.len() <= MOST_DOUBLES).then_some(())
    }
}

/// A number of 7 bits a byte, the lowest first, and what is behind it.
fn varint(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let length = 1 + bytes.iter().take(10).position(|byte| byte & 0x80 == 0)?;
    let (own, rest) = bytes.split_at(length);
    let value = own.iter().rev().fold(0_u64, |value, byte| (value << 7) | u64::from(byte & 0x7f));
    Some((value, rest))
}

/// Calls `take` with the number and the value of each field; `None` where one is broken, or `take` says so.
fn fields<'a>(mut bytes: &'a [u8], mut take: impl FnMut(u64, Value<'a>) -> Option<()>) -> Option<()> {
    while !bytes.is_empty() {
        let (tag, rest) = varint(bytes)?;
        let (value, rest) = match tag & 7 {
            0 => varint(rest).map(|(value, rest)| (Value::Varint(value), rest))?,
            1 => rest.split_first_chunk().map(|(value, rest)| (Value::Fixed64(*value), rest))?,
            2 => {
                let (length, rest) = varint(rest)?;
                let (value, rest) = rest.split_at_checked(usize::try_from(length).ok()?)?;
                (Value::Bytes(value), rest)
            }
            5 => rest.split_first_chunk().map(|(value, rest)| (Value::Fixed32(*value), rest))?,
            _ => return None, // groups, which no one writes any more
        };
        take(tag >> 3, value)?;
        bytes = rest;
    }
    Some(())
}

/// `google.protobuf.Timestamp`, ns.
fn stamp_ns(value: Value<'_>) -> Option<i64> {
    let mut parts = [0_i64; 2];
    fields(value.bytes()?, |number, value| {
        if let (1 | 2, Value::Varint(value)) = (number, value) {
            parts[number as usize - 1] = value as i64;
        }
        Some(())
    })?;
    parts[0].checked_mul(1_000_000_000)?.checked_add(parts[1])
}

/// An image, pixel by pixel.
pub(super) fn image(message: &[u8]) -> Option<Image<'_>> {
    let header = Header { stamp_ns: 0, frame_id: "" };
    let mut image = Image { header, height: 0, width: 0, encoding: "", is_big_endian: false, step: 0, data: &[] };
    fields(message, |number, value| {
        match number {
            1 => image.header.stamp_ns = stamp_ns(value)?,
            2 => image.width = value.u32()?,
            3 => image.height = value.u32()?,
            4 => image.encoding = value.text()?,
            5 => image.step = value.u32()?,
            6 => image.data = value.bytes()?,
            7 => image.header.frame_id = value.text()?,
            _ => {}
        }
        Some(())
    })?;
    Some(image)
}

/// An image as a file.
pub(super) fn compressed(message: &[u8]) -> Option<CompressedImage<'_>> {
    let mut image = CompressedImage { header: Header { stamp_ns: 0, frame_id: "" }, data: &[] };
    fields(message, |number, value| {
        match number {
            1 => image.header.stamp_ns = stamp_ns(value)?,
            2 => image.data = value.bytes()?,
            4 => image.header.frame_id = value.text()?,
            _ => {}
        }
        Some(())
    })?;
    Some(image)
}

/// Calibration of a camera.
pub(super) fn calibration(message: &[u8]) -> Option<CameraInfo> {
    let (mut width, mut height, mut model) = (0, 0, String::new());
    let [mut d, mut k, mut r, mut p] = [const { Vec::new() }; 4];
    fields(message, |number, value| {
        match number {
            2 => width = value.u32()?,
            3 => height = value.u32()?,
            4 => value.text()?.clone_into(&mut model),
            5 => value.doubles(&mut d)?,
            6 => value.doubles(&mut k)?,
            7 => value.doubles(&mut r)?,
            8 => value.doubles(&mut p)?,
            _ => {}
        }
        Some(())
    })?;
    let (k, r, p) = (k.try_into().ok()?, r.try_into().ok()?, p.try_into().ok()?);
    Some(CameraInfo { height, width, model, d, k, r, p })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_in_any_order_and_broken_ones_refused() {
        // width, an unknown varint, frame_id, time, data.
        let message =
            [&[0x15, 64, 1, 0, 0, 0x78, 0x96, 1, 0x3a, 1, b'a', 0x0a, 4, 8, 2, 16, 5, 0x32, 2, 7, 9][..]].concat();
        let found = image(&message).unwrap();
        assert_eq!((found.width, found.header.frame_id, found.header.stamp_ns), (320, "a", 2_000_000_005));
        assert_eq!((found.data, found.height), (&[7, 9][..], 0));
        for end in [1, 4, 6, 7, 9, 12, 16, 20] {
            assert!(image(&message[..end]).is_none(), "{end}");
        }
        assert!(image(&[0x13]).is_none(), "a group");
        assert!(image(&[0x10, 1]).is_none(), "a width as varint");
        assert!(image(&[0x32, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 1]).is_none(), "2^64 - 1 bytes");
        assert!(image(&[0xff; 11]).is_none(), "no end");
        assert_eq!(calibration(&[]), None, "matrices are missing");
        let doubles = |tag: u8, count: usize| [&[tag, 8 * count as u8][..], &vec![0; 8 * count]].concat();
        let matrices = [doubles(0x32, 9), doubles(0x3a, 9), doubles(0x42, 12)].concat();
        assert_eq!(calibration(&matrices).unwrap().p, [0.0; 12]);
        // Not packed: each behind a tag.
        let single = [&[0x29][..], &2.5_f64.to_le_bytes()].concat();
        assert_eq!(calibration(&[&matrices[..], &single, &single].concat()).unwrap().d, [2.5, 2.5]);
        assert!(calibration(&[&matrices[..], &single.repeat(65)].concat()).is_none());
    }
}
