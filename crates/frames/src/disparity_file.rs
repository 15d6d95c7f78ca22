//! Files of disparities in px as floating point: PFM and NumPy's NPY and NPZ.
//!
//! In: an unchecked file. Out: a disparity per pixel, the upper left one first; what is not finite
//! is unknown and becomes NaN.
//!
//! ```text
//! PFM   "Pf", width, height, scale, then 32-bit floats, the lowest row first; a scale below 0 says
//!       little endian, above 0 big endian
//! NPY   one array of two dimensions (height, width), or of three with one that is 1; floats or
//!       integers of any width and order
//! NPZ   a ZIP archive with one such array; of several the one called disp, disparity, gt or arr_0
//! ```
//!
//! A PFM file whose sign says the wrong order still has as many bytes: it is known by its values.
//! Where more than half of those that are not 0 lie outside of 1e-4 .. 1e5 px as marked, and more
//! than half lie inside with the bytes turned, the marker is wrong.
//!
//! # Bounds
//! At most 65 535 pixels a side, [`PIXELS`] and [`IMAGE_BYTES`] in all, and memory only for what
//! the file holds.
//!
//! # Source
//! PFM: Debevec's Portable FloatMap as the Middlebury benchmark uses it
//! (`vision.middlebury.edu/stereo/submit3/upload-format.html`: only the sign of the scale counts,
//! rows from below, infinity = unknown). NPY and NPZ: [`numpy`](super::numpy).

use super::error::{DisparityFault, FrameError};
use super::numpy::array;
use crate::untrusted::{self, IMAGE_BYTES, PIXELS};
use linestereo::Dims;
use std::io::Cursor;
use std::path::Path;
use zip::ZipArchive;

/// Names of files that are read here.
const EXTENSIONS: [&str; 3] = ["pfm", "npy", "npz"];
/// Names of arrays that are taken where an archive holds several.
const ARRAY_NAMES: [&str; 4] = ["disp", "disparity", "gt", "arr_0"];
/// No disparity is smaller or larger than this, px: a wrong byte order gives numbers of any size.
const PLAUSIBLE_PX: core::ops::Range<f32> = 1e-4..1e5;

/// A file of this name is read by [`load_disparities`].
pub(crate) fn is_float_file(path: &Path) -> bool {
    let extension =
        path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    extension.is_some_and(|extension| EXTENSIONS.contains(&&*extension))
}

/// Reads a PFM, NPY or NPZ file of disparities in px, row-major; NaN = unknown.
pub fn load_disparities(path: &Path) -> Result<(Dims, Vec<f32>), FrameError> {
    let bytes = untrusted::read(path, IMAGE_BYTES)
        .map_err(|error| FrameError::Read(path.to_path_buf(), error))?;
    disparities(&bytes).map_err(|fault| FrameError::Disparities(path.to_path_buf(), fault))
}

/// Size and disparities of a file, whose format its content tells.
fn disparities(bytes: &[u8]) -> Result<(Dims, Vec<f32>), DisparityFault> {
    let (dims, mut values) = if bytes.starts_with(b"PK") {
        zipped(bytes)?
    } else if bytes.starts_with(b"\x93NUMPY") {
        array(bytes)?
    } else {
        float_map(bytes)?
    };
    values.iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = f32::NAN);
    if values.iter().all(|value| value.is_nan()) {
        return Err(DisparityFault::NothingKnown);
    }
    Ok((dims, values))
}

fn float_map(bytes: &[u8]) -> Result<(Dims, Vec<f32>), DisparityFault> {
    let mut rest = bytes;
    match word(&mut rest) {
        Some("Pf") => {}
        Some("PF") => return Err(DisparityFault::Coloured),
        _ => return Err(DisparityFault::Header("its first word is not Pf")),
    }
    let mut side = || word(&mut rest)?.parse::<u16>().ok().filter(|&side| side > 0);
    let (Some(width), Some(height)) = (side(), side()) else {
        return Err(DisparityFault::Header("width and height are not two numbers of 1 to 65535"));
    };
    if u64::from(width) * u64::from(height) > PIXELS {
        return Err(DisparityFault::Shape(vec![height.into(), width.into()]));
    }
    let marker = word(&mut rest).ok_or(DisparityFault::Header("the scale is missing"))?;
    let scale = marker.parse::<f32>().ok().filter(|scale| *scale != 0.0 && scale.is_finite());
    let is_big =
        scale.ok_or_else(|| DisparityFault::NoByteOrder(marker.chars().take(24).collect()))? > 0.0;
    let needed = 4 * usize::from(width) * usize::from(height);
    let values = rest
        .get(..needed)
        .ok_or(DisparityFault::Truncated { needed: needed as u64, found: rest.len() as u64 })?;
    let read = |is_big: bool| -> Vec<f32> {
        let convert = if is_big { f32::from_be_bytes } else { f32::from_le_bytes };
        let rows = values.chunks_exact(4 * usize::from(width)).rev();
        rows.flat_map(|row| row.as_chunks().0.iter().map(|&bytes| convert(bytes))).collect()
    };
    let as_marked = read(is_big);
    if !is_plausible(&as_marked) && is_plausible(&read(!is_big)) {
        return Err(DisparityFault::ByteOrder { says_big: is_big });
    }
    Ok((Dims { width, height }, as_marked))
}

/// The next word of a header: exactly one white space ends it, because values follow the last one
/// at once.
fn word<'a>(rest: &mut &'a [u8]) -> Option<&'a str> {
    let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
    let length = rest[start..].iter().position(u8::is_ascii_whitespace)?;
    let (word, after) = rest[start..].split_at(length);
    // "\r\n" is one end of a line.
    *rest = after.strip_prefix(b"\r\n").unwrap_or(&after[1..]);
    core::str::from_utf8(word).ok()
}

/// More than half of the finite values that are not 0 are disparities; true of none.
fn is_plausible(values: &[f32]) -> bool {
    let sizes =
        || values.iter().map(|value| value.abs()).filter(|size| size.is_finite() && *size != 0.0);
    2 * sizes().filter(|size| PLAUSIBLE_PX.contains(size)).count() >= sizes().count()
}

fn zipped(bytes: &[u8]) -> Result<(Dims, Vec<f32>), DisparityFault> {
    let broken = |error: &dyn core::fmt::Display| DisparityFault::Array(error.to_string());
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| broken(&error))?;
    let names: Vec<String> = archive
        .file_names()
        .filter_map(|name| Some(name.ok()?.strip_suffix(".npy")?.to_owned()))
        .collect();
    let wanted = match names.as_slice() {
        [only] => only,
        several => ARRAY_NAMES
            .iter()
            .find_map(|wanted| several.iter().find(|name| name == wanted))
            .ok_or_else(|| DisparityFault::Arrays(several.to_vec()))?,
    };
    array(archive.by_name(&format!("{wanted}.npy")).map_err(|error| broken(&error))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_is_read_word_by_word() {
        let mut rest: &[u8] = b"Pf\r\n3 2\n-1.0\n\n\x0a\x20";
        let words: Vec<_> = (0..4).map(|_| word(&mut rest).unwrap().to_owned()).collect();
        assert_eq!(words, ["Pf", "3", "2", "-1.0"]);
        assert_eq!(rest, b"\n\x0a\x20"); // one end of line alone belongs to the header
        assert_eq!(word(&mut rest), None);
    }
}
