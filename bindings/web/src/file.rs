//! PNG of every kind, and binary PGM and PPM of 8 bits, to grey as the PC reads them.

use crate::{IMAGE_BYTES, dims_of};
use linestereo_frames::grey::{StoredGray, Values, luma};
use png::{BitDepth, ColorType, Decoder, Limits, Transformations};
use std::io::Cursor;

/// Reads an image file.
pub fn read(bytes: &[u8]) -> Result<StoredGray, String> {
    match bytes {
        [b'P', b'5', ..] => plain(bytes, 1).ok_or_else(broken_plain),
        [b'P', b'6', ..] => plain(bytes, 3).ok_or_else(broken_plain),
        [0x89, b'P', b'N', b'G', ..] => png(bytes).map_err(|what| match what {
            png::DecodingError::LimitsExceeded => {
                "an image of more than 128 MiB of pixels is not read; give a smaller one".to_owned()
            }
            // Its own words would cost the page 3 KB.
            _ => "a damaged PNG; give another file".to_owned(),
        })?,
        _ => Err(
            "not an image that is read; give PNG, PGM, or what this browser shows, such as JPEG"
                .to_owned(),
        ),
    }
}

fn broken_plain() -> String {
    "a PGM or PPM that is damaged or not of 8 bits; give another file, or a PNG".to_owned()
}

/// Width, height, largest value, and pixels of so many bytes.
fn plain(bytes: &[u8], channels: usize) -> Option<StoredGray> {
    let (mut at, mut numbers) = (2, [0_u32; 3]);
    for number in &mut numbers {
        loop {
            match bytes.get(at)? {
                b'#' => at += bytes[at..].iter().position(|&byte| byte == b'\n')?,
                byte if byte.is_ascii_whitespace() => at += 1,
                _ => break,
            }
        }
        let length = bytes[at..].iter().position(|byte| !byte.is_ascii_digit())?;
        *number = core::str::from_utf8(&bytes[at..at + length]).ok()?.parse().ok()?;
        at += length;
    }
    let [width, height, largest] = numbers;
    let dims = dims_of(width, height).ok().filter(|_| largest == 255)?;
    let count = usize::from(dims.width) * usize::from(dims.height);
    let values = bytes.get(at + 1..at + 1 + count * channels)?;
    Some(StoredGray {
        dims,
        values: Values::Eight(grey(values, channels, |value| u32::from(value), |grey| grey as u8)),
    })
}

/// A refusal inside, since a text is none of the decoder's errors.
fn png(bytes: &[u8]) -> Result<Result<StoredGray, String>, png::DecodingError> {
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: IMAGE_BYTES });
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info()?;
    let dims = match dims_of(reader.info().width, reader.info().height) {
        Ok(dims) => dims,
        Err(reason) => return Ok(Err(reason)),
    };
    let size = reader.output_buffer_size().filter(|&size| size <= IMAGE_BYTES);
    let mut stored = vec![0; size.ok_or(png::DecodingError::LimitsExceeded)?];
    reader.next_frame(&mut stored)?;
    if reader.info().exif_metadata.as_ref().is_some_and(|exif| is_turned(exif)) {
        return Ok(Err("a PNG that its EXIF turns; store it upright".to_owned()));
    }
    let (color, depth) = reader.output_color_type();
    let channels = color.samples();
    let values = if depth == BitDepth::Sixteen {
        let (pairs, _) = stored.as_chunks::<2>();
        let values: Vec<u16> = pairs.iter().map(|&pair| u16::from_be_bytes(pair)).collect();
        Values::Sixteen(grey(&values, channels, u32::from, |grey| grey))
    } else {
        Values::Eight(grey(&stored, channels, u32::from, |grey| grey as u8))
    };
    debug_assert!(color != ColorType::Indexed, "palettes are expanded");
    Ok(Ok(StoredGray { dims, values }))
}

/// The grey of pixels of so many channels: one or two are grey, with transparency, three or four
/// colour.
fn grey<T: Copy>(
    values: &[T],
    channels: usize,
    wide: impl Fn(T) -> u32,
    narrow: impl Fn(u16) -> T,
) -> Vec<T> {
    let pixels = values.chunks_exact(channels);
    if channels < 3 {
        return pixels.map(|pixel| pixel[0]).collect();
    }
    pixels.map(|pixel| narrow(luma([wide(pixel[0]), wide(pixel[1]), wide(pixel[2])]))).collect()
}

/// The entry of the orientation, a short number, in either order of bytes, is another than 1.
fn is_turned(exif: &[u8]) -> bool {
    exif.windows(10).any(|entry| match entry {
        [0x12, 0x01, 3, 0, 1, 0, 0, 0, value, 0] | [0x01, 0x12, 0, 3, 0, 0, 0, 1, 0, value] => {
            (2..=8).contains(value)
        }
        _ => false,
    })
}
